//! Double-double with a running bound on the error: the arithmetic of last resort.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::math::{Ball64, DoubleDouble, Expansion, Real, Sign, elementary};

/// A bound on the relative error of one operation.
const ROUNDOFF: f64 = DoubleDouble::ROUNDOFF;

/// Covers the roundings of the computation of one bound.
const WIDEN: f64 = 1.0 + 16.0 * f64::EPSILON;

/// Covers underflow, as in `ball64`; double-double products lose more of it, as their low parts underflow first.
const UNDERFLOW: f64 = f64::from_bits((1023 - 900) << 52); // 2^-900

/// The largest exponent that is carried out by repeated squaring.
const MAX_SQUARING_EXPONENT: f64 = 1_048_576.0;

/// A double-double number with a bound on its distance from the exact number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball106 {
    value: DoubleDouble,
    error: f64,
}

impl Ball106 {
    /// Tells whether the number is exactly 0.
    fn is_zero(self) -> bool {
        self.value.hi() == 0.0 && self.error == 0.0
    }

    /// Returns the middle of the bounds.
    #[must_use]
    pub fn middle(self) -> DoubleDouble {
        self.value
    }

    /// Returns the magnitude of the middle.
    fn magnitude(self) -> f64 {
        self.value.hi().abs()
    }

    /// Raises to a whole power by repeated squaring; `exponent` is at least 1.
    fn pow_whole(self, exponent: u32) -> Self {
        let mut result = Self::exact(1.0);
        for bit in (0..u32::BITS - exponent.leading_zeros()).rev() {
            result = result * result;
            if exponent >> bit & 1 == 1 {
                result = result * self;
            }
        }
        result
    }
}

impl Add for Ball106 {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let value = self.value + other.value;
        Self { value, error: (self.error + other.error + value.hi().abs() * ROUNDOFF) * WIDEN }
    }
}

impl Sub for Ball106 {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Ball106 {
    type Output = Self;

    fn neg(self) -> Self {
        Self { value: -self.value, error: self.error }
    }
}

impl Mul for Ball106 {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self::exact(0.0);
        }
        let value = self.value * other.value;
        let inherited = self.magnitude() * other.error + (other.magnitude() + other.error) * self.error;
        Self { value, error: (inherited + value.hi().abs() * ROUNDOFF) * WIDEN + UNDERFLOW }
    }
}

impl Div for Ball106 {
    type Output = Self;

    /// The bound is that of `Ball64`.
    fn div(self, other: Self) -> Self {
        let divisor = other.magnitude() * (1.0 - 4.0 * f64::EPSILON) - other.error;
        if divisor.is_nan() || divisor <= 0.0 {
            return Self { value: DoubleDouble::ZERO, error: f64::INFINITY };
        }
        if self.is_zero() {
            return self;
        }
        let value = self.value / other.value;
        let own = (value.hi() * other.value.hi()).abs() * (2.0 * ROUNDOFF);
        let rest = self.error + value.hi().abs() * WIDEN * other.error + own + UNDERFLOW;
        Self { value, error: rest / divisor * WIDEN + UNDERFLOW }
    }
}

impl Real for Ball106 {
    const IS_FINE: bool = true;

    fn exact(value: f64) -> Self {
        Self { value: DoubleDouble::from(value), error: 0.0 }
    }

    fn rounded(value: DoubleDouble, relative_error: f64) -> Self {
        Self { value, error: value.hi().abs() * relative_error * WIDEN }
    }

    fn unit_interval() -> Self {
        Self { value: DoubleDouble::from(0.5), error: 0.5 }
    }

    fn value(self) -> f64 {
        self.value.hi()
    }

    fn error(self) -> f64 {
        self.error
    }

    /// The bound is that of `Ball64`.
    fn sqrt(self) -> Self {
        if self.is_zero() {
            return self;
        }
        let middle = self.value.hi();
        if middle <= self.error {
            let top = ((middle + self.error) * WIDEN).max(0.0).sqrt();
            return Self { value: DoubleDouble::from(0.5 * top), error: 0.5 * top * WIDEN + UNDERFLOW };
        }
        let value = self.value.sqrt();
        let share = if self.error * 4.0 < middle { 0.54 } else { 1.0 };
        Self { value, error: (share * self.error / value.hi() + value.hi() * (2.0 * ROUNDOFF)) * WIDEN + UNDERFLOW }
    }

    /// Whole exponents by squaring, others as exp(p·ln x); wide balls are bounded in binary64.
    fn pow(self, exponent: f64) -> Self {
        if exponent == 0.0 {
            return Self::exact(1.0);
        }
        if exponent.fract() == 0.0 && exponent <= MAX_SQUARING_EXPONENT {
            return self.pow_whole(exponent as u32);
        }
        let relative = self.error / self.value.hi();
        let spread = exponent * relative / (1.0 - relative);
        if !(self.value.hi() > 0.0 && relative < 0.5 && spread <= 0.1) {
            let coarse = Ball64::new(self.value.hi(), self.error + self.value.lo().abs() * WIDEN).pow(exponent);
            return Self { value: DoubleDouble::from(coarse.value()), error: coarse.error() };
        }
        let (value, relative_error) = elementary::pow(self.value, exponent);
        Self { value, error: value.hi() * (1.1 * spread + relative_error) * WIDEN + UNDERFLOW }
    }

    fn clamp_unit(self) -> Self {
        let middle = self.value.hi();
        if middle - 2.0 * self.error >= 1.0 + f64::EPSILON {
            Self::exact(1.0)
        } else if middle + 2.0 * self.error <= -f64::MIN_POSITIVE {
            Self::exact(0.0)
        } else if middle >= 1.0 && self.value.lo() >= 0.0 {
            Self { value: DoubleDouble::ONE, error: self.error }
        } else if middle <= 0.0 {
            Self { value: DoubleDouble::ZERO, error: self.error }
        } else {
            self
        }
    }

    fn sign(self) -> Sign {
        Sign::of_ball(self.value.hi(), self.error)
    }

    fn power_of_point<const N: usize>(point: [Self; N], center: [f64; N], radius: f64) -> Self {
        let mut power = -Self::exact(radius).square();
        for (coordinate, center) in point.into_iter().zip(center) {
            power = power + (coordinate - Self::exact(center)).square();
        }
        let is_binary64 = |number: &Self| number.error == 0.0 && number.value.lo() == 0.0;
        if power.sign() != Sign::Unknown || !point.iter().all(is_binary64) {
            return power;
        }
        let exact = Expansion::power_of_point(point.map(Self::value), center, radius);
        exact.map_or(power, |exact| exact.rounded())
    }

    fn floor(self) -> Option<f64> {
        let nearest = self.value.hi().round();
        let above = self.value - DoubleDouble::from(nearest);
        let above = Self { value: above, error: (self.error + above.hi().abs() * ROUNDOFF) * WIDEN };
        match above.sign() {
            Sign::Negative if self.error < 0.25 => Some(nearest - 1.0),
            Sign::Positive | Sign::Zero if self.error < 0.25 => Some(nearest),
            _ => None,
        }
    }
}
