//! Magnitudes: upper and lower bounds of sizes, in a few bits but of any exponent.

/// A size, `mantissa` · 2^`exponent`, with the mantissa 0, in [1, 2) or infinite.
///
/// Every operation rounds its result up by a factor that covers the few roundings of binary64 in it, so that upper bounds
/// in give an upper bound out; those with `down` in their name do the same for lower bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mag {
    mantissa: f64,
    exponent: i64,
}

impl Mag {
    pub const ZERO: Self = Self { mantissa: 0.0, exponent: 0 };
    pub const INFINITE: Self = Self { mantissa: f64::INFINITY, exponent: 0 };
    /// Covers the rounding of the at most eight binary64 operations that make a bound, each below 2⁻⁵³.
    pub const UP: f64 = 1.0 + 16.0 * f64::EPSILON;
    /// The same for a lower bound.
    pub const DOWN: f64 = 1.0 - 16.0 * f64::EPSILON;

    /// Brings the mantissa into [1, 2), which is exact.
    pub fn new(mantissa: f64, exponent: i64) -> Self {
        if mantissa == 0.0 || mantissa.is_infinite() {
            return Self { mantissa, exponent: 0 };
        }
        assert!(mantissa > 0.0 && mantissa.is_normal(), "{mantissa:e} is no mantissa");
        let shift = (mantissa.to_bits() >> 52) as i64 - 1023;
        let mantissa = f64::from_bits(mantissa.to_bits() & !(0x7ff << 52) | 0x3ff << 52);
        Self { mantissa, exponent: exponent.saturating_add(shift) }
    }

    pub fn power_of_two(exponent: i64) -> Self {
        Self { mantissa: 1.0, exponent }
    }

    pub fn is_zero(self) -> bool {
        self.mantissa == 0.0
    }

    pub fn is_infinite(self) -> bool {
        self.mantissa.is_infinite()
    }

    /// Returns e with `self` < 2^e; meaningless for 0 and infinity.
    pub fn exponent_above(self) -> i64 {
        self.exponent + 1
    }

    /// Multiplies by 2^`by`.
    pub fn shifted(self, by: i64) -> Self {
        if self.is_zero() || self.is_infinite() { self } else { Self { exponent: self.exponent + by, ..self } }
    }

    /// Returns `self` in units of 2^`exponent`, rounded up; 0 only for 0.
    fn in_units_of(self, exponent: i64) -> f64 {
        let shift = (self.exponent - exponent).clamp(-1000, 1000);
        self.mantissa * f64::from_bits(((1023 + shift) as u64) << 52)
    }

    pub fn plus(self, other: Self) -> Self {
        match (self.is_zero(), other.is_zero()) {
            (true, _) => other,
            (_, true) => self,
            _ => {
                let exponent = self.exponent.max(other.exponent);
                Self::new((self.in_units_of(exponent) + other.in_units_of(exponent)) * Self::UP, exponent)
            }
        }
    }

    pub fn times(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self::ZERO;
        }
        Self::new(self.mantissa * other.mantissa * Self::UP, self.exponent + other.exponent)
    }

    /// Divides by a lower bound of the divisor.
    pub fn over(self, lower: Self) -> Self {
        if self.is_zero() {
            return self;
        }
        if lower.is_zero() {
            return Self::INFINITE;
        }
        Self::new(self.mantissa / lower.mantissa * Self::UP, self.exponent - lower.exponent)
    }

    pub fn square_root(self) -> Self {
        let odd = self.exponent.rem_euclid(2);
        let mantissa = if odd == 1 { 2.0 * self.mantissa } else { self.mantissa };
        Self::new(mantissa.sqrt() * Self::UP, (self.exponent - odd) / 2)
    }

    /// Returns a lower bound of `self` − `other` where `self` is itself a lower bound; 0 when it may be below.
    pub fn minus_down(self, other: Self) -> Self {
        if self.is_zero() || other.is_infinite() {
            return Self::ZERO;
        }
        if other.is_zero() {
            return self;
        }
        let exponent = self.exponent.max(other.exponent);
        let difference = self.in_units_of(exponent) * Self::DOWN - other.in_units_of(exponent) * Self::UP;
        if difference > 1e-300 { Self::new(difference * Self::DOWN, exponent) } else { Self::ZERO }
    }

    /// Tells whether `self`, as an upper bound, is surely below `lower`.
    pub fn is_below(self, lower: Self) -> bool {
        !lower.minus_down(self).is_zero()
    }

    /// Returns the number in binary64, rounded up by an ulp or so; infinite or the least normal number beyond its range.
    pub fn to_f64_up(self) -> f64 {
        match self.exponent {
            _ if self.is_zero() || self.is_infinite() => self.mantissa,
            1023.. => f64::INFINITY,
            ..-1022 => f64::MIN_POSITIVE,
            exponent => self.mantissa * f64::from_bits(((1023 + exponent) as u64) << 52),
        }
    }
}

#[cfg(test)]
mod tests {
    use dashu_float::FBig;
    use dashu_float::round::mode::HalfEven;

    use super::*;
    use crate::testing::Stream;

    #[test]
    fn bounds_keep_their_direction() {
        let (tenth, third) = (Mag::new(0.1, 0), Mag::new(1.0 / 3.0, 0));
        assert!(tenth.plus(third).to_f64_up() > 0.1 + 1.0 / 3.0);
        assert!(tenth.times(third).to_f64_up() > 0.1 / 3.0);
        assert!(tenth.over(third).to_f64_up() > 0.1 * 3.0);
        assert!(third.square_root().to_f64_up() > (1.0_f64 / 3.0).sqrt());
        assert!(third.minus_down(tenth).to_f64_up() < 1.0 / 3.0 - 0.1);
        assert!(third.minus_down(third).is_zero() && !third.is_below(third));
    }

    #[test]
    fn far_exponents_neither_vanish_nor_overflow() {
        let (huge, tiny) = (Mag::power_of_two(1 << 40), Mag::power_of_two(-(1 << 40)));
        assert!(huge.plus(tiny).exponent_above() > 1 << 40 && huge.plus(tiny) != huge);
        assert!(tiny.is_below(huge) && !huge.is_below(tiny));
        assert_eq!(huge.times(tiny).exponent_above(), 1);
        assert_eq!(tiny.minus_down(Mag::ZERO), tiny);
        assert_eq!(huge.to_f64_up(), f64::INFINITY);
        assert_eq!(tiny.to_f64_up(), f64::MIN_POSITIVE);
    }

    /// Returns the size itself, to compare with.
    fn exactly(mag: Mag) -> FBig<HalfEven, 2> {
        let number = |x: f64| FBig::<HalfEven, 2>::try_from(x).expect("finite").with_precision(400).value();
        number(mag.mantissa) * number(libm::exp2(mag.exponent as f64))
    }

    /// Asserts that a bound lies on its side of `exact`, and within some roundings of it.
    fn assert_bounds(what: &str, bound: Mag, exact: &FBig<HalfEven, 2>, is_upper: bool) {
        let bound = exactly(bound);
        let (low, high) = if is_upper { (exact.clone(), bound) } else { (bound, exact.clone()) };
        assert!(low <= high, "{what}: {low} above {high}");
        let spare = FBig::try_from(1.0 - 128.0 * f64::EPSILON).expect("finite").with_precision(400).value();
        assert!(high * spare <= low, "{what}: far off");
    }

    #[test]
    fn every_operation_rounds_to_its_side() {
        let mut stream = Stream::new(53);
        for _ in 0..2000 {
            let [a, b] = [(); 2].map(|()| Mag::new(stream.between(0.1, 8.0), stream.below(200) as i64 - 100));
            let (exact_a, exact_b) = (exactly(a), exactly(b));
            assert_bounds("sum", a.plus(b), &(exact_a.clone() + exact_b.clone()), true);
            assert_bounds("product", a.times(b), &(exact_a.clone() * exact_b.clone()), true);
            assert_bounds("quotient", a.over(b), &(exact_a.clone() / exact_b.clone()), true);
            assert_bounds("root", a.square_root(), &exact_a.sqrt(), true);
            assert_eq!(a.shifted(7).shifted(-7), a);
            let above = Mag::power_of_two(a.exponent_above());
            assert!(exact_a < exactly(above) && exactly(above.shifted(-1)) <= exact_a);
            assert!(a.to_f64_up() >= a.mantissa * libm::exp2(a.exponent as f64));
            let [larger, smaller] = if exact_a > exact_b { [a, b] } else { [b, a] };
            let difference = exactly(larger) - exactly(smaller);
            let least = larger.minus_down(smaller);
            assert!(exactly(least) <= difference && smaller.minus_down(larger).is_zero());
            if smaller.exponent + 2 < larger.exponent {
                assert_bounds("difference", least, &difference, false);
                assert!(smaller.is_below(larger) && !larger.is_below(smaller));
            }
        }
    }

    #[test]
    fn nothing_and_the_infinite_are_sizes() {
        let (zero, one) = (Mag::ZERO, Mag::power_of_two(0));
        assert_eq!((zero.plus(one), one.plus(zero), zero.times(one), zero.over(one)), (one, one, zero, zero));
        assert_eq!((one.times(zero), zero.over(zero), zero.shifted(9)), (zero, zero, zero));
        assert_eq!((one.over(zero), Mag::INFINITE.shifted(-9)), (Mag::INFINITE, Mag::INFINITE));
        assert!(zero.minus_down(one).is_zero() && one.minus_down(Mag::INFINITE).is_zero());
        assert!(one.plus(Mag::INFINITE).is_infinite() && !one.is_infinite());
        assert_eq!((zero.to_f64_up(), one.to_f64_up(), Mag::INFINITE.to_f64_up()), (0.0, 1.0, f64::INFINITY));
        for exponent in [-1023, -1022, -1021, 1022, 1023] {
            let number = Mag::power_of_two(exponent).to_f64_up();
            assert!(number >= libm::exp2(exponent as f64), "2^{exponent} became {number:e}");
            assert!(exponent.abs() > 1021 || number == libm::exp2(exponent as f64));
        }
    }
}
