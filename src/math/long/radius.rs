//! Sizes: bounds of magnitudes in 32 bits, of any exponent.

use std::cmp::Ordering;

/// A size of `mantissa`·2^`exponent`, with a mantissa of 0 or 32 bits, the first of which is 1.
///
/// Every operation rounds up, so that bounds from above give a bound from above. Those that end in `down` round down, for
/// bounds from below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Radius {
    mantissa: u64,
    exponent: i64,
}

/// The first mantissa bit.
const TOP: u64 = 1 << 31;

/// From this exponent on a size counts as infinite. Exponents of numbers stay so far below that their sums do not overflow.
const INFINITE_EXPONENT: i64 = 1 << 61;

impl Radius {
    pub const ZERO: Self = Self { mantissa: 0, exponent: 0 };
    pub const INFINITE: Self = Self { mantissa: TOP, exponent: INFINITE_EXPONENT };

    /// Makes `mantissa`·2^`exponent`, rounded up.
    #[inline]
    pub fn new(mantissa: u64, exponent: i64) -> Self {
        let shift = 32 - i64::from(mantissa.leading_zeros());
        if mantissa == 0 {
            return Self::ZERO;
        }
        if shift <= 0 {
            return Self { mantissa: mantissa << -shift, exponent: exponent + shift }.within_range();
        }
        let shortened = mantissa >> shift;
        let lost = u64::from(shortened << shift != mantissa);
        Self::carried(shortened + lost, exponent + shift)
    }

    /// Makes `mantissa`·2^`exponent`, rounded down.
    #[inline]
    pub fn new_down(mantissa: u64, exponent: i64) -> Self {
        if mantissa == 0 {
            return Self::ZERO;
        }
        let shift = 32 - i64::from(mantissa.leading_zeros());
        let mantissa = if shift <= 0 { mantissa << -shift } else { mantissa >> shift };
        Self { mantissa, exponent: exponent + shift }
    }

    /// Makes 2^`exponent`.
    #[inline]
    pub fn power_of_two(exponent: i64) -> Self {
        Self { mantissa: TOP, exponent: exponent - 31 }.within_range()
    }

    /// Returns the mantissa and the exponent.
    pub fn parts(self) -> (u64, i64) {
        (self.mantissa, self.exponent)
    }

    /// Returns 1.859 times a bound from below.
    pub fn by_1_859_down(self) -> Self {
        // 119/64 is 1.859375.
        Self::new_down(self.mantissa * 119, self.exponent - 6)
    }

    /// Takes a mantissa that rounding may have brought up to 2³².
    #[inline]
    fn carried(mantissa: u64, exponent: i64) -> Self {
        let carry = mantissa >> 32;
        Self { mantissa: mantissa >> carry, exponent: exponent + carry as i64 }.within_range()
    }

    /// Rounds up what is beyond the range of exponents.
    #[inline]
    fn within_range(self) -> Self {
        if self.exponent.abs() < INFINITE_EXPONENT {
            self
        } else if self.exponent > 0 {
            Self::INFINITE
        } else {
            Self { mantissa: TOP, exponent: 1 - INFINITE_EXPONENT }
        }
    }

    #[inline]
    pub fn is_zero(self) -> bool {
        self.mantissa == 0
    }

    #[inline]
    pub fn is_infinite(self) -> bool {
        self.exponent >= INFINITE_EXPONENT
    }

    /// Returns e with 2^(e − 1) ≤ `self` < 2^e; meaningless for 0.
    #[inline]
    pub fn exponent_above(self) -> i64 {
        self.exponent + 32
    }

    /// Multiplies by 2^`by`.
    #[inline]
    pub fn shifted(self, by: i64) -> Self {
        if self.is_zero() || self.is_infinite() {
            return self;
        }
        Self { exponent: self.exponent + by, ..self }.within_range()
    }

    #[inline]
    pub fn plus(self, other: Self) -> Self {
        if other.is_zero() {
            return self;
        }
        if self.is_zero() {
            return other;
        }
        let (large, small) = if self.exponent >= other.exponent { (self, other) } else { (other, self) };
        let shift = large.exponent - small.exponent;
        let small = if shift < 32 { (small.mantissa >> shift) + u64::from(shift > 0) } else { 1 };
        let sum = large.mantissa + small;
        let carry = sum >> 32;
        Self::carried((sum >> carry) + carry, large.exponent + carry as i64)
    }

    #[inline]
    pub fn times(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self::ZERO;
        }
        if self.is_infinite() || other.is_infinite() {
            return Self::INFINITE;
        }
        let product = self.mantissa * other.mantissa;
        let shift = 31 + (product >> 63);
        Self::carried((product >> shift) + 1, self.exponent + other.exponent + shift as i64)
    }

    /// Divides by a bound from below of the divisor.
    #[inline]
    pub fn over(self, lower: Self) -> Self {
        if self.is_zero() {
            return self;
        }
        if lower.is_zero() || self.is_infinite() {
            return Self::INFINITE;
        }
        Self::new((self.mantissa << 32) / lower.mantissa + 1, self.exponent - lower.exponent - 32)
    }

    pub fn square_root(self) -> Self {
        if self.is_zero() || self.is_infinite() {
            return self;
        }
        let is_odd = self.exponent & 1;
        // At most 63 bits, of which binary64 loses some: the root of that is off by less than 1.
        let root = ((self.mantissa << (30 + is_odd)) as f64).sqrt() as u64 + 2;
        Self::new(root, (self.exponent - is_odd - 30) / 2)
    }

    /// Returns a bound from below of `self` − `other`, where `self` is one itself; 0 if it may be below.
    #[inline]
    pub fn minus_down(self, other: Self) -> Self {
        if other.is_zero() || self.is_zero() {
            return self;
        }
        let shift = self.exponent - other.exponent;
        let taken = match shift {
            ..-1 => return Self::ZERO,
            -1 => other.mantissa << 31,
            0..62 => (other.mantissa << 30 >> shift) + 1,
            _ => 1,
        };
        Self::new_down((self.mantissa << 30).saturating_sub(taken), self.exponent - 30)
    }

    /// Tells whether `self` is surely below `lower`, a bound from below.
    #[inline]
    pub fn is_below(self, lower: Self) -> bool {
        match self.exponent_above().cmp(&lower.exponent_above()) {
            _ if lower.is_zero() => false,
            _ if self.is_zero() => true,
            Ordering::Less => true,
            Ordering::Equal => self.mantissa < lower.mantissa,
            Ordering::Greater => false,
        }
    }

    /// Returns the size in binary64, rounded up; infinite or the least normal number beyond its range.
    pub fn to_f64_up(self) -> f64 {
        match self.exponent {
            _ if self.is_zero() => 0.0,
            992.. => f64::INFINITY,
            ..-1050 => f64::MIN_POSITIVE,
            exponent => {
                let halves = [exponent / 2, exponent - exponent / 2];
                halves.into_iter().fold(self.mantissa as f64, |size, half| size * libm::exp2(half as f64))
            }
        }
    }

    /// Returns a bound of the magnitude of a binary64 number, which may be infinite or NaN.
    pub fn of_f64(size: f64) -> Self {
        if !size.is_finite() {
            return Self::INFINITE;
        }
        let (mantissa, exponent) = parts(size);
        Self::new(mantissa, exponent)
    }
}

/// Returns the mantissa m and the exponent e of a finite number whose magnitude is m·2^e.
pub(super) fn parts(number: f64) -> (u64, i64) {
    let bits = number.to_bits();
    let (fraction, exponent) = (bits & ((1 << 52) - 1), (bits >> 52 & 0x7ff) as i64);
    if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) }
}
