//! The margins are wide enough: lanes as wrong as they may be decide no pixel wrongly.
//!
//! With binary64 lanes a ray comes within a margin once in 10¹² times, so that no test would notice a margin that is ten
//! times too small. Coarse lanes (`kernels::coarse`) err 2²⁸ times as much, with the same code and the same bounds. Their tiles
//! are taken from images of billions of pixels, where silhouettes, rims, edges of shadows and their reflections run: places
//! are halved between two pixels of different colours until they are neighbours.

use rayon::prelude::*;

use super::*;
use crate::trace::kernels::coarse::{self, Way, Wrongness};
use crate::trace::wide::notes::Proved;

/// What a random scene is made of.
#[derive(Clone, Copy, Debug)]
struct Family {
    name: &'static str,
    n_objects: usize,
    /// The share of cylinders among the objects, and of mirrors among the surfaces.
    cylinders: f64,
    mirrors: f64,
    n_lights: usize,
    /// Whether surfaces have diffuse and specular light.
    is_diffuse: bool,
    is_specular: bool,
    /// Whether a sphere holds the eye.
    has_shell: bool,
    /// Whether the spheres are of one size, and touch.
    is_lattice: bool,
    /// Whether all surfaces and lights are grey.
    is_grey: bool,
    samples: u32,
    /// At least this share of the pixels is decided.
    decided: f64,
}

/// How many times as wrong as bounds take them to be the operations can be, and no pixel of these images is wrong.
const ROOM: f64 = 12.0;

const PLAIN: Family = Family {
    name: "eye rays",
    n_objects: 12,
    cylinders: 0.4,
    mirrors: 0.0,
    n_lights: 0,
    is_diffuse: false,
    is_specular: false,
    has_shell: false,
    is_lattice: false,
    is_grey: false,
    samples: 1,
    decided: 0.69,
};

const FAMILIES: &[Family] = &[
    PLAIN,
    Family { name: "in a shell", decided: 0.78, has_shell: true, ..PLAIN },
    Family { name: "lit", decided: 0.41, n_lights: 2, is_diffuse: true, ..PLAIN },
    Family { name: "lit in a shell", decided: 0.36, n_lights: 2, is_diffuse: true, has_shell: true, ..PLAIN },
    Family { name: "shining", decided: 0.37, n_lights: 2, is_diffuse: true, is_specular: true, ..PLAIN },
    Family { name: "mirrors", decided: 0.74, mirrors: 0.5, ..PLAIN },
    Family {
        name: "lit mirrors",
        decided: 0.36,
        mirrors: 0.5,
        n_lights: 2,
        is_diffuse: true,
        is_specular: true,
        ..PLAIN
    },
    Family {
        name: "mirrors in a shell",
        decided: 0.14,
        mirrors: 0.5,
        n_lights: 1,
        is_diffuse: true,
        has_shell: true,
        ..PLAIN
    },
    Family {
        name: "lattice",
        decided: 0.66,
        mirrors: 0.7,
        is_lattice: true,
        cylinders: 0.0,
        n_lights: 1,
        is_diffuse: true,
        ..PLAIN
    },
    Family { name: "lattice with cylinders", decided: 0.74, mirrors: 0.7, is_lattice: true, ..PLAIN },
    Family { name: "many mirrors", decided: 0.34, mirrors: 0.7, n_objects: 60, n_lights: 1, is_diffuse: true, ..PLAIN },
    Family { name: "crowd", decided: 0.21, n_objects: 200, mirrors: 0.3, n_lights: 2, is_diffuse: true, ..PLAIN },
    Family { name: "samples", decided: 0.55, samples: 2, mirrors: 0.3, n_lights: 1, is_diffuse: true, ..PLAIN },
];

/// Grey lattices: packets go among their mirrors as flocks.
const FLOCKS: &[Family] = &[
    Family {
        name: "flock",
        decided: 0.84,
        mirrors: 1.0,
        is_lattice: true,
        is_grey: true,
        cylinders: 0.0,
        n_lights: 1,
        is_diffuse: true,
        ..PLAIN
    },
    Family {
        name: "dark flock",
        decided: 0.82,
        mirrors: 1.0,
        is_lattice: true,
        is_grey: true,
        cylinders: 0.0,
        ..PLAIN
    },
];

/// Cylinders in cylinders: mirrors show walls, caps and rims, and where they cut each other.
const CYLINDERS: &[Family] = &[
    Family { name: "mirrored cylinders", decided: 0.42, cylinders: 1.0, mirrors: 1.0, n_objects: 20, ..PLAIN },
    Family { name: "lit cylinders", decided: 0.41, cylinders: 1.0, n_lights: 2, is_diffuse: true, ..PLAIN },
];

/// Rounds to a multiple of 2⁻¹⁰: what coarse lanes hold exactly.
fn short(number: f64) -> f64 {
    (number * 1024.0).round() / 1024.0
}

fn short_vector(stream: &mut Stream, low: f64, high: f64) -> DVec3 {
    DVec3::from_array([(); 3].map(|()| short(stream.between(low, high))))
}

impl Family {
    fn surface(&self, stream: &mut Stream) -> ir::Surface {
        let is_mirror = stream.unit() < self.mirrors;
        let mut color = |is_there: bool, most: f64| match is_there {
            true => short_vector(stream, 0.0, most),
            false => DVec3::ZERO,
        };
        let (ambient, diffuse, specular) = (
            color(true, if self.is_diffuse { 0.3 } else { 0.8 }),
            color(self.is_diffuse, 0.8),
            color(self.is_specular, 0.6),
        );
        let is_grey = self.is_grey || stream.unit() < 0.5;
        let [ambient, diffuse, specular] =
            [ambient, diffuse, specular].map(|color| if is_grey { DVec3::splat(color.x) } else { color });
        let exponents = [0.0, 0.5, 1.0, 2.0, 3.0, 7.5, 20.0, 60.0];
        let shininess = exponents[stream.below(exponents.len())];
        let reflectance = if is_mirror { short(stream.between(0.2, 1.0)) } else { 0.0 };
        ir::Surface { ambient, diffuse, specular, shininess, reflectance }
    }

    fn program(&self, stream: &mut Stream) -> Valid {
        let mut program = ir::Program::default();
        let n_surfaces = if self.is_lattice { 1 } else { 1 + stream.below(6) };
        for _ in 0..n_surfaces {
            program.surfaces.push(self.surface(stream));
        }
        for _ in 0..self.n_lights {
            let (color, position) = (short_vector(stream, 0.1, 0.9), short_vector(stream, -12.0, 12.0));
            let color = if self.is_grey { DVec3::splat(color.x) } else { color };
            program.lights.push(ir::Light { color, position });
        }
        for _ in 0..self.n_objects {
            let order = program.spheres.len() + program.cylinders.len();
            let surface = Handle::new(stream.below(n_surfaces) as u32);
            let distance = libm::exp2(stream.between(1.0, 5.0));
            let [x, y] = [(); 2].map(|()| short(stream.between(-0.5, 0.5) * distance));
            let (z, radius) = (short(-distance), short(distance * libm::exp2(stream.between(-5.0, -1.5))));
            if stream.unit() < self.cylinders {
                let y_max = short(y + radius * stream.between(0.1, 4.0)).max(y + 1.0 / 64.0);
                program.cylinders.push(ir::Cylinder { radius, x, z, y_min: y, y_max, surface, order });
            } else if self.is_lattice {
                // Where places are taken twice, one copy stays.
                let [i, j, k] = [(); 3].map(|()| stream.below(3) as f64);
                // Flocks set out from near spheres alone: errors of points grow with the distance.
                let nearest = if self.is_grey { 2.5 } else { 5.0 };
                let center = DVec3::new(2.0 * i - 2.0, 2.0 * j - 2.0, -nearest - 2.0 * k);
                if program.spheres.as_slice().iter().all(|sphere| sphere.center != center) {
                    program.spheres.push(ir::Sphere { center, radius: 1.0, surface, order });
                }
            } else {
                program.spheres.push(ir::Sphere { center: DVec3::new(x, y, z), radius, surface, order });
            }
        }
        if self.has_shell {
            let radius = short(libm::exp2(stream.between(4.5, 7.0)));
            let (center, surface) = (short_vector(stream, -8.0, 8.0), Handle::new(0));
            let order = program.spheres.len() + program.cylinders.len();
            program.spheres.push(ir::Sphere { center, radius, surface, order });
        }
        ir::validate(program).expect("a sound program")
    }
}

/// The pixels of an image as finer arithmetic has them.
struct Truth<'a, 'p> {
    sampling: Sampling,
    camera: Camera<Ball64>,
    fine_camera: Camera<Ball106>,
    coarse: Integrator<'a, 'p, Ball64>,
    fine: Integrator<'a, 'p, Ball106>,
}

/// What is known of a pixel.
#[derive(Clone, Copy, Debug)]
struct Known {
    color: [f64; 3],
    error: f64,
    bytes: [u8; 3],
}

impl<'a, 'p> Truth<'a, 'p> {
    fn new(plan: &'a Plan<'p>) -> Self {
        let sampling = Sampling::new(&plan.settings);
        Self {
            camera: Camera::new(plan.fov_deg, sampling.steps_per_half_height()),
            fine_camera: Camera::new(plan.fov_deg, sampling.steps_per_half_height()),
            coarse: Integrator::new(plan),
            fine: Integrator::new(plan),
            sampling,
        }
    }

    /// Returns what a pixel is, if double-double decides it.
    fn pixel(&mut self, column: u32, row: u32) -> Option<Known> {
        let pixel = self.sampling.pixel(column, row);
        let among = self.coarse.plan.tiles.candidates(column, row);
        known(&mut self.coarse, &self.camera, &pixel, among)
            .or_else(|| known(&mut self.fine, &self.fine_camera, &pixel, among))
    }
}

fn known<R: Real>(
    integrator: &mut Integrator<'_, '_, R>,
    camera: &Camera<R>,
    pixel: &Pixel,
    among: Candidates<'_>,
) -> Option<Known> {
    let color = pixel::mean(integrator, camera, pixel, among).ok()?;
    let bytes = pixel::quantise(&mut integrator.judge, color).ok()?;
    let channels = color.to_array();
    let error = channels.iter().fold(0.0, |error: f64, channel| error.max(channel.error()));
    Some(Known { color: channels.map(|channel| channel.value()), error, bytes })
}

/// How many pixels coarse lanes have decided.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    n_pixels: usize,
    n_decided: usize,
    n_wrong: usize,
    /// Channels that are off by more than their bound.
    n_beyond: usize,
    /// The largest error of a channel as a share of its bound.
    worst: f64,
}

impl Tally {
    fn plus(self, other: Self) -> Self {
        Self {
            n_pixels: self.n_pixels + other.n_pixels,
            n_decided: self.n_decided + other.n_decided,
            n_wrong: self.n_wrong + other.n_wrong,
            n_beyond: self.n_beyond + other.n_beyond,
            worst: self.worst.max(other.worst),
        }
    }
}

/// Traces tiles of one image.
fn audit(tally: &mut Tally, family: &Family, stream: &mut Stream, n_tiles: usize) {
    let program = family.program(stream);
    let registers = Registers {
        fov_deg: libm::exp2(stream.between(2.0, 6.8)),
        background: short_vector(stream, 0.0, 0.4),
        n_lights: program.lights.len(),
        n_spheres: program.spheres.len(),
        n_cylinders: program.cylinders.len(),
    };
    let side = Size::MAX_SIDE;
    let passes = if stream.unit() < 0.5 { Passes::all() } else { Passes::all().without(Pass::Tiles) };
    let settings = Settings {
        size: Size::new(side, side).expect("a size"),
        samples: family.samples,
        passes,
        max_level: stream.below(9) as u32,
        ..Settings::default()
    };
    let plan = plan(SceneView::new(&program, registers), &settings);
    let mut truth = Truth::new(&plan);
    let Some(wide) = Wide::new(&plan, truth.camera.step(), Backend::Coarse) else { return };
    let mut scratch = wide.scratch(true);
    for _ in 0..n_tiles {
        // At an edge flocks part; elsewhere they are followed far.
        let (column, row) = if family.is_grey && stream.below(2) == 0 {
            (stream.below(side as usize) as u32, stream.below(side as usize) as u32)
        } else {
            on_an_edge(&mut truth, side, stream)
        };
        let rect = Wide::tiles(&plan, row / 16 * 16..row / 16 * 16 + 16)
            .find(|rect| rect.columns.contains(&column) && rect.rows.contains(&row))
            .expect("a tile");
        audit_tile(tally, &plan, &wide, &mut truth, &rect, &mut scratch);
    }
}

/// Returns a pixel beside which the colour changes.
fn on_an_edge(truth: &mut Truth<'_, '_>, side: u32, stream: &mut Stream) -> (u32, u32) {
    let mut any = || [(); 2].map(|()| stream.below(side as usize) as u32);
    let [mut from, mut to] = [any(), any()];
    let mut color = |[column, row]: [u32; 2]| truth.pixel(column, row).map_or([0.5; 3], |known| known.color);
    let contrast = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).abs()).sum::<f64>();
    while (0..2).any(|k| from[k].abs_diff(to[k]) > 1) {
        let middle = [0, 1].map(|k| from[k].midpoint(to[k]));
        let [first, between, last] = [from, middle, to].map(&mut color);
        if contrast(first, between) > contrast(between, last) { to = middle } else { from = middle }
    }
    (from[0], from[1])
}

fn audit_tile(
    tally: &mut Tally,
    plan: &Plan<'_>,
    wide: &Wide,
    truth: &mut Truth<'_, '_>,
    rect: &Rect,
    scratch: &mut Scratch,
) {
    scratch.notes.iter_mut().for_each(|notes| notes.trail = Some(Vec::new()));
    wide.trace(plan, &truth.sampling.clone(), rect, scratch);
    let trail: Vec<Proved> = scratch.notes.iter_mut().filter_map(|notes| notes.trail.take()).flatten().collect();
    for row in rect.rows.clone() {
        for column in rect.columns.clone() {
            let place = (row - rect.rows.start) as usize * TILE_WIDTH + (column - rect.columns.start) as usize;
            tally.n_pixels += 1;
            if scratch.slow[place / 8] >> (place % 8) & 1 != 0 {
                continue;
            }
            let Some(known) = truth.pixel(column, row) else { continue };
            tally.n_decided += 1;
            let [red, green, blue, _] = scratch.pixels[place].to_le_bytes();
            if [red, green, blue] != known.bytes {
                tally.n_wrong += 1;
            }
            for proved in trail.iter().filter(|proved| proved.place == place) {
                for (computed, exact) in proved.color.into_iter().zip(known.color) {
                    let off = (computed.clamp(0.0, 1.0) - exact).abs() - known.error - 1e-12;
                    if off > proved.error {
                        tally.n_beyond += 1;
                    }
                    if off > 0.0 && proved.error < shade::HALF_LEVEL {
                        tally.worst = tally.worst.max(off / proved.error);
                    }
                }
            }
        }
    }
}

/// Audits some images of each family.
fn audit_all(n_images: usize, wrongness: Wrongness) -> Vec<(&'static Family, Tally)> {
    [FAMILIES, FLOCKS, CYLINDERS]
        .into_iter()
        .flat_map(|families| audit_families(families, n_images, wrongness))
        .collect()
}

fn audit_families(
    families: &'static [Family],
    n_images: usize,
    wrongness: Wrongness,
) -> impl Iterator<Item = (&'static Family, Tally)> {
    let audit_one = |place: usize| {
        coarse::be_wrong(wrongness);
        let mut tally = Tally::default();
        audit(&mut tally, &families[place % families.len()], &mut Stream::new(place as u64), 4);
        tally
    };
    let each: Vec<_> = (0..n_images * families.len()).into_par_iter().map(audit_one).collect();
    let of_family =
        move |i: usize| each.iter().skip(i).step_by(families.len()).copied().fold(Tally::default(), Tally::plus);
    families.iter().enumerate().map(move |(i, family)| (family, of_family(i)))
}

#[test]
fn lanes_as_wrong_as_they_may_be_decide_no_pixel_wrongly() {
    for way in [Way::Mixed, Way::Up, Way::Down] {
        for (family, tally) in audit_all(6, Wrongness { excess: 1.0, way }) {
            assert!(tally.n_wrong + tally.n_beyond == 0, "{}, {way:?}: {tally:?}", family.name);
        }
    }
}

/// Bounds that are added up term by term are larger than what is ever seen. A change that uses this room up is noticed here,
/// even if nothing is wrong yet, and so is one that makes them larger.
#[test]
fn the_bounds_leave_room_and_are_not_idle() {
    let mut failures = Vec::new();
    for (family, tally) in audit_all(24, Wrongness { excess: ROOM, way: Way::Mixed }) {
        let share = tally.n_decided as f64 / tally.n_pixels as f64;
        if tally.n_wrong + tally.n_beyond > 0 || share <= family.decided {
            failures.push(format!("{}, {share:.3} of the pixels: {tally:?}", family.name));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn lanes_that_are_worse_than_that_are_found_out() {
    for (family, tally) in audit_all(16, Wrongness { excess: 6.0 * ROOM, way: Way::Mixed }) {
        assert!(tally.n_wrong > 0, "{}: {tally:?}", family.name);
    }
}
