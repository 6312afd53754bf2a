//! Numbers without a proof: double-double of any exponent, and what it is probably off by.
//!
//! A bound that must hold grows with every operation, beyond all measure after some mirrors, though what is computed may well
//! be right. A [`Computed`] number always has a sign: that of what was computed. Its error is an estimate, and serves for one
//! question only: whether a number that should be 0 is as near to 0 as roundings leave it.

use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::math::{Ball106, DoubleDouble, Real, Sign};

/// The estimated relative error of one operation.
const ROUNDOFF: f64 = DoubleDouble::ROUNDOFF;

/// 2²⁰⁰: the middles of numbers that are not 0 are kept between this and its reciprocal, so that no product overflows, and
/// none underflows.
const LARGE: f64 = f64::from_bits((1023 + 200) << 52);

/// A number below its error is taken for 0 if its error is at most this share of the numbers that it is the sum of, 2⁻⁴⁰. That
/// a sum comes so near to 0 by chance is less likely than that it is 0. With larger errors it is the other way round.
const NARROW: f64 = 1.0 / (1u64 << 40) as f64;

/// The largest whole exponent of a power that is carried out by squaring.
const MAX_SQUARING_EXPONENT: f64 = 1_048_576.0;

/// The number `value` · 2^`exponent`, with an error and a size in the same units.
#[derive(Clone, Copy, Debug)]
pub struct Computed {
    value: DoubleDouble,
    exponent: i32,
    /// An estimate, perhaps infinite.
    error: f64,
    /// The magnitudes of the terms that this is the sum of, added up; at least its own.
    size: f64,
}

impl Computed {
    /// Makes a number, and brings the middle into its range.
    fn new(value: DoubleDouble, exponent: i32, error: f64, size: f64) -> Self {
        let number = Self { value, exponent, error, size };
        let magnitude = value.hi().abs();
        if magnitude == 0.0 || !magnitude.is_finite() || (magnitude < LARGE && magnitude > 1.0 / LARGE) {
            return number;
        }
        let shift = libm::ilogb(magnitude);
        Self { exponent, ..number.shifted(-shift) }.with_exponent(exponent.saturating_add(shift))
    }

    /// Makes a number that is no sum.
    fn product(value: DoubleDouble, exponent: i32, error: f64) -> Self {
        Self::new(value, exponent, error + value.hi().abs() * ROUNDOFF, value.hi().abs())
    }

    fn with_exponent(self, exponent: i32) -> Self {
        Self { exponent, ..self }
    }

    /// Multiplies all parts by a power of two, and leaves the exponent as it is.
    fn shifted(self, shift: i32) -> Self {
        let by = |x: f64| libm::ldexp(x, shift);
        let value = DoubleDouble::from_parts(by(self.value.hi()), by(self.value.lo()));
        Self { value, error: by(self.error), size: by(self.size), ..self }
    }

    /// Returns the same number in other units.
    fn at_exponent(self, exponent: i32) -> Self {
        if self.exponent == exponent {
            return self;
        }
        self.shifted(self.exponent.saturating_sub(exponent).clamp(-3000, 3000)).with_exponent(exponent)
    }

    fn is_zero(self) -> bool {
        self.value.hi() == 0.0
    }

    /// Returns the error if it is so small beside what the number is made from that 0 cannot be told from what is near.
    fn narrow_error(self) -> Option<f64> {
        (self.error.is_finite() && self.error <= self.size * NARROW).then_some(self.error)
    }

    /// Returns the number in double-double; infinite or 0 beyond its range.
    fn middle(self) -> DoubleDouble {
        self.at_exponent(0).value
    }

    /// Returns the same number if it is one of binary64.
    fn as_binary64(self) -> Option<f64> {
        (self.exponent == 0 && self.error == 0.0 && self.value.lo() == 0.0).then_some(self.value.hi())
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

impl Add for Computed {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let exponent = match (self.is_zero(), other.is_zero()) {
            (true, _) => other.exponent,
            (_, true) => self.exponent,
            _ => self.exponent.max(other.exponent),
        };
        let (a, b) = (self.at_exponent(exponent), other.at_exponent(exponent));
        let value = a.value + b.value;
        Self::new(value, exponent, a.error + b.error + value.hi().abs() * ROUNDOFF, a.size + b.size)
    }
}

impl Sub for Computed {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Computed {
    type Output = Self;

    fn neg(self) -> Self {
        Self { value: -self.value, ..self }
    }
}

impl Mul for Computed {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let value = self.value * other.value;
        let [a, b] = [self, other].map(|number| number.value.hi().abs());
        let inherited = if self.error == 0.0 && other.error == 0.0 {
            0.0
        } else {
            a * other.error + b * self.error + self.error * other.error
        };
        Self::product(value, self.exponent.saturating_add(other.exponent), inherited)
    }
}

impl Div for Computed {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let divisor = other.value.hi().abs();
        let inherited = (self.error + value.hi().abs() * other.error) / divisor;
        Self::product(value, self.exponent.saturating_sub(other.exponent), inherited)
    }
}

impl Real for Computed {
    const IS_FINE: bool = true;

    fn exact(value: f64) -> Self {
        Self::new(DoubleDouble::from(value), 0, 0.0, value.abs())
    }

    fn rounded(value: DoubleDouble, relative_error: f64) -> Self {
        Self::new(value, 0, value.hi().abs() * relative_error, value.hi().abs())
    }

    fn unit_interval() -> Self {
        Self::exact(0.5)
    }

    fn value(self) -> f64 {
        self.middle().hi()
    }

    /// Returns the error if it is narrow; what has no narrow one is what was computed.
    fn error(self) -> f64 {
        self.narrow_error().map_or(0.0, |error| libm::ldexp(error, self.exponent))
    }

    fn sqrt(self) -> Self {
        // The exponent has to be even.
        let Self { value, exponent, error, .. } = self.at_exponent(self.exponent & !1);
        if value.hi() <= 0.0 {
            return Self::new(DoubleDouble::ZERO, exponent / 2, error.sqrt(), 0.0);
        }
        let root = value.sqrt();
        Self::product(root, exponent / 2, error / root.hi())
    }

    fn pow(self, exponent: f64) -> Self {
        if exponent == 0.0 {
            return Self::exact(1.0);
        }
        if exponent.fract() == 0.0 && exponent <= MAX_SQUARING_EXPONENT {
            return self.pow_whole(exponent as u32);
        }
        let middle = self.middle();
        if middle.hi().is_nan() || middle.hi() <= 0.0 {
            return Self::exact(0.0);
        }
        let power = Ball106::rounded(middle, 0.0).pow(exponent).middle();
        Self::product(power, 0, power.hi() * exponent * (self.error / self.value.hi().abs() + ROUNDOFF))
    }

    fn clamp_unit(self) -> Self {
        if self.value.hi().is_nan() || self.value.hi() < 0.0 {
            return Self::exact(0.0);
        }
        if (self - Self::exact(1.0)).value.hi() > 0.0 { Self::exact(1.0) } else { self }
    }

    /// Is always known. What is no number, as the square root of infinity less itself, counts as below 0: nothing is met there.
    fn sign(self) -> Sign {
        let middle = self.value.hi();
        if middle == 0.0 || self.narrow_error().is_some_and(|error| middle.abs() <= error) {
            Sign::Zero
        } else if middle > 0.0 {
            Sign::Positive
        } else {
            Sign::Negative
        }
    }

    fn power_of_point<const N: usize>(point: [Self; N], center: [f64; N], radius: f64) -> Self {
        let is_in_range = |length: f64| length == 0.0 || (length.abs() < LARGE && length.abs() > 1.0 / LARGE);
        let is_exact = center.into_iter().chain([radius]).all(is_in_range)
            && point.iter().all(|coordinate| coordinate.as_binary64().is_some());
        if is_exact {
            let point = point.map(|coordinate| Ball106::exact(coordinate.value.hi()));
            let power = Ball106::power_of_point(point, center, radius);
            if power.sign() != Sign::Unknown {
                return Self::new(power.middle(), 0, power.error(), power.middle().hi().abs());
            }
        }
        let mut power = -Self::exact(radius).square();
        for (coordinate, center) in point.into_iter().zip(center) {
            power = power + (coordinate - Self::exact(center)).square();
        }
        power
    }

    fn floor(self) -> Option<f64> {
        let nearest = self.value().round();
        Some(match (self - Self::exact(nearest)).sign() {
            Sign::Negative => nearest - 1.0,
            _ => nearest,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(value: f64) -> Computed {
        Computed::exact(value)
    }

    #[test]
    fn numbers_of_any_size_are_computed_with() {
        let (large, small) = (exact(1e300), exact(1e-300));
        let one = large * large * small * small;
        assert!((one.value() - 1.0).abs() < 1e-14);
        let huge = large.square().square();
        assert_eq!((huge - huge).sign(), Sign::Zero);
        assert_eq!((huge + small - huge).sign(), Sign::Zero, "too far apart");
        assert!(((huge.sqrt() - large.square()) / large.square()).value().abs() < 1e-30);
        assert_eq!((small.square() - exact(0.0)).sign(), Sign::Positive);
        assert_eq!((exact(0.0) + small.square()).sign(), Sign::Positive);
        assert!(((small.square().square().sqrt() / small.square()).value() - 1.0).abs() < 1e-30);
        assert!((exact(0.3).pow(2.5).value() / (0.09 * 0.3f64.sqrt()) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn what_roundings_leave_of_0_is_0_and_what_is_lost_has_the_sign_that_was_computed() {
        let third = exact(1.0) / exact(3.0);
        assert_eq!((third + third + third - exact(1.0)).sign(), Sign::Zero);
        assert_eq!((third + third + third).floor(), Some(1.0));
        assert_eq!((third * exact(3.0) - exact(1.0) + exact(1e-20)).sign(), Sign::Positive);
        // Errors that grow as among mirrors.
        let vague = (0..40).fold(third, |number, _| (number - third * exact(1.0 - 1.0 / 1024.0)) * exact(1024.0));
        assert!(vague.narrow_error().is_none());
        assert_ne!(vague.sign(), Sign::Zero);
        assert_eq!(vague.error(), 0.0);
    }

    #[test]
    fn what_is_no_number_is_met_nowhere() {
        let none = exact(0.0) / exact(0.0);
        assert_eq!((none.sign(), none.clamp_unit().value()), (Sign::Negative, 0.0));
        assert_eq!(exact(-1.0).sqrt().value(), 0.0);
        assert_eq!(exact(-0.5).pow(2.5).value(), 0.0);
    }

    #[test]
    fn the_power_of_an_exact_point_has_its_sign() {
        let power = |x: f64| Computed::power_of_point([exact(x), exact(0.0), exact(0.0)], [0.0, 0.0, 1e17], 1e17);
        assert_eq!(power(0.0).sign(), Sign::Zero);
        assert_eq!(power(1e-30).sign(), Sign::Positive);
    }
}
