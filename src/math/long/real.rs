//! Long numbers as an arithmetic of the tracer.

use super::Long;
use super::radius::{Radius, parts};
use crate::math::{DoubleDouble, Expansion, Real, Sign};

/// The largest exponent that is carried out by repeated squaring.
const MAX_SQUARING_EXPONENT: f64 = 1_048_576.0;

/// Numbers below 2^`LEAST_EXPONENT` have a bound of that at least once they are binary64, which has fewer digits for them.
const LEAST_EXPONENT: i64 = -960;

/// Returns `number`·2^`exponent`; infinite or 0 beyond the range of binary64.
fn scaled(number: f64, exponent: i64) -> f64 {
    let exponent = exponent.clamp(-3000, 3000);
    let third = exponent / 3;
    [third, third, exponent - 2 * third].into_iter().fold(number, |number, part| number * libm::exp2(part as f64))
}

impl<const N: usize> Real for Long<N> {
    const IS_FINE: bool = true;

    fn exact(value: f64) -> Self {
        if !value.is_finite() {
            return Self::unknown();
        }
        let (mantissa, exponent) = parts(value);
        if mantissa == 0 {
            return Self::about_zero(Radius::ZERO);
        }
        let shift = mantissa.leading_zeros();
        let mut number = Self::power_of_two(exponent + 63 - i64::from(shift));
        number.limbs[0] = mantissa << shift;
        Self { is_negative: value < 0.0, ..number }
    }

    fn rounded(value: DoubleDouble, relative_error: f64) -> Self {
        let middle = Self::exact(value.hi()) + Self::exact(value.lo());
        Self { radius: middle.radius.plus(middle.upper().times(Radius::of_f64(relative_error))), ..middle }
    }

    fn unit_interval() -> Self {
        Self { radius: Radius::power_of_two(-1), ..Self::power_of_two(-1) }
    }

    fn tan_half_degrees(degrees: f64) -> Self {
        Self::tangent_of_half(degrees)
    }

    fn value(self) -> f64 {
        if self.len == 0 {
            return 0.0;
        }
        let magnitude = scaled(self.limbs[0] as f64, self.exponent - 64);
        if self.is_negative { -magnitude } else { magnitude }
    }

    fn error(self) -> f64 {
        let size = if self.len > 0 && self.exponent < LEAST_EXPONENT {
            self.radius.plus(Radius::power_of_two(LEAST_EXPONENT))
        } else {
            self.radius
        };
        size.to_f64_up()
    }

    fn sqrt(self) -> Self {
        if self.is_zero() {
            return self;
        }
        let is_positive = self.len > 0 && !self.is_negative;
        if is_positive && self.radius.is_below(self.lower()) {
            return self.root_of_positive();
        }
        let top = if is_positive { self.upper().plus(self.radius) } else { self.radius };
        Self::up_to(top.square_root())
    }

    /// Whole exponents by squaring, others as exp(p·ln x); wide balls by the powers of their ends.
    ///
    /// With s = p·r/(m − r), x^p for x within r of m is within m^p·(e^s − 1) of m^p, and e^s − 1 ≤ 1.06·s for s ≤ 0.1.
    fn pow(self, exponent: f64) -> Self {
        if exponent == 0.0 {
            return Self::exact(1.0);
        }
        if exponent.fract() == 0.0 && exponent <= MAX_SQUARING_EXPONENT {
            return self.pow_whole(exponent as u32);
        }
        if self.sign() == Sign::Positive {
            let spread = self.radius.over(self.lower().minus_down(self.radius)).times(Radius::of_f64(exponent));
            if spread.is_zero() || !Radius::of_f64(0.1).is_below(spread) {
                let power = self.middle().to_the(exponent, self.known_bits());
                let inherited = power.upper().plus(power.radius).times(spread).times(Radius::of_f64(1.06));
                return Self { radius: power.radius.plus(inherited), ..power };
            }
        }
        let zero = Self::about_zero(Radius::ZERO);
        let [bottom, top] = self.ends();
        let top = if top.sign() == Sign::Unknown { Self::of_radius(top.upper().plus(top.radius)) } else { top };
        let [bottom, top] = [bottom, top].map(|end| match end.sign() {
            Sign::Positive => end.to_the(exponent, 64),
            Sign::Negative | Sign::Zero | Sign::Unknown => zero,
        });
        bottom.hull(&top)
    }

    fn clamp_unit(self) -> Self {
        let one = Self::power_of_two(0);
        if matches!((self - one).sign(), Sign::Positive | Sign::Zero) {
            one
        } else if self.sign() == Sign::Negative {
            Self::about_zero(Radius::ZERO)
        } else if !self.radius.is_below(Radius::power_of_two(-1)) {
            Self::unit_interval()
        } else if self.is_negative || self.len == 0 {
            Self::about_zero(self.radius)
        } else if self.exponent > 0 {
            Self { radius: self.radius, ..one }
        } else {
            self
        }
    }

    #[inline]
    fn sign(self) -> Sign {
        match (self.len, self.is_negative) {
            (0, _) if self.radius.is_zero() => Sign::Zero,
            (0, _) => Sign::Unknown,
            (_, is_negative) if self.radius.is_below(self.lower()) => {
                if is_negative {
                    Sign::Negative
                } else {
                    Sign::Positive
                }
            }
            _ => Sign::Unknown,
        }
    }

    fn power_of_point<const M: usize>(point: [Self; M], center: [f64; M], radius: f64) -> Self {
        let mut power = -Self::exact(radius).square();
        for (coordinate, center) in point.into_iter().zip(center) {
            power = power + (coordinate - Self::exact(center)).square();
        }
        let is_binary64 = |number: &Self| number.radius.is_zero() && number.len < 2 && number.exponent > LEAST_EXPONENT;
        if power.sign() != Sign::Unknown || !point.iter().all(is_binary64) {
            return power;
        }
        let exact = Expansion::power_of_point(point.map(Self::value), center, radius);
        exact.map_or(power, |exact| exact.rounded())
    }

    fn floor(self) -> Option<f64> {
        if self.error() >= 0.25 || self.exponent > 50 {
            return None;
        }
        let nearest = self.value().round();
        match (self - Self::exact(nearest)).sign() {
            Sign::Negative => Some(nearest - 1.0),
            Sign::Positive | Sign::Zero => Some(nearest),
            Sign::Unknown => None,
        }
    }
}

impl<const N: usize> Long<N> {
    /// Returns a ball that holds two.
    fn hull(&self, other: &Self) -> Self {
        let sum = *self + *other;
        let middle = if sum.len == 0 { sum } else { Self { exponent: sum.exponent - 1, ..sum } }.middle();
        let reach = [self, other].map(|ball| {
            let off = middle - *ball;
            off.upper().plus(off.radius)
        });
        let radius = if reach[0].is_below(reach[1]) { reach[1] } else { reach[0] };
        Self { radius, ..middle }
    }
}
