//! Laws of the plan: no pixel depends on what a pass skips, and what a pass says is so.

mod families;

use clisc::compile;
use clisc::ir::{self, Registers, SceneView, Valid};
use clisc::plan::{
    Changes, Object, Part, Pass, Passes, Reason, SampleAt, Settings, Size, dump_plans, dump_plans_json, plan,
};
use clisc::source::Source;
use clisc::testing::Stream;
use clisc::trace::{Counts, Tracer};

use families::FAMILIES;
use families::sketch::{Finish, Sketch};

/// Seeds of each family.
const N_SEEDS: u64 = 3;

/// Scenes of objects in objects; `CLISC_SWEEP` asks for another number.
const N_NESTED: u64 = 300;

const WIDTH: u32 = 32;
const HEIGHT: u32 = 24;

fn settings(passes: Passes) -> Settings {
    Settings { size: Size::new(WIDTH, HEIGHT).expect("a size within the limits"), passes, ..Settings::default() }
}

fn render(view: SceneView<'_>, settings: &Settings) -> (Vec<u8>, Counts) {
    let mut rgb = vec![0; (WIDTH * HEIGHT * 3) as usize];
    let counts = Tracer::new(plan(view, settings)).render_rows(0..HEIGHT, &mut rgb);
    (rgb, counts)
}

/// Compares the image of a sketch with all passes, and with each alone, to the one without any.
fn assert_passes_change_nothing(title: &str, sketch: &Sketch, settings: &Settings) {
    let made = sketch.make();
    let (plain, _) = render(made.view(), &Settings { passes: Passes::none(), ..settings.clone() });
    let alone = |pass: Pass| Pass::ALL.into_iter().filter(|other| *other != pass).fold(Passes::all(), Passes::without);
    let sets = Pass::ALL.map(|pass| (pass.name(), alone(pass)));
    for (name, passes) in sets.into_iter().chain([("all", Passes::all())]) {
        let (image, _) = render(made.view(), &Settings { passes, ..settings.clone() });
        let first = image.chunks(3).zip(plain.chunks(3)).position(|(a, b)| a != b);
        if let Some(first) = first {
            let [column, row] = [first as u32 % WIDTH, first as u32 / WIDTH];
            panic!("{title}: pixel ({column}, {row}) depends on pass {name}\n{}", sketch.text());
        }
    }
}

#[test]
fn no_pixel_depends_on_a_pass() {
    for family in FAMILIES {
        for seed in 0..N_SEEDS {
            let title = format!("{} seed {seed}", family.name);
            assert_passes_change_nothing(&title, &family.sketch(seed), &settings(Passes::all()));
        }
    }
}

#[test]
fn no_pixel_depends_on_a_pass_by_other_settings() {
    let usual = settings(Passes::all());
    for family in FAMILIES {
        let sketch = family.sketch(N_SEEDS);
        assert_passes_change_nothing(family.name, &sketch, &Settings { part: Part::A, ..usual.clone() });
        let smooth = Settings { samples: 2, sample_at: SampleAt::Centre, max_level: 1, ..usual.clone() };
        assert_passes_change_nothing(family.name, &sketch, &smooth);
    }
}

fn finish(stream: &mut Stream) -> Finish {
    let mut color = |scale: f64| [0; 3].map(|_| if stream.unit() < 0.2 { 0.0 } else { stream.unit() * scale });
    let (ambient, diffuse, specular) = (color(1.3), color(0.8), color(0.5));
    let shininess = [0.0, 1.0, 2.0, 7.0, 20.0, 0.5, 1e5][stream.below(7)];
    let reflectance = [0.0, 0.0, 0.6][stream.below(3)];
    let [ambient, diffuse, specular] =
        [ambient, diffuse, specular].map(|color| if stream.unit() < 0.3 { [0.0; 3] } else { color });
    Finish { ambient, diffuse, specular, shininess, reflectance }
}

/// Objects in, on, above, beside, behind and equal to each other, at whole numbers and halves so that many touch.
fn nested(seed: u64) -> Sketch {
    let mut stream = Stream::new(seed);
    let half = |stream: &mut Stream, low: i32, n: usize| f64::from(low + stream.below(n) as i32) / 2.0;
    let mut sketch = Sketch::new([60.0, 90.0, 53.0][stream.below(3)], [0.1, 0.2, 0.3]);
    for _ in 0..stream.below(4) {
        let color = [0; 3].map(|_| [0.0, 0.5, 0.9, -0.2][stream.below(4)]);
        sketch.light(color, [half(&mut stream, -8, 17), half(&mut stream, -4, 13), half(&mut stream, -16, 21)]);
    }
    let places: Vec<_> = (0..2 + stream.below(2))
        .map(|_| [half(&mut stream, -4, 9), half(&mut stream, -3, 7), half(&mut stream, -12, 15)])
        .collect();
    for _ in 0..3 + stream.below(8) {
        sketch.surface(finish(&mut stream));
        let [x, y, z] = places[stream.below(places.len())];
        let size = half(&mut stream, 1, 4);
        match stream.below(5) {
            0 | 1 => sketch.sphere([x, y, z], size),
            2 => sketch.sphere([x + size, y, z], size),
            3 => sketch.cylinder(size, [x, z], [y - size, y + half(&mut stream, 0, 3)]),
            _ => sketch.cylinder(size, [x, z], [y, y + 0.5]),
        };
    }
    sketch
}

#[test]
fn no_pixel_depends_on_a_pass_where_objects_touch_and_nest() {
    let n_seeds =
        std::env::var("CLISC_SWEEP").map_or(N_NESTED, |n| n.parse().expect("CLISC_SWEEP is a number of seeds"));
    for seed in 0..n_seeds {
        assert_passes_change_nothing(&format!("nested seed {seed}"), &nested(seed), &settings(Passes::all()));
    }
}

fn program(text: &str) -> Valid {
    let compilation = compile(&Source::new("plan.cli", format!("fov 60\n{text}\nwrite a.png\n")));
    assert!(!compilation.has_errors(), "{text}");
    ir::validate(compilation.program).expect("a sound program")
}

fn view(program: &Valid) -> SceneView<'_> {
    let mut registers = Registers::default();
    program.commands.iter().for_each(|command| registers.step(command));
    SceneView::new(program, registers)
}

const MATTE: &str = "surface .1 .1 .1 .6 .3 .2 0 0 0 1 0\n";
const MIRROR: &str = "surface .1 .1 .1 .6 .3 .2 0 0 0 1 .5\n";

/// Returns what is left out of a scene, and why.
fn left_out(text: &str) -> Vec<(Object, Reason)> {
    let program = program(text);
    let plan = plan(view(&program), &settings(Passes::all()));
    plan.report.left_out.iter().map(|left_out| (left_out.object, left_out.reason)).collect()
}

#[test]
fn objects_that_nothing_meets_are_left_out() {
    use Object::{Cylinder, Sphere};
    use Reason::{Copy, Inside, OutOfReach};
    for (text, expected) in [
        // Equal objects: all but the first.
        (
            &*format!("{MATTE}sphere 0 0 -5 1\nsphere 0 0 -5 1\ncylinder 1 0 -5 2 3\ncylinder 1 0 -5 2 3\n"),
            &[(Sphere(1), Copy), (Cylinder(1), Copy)][..],
        ),
        (&format!("{MATTE}cylinder 1 0 -5 2 3\ncylinder 1 0 -5 2 2.5\n"), &[]),
        // Inside another, unless eye or light are there too, or they touch.
        (
            &format!("{MATTE}sphere 0 0 -5 2\nsphere .5 0 -5 1\ncylinder .5 0 -5 -1 1\n"),
            &[(Sphere(1), Inside(Sphere(0))), (Cylinder(0), Inside(Sphere(0)))],
        ),
        (&format!("{MATTE}sphere 0 0 -5 2\nsphere 1 0 -5 1\n"), &[]),
        (&format!("{MATTE}sphere 0 0 -1 2\nsphere .5 0 -2 .25\n"), &[]),
        (&format!("light 1 1 1 0 0 -5\n{MATTE}sphere 0 0 -5 2\nsphere .5 0 -5 1\n"), &[]),
        (
            &format!("{MATTE}cylinder 2 0 -6 -1 1\nsphere 0 0 -6 .5\ncylinder 1 0 -6 -.5 .5\n"),
            &[(Sphere(0), Inside(Cylinder(0))), (Cylinder(1), Inside(Cylinder(0)))],
        ),
        (&format!("{MATTE}cylinder 2 0 -6 -1 1\ncylinder 1 0 -6 -1 .5\n"), &[]),
        // Behind the eye or beside the view: only mirrors and shadows need them.
        (
            &format!("light 1 1 1 0 0 1\n{MATTE}sphere 0 0 -5 1\nsphere 0 0 3 1\nsphere 40 0 -5 1\n"),
            &[(Sphere(1), OutOfReach), (Sphere(2), OutOfReach)],
        ),
        (
            &format!("light 1 1 1 0 0 9\n{MATTE}sphere 0 0 -5 1\nsphere 0 0 3 1\nsphere 40 0 -5 1\n"),
            &[(Sphere(2), OutOfReach)],
        ),
        (&format!("{MATTE}sphere 0 0 3 1\n{MIRROR}sphere 0 0 -5 1\n"), &[]),
        (&format!("{MATTE}sphere 0 0 -5 1\n{MIRROR}sphere 0 0 3 1\n"), &[(Sphere(1), OutOfReach)]),
        // A mirror that cuts an object may send rays into it, if it counts where they meet.
        (&format!("{MIRROR}sphere 1 0 -3 1\n{MATTE}sphere 0 0 -5 2\nsphere 0 0 -5 .5\n"), &[]),
        (
            &format!("{MATTE}sphere 0 0 -5 2\nsphere 0 0 -5 .5\n{MIRROR}sphere 1 0 -3 1\n"),
            &[(Sphere(1), Inside(Sphere(0)))],
        ),
        // At the rim of a cylinder no order counts; within its wall the mirror comes to no rim.
        (&format!("{MATTE}cylinder 2 0 -6 -1 1\nsphere 0 0 -6 .5\n{MIRROR}sphere 2 1 -6 1\n"), &[]),
        (
            &format!("{MATTE}cylinder 2 0 -6 -1 1\nsphere 0 0 -6 .5\n{MIRROR}sphere 0 1.5 -6 .75\n"),
            &[(Sphere(0), Inside(Cylinder(0)))],
        ),
        (
            &format!("{MIRROR}sphere 3 0 -5 1\n{MATTE}sphere 0 0 -5 2\nsphere 0 0 -5 .5\n"),
            &[(Sphere(2), Inside(Sphere(1)))],
        ),
    ] {
        assert_eq!(left_out(text), expected, "{text}");
    }
}

/// Returns how many objects may lie between each object and the first light.
fn n_occluders(text: &str) -> Vec<usize> {
    let program = program(text);
    let plan = plan(view(&program), &settings(Passes::all()));
    let kept = plan.report.kept.as_ref().expect("few objects");
    let between = |lights: &Vec<(u32, Vec<Object>)>| lights.first().map_or(0, |(_, between)| between.len());
    kept.iter().map(|kept| between(&kept.lights)).collect()
}

#[test]
fn occluders_are_few() {
    // A ball on the ground: only the ground has it in its light.
    let ground = "cylinder 10 0 -5 -3 -1\n";
    assert_eq!(n_occluders(&format!("light 1 1 1 3 4 0\n{MATTE}sphere 0 0 -5 1\n{ground}")), [0, 1]);
    // Two balls side by side with the light above, and with the light beside them.
    let balls = "sphere -1.5 0 -5 1\nsphere 1.5 0 -5 1\n";
    assert_eq!(n_occluders(&format!("light 1 1 1 0 9 -5\n{MATTE}{balls}")), [0, 0]);
    assert_eq!(n_occluders(&format!("light 1 1 1 9 0 -5\n{MATTE}{balls}")), [1, 0]);
    // A light under the ground, which is seen from above; and one inside the ball.
    assert_eq!(n_occluders(&format!("light 1 1 1 0 -9 -5\n{MATTE}sphere 0 0 -5 1\n{ground}")), [1, 0]);
    assert_eq!(n_occluders(&format!("light 1 1 1 0 0 -5\n{MATTE}sphere 0 0 -5 1\n{ground}")), [0, 1]);
    // With the eye inside, the light outside is behind the wall.
    assert_eq!(n_occluders(&format!("light 1 1 1 9 0 0\n{MATTE}sphere 0 0 0 1\n")), [1]);
}

#[test]
fn levels_end_where_no_mirror_meets_another() {
    let last_level = |text: &str| {
        let program = program(text);
        plan(view(&program), &settings(Passes::all())).last_level()
    };
    assert_eq!(last_level(&format!("{MATTE}sphere 0 0 -5 1\n")), 0);
    assert_eq!(last_level(&format!("{MIRROR}sphere 0 0 -5 1\n{MATTE}sphere 0 3 -5 1\n")), 1);
    assert_eq!(last_level(&format!("{MIRROR}sphere 0 0 -5 1\nsphere 0 3 -5 1\n")), 9);
    assert_eq!(last_level(&format!("{MIRROR}sphere 0 0 0 1\n")), 9);
    // A room of two mirrors: the floor sends rays up, and never to itself or below.
    assert_eq!(last_level(&format!("{MIRROR}cylinder 9 0 -5 -1 -.5\ncylinder 9 0 -5 3 4\n")), 9);
}

#[test]
fn a_floor_reflects_what_is_above_it() {
    let program = program(&format!("{MIRROR}cylinder 9 0 -5 -1 -.5\n{MATTE}sphere 0 0 -5 .5\nsphere 0 -3 -5 1\n"));
    let plan = plan(view(&program), &settings(Passes::all()));
    let kept = plan.report.kept.as_ref().expect("few objects");
    let floor = kept.iter().find(|kept| kept.object == Object::Cylinder(0)).expect("a floor");
    assert_eq!(floor.reflects, Some(vec![Object::Sphere(0)]));
}

#[test]
fn fewer_rays_and_tests_are_made() {
    let text = format!("light 1 1 1 3 4 0\n{MATTE}sphere 0 0 -5 1\ncylinder 10 0 -5 -3 -1\nsphere 0 0 5 1\n");
    let program = program(&text);
    let (image, counts) = render(view(&program), &settings(Passes::all()));
    let (plain, plain_counts) = render(view(&program), &settings(Passes::none()));
    assert!(image == plain);
    assert!(counts.tests < plain_counts.tests, "{counts:?} and {plain_counts:?}");
}

/// A scene with something for every pass.
const FOR_THE_DUMP: &str = "\
fov 60
background .2 .3 .4
light .9 .9 .9  5 9 2
light 0 0 0  1 1 1
light .5 0 0  -4 3 0
surface .1 .1 .1  .8 .7 .6  0 0 0  1 0
cylinder 9  0 -5  -3 -1
surface .1 0 0  .5 .1 .1  .3 .3 .3  20 .4
sphere -1 0 -5  1
sphere -1 0 -5  1
surface 0 0 .1  0 .2 .9  .2 .2 .2  2.5 0
sphere 1.5 -.25 -5  .75
sphere 1.5 -.25 -5  .5
sphere 0 30 -2  1
surface 1 1 1  .2 .2 .2  0 0 0  0 0
cylinder .25  .2 -3  -1 -.5
write first.png
light 0 0 0  3 3 3
write same.png
sphere 0 0 40 1
write mirrored.png
fov 30
write near.png
background 0 0 0
";

#[test]
fn dumps_keep_their_shape() {
    let source = Source::new("dump.cli", FOR_THE_DUMP);
    let program = ir::validate(compile(&source).program).expect("a sound program");
    let settings = Settings { size: Size::new(320, 240).expect("a size"), ..Settings::default() };
    let mut text = Vec::new();
    dump_plans(&source, &program, &settings, &mut text).expect("written to memory");
    insta::assert_snapshot!("dump", String::from_utf8(text).expect("text"));
    let mut json = Vec::new();
    dump_plans_json(&source, &program, &settings, &mut json).expect("written to memory");
    let json = String::from_utf8(json).expect("text");
    let document: serde_json::Value = serde_json::from_str(&json).expect("one document");
    assert_eq!(document["version"], 1);
    assert_eq!(document["writes"].as_array().expect("a list").len(), 4);
    insta::assert_snapshot!("dump_json", json);
    let mut off = Vec::new();
    let none = Settings { passes: Passes::none(), ..settings };
    dump_plans(&source, &program, &none, &mut off).expect("written to memory");
    insta::assert_snapshot!("dump_off", String::from_utf8(off).expect("text"));
}

/// A scene that grows: every object and light is followed by a `write`.
fn growing(sketch: &Sketch) -> Valid {
    let text = sketch.text();
    let mut lines: Vec<_> = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with("write")) {
        lines.push(line);
        if ["light", "sphere", "cylinder"].iter().any(|name| line.starts_with(name)) {
            lines.push("write a.png");
        }
    }
    let compilation = compile(&Source::new("growing.cli", lines.join("\n")));
    assert!(!compilation.has_errors());
    ir::validate(compilation.program).expect("a sound program")
}

/// Checks that what a later image is said to share with an earlier one, it shares; returns how many pixels that is.
fn assert_changes_hold(title: &str, program: &Valid) -> u64 {
    let settings = settings(Passes::all());
    let mut registers = Registers::default();
    let mut earlier: Option<(Registers, Vec<u8>)> = None;
    let mut n_kept = 0;
    for command in &program.commands {
        registers.step(command);
        if !matches!(command, ir::Command::Write(_)) {
            continue;
        }
        let view = SceneView::new(program, registers);
        let (image, _) = render(view, &settings);
        if let Some((before, old)) = &earlier {
            let changes = plan(view, &settings).changes_since(before);
            for (at, (pixel, old)) in (0..).zip(image.chunks(3).zip(old.chunks(3))) {
                let (column, row) = (at % WIDTH, at / WIDTH);
                let may_change = match &changes {
                    Changes::Nothing => false,
                    Changes::Tiles(mask) => mask.contains(column, row),
                    Changes::Everything => true,
                };
                assert!(may_change || pixel == old, "{title}: pixel ({column}, {row}) changes at {registers:?}");
                n_kept += u64::from(!may_change);
            }
        }
        earlier = Some((registers, image));
    }
    n_kept
}

#[test]
fn pixels_that_cannot_change_do_not() {
    let mut n_kept = 0;
    for family in FAMILIES {
        n_kept += assert_changes_hold(family.name, &growing(&family.sketch(0)));
    }
    for seed in 0..60 {
        n_kept += assert_changes_hold(&format!("nested seed {seed}"), &growing(&nested(seed)));
    }
    assert!(n_kept > 10_000, "only {n_kept} pixels are kept");
}
