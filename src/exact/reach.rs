//! The only binary64 of the renderer: leaving out bodies that a ray misses by a wide margin.
//!
//! # Proof
//! Lengths are taken in units U of the largest one at hand and directions in units V of the largest component, so that
//! |o|, |c|, r ≤ 1, |d| ≤ 1 and o − c ≤ 2 in every component. Then a = d·d ≤ 3, b = d·(o − c) ≤ 6, c = |o − c|² − r² ≤ 12,
//! and b² − ac ≤ 72. A component of o or d is off by at most 2⁻³⁹, of c by 2⁻⁵²; with that a is off by at most 2⁻³⁶, b by
//! 2⁻³⁵, c by 2⁻³⁴ and b² − ac by 2·6·2⁻³⁵ + 12·2⁻³⁶ + 3·2⁻³⁴ < 2⁻³⁰, the roundings of binary64 included, which are smaller by
//! far. [`Reach::MARGIN`] is more than a thousand times that. The ray
//! - misses where b² − ac < 0,
//! - has both roots behind its origin where c > 0 and b > 0,
//! - has both roots beyond T where c > 0 and the nearer one is, which is at least (−b − r√a)/a, since b² − ac ≤ a r² by the
//!   inequality of Cauchy and Schwarz. Where −b − r√a > T·a is asked, −b is above the margin and at most √a·|o − c| ≤ 4√a, so
//!   √a > 2⁻¹⁹. The error of a is at most 2⁻³⁷√a, that of √a half of 2⁻³⁷, and that of T·a ≤ 4√a below 2⁻³⁴, with T good to
//!   2⁻³⁹ of itself.
//!
//! U and V lie within 2^±900, T and T·V are normal numbers, and so nothing is lost to underflow that could matter.

use crate::exact::real::Real;
use crate::exact::vec3::Vec3;

/// What a body is for the filter: a sphere, or an endless upright cylinder.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    pub center: [f64; 3],
    pub radius: f64,
    /// The axes of its equation: all, or x and z.
    pub axes: &'static [usize],
}

/// 2^900: units lie between this and its reciprocal.
const LARGEST_UNIT: f64 = f64::from_bits((1023 + 900) << 52);

/// Bits to which numbers have to be known, of the largest of their kind.
const SHARP_BITS: i64 = 40;

impl Reach {
    /// See the proof above.
    const MARGIN: f64 = 1.0 / 65536.0;

    /// Tells whether the ray misses by a wide margin, or meets only far behind `t_max`; NaN and infinities answer no.
    pub fn is_surely_missed(&self, ray: &ApproxRay, t_max: f64) -> bool {
        let length_unit = ray.origin_unit.max(largest(self.center)).max(self.radius);
        let dir_unit = ray.dir_unit;
        if !is_unit(length_unit) || !is_unit(dir_unit) {
            return false;
        }
        let [mut a, mut b, mut c] = [0.0; 3];
        for &axis in self.axes {
            let from_center = ray.origin[axis] / length_unit - self.center[axis] / length_unit;
            let dir = ray.dir[axis] / dir_unit;
            a += dir * dir;
            b += dir * from_center;
            c += from_center * from_center;
        }
        let radius = self.radius / length_unit;
        c -= radius * radius;
        let is_beside = b * b - a * c < -Self::MARGIN;
        let is_before = c > Self::MARGIN;
        let far = t_max * dir_unit;
        let is_beyond = far.is_normal() && -b - radius * a.sqrt() - Self::MARGIN > a * (far / length_unit);
        is_beside || is_before && (b > Self::MARGIN || is_beyond)
    }

    /// Tells whether a point lies off the surface by a wide margin: the c of the proof above is far from 0.
    pub fn is_surely_off(&self, point: [f64; 3]) -> bool {
        let length_unit = largest(point).max(largest(self.center)).max(self.radius);
        if !is_unit(length_unit) {
            return false;
        }
        let radius = self.radius / length_unit;
        let offsets = self.axes.iter().map(|&axis| point[axis] / length_unit - self.center[axis] / length_unit);
        let c = offsets.map(|offset| offset * offset).sum::<f64>() - radius * radius;
        c.abs() > Self::MARGIN
    }
}

fn largest(v: [f64; 3]) -> f64 {
    v.into_iter().fold(0.0, |largest, component: f64| largest.max(component.abs()))
}

fn is_unit(unit: f64) -> bool {
    unit < LARGEST_UNIT && unit > 1.0 / LARGEST_UNIT
}

/// A ray in binary64, each component good to 2⁻³⁹ of the largest.
#[derive(Debug)]
pub struct ApproxRay {
    origin: [f64; 3],
    dir: [f64; 3],
    /// The largest component.
    origin_unit: f64,
    dir_unit: f64,
}

impl ApproxRay {
    /// Returns the ray in binary64, if it is known well enough.
    pub fn new(origin: &Vec3, dir: &Vec3) -> Option<Self> {
        let (origin, dir) = (approximate(origin)?, approximate(dir)?);
        Some(Self { origin_unit: largest(origin), dir_unit: largest(dir), origin, dir })
    }
}

/// Returns a vector in binary64 if every component is known to 2⁻⁴⁰ of the largest.
fn approximate(v: &Vec3) -> Option<[f64; 3]> {
    let approx = [0, 1, 2].map(|axis| v[axis].to_f64());
    let largest = (0..3).max_by(|&a, &b| approx[a].abs().total_cmp(&approx[b].abs()))?;
    v.iter().all(|component| component.is_sharp_beside(&v[largest], SHARP_BITS)).then_some(approx)
}

/// Returns a number in binary64 if it is known to 2⁻⁴⁰ of itself and normal there, else infinity.
pub fn approximate_bound(t: &Real) -> f64 {
    let approx = t.to_f64();
    if approx.is_normal() && t.is_sharp_beside(t, SHARP_BITS) { approx } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Stream;

    const SPHERE: &[usize] = &[0, 1, 2];
    const WALL: &[usize] = &[0, 2];

    /// A sphere or an endless cylinder of any size at any place.
    fn reach(stream: &mut Stream) -> Reach {
        let scale = libm::exp2(stream.between(-300.0, 300.0));
        let center = [0; 3].map(|_| scale * stream.between(-1.0, 1.0));
        let radius = scale * libm::exp2(stream.between(-3.0, 1.0));
        Reach { center, radius, axes: [SPHERE, WALL][stream.below(2)] }
    }

    fn along(axes: &[usize], a: [f64; 3], b: [f64; 3]) -> f64 {
        axes.iter().map(|&axis| a[axis] * b[axis]).sum()
    }

    /// A vector of length 1, along the axes that count.
    fn unit(stream: &mut Stream, axes: &[usize]) -> [f64; 3] {
        let mut v = [0.0; 3];
        axes.iter().for_each(|&axis| v[axis] = stream.between(-1.0, 1.0));
        let length = along(axes, v, v).sqrt();
        v.map(|c| c / length)
    }

    /// A ray that passes the centre at `share` of the radius, `far` radii from where it starts; and the t at which it does.
    fn passing(stream: &mut Stream, reach: &Reach, share: f64, far: f64) -> (ApproxRay, f64) {
        let dir = unit(stream, reach.axes);
        let aside = unit(stream, reach.axes);
        let dot = along(reach.axes, aside, dir);
        let across: [f64; 3] = std::array::from_fn(|k| aside[k] - dot * dir[k]);
        let length = along(reach.axes, across, across).sqrt();
        let Reach { center, radius, .. } = *reach;
        let origin = std::array::from_fn(|k| center[k] + radius * (share * across[k] / length - far * dir[k]));
        let speed = libm::exp2(stream.between(-300.0, 300.0));
        let dir = dir.map(|d| d * speed);
        (ApproxRay { origin, dir, origin_unit: largest(origin), dir_unit: largest(dir) }, far * radius / speed)
    }

    #[test]
    fn points_on_a_surface_are_not_off_and_others_are() {
        let mut stream = Stream::new(41);
        for _ in 0..50_000 {
            let reach = reach(&mut stream);
            let way = unit(&mut stream, reach.axes);
            let at = |share: f64| std::array::from_fn(|k| reach.center[k] + share * reach.radius * way[k]);
            assert!(!reach.is_surely_off(at(1.0)), "{reach:?} {way:?}");
            assert!(reach.is_surely_off(at(1.1)) && reach.is_surely_off(at(0.9)), "{reach:?} {way:?}");
        }
    }

    #[test]
    fn what_is_met_is_not_left_out_and_what_is_clearly_missed_is() {
        let mut stream = Stream::new(42);
        let infinity = f64::INFINITY;
        for _ in 0..50_000 {
            let (reach, far) = (reach(&mut stream), stream.between(-0.5, 8.0));
            let (touching, t) = passing(&mut stream, &reach, 1.0, far.abs());
            for t_max in [infinity, t] {
                assert!(!reach.is_surely_missed(&touching, t_max), "{reach:?} {touching:?} {t}");
            }
            let share = stream.unit();
            let (meeting, t) = passing(&mut stream, &reach, share, far);
            // The far root is ahead.
            let half = (1.0 - share * share).sqrt();
            let root = t + half * t / far;
            if far + half > 0.0 {
                assert!(!reach.is_surely_missed(&meeting, infinity), "{reach:?} {meeting:?}");
                assert!(!reach.is_surely_missed(&meeting, root), "{reach:?} {meeting:?} {root}");
            }
            let (beside, _) = passing(&mut stream, &reach, 1.5, far);
            assert!(reach.is_surely_missed(&beside, infinity), "{reach:?} {beside:?}");
            let (behind, _) = passing(&mut stream, &reach, share, -1.5);
            assert!(reach.is_surely_missed(&behind, infinity), "{reach:?} {behind:?}");
            let (ahead, t) = passing(&mut stream, &reach, share, 8.0);
            assert!(reach.is_surely_missed(&ahead, 0.5 * t), "{reach:?} {ahead:?}");
        }
    }
}
