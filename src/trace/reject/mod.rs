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
#[cfg(test)]
pub(in crate::trace) mod tests;

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
