//! The only binary64 of the oracle: leaving out primitives that a ray misses by a wide margin.

use std::ops::RangeInclusive;

use super::vec3::Vec3;

/// What a primitive is for the binary64 filter: a sphere, or an endless upright cylinder.
pub struct Reach {
    pub center: [f64; 3],
    pub radius: f64,
    /// The axes of its equation: all, or x and z.
    pub axes: &'static [usize],
}

impl Reach {
    /// A margin for quantities of about 1 to 1000 that are good to 1e-9: far wider than their error.
    const MARGIN: f64 = 1e-5;

    /// The units within which a number keeps its relative precision, whatever it is divided by.
    const UNITS: RangeInclusive<f64> = 1e-250..=1e250;

    /// Tells whether the ray misses by a wide margin, or meets only far behind `t_max`.
    ///
    /// Lengths are taken in units of the largest one at hand and the direction in units of its largest component, so
    /// all that follows is of moderate size. A NaN or an infinity answers no.
    pub fn is_surely_missed(&self, ray: &ApproxRay, t_max: f64) -> bool {
        let largest = |v: [f64; 3]| v.into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let length_unit = largest(ray.origin).max(largest(self.center)).max(self.radius);
        let dir_unit = largest(ray.dir);
        if !Self::UNITS.contains(&length_unit) || !Self::UNITS.contains(&dir_unit) {
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
        let is_behind = c > Self::MARGIN && b > Self::MARGIN;
        let is_beyond =
            c > Self::MARGIN && -b - radius * a.sqrt() - Self::MARGIN > a * (t_max * dir_unit / length_unit);
        is_beside || is_behind || is_beyond
    }
}

/// A ray in binary64, each component good to 2⁻⁴⁰ of the largest.
pub struct ApproxRay {
    origin: [f64; 3],
    dir: [f64; 3],
}

impl ApproxRay {
    /// Returns the ray in binary64, if it is known well enough.
    pub fn new(origin: &Vec3, dir: &Vec3) -> Option<Self> {
        Some(Self { origin: approximate(origin)?, dir: approximate(dir)? })
    }
}

/// Returns a vector in binary64 if every component is known to 2⁻⁴⁰ of the largest.
fn approximate(v: &Vec3) -> Option<[f64; 3]> {
    let approx = [0, 1, 2].map(|axis| v[axis].to_f64());
    let largest = (0..3).max_by(|&a, &b| approx[a].abs().total_cmp(&approx[b].abs()))?;
    v.iter().all(|component| component.is_sharp_beside(&v[largest], 40)).then_some(approx)
}
