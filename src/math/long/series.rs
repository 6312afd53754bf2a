//! π, the tangent and powers of long numbers: sums of series.
//!
//! Every term is a ball and bounds its own rounding. What is left out of a series is bounded by the last term and added.
//!
//! # Method
//! In each of these series what follows a term is less than the term itself:
//! - π = 16 atan(1/5) − 4 atan(1/239) (Machin). The terms of atan x = x − x³/3 + … alternate and fall.
//! - tan x = sin x / cos x for x up to π/4, by their Taylor series at x/2^10, whose terms do the same, and by
//!   tan 2y = 2 tan y / (1 − tan² y). Above 90 degrees the tangent of the half is 1 by that of the half of the complement, which is
//!   known exactly.
//! - ln x = 2^k ln y, where k square roots lead from x to y near 1, and ln y = 2 (z + z³/3 + z⁵/5 + …) with
//!   z = (y − 1)/(y + 1), which is so small that each term is less than a quarter of the one before.
//! - e^x = (e^y)^(2^k) with y = x/2^k below 1/1024, and e^y = 1 + y + y²/2 + …, where each term is less than half of the one
//!   before.
//!
//! # Source
//! Brent and Zimmermann, "Modern Computer Arithmetic" (2010), sections 4.3 and 4.4.

use super::radius::Radius;
use super::{Long, SPARE_BITS};
use crate::math::{Real, Sign};

/// Halvings of an argument before a Taylor series is summed.
const N_HALVINGS: i64 = 10;

/// The largest exponent of a number that is exponentiated: e^−x is below 2^−x.
const MAX_EXP_EXPONENT: i64 = 40;

impl<const N: usize> Long<N> {
    /// Returns the number, which is above 0 beyond its bound, to a power; computed with some more than `known_bits`.
    pub(super) fn to_the(self, exponent: f64, known_bits: i64) -> Self {
        let bits = (known_bits.min(64 * N as i64) + 2 * SPARE_BITS).max(96);
        (self.shortened(bits as u32).ln() * Self::exact(exponent)).exp()
    }

    /// Returns the natural logarithm of a number above 0, beyond its bound.
    fn ln(self) -> Self {
        let n_roots = N_HALVINGS + i64::from(64 - self.exponent.unsigned_abs().leading_zeros());
        let root = (0..n_roots).fold(self, |root, _| root.sqrt());
        let one = Self::power_of_two(0);
        let z = (root - one) / (root + one);
        let (square, mut power) = (z.square(), z);
        let sum = z.plus_series(|n| {
            power = power * square;
            power / Self::exact(f64::from(2 * n + 1))
        });
        sum.shifted(n_roots + 1)
    }

    /// Returns e to the power of a number.
    fn exp(self) -> Self {
        let reach = self.upper().plus(self.radius);
        if !reach.is_below(Radius::power_of_two(MAX_EXP_EXPONENT)) {
            let is_small = self.sign() == Sign::Negative && self.exponent > MAX_EXP_EXPONENT;
            // The middle is below −2^40, and its bound is less than half of that, or nothing is known.
            let is_small = is_small && self.radius.shifted(1).is_below(self.lower());
            let top = Radius::power_of_two(-(1 << (MAX_EXP_EXPONENT - 1)));
            return if is_small { Self::up_to(top) } else { Self::unknown() };
        }
        let n_halvings = N_HALVINGS + if reach.is_zero() { 0 } else { reach.exponent_above().max(0) };
        let y = self.shifted(-n_halvings);
        let mut term = Self::power_of_two(0);
        let exp = term.plus_series(|n| {
            term = term * y / Self::exact(f64::from(n));
            term
        });
        (0..n_halvings).fold(exp, |power, _| power.square())
    }

    /// Returns tan(`degrees`·π/360), for 0 < `degrees` < 180.
    pub(super) fn tangent_of_half(degrees: f64) -> Self {
        let one = Self::power_of_two(0);
        if degrees == 90.0 {
            return one;
        }
        if degrees > 90.0 {
            let complement = Self::exact(180.0) - Self::exact(degrees);
            return one / Self::tangent(Self::half_in_radians(complement));
        }
        if degrees == 60.0 {
            return one / Self::exact(3.0).sqrt();
        }
        Self::tangent(Self::half_in_radians(Self::exact(degrees)))
    }

    fn half_in_radians(degrees: Self) -> Self {
        degrees * Self::pi() / Self::exact(360.0)
    }

    /// Returns the tangent of an angle in 0…π/4.
    fn tangent(angle: Self) -> Self {
        let small = angle.shifted(-N_HALVINGS);
        let minus_square = -small.square();
        // x − x³/3! + … and 1 − x²/2! + …: each term is the one before times −x² by the next two whole numbers.
        let [sin, cos] = [(small, 1), (Self::power_of_two(0), 0)].map(|(first, degree)| {
            let mut term = first;
            first.plus_series(|n| {
                let last = f64::from(degree + 2 * n);
                term = term * minus_square / Self::exact(last * (last - 1.0));
                term
            })
        });
        let one = Self::power_of_two(0);
        (0..N_HALVINGS).fold(sin / cos, |tan, _| tan.shifted(1) / (one - tan.square()))
    }

    fn pi() -> Self {
        let atan_of_inverse = |n: f64| {
            let minus_square = Self::exact(-n * n);
            let mut power = Self::power_of_two(0) / Self::exact(n);
            power.plus_series(|k| {
                power = power / minus_square;
                power / Self::exact(f64::from(2 * k + 1))
            })
        };
        Self::exact(16.0) * atan_of_inverse(5.0) - Self::exact(4.0) * atan_of_inverse(239.0)
    }

    /// Multiplies by 2^`by`.
    fn shifted(self, by: i64) -> Self {
        Self { exponent: self.exponent + by, radius: self.radius.shifted(by), ..self }
    }

    /// Adds `term(1)`, `term(2)`, … until one is too small to matter, and widens the bound by that, which is to bound what is
    /// left out.
    fn plus_series(self, mut term: impl FnMut(u32) -> Self) -> Self {
        let mut sum = self;
        let mut n = 0;
        loop {
            n += 1;
            let next = term(n);
            let size = next.upper().plus(next.radius);
            sum = sum + next;
            let least = Radius::power_of_two(sum.exponent - 64 * N as i64);
            if size.is_infinite()
                || size.is_zero()
                || size.is_below(least)
                || size.shifted(SPARE_BITS).is_below(sum.radius)
            {
                return Self { radius: sum.radius.plus(size), ..sum };
            }
        }
    }
}
