//! Double-double arithmetic: unevaluated sums of two binary64 numbers, 106 bits.
//!
//! # Source
//! Dekker, "A floating-point technique for extending the available precision", Numerische Mathematik 18 (1971), for the
//! exact product; Joldes, Muller, Popescu, "Tight and rigorous error bounds for basic building blocks of double-word
//! arithmetic", ACM TOMS 44 (2017), for the algorithms (6, 10, 12, 17) and their bounds. Products are split by Veltkamp's
//! method and not by a fused multiply-add, so that the results are the same on machines that have none.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// The unevaluated sum `hi + lo`, with `|lo|` at most half an ulp of `hi`.
///
/// Every operation is within [`DoubleDouble::ROUNDOFF`] of the exact result, relative to that result, unless it
/// underflows (below 2⁻⁹⁶⁰ or so) or an operand exceeds 2⁹⁹⁰.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleDouble {
    hi: f64,
    lo: f64,
}

impl DoubleDouble {
    /// A bound on the relative error of one operation: 2⁻¹⁰².
    ///
    /// The bounds proved for the sum, the product, the quotient and the square root are 3u², 7u², 15u² and 25/8·u² with
    /// u = 2⁻⁵³, all below 16u².
    pub const ROUNDOFF: f64 = 16.0 * (f64::EPSILON / 2.0) * (f64::EPSILON / 2.0);

    /// Zero.
    pub const ZERO: Self = Self { hi: 0.0, lo: 0.0 };

    /// One.
    pub const ONE: Self = Self { hi: 1.0, lo: 0.0 };

    /// Makes a number from its two parts, which must not overlap.
    #[must_use]
    pub const fn from_parts(hi: f64, lo: f64) -> Self {
        Self { hi, lo }
    }

    /// Returns the leading part: the number rounded to binary64.
    #[must_use]
    pub const fn hi(self) -> f64 {
        self.hi
    }

    /// Returns the trailing part.
    #[must_use]
    pub const fn lo(self) -> f64 {
        self.lo
    }

    /// Returns the exact sum of two binary64 numbers.
    #[must_use]
    pub fn sum(a: f64, b: f64) -> Self {
        let hi = a + b;
        let b_rounded = hi - a;
        let lo = (a - (hi - b_rounded)) + (b - b_rounded);
        Self { hi, lo }
    }

    /// Returns the exact sum of two binary64 numbers with `|a| >= |b|` or `a == 0`.
    fn fast_sum(a: f64, b: f64) -> Self {
        let hi = a + b;
        Self { hi, lo: b - (hi - a) }
    }

    /// Returns the exact product of two binary64 numbers.
    #[must_use]
    pub fn product(a: f64, b: f64) -> Self {
        let hi = a * b;
        let (a_hi, a_lo) = split(a);
        let (b_hi, b_lo) = split(b);
        let lo = ((a_hi * b_hi - hi) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo;
        Self { hi, lo }
    }

    /// Returns the product with a power of two, which is exact.
    #[must_use]
    pub fn scale(self, power_of_two: f64) -> Self {
        Self { hi: self.hi * power_of_two, lo: self.lo * power_of_two }
    }

    /// Returns the square.
    #[must_use]
    pub fn square(self) -> Self {
        self * self
    }

    /// Returns the square root; the number must not be negative.
    #[must_use]
    pub fn sqrt(self) -> Self {
        if self.hi <= 0.0 {
            return Self::ZERO;
        }
        let root = self.hi.sqrt();
        let rest = self - Self::product(root, root);
        Self::fast_sum(root, rest.hi / (2.0 * root))
    }
}

/// Splits a number into two of 26 bits each (Veltkamp).
fn split(a: f64) -> (f64, f64) {
    const FACTOR: f64 = 134_217_729.0; // 2^27 + 1
    let scaled = FACTOR * a;
    let hi = scaled - (scaled - a);
    (hi, a - hi)
}

impl From<f64> for DoubleDouble {
    fn from(value: f64) -> Self {
        Self { hi: value, lo: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let high = Self::sum(self.hi, other.hi);
        let low = Self::sum(self.lo, other.lo);
        let carried = Self::fast_sum(high.hi, high.lo + low.hi);
        Self::fast_sum(carried.hi, carried.lo + low.lo)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for DoubleDouble {
    type Output = Self;

    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let high = Self::product(self.hi, other.hi);
        Self::fast_sum(high.hi, high.lo + (self.hi * other.lo + self.lo * other.hi))
    }
}

impl Mul<f64> for DoubleDouble {
    type Output = Self;

    fn mul(self, other: f64) -> Self {
        self * Self::from(other)
    }
}

impl Div for DoubleDouble {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let quotient = self.hi / other.hi;
        let rest = self - other * quotient;
        Self::fast_sum(quotient, rest.hi / other.hi)
    }
}
