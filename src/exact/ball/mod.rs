//! Ball arithmetic: real numbers as a midpoint of chosen precision and a proved bound of its distance to the truth.
//!
//! Every operation takes balls that hold the true operands and returns one that holds the true result. A sign is given
//! only where the whole ball agrees, so a comparison is either proved or openly undecided; there is no epsilon. Exact
//! operations on exact operands keep radius 0, which lets ties of binary64 numbers be proved as well.
//!
//! The midpoints are dashu-float's; of it we use sum, difference, product, quotient and square root, and its word on
//! whether one was rounded. A result that was is within half an ulp of the truth, and we add a whole one to the radius.
//! `tan`, `ln` and `exp` are ours (`series`).
//!
//! # Source
//! Van der Hoeven, "Ball arithmetic" (2009); Johansson, "Arb: efficient arbitrary-precision midpoint-radius interval
//! arithmetic", IEEE Transactions on Computers 66 (2017), for a radius of few bits. The bounds of the operations are
//! derived where they stand.

mod mag;
mod series;
#[cfg(test)]
mod tests;

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use dashu_float::round::Rounded;
use dashu_float::round::mode::HalfEven;
use dashu_float::{Context, FBig};

use self::mag::Mag;

/// A number of a chosen precision; the nearest to the true result of one operation.
type Mid = FBig<HalfEven, 2>;

/// The precision at which nothing is rounded; quotients and roots have none.
const UNLIMITED: usize = 0;

/// A real number within `radius` of `mid`.
#[derive(Clone, Debug)]
pub struct Ball {
    mid: Mid,
    radius: Mag,
}

impl Ball {
    /// Makes the ball of radius 0 about a finite number, to be computed with at `bits` of precision, at least 53.
    ///
    /// # Panics
    /// When the number is not finite.
    #[must_use]
    pub fn exact(value: f64, bits: usize) -> Self {
        // Adding 0 turns −0 into 0.
        let mid = Mid::try_from(value + 0.0).expect("a finite number").with_precision(bits);
        Self::from_rounded(mid, Mag::ZERO)
    }

    /// Makes the ball of radius 0 with which sums, differences and products are exact, however long they grow.
    ///
    /// # Panics
    /// When the number is not finite.
    #[must_use]
    pub fn unrounded(value: f64) -> Self {
        Self::exact(value, UNLIMITED)
    }

    /// Returns an exact value at the precision of `self`.
    #[must_use]
    pub fn like(&self, value: f64) -> Self {
        Self::exact(value, self.mid.precision())
    }

    /// Returns how many words the digits of the midpoint fill.
    #[must_use]
    pub fn n_words(&self) -> usize {
        self.mid.repr().significand().as_sign_words().1.len()
    }

    /// Returns the precision that it is computed with.
    #[must_use]
    pub fn bits(&self) -> usize {
        self.mid.precision()
    }

    /// Returns the same number at another precision.
    #[must_use]
    pub fn at_precision(&self, bits: usize) -> Self {
        Self::from_rounded(self.mid.clone().with_precision(bits), self.radius)
    }

    /// Takes a midpoint as dashu-float reports it: an ulp is added to the radius when it was rounded.
    fn from_rounded(mid: Rounded<Mid>, radius: Mag) -> Self {
        let inexact = mid.error_ref().is_some();
        let mid = mid.value();
        let radius = if inexact { radius.plus(ulp(&mid)) } else { radius };
        Self { mid, radius }
    }

    /// Makes the ball of all numbers that `radius` allows about 0.
    fn about_zero(&self, radius: Mag) -> Self {
        Self { mid: self.like(0.0).mid, radius }
    }

    /// Returns the sign, if every number of the ball has it. `Equal` means exactly 0.
    #[must_use]
    pub fn sign(&self) -> Option<Ordering> {
        let (lower, _) = magnitude(&self.mid);
        if self.radius.is_zero() || self.radius.is_below(lower) {
            let zero = self.mid.repr().significand().is_zero();
            let negative = self.mid < Mid::ZERO;
            return Some(if zero {
                Ordering::Equal
            } else if negative {
                Ordering::Less
            } else {
                Ordering::Greater
            });
        }
        None
    }

    /// Tells whether this is exactly 0.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.sign() == Some(Ordering::Equal)
    }

    /// Returns the midpoint as binary64; infinite or 0 beyond its range.
    #[must_use]
    pub fn to_f64(&self) -> f64 {
        self.mid.to_f64().value()
    }

    /// Returns an upper bound of the radius.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius.to_f64_up()
    }

    /// Tells whether the radius is below 2^-`bits` of `largest`.
    #[must_use]
    pub fn is_sharp_beside(&self, largest: &Self, bits: i64) -> bool {
        self.radius.is_zero() || self.radius.shifted(bits).is_below(magnitude(&largest.mid).0)
    }

    /// Returns the square root, of 0 where the ball reaches below 0.
    #[must_use]
    pub fn sqrt(&self) -> Self {
        let (lower, upper) = magnitude(&self.mid);
        let positive = self.mid > Mid::ZERO;
        let context = self.mid.context();
        if positive && (self.radius.is_zero() || self.radius.is_below(lower)) {
            let root = context.sqrt(self.mid.repr()).expect("the square root of a positive number");
            // |√m − √x| = |m − x| / (√m + √x) ≤ r / √m, and √m is at least the rounded root less an ulp.
            let lower_root = magnitude(root.value_ref()).0.minus_down(ulp(root.value_ref()));
            let radius = self.radius.over(lower_root);
            return Self::from_rounded(root, radius);
        }
        if self.is_zero() {
            return self.clone();
        }
        let reach = if positive { upper.plus(self.radius) } else { self.radius };
        self.about_zero(reach.square_root())
    }

    /// Returns a ball of all that lies between the number and 0.
    #[must_use]
    pub fn or_zero(&self) -> Self {
        // From the middle m/2 the farthest are 0 and m ± r, which are |m|/2 + r away.
        let half = self * &self.like(0.5);
        Self { radius: half.radius.shifted(1).plus(magnitude(&half.mid).1), ..half }
    }

    /// Returns the square.
    #[must_use]
    pub fn square(&self) -> Self {
        self * self
    }

    /// Returns twice the number.
    #[must_use]
    pub fn double(&self) -> Self {
        self + self
    }

    /// Returns the number clamped to [0, 1].
    #[must_use]
    pub fn clamp01(&self) -> Self {
        // Clamping brings no two numbers further apart, nor any further apart than 1.
        let one = self.like(1.0);
        let clamped = if self.mid <= one.mid {
            self.max0()
        } else if (self - &one).sign() == Some(Ordering::Greater) {
            one
        } else {
            Self { radius: self.radius, ..one }
        };
        let unit = Mag::power_of_two(0);
        if clamped.radius.is_below(unit) { clamped } else { Self { radius: unit, ..clamped } }
    }

    /// Returns the greater of the number and 0.
    #[must_use]
    pub fn max0(&self) -> Self {
        if self.mid < Mid::ZERO {
            let zero = self.like(0.0);
            return if self.sign().is_some() { zero } else { Self { radius: self.radius, ..zero } };
        }
        self.clone()
    }
}

/// Returns a bound of one unit in the last place of a rounded number.
fn ulp(mid: &Mid) -> Mag {
    magnitude(mid).1.shifted(1 - mid.precision() as i64)
}

/// Returns a lower and an upper bound of |mid|, from its leading bits.
fn magnitude(mid: &Mid) -> (Mag, Mag) {
    let (_, words) = mid.repr().significand().as_sign_words();
    let Some(&top) = words.last() else { return (Mag::ZERO, Mag::ZERO) };
    let below_top = (words.len() - 1) * size_of_val(&top) * 8;
    let exponent = mid.repr().exponent() as i64 + below_top as i64;
    // With what lies below it the leading word counts for less than one more.
    let top = top as f64;
    let next = if words.len() == 1 { top } else { top + 1.0 };
    (Mag::new(top * Mag::DOWN, exponent), Mag::new(next * Mag::UP, exponent))
}

fn context_of(a: &Ball, b: &Ball) -> Context<HalfEven> {
    Context::max(a.mid.context(), b.mid.context())
}

impl Add for &Ball {
    type Output = Ball;

    fn add(self, other: &Ball) -> Ball {
        let sum = context_of(self, other).add(self.mid.repr(), other.mid.repr()).expect("finite terms");
        Ball::from_rounded(sum, self.radius.plus(other.radius))
    }
}

impl Sub for &Ball {
    type Output = Ball;

    fn sub(self, other: &Ball) -> Ball {
        let difference = context_of(self, other).sub(self.mid.repr(), other.mid.repr()).expect("finite terms");
        Ball::from_rounded(difference, self.radius.plus(other.radius))
    }
}

impl Mul for &Ball {
    type Output = Ball;

    fn mul(self, other: &Ball) -> Ball {
        let product = context_of(self, other).mul(self.mid.repr(), other.mid.repr()).expect("finite factors");
        // |ab − xy| ≤ |a| r_b + |b| r_a + r_a r_b
        let left = magnitude(&self.mid).1.times(other.radius);
        let right = magnitude(&other.mid).1.plus(other.radius).times(self.radius);
        Ball::from_rounded(product, left.plus(right))
    }
}

impl Div for &Ball {
    type Output = Ball;

    /// Divides; by a ball that may hold 0 the result may be any number.
    fn div(self, other: &Ball) -> Ball {
        let divisor = magnitude(&other.mid).0.minus_down(other.radius);
        if divisor.is_zero() {
            return self.about_zero(Mag::INFINITE);
        }
        let quotient = context_of(self, other).div(self.mid.repr(), other.mid.repr()).expect("a divisor above 0");
        // |a/b − x/y| = |(a − x) + (a/b)(y − b)| / |y| ≤ (r_a + |a/b| r_b) / (|b| − r_b), where the quotient stands for a/b
        // to within its ulp.
        let a_over_b = magnitude(quotient.value_ref()).1.plus(ulp(quotient.value_ref()));
        let radius = self.radius.plus(a_over_b.times(other.radius)).over(divisor);
        Ball::from_rounded(quotient, radius)
    }
}

impl Neg for &Ball {
    type Output = Ball;

    fn neg(self) -> Ball {
        if self.mid.repr().significand().is_zero() {
            return self.clone();
        }
        Ball { mid: -&self.mid, radius: self.radius }
    }
}
