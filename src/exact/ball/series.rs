//! π, the tangent, powers: what is summed as a series.
//!
//! Each sum is made of balls, which bound their own rounding; what is left out of the series is bounded here and added to
//! the radius.
//!
//! # Method
//! - π = 16 atan(1/5) − 4 atan(1/239) (Machin), with atan x = x − x³/3 + x⁵/5 − …. The terms alternate and fall, so the
//!   rest is below the first term left out.
//! - tan x by tan 2y = 2 tan y / (1 − tan² y), again and again from a small y = x/2^k, and tan y = sin y / cos y by their
//!   Taylor series, of which the terms alternate and fall; the rest is below the first term left out. For x below π/2 the
//!   last divisor is above 0.
//! - ln x = 2^k ln y with y = x^(1/2^k), by k square roots, near 1. With z = (y − 1)/(y + 1), ln y = 2 atanh z =
//!   2 (z + z³/3 + z⁵/5 + …). For z² ≤ ½ each term is at most half of the one before, so the rest is below twice the first
//!   term left out.
//! - e^x = (e^y)^(2^k) with y = x/2^k, |y| ≤ 1, by k squarings. e^y = 1 + y + y²/2 + …, where from the third term on each
//!   is at most half of the one before; again the rest is below twice the first left out.
//! - x^p is a product for whole p, one of a square root for halves, quarters and eighths of them, else e^(p ln x). Powers of
//!   numbers from 0 to 1 lie from 0 to 1, whatever is lost on the way.
//!
//! # Source
//! Brent and Zimmermann, "Modern Computer Arithmetic" (2010), section 4.3 and 4.4, for the reductions of the argument.

use std::cmp::Ordering;

use super::mag::Mag;
use super::{Ball, magnitude};

/// Below this argument `exp` is given as 0 with a radius: e^-2^20 < 2^[`TINY_EXP_BITS`].
const TINY_EXP_ARGUMENT: f64 = -1_048_576.0;

/// See [`TINY_EXP_ARGUMENT`]: 2^20 / ln 2 is above 1.5 million.
const TINY_EXP_BITS: i64 = -1_500_000;

/// Whole exponents up to here are made of multiplications. Beyond, the exponent of the result might not fit.
const MAX_WHOLE_EXPONENT: f64 = 1_048_576.0;

/// Exponents are whole, or made so by as many doublings, each of which costs a square root of the base.
const MAX_ROOTS: u32 = 4;

/// Bits beyond those asked for with which the tangent is computed; near 180 degrees the last divisor loses some 53.
const TANGENT_GUARD_BITS: usize = 128;

impl Ball {
    /// Returns the number to the power of `exponent`, for a number within [0, 1] and an exponent of at least 0; 0⁰ = 1.
    #[must_use]
    pub fn pow(&self, exponent: f64) -> Self {
        let base = self.clamp01();
        let mut whole = exponent;
        for n_roots in 0..=MAX_ROOTS {
            if whole > MAX_WHOLE_EXPONENT {
                break;
            }
            if whole.fract() == 0.0 {
                let root = (0..n_roots).fold(base, |root, _| root.sqrt());
                return root.pow_whole(whole as u64).clamp01();
            }
            whole *= 2.0;
        }
        match base.sign() {
            Some(Ordering::Greater) => (&base.ln() * &base.like(exponent)).exp().clamp01(),
            Some(_) => base.like(0.0),
            None => base.pow_near_zero(exponent),
        }
    }

    /// Bounds a power of a number that may be 0: x^p ≤ reach^(2^-k) where reach ≤ 1 and 2^-k ≤ p.
    fn pow_near_zero(&self, exponent: f64) -> Self {
        let reach = magnitude(&self.mid).1.plus(self.radius);
        if !reach.is_below(Mag::power_of_two(0)) {
            return self.about_zero(Mag::power_of_two(0));
        }
        let (mut bound, mut power) = (reach, 1.0);
        while power > exponent && bound.exponent_above() < 0 {
            bound = bound.square_root();
            power *= 0.5;
        }
        let is_small = power <= exponent && bound.is_below(Mag::power_of_two(0));
        self.about_zero(if is_small { bound } else { Mag::power_of_two(0) })
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

    /// Returns how far an argument is reduced, in bits: more for more precision, since it makes series shorter.
    fn reduction_bits(&self) -> u32 {
        8 + (self.mid.precision() / 128) as u32
    }

    /// Returns the natural logarithm of a number that is surely above 0.
    pub(super) fn ln(&self) -> Self {
        // |ln x| < 2^(log2 |log2 x|) as a magnitude; each root halves it.
        let size = magnitude(&self.mid).1.exponent_above().unsigned_abs() + 1;
        let n_roots = self.reduction_bits() + size.ilog2() + 1;
        let root = (0..n_roots).fold(self.clone(), |root, _| root.sqrt());
        let one = self.like(1.0);
        let z = &(&root - &one) / &(&root + &one);
        let square = &z * &z;
        if magnitude(&square.mid).1.plus(square.radius).exponent_above() > -1 && !square.is_zero() {
            return self.about_zero(Mag::INFINITE);
        }
        let mut power = z.clone();
        let atanh = z.sum_until_small(Mag::power_of_two(1), |n| {
            power = &power * &square;
            &power / &power.like(2.0 * f64::from(n) + 1.0)
        });
        &atanh * &self.like((1_u64 << (n_roots + 1)) as f64)
    }

    /// Returns e to the power of the number.
    pub(super) fn exp(&self) -> Self {
        let reach = magnitude(&self.mid).1.plus(self.radius);
        let approx = self.to_f64();
        if self.radius.is_infinite() || !self.radius.is_below(Mag::power_of_two(0)) || approx > -TINY_EXP_ARGUMENT {
            return self.about_zero(Mag::INFINITE);
        }
        // Within a radius of 1 this still holds: 2^20 / ln 2 is 1,512,775.
        if approx < TINY_EXP_ARGUMENT {
            return self.about_zero(Mag::power_of_two(TINY_EXP_BITS));
        }
        let n_squarings =
            self.reduction_bits() + if reach.is_zero() { 0 } else { reach.exponent_above().clamp(0, 32) as u32 };
        let y = self * &self.like(1.0 / (1_u64 << n_squarings) as f64);
        let mut term = self.like(1.0);
        let exp = self.like(1.0).sum_until_small(Mag::power_of_two(1), |n| {
            term = &(&term * &y) / &term.like(f64::from(n));
            term.clone()
        });
        (0..n_squarings).fold(exp, |power, _| &power * &power)
    }

    /// Adds `term(1)`, `term(2)`, … to `self` until one is too small to matter, and `share` of that to the radius, which is
    /// to bound all that is left out.
    fn sum_until_small(self, share: Mag, mut term: impl FnMut(u32) -> Self) -> Self {
        let bits = self.mid.precision() as i64;
        let mut sum = self;
        for n in 1.. {
            let next = term(n);
            let bound = magnitude(&next.mid).1.plus(next.radius);
            let reach = magnitude(&sum.mid).1.plus(sum.radius);
            if bound.is_zero() || bound.is_infinite() || bound.shifted(bits).is_below(reach) {
                return Self { radius: sum.radius.plus(bound.times(share)), ..sum };
            }
            sum = &sum + &next;
        }
        unreachable!("the terms of these series vanish")
    }

    /// Returns the tangent of half an angle given in degrees: tan(`degrees` · π / 360), for 0 < `degrees` < 180.
    #[must_use]
    pub fn tan_half_degrees(degrees: f64, bits: usize) -> Self {
        let root_of_3 = || Self::exact(3.0, bits).sqrt();
        if degrees == 60.0 {
            return &root_of_3() / &Self::exact(3.0, bits);
        } else if degrees == 90.0 {
            return Self::exact(1.0, bits);
        } else if degrees == 120.0 {
            return root_of_3();
        }
        let finer = bits + TANGENT_GUARD_BITS;
        let x = &(&Self::exact(degrees, finer) * &Self::pi(finer)) / &Self::exact(360.0, finer);
        x.tan().at_precision(bits)
    }

    /// Returns the tangent of a number from 0 to below π/2.
    fn tan(&self) -> Self {
        let n_doublings = self.reduction_bits();
        let [sin, cos] = (self * &self.like(1.0 / (1_u64 << n_doublings) as f64)).sin_cos();
        let one = self.like(1.0);
        (0..n_doublings).fold(&sin / &cos, |tan, _| &tan.double() / &(&one - &(&tan * &tan)))
    }

    /// Returns sine and cosine of a number from 0 to 1.
    fn sin_cos(&self) -> [Self; 2] {
        let minus_square = -&(self * self);
        [(self.clone(), 1.0), (self.like(1.0), 0.0)].map(|(first, degree)| {
            let mut term = first.clone();
            first.sum_until_small(Mag::power_of_two(0), |n| {
                let last = degree + 2.0 * f64::from(n);
                term = &(&term * &minus_square) / &term.like((last - 1.0) * last);
                term.clone()
            })
        })
    }

    /// Returns π.
    #[must_use]
    pub fn pi(bits: usize) -> Self {
        let atan_of_inverse = |n: f64| {
            let minus_square = Self::exact(-(n * n), bits);
            let mut power = &Self::exact(1.0, bits) / &Self::exact(n, bits);
            power.clone().sum_until_small(Mag::power_of_two(0), |k| {
                power = &power / &minus_square;
                &power / &power.like(2.0 * f64::from(k) + 1.0)
            })
        };
        let [a, b] = [(16.0, 5.0), (4.0, 239.0)].map(|(times, n)| &Self::exact(times, bits) * &atan_of_inverse(n));
        &a - &b
    }
}
