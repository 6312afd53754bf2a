//! Beams: which of some hundreds of objects a packet of reflected rays can meet.
//!
//! A mirror shows neighbouring pixels about the same. One packet of objects after the other is held against the beam that
//! holds a whole packet of rays, and most objects are beside it.
//!
//! # Why nothing is lost
//! Each ray starts within ρ of a point O and runs within an angle θ < 90° of a direction A. So every point of it lies within
//! ρ of the cone with its apex in O. With m from O to the centre of a ball of radius r, q = m·A and p its distance from the
//! axis, the ball lies beside the cone if p·cos θ − q·sin θ, which is the distance to a plane that touches the cone, is more
//! than R = r + ρ; and behind it if q < −R.
//!
//! *Errors*: ρ holds the error of the origins, and cos θ is lowered by that of the directions. What is computed here
//! is off by some roundings of R, which is widened by a share of 2²³u, or of |m|² where squares are compared: less than
//! 2¹³u·|m|².

use crate::plan::{ObjectLists, Scene};
use crate::trace::kernels::{Lanes, Mask, Precision};
use crate::trace::wide::eye::MAX_LANES;
use crate::trace::wide::queue::Rays;

/// More objects are found faster ray by ray, in a tree.
const MAX_OBJECTS: usize = 4096;

/// Beams with a smaller cosine are not looked at.
const MIN_COSINE: f64 = 0.25;

/// What a cosine is lowered by, and what squares are compared with, as a share of |m|², in units of u.
const SLACK: f64 = 8192.0;

/// Returns what radii are multiplied with.
const fn widened(precision: Precision) -> f64 {
    1.0 + (1_u64 << 23) as f64 * precision.u
}

/// Balls around all objects, spheres first.
#[derive(Debug, Default)]
pub(super) struct Balls {
    /// Coordinates of the centres, and the radii; whole packets of them.
    lanes: [Vec<f64>; 4],
    n_balls: usize,
    n_spheres: usize,
}

/// What a packet of rays lies in.
struct Beam {
    origin: [f64; 3],
    dir: [f64; 3],
    /// ρ.
    radius: f64,
    cosine: f64,
    sine: f64,
}

impl Balls {
    /// Lists the objects of a scene, unless they are too many.
    pub fn new(scene: &Scene<'_>, precision: Precision) -> Self {
        let widen = widened(precision);
        let (s, c) = (&scene.spheres, &scene.cylinders);
        let n_balls = s.radius.len() + c.radius.len();
        if n_balls > MAX_OBJECTS {
            return Self::default();
        }
        let spheres = (0..s.radius.len()).map(|i| [s.x[i], s.y[i], s.z[i], s.radius[i] * widen]);
        let cylinders = (0..c.radius.len()).map(|i| {
            let (middle, half) = (0.5 * (c.y_min[i] + c.y_max[i]), 0.5 * (c.y_max[i] - c.y_min[i]));
            let (long, short) = (c.radius[i].max(half), c.radius[i].min(half));
            let reach = long * (1.0 + (short / long) * (short / long)).sqrt() * widen;
            // The middle is off by a rounding.
            [c.x[i], middle, c.z[i], reach + 1e-15 * (c.y_min[i].abs() + c.y_max[i].abs())]
        });
        let mut lanes = [const { Vec::new() }; 4];
        for ball in spheres.chain(cylinders) {
            lanes.iter_mut().zip(ball).for_each(|(lane, number)| lane.push(number));
        }
        let n_whole = n_balls.next_multiple_of(MAX_LANES);
        lanes.iter_mut().for_each(|lane| lane.resize(n_whole, 0.0));
        Self { lanes, n_balls, n_spheres: s.radius.len() }
    }

    /// Tells whether no object is listed.
    pub fn are_none(&self) -> bool {
        self.n_balls == 0
    }

    /// Lists what the rays can meet; `false` when they run too far apart, or the objects are too many.
    #[inline(always)]
    pub fn list<L: Lanes>(&self, rays: &Rays<L>, active: L::Mask, found: &mut ObjectLists) -> bool {
        if self.are_none() {
            return false;
        }
        let Some(beam) = Beam::new(rays, active) else { return false };
        found.clear();
        let mut first = 0;
        while first < self.n_balls {
            let mut rest = self.meet::<L>(&beam, first).bits();
            while rest != 0 {
                let i = first + rest.trailing_zeros() as usize;
                rest &= rest - 1;
                if i < self.n_spheres {
                    found.spheres.push(i as u32);
                } else if i < self.n_balls {
                    found.cylinders.push((i - self.n_spheres) as u32);
                }
            }
            first += L::N;
        }
        true
    }

    /// Tells which balls from one on may meet a beam.
    #[inline(always)]
    fn meet<L: Lanes>(&self, beam: &Beam, first: usize) -> L::Mask {
        let [x, y, z, radius] = &self.lanes;
        let m = [
            L::load(&x[first..]) - L::splat(beam.origin[0]),
            L::load(&y[first..]) - L::splat(beam.origin[1]),
            L::load(&z[first..]) - L::splat(beam.origin[2]),
        ];
        let reach = L::load(&radius[first..]) + L::splat(beam.radius);
        let squared = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
        let along = m[0] * L::splat(beam.dir[0]) + m[1] * L::splat(beam.dir[1]) + m[2] * L::splat(beam.dir[2]);
        let along_squared = along * along;
        let slack = squared * L::splat(SLACK * L::U);
        let allowed = (reach + along * L::splat(beam.sine)).max(L::splat(0.0));
        let across_squared = (squared - along_squared) * L::splat(beam.cosine * beam.cosine);
        let is_beside = across_squared.gt(allowed * allowed + slack);
        let is_behind = along.lt(L::splat(0.0)) & along_squared.gt(reach * reach + slack);
        !(is_beside | is_behind)
    }
}

impl Beam {
    /// Bounds the active rays, of which there is one, by how far they are from one in their middle; `None` when they run too
    /// far apart.
    #[inline(always)]
    fn new<L: Lanes>(rays: &Rays<L>, active: L::Mask) -> Option<Self> {
        let middle = middle_of(active.bits(), L::N);
        let mut numbers = [[0.0; MAX_LANES]; 6];
        for k in 0..3 {
            rays.origin[k].store(&mut numbers[k]);
            rays.dir[k].store(&mut numbers[3 + k]);
        }
        let [x, y, z, dx, dy, dz] = numbers.map(|lanes| lanes[middle]);
        let length = (dx * dx + dy * dy + dz * dz).sqrt();
        let dir = [dx / length, dy / length, dz / length];
        let off = [rays.origin[0] - L::splat(x), rays.origin[1] - L::splat(y), rays.origin[2] - L::splat(z)];
        let distance_squared = off[0] * off[0] + off[1] * off[1] + off[2] * off[2];
        let cosine = rays.dir[0] * L::splat(dir[0]) + rays.dir[1] * L::splat(dir[1]) + rays.dir[2] * L::splat(dir[2]);
        let turned = L::splat(1.0) - (cosine - rays.dir_error);
        let distance = largest(distance_squared, active).sqrt();
        let cosine = 1.0 - largest(turned, active) - SLACK * L::U;
        let radius = (distance + largest(rays.origin_error, active)) * widened(L::PRECISION);
        let is_narrow = cosine > MIN_COSINE && radius < f64::INFINITY;
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        is_narrow.then_some(Self { origin: [x, y, z], dir, radius, cosine, sine })
    }
}

/// Returns the lane of the mask that is about in the middle.
#[inline(always)]
fn middle_of(bits: u32, n_lanes: usize) -> usize {
    let half = n_lanes / 2;
    let upper = bits >> half;
    if upper != 0 { half + upper.trailing_zeros() as usize % half } else { bits.checked_ilog2().unwrap_or(0) as usize }
}

/// Returns the largest number of the lanes of the mask, at least 0; what is no number is infinite.
#[inline(always)]
fn largest<L: Lanes>(numbers: L, lanes: L::Mask) -> f64 {
    let mut each = [0.0; MAX_LANES];
    L::select(lanes, numbers, L::splat(0.0)).store(&mut each);
    let mut largest = 0.0;
    for lane in 0..L::N {
        if each[lane] > largest || each[lane].is_nan() {
            largest = if each[lane].is_nan() { f64::INFINITY } else { each[lane] };
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{CylinderLanes, SphereLanes};
    use crate::testing::Stream;
    use crate::trace::kernels::{Backend, Job};

    /// Lists what some rays, origin, direction and errors each, may meet.
    struct List<'a>(&'a Balls, &'a [[f64; MAX_LANES]; 9], u32);

    impl Job for List<'_> {
        type Output = Option<ObjectLists>;

        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Output {
            let numbers = self.1.each_ref().map(|numbers| L::load(numbers));
            let [ox, oy, oz, dx, dy, dz, origin_error, dir_error, leaving] = numbers;
            let rays = Rays { origin: [ox, oy, oz], dir: [dx, dy, dz], origin_error, dir_error, leaving };
            let mut found = ObjectLists::default();
            self.0.list(&rays, L::Mask::from_bits(self.2), &mut found).then_some(found)
        }
    }

    /// Each true ray touches one sphere, from inside by a rounding, and the rays that are given are off by their errors.
    #[test]
    fn what_a_ray_grazes_is_listed() {
        let mut stream = Stream::new(61);
        let (mut n_listed, mut n_left_out) = (0, 0);
        for round in 0..4000 {
            let mut lanes = SphereLanes::default();
            let mut numbers = [[0.0; MAX_LANES]; 9];
            let spread = libm::exp2(stream.between(-12.0, 0.0));
            let error = libm::exp2(stream.between(-50.0, -10.0));
            let mut vector = |size: f64| [0; 3].map(|_| size * stream.between(-1.0, 1.0));
            let (origin, dir) = (vector(1.0), vector(1.0));
            let unit = |v: [f64; 3]| {
                let length = libm::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
                v.map(|c| c / length)
            };
            let dir = unit(dir);
            for lane in 0..MAX_LANES {
                let mut near = |v: [f64; 3], size: f64| v.map(|c| c + size * stream.between(-0.5, 0.5));
                let (true_origin, true_dir) = (near(origin, spread), unit(near(dir, 0.3 * spread)));
                let (its_origin, its_dir) = (near(true_origin, error), near(true_dir, error));
                let aside = near([0.0; 3], 1.0);
                let along = aside[0] * true_dir[0] + aside[1] * true_dir[1] + aside[2] * true_dir[2];
                let across: [f64; 3] = std::array::from_fn(|k| aside[k] - along * true_dir[k]);
                let radius = libm::exp2(stream.between(-20.0, 0.0));
                let (across, t) = (unit(across), stream.unit() * 2.0);
                let center: [f64; 3] = std::array::from_fn(|k| true_origin[k] + t * true_dir[k] + across[k] * radius);
                lanes.x.push(center[0]);
                lanes.y.push(center[1]);
                lanes.z.push(center[2]);
                lanes.radius.push(radius + 1e-15);
                for k in 0..3 {
                    (numbers[k][lane], numbers[3 + k][lane]) = (its_origin[k], its_dir[k]);
                }
                (numbers[6][lane], numbers[7][lane]) = (error, error);
            }
            let scene = Scene::of_shapes(lanes, CylinderLanes::default());
            let balls = Balls::new(&scene, Precision::BINARY64);
            let active = 1 + stream.below(0xff) as u32;
            let job = || List(&balls, &numbers, active);
            let Some(found) = Backend::best().run(job()) else { continue };
            assert_eq!(Some(&found), Backend::Scalar.run(job()).as_ref());
            for lane in (0..8).filter(|lane| active >> lane & 1 != 0) {
                assert!(found.spheres.contains(&lane), "{round} {lane}");
            }
            n_listed += found.spheres.len();
            n_left_out += MAX_LANES - found.spheres.len();
        }
        assert!(n_listed > 5000 && n_left_out > 1000, "{n_listed} {n_left_out}");
    }
}
