//! What checks `exact` itself: pixels that can be computed by hand.
//!
//! Its numbers are held against far more bits in `src/exact/ball/tests.rs`; that its pixels do not depend on the precision
//! it starts with, nor on its filter, and that it paints the original images, stands in `tests/exactness.rs`.

mod support;

use std::sync::atomic::{AtomicU32, Ordering};

use clisc::exact::{LADDER, Part, Pixel, Record, Renderer, SampleAt, Settings, Tie};

use support::views::{compile, last_view};

/// With a field of view of 90 degrees and 4×4 pixels the eye ray of a pixel is ((i − 2)/2, (2 − j)/2, −1), all exact.
fn pixel_of(text: &str, column: u32, row: u32) -> [u8; 3] {
    let program = compile(&format!("fov 90\n{text}\nwrite i.png\n"));
    let settings = Settings { width: 4, height: 4, ..Settings::default() };
    let pixel = Renderer::new(last_view(&program), &settings).pixel(column, row);
    assert_eq!(pixel.open_ties.total(), 0, "{text}: {:?}", pixel.open_ties);
    pixel.rgb
}

#[test]
fn what_meets_nothing_is_background() {
    assert_eq!(pixel_of("background .2 .4 1", 2, 2), [51, 102, 255]);
    assert_eq!(pixel_of("background .2 .4 7\nsurface 1 1 1 0 0 0 0 0 0 1 0\nsphere 0 0 4 1", 2, 2), [51, 102, 255]);
}

#[test]
fn a_light_before_a_sphere_lights_it_fully() {
    // The ray (0, 0, −1) meets (0, 0, −3), where the normal, L, V and H are all (0, 0, 1): .1 + .5 + .2 = .8.
    let text = "light 1 1 1 0 0 5\nsurface .1 .1 .1 .5 .5 .5 .2 .2 .2 17.3 0\nsphere 0 0 -4 1";
    assert_eq!(pixel_of(text, 2, 2), [204; 3]);
}

#[test]
fn a_light_aside_lights_by_the_cosines() {
    // L = (0, 4, 3)/5, so n·L = .6; H = (0, .8, 1.6)/√3.2, so n·H = 2/√5, of which the square is .8.
    let diffuse = "light 1 1 1 0 4 0\nsurface 0 0 0 1 .5 0 0 0 0 1 0\nsphere 0 0 -4 1";
    assert_eq!(pixel_of(diffuse, 2, 2), [153, 76, 0]);
    let specular = "light 1 1 1 0 4 0\nsurface 0 0 0 .5 0 0 .25 .25 1 2 0\nsphere 0 0 -4 1";
    assert_eq!(pixel_of(specular, 2, 2), [127, 51, 204]);
    // (n·H)^(1/2) = (4/5)^(1/4) = .94574…, and (n·H)^P → 0.
    let root = "light 1 1 1 0 4 0\nsurface 0 0 0 0 0 0 1 1 1 .5 0\nsphere 0 0 -4 1";
    assert_eq!(pixel_of(root, 2, 2), [241; 3]);
    let steep = "light 1 1 1 0 4 0\nsurface .2 .2 .2 0 0 0 1 1 1 1e300 0\nsphere 0 0 -4 1";
    assert_eq!(pixel_of(steep, 2, 2), [51; 3]);
}

#[test]
fn what_lies_between_casts_a_shadow_and_what_lies_beyond_does_not() {
    let ball = "surface .2 .2 .2 .4 .4 .4 0 0 0 1 0\nsphere 0 0 -4 1\n";
    assert_eq!(pixel_of(&format!("light 1 1 1 0 0 5\n{ball}"), 2, 2), [153; 3]);
    assert_eq!(pixel_of(&format!("light 1 1 1 0 0 5\n{ball}sphere 0 0 2 1"), 2, 2), [51; 3]);
    assert_eq!(pixel_of(&format!("light 1 1 1 0 0 5\n{ball}sphere 0 0 8 1"), 2, 2), [153; 3]);
    // The light on the far side of the ball itself, and inside of it.
    assert_eq!(pixel_of(&format!("light 1 1 1 0 0 -9\n{ball}"), 2, 2), [51; 3]);
    assert_eq!(pixel_of(&format!("light 1 1 1 0 0 -4\n{ball}"), 2, 2), [51; 3]);
}

#[test]
fn two_mirrors_add_up_a_geometric_series_of_nine_terms() {
    // .08 · (1 + .9 + … + .9⁸) = .8 · (1 − .9⁹) = .490063…; the ray of level 9 meets a mirror and gives black.
    let mirrors = "surface .08 .08 .08 0 0 0 0 0 0 1 .9\nsphere 0 0 -4 1\nsphere 0 0 4 1";
    assert_eq!(pixel_of(mirrors, 2, 2), [124; 3]);
    let one = "background .4 .4 .4\nsurface 0 0 0 0 0 0 0 0 0 1 .5\nsphere 0 0 -4 1";
    assert_eq!(pixel_of(one, 2, 2), [51; 3]);
}

#[test]
fn a_cylinder_has_caps_and_a_wall() {
    // Row 3: the ray (0, −½, −1) meets the plane y = −1 at (0, −1, −2), right below the light.
    let cap = "light 1 1 1 0 3 -2\nsurface 0 0 0 .6 .6 .6 0 0 0 1 0\ncylinder 10 0 -2 -3 -1";
    assert_eq!(pixel_of(cap, 2, 3), [153; 3]);
    // The wall at (0, 0, −3) looks to the eye.
    let wall = "light 1 1 1 0 0 1\nsurface 0 0 0 .6 .6 .6 0 0 0 1 0\ncylinder 1 0 -4 -1 1";
    assert_eq!(pixel_of(wall, 2, 2), [153; 3]);
    // Above its upper rim at z = −3 the ray (0, ½, −1) is at 1.5; within it comes down nowhere.
    assert_eq!(pixel_of(wall, 2, 1), [0; 3]);
    // From inside the normal is turned: the eye and the light in one cylinder.
    let inside = "light 1 1 1 0 0 0\nsurface 0 0 0 .6 .6 .6 0 0 0 1 0\ncylinder 5 0 0 -1 1";
    assert_eq!(pixel_of(inside, 2, 2), [153; 3]);
}

#[test]
fn of_coincident_objects_the_first_is_met() {
    let copies = "surface 1 0 0 0 0 0 0 0 0 1 0\nsphere 0 0 -4 1\nsurface 0 1 0 0 0 0 0 0 0 1 0\nsphere 0 0 -4 1";
    assert_eq!(pixel_of(copies, 2, 2), [255, 0, 0]);
    // Another equation, the same point: (0, 0, −3) of a cylinder and of a sphere, proved equal by exact numbers.
    let touching =
        "surface 1 0 0 0 0 0 0 0 0 1 0\ncylinder 1 0 -4 -1 1\nsurface 0 1 0 0 0 0 0 0 0 1 0\nsphere 0 0 -5 2";
    assert_eq!(pixel_of(touching, 2, 2), [255, 0, 0]);
}

#[test]
fn part_a_knows_neither_cylinders_nor_shadows() {
    let text = "fov 90\nlight 1 1 1 0 4 0\nsurface .9 .9 .9 1 .5 0 1 1 1 1 .5\ncylinder 1 0 -2 -1 1\nsphere 0 0 -4 1\n\
                sphere 0 3 -1 .5\nwrite i.png\n";
    let program = compile(text);
    let settings = Settings { width: 4, height: 4, part: Part::A, ..Settings::default() };
    assert_eq!(Renderer::new(last_view(&program), &settings).pixel(2, 2).rgb, [153, 76, 0]);
}

#[test]
fn samples_are_averaged_about_the_sample_point() {
    // At the left half of the image white, at the right black: the four samples about the corner in the middle are two
    // and two; about the centre of the pixel to its right all are black.
    let text = "fov 90\nsurface 1 1 1 0 0 0 0 0 0 1 0\nsphere -1e6 0 -1 1e6\nwrite i.png\n";
    let program = compile(text);
    let at = |sample_at| {
        let settings = Settings { width: 4, height: 4, samples: 2, sample_at, ..Settings::default() };
        Renderer::new(last_view(&program), &settings).pixel(2, 2).rgb
    };
    assert_eq!(at(SampleAt::Corner), [127; 3]);
    assert_eq!(at(SampleAt::Centre), [0; 3]);
}

/// With k² = 1/3 some eye rays touch this ball; no finite precision can tell, but algebra can.
const TOUCHED: &str = "fov 60\nlight 1 1 1 0 0 5\nsurface 0 .2 0 .4 .1 .1 0 0 0 1 0\nsphere 0 0 -4 1\nwrite i.png\n";

#[test]
fn ties_are_listed_with_their_places() {
    let program = compile(TOUCHED);
    let renderer = Renderer::new(last_view(&program), &Settings::default());
    let mut rgb = vec![0; 300 * 3];
    let record = renderer.render_rows(84..85, &mut rgb, &|| false);
    let places: Vec<_> = record.ties.iter().map(|place| (place.column, place.row)).collect();
    assert_eq!(places, [(138, 84), (162, 84)]);
    assert!(record.ties.iter().all(|place| place.proved.of(Tie::Tangent) == 1 && place.n_ties() == 1));
    assert_eq!(record.n_pixels, [(LADDER[0], 298), (LADDER[1], 2)].into());
    assert_eq!((record.n_tied_pixels, record.n_open_pixels, record.n_ties, record.n_pixels()), (2, 0, 2, 300));
}

const MIRROR: &str = "fov 50\nlight 1 1 1 0 5 5\nsurface .1 .1 .1 0 0 0 0 0 0 1 .5\nsphere 0 0 -14 1\n";
const HALL: &str = "light 1 1 1 0 .5 -2\nsurface .1 .1 .1 0 0 0 0 0 0 1 .9\nsphere 0 .2 1 10\n";
const TWINS_BEHIND: &str = "surface .2 .2 .2 .5 .5 .5 0 0 0 1 0\nsphere -.3 .1 4 1\nsphere .3 .1 4 1\n";

#[test]
fn a_tie_beyond_algebra_takes_every_bit_and_stays_open() {
    // Two balls that are each other's mirror image meet every ray of the middle column at the same t: here after so many
    // bounces on the wall about them that the numbers are too long.
    let hall = format!("fov 50\n{HALL}{}", TWINS_BEHIND.replace(" 4 1", " 5 1"));
    let program = compile(&format!("{hall}write i.png\n"));
    let settings = Settings { width: 40, height: 30, ..Settings::default() };
    let renderer = Renderer::new(last_view(&program), &settings);
    let (tied, beside) = (renderer.pixel(20, 26), renderer.pixel(21, 26));
    assert!(tied.open_ties.of(Tie::Order) > 0 && tied.bits == LADDER[LADDER.len() - 1], "{tied:?}");
    assert_eq!((beside.open_ties.total(), beside.bits), (0, LADDER[0]));
    let mut record = Record::default();
    record.add(20, 26, &tied);
    assert_eq!((record.n_open_pixels, record.ties[0].open), (1, tied.open_ties));
}

/// Returns a pixel of 40×30, of which every tie is proved, with the ties that took algebra.
fn pixel_by_algebra(text: &str, column: u32, row: u32) -> (Pixel, Vec<(Tie, u32)>) {
    let program = compile(&format!("{text}write i.png\n"));
    let settings = Settings { width: 40, height: 30, ..Settings::default() };
    let pixel = Renderer::new(last_view(&program), &settings).pixel(column, row);
    assert_eq!((pixel.open_ties.total(), pixel.bits), (0, LADDER[1]), "{text}{pixel:?}");
    let ties = pixel.algebraic_ties.met().collect();
    (pixel, ties)
}

#[test]
fn twins_are_proved_to_be_met_at_once() {
    // Before the eye, and in a mirror between them; whatever tan 25° is.
    let before = format!("fov 50\nlight 1 1 1 0 5 5\n{}", TWINS_BEHIND.replace(" 4 1", " -4 1"));
    assert_eq!(pixel_by_algebra(&before, 20, 14).1, [(Tie::Order, 1)]);
    assert_eq!(pixel_by_algebra(&format!("{MIRROR}{TWINS_BEHIND}"), 20, 15).1, [(Tie::Order, 1)]);
}

#[test]
fn equators_are_proved_to_lie_on_walls() {
    // The ball closes the tube: their circle in the plane of the eye is met by the whole middle row.
    let capsule = "light 1 1 1 0 5 5\nsurface .1 .1 .1 .5 .5 .5 0 0 0 1 0\ncylinder 1 .1 -4 -2 0\nsphere .1 0 -4 1\n";
    let (pixel, ties) = pixel_by_algebra(&format!("fov 47.5\n{capsule}"), 22, 15);
    assert!(ties.iter().any(|(tie, _)| *tie == Tie::Order), "{pixel:?}");
}

#[test]
fn shadows_that_touch_are_proved_to() {
    // Two columns touch each other along x = 0, z = -4; seen from there is a floor, lit by a light over the same line.
    let columns = "light 1 1 1 0 3 -6\nsurface .2 .2 .2 .8 .8 .8 0 0 0 1 0\ncylinder 9 0 -4 -2 -1\n\
                   cylinder 1 -1 -4 -1 2\ncylinder 1 1 -4 -1 2\n";
    for fov in [60.0, 50.0] {
        let (pixel, ties) = pixel_by_algebra(&format!("fov {fov}\n{columns}"), 20, 29);
        assert_eq!((pixel.rgb, &*ties), ([51; 3], &[(Tie::Tangent, 1)][..]), "{pixel:?}");
    }
}

/// The ground of an original scene: eye rays meet its rim exactly in three of 300×300 pixels.
#[test]
fn rims_are_proved_to_be_met() {
    let program = |radius: f64| {
        let ground = format!("surface .2 .2 .2 .8 .8 .8 0 0 0 1 0\ncylinder {radius} 0 0 -2 -1");
        compile(&format!("fov 60\nbackground 0 0 1\n{ground}\nwrite i.png\n"))
    };
    let pixel_at = |radius: f64, [column, row]: [u32; 2]| {
        Renderer::new(last_view(&program(radius)), &Settings::default()).pixel(column, row)
    };
    for place in [[140, 176], [160, 176], [0, 180]] {
        let pixel = pixel_at(10.0, place);
        assert_eq!((pixel.algebraic_ties.of(Tie::Rim), pixel.open_ties.total(), pixel.bits), (2, 0, LADDER[1]));
        // By a last bit more or less the ray meets the cap, or the wall from inside.
        for radius in [10_f64.next_up(), 10_f64.next_down()] {
            let pixel = pixel_at(radius, place);
            let n_ties = pixel.proved_ties.total() + pixel.algebraic_ties.total() + pixel.open_ties.total();
            assert_eq!(n_ties, 0, "{radius} {place:?} {pixel:?}");
        }
    }
}

/// In steps an eye ray goes along (X√w, Y√w, −M), and touches a ball where b² = a·p; see `src/exact/grid.rs`.
#[test]
fn rays_that_touch_are_proved_to_for_60_90_and_120_degrees() {
    for (fov, [width, height], [column, row], body) in [
        // X = 2, Y = 0, M = 12: b² = 144 · 169, a = 156, p = 36 + 169 − 49.
        (60, [4, 4], [3, 2], "sphere 0 6 -13 7"),
        // X = 2, Y = 0, M = 4: b² = 16 · 196, a = 28, p = 16 + 196 − 100.
        (120, [4, 4], [3, 2], "sphere 0 4 -14 10"),
        // X = 1, M = 12: b² = 144 · 49, a = 147, p = 49 − 1.
        (60, [5, 4], [3, 2], "cylinder 1 0 -7 -1 1"),
        // X = −4, M = 3: b = 4 + 21, a = 25, p = 1 + 49 − 25.
        (90, [4, 3], [0, 1], "cylinder 5 -1 -7 -2 2"),
    ] {
        let program = compile(&format!("fov {fov}\nsurface 1 1 1 0 0 0 0 0 0 1 0\n{body}\nwrite i.png\n"));
        let settings = Settings { width, height, ..Settings::default() };
        let pixel = Renderer::new(last_view(&program), &settings).pixel(column, row);
        assert!(pixel.rgb == [255; 3] && pixel.bits <= LADDER[1], "{body}: {pixel:?}");
        assert_eq!((n_touching(&pixel), pixel.open_ties.total()), (1, 0), "{body}: {pixel:?}");
    }
}

fn n_touching(pixel: &Pixel) -> u32 {
    pixel.proved_ties.of(Tie::Tangent) + pixel.algebraic_ties.of(Tie::Tangent)
}

#[test]
fn rays_that_almost_touch_are_not_taken_to() {
    // Those of above, and the same a last bit nearer or further.
    for (fov, [width, height], [column, row], center, radius) in [
        (60, [4, 4], [3, 2], "0 6 -13", 7.0),
        (120, [4, 4], [3, 2], "0 4 -14", 10.0),
        (60, [300, 300], [138, 84], "0 0 -4", 1.0),
    ] {
        for (radius, expected) in [(f64::next_down(radius), [0; 3]), (f64::next_up(radius), [255; 3])] {
            let text = format!("fov {fov}\nsurface 1 1 1 0 0 0 0 0 0 1 0\nsphere {center} {radius}\nwrite i.png\n");
            let program = compile(&text);
            let settings = Settings { width, height, ..Settings::default() };
            let pixel = Renderer::new(last_view(&program), &settings).pixel(column, row);
            assert_eq!((pixel.rgb, n_touching(&pixel), pixel.open_ties.total()), (expected, 0, 0), "{text}{pixel:?}");
        }
    }
}

#[test]
fn rows_do_not_depend_on_how_they_are_cut() {
    let program = compile(TOUCHED);
    let settings = Settings { width: 37, height: 20, ..Settings::default() };
    let renderer = Renderer::new(last_view(&program), &settings);
    let (image, record) = renderer.image();
    let (mut cut, mut merged) = (Vec::new(), Record::default());
    for rows in [0..1, 1..13, 13..20] {
        let mut rgb = vec![0; rows.len() * 37 * 3];
        merged.merge(renderer.render_rows(rows, &mut rgb, &|| false));
        cut.extend(rgb);
    }
    assert_eq!((image.rgb(), &record), (&*cut, &merged));
}

#[test]
fn a_cancelled_render_ends_soon() {
    let program = compile(TOUCHED);
    let renderer = Renderer::new(last_view(&program), &Settings::default());
    let asked = AtomicU32::new(0);
    let is_cancelled = || asked.fetch_add(1, Ordering::Relaxed) >= 100;
    let record = renderer.render_rows(0..300, &mut vec![0; 300 * 300 * 3], &is_cancelled);
    assert!(record.n_pixels() <= 100, "{}", record.n_pixels());
}
