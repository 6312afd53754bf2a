//! The tracer gives, in every pixel, what exact arithmetic gives.
//!
//! Families of hard scenes are rendered by the tracer and by `exact`, which shares nothing with it but the IR. That in turn
//! is held against itself and against the original images here, and against analytic cases in `tests/exact.rs`.
//!
//! `CLISC_SWEEP=N cargo test --test exactness` takes N seeds of each family, at larger sizes; the name of a family in
//! `CLISC_FAMILY` leaves out the others.

mod families;

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use clisc::exact::{LADDER, Pixel, Renderer, Tie};
use clisc::exec::exact_settings;
use clisc::ir::{self, Registers, SceneView};
use clisc::plan::{Part, SampleAt, Settings, Size, plan};
use clisc::source::Source;
use clisc::trace::Tracer;

use rayon::prelude::*;

use families::sketch::Sketch;
use families::{FAMILIES, FINEST, Family};

/// Seeds of each family in an ordinary run.
const N_SEEDS: u64 = 3;

/// The sizes that the seeds of a family take in turn: even and odd, upright and wide.
const SIZES: [[u32; 2]; 3] = [[32, 24], [23, 31], [30, 30]];
/// The sizes of a sweep.
const SWEEP_SIZES: [[u32; 2]; 3] = [[96, 72], [61, 81], [150, 150]];

/// Pixels of a part B image in which the original differs from exact arithmetic, row 0 left out, for i1 … i10.
const ORIGINAL_DIFFERENCES: [usize; 10] = [0, 2, 0, 0, 5, 2, 4, 0, 15, 13];

/// A pixel in which the tracer and `exact` differ.
struct Difference {
    column: u32,
    row: u32,
    traced: [u8; 3],
    exact: Pixel,
}

fn sized([width, height]: [u32; 2]) -> Settings {
    let size = Size::new(width, height).expect("a size within the limits");
    Settings { size, ..Settings::default() }
}

fn trace(view: SceneView<'_>, settings: &Settings) -> Vec<[u8; 3]> {
    let [width, height] = [settings.size.width(), settings.size.height()];
    let mut rgb = vec![0; width as usize * height as usize * 3];
    Tracer::new(plan(view, settings)).render_rows(0..height, &mut rgb);
    rgb.as_chunks().0.to_vec()
}

fn renderer<'p>(view: SceneView<'p>, settings: &Settings) -> Renderer<'p> {
    Renderer::new(view, &exact_settings(settings))
}

/// Renders every pixel, row by row from the top.
fn pixels(renderer: &Renderer<'_>, size: Size) -> Vec<Pixel> {
    let n_pixels = size.width() * size.height();
    (0..n_pixels).into_par_iter().map(|i| renderer.pixel(i % size.width(), i / size.width())).collect()
}

fn compare(view: SceneView<'_>, settings: &Settings) -> Vec<Difference> {
    let width = settings.size.width();
    let exact = pixels(&renderer(view, settings), settings.size);
    (0..)
        .zip(trace(view, settings).into_iter().zip(exact))
        .filter(|(_, (traced, exact))| *traced != exact.rgb)
        .map(|(i, (traced, exact))| Difference { column: i % width, row: i / width, traced, exact })
        .collect()
}

/// Compares one scene; of a difference returns all that one needs to look into it.
fn check(title: &str, sketch: &Sketch, settings: &Settings) -> Option<String> {
    let differences = compare(sketch.make().view(), settings);
    if differences.is_empty() {
        return None;
    }
    let mut text = format!("{title}, {settings:?}: {} pixels differ\n", differences.len());
    for Difference { column, row, traced, exact } in differences.iter().take(5) {
        writeln!(text, "  ({column}, {row}): traced {traced:?}, {exact:?}").expect("a string takes any text");
    }
    text.push_str(&sketch.text());
    Some(text)
}

fn assert_none(failures: &[String]) {
    assert!(failures.is_empty(), "{} scenes differ\n{}", failures.len(), failures.join("\n"));
}

/// Returns the seeds of a sweep, if this is one.
fn sweep() -> Option<u64> {
    std::env::var("CLISC_SWEEP").ok().map(|n| n.parse().expect("CLISC_SWEEP is a number of seeds"))
}

/// Returns families at their seeds, each with a title and the size of its turn.
fn cases(families: &[Family]) -> impl Iterator<Item = (String, Sketch, [u32; 2])> {
    let n_seeds = sweep().unwrap_or(N_SEEDS);
    let sizes = if sweep().is_some() { SWEEP_SIZES } else { SIZES };
    let only = std::env::var("CLISC_FAMILY").ok();
    let chosen = families.iter().filter(move |family| only.as_ref().is_none_or(|only| *only == family.name));
    chosen.flat_map(move |family| {
        (0..n_seeds).map(move |seed| {
            let size = sizes[seed as usize % sizes.len()];
            (format!("{} seed {seed}", family.name), family.sketch(seed), size)
        })
    })
}

#[test]
fn every_family_is_exact() {
    let failures: Vec<_> =
        cases(FAMILIES).filter_map(|(title, sketch, size)| check(&title, &sketch, &sized(size))).collect();
    assert_none(&failures);
}

#[test]
fn the_finest_families_need_more_bits_than_the_tracer_has() {
    // FIXME: double-double loses these rays. Once it leaves none open the families belong to the others. Its limits, as
    // measured: specks of 1e-29 of their distance are proved, of 1e-30 not; 16 levels among mirrors are, 20 are not.
    for family in FINEST {
        let n_open = |seed| {
            let (made, settings) = (family.sketch(seed).make(), sized([32, 24]));
            let mut rgb = vec![0; 32 * 24 * 3];
            Tracer::new(plan(made.view(), &settings)).render_rows(0..24, &mut rgb).unproved_pixels
        };
        assert!((0..3).map(n_open).sum::<u64>() > 0, "{} is proved now", family.name);
    }
}

#[test]
fn every_setting_is_exact() {
    let base = sized([16, 13]);
    let settings = [
        Settings { part: Part::A, ..sized([32, 24]) },
        Settings { sample_at: SampleAt::Centre, ..base.clone() },
        Settings { samples: 2, ..base.clone() },
        Settings { samples: 3, sample_at: SampleAt::Centre, ..base.clone() },
        Settings { max_level: 0, ..base.clone() },
        Settings { max_level: 1, ..base.clone() },
        Settings { max_level: 12, ..base.clone() },
        sized([1, 1]),
        sized([40, 3]),
    ];
    let mut failures = Vec::new();
    for name in ["ordinary", "hall of mirrors", "extreme surfaces", "eye in a mirrored cylinder", "touching rays"] {
        let family = FAMILIES.iter().find(|family| family.name == name).expect("a family of this name");
        for (seed, settings) in (0..).zip(&settings) {
            failures.extend(check(&format!("{name} seed {seed}"), &family.sketch(seed), settings));
        }
    }
    assert_none(&failures);
}

#[test]
fn the_text_of_a_sketch_says_the_same_scene() {
    for (title, sketch, size) in cases(FAMILIES) {
        let compiled = clisc::compile(&Source::new("scene.cli", sketch.text()));
        assert!(!compiled.has_errors(), "{title}\n{}", sketch.text());
        let program = ir::validate(compiled.program).expect("a sound program");
        assert_eq!(trace(whole(&program), &sized(size)), trace(sketch.make().view(), &sized(size)), "{title}");
    }
}

/// Returns the scene as the last `write` sees it.
fn whole(program: &ir::Valid) -> SceneView<'_> {
    let mut registers = Registers::default();
    program.commands.iter().for_each(|command| registers.step(command));
    SceneView::new(program, registers)
}

#[test]
fn exact_does_not_depend_on_its_precision() {
    for (title, sketch, size) in cases(FAMILIES).step_by(5).chain(cases(FINEST).step_by(2)) {
        let made = sketch.make();
        let settings = sized(size);
        let few = Renderer::with_ladder(made.view(), &exact_settings(&settings), &[192, 576, 1152, 2304]);
        let many = renderer(made.view(), &settings);
        let width = settings.size.width();
        for (i, pixel) in (0..).zip(pixels(&many, settings.size)).step_by(11) {
            let other = few.pixel(i % width, i / width);
            assert_eq!((pixel.rgb, pixel.open_ties), (other.rgb, other.open_ties), "{title} pixel {i}");
        }
    }
}

#[test]
fn exact_does_not_depend_on_its_algebra() {
    let mut n_answers = 0;
    for (title, sketch, size) in cases(FAMILIES).chain(cases(FINEST)) {
        let made = sketch.make();
        let settings = sized(size);
        let without = renderer(made.view(), &settings).without_algebra();
        let width = settings.size.width();
        let asking =
            (0..).zip(pixels(&renderer(made.view(), &settings), settings.size)).filter(|(_, p)| p.bits > LADDER[0]);
        for (i, pixel) in asking.step_by(7) {
            let other = without.pixel(i % width, i / width);
            assert_eq!(pixel.rgb, other.rgb, "{title} pixel {i}: {pixel:?} {other:?}");
            // What is equal by algebra is what no precision can tell apart.
            for (tie, n) in pixel.algebraic_ties.met() {
                let n_open = other.open_ties.of(tie) + other.proved_ties.of(tie);
                assert!(n <= n_open, "{title} pixel {i}: {pixel:?} {other:?}");
                n_answers += n;
            }
        }
    }
    assert!(n_answers > 20, "{n_answers} ties");
}

#[test]
fn exact_does_not_depend_on_its_filter() {
    for (title, sketch, size) in cases(FAMILIES).step_by(2) {
        let made = sketch.make();
        let settings = sized(size);
        let unfiltered = renderer(made.view(), &settings).testing_all();
        let width = settings.size.width();
        for (i, pixel) in (0..).zip(pixels(&renderer(made.view(), &settings), settings.size)).step_by(37) {
            assert_eq!(pixel.rgb, unfiltered.pixel(i % width, i / width).rgb, "{title} pixel {i}");
        }
    }
}

#[test]
fn exact_draws_touching_rays_and_counts_them() {
    let scene = "fov 60\nlight 1 1 1 0 0 5\nsurface 0 .2 0 .4 .1 .1 0 0 0 1 0\nsphere 0 0 -4 1\nwrite i.png\n";
    let program = ir::validate(clisc::compile(&Source::new("scene.cli", scene)).program).expect("a sound program");
    let exact = renderer(whole(&program), &sized([300, 300]));
    let touching = exact.pixel(138, 84);
    assert_eq!((touching.rgb, touching.algebraic_ties.of(Tie::Tangent)), ([14, 54, 3], 1));
    assert_eq!(touching.open_ties.total(), 0);
    let beside = exact.pixel(138, 83);
    assert_eq!((beside.rgb, beside.proved_ties.total() + beside.open_ties.total()), ([0; 3], 0));
}

/// Returns the folder of the original scenes, where there is one.
fn originals() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/course/2018");
    if !folder.is_dir() {
        let _ = writeln!(std::io::stderr(), "\nSKIPPED: the original scenes are not at {}", folder.display());
        return None;
    }
    Some(folder)
}

fn compile_original(folder: &Path, number: usize) -> ir::Valid {
    let text = std::fs::read_to_string(folder.join(format!("i{number}.cli"))).expect("an original scene");
    let compiled = clisc::compile(&Source::new(format!("i{number}.cli"), text));
    assert!(!compiled.has_errors(), "i{number}: {:?}", compiled.diagnostics);
    ir::validate(compiled.program).expect("a sound program")
}

/// In an ordinary run every eleventh pixel, in a sweep all.
#[test]
fn exact_paints_the_original_images() {
    let Some(folder) = originals() else { return };
    let step = if sweep().is_some() { 1 } else { 11 };
    for (i, &n_allowed) in ORIGINAL_DIFFERENCES.iter().enumerate() {
        let number = i + 1;
        let program = compile_original(&folder, number);
        let original = image::open(folder.join(format!("i{number}.png"))).expect("an original image").to_rgb8();
        let exact = renderer(whole(&program), &sized([300, 300]));
        let pixels = (300..300 * 300).step_by(step).map(|i| (i % 300, i / 300));
        let n_different = pixels.filter(|&(x, y)| original.get_pixel(x, y).0 != exact.pixel(x, y).rgb).count();
        assert!(n_different <= n_allowed, "i{number} differs in {n_different} pixels");
        assert!(step > 1 || n_different == n_allowed, "i{number} differs in {n_different} pixels");
    }
}

/// In an ordinary run at a smaller size, in a sweep at that of the original images.
#[test]
fn the_original_scenes_are_exact() {
    let Some(folder) = originals() else { return };
    let size = if sweep().is_some() { [300, 300] } else { [50, 50] };
    for number in 1..=10 {
        for part in [Part::A, Part::B] {
            let program = compile_original(&folder, number);
            let settings = Settings { part, ..sized(size) };
            let differences = compare(whole(&program), &settings);
            let places: Vec<_> = differences.iter().map(|d| (d.column, d.row, d.traced, &d.exact)).collect();
            assert!(places.is_empty(), "i{number} {part:?}: {places:?}");
        }
    }
}
