//! Patches: what can hide the lights from the part of a face that some neighbouring eye rays meet.
//!
//! The plan knows what may lie between a light and all of a face. The packets of a tile that meet the face one after the
//! other meet only a patch of it, and between a patch and a light there is mostly less, and often nothing; or all of it
//! faces away from the light, or lies in one shadow. What is found for the patch once serves all of its packets. How large
//! a patch is does not matter for what follows; a tile bounds it.
//!
//! # Why it is safe
//! *The ball.* The computed points are t·(dx, dy, −1) for some t, dx, dy in three intervals. They lie in the box that has
//! the least and the largest products as its corners, widened by roundings, and the exact points are no farther from them
//! than the bound on the error of the face's points, e. So all of them lie in a ball: of centre C, the middle of the box, and
//! of radius R, half of its diagonal and what was said.
//!
//! *Spheres.* With the light outside of the ball, at W from C, and outside of a sphere of radius r at M from its centre, the
//! light sees the two under half angles of sines R/W and r/M. With w and m from the light to the centres, and the lengths of
//! the tangents, P² = W² − R² and p² = M² − r²:
//! - if w·m < P·p − R·r, the angle between w and m is larger than both half angles together, whose cosine that is over W·M: no
//!   segment from the light to the ball meets the sphere. None does either if M − r > W + R, since the sphere begins behind
//!   the ball's end;
//! - if w·m > P·p + R·r and r/M > R/W, the half angle of the sphere is larger than the angle between w and m and that of the
//!   ball together: each ray from the light to the ball meets the sphere, no farther away than p. If W − R > p, it does so
//!   before the point; and since points lie outside of spheres or on them, all of them are hidden.
//!
//! *Cylinders.* The same from above, in x and z, is said of the infinite wall, and that none of it is met is all that is used.
//! Along a segment to a point at the distance s from the light, from above, heights change evenly; what is inside of the
//! wall lies at distances from M − r to M + r. So if light and wall are apart, heights inside are the light's and from
//! (M − r)/(W + R) to (M + r)/(W − R) of the way to the point's, at most all of it. If all of them are above the cylinder, or
//! below, it is not met.
//!
//! *The face.* A point P of a sphere or wall of centre c faces the light l exactly if (P − c)·(l − c) > r². In the ball the left
//! side is at most (C − c)·(l − c) + R·|l − c|. A cap faces the light or not.
//!
//! *Errors.* Each side of a comparison is the sum of at most some ten products of two lengths, each off by a few roundings
//! of what the slack is a share of: [`SLACK`] is some thousand roundings. What is no number proves nothing.

use crate::trace::kernels::{Lanes, Mask};
use crate::trace::wide::bounds::{Bounds, Face, FaceKind, Occluder, Side, WideLight};
use crate::trace::wide::eye::{LaneArray, MAX_LANES};
use crate::trace::wide::shadow::LightOccluders;
use crate::trace::wide::tile::TileJob;
use crate::trace::wide::{Scratch, TILE_WIDTH};

/// What comparisons are widened by, as a share of the product of the largest lengths in them: 2⁻⁴⁰.
const SLACK: f64 = 1.0 / (1_u64 << 40) as f64;

/// Of so many packets at most a patch is made.
const MAX_PACKETS: usize = 16;

/// Fewer packets are held against what the plan has left.
const MIN_PACKETS: usize = 3;

/// The patches of a tile, in the order of its hits.
#[derive(Debug, Default)]
pub(super) struct Patches {
    /// Only the first `n` are of this tile.
    patches: Vec<Patch>,
    n: usize,
    /// The patch that was asked for last.
    current: usize,
}

/// What is known of one patch.
#[derive(Debug, Default)]
struct Patch {
    /// The place of its first packet among the hits of the tile, and that behind its last.
    first: usize,
    end: usize,
    /// What can hide each light from it.
    occluders: LightOccluders,
}

/// Where the points of a patch lie: t·(dx, dy, −1) for numbers of these intervals.
#[derive(Clone, Copy, Debug)]
struct Slab {
    t: [f64; 2],
    dx: [f64; 2],
    dy: [f64; 2],
}

/// What each light sees of each object.
#[derive(Clone, Debug)]
pub(super) struct Outlines(Vec<[Vec<Outline>; 2]>);

/// A sphere as a light outside of it sees it, or a wall as it is seen from above, where m has no height.
#[derive(Clone, Copy, Debug)]
struct Outline {
    m: [f64; 3],
    /// M, rounded up.
    m_length: f64,
    radius: f64,
    /// p; not a number if the light is not outside.
    tangent: f64,
}

impl Outlines {
    /// Works out what the lights see.
    pub fn new(lights: &[WideLight]) -> Self {
        let outlines = |occluders: &[Occluder]| occluders.iter().map(Outline::new).collect();
        Self(lights.iter().map(|light| [outlines(&light.spheres), outlines(&light.cylinders)]).collect())
    }
}

impl Outline {
    fn new(occluder: &Occluder) -> Self {
        let tangent = if occluder.side == Side::Outside { occluder.power.sqrt() } else { f64::NAN };
        Self { m: occluder.m, m_length: occluder.m_length, radius: occluder.radius_squared.sqrt(), tangent }
    }
}

impl TileJob<'_> {
    /// Looks at the patches of the tile's hits, which are sorted.
    #[inline(always)]
    pub fn look_at_patches<L: Lanes>(&mut self) {
        self.scratch.patches.clear();
        let Some(outlines) = &self.wide.outlines else { return };
        let (bounds, n_hits) = (&self.wide.bounds, self.scratch.hits.len());
        let mut end = 0;
        while end < n_hits {
            let first = end;
            let face_idx = self.scratch.hits[first].face;
            let last = n_hits.min(first + MAX_PACKETS);
            while end < last && self.scratch.hits[end].face == face_idx {
                end += 1;
            }
            let face = &bounds.faces[face_idx as usize];
            if end - first < MIN_PACKETS || !bounds.terms[face.surface].answers() || self.is_in_flock(face_idx) {
                continue;
            }
            let whole = self.occluders(face, None);
            if whole.are_none() {
                continue;
            }
            let slab = self.slab::<L>(first, end);
            let patch = self.scratch.patches.add(first, end);
            patch.look_at(bounds, outlines, face, &slab, whole);
        }
    }

    /// Tells whether packets that meet a face may be followed as a flock.
    fn is_in_flock(&self, face: u32) -> bool {
        self.wide.flock.as_ref().is_some_and(|flock| flock.ball_of(face as usize).is_some())
    }

    /// Bounds the points of some packets of hits.
    #[inline(always)]
    fn slab<L: Lanes>(&self, first: usize, end: usize) -> Slab {
        let Scratch { hits, t, .. } = &*self.scratch;
        let (mut near, mut minus_far) = (L::splat(f64::INFINITY), L::splat(0.0));
        let (mut left, mut right) = (TILE_WIDTH, 0);
        for i in first..end {
            let (packet, lanes) = (hits[i].packet as usize, L::Mask::from_bits(hits[i].lanes));
            let numbers = L::load(&t[packet * L::N..]);
            near = L::select(lanes, numbers, near).min(near);
            minus_far = L::select(lanes, -numbers, minus_far).min(minus_far);
            left = left.min(packet * L::N % TILE_WIDTH);
            right = right.max(packet * L::N % TILE_WIDTH);
        }
        let [top, bottom] = [first, end - 1].map(|i| hits[i].packet as usize * L::N / TILE_WIDTH);
        let ([low_x, high_y], [high_x, low_y]) = (self.slopes(left, top), self.slopes(right + L::N - 1, bottom));
        Slab { t: [smallest(near), -smallest(minus_far)], dx: [low_x, high_x], dy: [low_y, high_y] }
    }

    /// Returns dx and dy of the eye ray through the sample at hand of a pixel of the tile.
    fn slopes(&self, column: usize, row: usize) -> [f64; 2] {
        let (left, top) =
            self.sampling.first_sample(self.rect.columns.start + column as u32, self.rect.rows.start + row as u32);
        let (left, top) = (left + i64::from(2 * self.sample[0]), top - i64::from(2 * self.sample[1]));
        [left as f64 * self.wide.step, top as f64 * self.wide.step]
    }
}

/// Returns the smallest of some numbers.
#[inline(always)]
fn smallest<L: Lanes>(numbers: L) -> f64 {
    let mut lanes = LaneArray([0.0; MAX_LANES]);
    numbers.store(&mut lanes.0);
    let mut smallest = lanes.0[0];
    for lane in 1..L::N {
        smallest = if lanes.0[lane] < smallest { lanes.0[lane] } else { smallest };
    }
    smallest
}

impl Patches {
    /// Makes room for those of another tile.
    fn clear(&mut self) {
        (self.n, self.current) = (0, 0);
    }

    /// Adds a patch of some packets of hits, of which nothing is known yet.
    fn add(&mut self, first: usize, end: usize) -> &mut Patch {
        if self.n == self.patches.len() {
            self.patches.push(Patch::default());
        }
        self.n += 1;
        let patch = &mut self.patches[self.n - 1];
        (patch.first, patch.end) = (first, end);
        patch
    }

    /// Returns what can hide each light from a packet of hits, if it belongs to a patch that was looked at; hits are asked for in
    /// order.
    #[inline(always)]
    pub fn at(&mut self, hit_idx: usize) -> Option<&LightOccluders> {
        while self.current < self.n && self.patches[self.current].end <= hit_idx {
            self.current += 1;
        }
        let patch = &self.patches[..self.n].get(self.current)?;
        (patch.first <= hit_idx).then_some(&patch.occluders)
    }
}

impl Patch {
    /// Finds out what can hide each light from a part of a face.
    ///
    /// `whole`: what can hide it from all of the face.
    #[inline(never)]
    fn look_at(&mut self, bounds: &Bounds, outlines: &Outlines, face: &Face, slab: &Slab, whole: &LightOccluders) {
        let ball = Ball::new(slab, 2.0 * face.eye_point_error, bounds.eye.precision.u);
        for (light_idx, light) in bounds.lights.iter().enumerate() {
            let [its_spheres, its_cylinders] = &outlines.0[light_idx];
            let [spheres, cylinders] = whole.of_light(light_idx);
            let sight = Sight::new(&ball, light.position);
            let is_dark = whole.is_hidden(light_idx)
                || ball.faces_away(face, light.position)
                || spheres.iter().any(|&i| sight.is_behind(&its_spheres[i as usize]));
            let may_pass = |i: &u32| !is_dark && !sight.passes_sphere(&its_spheres[*i as usize]);
            let may_stand = |i: &u32| {
                !is_dark && !sight.passes_cylinder(&its_cylinders[*i as usize], &light.cylinders[*i as usize])
            };
            let spheres = spheres.iter().copied().filter(may_pass);
            self.occluders.list(light_idx, is_dark, spheres, cylinders.iter().copied().filter(may_stand));
        }
    }
}

/// A ball around the points of a patch.
struct Ball {
    center: [f64; 3],
    radius: f64,
}

impl Ball {
    /// `error`: how far points may be off; `u`: what a rounding is.
    fn new(slab: &Slab, error: f64, u: f64) -> Self {
        let [near, far] = slab.t;
        let products = |[low, high]: [f64; 2]| [(low * near).min(low * far), (high * near).max(high * far)];
        let sides = [products(slab.dx), products(slab.dy), [-far, -near]];
        let center = sides.map(|[low, high]| 0.5 * (low + high));
        let largest = sides.iter().map(|[low, high]| low.abs().max(high.abs())).sum::<f64>();
        let half = length(sides.map(|[low, high]| 0.5 * (high - low)));
        Self { center, radius: half * (1.0 + SLACK) + (16.0 * u + SLACK) * largest + error }
    }

    /// Proves that no point faces a light, if it can.
    fn faces_away(&self, face: &Face, light: [f64; 3]) -> bool {
        let height = face.center[1];
        let is_round = match face.kind {
            FaceKind::Sphere => 1.0,
            FaceKind::Wall => 0.0,
            FaceKind::UpperCap => return light[1] <= height,
            FaceKind::LowerCap => return light[1] >= height,
        };
        let from_center = |point: [f64; 3]| {
            let [x, y, z] = difference(point, face.center);
            [x, is_round * y, z]
        };
        let (middle, way) = (from_center(self.center), from_center(light));
        let (reach, length) = (length(middle) + self.radius, length(way));
        let squared = face.radius * face.radius;
        face.per_radius > 0.0 && dot(middle, way) + self.radius * length < squared - SLACK * (squared + reach * length)
    }
}

/// A ball as a light sees it.
struct Sight {
    /// w, W and P, the last not a number if the light is not outside.
    way: [f64; 3],
    length: f64,
    tangent: f64,
    /// The same from above.
    level_length: f64,
    level_tangent: f64,
    radius: f64,
    light_height: f64,
}

impl Sight {
    fn new(ball: &Ball, light: [f64; 3]) -> Self {
        let way = difference(ball.center, light);
        let (length, level_length) = (length(way), length([way[0], 0.0, way[2]]));
        let tangent = |length: f64| ((length - ball.radius) * (length + ball.radius)).sqrt();
        Self {
            way,
            length,
            tangent: tangent(length),
            level_length,
            level_tangent: tangent(level_length),
            radius: ball.radius,
            light_height: light[1],
        }
    }

    /// Proves that no segment from the light to the ball meets a sphere, if it can.
    fn passes_sphere(&self, sphere: &Outline) -> bool {
        self.passes(sphere, self.length, self.tangent)
    }

    /// Proves that all of the ball that is outside of a sphere is hidden behind it, if it can.
    fn is_behind(&self, sphere: &Outline) -> bool {
        let slack = SLACK * self.length * sphere.m_length;
        let together = self.tangent * sphere.tangent + self.radius * sphere.radius + slack;
        dot(self.way, sphere.m) > together
            && sphere.radius * self.length > self.radius * sphere.m_length + slack
            && self.length - self.radius > sphere.tangent + SLACK * (self.length + sphere.m_length)
    }

    /// Proves that no segment from the light to the ball meets a cylinder, if it can.
    fn passes_cylinder(&self, wall: &Outline, cylinder: &Occluder) -> bool {
        self.passes(wall, self.level_length, self.level_tangent) || self.passes_over(wall, cylinder)
    }

    /// `length`, `tangent`: of the ball, as it is seen.
    fn passes(&self, outline: &Outline, length: f64, tangent: f64) -> bool {
        let apart = tangent * outline.tangent - self.radius * outline.radius - SLACK * length * outline.m_length;
        let near = outline.tangent * outline.tangent / (outline.m_length + outline.radius);
        dot(self.way, outline.m) < apart || near > (length + self.radius) * (1.0 + SLACK)
    }

    /// Proves that all segments pass over or under a cylinder, if it can.
    fn passes_over(&self, wall: &Outline, cylinder: &Occluder) -> bool {
        let (low, high) = (self.way[1] - self.radius, self.way[1] + self.radius);
        // Shares of the way, from above: all of it if the light is in line.
        let near = wall.tangent * wall.tangent / (wall.m_length + wall.radius);
        let first = (near / (self.level_length + self.radius) * (1.0 - SLACK)).max(0.0);
        let last = (wall.m_length + wall.radius) / (self.level_length - self.radius) * (1.0 + SLACK);
        let last = if last > 0.0 { last.min(1.0) } else { 1.0 };
        let slack = SLACK * (self.light_height.abs() + low.abs().max(high.abs()));
        let lowest = self.light_height + (low * first).min(low * last) - slack;
        let highest = self.light_height + (high * first).max(high * last) + slack;
        lowest > cylinder.y_max || highest < cylinder.y_min
    }
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Object;
    use crate::testing::Stream;

    /// What a sphere or wall is to a light, as [`Outlines`] takes it.
    fn occluder(m: [f64; 3], radius: f64, [y_min, y_max]: [f64; 2]) -> Occluder {
        let power = dot(m, m) - radius * radius;
        let side = if power > 1e-9 * dot(m, m) { Side::Outside } else { Side::Unknown };
        let m_length = 1.001 * length(m);
        let radius_squared = radius * radius;
        Occluder { m, m_length, power, slack: 0.0, radius_squared, y_min, y_max, side, equation: f64::NAN }
    }

    fn vector(stream: &mut Stream, size: f64) -> [f64; 3] {
        [0; 3].map(|_| size * stream.between(-1.0, 1.0))
    }

    /// A light, a ball, and a point on the ball's surface, sometimes within.
    fn random_ball(stream: &mut Stream) -> ([f64; 3], Ball, [f64; 3]) {
        let (light, center, off) = (vector(stream, 4.0), vector(stream, 2.0), vector(stream, 1.0));
        let radius = libm::exp2(stream.between(-12.0, 0.0));
        let share = radius / length(off) * if stream.unit() < 0.8 { 1.0 - 1e-12 } else { stream.unit() };
        (light, Ball { center, radius }, std::array::from_fn(|k| center[k] + off[k] * share))
    }

    /// Returns a vector of some length that is at right angles to another, more or less.
    fn across(stream: &mut Stream, way: [f64; 3], size: f64, lean: f64) -> [f64; 3] {
        let off = vector(stream, 1.0);
        let along = dot(off, way) / dot(way, way) * (1.0 - lean * stream.unit());
        let off: [f64; 3] = std::array::from_fn(|k| off[k] - along * way[k]);
        off.map(|c| c * size / length(off))
    }

    /// A segment from a light to a point of a ball touches a sphere or a cylinder, from inside by a rounding: it does not pass.
    #[test]
    fn what_a_segment_grazes_is_not_passed() {
        let mut stream = Stream::new(81);
        let (mut n_spheres, mut n_cylinders) = (0, 0);
        for _ in 0..300_000 {
            let (light, ball, point) = random_ball(&mut stream);
            let (sight, way) = (Sight::new(&ball, light), difference(point, light));
            let (share, radius) = (stream.unit(), libm::exp2(stream.between(-10.0, 2.0)));
            let lean = if stream.unit() < 0.5 { 0.0 } else { 1.0 };
            let touched = way.map(|c| share * c);
            let off = across(&mut stream, way, radius, lean);
            let m: [f64; 3] = std::array::from_fn(|k| touched[k] + off[k]);
            let sphere = occluder(m, radius * (1.0 + 1e-11), [0.0; 2]);
            assert!(!sight.passes_sphere(&Outline::new(&sphere)), "{light:?} {point:?} {m:?} {radius}");
            n_spheres += usize::from(sphere.side == Side::Outside);
            // Of a cylinder the touched point is at the wall, at a rim or at a cap.
            let level = across(&mut stream, [way[0], 0.0, way[2]], 1.0, lean);
            let share = radius / level[0].hypot(level[2]) * if stream.unit() < 0.5 { 1.0 } else { stream.unit() };
            let m = [touched[0] + level[0] * share, 0.0, touched[2] + level[2] * share];
            let height = light[1] + touched[1];
            let [below, above] = [0; 2].map(|_| if stream.unit() < 0.4 { 1e-11 } else { stream.unit() });
            let cylinder = occluder(m, radius * (1.0 + 1e-11), [height - below, height + above]);
            assert!(!sight.passes_cylinder(&Outline::new(&cylinder), &cylinder), "{light:?} {point:?} {cylinder:?}");
            n_cylinders += usize::from(cylinder.side == Side::Outside);
        }
        assert!(n_spheres > 100_000 && n_cylinders > 50_000, "{n_spheres} {n_cylinders}");
    }

    /// Returns how much of a segment's way, from the light, lies before it meets a sphere.
    fn share_before(way: [f64; 3], sphere: &Occluder) -> Option<f64> {
        let (a, b) = (dot(way, way), dot(way, sphere.m));
        let discriminant = b * b - a * sphere.power;
        (discriminant > 0.0).then(|| (b - discriminant.sqrt()) / a)
    }

    #[test]
    fn verdicts_hold_and_are_not_rare() {
        let mut stream = Stream::new(82);
        let mut n = [0; 4];
        for _ in 0..200_000 {
            let (light, ball, point) = random_ball(&mut stream);
            let (sight, way) = (Sight::new(&ball, light), difference(point, light));
            let center = vector(&mut stream, 2.0);
            let radius = libm::exp2(stream.between(-3.0, 1.0));
            let sphere = occluder(difference(center, light), radius, [0.0; 2]);
            let is_outside = length(difference(point, center)) > radius;
            if sphere.side == Side::Outside && is_outside && sight.is_behind(&Outline::new(&sphere)) {
                assert!(share_before(way, &sphere).is_some_and(|share| share < 1.0), "{light:?} {point:?} {sphere:?}");
                n[0] += 1;
            }
            n[1] += usize::from(sight.passes_sphere(&Outline::new(&sphere)));
            let cylinder = occluder([sphere.m[0], 0.0, sphere.m[2]], radius, [center[1] - radius, center[1]]);
            n[2] += usize::from(sight.passes_cylinder(&Outline::new(&cylinder), &cylinder));
            // The ball holds a point of the sphere that is shaded.
            let out = difference(point, center);
            let face = face_of(center, length(out));
            if ball.faces_away(&face, light) {
                assert!(dot(out, way) >= 0.0, "{light:?} {point:?} {center:?}");
                n[3] += 1;
            }
        }
        assert!(n.iter().all(|n| *n > 5000), "{n:?}");
    }

    fn face_of(center: [f64; 3], radius: f64) -> Face {
        Face {
            kind: FaceKind::Sphere,
            object: Object::Sphere(0),
            order: 0,
            equation: 0,
            surface: 0,
            center,
            radius,
            per_radius: 1.0 / radius,
            is_vague: false,
            group: None,
            eye_point_error: 0.0,
            eye_normal_error: 0.0,
            eye_error_at_right_angles: 0.0,
        }
    }
}
