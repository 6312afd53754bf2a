//! Numbers of up to N limbs of 64 bits with a running bound on the error: for what double-double leaves open.
//!
//! A middle is ± 0.d₀d₁d₂… · 2^exponent with limbs for digits, of which the first begins with a 1. The exponent has 60 bits, so
//! that nothing overflows or underflows that a scene can hold. The bound is a [`Radius`] of 32 bits. Nothing is allocated.
//!
//! # Method
//! A result has as many limbs as are worth keeping: [`SPARE_BITS`] more than its bound leaves known, and no more than N.
//! So a number that has lost half of its digits costs a quarter of the time in products, and whoever begins with fewer bits
//! than N limbs hold computes with fewer ([`Long::shortened`]). What falls off is cut, not rounded, and a unit or a few of
//! the last place are added to the bound. A sum, difference or product of exact numbers is exact if it fits into N limbs.
//!
//! # Source
//! Johansson, "Arb: efficient arbitrary-precision midpoint-radius interval arithmetic", IEEE Transactions on Computers 66
//! (2017), for bounds of few bits and for digits that are dropped with accuracy; Knuth, "The Art of Computer Programming",
//! volume 2, section 4.3.1, for the operations on digits. The bounds are derived where they stand.

mod limbs;
mod radius;
mod real;
mod series;
#[cfg(test)]
mod tests;

#[cfg(test)]
pub(super) use tests::big_middle;

use std::ops::{Add, Div, Mul, Neg, Sub};

use self::radius::Radius;
use crate::math::Real;

/// Bits that a middle keeps beyond those that its bound leaves known.
const SPARE_BITS: i64 = 16;

/// Exponents beyond ±2⁶⁰ are given up: nothing is known of larger numbers, and smaller ones are 0 up to a bound.
const MAX_EXPONENT: i64 = 1 << 60;

/// A number of up to N limbs, with a bound on its distance from the exact number.
#[derive(Clone, Copy, Debug)]
pub struct Long<const N: usize> {
    /// Those beyond `len` mean nothing.
    limbs: [u64; N],
    /// 0 for a middle of 0.
    len: u32,
    is_negative: bool,
    /// The middle is below 2^exponent, and not below half of that unless it is 0.
    exponent: i64,
    radius: Radius,
}

impl<const N: usize> Long<N> {
    /// Makes a middle of 0 with a bound.
    fn about_zero(radius: Radius) -> Self {
        Self { limbs: [0; N], len: 0, is_negative: false, exponent: 0, radius }
    }

    /// Makes the number of which nothing is known.
    fn unknown() -> Self {
        Self::about_zero(Radius::INFINITE)
    }

    /// Makes the ball of all that lies between 0 and `top`.
    fn up_to(top: Radius) -> Self {
        if top.is_infinite() {
            return Self::unknown();
        }
        Self { radius: top.shifted(-1), ..Self::of_radius(top.shifted(-1)) }
    }

    /// Makes the number that a size is, exactly.
    fn of_radius(size: Radius) -> Self {
        if size.is_zero() {
            return Self::about_zero(size);
        }
        let (mantissa, exponent) = size.parts();
        let mut number = Self::power_of_two(exponent + 31);
        number.limbs[0] = mantissa << 32;
        number
    }

    /// Makes 2^`exponent`.
    fn power_of_two(exponent: i64) -> Self {
        let mut limbs = [0; N];
        limbs[0] = 1 << 63;
        Self { limbs, len: 1, is_negative: false, exponent: exponent + 1, radius: Radius::ZERO }
    }

    fn digits(&self) -> &[u64] {
        &self.limbs[..self.len as usize]
    }

    /// Tells whether the number is exactly 0.
    #[inline]
    fn is_zero(&self) -> bool {
        self.len == 0 && self.radius.is_zero()
    }

    /// Returns the middle, exactly.
    fn middle(&self) -> Self {
        Self { radius: Radius::ZERO, ..*self }
    }

    /// Returns a bound of the middle's magnitude from above.
    #[inline]
    fn upper(&self) -> Radius {
        if self.len == 0 {
            return Radius::ZERO;
        }
        Radius::new(self.limbs[0] >> 32 | 1 << 31, self.exponent - 32).plus(Radius::power_of_two(self.exponent - 32))
    }

    /// Returns a bound of the middle's magnitude from below.
    #[inline]
    fn lower(&self) -> Radius {
        if self.len == 0 { Radius::ZERO } else { Radius::new_down(self.limbs[0] >> 32, self.exponent - 32) }
    }

    /// Returns the bits of the middle that its bound leaves known.
    fn known_bits(&self) -> i64 {
        if self.radius.is_zero() { i64::MAX / 4 } else { self.exponent - self.radius.exponent_above() + 1 }
    }

    /// Returns how many limbs a middle below 2^`exponent` needs beside a bound.
    #[inline]
    fn n_limbs(exponent: i64, radius: Radius) -> usize {
        if radius.is_zero() {
            return N;
        }
        Self::n_limbs_of_bits(exponent - radius.exponent_above() + 1)
    }

    /// Returns how many limbs hold so many known bits.
    #[inline]
    fn n_limbs_of_bits(known_bits: i64) -> usize {
        ((known_bits.saturating_add(SPARE_BITS + 63)) >> 6).clamp(1, N as i64) as usize
    }

    /// Completes a number from a middle whose first bit is 1: widens the bound by `cut` units of the last of `n` places below
    /// 2^`place_exponent`, and drops zeros of an exact one.
    #[inline]
    fn finished(mut self, cut: u64, place_exponent: i64, n: usize) -> Self {
        if cut > 0 {
            self.radius = self.radius.plus(Radius::new(cut, place_exponent - 64 * n as i64));
        }
        if self.radius.is_zero() {
            while self.len > 0 && self.limbs[self.len as usize - 1] == 0 {
                self.len -= 1;
            }
        }
        if self.exponent.abs() < MAX_EXPONENT {
            return self;
        }
        if self.exponent > 0 {
            return Self::unknown();
        }
        Self::about_zero(self.radius.plus(Radius::power_of_two(-MAX_EXPONENT)))
    }

    /// Returns the number with `bits` known bits at most, and the time that its limbs cost.
    #[must_use]
    pub fn shortened(self, bits: u32) -> Self {
        let n = Self::n_limbs_of_bits(i64::from(bits));
        let radius = self.radius.plus(Radius::power_of_two(self.exponent - i64::from(bits)));
        if self.len as usize <= n {
            return Self { radius, ..self };
        }
        Self { len: n as u32, radius, ..self }.finished(1, self.exponent, n)
    }

    /// Returns the first limbs of the middle.
    fn truncated(self, n: usize) -> Self {
        Self { len: self.len.min(n as u32), ..self }
    }

    /// Adds `other`, or takes it away, into `n` limbs at most.
    #[inline]
    fn sum(&self, other: &Self, is_difference: bool, n: usize) -> Self {
        let radius = self.radius.plus(other.radius);
        let other_is_negative = other.is_negative != is_difference;
        if other.len == 0 {
            return Self { radius, ..*self };
        }
        if self.len == 0 {
            return Self { radius, is_negative: other_is_negative, ..*other };
        }
        let (large, small, is_negative) = if self.exponent >= other.exponent {
            (self, other, self.is_negative)
        } else {
            (other, self, other_is_negative)
        };
        let (exponent, shift) = (large.exponent, large.exponent - small.exponent);
        let n = Self::n_limbs(exponent, radius).min(n);
        let n_kept = n.min(large.len as usize);
        let mut sum = Self { limbs: [0; N], len: n as u32, is_negative, exponent, radius };
        let digits = &mut sum.limbs[..n];
        digits[..n_kept].copy_from_slice(&large.limbs[..n_kept]);
        let mut cut = u64::from(n_kept < large.len as usize);
        let (limbs, bits) = ((shift >> 6).min(N as i64) as usize, (shift & 63) as u32);
        cut += u64::from(limbs::is_cut(small.digits(), limbs, bits, n));
        if self.is_negative == other_is_negative {
            if limbs < n && limbs::add(digits, small.digits(), limbs, bits) {
                sum.exponent += 1;
                cut += u64::from(limbs::carry_in(digits));
            }
            return sum.finished(cut, exponent, n);
        }
        if limbs < n && limbs::subtract(digits, small.digits(), limbs, bits) {
            limbs::complement(digits);
            sum.is_negative = !is_negative;
        }
        match limbs::normalize(digits) {
            Some(n_bits) => {
                sum.exponent -= i64::from(n_bits);
                sum.len -= n_bits / 64;
            }
            None => sum.len = 0,
        }
        sum.finished(cut, exponent, n)
    }

    /// Divides, into `n` limbs at most; by a number that may be 0 the result may be any.
    ///
    /// For every a, b in the balls and the quotient q of the middles, |a/b − q| = |a − q·b| / |b| ≤ (error of a + |q|·error of b) /
    /// |b|. The quotient that is computed is below q by less than a unit of its last place, and above by no more if the divisor
    /// is cut to a limb more than it has.
    fn quotient(&self, other: &Self, n: usize) -> Self {
        let divisor = other.lower().minus_down(other.radius);
        if divisor.is_zero() {
            return Self::unknown();
        }
        if self.len == 0 {
            return Self::about_zero(self.radius.over(divisor));
        }
        let n = Self::n_limbs_of_bits(self.known_bits().min(other.known_bits())).min(n);
        let n_divisor = (other.len as usize).min(n + 1);
        let is_cut = n_divisor < other.len as usize;
        let exponent = self.exponent - other.exponent + 1;
        let mut quotient = Self { limbs: [0; N], len: n as u32, exponent, ..Self::about_zero(Radius::ZERO) };
        let (digits, mut rest) = (&mut quotient.limbs[..n], [0; N]);
        let is_exact =
            limbs::divide_half(self.digits(), &other.limbs[..n_divisor], digits, &mut rest[..n_divisor]) && !is_cut;
        quotient.exponent -= i64::from(limbs::normalize(digits).expect("the quotient is at least a quarter"));
        quotient.is_negative = self.is_negative != other.is_negative;
        let cut = if is_exact { 0 } else { 2 };
        let quotient = quotient.finished(cut, exponent, n);
        let inherited = self.radius.plus(quotient.upper().plus(quotient.radius).times(other.radius)).over(divisor);
        Self { radius: quotient.radius.plus(inherited), ..quotient }
    }

    /// Returns the square root of a number above 0, beyond its bound.
    ///
    /// Newton's method doubles the known digits of s in each step: s + (x − s²)/2s. What it leaves is seen at the end, and not
    /// predicted. For every x ≥ 0 in the ball |√x − s| = |x − s²| / (√x + s), and the divisor is at least s, and at least
    /// 1.859·s when the bound is below a quarter of the middle.
    fn root_of_positive(&self) -> Self {
        let wanted = self.known_bits().saturating_add(SPARE_BITS / 2).min(64 * N as i64 - 4);
        let is_odd = self.exponent & 1;
        let leading = self.limbs[0] as f64 * libm::exp2((is_odd - 64) as f64);
        let mut root = Self::exact(leading.sqrt());
        root.exponent += (self.exponent + is_odd) / 2 - is_odd;
        let mut known = 50;
        let mut rest = self.minus_square(&root, 2);
        while known < wanted {
            let n_half = Self::n_limbs_of_bits(known);
            let twice_root = Self { exponent: root.exponent + 1, ..root.truncated(n_half) };
            let step = rest.middle().truncated(n_half).quotient(&twice_root, n_half).middle();
            known *= 2;
            let n = Self::n_limbs_of_bits(known.min(wanted));
            root = root.sum(&step, false, n).middle();
            rest = self.minus_square(&root, 2 * n);
        }
        let off = rest.upper().plus(rest.radius);
        let is_narrow = self.radius.shifted(2).is_below(self.lower());
        Self { radius: off.over(if is_narrow { root.lower().by_1_859_down() } else { root.lower() }), ..root }
    }

    /// Returns the difference from the square of an exact number, which has up to `n` limbs.
    fn minus_square(&self, root: &Self, n: usize) -> Self {
        self.sum(&root.product(root, n), true, N)
    }

    /// Multiplies, into `n` limbs at most.
    #[inline]
    fn product(&self, other: &Self, n: usize) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self::about_zero(Radius::ZERO);
        }
        let radius = self.inherited(other);
        if self.len == 0 || other.len == 0 {
            return Self::about_zero(radius);
        }
        let exponent = self.exponent + other.exponent;
        let n = Self::n_limbs(exponent, radius).min(n);
        let is_negative = self.is_negative != other.is_negative;
        let mut product = Self { limbs: [0; N], len: n as u32, is_negative, exponent, radius };
        let digits = &mut product.limbs[..n];
        let cut = if limbs::multiply(self.digits(), other.digits(), digits) { 2 * n as u64 + 1 } else { 0 };
        if digits[0] >> 63 == 0 {
            limbs::shift_up(digits);
            product.exponent -= 1;
        }
        product.finished(cut, exponent, n)
    }

    /// Returns what the bounds of two factors make of the product's: |xy − mn| ≤ |m|·f + (|n| + f)·e.
    #[inline]
    fn inherited(&self, other: &Self) -> Radius {
        let left = if other.radius.is_zero() { Radius::ZERO } else { self.upper().times(other.radius) };
        if self.radius.is_zero() {
            return left;
        }
        left.plus(other.upper().plus(other.radius).times(self.radius))
    }

    /// Raises to a whole power by repeated squaring; `exponent` is at least 1.
    fn pow_whole(self, exponent: u32) -> Self {
        let mut power = self;
        for bit in (0..u32::BITS - 1 - exponent.leading_zeros()).rev() {
            power = power * power;
            if exponent >> bit & 1 == 1 {
                power = power * self;
            }
        }
        power
    }

    /// Returns the least and the greatest number of the ball, each with a bound of its own.
    fn ends(&self) -> [Self; 2] {
        let radius = Self::of_radius(self.radius);
        [true, false].map(|is_difference| self.middle().sum(&radius, is_difference, N))
    }
}

impl<const N: usize> Add for Long<N> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.sum(&other, false, N)
    }
}

impl<const N: usize> Sub for Long<N> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.sum(&other, true, N)
    }
}

impl<const N: usize> Neg for Long<N> {
    type Output = Self;

    fn neg(self) -> Self {
        Self { is_negative: !self.is_negative, ..self }
    }
}

impl<const N: usize> Mul for Long<N> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        self.product(&other, N)
    }
}

impl<const N: usize> Div for Long<N> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        self.quotient(&other, N)
    }
}
