//! Laws of the tracer that need no oracle: what must not change the image. `tests/metamorphic.rs` has those of changed
//! scenes.

mod families;

use std::ops::Range;

use clisc::compile;
use clisc::ir::{self, Registers, SceneView};
use clisc::plan::{Part, Settings, Size, plan};
use clisc::source::Source;
use clisc::trace::Tracer;

use families::sketch::{Finish, Sketch};
use families::{FAMILIES, WITHOUT_TIES};

/// Seeds of each family.
const N_SEEDS: u64 = 3;

const WIDTH: u32 = 48;
const HEIGHT: u32 = 36;

fn settings() -> Settings {
    Settings { size: Size::new(WIDTH, HEIGHT).expect("a size within the limits"), ..Settings::default() }
}

fn render_rows(view: SceneView<'_>, rows: Range<u32>) -> Vec<u8> {
    let mut rgb = vec![0; rows.len() * WIDTH as usize * 3];
    Tracer::new(plan(view, &settings())).render_rows(rows, &mut rgb);
    rgb
}

fn render(sketch: &Sketch) -> Vec<u8> {
    render_rows(sketch.make().view(), 0..HEIGHT)
}

/// Calls `law` with every family at its seeds.
fn for_all_sketches(law: impl Fn(&str, &Sketch)) {
    for family in FAMILIES {
        for seed in 0..N_SEEDS {
            law(&format!("{} seed {seed}", family.name), &family.sketch(seed));
        }
    }
}

#[track_caller]
fn assert_same(title: &str, sketch: &Sketch, image: &[u8], other: &[u8]) {
    let n_different = image.chunks(3).zip(other.chunks(3)).filter(|(a, b)| a != b).count();
    let first = image.chunks(3).zip(other.chunks(3)).position(|(a, b)| a != b).unwrap_or(0);
    let [column, row] = [first % WIDTH as usize, first / WIDTH as usize];
    assert!(
        n_different == 0,
        "{title}: {n_different} pixels differ, first ({column}, {row}): {:?} and {:?}\n{}",
        &image[3 * first..3 * first + 3],
        &other[3 * first..3 * first + 3],
        sketch.text()
    );
}

#[test]
fn threads_and_bands_do_not_change_the_image() {
    let pools = [1, 2, 5].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("a pool of threads"));
    for_all_sketches(|title, sketch| {
        let [one, two, five] = pools.each_ref().map(|pool| pool.install(|| render(sketch)));
        assert_same(title, sketch, &one, &two);
        assert_same(title, sketch, &one, &five);
        let made = sketch.make();
        let bands = [0..1, 1..8, 8..35, 35..HEIGHT].map(|rows| render_rows(made.view(), rows)).concat();
        assert_same(title, sketch, &one, &bands);
    });
}

#[test]
fn the_order_of_distinct_objects_does_not_change_the_image() {
    for family in FAMILIES.iter().filter(|family| WITHOUT_TIES.contains(&family.name)) {
        for seed in 0..4 * N_SEEDS {
            let sketch = family.sketch(seed);
            let title = format!("{} seed {seed} reversed", family.name);
            assert_same(&title, &sketch, &render(&sketch), &render(&sketch.reversed()));
        }
    }
}

#[test]
fn copies_behind_the_first_are_never_seen() {
    let garish =
        Finish { ambient: [1.0, 0.0, 1.0], diffuse: [0.0; 3], specular: [1.0; 3], shininess: 1.0, reflectance: 1.0 };
    for_all_sketches(|title, sketch| {
        assert_same(&format!("{title} with copies"), sketch, &render(sketch), &render(&sketch.with_copies(garish)));
    });
}

#[test]
fn an_endless_pillar_out_of_sight_changes_nothing() {
    let scene = |pillar: &str| {
        let text = format!(
            "fov 60\nlight 1 1 1 2 4 1\nsurface .1 .1 .1 .6 .3 .2 .4 .4 .4 20 .3\nsphere 0 0 -4 1\nsphere 1 .5 -3 .3\n\
             {pillar}\nwrite a.png\n"
        );
        ir::validate(compile(&Source::new("pillar.cli", text)).program).expect("a sound program")
    };
    let image = |program: &ir::Valid, part: Part| {
        let mut registers = Registers::default();
        program.commands.iter().for_each(|command| registers.step(command));
        let mut rgb = vec![0; (WIDTH * HEIGHT * 3) as usize];
        Tracer::new(plan(SceneView::new(program, registers), &Settings { part, ..settings() }))
            .render_rows(0..HEIGHT, &mut rgb);
        rgb
    };
    for part in [Part::A, Part::B] {
        let without = image(&scene(""), part);
        // Behind the eye and the light, and too thin to be met by chance.
        for reach in ["1e6", "1e100", "1e130"] {
            let with = image(&scene(&format!("cylinder 1e-9 7.123456789 50 -{reach} {reach}")), part);
            assert!(with == without, "a pillar to {reach} changes part {part:?}");
        }
    }
    // Part A draws no cylinders, whatever their size.
    assert!(image(&scene("cylinder 1 0 -5 -1e300 1e300"), Part::A) == image(&scene(""), Part::A));
}

#[test]
fn a_cancelled_render_traces_no_further_pixel() {
    let program = ir::validate(compile(&Source::new("empty.cli", "write a.png\n")).program).expect("a sound program");
    let view = SceneView::new(&program, Registers::default());
    let mut rgb = vec![0; (WIDTH * HEIGHT * 3) as usize];
    let counts = Tracer::new(plan(view, &settings())).render_rows_unless(0..HEIGHT, &mut rgb, &|| true);
    assert_eq!(counts.eye_rays, 0);
}
