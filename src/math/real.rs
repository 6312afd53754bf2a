//! The arithmetic that the tracer is written over.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// What is known of a number's sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Below 0, proved.
    Negative,
    /// Exactly 0, proved.
    Zero,
    /// Above 0, proved.
    Positive,
    /// The bound holds numbers of several signs.
    Unknown,
}

impl Sign {
    /// Returns what is known of the sign of a number that is off from `middle` by at most `error`.
    #[inline]
    pub(super) fn of_ball(middle: f64, error: f64) -> Self {
        if middle > error {
            Self::Positive
        } else if middle < -error {
            Self::Negative
        } else if middle == 0.0 && error == 0.0 {
            Self::Zero
        } else {
            Self::Unknown
        }
    }
}

/// A real number known up to a bound: the exact result of the same operations on the same exact inputs lies within.
///
/// Infinite bounds and NaN are legal and mean that nothing is known.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// Whether the middle holds more than binary64 can.
    const IS_FINE: bool;

    /// Makes a number that is known exactly.
    fn exact(value: f64) -> Self;

    /// Makes the number that a double-double with this relative error stands for.
    fn rounded(value: super::DoubleDouble, relative_error: f64) -> Self;

    /// Returns tan(`degrees`·π/360), the tangent of half an angle in 0…180.
    fn tan_half_degrees(degrees: f64) -> Self {
        let (tangent, relative_error) = super::tan_half_degrees(degrees);
        Self::rounded(tangent, relative_error)
    }

    /// Makes the number of which nothing is known but that it lies in 0…1.
    fn unit_interval() -> Self;

    /// Returns the middle of the bounds, in binary64.
    fn value(self) -> f64;

    /// Returns a bound on the distance of the exact number from the middle.
    fn error(self) -> f64;

    /// Returns the square root; what lies below 0 within the bounds counts as 0.
    fn sqrt(self) -> Self;

    /// Returns the number to the power `exponent`, which is at least 0; 0⁰ = 1. The number must not be negative: what lies
    /// below 0 within the bounds counts as 0.
    fn pow(self, exponent: f64) -> Self;

    /// Returns the number clamped to 0…1.
    fn clamp_unit(self) -> Self;

    /// Returns what is known of the sign.
    fn sign(self) -> Sign;

    /// Returns the power of a point with regard to a circle or sphere: the squared distance of `point` from `center`, less
    /// `radius` squared. Below 0 inside, above 0 outside.
    ///
    /// The difference is taken in more precision than the type has, because it cancels near the surface of large spheres. Of
    /// a point that is known exactly the sign is known, as long as no product underflows: see [`Expansion::power_of_point`](super::Expansion::power_of_point).
    fn power_of_point<const N: usize>(point: [Self; N], center: [f64; N], radius: f64) -> Self;

    /// Returns ⌊x⌋ when all of the bounds agree on it.
    fn floor(self) -> Option<f64>;

    /// Returns the square.
    fn square(self) -> Self {
        self * self
    }
}
