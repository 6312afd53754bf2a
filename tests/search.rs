//! What is left out of a search changes no pixel: scenes of many objects, with and without the passes.

mod families;

use clisc::plan::{Passes, Search, Settings, Size, plan};
use clisc::testing::Stream;
use clisc::trace::Tracer;

use families::sketch::{Finish, Sketch};

const WIDTH: u32 = 40;
const HEIGHT: u32 = 30;

/// What a crowd is like.
#[derive(Clone, Copy, Debug)]
struct Crowd {
    n_objects: usize,
    /// The size of the smallest and of the largest objects.
    sizes: [f64; 2],
    /// How closely they are packed: 1 for not at all.
    cluster: f64,
    /// Where they lie along the view.
    depths: [f64; 2],
    /// One object in so many is a cylinder.
    cylinders: usize,
    /// The radius of a sphere around the eye, 0 for none.
    around: f64,
}

fn sketch(crowd: &Crowd, stream: &mut Stream) -> Sketch {
    let mut sketch = Sketch::new(60.0, [0.2, 0.3, 0.5]);
    for position in [[3.0, 4.0, 1.0], [-0.3, 0.2, -3.0], [0.0, 0.0, 0.0], [0.0, -9.0, -4.0]] {
        sketch.light([0.4, 0.3, 0.2], position);
    }
    if crowd.around > 0.0 {
        sketch.surface(finish(stream));
        sketch.sphere([0.1, -0.2, 0.3], crowd.around);
    }
    let centers: Vec<[f64; 3]> = (0..4).map(|_| place(stream, crowd.depths)).collect();
    for i in 0..crowd.n_objects {
        if i % 10 == 0 {
            sketch.surface(finish(stream));
        }
        let [x, y, z] = place(stream, crowd.depths);
        let center = centers[stream.below(centers.len())];
        let blend = |k: usize, c: f64| center[k] + crowd.cluster * (c - center[k]);
        let (x, y, z) = (blend(0, x), blend(1, y), blend(2, z));
        let exponents = crowd.sizes.map(f64::log2);
        let size = libm::exp2(stream.between(exponents[0], exponents[1]));
        if (i + 1) % crowd.cylinders == 0 {
            sketch.cylinder(size, [x, z], [y, y + 2.0 * size]);
        } else {
            sketch.sphere([x, y, z], size);
        }
    }
    sketch
}

fn place(stream: &mut Stream, depths: [f64; 2]) -> [f64; 3] {
    let z = stream.between(depths[0], depths[1]);
    let width = 0.7 * z.abs() + 0.1;
    [stream.between(-width, width), stream.between(-width, width), z]
}

fn finish(stream: &mut Stream) -> Finish {
    Finish {
        ambient: [0.1, 0.05, 0.1],
        diffuse: [stream.unit(), 0.5, 0.4],
        specular: [0.3; 3],
        shininess: 20.0,
        reflectance: [0.0, 0.0, 0.4][stream.below(3)],
    }
}

fn render(sketch: &Sketch, passes: Passes) -> (Search, Vec<u8>) {
    let size = Size::new(WIDTH, HEIGHT).expect("a size within the limits");
    let made = sketch.make();
    let plan = plan(made.view(), &Settings { size, passes, ..Settings::default() });
    let search = plan.search;
    let mut rgb = vec![0; (WIDTH * HEIGHT * 3) as usize];
    Tracer::new(plan).render_rows(0..HEIGHT, &mut rgb);
    (search, rgb)
}

/// Most pixels of crowds are traced wide, those with cylinders and with a sphere around the eye too.
#[test]
fn crowds_are_traced_wide() {
    let usual =
        Crowd { n_objects: 900, sizes: [0.02, 0.2], cluster: 1.0, depths: [-9.0, -2.0], cylinders: 4, around: 0.0 };
    for (seed, crowd) in (0..).zip([usual, Crowd { around: 30.0, ..usual }, Crowd { cylinders: 5000, ..usual }]) {
        let made = sketch(&crowd, &mut Stream::new(seed)).make();
        let size = Size::new(200, 150).expect("a size within the limits");
        let mut rgb = vec![0; 200 * 150 * 3];
        let counts =
            Tracer::new(plan(made.view(), &Settings { size, ..Settings::default() })).render_rows(0..150, &mut rgb);
        assert!(counts.settled_pixels < 200 * 150 / 20, "{crowd:?}: {}", counts.settled_pixels);
    }
}

#[test]
fn searching_changes_no_pixel() {
    let usual =
        Crowd { n_objects: 300, sizes: [0.02, 0.2], cluster: 1.0, depths: [-9.0, -2.0], cylinders: 4, around: 0.0 };
    let crowds = [
        usual,
        Crowd { n_objects: 130, sizes: [0.2, 1.0], ..usual },
        Crowd { n_objects: 3000, sizes: [0.005, 0.05], cylinders: 7, ..usual },
        Crowd { n_objects: 1000, sizes: [1e-4, 0.1], cluster: 0.05, ..usual },
        Crowd { n_objects: 1000, sizes: [1e-6, 0.01], cluster: 0.001, cylinders: 5000, ..usual },
        Crowd { n_objects: 3000, sizes: [0.01, 0.2], cylinders: 5000, ..usual },
        Crowd { n_objects: 700, sizes: [0.1, 0.4], cylinders: 5000, depths: [-9.0, -1.0], ..usual },
        Crowd { n_objects: 200, sizes: [0.01, 20.0], ..usual },
        Crowd { n_objects: 400, sizes: [0.01, 0.5], depths: [-3.0, 3.0], ..usual },
        Crowd { n_objects: 140, sizes: [2.0, 30.0], depths: [-3.0, 3.0], cylinders: 2, ..usual },
        Crowd { n_objects: 900, sizes: [0.02, 0.3], cylinders: 2, ..usual },
        Crowd { n_objects: 700, sizes: [0.02, 0.3], cylinders: 3, around: 30.0, ..usual },
        Crowd { n_objects: 700, sizes: [0.02, 0.3], cylinders: 5, around: 7.0, ..usual },
        Crowd { n_objects: 600, sizes: [0.01, 0.6], depths: [-3.0, 3.0], cylinders: 3, around: 12.0, ..usual },
    ];
    for (seed, crowd) in (0..).zip(&crowds) {
        let sketch = sketch(crowd, &mut Stream::new(seed));
        let (search, with) = render(&sketch, Passes::all());
        let (_, without) = render(&sketch, Passes::none());
        assert_eq!(search, Search::Structures, "{crowd:?}");
        let n_different = with.chunks(3).zip(without.chunks(3)).filter(|(a, b)| a != b).count();
        assert_eq!(n_different, 0, "{crowd:?}: of {} pixels", WIDTH * HEIGHT);
    }
}

/// A mirror shows spheres at almost the same place, so that its rays may meet them all, which are more than a packet lists: such
/// packets are left to finer arithmetic.
#[test]
fn rays_that_may_meet_thousands_of_spheres_change_no_pixel() {
    let dull =
        Finish { ambient: [0.1; 3], diffuse: [0.5, 0.6, 0.3], specular: [0.0; 3], shininess: 1.0, reflectance: 0.0 };
    let mut sketch = Sketch::new(60.0, [0.2, 0.3, 0.5]);
    sketch.light([0.6, 0.5, 0.4], [3.0, 4.0, 1.0]);
    sketch.surface(Finish { reflectance: 0.4, ..dull }).sphere([0.1, -0.1, -4.0], 1.0).surface(dull);
    for i in 0..1500 {
        sketch.sphere([0.3, 0.2, 9.0 + 1e-6 * f64::from(i)], 4.0);
    }
    let (search, with) = render(&sketch, Passes::all());
    assert_eq!(search, Search::Structures);
    assert!(with == render(&sketch, Passes::none()).1);
    let made = sketch.make();
    let size = Size::new(WIDTH, HEIGHT).expect("a size within the limits");
    let tracer = Tracer::new(plan(made.view(), &Settings { size, ..Settings::default() }));
    let counts = tracer.render_rows(0..HEIGHT, &mut vec![0; with.len()]);
    assert!(counts.settled_pixels > 20, "{counts:?}");
}

/// The same scenes with one object more or less: before and behind the steps at which pairs are no longer looked at, and from
/// which on objects are looked up.
#[test]
fn steps_from_few_to_many_change_no_pixel() {
    let usual =
        Crowd { n_objects: 0, sizes: [0.1, 0.5], cluster: 1.0, depths: [-9.0, -2.0], cylinders: 4, around: 0.0 };
    for n_objects in [52, 53, 56, 57, 58, 59, 126, 127, 128, 129] {
        let sketch = sketch(&Crowd { n_objects, ..usual }, &mut Stream::new(7));
        let (search, with) = render(&sketch, Passes::all());
        let (_, without) = render(&sketch, Passes::none());
        assert_eq!(search == Search::Structures, n_objects >= 128, "{n_objects}");
        assert!(with == without, "{n_objects} objects");
    }
}
