//! Metamorphic laws: what is done to a scene, and what must then hold of its image, without a word on what the image is.
//!
//! Every law holds exactly, because the image is that of exact arithmetic: a sum does not depend on its order, nor a scene
//! on its unit. Scenes come from proptest, which makes a failing one small, and from the [families]. Lengths of the former
//! are multiples of 1/64, colours of 1/256, so that no change makes a rounding of its own.
//!
//! `CLISC_SWEEP=N cargo test --test metamorphic` takes N random scenes for each law, from another seed.

mod families;

use clisc::plan::{Settings, Size, plan};
use clisc::trace::Tracer;
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestCaseResult, TestRunner};

use families::sketch::{Finish, Sketch};
use families::{FAMILIES, WITHOUT_TIES};

/// A size of several packets and a rest, with as many rows above the middle as below.
const SIZE: [usize; 2] = [28, 20];

/// The size where an image is turned.
const SQUARE: [usize; 2] = [24, 24];

/// Random scenes for each law in an ordinary run.
const N_CASES: u32 = 48;

/// Row by row from the top.
type Image = Vec<[u8; 3]>;

fn config() -> ProptestConfig {
    let sweep = std::env::var("CLISC_SWEEP").ok().map(|n| n.parse().expect("CLISC_SWEEP is a number of scenes"));
    let seed = sweep.map_or(RngSeed::Fixed(4), |_| RngSeed::Random);
    let cases = sweep.unwrap_or(N_CASES);
    ProptestConfig { cases, rng_seed: seed, failure_persistence: None, ..ProptestConfig::default() }
}

/// Holds a law against random scenes.
fn for_all(scenes: impl Strategy<Value = Sketch>, law: impl Fn(&Sketch) -> TestCaseResult) {
    TestRunner::new(config()).run(&scenes, |scene| law(&scene)).unwrap_or_else(|failure| panic!("{failure}"));
}

/// Returns a length: a multiple of 1/64 in sixty-fourths from `low` to `high`.
fn length(low: i32, high: i32) -> impl Strategy<Value = f64> {
    (low..=high).prop_map(|n| f64::from(n) / 64.0)
}

fn color(high: i32) -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3((0..=high).prop_map(|n| f64::from(n) / 256.0))
}

fn finish() -> impl Strategy<Value = Finish> {
    let shininess = prop::sample::select(vec![0.0, 1.0, 2.5, 20.0]);
    let reflectance = prop::sample::select(vec![0.0, 0.0, 0.25, 0.75]);
    (color(64), color(200), color(160), shininess, reflectance).prop_map(
        |(ambient, diffuse, specular, shininess, reflectance)| Finish {
            ambient,
            diffuse,
            specular,
            shininess,
            reflectance,
        },
    )
}

/// A place in front of the eye or beside it.
fn place() -> impl Strategy<Value = [f64; 3]> {
    (length(-192, 192), length(-128, 128), length(-512, -32)).prop_map(|(x, y, z)| [x, y, z])
}

/// An object, told by numbers: whether it is a sphere, where it is, how large and how high.
type Object = (bool, [f64; 3], f64, f64);

/// Returns scenes of a few lights and objects, the eye anywhere among them.
fn dyadic_scene() -> impl Strategy<Value = Sketch> {
    dyadic_scene_seen_at(&[30.0, 60.0, 90.0, 120.0])
}

fn dyadic_scene_seen_at(fovs_deg: &'static [f64]) -> impl Strategy<Value = Sketch> {
    let lights = prop::collection::vec((color(160), place(), length(-64, 512)), 1..4);
    let object = (any::<bool>(), place(), length(4, 120), length(1, 200));
    let objects = prop::collection::vec((finish(), object), 1..7);
    let fov_deg = prop::sample::select(fovs_deg);
    (fov_deg, color(256), lights, objects).prop_map(|(fov_deg, background, lights, objects)| {
        let mut scene = Sketch::new(fov_deg, background);
        for (color, [x, y, z], nearer) in lights {
            scene.light(color, [x, y + 1.0, z + nearer]);
        }
        for (finish, object) in objects {
            add(scene.surface(finish), object);
        }
        scene
    })
}

fn add(scene: &mut Sketch, (is_sphere, [x, y, z], size, height): Object) {
    if is_sphere {
        scene.sphere([x, y, z], size);
    } else {
        scene.cylinder(size, [x, z], [y, y + height]);
    }
}

/// Returns scenes of any kind: simple ones, and those of the families.
fn any_scene() -> impl Strategy<Value = Sketch> {
    let of_family = (0..FAMILIES.len(), 0..1000_u64).prop_map(|(family, seed)| FAMILIES[family].sketch(seed));
    prop_oneof![dyadic_scene(), of_family]
}

/// Returns scenes in which no ray leaves a point of two surfaces: it might lead into one of them, and so see its inside.
/// The eye rays of these angles meet no point of the dyadic ones where two surfaces do.
fn scene_without_contacts() -> impl Strategy<Value = Sketch> {
    let of_family = (prop::sample::select(&WITHOUT_TIES), 0..1000_u64).prop_map(|(name, seed)| {
        FAMILIES.iter().find(|family| family.name == name).expect("a family of this name").sketch(seed)
    });
    prop_oneof![dyadic_scene_seen_at(&[31.0, 55.5, 111.0]), of_family]
}

fn render(scene: &Sketch, [width, height]: [usize; 2]) -> Image {
    let size = Size::new(width as u32, height as u32).expect("a size within the limits");
    let mut rgb = vec![0; width * height * 3];
    let made = scene.make();
    let settings = Settings { size, ..Settings::default() };
    Tracer::new(plan(made.view(), &settings)).render_rows(0..height as u32, &mut rgb);
    rgb.as_chunks().0.to_vec()
}

/// Asks that a changed scene has, at each place that `from` knows, the pixel that the scene has where `from` says.
fn expect_moved(
    scene: &Sketch,
    changed: &Sketch,
    [width, height]: [usize; 2],
    from: impl Fn(usize, usize) -> Option<[usize; 2]>,
) -> TestCaseResult {
    let [image, other] = [scene, changed].map(|scene| render(scene, [width, height]));
    for (i, pixel) in other.iter().enumerate() {
        let Some([column, row]) = from(i % width, i / width) else { continue };
        let expected = image[row * width + column];
        prop_assert_eq!(
            *pixel,
            expected,
            "pixel ({}, {}) of the changed scene\n{}",
            i % width,
            i / width,
            changed.text()
        );
    }
    Ok(())
}

fn expect_same(scene: &Sketch, changed: &Sketch) -> TestCaseResult {
    expect_moved(scene, changed, SIZE, |column, row| Some([column, row]))
}

#[test]
fn a_power_of_two_does_not_change_the_image() {
    for_all(any_scene(), |scene| {
        for exponent in [-300, -171, -1, 5, 200, 300] {
            let factor = f64::from_bits(((1023 + exponent) as u64) << 52);
            let scaled = scene.map_lengths(|length| length * factor);
            // Beyond the normal numbers it would be another scene.
            if scaled.is_normal() {
                expect_same(scene, &scaled)?;
            }
        }
        Ok(())
    });
}

/// Lengths of 13 bits times factors of 14 are exact.
#[test]
fn no_factor_changes_the_image_if_it_rounds_nothing() {
    for_all(dyadic_scene(), |scene| {
        for factor in [3.0, 10.0, 1000.0, 12_345.0, 0.6875, 1e9] {
            let scaled = scene.map_lengths(|length| length * factor);
            let back = scaled.map_lengths(|length| length / factor);
            prop_assert_eq!(back.text(), scene.text(), "a rounding");
            expect_same(scene, &scaled)?;
        }
        Ok(())
    });
}

#[test]
fn a_cylinder_in_two_halves_is_the_same_cylinder() {
    for_all(scene_without_contacts(), |scene| expect_same(scene, &scene.with_split_cylinders()));
}

#[test]
fn what_is_inside_of_an_object_is_not_seen() {
    for_all(scene_without_contacts(), |scene| expect_same(scene, &scene.with_hidden_balls()));
}

#[test]
fn a_black_light_changes_nothing() {
    for_all(any_scene(), |scene| {
        // Far away too, where it would outgrow the scene by more than squares can bear.
        for distance in [1.0, 1e120] {
            let mut lit = scene.clone();
            lit.light([0.0; 3], [0.3, 0.7, -1.1].map(|length| length * distance * scene.largest_length()));
            expect_same(scene, &lit)?;
        }
        Ok(())
    });
}

#[test]
fn two_lights_of_half_the_colour_are_one_light() {
    for_all(any_scene(), |scene| expect_same(scene, &scene.with_halved_lights()));
}

#[test]
fn twice_the_light_on_half_the_surface_is_the_same() {
    for_all(any_scene(), |scene| expect_same(scene, &scene.with_brighter_lights()));
}

/// Samples lie on the left edge of a pixel: column i mirrors column W − i, and column 0 has no counterpart.
#[test]
fn a_mirrored_scene_gives_a_mirrored_image() {
    for_all(any_scene(), |scene| {
        expect_moved(scene, &scene.mirrored(), SIZE, |column, row| (column > 0).then(|| [SIZE[0] - column, row]))
    });
}

/// Samples lie on the upper edge of a pixel: row j mirrors row H − j, and row 0 has no counterpart.
#[test]
fn a_scene_upside_down_gives_an_image_upside_down() {
    for_all(any_scene(), |scene| {
        expect_moved(scene, &scene.upside_down(), SIZE, |column, row| (row > 0).then(|| [column, SIZE[1] - row]))
    });
}

/// The ray of column i and row j has x and y in proportion to 2i − N and N − 2j. Turned, they are −y and x: what is in
/// column i and row j comes to column j and row N − i, so a pixel of column i and row j comes from column N − j and row i.
#[test]
fn a_quarter_turn_of_spheres_turns_the_image() {
    let n = SQUARE[0];
    for_all(any_scene(), |scene| {
        let from = |column: usize, row: usize| (row > 0).then(|| [n - row, column]);
        expect_moved(&scene.spheres_alone(), &scene.quarter_turned(), SQUARE, from)
    });
}
