//! The program as text and JSON, stable from run to run.
//!
//! The text is for people and for snapshots. The command list is a listing to be read like assembler: index, mnemonic,
//! operand, and behind a semicolon the line of the source and what the step shows.

use std::io::{self, Write};
use std::ops::Range;

use glam::DVec3;
use serde_json::{Value, json};

use crate::ir::{Command, Handle, Registers, Valid};
use crate::source::{Source, Span};

/// The version of the shape of the JSON dumps.
const VERSION: u32 = 1;

/// Writes lights, surfaces, spheres and cylinders, one a line, with their lines in the source.
///
/// # Errors
/// Those of `out`.
pub fn dump_arenas(source: &Source, program: &Valid, out: &mut dyn Write) -> io::Result<()> {
    let lines = Lines { source };
    let (origins, equations) = (&program.origins, program.equations());
    writeln!(out, "lights")?;
    for (i, light) in program.lights.as_slice().iter().enumerate() {
        let (color, position) = (Triple(light.color), Triple(light.position));
        writeln!(out, "  #{i}  color {color}  position {position}{}", lines.comment(&origins.lights, i))?;
    }
    writeln!(out, "surfaces")?;
    for (i, s) in program.surfaces.as_slice().iter().enumerate() {
        let (ambient, diffuse, specular) = (Triple(s.ambient), Triple(s.diffuse), Triple(s.specular));
        write!(out, "  #{i}  ambient {ambient}  diffuse {diffuse}  specular {specular}")?;
        let (shininess, reflectance) = (s.shininess, s.reflectance);
        let comment = lines.comment(&origins.surfaces, i);
        writeln!(out, "  shininess {shininess:?}  reflectance {reflectance:?}{comment}")?;
    }
    writeln!(out, "spheres")?;
    for (i, s) in program.spheres.as_slice().iter().enumerate() {
        let (center, equation) = (Triple(s.center), equations.spheres[i].number());
        write!(out, "  #{i}  center {center}  radius {:?}", s.radius)?;
        write!(out, "  surface {:?}  order {}  equation {equation}", s.surface, s.order)?;
        writeln!(out, "{}", lines.comment(&origins.spheres, i))?;
    }
    writeln!(out, "cylinders")?;
    for (i, c) in program.cylinders.as_slice().iter().enumerate() {
        let (wall, [low, high]) = (equations.walls[i].number(), equations.caps[i].map(|cap| cap.number()));
        write!(
            out,
            "  #{i}  radius {:?}  x {:?}  z {:?}  y_min {:?}  y_max {:?}",
            c.radius, c.x, c.z, c.y_min, c.y_max
        )?;
        write!(out, "  surface {:?}  order {}  wall {wall}  caps {low} {high}", c.surface, c.order)?;
        writeln!(out, "{}", lines.comment(&origins.cylinders, i))?;
    }
    Ok(())
}

/// Writes lights, surfaces, spheres and cylinders as a JSON document.
///
/// # Errors
/// Those of `out`.
pub fn dump_arenas_json(source: &Source, program: &Valid, out: &mut dyn Write) -> io::Result<()> {
    let lines = Lines { source };
    let (origins, equations) = (&program.origins, program.equations());
    let mut document = Document::begin(source, out)?;
    document.list("lights", program.lights.as_slice(), |i, light| {
        json!({ "color": light.color.to_array(), "position": light.position.to_array(),
            "line": lines.line(&origins.lights, i) })
    })?;
    document.list("surfaces", program.surfaces.as_slice(), |i, s| {
        json!({ "ambient": s.ambient.to_array(), "diffuse": s.diffuse.to_array(), "specular": s.specular.to_array(),
            "shininess": s.shininess, "reflectance": s.reflectance, "line": lines.line(&origins.surfaces, i) })
    })?;
    document.list("spheres", program.spheres.as_slice(), |i, s| {
        json!({ "center": s.center.to_array(), "radius": s.radius, "surface": s.surface.index(), "order": s.order,
            "equation": equations.spheres[i].number(), "line": lines.line(&origins.spheres, i) })
    })?;
    document.list("cylinders", program.cylinders.as_slice(), |i, c| {
        json!({ "radius": c.radius, "x": c.x, "z": c.z, "y_min": c.y_min, "y_max": c.y_max,
            "surface": c.surface.index(), "order": c.order, "wall": equations.walls[i].number(),
            "caps": equations.caps[i].map(|cap| cap.number()), "line": lines.line(&origins.cylinders, i) })
    })?;
    document.end()
}

/// Writes the command list as a listing.
///
/// # Errors
/// Those of `out`.
pub fn dump_commands(source: &Source, program: &Valid, out: &mut dyn Write) -> io::Result<()> {
    let lines = Lines { source };
    let mut registers = Registers::default();
    for (i, command) in program.commands.iter().enumerate() {
        let before = registers;
        registers.step(command);
        let (operand, effect) = describe(command, &before, &registers);
        let line =
            lines.line(&program.origins.commands, i).map_or_else(|| "no line".to_owned(), |n| format!("line {n}"));
        writeln!(out, "{i:>4}  {:<10}  {operand:<22}  ; {line}: {effect}", mnemonic(command))?;
    }
    Ok(())
}

/// Writes the command list as a JSON document.
///
/// # Errors
/// Those of `out`.
pub fn dump_commands_json(source: &Source, program: &Valid, out: &mut dyn Write) -> io::Result<()> {
    let lines = Lines { source };
    let mut document = Document::begin(source, out)?;
    document.list("commands", &program.commands, |i, command| {
        let operand = match command {
            Command::Fov(fov_deg) => json!(fov_deg),
            Command::Background(color) => json!(color.to_array()),
            Command::Lights(n) | Command::Spheres(n) | Command::Cylinders(n) => json!(n),
            Command::Write(name) => json!(name.as_ref()),
        };
        json!({ "op": mnemonic(command), "operand": operand, "line": lines.line(&program.origins.commands, i) })
    })?;
    document.end()
}

fn mnemonic(command: &Command) -> &'static str {
    match command {
        Command::Fov(_) => "fov",
        Command::Background(_) => "background",
        Command::Lights(_) => "lights",
        Command::Spheres(_) => "spheres",
        Command::Cylinders(_) => "cylinders",
        Command::Write(_) => "write",
    }
}

/// Returns the operand of a command and what it does, given the registers before and after it.
fn describe(command: &Command, before: &Registers, after: &Registers) -> (String, String) {
    match command {
        Command::Fov(fov_deg) => (format!("{fov_deg:?}"), "field of view in degrees".to_owned()),
        Command::Background(color) => (Triple(*color).to_string(), "colour of the background".to_owned()),
        Command::Lights(n) => (n.to_string(), shown("light", before.n_lights..after.n_lights)),
        Command::Spheres(n) => (n.to_string(), shown("sphere", before.n_spheres..after.n_spheres)),
        Command::Cylinders(n) => (n.to_string(), shown("cylinder", before.n_cylinders..after.n_cylinders)),
        Command::Write(name) => {
            let Registers { fov_deg, n_lights, n_spheres, n_cylinders, .. } = after;
            let effect = format!(
                "renders with fov {fov_deg:?}, lights {n_lights}, spheres {n_spheres}, cylinders {n_cylinders}"
            );
            (format!("{name:?}"), effect)
        }
    }
}

/// Returns "shows light #0" or "shows lights #0 to #3".
fn shown(noun: &str, range: Range<u32>) -> String {
    match range.len() {
        0 => format!("shows no more {noun}s"),
        1 => format!("shows {noun} {:?}", Handle::<()>::new(range.start)),
        _ => format!("shows {noun}s #{} to #{}", range.start, range.end - 1),
    }
}

/// The lines of the source from which the parts of a program came.
struct Lines<'s> {
    source: &'s Source,
}

impl Lines<'_> {
    /// Returns the line of the `i`-th origin, from 1; none for a program that was not lowered from text.
    fn line(&self, origins: &[Span], i: usize) -> Option<u32> {
        let span = origins.get(i)?;
        Some(self.source.lines().line_of(span.start) as u32 + 1)
    }

    /// Returns the line as the end of a line of text.
    fn comment(&self, origins: &[Span], i: usize) -> String {
        self.line(origins, i).map_or_else(String::new, |line| format!("  ; line {line}"))
    }
}

/// Three numbers with blanks between them.
struct Triple(DVec3);

impl std::fmt::Display for Triple {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let DVec3 { x, y, z } = self.0;
        write!(f, "{x:?} {y:?} {z:?}")
    }
}

/// A JSON document of lists, written an item a line.
struct Document<'o> {
    out: &'o mut dyn Write,
}

impl<'o> Document<'o> {
    fn begin(source: &Source, out: &'o mut dyn Write) -> io::Result<Self> {
        write!(out, "{{\n  \"version\": {VERSION},\n  \"path\": {}", Value::from(source.name()))?;
        Ok(Self { out })
    }

    fn list<T>(&mut self, key: &str, items: &[T], to_json: impl Fn(usize, &T) -> Value) -> io::Result<()> {
        write!(self.out, ",\n  \"{key}\": [")?;
        for (i, item) in items.iter().enumerate() {
            let separator = if i == 0 { "" } else { "," };
            write!(self.out, "{separator}\n    {}", to_json(i, item))?;
        }
        let close = if items.is_empty() { "]" } else { "\n  ]" };
        write!(self.out, "{close}")
    }

    fn end(self) -> io::Result<()> {
        writeln!(self.out, "\n}}")
    }
}
