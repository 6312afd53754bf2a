//! Binary64 with a running bound on the error.
//!
//! Each operation adds to the bound what it inherits and half an ulp for its own rounding; the bound itself is computed in
//! binary64 and widened by [`WIDEN`] for the rounding of that computation.
//!
//! # Source
//! Wilkinson's running error analysis, as in Higham, "Accuracy and Stability of Numerical Algorithms" (2002), section 3.3;
//! ball arithmetic as in van der Hoeven, "Ball arithmetic" (2009). The bounds of quotient and root are derived where they
//! stand.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::math::{DoubleDouble, Expansion, Real, Sign};

/// Half the distance from 1 to the next number: the relative error of one rounding is at most this.
const ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// Covers the roundings of the at most eight operations that compute one bound, each below 2⁻⁵³.
const WIDEN: f64 = 1.0 + 16.0 * ROUNDOFF;

/// Covers what products and quotients lose to underflow, and what the products in their bounds do: at most 8 times 2⁻¹⁰⁷⁵.
/// Much larger than that, so that bounds stay clear of subnormal numbers, which are slow.
const UNDERFLOW: f64 = f64::from_bits((1023 - 960) << 52); // 2^-960

/// The relative error that `libm::pow` is trusted to stay below: 4 ulp, where its authors state less than one.
const POW_ERROR: f64 = 8.0 * ROUNDOFF;

/// A binary64 number with a bound on its distance from the exact number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball64 {
    value: f64,
    error: f64,
}

impl Ball64 {
    /// Makes a ball from its middle and a bound, which must not be negative.
    #[must_use]
    pub const fn new(value: f64, error: f64) -> Self {
        Self { value, error }
    }

    /// Tells whether the number is exactly 0.
    fn is_zero(self) -> bool {
        self.value == 0.0 && self.error == 0.0
    }
}

impl Add for Ball64 {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        let value = self.value + other.value;
        Self { value, error: (self.error + other.error + value.abs() * ROUNDOFF) * WIDEN }
    }
}

impl Sub for Ball64 {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Ball64 {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self { value: -self.value, error: self.error }
    }
}

impl Mul for Ball64 {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self { value: 0.0, error: 0.0 };
        }
        let value = self.value * other.value;
        let inherited = self.value.abs() * other.error + (other.value.abs() + other.error) * self.error;
        Self { value, error: (inherited + value.abs() * ROUNDOFF) * WIDEN + UNDERFLOW }
    }
}

impl Div for Ball64 {
    type Output = Self;

    /// For every a, b in the balls and the rounded quotient q of the middles,
    /// |a/b − q| = |a − q·b| / |b| ≤ (error of a + |q|·error of b + |q·b|·roundoff) / |b|.
    #[inline]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let divisor = other.value.abs() * (1.0 - 2.0 * ROUNDOFF) - other.error;
        if divisor.is_nan() || divisor <= 0.0 {
            return Self { value, error: f64::INFINITY };
        }
        if self.is_zero() {
            return self;
        }
        let rest = self.error + value.abs() * other.error + (value * other.value).abs() * (2.0 * ROUNDOFF) + UNDERFLOW;
        Self { value, error: rest / divisor * WIDEN + UNDERFLOW }
    }
}

impl Real for Ball64 {
    const IS_FINE: bool = false;

    #[inline]
    fn exact(value: f64) -> Self {
        Self { value, error: 0.0 }
    }

    fn rounded(value: DoubleDouble, relative_error: f64) -> Self {
        let error = (value.lo().abs() + value.hi().abs() * relative_error) * WIDEN;
        Self { value: value.hi(), error }
    }

    fn unit_interval() -> Self {
        Self { value: 0.5, error: 0.5 }
    }

    #[inline]
    fn value(self) -> f64 {
        self.value
    }

    #[inline]
    fn error(self) -> f64 {
        self.error
    }

    /// For every x ≥ 0 in the ball and the rounded root s of the middle, |√x − s| = |x − s²| / (√x + s); the divisor is at
    /// least s, and at least 1.86·s when the error is below a quarter of the middle.
    #[inline]
    fn sqrt(self) -> Self {
        if self.is_zero() {
            return self;
        }
        if self.value <= self.error {
            let top = ((self.value + self.error) * WIDEN).max(0.0).sqrt();
            return Self { value: 0.5 * top, error: 0.5 * top * WIDEN + UNDERFLOW };
        }
        let value = self.value.sqrt();
        let share = if self.error * 4.0 < self.value { 0.54 } else { 1.0 };
        Self { value, error: (share * self.error / value + value * (2.0 * ROUNDOFF)) * WIDEN + UNDERFLOW }
    }

    /// With r = error / value, x^p for x in the ball is within value^p · (exp(p·r/(1−r)) − 1) of value^p, and
    /// exp(s) − 1 ≤ 1.06·s for s ≤ 0.1. Wider balls are bounded by the powers of their ends.
    fn pow(self, exponent: f64) -> Self {
        if exponent == 0.0 {
            return Self::exact(1.0);
        }
        if exponent == 1.0 {
            return self;
        }
        let relative = self.error / self.value;
        let spread = exponent * relative / (1.0 - relative);
        if self.value > 0.0 && relative < 0.5 && spread <= 0.1 {
            let value = libm::pow(self.value, exponent);
            return Self { value, error: value * (1.1 * spread + POW_ERROR) * WIDEN + UNDERFLOW };
        }
        let bottom =
            libm::pow((self.value - self.error).max(0.0) * (1.0 - 2.0 * ROUNDOFF), exponent) * (1.0 - POW_ERROR);
        let top = libm::pow((self.value + self.error).max(0.0) * WIDEN, exponent) * (1.0 + POW_ERROR);
        let value = 0.5 * (bottom + top);
        Self { value, error: ((top - value).max(value - bottom) + value * (4.0 * ROUNDOFF)) * WIDEN + UNDERFLOW }
    }

    #[inline]
    fn clamp_unit(self) -> Self {
        // The difference of 1 and a small error is rounded to 1.
        if self.value - 2.0 * self.error >= 1.0 + f64::EPSILON {
            Self::exact(1.0)
        } else if self.value + 2.0 * self.error <= 0.0 {
            Self::exact(0.0)
        } else {
            Self { value: self.value.clamp(0.0, 1.0), error: self.error }
        }
    }

    #[inline]
    fn sign(self) -> Sign {
        Sign::of_ball(self.value, self.error)
    }

    fn power_of_point<const N: usize>(point: [Self; N], center: [f64; N], radius: f64) -> Self {
        let radius_squared = DoubleDouble::product(radius, radius);
        let mut power = -radius_squared;
        let mut magnitude = radius_squared.hi();
        let mut inherited = 0.0;
        for (coordinate, center) in point.into_iter().zip(center) {
            let distance = DoubleDouble::sum(coordinate.value, -center);
            let squared = distance.square();
            power = power + squared;
            magnitude += squared.hi();
            inherited += (2.0 * distance.hi().abs() * (1.0 + ROUNDOFF) + coordinate.error) * coordinate.error;
        }
        // Two operations a coordinate, each on numbers of at most the magnitude.
        let own = magnitude * (2 * N) as f64 * DoubleDouble::ROUNDOFF + power.lo().abs();
        let power = Self { value: power.hi(), error: (inherited + own) * WIDEN + UNDERFLOW };
        if power.sign() != Sign::Unknown || point.iter().any(|coordinate| coordinate.error != 0.0) {
            return power;
        }
        let exact = Expansion::power_of_point(point.map(|coordinate| coordinate.value), center, radius);
        exact.map_or(power, |exact| exact.rounded())
    }

    #[inline]
    fn floor(self) -> Option<f64> {
        let bottom = ((self.value - self.error) * (1.0 - 2.0 * ROUNDOFF)).floor();
        let top = ((self.value + self.error) * (1.0 + 2.0 * ROUNDOFF)).floor();
        (bottom == top).then_some(top)
    }
}
