//! What a render says it has done and left out, held against rays that are followed one by one.

mod support;

use clisc::plan::{Pass, Passes, Precision, Settings, Size, plan};
use clisc::trace::kernels::Backend;
use clisc::trace::{Counts, Spared, Tracer};

use support::views::{compile, last_view};

const WIDTH: u32 = 96;
const HEIGHT: u32 = 72;

/// Spheres, as centre, radius and reflectance, under point lights.
struct Balls {
    balls: Vec<([f64; 3], f64, f64)>,
    lights: Vec<[f64; 3]>,
}

/// What following every ray through plain numbers takes, without leaving out anything.
#[derive(Clone, Copy, Debug, Default)]
struct Taken {
    /// Reflected rays, by level from 1.
    reflected: [u64; 10],
    hits: u64,
    /// Pairs of a hit and a light that it faces.
    facing: u64,
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

impl Balls {
    fn text(&self) -> String {
        let mut text = String::from("fov 60\nbackground .1 .2 .3\n");
        for [x, y, z] in &self.lights {
            text += &format!("light .5 .4 .3 {x} {y} {z}\n");
        }
        for ([x, y, z], radius, reflectance) in &self.balls {
            text += &format!("surface .02 .03 .04 .3 .2 .1 0 0 0 1 {reflectance}\nsphere {x} {y} {z} {radius}\n");
        }
        text + "write a.png\n"
    }

    /// Returns the number of the ball that a ray meets first, and t; all are met from outside.
    fn meet(&self, origin: [f64; 3], dir: [f64; 3], leaving: Option<usize>) -> Option<(usize, f64)> {
        let roots = self.balls.iter().enumerate().filter(|(i, _)| Some(*i) != leaving).filter_map(|(i, ball)| {
            let m = minus(ball.0, origin);
            let (a, b, power) = (dot(dir, dir), dot(m, dir), dot(m, m) - ball.1 * ball.1);
            let discriminant = b * b - a * power;
            (discriminant >= 0.0 && b > 0.0).then(|| (i, (b - discriminant.sqrt()) / a))
        });
        roots.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    fn follow_all(&self) -> Taken {
        let mut taken = Taken::default();
        let k = libm::tan(std::f64::consts::PI / 6.0);
        for (row, column) in (0..HEIGHT).flat_map(|row| (0..WIDTH).map(move |column| (row, column))) {
            let (width, height) = (f64::from(WIDTH), f64::from(HEIGHT));
            let slope = |steps: f64| steps * k / height;
            let (mut origin, mut leaving) = ([0.0; 3], None);
            let mut dir = [slope(2.0 * f64::from(column) - width), slope(height - 2.0 * f64::from(row)), -1.0];
            for level in 1..10 {
                let Some((i, t)) = self.meet(origin, dir, leaving) else { break };
                let (center, radius, reflectance) = self.balls[i];
                let point: [f64; 3] = std::array::from_fn(|k| origin[k] + t * dir[k]);
                let normal = minus(point, center).map(|c| c / radius);
                taken.hits += 1;
                taken.facing +=
                    self.lights.iter().filter(|light| dot(normal, minus(**light, point)) > 0.0).count() as u64;
                if reflectance == 0.0 {
                    break;
                }
                taken.reflected[level] += 1;
                let twice = 2.0 * dot(normal, dir);
                (origin, leaving) = (point, Some(i));
                dir = std::array::from_fn(|k| dir[k] - twice * normal[k]);
            }
        }
        taken
    }

    fn render(&self, passes: Passes, backend: Option<Backend>) -> (Vec<u8>, Counts, Spared) {
        let program = compile(&self.text());
        let size = Size::new(WIDTH, HEIGHT).expect("a size within the limits");
        let settings = Settings { size, passes, ..Settings::default() };
        let mut rgb = vec![0; (WIDTH * HEIGHT * 3) as usize];
        let counts =
            Tracer::with_backend(plan(last_view(&program), &settings), backend).render_rows(0..HEIGHT, &mut rgb);
        (rgb, counts, counts.spared(self.balls.len() as u64))
    }
}

/// Three balls in each other's light and a large one below.
fn matte() -> Balls {
    Balls {
        balls: vec![
            ([0.3, -101.0, -6.0], 100.0, 0.0),
            ([-1.2, 0.1, -6.0], 0.9, 0.0),
            ([1.3, 0.2, -5.0], 0.7, 0.0),
            ([0.1, 1.3, -7.0], 0.6, 0.0),
        ],
        lights: vec![[4.1, 5.2, 1.3], [-6.3, 2.1, -3.7]],
    }
}

/// Two mirrors, and what they show.
fn mirrors(reflectance: f64) -> Balls {
    Balls {
        balls: vec![
            ([-1.1, 0.1, -4.0], 0.9, reflectance),
            ([1.2, -0.2, -4.3], 0.9, reflectance),
            ([0.1, 1.6, -5.0], 0.5, 0.0),
        ],
        lights: vec![[0.4, 4.2, 1.3]],
    }
}

/// Asserts that a count is that of all rays, or more by what pixels that were settled again took.
#[track_caller]
fn assert_near(count: u64, all: u64, again: u64) {
    assert!(all <= count && count <= all + again, "{count} is not {all} and at most {again} more");
}

#[test]
fn without_passes_every_ray_and_test_is_counted() {
    for (balls, n_mirrors) in [(matte(), 0), (mirrors(0.6), 2)] {
        let (taken, n_objects, n_lights) = (balls.follow_all(), balls.balls.len() as u64, balls.lights.len() as u64);
        let n_reflected: u64 = taken.reflected.iter().sum();
        assert_eq!(n_reflected > 0, n_mirrors > 0);
        let n_pixels = u64::from(WIDTH * HEIGHT);
        // One by one, and none of them twice.
        let (_, counts, spared) = balls.render(Passes::none(), None);
        assert_eq!((counts.settled_pixels, counts.refined_pixels), (n_pixels, 0));
        assert_eq!((counts.eye_rays, counts.reflected_rays), (n_pixels, n_reflected));
        assert_eq!((counts.lightings, counts.shadow_rays), (taken.hits * n_lights, taken.facing));
        assert_eq!(counts.reflected_tests, n_reflected * n_objects);
        assert_eq!(counts.shadow_tests, taken.facing * n_objects);
        assert_eq!(counts.tests, (n_pixels + n_reflected + taken.facing) * n_objects);
        assert_eq!(spared.shadow_rays_not_cast, taken.hits * n_lights - taken.facing);
        assert_eq!(spared.shadow_tests_not_made, spared.shadow_rays_not_cast * n_objects);
        assert_eq!((spared.reflected_rays_not_cast, spared.reflected_tests_not_made), (0, 0));
        // In packets some pixels are left, and traced again.
        let (_, counts, spared) = balls.render(Passes::none(), Some(Backend::best()));
        let again = 10 * n_lights * counts.settled_pixels;
        assert!(counts.settled_pixels < 100, "{counts:?}");
        assert_near(counts.reflected_rays, n_reflected, again);
        assert_near(counts.lightings, taken.hits * n_lights, again);
        assert_near(counts.shadow_rays, taken.facing, again);
        assert_near(spared.shadow_rays_not_cast + counts.shadow_rays, taken.hits * n_lights, again);
        assert!(counts.shadow_tests >= counts.shadow_rays && counts.shadow_tests < counts.shadow_rays * n_objects);
    }
}

#[test]
fn what_is_left_out_is_counted() {
    for (balls, n_mirrors) in [(matte(), 0), (mirrors(0.6), 2)] {
        let (taken, n_objects, n_lights) = (balls.follow_all(), balls.balls.len() as u64, balls.lights.len() as u64);
        for backend in [None, Some(Backend::Scalar), Some(Backend::best())] {
            let (_, counts, spared) = balls.render(Passes::all(), backend);
            let again = if backend.is_some() { 10 * n_lights * counts.settled_pixels } else { 0 };
            assert_near(counts.lightings, taken.hits * n_lights, again);
            assert!(counts.shadow_rays < taken.facing, "nothing lies before some lights");
            assert_eq!(counts.shadow_rays + spared.shadow_rays_not_cast, counts.lightings);
            assert_eq!(counts.shadow_tests + spared.shadow_tests_not_made, counts.lightings * n_objects);
            assert_eq!(counts.reflected_tests + spared.reflected_tests_not_made, counts.reflected_rays * n_objects);
            assert!(n_mirrors == 0 || spared.reflected_tests_not_made > 0, "no mirror shows itself");
        }
    }
}

#[test]
fn the_tiles_of_a_face_take_fewer_shadow_rays_than_the_whole() {
    let balls = matte();
    let one_by_one = balls.render(Passes::all(), None).1;
    let packets = balls.render(Passes::all(), Some(Backend::best())).1;
    assert!(4 * packets.shadow_rays < 3 * one_by_one.shadow_rays, "{packets:?} {one_by_one:?}");
}

/// Of mirrors that reflect little the second reflection weighs a quarter of a level.
#[test]
fn rays_that_cannot_change_the_pixel_are_not_cast() {
    let balls = mirrors(0.03);
    let taken = balls.follow_all();
    let all = Some(Backend::best());
    let (image, counts, spared) = balls.render(Passes::all(), all);
    let (plain, plain_counts, plain_spared) = balls.render(Passes::all().without(Pass::Bounces), all);
    assert!(image == plain);
    let again = 10 * counts.settled_pixels;
    assert_near(plain_counts.reflected_rays, taken.reflected.iter().sum(), again);
    assert_eq!(plain_spared.reflected_rays_not_cast, 0);
    assert!(taken.reflected[2] > 50 && spared.reflected_rays_not_cast * 3 > taken.reflected[2], "{spared:?} {taken:?}");
    assert!(spared.reflected_rays_not_cast <= taken.reflected[2]);
    // What goes on is followed to its end.
    let n_asked = counts.reflected_rays + spared.reflected_rays_not_cast;
    assert!(taken.reflected[1] + taken.reflected[2] <= n_asked && n_asked <= plain_counts.reflected_rays);
}

/// Two lights on a white surface, the first of which fills all channels where it shines straight on.
#[test]
fn lights_on_full_channels_take_no_rays() {
    let text = "fov 60\nlight 2 2 2 0 0 4\nlight 1 1 1 3 0 4\nsurface .5 .5 .5 .8 .8 .8 0 0 0 1 0\n\
                sphere 0 0 -5 2\nsphere .7 0 -2 .1\nwrite a.png\n";
    let program = compile(text);
    let render = |passes: Passes| {
        let size = Size::new(WIDTH, HEIGHT).expect("a size within the limits");
        let mut rgb = vec![0; (WIDTH * HEIGHT * 3) as usize];
        let plan = plan(last_view(&program), &Settings { size, passes, ..Settings::default() });
        let counts = Tracer::new(plan).render_rows(0..HEIGHT, &mut rgb);
        (rgb, counts)
    };
    let others = Pass::ALL.into_iter().filter(|pass| *pass != Pass::Saturation);
    let kept = others.fold(Passes::all(), Passes::without);
    let ((image, counts), (plain, plain_counts)) = (render(kept), render(Passes::none()));
    assert!(image == plain);
    assert!(10 * counts.shadow_rays < 8 * plain_counts.shadow_rays, "{counts:?} {plain_counts:?}");
    assert_eq!(counts.lightings, plain_counts.lightings);
}

/// What the pass `terms` takes out of surfaces is neither cast nor tested nor counted as work: a mirror that is white whatever it
/// shows, a surface that no light reaches, and a light that adds nothing to the one that is left.
#[test]
fn terms_that_add_nothing_take_no_rays() {
    let text = "fov 60\nlight 1 0 0 0 4 4\nlight 1 1 0 3 0 4\n\
                surface 1 1 1 .5 .5 .5 .2 .2 .2 9 .5\nsphere -1.2 0 -5 1\n\
                surface .1 .1 .1 0 0 .8 0 0 .5 9 0\nsphere 1.2 0 -5 1\n\
                surface .1 .1 .1 0 .8 0 0 0 0 1 0\nsphere 0 1.5 -5 .9\nsphere 0 -1.5 -5 .9\nwrite a.png\n";
    let program = compile(text);
    let size = Size::new(WIDTH, HEIGHT).expect("a size within the limits");
    for (precision, backend) in [
        (Precision::F64, None),
        (Precision::F64, Some(Backend::Scalar)),
        (Precision::F64, Some(Backend::best())),
        (Precision::F32, Some(Backend::best())),
    ] {
        let render = |passes: Passes| {
            let mut rgb = vec![0; (WIDTH * HEIGHT * 3) as usize];
            let settings = Settings { size, passes, precision, ..Settings::default() };
            let plan = plan(last_view(&program), &settings);
            let n_terms = plan.savings().terms_not_computed;
            let counts = Tracer::with_backend(plan, backend).render_rows(0..HEIGHT, &mut rgb);
            (rgb, counts, n_terms)
        };
        let only = Pass::ALL.into_iter().filter(|pass| *pass != Pass::Terms).fold(Passes::all(), Passes::without);
        for (with, without) in [(Passes::all(), Passes::all().without(Pass::Terms)), (only, Passes::none())] {
            let ((image, counts, n_terms), (plain, more, none)) = (render(with), render(without));
            assert!(image == plain, "{precision:?} {backend:?}");
            assert_eq!((n_terms, none), (5, 0), "all of the mirror's, and both of the blue surface");
            assert_eq!(counts.reflected_rays, 0, "{counts:?}");
            assert!(more.reflected_rays > 100, "{more:?}");
            assert!(2 * counts.lightings < more.lightings, "{counts:?} {more:?}");
            assert!(2 * counts.shadow_rays < more.shadow_rays, "{counts:?} {more:?}");
            assert!(counts.tests < more.tests, "{counts:?} {more:?}");
        }
    }
}
