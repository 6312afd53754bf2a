//! What the plans of a program's images have found, as text and JSON, stable from run to run.
//!
//! A block for each `write`, in it a stanza for each pass: what is kept, and of what is left out the reason.

use std::fmt::{self, Display};
use std::io::{self, Write};

use glam::DVec3;
use serde_json::{Value, json};

use crate::ir::{Command, Registers, SceneView, Valid};
use crate::plan::report::{Kept, LeftOut, Reason};
use crate::plan::{Changes, Object, Pass, Plan, Settings, Terms, plan};
use crate::source::Source;

/// The version of the shape of the JSON dump.
const VERSION: u32 = 1;

/// One `write` with its plan.
struct Planned<'a> {
    write_idx: usize,
    name: &'a str,
    line: Option<u32>,
    registers: Registers,
    plan: Plan<'a>,
    /// An earlier `write` of which pixels can be kept, and which not.
    earlier: Option<(usize, Changes)>,
}

/// Writes what each image of the program needs, as a listing.
///
/// # Errors
/// Those of `out`.
pub fn dump_plans(source: &Source, program: &Valid, settings: &Settings, out: &mut dyn Write) -> io::Result<()> {
    for_each_write(source, program, settings, |planned| write!(out, "{}", Listing(planned)))?;
    let n_dead = n_commands_behind_the_last_write(program);
    if n_dead > 0 {
        writeln!(out, "behind the last write: {} without effect", counted(n_dead, "command"))?;
    }
    Ok(())
}

/// Writes what each image of the program needs, as a JSON document.
///
/// # Errors
/// Those of `out`.
pub fn dump_plans_json(source: &Source, program: &Valid, settings: &Settings, out: &mut dyn Write) -> io::Result<()> {
    write!(out, "{{\n  \"version\": {VERSION},\n  \"path\": {},\n  \"writes\": [", Value::from(source.name()))?;
    let mut separator = "";
    for_each_write(source, program, settings, |planned| {
        write!(out, "{separator}\n    {}", to_json(planned))?;
        separator = ",";
        Ok(())
    })?;
    let close = if separator.is_empty() { "]" } else { "\n  ]" };
    writeln!(out, "{close},\n  \"commands_behind_the_last_write\": {}\n}}", n_commands_behind_the_last_write(program))
}

fn n_commands_behind_the_last_write(program: &Valid) -> usize {
    program.commands.iter().rev().take_while(|command| !matches!(command, Command::Write(_))).count()
}

/// Plans every image and calls `visit` with it.
fn for_each_write(
    source: &Source,
    program: &Valid,
    settings: &Settings,
    mut visit: impl FnMut(&Planned<'_>) -> io::Result<()>,
) -> io::Result<()> {
    let mut registers = Registers::default();
    let mut earlier: Vec<Registers> = Vec::new();
    for (idx, command) in program.commands.iter().enumerate() {
        registers.step(command);
        let Command::Write(name) = command else { continue };
        let plan = plan(SceneView::new(program, registers), settings);
        let span = program.origins.commands.get(idx);
        let line = span.map(|span| source.lines().line_of(span.start) as u32 + 1);
        let of = best_earlier(&plan, &earlier);
        visit(&Planned { write_idx: earlier.len(), name, line, registers, plan, earlier: of })?;
        earlier.push(registers);
    }
    Ok(())
}

/// Returns the earlier `write` that saves most: one that is equal, else the last if some of its pixels can be kept.
fn best_earlier(plan: &Plan<'_>, earlier: &[Registers]) -> Option<(usize, Changes)> {
    let mut changes = earlier.iter().map(|registers| plan.changes_since(registers)).enumerate();
    let last = changes.next_back()?;
    if last.1 == Changes::Nothing {
        return Some(last);
    }
    let equal = changes.find(|(_, changes)| *changes == Changes::Nothing);
    equal.or_else(|| matches!(last.1, Changes::Tiles(_)).then_some(last))
}

/// A `write` as a listing.
struct Listing<'a>(&'a Planned<'a>);

impl Display for Listing<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Planned { write_idx, name, line, registers, plan, earlier } = self.0;
        let size = plan.settings.size;
        write!(f, "write {write_idx}  {name:?}  {}x{}  fov {:?}", size.width(), size.height(), registers.fov_deg)?;
        writeln!(f, "{}", line.map_or_else(String::new, |line| format!("  ; line {line}")))?;
        list_writes(f, plan, earlier.as_ref())?;
        list_objects(f, plan)?;
        list_terms(f, plan)?;
        list_bounces(f, plan)?;
        list_shadows(f, plan)?;
        list_tiles(f, plan)
    }
}

/// Begins the stanza of a pass; tells whether the pass is on.
fn begin(f: &mut fmt::Formatter<'_>, plan: &Plan<'_>, pass: Pass) -> Result<bool, fmt::Error> {
    let is_on = plan.settings.passes.contains(pass);
    write!(f, "  {:<10}  ", pass.name())?;
    if !is_on {
        writeln!(f, "off")?;
    }
    Ok(is_on)
}

fn list_writes(f: &mut fmt::Formatter<'_>, plan: &Plan<'_>, earlier: Option<&(usize, Changes)>) -> fmt::Result {
    if !begin(f, plan, Pass::Writes)? {
        return Ok(());
    }
    match earlier {
        Some((idx, Changes::Nothing)) => writeln!(f, "the image of write {idx}"),
        Some((idx, Changes::Tiles(mask))) => {
            writeln!(f, "the image of write {idx} but for {} of {} tiles", mask.n_tiles(), count_tiles(plan).n_tiles)
        }
        Some((_, Changes::Everything)) | None => writeln!(f, "every pixel is new"),
    }
}

fn list_objects(f: &mut fmt::Formatter<'_>, plan: &Plan<'_>) -> fmt::Result {
    let report = &plan.report;
    if !begin(f, plan, Pass::Objects)? {
        return Ok(());
    }
    let n_objects = report.n_spheres + report.n_cylinders;
    write!(f, "{} of {} kept", n_objects - report.left_out.len(), counted(n_objects, "object"))?;
    writeln!(f, "{}", if report.kept.is_none() { "; too many for pairs to be looked at" } else { "" })?;
    for LeftOut { object, reason } in &report.left_out {
        writeln!(f, "    {}  left out: {}", Name(*object), Because(*reason))?;
    }
    for kept in report.kept.iter().flatten() {
        let seen = if kept.is_seen { "seen" } else { "not seen by the eye" };
        let from = if kept.is_sealed { ", met from outside alone" } else { "" };
        writeln!(f, "    {}  {seen}{from}", Name(kept.object))?;
    }
    Ok(())
}

fn list_terms(f: &mut fmt::Formatter<'_>, plan: &Plan<'_>) -> fmt::Result {
    let report = &plan.report;
    if begin(f, plan, Pass::Terms)? {
        writeln!(f, "{} of {} shine", report.lights.len(), counted(report.n_lights, "light"))?;
        for (surface, terms) in &report.surfaces {
            writeln!(f, "    surface #{surface}  {}", Needs(terms))?;
        }
    }
    if begin(f, plan, Pass::Saturation)? {
        let n_gain = report.surfaces.iter().filter(|(_, terms)| terms.only_gains).count();
        writeln!(f, "{} of {} only gain light", n_gain, counted(report.surfaces.len(), "surface"))?;
    }
    Ok(())
}

fn list_bounces(f: &mut fmt::Formatter<'_>, plan: &Plan<'_>) -> fmt::Result {
    if !begin(f, plan, Pass::Bounces)? {
        return Ok(());
    }
    match plan.report.max_bounces {
        Some(0) => writeln!(f, "no ray is reflected")?,
        Some(n) => writeln!(f, "a ray is reflected at most {}", times(n))?,
        None => writeln!(f, "a ray is reflected at most {}", times(plan.last_level()))?,
    }
    for kept in plan.report.kept.iter().flatten() {
        if let Some(met) = &kept.reflects {
            writeln!(f, "    {}  reflects {}", Name(kept.object), Names(met))?;
        }
    }
    Ok(())
}

fn list_shadows(f: &mut fmt::Formatter<'_>, plan: &Plan<'_>) -> fmt::Result {
    if !begin(f, plan, Pass::Shadows)? {
        return Ok(());
    }
    let Some(kept) = &plan.report.kept else { return writeln!(f, "found while tracing") };
    let lists = kept.iter().flat_map(|kept| &kept.lights);
    let n_pairs = kept.len() * plan.report.lights.len();
    let n_free = n_pairs - lists.clone().filter(|(_, between)| !between.is_empty()).count();
    write!(f, "nothing between object and light in {n_free} of {}", counted(n_pairs, "pair"))?;
    writeln!(f, "{}", if n_free < n_pairs { "; of the others less is, tile by tile, as tracing finds" } else { "" })?;
    for Kept { object, lights, .. } in kept {
        for (light, between) in lights {
            let light = plan.report.lights[*light as usize];
            writeln!(f, "    {}  light #{light}: {}", Name(*object), Names(between))?;
        }
    }
    Ok(())
}

fn list_tiles(f: &mut fmt::Formatter<'_>, plan: &Plan<'_>) -> fmt::Result {
    if !begin(f, plan, Pass::Tiles)? {
        return Ok(());
    }
    let TileCounts { n_tiles, n_empty, n_listed } = count_tiles(plan);
    let (width, height) = (plan.tiles.width(), plan.tiles.height());
    write!(f, "{} of {width}x{height} pixels, {n_empty} see nothing", counted(n_tiles, "tile"))?;
    let mean = n_listed as f64 / (n_tiles - n_empty).max(1) as f64;
    writeln!(f, ", the others {mean:.1} objects each")
}

/// What the tiles see.
struct TileCounts {
    n_tiles: usize,
    n_empty: usize,
    n_listed: usize,
}

fn count_tiles(plan: &Plan<'_>) -> TileCounts {
    let size = plan.settings.size;
    let mut counts = TileCounts { n_tiles: 0, n_empty: 0, n_listed: 0 };
    for row in (0..size.height()).step_by(plan.tiles.height() as usize) {
        for column in (0..size.width()).step_by(plan.tiles.width() as usize) {
            let n_listed = plan.tiles.candidates(column, row).len();
            counts.n_tiles += 1;
            counts.n_empty += usize::from(n_listed == 0);
            counts.n_listed += n_listed;
        }
    }
    counts
}

/// Returns "1 light" or "3 lights".
fn counted(n: usize, noun: &str) -> String {
    if n == 1 { format!("1 {noun}") } else { format!("{n} {noun}s") }
}

fn times(n: u32) -> String {
    if n == 1 { "once".to_owned() } else { format!("{n} times") }
}

/// An object by its kind and index.
struct Name(Object);

impl Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Object::Sphere(i) => write!(f, "sphere #{i}"),
            Object::Cylinder(i) => write!(f, "cylinder #{i}"),
        }
    }
}

/// Objects with commas between them.
struct Names<'a>(&'a [Object]);

impl Display for Names<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return write!(f, "nothing");
        }
        for (i, object) in self.0.iter().enumerate() {
            write!(f, "{}{}", if i == 0 { "" } else { ", " }, Name(*object))?;
        }
        Ok(())
    }
}

/// Why an object is left out.
struct Because(Reason);

impl Display for Because {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Reason::Copy => write!(f, "equals one declared before"),
            Reason::Inside(outer) => write!(f, "lies inside {}", Name(outer)),
            Reason::OutOfReach => write!(f, "no ray comes near"),
        }
    }
}

/// What a surface needs.
struct Needs<'a>(&'a Terms);

impl Display for Needs<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Terms { diffuse, specular, mirror, constant, .. } = self.0;
        if let Some(DVec3 { x, y, z }) = constant {
            return write!(f, "always {x:?} {y:?} {z:?}");
        }
        write!(f, "ambient")?;
        if *diffuse {
            write!(f, ", diffuse")?;
        }
        if let Some(power) = specular {
            write!(f, ", specular of power {power}")?;
        }
        if *mirror { write!(f, ", reflection") } else { Ok(()) }
    }
}

fn to_json(planned: &Planned<'_>) -> Value {
    let Planned { write_idx, name, line, plan, earlier, .. } = planned;
    let report = &plan.report;
    let TileCounts { n_tiles, n_empty, n_listed } = count_tiles(plan);
    let names = |objects: &[Object]| objects.iter().map(|object| Name(*object).to_string()).collect::<Vec<_>>();
    let left_out = |left_out: &LeftOut| json!({ "object": Name(left_out.object).to_string(), "reason": Because(left_out.reason).to_string() });
    let kept = |kept: &Kept| {
        let between = |(light, between): &(u32, Vec<Object>)| json!({ "light": report.lights[*light as usize], "between": names(between) });
        json!({ "object": Name(kept.object).to_string(), "seen": kept.is_seen, "from_outside_alone": kept.is_sealed,
            "reflects": kept.reflects.as_deref().map(names),
            "lights": kept.lights.iter().map(between).collect::<Vec<_>>() })
    };
    let surface = |(idx, terms): &(u32, Terms)| {
        json!({ "surface": idx, "diffuse": terms.diffuse, "specular_power": terms.specular, "mirror": terms.mirror,
            "constant": terms.constant.map(|color| color.to_array()), "only_gains": terms.only_gains })
    };
    let (same_as, changed_tiles) = match earlier {
        Some((idx, Changes::Nothing)) => (Some(idx), Some(0)),
        Some((idx, Changes::Tiles(mask))) => (Some(idx), Some(mask.n_tiles())),
        Some((_, Changes::Everything)) | None => (None, None),
    };
    let off: Vec<_> = Pass::ALL.iter().filter(|pass| !plan.settings.passes.contains(**pass)).collect();
    json!({
        "write": write_idx, "name": name, "line": line,
        "off": off.iter().map(|pass| pass.name()).collect::<Vec<_>>(),
        "writes": { "earlier": same_as, "changed_tiles": changed_tiles },
        "objects": { "left_out": report.left_out.iter().map(left_out).collect::<Vec<_>>(),
            "kept": report.kept.as_ref().map(|all| all.iter().map(kept).collect::<Vec<_>>()) },
        "terms": { "lights": report.lights, "surfaces": report.surfaces.iter().map(surface).collect::<Vec<_>>() },
        "bounces": { "most": plan.last_level() },
        "tiles": { "width": plan.tiles.width(), "height": plan.tiles.height(), "count": n_tiles, "empty": n_empty,
            "listed": n_listed },
    })
}
