//! Rejects primitives that a ray does not meet, one at a time and in plain binary64.
//!
//! What it rejects is not met, by a bound on its own rounding and on what the ray is off. What it keeps is tested again
//! with bounds by `intersect`.
//!
//! # Method
//! Let m = c − o lead from the origin to the centre, d be the direction. The line passes the centre at the distance
//! |m × d| / |d|, so it misses when |m × d|² > |d|²·r². The ray leads away from an outside point when m·d < 0 and
//! |m|² > r². Each difference below holds with the slack that rounding and the errors of the ray can make up:
//! with M = |m|₁, N = |d|₁ and u = 2⁻⁵³, each product of a component of m and one of d is off by at most
//! δ = 4u·M·N + N·(origin error) + M·(direction error) + 2·(origin error)·(direction error) together with the subtraction
//! or additions that follow it.

mod cylinder;
mod sphere;

pub use cylinder::keep_cylinders;
pub use sphere::keep_spheres;

/// Half an ulp of 1.
const ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// More than underflow can take away: 2⁻⁹⁶⁰.
const UNDERFLOW: f64 = f64::from_bits((1023 - 960) << 52);

/// A ray in plain binary64, and how far it is off.
#[derive(Clone, Copy, Debug)]
pub struct PlainRay {
    /// Where it starts.
    pub origin: [f64; 3],
    /// Where it goes; need not be of unit length.
    pub dir: [f64; 3],
    /// A bound on the error of each coordinate of the origin.
    pub origin_error: f64,
    /// A bound on the error of the height of the origin, which is exact on a cap.
    pub origin_y_error: f64,
    /// A bound on the error of each coordinate of the direction.
    pub dir_error: f64,
}

/// What rejection has to know of the line through two or three of its coordinates.
struct Offsets {
    /// m, from the origin to the centre.
    to_center: f64,
    /// δ of the module's documentation.
    slack: f64,
}

impl Offsets {
    /// Makes them from M = |m|₁ and N = |d|₁.
    fn new(ray: &PlainRay, to_center: f64, dir: f64) -> Self {
        let slack = 6.0 * ROUNDOFF * to_center * dir
            + dir * ray.origin_error
            + to_center * ray.dir_error
            + 2.0 * ray.origin_error * ray.dir_error
            + UNDERFLOW;
        Self { to_center, slack }
    }
}

/// Tells whether the line misses: |m × d|² > |d|²·r² beyond doubt.
///
/// `cross_squared`, `cross_sum`: squared length and sum of magnitudes of m × d, each component off by at most twice
/// the slack. `dir_squared`: |d|², `dir`: |d|₁.
fn line_misses(
    ray: &PlainRay,
    offsets: &Offsets,
    cross_squared: f64,
    cross_sum: f64,
    dir_squared: f64,
    dir: f64,
    radius: f64,
) -> bool {
    let radius_squared = radius * radius;
    let dir_slack = 16.0 * ROUNDOFF * dir_squared + 4.0 * (dir + ray.dir_error) * ray.dir_error;
    let slack =
        8.0 * offsets.slack * cross_sum + 16.0 * ROUNDOFF * cross_squared + dir_slack * radius_squared + UNDERFLOW;
    cross_squared > dir_squared * radius_squared * (1.0 + 8.0 * ROUNDOFF) + slack * (1.0 + 16.0 * ROUNDOFF)
}

/// Tells whether the ray leads away from the outside: m·d < 0 and |m|² > r² beyond doubt.
///
/// `along`: m·d, off by at most three times the slack. `distance_squared`: |m|².
fn leads_away(ray: &PlainRay, offsets: &Offsets, along: f64, distance_squared: f64, radius: f64) -> bool {
    let distance_slack = 16.0 * ROUNDOFF * (distance_squared + radius * radius)
        + 4.0 * (offsets.to_center + ray.origin_error) * ray.origin_error
        + UNDERFLOW;
    along < -4.0 * offsets.slack && distance_squared > radius * radius + distance_slack
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{CylinderLanes, SphereLanes};
    use crate::testing::Stream;

    fn vector(stream: &mut Stream) -> [f64; 3] {
        [(); 3].map(|()| stream.between(-1.0, 1.0))
    }

    fn length(v: [f64; 3]) -> f64 {
        v.into_iter().map(|c| c * c).sum::<f64>().sqrt()
    }

    fn ray(origin: [f64; 3], dir: [f64; 3], error: f64) -> PlainRay {
        PlainRay { origin, dir, origin_error: error, origin_y_error: error, dir_error: error }
    }

    /// A ray that grazes a sphere: from `origin` past `center` at `share` of the radius, with all of it known to `error`.
    fn grazing_ray(stream: &mut Stream, center: [f64; 3], radius: f64, share: f64, error: f64) -> PlainRay {
        let aside = vector(stream);
        let along = vector(stream);
        // The part of `aside` across `along`, as long as the radius.
        let dot: f64 = (0..3).map(|k| aside[k] * along[k]).sum::<f64>() / (length(along) * length(along));
        let across: [f64; 3] = std::array::from_fn(|k| aside[k] - dot * along[k]);
        let factor = share * radius / length(across);
        let far = 1.0 + 50.0 * stream.unit();
        let origin = std::array::from_fn(|k| center[k] + across[k] * factor - along[k] * far * radius);
        ray(origin, along, error)
    }

    /// A hit that rounding hides must not be rejected: rays aimed a few roundings inside of the silhouette, at spheres of
    /// all sizes far from the origin of coordinates, are kept.
    #[test]
    fn grazing_hits_are_kept() {
        let mut stream = Stream::new(3);
        for _ in 0..200_000 {
            let radius = libm::exp2(stream.between(-30.0, 30.0));
            let center = vector(&mut stream).map(|c| c * 100.0 * radius);
            // The ray is off by the roundings of its making, at most this.
            let error = 200.0 * radius * 8.0 * f64::EPSILON;
            let ray = grazing_ray(&mut stream, center, radius, 1.0, error);
            let [x, y, z] = center.map(|c| vec![c]);
            let mut kept = Vec::new();
            keep_spheres(&ray, &SphereLanes { x, y, z, radius: vec![radius] }, &[0], &mut kept);
            assert_eq!(kept, [0], "{ray:?} {center:?} {radius}");
        }
    }

    #[test]
    fn clear_misses_are_rejected() {
        let mut stream = Stream::new(5);
        for _ in 0..10_000 {
            let center = vector(&mut stream).map(|c| c * 100.0);
            let ray = grazing_ray(&mut stream, center, 1.0, 1.0 + 1e-9, 1e-15);
            let [x, y, z] = center.map(|c| vec![c]);
            let mut kept = Vec::new();
            keep_spheres(&ray, &SphereLanes { x, y, z, radius: vec![1.0] }, &[0], &mut kept);
            assert!(kept.is_empty(), "{ray:?} {center:?}");
        }
    }

    #[test]
    fn what_lies_behind_is_rejected_and_what_surrounds_is_kept() {
        let toward_minus_z = ray([0.0; 3], [0.1, 0.0, -1.0], 0.0);
        let spheres = SphereLanes { x: vec![0.0; 2], y: vec![0.0; 2], z: vec![3.0, 3.0], radius: vec![1.0, 4.0] };
        let mut kept = Vec::new();
        keep_spheres(&toward_minus_z, &spheres, &[0, 1], &mut kept);
        assert_eq!(kept, [1]);

        let cylinders = CylinderLanes {
            x: vec![0.0; 4],
            z: vec![3.0, 3.0, -3.0, -3.0],
            radius: vec![1.0, 4.0, 1.0, 1.0],
            y_min: vec![-1.0, -1.0, -1.0, 0.5],
            y_max: vec![1.0, 1.0, 1.0, 1.0],
        };
        kept.clear();
        keep_cylinders(&ray([0.0; 3], [0.1, -0.1, -1.0], 0.0), &cylinders, &[0, 1, 2, 3], &mut kept);
        assert_eq!(kept, [1, 2], "behind; around; ahead; ahead but above a ray that falls");
    }

    #[test]
    fn a_ray_in_the_plane_of_a_cap_keeps_its_cylinder() {
        let cylinders =
            CylinderLanes { x: vec![0.0], z: vec![-3.0], radius: vec![1.0], y_min: vec![-1.0], y_max: vec![0.0] };
        let mut kept = Vec::new();
        keep_cylinders(&ray([0.0; 3], [0.0, 0.0, -1.0], 0.0), &cylinders, &[0], &mut kept);
        assert_eq!(kept, [0]);
    }
}
