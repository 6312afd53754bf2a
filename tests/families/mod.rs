//! Families of scenes that are hard to trace, each made from a seed.
//!
//! A family names one difficulty. Its scenes differ from seed to seed in number, place and surface of the objects; a seed
//! gives the same scene on every machine.

#![allow(dead_code, reason = "each suite uses a part")]

pub mod sketch;
mod transform;

use clisc::testing::Stream;

use self::sketch::{Finish, Sketch};

/// A kind of scene.
#[derive(Clone, Copy)]
pub struct Family {
    /// What tests print.
    pub name: &'static str,
    sketch: fn(&mut Random) -> Sketch,
}

impl Family {
    /// Makes the scene of one seed.
    pub fn sketch(&self, seed: u64) -> Sketch {
        let of_name = self.name.bytes().fold(seed, |hash, byte| hash.wrapping_mul(0x100_0000_01b3) ^ u64::from(byte));
        (self.sketch)(&mut Random(Stream::new(of_name)))
    }
}

/// Every family.
pub const FAMILIES: &[Family] = &[
    Family { name: "ordinary", sketch: ordinary },
    Family { name: "ordinary scaled by 1e6", sketch: |random| scaled_by_decimal(&ordinary(random), 6) },
    Family { name: "ordinary scaled by 1e-6", sketch: |random| scaled_by_decimal(&ordinary(random), -6) },
    Family { name: "ordinary scaled by 1e12", sketch: |random| scaled_by_decimal(&ordinary(random), 12) },
    Family { name: "ordinary scaled by 1e-12", sketch: |random| scaled_by_decimal(&ordinary(random), -12) },
    Family { name: "ordinary scaled by 1e30", sketch: |random| scaled_by_decimal(&ordinary(random), 30) },
    Family { name: "ordinary scaled by 1e-30", sketch: |random| scaled_by_decimal(&ordinary(random), -30) },
    Family { name: "ordinary scaled by 2^300", sketch: |random| scaled_by_power_of_two(&ordinary(random), 300) },
    Family { name: "ordinary scaled by 2^-300", sketch: |random| scaled_by_power_of_two(&ordinary(random), -300) },
    Family { name: "crowd", sketch: crowd },
    Family { name: "balls on a ball of 1e3", sketch: |random| resting(random, 1e3) },
    Family { name: "balls on a ball of 1e6", sketch: |random| resting(random, 1e6) },
    Family { name: "balls on a ball of 1e8", sketch: |random| resting(random, 1e8) },
    Family { name: "eye in a mirrored sphere", sketch: inside_sphere },
    Family { name: "eye in a mirrored cylinder", sketch: inside_cylinder },
    Family { name: "mirrored balls in a mirrored room", sketch: mirrored_room },
    Family { name: "hall of mirrors", sketch: hall_of_mirrors },
    Family { name: "needles", sketch: needles },
    Family { name: "stacked cylinders", sketch: stacked },
    Family { name: "coincident copies", sketch: coincident },
    Family { name: "common cap planes", sketch: common_planes },
    Family { name: "lights on and in surfaces", sketch: lights_on_surfaces },
    Family { name: "light at a hit point", sketch: light_at_hit },
    Family { name: "lens of 0.0002 degrees", sketch: long_lens },
    Family { name: "lens of 175 degrees", sketch: wide_lens },
    Family { name: "lens of 90 degrees", sketch: right_angle },
    Family { name: "lattice of mirrors", sketch: lattice },
    Family { name: "touching rays", sketch: tangents },
    Family { name: "contact points", sketch: contacts },
    Family { name: "mirror images", sketch: symmetric },
    Family { name: "extreme surfaces", sketch: extreme_surfaces },
    Family { name: "eye on a surface", sketch: eye_on_surface },
    Family { name: "eye and lights on surfaces of long numbers", sketch: on_long_surfaces },
    Family { name: "specks", sketch: |random| specks(random, &[1e-28, 1e-20, 1e-12, 1e-5]) },
    Family { name: "giants", sketch: giants },
    Family { name: "scene in a scene", sketch: |random| scene_in_scene(random, &[-3, -6, -9]) },
    Family { name: "eye at the centre of a mirror", sketch: |random| centred_mirror(random, &[1.0, 0.3]) },
    Family { name: "nothing to see", sketch: nothing },
    Family { name: "tiny scene in a scene", sketch: |random| scene_in_scene(random, &[-30]) },
];

/// The names of families in which no ray meets or leaves two surfaces in one point.
pub const WITHOUT_TIES: [&str; 5] =
    ["ordinary", "crowd", "eye in a mirrored sphere", "eye in a mirrored cylinder", "lens of 175 degrees"];

/// Families in which a ray's error grows beyond what 106 bits can follow.
pub const FINEST: &[Family] = &[
    Family { name: "finest specks", sketch: |random| specks(random, &[1e-32]) },
    Family { name: "specks about the centre of a mirror", sketch: |random| centred_mirror(random, &[1e-6, 1e-15]) },
];

/// A stream of numbers with a taste for scenes.
pub struct Random(Stream);

impl Random {
    /// Returns a number in [0, 1).
    fn unit(&mut self) -> f64 {
        self.0.unit()
    }

    fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }

    fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// Returns a number of full length in [low, high).
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0.between(low, high)
    }

    /// Returns a number of three decimals, as people write them, in [low, high].
    fn decimal(&mut self, low: f64, high: f64) -> f64 {
        (self.between(low, high) * 1000.0).round() / 1000.0
    }

    fn color(&mut self, low: f64, high: f64) -> [f64; 3] {
        [0; 3].map(|_| self.decimal(low, high))
    }

    /// Returns an ordinary surface: a mirror one time in three.
    fn finish(&mut self) -> Finish {
        let reflectance = if self.chance(0.33) { self.decimal(0.1, 0.9) } else { 0.0 };
        self.finish_reflecting(reflectance)
    }

    fn finish_reflecting(&mut self, reflectance: f64) -> Finish {
        let specular = if self.chance(0.6) { self.color(0.1, 0.7) } else { [0.0; 3] };
        Finish {
            ambient: self.color(0.0, 0.3),
            diffuse: self.color(0.0, 0.8),
            specular,
            shininess: self.pick(&[0.0, 0.5, 1.0, 2.5, 5.0, 20.0, 100.0]),
            reflectance,
        }
    }

    /// Returns a point in front of the eye, 2 to 9 away.
    fn place(&mut self) -> [f64; 3] {
        let z = self.decimal(-9.0, -2.0);
        [self.decimal(0.6 * z, -0.6 * z), self.decimal(0.6 * z, -0.6 * z), z]
    }

    fn lights(&mut self, sketch: &mut Sketch, n_lights: usize) {
        for _ in 0..n_lights {
            let color = self.color(0.1, 0.8);
            sketch.light(color, [self.decimal(-8.0, 8.0), self.decimal(-3.0, 8.0), self.decimal(-8.0, 8.0)]);
        }
    }

    /// Adds a sphere or a cylinder in front of the eye with a surface of its own.
    fn object(&mut self, sketch: &mut Sketch) {
        let [x, y, z] = self.place();
        let size = self.decimal(0.2, 1.5);
        sketch.surface(self.finish());
        if self.chance(0.6) {
            sketch.sphere([x, y, z], size);
        } else {
            sketch.cylinder(size, [x, z], [y, y + self.decimal(0.1, 2.0)]);
        }
    }

    /// Returns an offset and its length, about 1, exactly: fifty bits each, by Lebesgue's identity.
    fn long_offset(&mut self) -> ([f64; 3], f64) {
        let [m, n, p, q] = [0; 4].map(|_| (self.unit() * f64::from(1 << 23)).round());
        let scaled = |whole: f64| whole / (1u64 << 47) as f64;
        let offset = [2.0 * (m * q + n * p), 2.0 * (n * q - m * p), -(m * m + n * n - p * p - q * q).abs()];
        (offset.map(scaled), scaled(m * m + n * n + p * p + q * q))
    }

    /// Returns an offset along x and z and its length, about 1, exactly.
    fn long_offset_across(&mut self) -> ([f64; 2], f64) {
        let [m, n] = [0; 2].map(|_| (self.unit() * f64::from(1 << 24)).round());
        let scaled = |whole: f64| whole / (1u64 << 48) as f64;
        ([m * m - n * n, -2.0 * m * n].map(scaled), scaled(m * m + n * n))
    }

    fn sketch(&mut self, fov_deg: f64) -> Sketch {
        Sketch::new(fov_deg, self.color(0.0, 1.0))
    }
}

fn scaled_by_decimal(sketch: &Sketch, exponent: i32) -> Sketch {
    sketch.map_lengths(|length| format!("{length:?}e{exponent}").parse().expect("a decimal number"))
}

fn scaled_by_power_of_two(sketch: &Sketch, exponent: i64) -> Sketch {
    let factor = f64::from_bits(((1023 + exponent) as u64) << 52);
    sketch.map_lengths(|length| length * factor)
}

fn ordinary(random: &mut Random) -> Sketch {
    let fov_deg = random.pick(&[30.0, 45.0, 60.0, 60.0, 75.5, 90.0]);
    let mut sketch = random.sketch(fov_deg);
    let n_lights = 1 + random.below(4);
    random.lights(&mut sketch, n_lights);
    for _ in 0..3 + random.below(7) {
        random.object(&mut sketch);
    }
    sketch
}

fn crowd(random: &mut Random) -> Sketch {
    let mut sketch = random.sketch(60.0);
    random.lights(&mut sketch, 3);
    for _ in 0..40 {
        sketch.surface(random.finish());
        for _ in 0..4 {
            let [x, y, z] = random.place();
            let size = random.between(0.02, 0.25);
            if random.chance(0.7) {
                sketch.sphere([x, y, z], size);
            } else {
                sketch.cylinder(size, [x, z], [y, y + 3.0 * size]);
            }
        }
    }
    sketch
}

/// Balls of radius 0.25 to 1 on a ball so large that it is flat.
fn resting(random: &mut Random, radius: f64) -> Sketch {
    let mut sketch = random.sketch(60.0);
    random.lights(&mut sketch, 2);
    let top = random.pick(&[-1.0, -0.6, -1.5]);
    sketch.surface(random.finish()).sphere([0.0, top - radius, -5.0], radius);
    for i in 0..2 + random.below(4) {
        let ball = random.pick(&[0.25, 0.3, 0.5, 0.7, 1.0]);
        let [x, z] = if i == 0 { [0.0, -5.0] } else { [random.decimal(-3.0, 3.0), random.decimal(-9.0, -3.0)] };
        // The larger ball falls away below its tangent plane, (x² + (z + 5)²) / 2R at the distance of the ball.
        let sag = (x * x + (z + 5.0) * (z + 5.0)) / (2.0 * radius);
        sketch.surface(random.finish()).sphere([x, top + ball - sag, z], ball);
    }
    sketch
}

fn inside_sphere(random: &mut Random) -> Sketch {
    let fov_deg = random.pick(&[60.0, 90.0, 120.0]);
    let mut sketch = random.sketch(fov_deg);
    let radius = random.decimal(2.0, 8.0);
    let center = [0; 3].map(|_| random.decimal(-0.5 * radius, 0.5 * radius));
    let shell = random.decimal(0.3, 1.0);
    sketch.surface(random.finish_reflecting(shell)).sphere(center, radius);
    for _ in 0..2 {
        let color = random.color(0.1, 0.6);
        sketch.light(color, center.map(|c| c + random.decimal(-0.5 * radius, 0.5 * radius)));
    }
    for _ in 0..random.below(3) {
        let place = center.map(|c| c + random.decimal(-0.6 * radius, 0.6 * radius));
        sketch.surface(random.finish()).sphere(place, random.decimal(0.1, 0.5));
    }
    sketch
}

fn inside_cylinder(random: &mut Random) -> Sketch {
    let fov_deg = random.pick(&[60.0, 90.0, 120.0]);
    let mut sketch = random.sketch(fov_deg);
    let radius = random.decimal(1.5, 6.0);
    let axis = [0; 2].map(|_| random.decimal(-0.5 * radius, 0.5 * radius));
    let shell = random.decimal(0.3, 1.0);
    let floor = -random.decimal(0.5, 4.0);
    let ceiling = random.decimal(0.5, 4.0);
    sketch.surface(random.finish_reflecting(shell)).cylinder(radius, axis, [floor, ceiling]);
    for _ in 0..2 {
        let color = random.color(0.1, 0.6);
        let [x, z] = axis.map(|c| c + random.decimal(-0.5 * radius, 0.5 * radius));
        sketch.light(color, [x, random.decimal(0.9 * floor, 0.9 * ceiling), z]);
    }
    for _ in 0..random.below(3) {
        let [x, z] = axis.map(|c| c + random.decimal(-0.6 * radius, 0.6 * radius));
        sketch.surface(random.finish());
        if random.chance(0.5) {
            sketch.sphere([x, random.decimal(floor, ceiling), z], random.decimal(0.1, 0.5));
        } else {
            sketch.cylinder(random.decimal(0.05, 0.3), [x, z], [floor, floor + 0.5]);
        }
    }
    sketch
}

/// Small round mirrors in a large one: each bounce spreads neighbouring rays by the ratio of the sizes.
fn mirrored_room(random: &mut Random) -> Sketch {
    let mut sketch = random.sketch(75.0);
    let shell = random.decimal(0.5, 1.0);
    let radius = random.decimal(4.0, 9.0);
    sketch.surface(random.finish_reflecting(shell));
    if random.chance(0.5) {
        sketch.sphere([0.3, -0.2, -1.0], radius);
    } else {
        sketch.cylinder(radius, [0.3, -1.0], [-2.0, 1.7]);
    }
    for _ in 0..8 {
        let mirror = random.decimal(0.6, 1.0);
        let [x, y, z] = [random.decimal(-1.5, 1.5), random.decimal(-1.5, 1.5), random.decimal(-4.0, 1.0)];
        let size = random.pick(&[0.4, 0.2, 0.1, 0.03, 0.003]);
        sketch.surface(random.finish_reflecting(mirror));
        if random.chance(0.7) {
            sketch.sphere([x, y, z], size);
        } else {
            sketch.cylinder(size, [x, z], [y - 0.5, y + 0.5]);
        }
    }
    for _ in 0..2 {
        let color = random.color(0.1, 0.5);
        sketch.light(color, [random.decimal(-2.0, 2.0), random.decimal(-1.5, 1.5), random.decimal(-3.0, 1.0)]);
    }
    sketch
}

/// Four mirrors about the eye that almost touch, touch or overlap, so that rays are caught between them.
fn hall_of_mirrors(random: &mut Random) -> Sketch {
    let mut sketch = random.sketch(60.0);
    let light = random.color(0.2, 0.8);
    sketch.light(light, [random.decimal(-0.5, 0.5), random.decimal(-0.2, 0.2), random.decimal(-0.2, 0.2)]);
    let sqrt_2 = std::f64::consts::SQRT_2;
    let eight_decimals = (sqrt_2 * 1e8).floor() / 1e8;
    let radius = random.pick(&[sqrt_2, eight_decimals, eight_decimals, 1.4, 1.42]);
    let shared = random.chance(0.5);
    let reflectance = random.decimal(0.5, 1.0);
    sketch.surface(random.finish_reflecting(reflectance));
    for [x, y, z] in [[1.0, 1.0, -1.0], [-1.0, -1.0, -1.0], [1.0, -1.0, 1.0], [-1.0, 1.0, 1.0]] {
        if !shared {
            sketch.surface(random.finish_reflecting(reflectance));
        }
        sketch.sphere([x, y, z], radius);
    }
    sketch
}

fn needles(random: &mut Random) -> Sketch {
    let mut sketch = random.sketch(60.0);
    random.lights(&mut sketch, 2);
    for _ in 0..12 {
        let radius = random.pick(&[1e-1, 1e-2, 1e-3, 1e-6, 1e-9, 1e-12]);
        // Whole columns of the image lie at x = 0 and, for W = 2H/3·…, at simple fractions of z.
        let x = random.pick(&[0.0, 0.0, 1.0, -1.0, 0.5]) * random.pick(&[0.0, 1.0]);
        let z = random.decimal(-9.0, -2.0);
        let height = random.pick(&[1e-12, 1e-6, 1e-3, 1.0, 10.0, 1e6]);
        let floor = random.pick(&[0.0, -1.0, -0.5 * height]);
        sketch.surface(random.finish()).cylinder(radius, [x, z], [floor, floor + height]);
    }
    let disc = random.decimal(0.5, 3.0);
    sketch.surface(random.finish()).cylinder(disc, [0.0, -5.0], [-1.0, -1.0 + 1e-9]);
    sketch
}

fn stacked(random: &mut Random) -> Sketch {
    let mut sketch = random.sketch(60.0);
    random.lights(&mut sketch, 3);
    let radius = random.decimal(0.5, 1.5);
    let z = random.decimal(-7.0, -4.0);
    let anywhere = random.decimal(-1.0, 1.0);
    let x = random.pick(&[0.0, 0.5, anywhere]);
    let mut floor = random.pick(&[-2.0, -1.5, -1.0]);
    for _ in 0..4 {
        let height = random.pick(&[0.5, 1.0, 0.3, 1e-6]);
        sketch.surface(random.finish()).cylinder(radius, [x, z], [floor, floor + height]);
        floor += height;
    }
    random.object(&mut sketch);
    sketch
}

fn coincident(random: &mut Random) -> Sketch {
    let mut sketch = random.sketch(60.0);
    random.lights(&mut sketch, 2);
    for _ in 0..2 {
        let center = random.place();
        let radius = random.decimal(0.5, 1.5);
        for _ in 0..2 {
            sketch.surface(random.finish()).sphere(center, radius);
        }
    }
    let [x, y, z] = random.place();
    let radius = random.decimal(0.5, 1.5);
    for [from, to] in [[0.0, 1.0], [0.0, 1.0], [-0.5, 1.0], [0.25, 0.75], [-0.25, 1.5]] {
        sketch.surface(random.finish()).cylinder(radius, [x, z], [y + from, y + to]);
    }
    let eye = random.decimal(3.0, 6.0);
    let mirror = random.finish_reflecting(0.8);
    for finish in [mirror, random.finish_reflecting(0.5)] {
        if random.chance(0.4) {
            sketch.surface(finish).sphere([0.0, 0.0, 0.0], eye + 8.0);
        }
    }
    sketch
}

fn common_planes(random: &mut Random) -> Sketch {
    let mut sketch = random.sketch(60.0);
    random.lights(&mut sketch, 2);
    let plane = random.pick(&[-1.0, -0.7, -0.5]);
    // A light in the plane grazes every cap.
    sketch.light([0.3, 0.3, 0.3], [random.decimal(-3.0, 3.0), plane, random.decimal(-8.0, 0.0)]);
    for _ in 0..6 {
        let radius = random.decimal(0.3, 2.5);
        let axis = [random.decimal(-2.5, 2.5), random.decimal(-8.0, -3.0)];
        let other = plane + random.pick(&[-1.0, -0.25, 0.5]);
        let mut ends = [plane, other];
        ends.sort_by(f64::total_cmp);
        sketch.surface(random.finish()).cylinder(radius, axis, ends);
    }
    sketch
}

fn lights_on_surfaces(random: &mut Random) -> Sketch {
    let mut sketch = random.sketch(60.0);
    // Points of the sphere of radius 5/4 that binary64 holds exactly.
    let [x, y, z] = [random.pick(&[0.0, 0.5]), random.pick(&[0.0, -0.5, 0.25]), random.pick(&[-4.0, -5.0])];
    for [dx, dy, dz] in [[0.0, 1.25, 0.0], [0.75, 1.0, 0.0], [0.0, 0.75, 1.0], [-1.0, 0.0, 0.75]] {
        if random.chance(0.5) {
            sketch.light(random.color(0.1, 0.7), [x + dx, y + dy, z + dz]);
        }
    }
    sketch.light(random.color(0.1, 0.7), [x, y, z]);
    sketch.surface(random.finish()).sphere([x, y, z], 1.25);
    // A light on the wall, one in the plane of the cap, one on the rim, one inside.
    let [cx, cz] = [random.pick(&[-1.5, 1.5, 0.0]), random.pick(&[-3.0, -6.0])];
    let [floor, ceiling] = [-1.5, random.pick(&[-1.0, 0.0, 0.5])];
    for place in [[cx + 0.75, -1.25, cz + 1.0], [cx, ceiling, cz], [cx + 1.0, ceiling, cz - 0.75], [cx, -1.25, cz]] {
        if random.chance(0.5) {
            sketch.light(random.color(0.1, 0.7), place);
        }
    }
    sketch.surface(random.finish()).cylinder(1.25, [cx, cz], [floor, ceiling]);
    // Grounds that catch the light; one starts in the cap's plane.
    sketch.surface(random.finish()).cylinder(6.0, [0.0, -5.0], [-3.0, floor]);
    sketch.surface(random.finish()).sphere([0.0, 0.0, -30.0], 20.0);
    sketch
}

fn light_at_hit(random: &mut Random) -> Sketch {
    let fov_deg = random.pick(&[30.0, 60.0, 90.0]);
    let mut sketch = random.sketch(fov_deg);
    // The ray of the centre column and row goes along −z and meets these at whole numbers.
    let depth = random.pick(&[3.0, 4.0, 5.0]);
    sketch.light(random.color(0.2, 0.9), [0.0, 0.0, -depth]);
    sketch.light(random.color(0.2, 0.9), [0.0, 0.0, 0.0]);
    sketch.light(random.color(0.2, 0.9), [0.0, 0.0, -depth + 1.0]);
    sketch.surface(random.finish()).sphere([0.0, 0.0, -depth - 1.0], 1.0);
    sketch.surface(random.finish()).cylinder(2.0, [0.0, -depth - 2.0], [-0.5, 0.5]);
    sketch.surface(random.finish()).sphere([0.0, 0.0, -depth - 0.5], 0.5);
    sketch
}

fn long_lens(random: &mut Random) -> Sketch {
    let mut sketch = random.sketch(0.0002);
    random.lights(&mut sketch, 2);
    // Half the view at a distance of 1e6 is 1e6 · tan(0.0001°) = 1.745.
    for _ in 0..8 {
        let distance = random.pick(&[1e6, 1.1e6, 0.9e6, 1e4, 1e8]);
        let unit = distance / 1e6;
        let [x, y] = [0; 2].map(|_| random.between(-1.5, 1.5) * unit);
        let size = random.decimal(0.1, 0.9) * unit;
        sketch.surface(random.finish());
        if random.chance(0.6) {
            sketch.sphere([x, y, -distance], size);
        } else {
            sketch.cylinder(size, [x, -distance], [y, y + size]);
        }
    }
    sketch.light([0.5, 0.5, 0.5], [2e6, 1e6, 0.0]);
    sketch
}

fn wide_lens(random: &mut Random) -> Sketch {
    let fov_deg = random.pick(&[175.0, 175.0, 179.9, 170.0]);
    let mut sketch = random.sketch(fov_deg);
    random.lights(&mut sketch, 2);
    for _ in 0..12 {
        let z = random.between(-1.0, -0.05);
        let place = [random.between(-6.0, 6.0), random.between(-6.0, 6.0), z];
        let size = random.between(0.1, 1.5);
        sketch.surface(random.finish());
        if random.chance(0.6) {
            sketch.sphere(place, size);
        } else {
            sketch.cylinder(size, [place[0], z], [place[1], place[1] + size]);
        }
    }
    sketch
}

/// k = 1: eye rays are rational, and whole-number objects are met at rims, edges and touching points.
fn right_angle(random: &mut Random) -> Sketch {
    let mut sketch = random.sketch(90.0);
    random.lights(&mut sketch, 2);
    sketch.light([0.4, 0.4, 0.4], [0.0, 3.0, -3.0]);
    for _ in 0..6 {
        let whole = |random: &mut Random, low: f64, high: f64| random.between(low, high + 1.0).floor();
        let [x, z] = [whole(random, -3.0, 3.0), whole(random, -8.0, -2.0)];
        sketch.surface(random.finish());
        if random.chance(0.4) {
            sketch.sphere([x, whole(random, -2.0, 2.0), z], 1.0);
        } else {
            let floor = whole(random, -3.0, 1.0);
            sketch.cylinder(1.0, [x, z], [floor, floor + 1.0]);
        }
    }
    sketch
}

/// Mirrors, lights and planes at whole numbers under rational eye rays, so that bounces end on edges too.
fn lattice(random: &mut Random) -> Sketch {
    let mut sketch = random.sketch(90.0);
    let whole = |random: &mut Random, low: f64, high: f64| random.between(low, high + 1.0).floor();
    for _ in 0..3 {
        let color = random.color(0.1, 0.5);
        sketch.light(color, [whole(random, -2.0, 2.0), whole(random, -1.0, 3.0), whole(random, -6.0, 1.0)]);
    }
    // A floor and a ceiling that face each other.
    sketch.surface(random.finish_reflecting(0.8)).cylinder(8.0, [0.0, -2.0], [-3.0, -2.0]);
    sketch.surface(random.finish_reflecting(0.7)).cylinder(8.0, [0.0, -2.0], [4.0, 5.0]);
    for _ in 0..5 {
        let [x, z] = [whole(random, -4.0, 4.0), whole(random, -8.0, -2.0)];
        let floor = whole(random, -2.0, 2.0);
        let mirror = random.pick(&[0.0, 0.5]);
        sketch.surface(random.finish_reflecting(mirror));
        if random.chance(0.3) {
            sketch.sphere([x, floor, z], 1.0);
        } else {
            let radius = random.pick(&[0.5, 1.0, 2.0]);
            let height = random.pick(&[1.0, 2.0]);
            sketch.cylinder(radius, [x, z], [floor, floor + height]);
        }
    }
    sketch
}

/// k² = 1/3: some eye rays touch a unit sphere exactly.
fn tangents(random: &mut Random) -> Sketch {
    let mut sketch = random.sketch(60.0);
    random.lights(&mut sketch, 2);
    let depth = random.pick(&[2.0, 3.0, 4.0, 5.0]);
    sketch.surface(random.finish()).sphere([0.0, 0.0, -depth], 1.0);
    sketch.surface(random.finish()).cylinder(1.0, [random.pick(&[0.0, 1.0, -1.0]), -depth - 2.0], [-2.0, 2.0]);
    sketch.surface(random.finish()).cylinder(random.pick(&[5.0, 10.0, 20.0]), [0.0, 0.0], [-2.0, -1.0]);
    sketch.surface(random.finish()).sphere([random.pick(&[-2.0, 2.0]), 0.0, -depth], 1.0);
    sketch
}

/// Spheres and cylinders that touch each other in single points and lines.
fn contacts(random: &mut Random) -> Sketch {
    let mut sketch = random.sketch(60.0);
    random.lights(&mut sketch, 2);
    sketch.surface(random.finish()).cylinder(4.0, [0.0, -5.0], [-2.0, -1.0]);
    sketch.surface(random.finish()).sphere([0.0, 0.0, -5.0], 1.0);
    sketch.surface(random.finish()).sphere([1.5, -0.5, -5.0], 0.5);
    sketch.surface(random.finish()).sphere([0.0, 1.25, -5.0], 0.25);
    sketch.surface(random.finish()).cylinder(0.5, [-1.5, -5.0], [-1.0, 0.0]);
    if random.chance(0.5) {
        let shell = random.decimal(0.2, 0.9);
        sketch.surface(random.finish_reflecting(shell)).sphere([0.0, 0.0, -2.0], 4.0);
    }
    if random.chance(0.5) {
        sketch.surface(random.finish()).sphere([0.75, -0.75, -4.0], 0.25);
    }
    // Lights over the contact points and in the plane of contact.
    sketch.light([0.3, 0.3, 0.3], [0.0, -1.0, random.pick(&[-5.0, 0.0, -3.0])]);
    sketch
}

/// Pairs of objects that are each other's mirror image, so that rays of the middle column meet both at equal t.
fn symmetric(random: &mut Random) -> Sketch {
    let mut sketch = random.sketch(60.0);
    random.lights(&mut sketch, 1);
    let height = random.decimal(0.5, 3.0);
    sketch.light(random.color(0.2, 0.6), [0.0, height, random.decimal(-3.0, 0.0)]);
    for _ in 0..2 {
        let [x, y, z] = [random.decimal(0.2, 1.2), random.decimal(-1.0, 1.0), random.decimal(-7.0, -3.0)];
        let size = random.decimal(0.6, 1.4);
        let is_sphere = random.chance(0.5);
        for x in [x, -x] {
            sketch.surface(random.finish());
            if is_sphere {
                sketch.sphere([x, y, z], size);
            } else {
                sketch.cylinder(size, [x, z], [y - size, y + size]);
            }
        }
    }
    sketch
}

fn extreme_surfaces(random: &mut Random) -> Sketch {
    let background = random.color(-0.5, 1.5);
    let mut sketch = Sketch::new(60.0, background);
    for _ in 0..4 {
        let color = random.color(-1.0, 3.0);
        sketch.light(color, [random.decimal(-8.0, 8.0), random.decimal(-3.0, 8.0), random.decimal(-8.0, 8.0)]);
    }
    sketch.light(random.color(0.2, 0.7), [0.0, 0.0, 0.0]);
    for _ in 0..7 {
        sketch.surface(Finish {
            ambient: random.color(-0.3, 0.5),
            diffuse: random.color(-0.5, 1.5),
            specular: random.color(-0.5, 2.0),
            shininess: random.pick(&[0.0, 0.1, 0.5, 1.5, 33.3, 1e3, 1e6, 12_345.678, 1e9, 1e17, 1e300, 1e-9]),
            reflectance: random.pick(&[0.0, -0.5, 0.2, 1.0, 1.5, 3.0, 1e-9]),
        });
        let [x, y, z] = random.place();
        let size = random.decimal(0.4, 1.5);
        if random.chance(0.7) {
            sketch.sphere([x, y, z], size);
        } else {
            sketch.cylinder(size, [x, z], [y, y + size]);
        }
    }
    sketch
}

fn eye_on_surface(random: &mut Random) -> Sketch {
    let fov_deg = random.pick(&[60.0, 90.0, 100.0]);
    let mut sketch = random.sketch(fov_deg);
    random.lights(&mut sketch, 2);
    let shell = random.pick(&[0.0, 0.5, 0.9]);
    sketch.surface(random.finish_reflecting(shell));
    match random.below(7) {
        0 => sketch.sphere([0.0, 0.0, -3.0], 3.0),
        1 => sketch.sphere([0.0, 0.0, 3.0], 3.0),
        2 => sketch.sphere([0.0, -4.0, -3.0], 5.0),
        3 => sketch.cylinder(3.0, [0.0, -1.0], [0.0, 2.0]),
        4 => sketch.cylinder(3.0, [0.0, -1.0], [-2.0, 0.0]),
        5 => sketch.cylinder(5.0, [3.0, -4.0], [-1.0, 1.0]),
        _ => sketch.cylinder(5.0, [3.0, -4.0], [random.pick(&[0.0, -2.0]), 2.0]),
    };
    let light = random.color(0.2, 0.6);
    sketch.light(light, [0.0, random.decimal(-0.5, 0.5), -2.0]);
    for _ in 0..3 {
        random.object(&mut sketch);
    }
    // Behind the eye, seen in mirrors only.
    sketch.surface(random.finish()).sphere([0.0, 0.0, random.decimal(4.0, 9.0)], random.decimal(0.5, 2.0));
    sketch
}

/// Surfaces through the eye and through lights, to the last of fifty bits or but for it: squares of such lengths are longer
/// than double-double.
fn on_long_surfaces(random: &mut Random) -> Sketch {
    let fov_deg = random.pick(&[60.0, 90.0, 110.0]);
    let mut sketch = random.sketch(fov_deg);
    random.lights(&mut sketch, 1);
    // The eye lies on it, or off it by 2⁻¹²¹.
    let aside = 1.0 / (1u64 << 60) as f64;
    let ([x, z], radius) = random.long_offset_across();
    sketch.surface(random.finish()).sphere([x, random.pick(&[0.0, aside, -aside]), z], radius);
    sketch.surface(random.finish());
    if random.chance(0.5) {
        let ([x, y, z], radius) = random.long_offset();
        sketch.sphere([x, y, z], random.pick(&[radius, radius.next_down(), radius.next_up()]));
    } else {
        let ([x, z], radius) = random.long_offset_across();
        sketch.cylinder(radius, [x, z], random.pick(&[[-1.0, 1.0], [0.0, 1.0], [-1.0, 0.0]]));
    }
    for _ in 0..2 {
        // A coarse place, so that its sums with long offsets are exact.
        let place = random.place().map(|coordinate| (coordinate * 8.0).round() / 8.0);
        let color = random.color(0.1, 0.7);
        sketch.surface(random.finish());
        if random.chance(0.6) {
            let (offset, radius) = random.long_offset();
            sketch.light(color, std::array::from_fn(|axis| place[axis] + offset[axis]));
            sketch.sphere(place, radius);
        } else {
            let ([x, z], radius) = random.long_offset_across();
            let height = random.pick(&[0.0, 0.5, 1.0]);
            sketch.light(color, [place[0] + x, place[1] + height, place[2] + z]);
            sketch.cylinder(radius, [place[0], place[2]], [place[1], place[1] + 1.0]);
        }
    }
    sketch.surface(random.finish()).cylinder(9.0, [0.0, -5.0], [-4.0, -3.0]);
    random.object(&mut sketch);
    sketch
}

/// Objects of a tiny part of the others' size where rays meet them.
fn specks(random: &mut Random, sizes: &[f64]) -> Sketch {
    let mut sketch = random.sketch(60.0);
    random.lights(&mut sketch, 2);
    let depth = random.pick(&[2.0, 3.0, 0.5]);
    for _ in 0..3 {
        let speck = random.pick(sizes);
        let mirror = random.pick(&[0.0, 0.7]);
        sketch.surface(random.finish_reflecting(mirror));
        let place = depth + random.pick(&[0.0, 1.0, 0.25]);
        match random.below(3) {
            0 => sketch.sphere([0.0, 0.0, -place], speck),
            1 => sketch.cylinder(speck, [0.0, -place], [-0.5, random.pick(&[0.5, -0.5 + 1e-15])]),
            _ => sketch.cylinder(speck, [0.0, -place], [-speck, speck]),
        };
    }
    for _ in 0..30 {
        sketch.surface(random.finish()).sphere(random.place(), random.between(1e-5, 1e-2));
    }
    random.object(&mut sketch);
    let reflectance = random.pick(&[0.0, 0.8]);
    sketch.surface(random.finish_reflecting(reflectance)).sphere([0.0, 0.0, -depth - 4.0], 1.0);
    // A speck of light close to the ball.
    let gap = random.pick(&[1e-3, 1e-9, 1e-15]);
    sketch.light([0.5, 0.5, 0.5], [0.0, 0.0, -depth - 3.0 + gap]);
    sketch
}

/// An ordinary scene in front of, in or beside an object of 1e5 to 1e12 times its size.
fn giants(random: &mut Random) -> Sketch {
    let mut sketch = ordinary(random);
    let giant = random.pick(&[1e5, 1e8, 1e12]);
    let mirror = random.pick(&[0.0, 0.6]);
    sketch.surface(random.finish_reflecting(mirror));
    match random.below(5) {
        0 => sketch.sphere([0.0, 0.0, 0.0], giant),
        1 => sketch.sphere([0.0, -giant - 2.0, 0.0], giant),
        2 => sketch.cylinder(giant, [0.0, 0.0], [-giant, -2.0]),
        3 => sketch.cylinder(giant, [giant + 3.0, 0.0], [-1.0, 1.0]),
        _ => sketch.cylinder(giant, [0.0, 0.0], [-2.0, giant]),
    };
    sketch.light([0.4, 0.4, 0.4], [giant, giant, giant]);
    sketch
}

/// An ordinary scene and within it, about the eye, a second one of a small power of ten of its size.
fn scene_in_scene(random: &mut Random, exponents: &[i32]) -> Sketch {
    let mut sketch = ordinary(random);
    let exponent = random.pick(exponents);
    let inner = if random.chance(0.5) { ordinary(random) } else { hall_of_mirrors(random) };
    sketch.items.extend(scaled_by_decimal(&inner, exponent).items);
    sketch
}

/// A mirror that sends every eye ray back through the eye, and on to what lies behind it.
fn centred_mirror(random: &mut Random, units: &[f64]) -> Sketch {
    let fov_deg = random.pick(&[60.0, 90.0, 100.0]);
    let mut sketch = random.sketch(fov_deg);
    random.lights(&mut sketch, 2);
    let radius = random.pick(&[1.0, 3.0, 4.7]);
    let shell = random.decimal(0.3, 0.9);
    sketch.surface(random.finish_reflecting(shell)).sphere([0.0; 3], radius);
    let light = random.color(0.1, 0.6);
    sketch.light(light, [0; 3].map(|_| random.decimal(-0.5 * radius, 0.5 * radius)));
    for _ in 0..1 + random.below(3) {
        let unit = random.pick(units);
        let [x, y] = [0; 2].map(|_| random.decimal(-0.3, 0.3) * unit);
        let z = random.decimal(0.2, 0.5) * unit;
        let size = random.decimal(0.05, 0.25) * unit;
        sketch.surface(random.finish());
        if random.chance(0.6) {
            sketch.sphere([x, y, z], size);
        } else {
            sketch.cylinder(size, [x, z], [y, y + size]);
        }
    }
    sketch
}

fn nothing(random: &mut Random) -> Sketch {
    let mut sketch = random.sketch(60.0);
    match random.below(4) {
        0 => {}
        1 => random.lights(&mut sketch, 2),
        // Objects in the dark, and objects behind the eye.
        2 => {
            for _ in 0..3 {
                random.object(&mut sketch);
            }
        }
        _ => {
            random.lights(&mut sketch, 1);
            sketch.surface(random.finish()).sphere([0.0, 0.0, 5.0], 3.0).cylinder(2.0, [0.0, 6.0], [-1.0, 1.0]);
        }
    }
    sketch
}
