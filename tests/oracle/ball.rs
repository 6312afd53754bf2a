//! Ball arithmetic: real numbers as a midpoint of chosen precision and a proved bound of its distance to the truth.
//!
//! Every operation takes balls that hold the true operands and returns one that holds the true result. A sign is given
//! only where the whole ball agrees, so a comparison is either proved or openly undecided; there is no epsilon. Exact
//! operations on exact operands keep radius 0, which lets ties of binary64 numbers be proved as well.
//!
//! Never here: anything of `clisc`. The midpoints are dashu-float's, whose reports of what was rounded we use; `exp` and
//! `ln` are its as well (they claim one unit in the last place, we allow for [`SERIES_SLACK_ULP`]); `tan` and π are ours.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use dashu_float::round::Rounded;
use dashu_float::round::mode::HalfEven;
use dashu_float::{Context, FBig};

/// A number of a chosen precision; the nearest to the true result of one operation.
type Mid = FBig<HalfEven, 2>;

/// What we allow for the error of dashu-float's `exp` and `ln`, in units in the last place.
const SERIES_SLACK_ULP: f64 = 16.0;

/// Below this argument `exp` is given as 0 with a radius: e^-2^20 < 2^[`TINY_EXP_BITS`].
const TINY_EXP_ARGUMENT: f64 = -1_048_576.0;
/// See [`TINY_EXP_ARGUMENT`]: 2^20 / ln 2 is above 1.5 million.
const TINY_EXP_BITS: i64 = -1_500_000;

/// An upper bound of a magnitude, `mantissa` · 2^`exponent`, with the mantissa 0, in [1, 2) or infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mag {
    mantissa: f64,
    exponent: i64,
}

impl Mag {
    const ZERO: Self = Self { mantissa: 0.0, exponent: 0 };
    const INFINITE: Self = Self { mantissa: f64::INFINITY, exponent: 0 };
    /// Covers the rounding of the few binary64 operations that make a bound.
    const UP: f64 = 1.0 + 16.0 * f64::EPSILON;
    /// The same for a lower bound.
    const DOWN: f64 = 1.0 - 16.0 * f64::EPSILON;

    /// Brings the mantissa into [1, 2), which is exact.
    fn new(mantissa: f64, exponent: i64) -> Self {
        if mantissa == 0.0 || mantissa.is_infinite() {
            return Self { mantissa, exponent: 0 };
        }
        assert!(mantissa > 0.0 && mantissa.is_normal(), "{mantissa:e} is no mantissa");
        let shift = (mantissa.to_bits() >> 52) as i64 - 1023;
        let mantissa = f64::from_bits(mantissa.to_bits() & !(0x7ff << 52) | 0x3ff << 52);
        Self { mantissa, exponent: exponent + shift }
    }

    fn power_of_two(exponent: i64) -> Self {
        Self { mantissa: 1.0, exponent }
    }

    fn is_zero(self) -> bool {
        self.mantissa == 0.0
    }

    fn is_infinite(self) -> bool {
        self.mantissa.is_infinite()
    }

    fn shifted(self, by: i64) -> Self {
        if self.is_zero() { self } else { Self { exponent: self.exponent + by, ..self } }
    }

    /// Returns `self` in units of 2^`exponent`, rounded up; 0 only for 0.
    fn in_units_of(self, exponent: i64) -> f64 {
        let shift = (self.exponent - exponent).clamp(-1000, 1000);
        self.mantissa * f64::from_bits(((1023 + shift) as u64) << 52)
    }

    fn plus(self, other: Self) -> Self {
        match (self.is_zero(), other.is_zero()) {
            (true, _) => other,
            (_, true) => self,
            _ => {
                let exponent = self.exponent.max(other.exponent);
                Self::new((self.in_units_of(exponent) + other.in_units_of(exponent)) * Self::UP, exponent)
            }
        }
    }

    fn times(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self::ZERO;
        }
        Self::new(self.mantissa * other.mantissa * Self::UP, self.exponent + other.exponent)
    }

    /// Divides by a lower bound of the divisor.
    fn over(self, lower: Self) -> Self {
        if self.is_zero() {
            return self;
        }
        if lower.is_zero() {
            return Self::INFINITE;
        }
        Self::new(self.mantissa / lower.mantissa * Self::UP, self.exponent - lower.exponent)
    }

    fn square_root(self) -> Self {
        let odd = self.exponent.rem_euclid(2);
        let mantissa = if odd == 1 { 2.0 * self.mantissa } else { self.mantissa };
        Self::new(mantissa.sqrt() * Self::UP, (self.exponent - odd) / 2)
    }

    /// Returns a lower bound of `self` − `other` where `self` is itself a lower bound; 0 when it may be below.
    fn minus_down(self, other: Self) -> Self {
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
    fn is_below(self, lower: Self) -> bool {
        !lower.minus_down(self).is_zero()
    }
}

/// A real number within `radius` of `mid`.
#[derive(Clone, Debug)]
pub struct Ball {
    mid: Mid,
    radius: Mag,
}

impl Ball {
    /// Makes the ball of radius 0 about a finite binary64 value, to be computed with at `bits` of precision.
    pub fn exact(value: f64, bits: usize) -> Self {
        // Adding 0 turns −0 into 0.
        let mid = Mid::try_from(value + 0.0).expect("a finite number").with_precision(bits);
        Self::from_rounded(mid, Mag::ZERO)
    }

    /// Returns an exact value at the precision of `self`.
    pub fn like(&self, value: f64) -> Self {
        Self::exact(value, self.mid.precision())
    }

    /// Takes a midpoint as dashu-float reports it: half an ulp is added to the radius when it was rounded.
    fn from_rounded(mid: Rounded<Mid>, radius: Mag) -> Self {
        let inexact = mid.error_ref().is_some();
        let mid = mid.value();
        let radius = if inexact { radius.plus(ulp(&mid)) } else { radius };
        Self { mid, radius }
    }

    /// Returns the sign, if every number of the ball has it. `Equal` means exactly 0.
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
    pub fn is_zero(&self) -> bool {
        self.sign() == Some(Ordering::Equal)
    }

    /// Returns the midpoint as binary64; infinite or 0 beyond its range.
    pub fn to_f64(&self) -> f64 {
        self.mid.to_f64().value()
    }

    /// Tells whether the radius is below 2^-`bits` of `largest`.
    pub fn is_sharp_beside(&self, largest: &Self, bits: i64) -> bool {
        self.radius.is_zero() || self.radius.shifted(bits).is_below(magnitude(&largest.mid).0)
    }

    /// Returns the square root, of 0 where the ball reaches below 0.
    pub fn sqrt(&self) -> Self {
        let (lower, upper) = magnitude(&self.mid);
        let positive = self.mid > Mid::ZERO;
        let context = self.mid.context();
        let root = |x: &Mid| context.sqrt(x.repr()).expect("the square root of a positive number");
        if positive && (self.radius.is_zero() || self.radius.is_below(lower)) {
            // |√m − √x| = |m − x| / (√m + √x) ≤ r / √m
            let root = root(&self.mid);
            let radius = self.radius.over(magnitude(root.value_ref()).0);
            return Self::from_rounded(root, radius);
        }
        if self.is_zero() {
            return self.clone();
        }
        let reach = if positive { upper.plus(self.radius) } else { self.radius };
        Self { mid: self.like(0.0).mid, radius: reach.square_root() }
    }

    /// Returns twice the number.
    pub fn double(&self) -> Self {
        self + self
    }

    /// Returns the number clamped to [0, 1].
    pub fn clamp01(&self) -> Self {
        // Clamping brings no two numbers further apart.
        let one = self.like(1.0);
        if self.mid <= one.mid {
            return self.max0();
        }
        let surely_above = (self - &one).sign() == Some(Ordering::Greater);
        if surely_above { one } else { Self { radius: self.radius, ..one } }
    }

    /// Returns the greater of the number and 0.
    pub fn max0(&self) -> Self {
        if self.mid < Mid::ZERO {
            let zero = self.like(0.0);
            return if self.sign().is_some() { zero } else { Self { radius: self.radius, ..zero } };
        }
        self.clone()
    }

    /// Returns the number to the power of `exponent`, for a number and an exponent of at least 0; 0⁰ = 1.
    pub fn pow(&self, exponent: f64) -> Self {
        /// Whole exponents up to here are made of multiplications.
        const MAX_WHOLE: f64 = 9_007_199_254_740_992.0;
        /// Halves, quarters, … of exponents are made of this many square roots at most.
        const MAX_ROOTS: u32 = 4;
        let mut whole = exponent;
        for n_roots in 0..=MAX_ROOTS {
            if whole.fract() == 0.0 && whole <= MAX_WHOLE {
                let root = (0..n_roots).fold(self.clone(), |root, _| root.sqrt());
                return root.pow_whole(whole as u64);
            }
            whole *= 2.0;
        }
        match self.sign() {
            Some(Ordering::Greater) => (&self.ln() * &self.like(exponent)).exp(),
            Some(_) => self.like(0.0),
            // Only a number near 0 has no sign, and it is at most its reach; the exponent is above 0.
            None => {
                let one = Mag::power_of_two(0);
                let reach = magnitude(&self.mid).1.plus(self.radius);
                let radius = if reach.is_below(one) { one } else { Mag::INFINITE };
                Self { mid: self.like(0.0).mid, radius }
            }
        }
    }

    fn pow_whole(&self, mut exponent: u64) -> Self {
        let mut square = self.clone();
        let mut power = self.like(1.0);
        while exponent > 0 {
            if exponent & 1 == 1 {
                power = &power * &square;
            }
            exponent >>= 1;
            if exponent > 0 {
                square = &square * &square;
            }
        }
        power
    }

    /// Returns the natural logarithm of a number that is surely above 0.
    fn ln(&self) -> Self {
        let ln = self.mid.context().ln(self.mid.repr(), None).expect("the logarithm of a positive number");
        // |ln m − ln x| ≤ r / (m − r)
        let radius = self.radius.over(magnitude(&self.mid).0.minus_down(self.radius));
        Self::from_series(ln, radius)
    }

    /// Returns e to the power of the number.
    fn exp(&self) -> Self {
        let approx = self.to_f64();
        if self.radius.is_infinite() || !self.radius.is_below(Mag::power_of_two(0)) {
            return Self { mid: self.like(0.0).mid, radius: Mag::INFINITE };
        }
        if approx < TINY_EXP_ARGUMENT {
            return Self { mid: self.like(0.0).mid, radius: Mag::power_of_two(TINY_EXP_BITS) };
        }
        let exp = self.mid.context().exp(self.mid.repr(), None).expect("a power of e in range");
        // |e^m − e^x| ≤ e^m (e^r − 1) ≤ e^m · 2r for r ≤ 1
        let radius = magnitude(exp.value_ref()).1.times(self.radius).shifted(1);
        Self::from_series(exp, radius)
    }

    /// Takes the value of a function that dashu-float computes by a series.
    fn from_series(mid: Rounded<Mid>, radius: Mag) -> Self {
        let slack = if mid.error_ref().is_some() { ulp(mid.value_ref()) } else { Mag::ZERO };
        Self::from_rounded(mid, radius.plus(slack.times(Mag::new(SERIES_SLACK_ULP, 0))))
    }

    /// Returns the tangent of half an angle given in degrees: tan(`angle` · π / 360), for 0 < `angle` < 180.
    pub fn tan_half_degrees(angle: f64, bits: usize) -> Self {
        if angle == 90.0 {
            return Self::exact(1.0, bits);
        }
        let x = &(&Self::exact(angle, bits) * &Self::pi(bits)) / &Self::exact(360.0, bits);
        let [sin, cos] = x.sin_cos();
        &sin / &cos
    }

    /// Returns sine and cosine of a number from 0 to π/2.
    fn sin_cos(&self) -> [Self; 2] {
        let minus_square = -&(self * self);
        [(self.clone(), 1.0), (self.like(1.0), 0.0)].map(|(first, degree)| first.sum_taylor(degree, &minus_square))
    }

    /// Sums x^n / n! with alternating signs, n = `degree`, `degree` + 2, …; `self` is the first term.
    fn sum_taylor(self, mut degree: f64, minus_square: &Self) -> Self {
        let bits = self.mid.precision() as i64;
        let mut term = self.clone();
        let mut sum = self;
        loop {
            term = &(&term * minus_square) / &term.like((degree + 1.0) * (degree + 2.0));
            degree += 2.0;
            let bound = magnitude(&term.mid).1.plus(term.radius);
            if bound.is_zero() || bound.shifted(bits).is_below(magnitude(&sum.mid).0) {
                // The terms fall from the second on, so the sum is off by less than the first term left out.
                return Self { radius: sum.radius.plus(bound), ..sum };
            }
            sum = &sum + &term;
        }
    }

    /// Returns π by Machin's formula, 16 atan(1/5) − 4 atan(1/239).
    pub fn pi(bits: usize) -> Self {
        let atan_of_inverse = |n: f64| {
            let n_squared = Self::exact(n * n, bits);
            let mut power = &Self::exact(1.0, bits) / &Self::exact(n, bits);
            let mut sum = power.clone();
            for k in 1.. {
                power = &power / &n_squared;
                let term = &power / &Self::exact(2.0 * f64::from(k) + 1.0, bits);
                let bound = magnitude(&term.mid).1.plus(term.radius);
                if bound.exponent < -(bits as i64) {
                    sum.radius = sum.radius.plus(bound);
                    break;
                }
                sum = if k % 2 == 1 { &sum - &term } else { &sum + &term };
            }
            sum
        };
        let [a, b] = [(16.0, 5.0), (4.0, 239.0)].map(|(times, n)| &Self::exact(times, bits) * &atan_of_inverse(n));
        &a - &b
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
            return Ball { mid: self.like(0.0).mid, radius: Mag::INFINITE };
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Tells whether the balls of one number, computed with few and with many bits, agree.
    fn agree(few: &Ball, many: &Ball) -> bool {
        let gap = magnitude(&(few - many).mid).1;
        !few.radius.plus(many.radius).is_below(gap.times(Mag::new(Mag::DOWN, -2)))
    }

    /// Some formula with every operation.
    fn tangle(x: f64, y: f64, bits: usize) -> Ball {
        let [x, y] = [x, y].map(|number| Ball::exact(number, bits));
        let third = &x / &Ball::exact(3.0, bits);
        let root = (&(&third * &third) + &(&y * &y)).sqrt();
        let ratio = &(&root - &third) / &(&root + &y);
        &ratio.pow(2.7) + &(&ratio.pow(1.25) - &ratio.pow(11.0).clamp01())
    }

    #[test]
    fn balls_of_all_precisions_meet() {
        for i in 1..200 {
            let [x, y] = [f64::from(i) * 0.37, 1.0 / f64::from(i)];
            let [few, many] = [60, 400].map(|bits| tangle(x, y, bits));
            assert!(agree(&few, &many), "{few:?} {many:?}");
            assert!(many.radius.is_below(Mag::power_of_two(-300)), "{many:?}");
        }
    }

    #[test]
    fn a_radius_is_no_wider_than_it_must() {
        let third = &Ball::exact(1.0, 256) / &Ball::exact(3.0, 256);
        let nothing = &(&third * &Ball::exact(3.0, 256)) - &Ball::exact(1.0, 256);
        assert_eq!(nothing.sign(), None);
        assert!(nothing.radius.is_below(Mag::power_of_two(-252)));
        let little = &nothing + &Ball::exact(f64::from_bits((1023 - 250) << 52), 256);
        assert_eq!(little.sign(), Some(Ordering::Greater));
    }

    #[test]
    fn exact_operations_stay_exact() {
        let [three, four, five] = [3.0, 4.0, 5.0].map(|number| Ball::exact(number * 1e10, 256));
        let difference = &(&(&three * &three) + &(&four * &four)) - &(&five * &five);
        assert!(difference.is_zero());
        assert!((&(&four * &four).sqrt() - &four).is_zero());
        assert!((&Ball::exact(0.0, 256) * &(&three / &Ball::exact(7.0, 256))).is_zero());
    }

    #[test]
    fn pi_and_the_tangent_are_those_of_dashu() {
        let bits = 300;
        let context = Context::<HalfEven>::new(bits);
        let theirs = Ball { mid: context.pi(None).value(), radius: Mag::power_of_two(3 - bits as i64) };
        assert!(agree(&Ball::pi(bits), &theirs));
        for angle in [1e-300, 0.0002, 1.0, 45.0, 60.0, 75.5, 120.0, 175.0, 179.999_999] {
            let ours = Ball::tan_half_degrees(angle, bits);
            let half = &(&Ball::exact(angle, 400) * &Ball::pi(400)) / &Ball::exact(360.0, 400);
            let tan = Context::<HalfEven>::new(400).tan(half.mid.repr(), None).expect("a tangent").value();
            let radius = magnitude(&tan).1.shifted(-350);
            assert!(agree(&ours, &Ball { mid: tan, radius }), "{angle}");
            assert!(ours.is_sharp_beside(&ours, 250), "{angle}");
        }
    }

    #[test]
    fn a_power_is_the_same_by_roots_by_products_and_by_logarithms() {
        for base in [0.999, 0.5, 1e-3, 0.123_456_789] {
            let base = Ball::exact(base, 256);
            for exponent in [1.0, 2.5, 20.0, 33.75] {
                let by_logarithm = (&base.ln() * &base.like(exponent)).exp();
                assert!(agree(&base.pow(exponent), &by_logarithm));
            }
        }
        assert!((&Ball::exact(0.0, 256).pow(0.0) - &Ball::exact(1.0, 256)).is_zero());
        assert!(Ball::exact(0.0, 256).pow(0.3).is_zero());
        assert!((&Ball::exact(1.0, 256).pow(1e300) - &Ball::exact(1.0, 256)).is_zero());
    }
}
