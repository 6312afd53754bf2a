//! Outlines: the slopes under which an apex sees an object.
//!
//! # Method
//! Place the apex at the origin and look along one axis, *ahead*. A point has two slopes, its coordinates *across* divided
//! by its coordinate ahead. The slopes of a disc of radius r about (across, ahead) lie between those of its two tangents
//! through the apex: with the length s of the tangents, s² = across² + ahead² − r², they have the directions
//! (across·s ∓ ahead·r, ahead·s ± across·r). A sphere is a disc in each of two planes, an upright cylinder a disc from
//! above and a box from aside.
//!
//! Why a grazing ray is not lost: s is rounded down, which turns the two tangents outward, for they meet the axis of the
//! disc at an angle of arctan r/s. What rounding does to the direction of a tangent from there on is bounded and taken off
//! outward, before and behind the division. Where a bound would have to be negative (the apex in the disc or near it), all
//! slopes are possible.
//!
//! A sphere that is wholly ahead, at least twice as far as it is large, takes one division: the slopes of the tangents are
//! the roots of σ²·(ahead² − r²) − 2σ·across·ahead + across² − r², which are (across·ahead ∓ r·s)/(ahead² − r²). With
//! ahead ≥ 2r every difference below a root or a fraction is at least three fifths of the sum of its terms, so that each
//! root is off by at most 16u of |across·ahead| + r·s, divided by ahead² − r².

use crate::plan::apex::{ROUNDOFF, UNDERFLOW};

/// Below this, 2⁻²⁰⁰, products of four lengths may underflow, and beyond 2²⁰⁰ overflow.
const SHORTEST: f64 = f64::from_bits((1023 - 200) << 52);
const FARTHEST: f64 = f64::from_bits((1023 + 200) << 52);

/// A bound of what an apex sees of one object ahead of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outline {
    /// The least and the largest slope along each of the two axes across, −∞ to ∞.
    pub slopes: [[f64; 2]; 2],
    /// No point of the object that is ahead has a smaller coordinate ahead; not negative.
    pub near: f64,
}

impl Outline {
    /// Returns the outline of a sphere; `None` when no point of it is ahead.
    ///
    /// `center`: from the apex, the two coordinates across and the one ahead.
    pub fn of_sphere([u, v, ahead]: [f64; 3], radius: f64) -> Option<Self> {
        if is_simple([u, v, ahead], radius) {
            let slopes = simple_slopes([u, v], ahead, radius);
            return Some(Self { slopes, near: simple_near(ahead, radius) });
        }
        let slopes = [disc_slopes(u, ahead, radius)?, disc_slopes(v, ahead, radius)?];
        Some(Self { slopes, near: nearest(ahead, radius) })
    }

    /// Returns the outline of a cylinder that stands upright along the second axis across; `None` when no point of it is
    /// ahead.
    ///
    /// `axis`: from the apex, the first coordinate across and the one ahead. `heights`: of its two caps, from the apex.
    pub fn of_upright_cylinder([u, ahead]: [f64; 2], radius: f64, heights: [f64; 2]) -> Option<Self> {
        let slopes = [disc_slopes(u, ahead, radius)?, box_slopes(heights, [ahead - radius, ahead + radius])];
        Some(Self { slopes, near: nearest(ahead, radius) })
    }

    /// Returns the outline of a cylinder along whose axis the apex looks; `None` when no point of it is ahead.
    ///
    /// `axis`: from the apex, the two coordinates across. `ahead`: of its two caps, from the apex, rounded outward.
    pub fn of_cylinder_from_below(axis: [f64; 2], radius: f64, ahead: [f64; 2]) -> Option<Self> {
        if ahead[1] <= 0.0 {
            return None;
        }
        let slopes = axis.map(|across| box_slopes([(across - radius).next_down(), (across + radius).next_up()], ahead));
        Some(Self { slopes, near: ahead[0].max(0.0) })
    }
}

/// Spheres that are looked at side by side: so many fill a few registers of any machine.
pub const BLOCK: usize = 16;

/// The outlines of a block of spheres, as far as they take one division each.
#[derive(Clone, Debug)]
pub struct Outlines {
    /// Along each axis the least slopes, and the largest.
    slopes: [[[f64; BLOCK]; 2]; 2],
    near: [f64; BLOCK],
    is_simple: [bool; BLOCK],
}

impl Outlines {
    /// Works out what [`Outline::of_sphere`] does for each sphere that is wholly ahead, to the same bits.
    #[inline]
    pub fn of_spheres([u, v, ahead]: [&[f64; BLOCK]; 3], radius: &[f64; BLOCK]) -> Self {
        let mut outlines = Self { slopes: [[[0.0; BLOCK]; 2]; 2], near: [0.0; BLOCK], is_simple: [false; BLOCK] };
        for i in 0..BLOCK {
            let slopes = simple_slopes([u[i], v[i]], ahead[i], radius[i]);
            for (k, bounds) in slopes.into_iter().enumerate() {
                [outlines.slopes[k][0][i], outlines.slopes[k][1][i]] = bounds;
            }
            outlines.near[i] = simple_near(ahead[i], radius[i]);
            outlines.is_simple[i] = is_simple([u[i], v[i], ahead[i]], radius[i]);
        }
        outlines
    }

    /// Returns the outline of the i-th sphere; `None` when it is left to [`Outline::of_sphere`].
    #[inline]
    pub fn get(&self, i: usize) -> Option<Outline> {
        let slopes = || self.slopes.each_ref().map(|[low, high]| [low[i], high[i]]);
        self.is_simple[i].then(|| Outline { slopes: slopes(), near: self.near[i] })
    }
}

/// Tells whether a sphere is so far ahead that its outline takes one division.
#[inline]
fn is_simple([u, v, ahead]: [f64; 3], radius: f64) -> bool {
    (ahead >= 2.0 * radius) & (radius >= SHORTEST) & (u.abs().max(v.abs()).max(ahead) <= FARTHEST)
}

/// Returns the slopes of a simple sphere.
#[inline]
fn simple_slopes(across: [f64; 2], ahead: f64, radius: f64) -> [[f64; 2]; 2] {
    let difference = ahead * ahead - radius * radius;
    let inverse = 1.0 / difference;
    across.map(|across| {
        let middle = across * ahead * inverse;
        let half = radius * (across * across + difference).sqrt() * inverse;
        let slack = (32.0 * ROUNDOFF) * (middle.abs() + half);
        [middle - half - slack, middle + half + slack]
    })
}

/// Returns a lower bound of ahead − radius of a simple sphere.
#[inline]
fn simple_near(ahead: f64, radius: f64) -> f64 {
    (ahead - radius) * (1.0 - 4.0 * ROUNDOFF)
}

/// Returns a lower bound of ahead − radius, at least 0.
fn nearest(ahead: f64, radius: f64) -> f64 {
    (ahead - radius).next_down().max(0.0)
}

/// Returns the slopes of a disc; `None` when no point of it is ahead.
fn disc_slopes(across: f64, ahead: f64, radius: f64) -> Option<[f64; 2]> {
    // A rounded sum has the sign of the sum.
    if ahead + radius <= 0.0 {
        return None;
    }
    let tangent = tangent_length(across, ahead, radius);
    Some(match tangent {
        None => [f64::NEG_INFINITY, f64::INFINITY],
        Some(tangent) => [least_slope(across, ahead, radius, tangent), -least_slope(-across, ahead, radius, tangent)],
    })
}

/// Returns a lower bound of s, the length of the tangents to a disc; `None` when the apex may lie in the disc.
fn tangent_length(across: f64, ahead: f64, radius: f64) -> Option<f64> {
    let (across, ahead, radius) = (across * across, ahead * ahead, radius * radius);
    let squared = across + ahead - radius;
    let lowered = squared - (8.0 * ROUNDOFF * (across + ahead + radius) + UNDERFLOW);
    (lowered > 0.0).then(|| lowered.sqrt() * (1.0 - 4.0 * ROUNDOFF))
}

/// Returns a lower bound of the slopes of a disc of which some point is ahead.
///
/// The direction (n, d) of the tangent that bounds them from below points ahead when d > 0; when it does not, the disc
/// reaches beside or behind the apex on that side, and nothing bounds its slopes.
fn least_slope(across: f64, ahead: f64, radius: f64, tangent: f64) -> f64 {
    let slack = 8.0 * ROUNDOFF * (across.abs() + ahead.abs()) * (tangent + radius) + UNDERFLOW;
    let n = across * tangent - ahead * radius - slack;
    let d = ahead * tangent + across * radius;
    if d <= slack {
        return f64::NEG_INFINITY;
    }
    lower(if n >= 0.0 { n / (d + slack) } else { n / (d - slack) })
}

/// Returns the slopes of the part of a box that is ahead, of which there is some.
///
/// `ahead`: its coordinates ahead, each off by at most one rounding.
fn box_slopes([low, high]: [f64; 2], ahead: [f64; 2]) -> [f64; 2] {
    let (near, far) = (ahead[0].next_down(), ahead[1].next_up());
    let most = |across: f64| match (across > 0.0, near > 0.0) {
        (false, _) => across / far,
        (true, true) => across / near,
        (true, false) => f64::INFINITY,
    };
    [lower(-most(-low)), -lower(-most(high))]
}

/// Returns a number below a quotient that was rounded, perhaps beyond all numbers.
fn lower(quotient: f64) -> f64 {
    let quotient = quotient.min(f64::MAX);
    quotient - (quotient.abs() * (4.0 * ROUNDOFF) + f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DoubleDouble;
    use crate::testing::Stream;

    /// Tells by double-double whether the disc is met by the ray of this slope: (across − slope·ahead)² ≤ r²·(1 + slope²).
    fn is_met(slope: f64, across: f64, ahead: f64, radius: f64) -> bool {
        let offset = DoubleDouble::from(across) - DoubleDouble::product(slope, ahead);
        let reach = DoubleDouble::product(radius, radius) * (DoubleDouble::ONE + DoubleDouble::product(slope, slope));
        (reach - offset.square()).hi() >= 0.0
    }

    /// Slopes that meet a disc ahead are within its bounds, to the last bit: bisection finds the outermost.
    #[test]
    fn no_slope_that_meets_a_disc_is_outside() {
        let mut stream = Stream::new(11);
        let mut n_bounded = 0;
        for round in 0..40_000 {
            let radius = libm::exp2(stream.between(-40.0, 10.0));
            let across = stream.between(-1.0, 1.0) * libm::exp2(stream.between(-20.0, 10.0));
            let ahead = radius * libm::exp2(stream.between(-2.0, 40.0)) + radius * stream.unit();
            let Some(slopes) = disc_slopes(across, ahead, radius) else { panic!("{ahead} is ahead") };
            let sphere = Outline::of_sphere([across, 0.0, ahead], radius).expect("ahead");
            let [low, high] = [slopes, sphere.slopes[0]][round % 2];
            if !low.is_finite() || !high.is_finite() {
                continue;
            }
            n_bounded += 1;
            for bound in [low, high] {
                assert!(!is_met(bound, across, ahead, radius), "{across} {ahead} {radius}: {bound} is met");
            }
            // The bounds are no wider than rounding asks for.
            let middle = (low + high) / 2.0;
            let shrunk = |bound: f64| bound + (middle - bound) * 1e-2;
            let is_wide = (high - low) > 1e-10 * (1.0 + low.abs() + high.abs());
            let is_far = ahead > 1.001 * radius && low.abs().max(high.abs()) < 1e3;
            if is_wide && is_far {
                assert!(is_met(shrunk(low), across, ahead, radius), "{across} {ahead} {radius}: {low} is loose");
                assert!(is_met(shrunk(high), across, ahead, radius), "{across} {ahead} {radius}: {high} is loose");
            }
        }
        assert!(n_bounded > 20_000);
    }

    #[test]
    fn what_is_around_or_beside_the_apex_is_unbounded_and_what_is_behind_is_not_seen() {
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        assert_eq!(disc_slopes(0.5, 0.5, 1.0), Some(all), "around");
        assert_eq!(disc_slopes(3.0, 4.0, 5.0), Some(all), "on the circle");
        assert_eq!(disc_slopes(0.0, -1.0, 1.0), None, "touches the plane of the apex from behind");
        assert_eq!(disc_slopes(7.0, -2.0, 1.0), None);
        let [low, high] = disc_slopes(3.0, -0.5, 1.0).expect("partly ahead");
        assert!(low > 3.0 && high == f64::INFINITY);
        let [low, high] = disc_slopes(-3.0, 0.5, 1.0).expect("partly ahead");
        assert!(low == f64::NEG_INFINITY && high < -1.0);
    }

    #[test]
    fn boxes_are_bounded_by_their_corners() {
        let within = |[low, high]: [f64; 2], exact: [f64; 2]| {
            low < exact[0] && low > exact[0] - 1e-12 && high > exact[1] && high < exact[1] + 1e-12
        };
        assert!(within(box_slopes([-1.0, 3.0], [2.0, 4.0]), [-0.5, 1.5]));
        assert!(within(box_slopes([1.0, 3.0], [2.0, 4.0]), [0.25, 1.5]));
        assert!(within(box_slopes([-3.0, -1.0], [2.0, 4.0]), [-1.5, -0.25]));
        let [low, high] = box_slopes([-3.0, -1.0], [-2.0, 4.0]);
        assert!(low == f64::NEG_INFINITY && (-0.25..-0.24).contains(&high));
        let [low, high] = box_slopes([0.0, 1.0], [0.0, 4.0]);
        assert!(low < 0.0 && low > -1e-300 && high == f64::INFINITY);
        // A cap at the height of the apex, rounded outward: its slopes are beyond all numbers, and not NaN.
        let [low, high] = box_slopes([0.5, 1.0], [-1.0, f64::from_bits(1)]);
        assert!((1e308..f64::INFINITY).contains(&low) && high == f64::INFINITY);
        assert_eq!(box_slopes([-1.0, -0.5], [-1.0, f64::from_bits(1)]), [-high, -low]);
    }
}
