//! Lanes of plain numbers: the specification of the other backends.

pub(super) mod single;

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use crate::trace::kernels::{Mask, Numbers};

/// Eight numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lanes8([f64; 8]);

/// Eight truths, a bit each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mask8(u8);

impl Lanes8 {
    #[inline(always)]
    fn map(mut self, f: impl Fn(f64) -> f64) -> Self {
        for lane in &mut self.0 {
            *lane = f(*lane);
        }
        self
    }

    #[inline(always)]
    fn zip(mut self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        for (lane, other) in self.0.iter_mut().zip(other.0) {
            *lane = f(*lane, other);
        }
        self
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(f64, f64) -> bool) -> Mask8 {
        let mut bits = 0;
        for i in 0..8 {
            bits |= u8::from(f(self.0[i], other.0[i])) << i;
        }
        Mask8(bits)
    }
}

impl Add for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Div for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
}

impl Neg for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl Numbers for Lanes8 {
    const N: usize = 8;

    type Mask = Mask8;

    type Element = f64;

    #[inline(always)]
    fn splat(number: f64) -> Self {
        Self([number; 8])
    }

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        Self(std::array::from_fn(|i| from[..8][i]))
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[..8].copy_from_slice(&self.0);
    }

    #[inline(always)]
    fn store_packed(self, mask: Mask8, to: &mut [f64]) {
        let to = &mut to[..8];
        let mut n = 0;
        for (i, lane) in self.0.into_iter().enumerate() {
            if mask.0 >> i & 1 != 0 {
                to[n] = lane;
                n += 1;
            }
        }
    }

    #[inline(always)]
    fn store_whole(self, mask: Mask8, to: &mut [u32]) {
        let to = &mut to[..8];
        for (i, lane) in self.0.into_iter().enumerate() {
            if mask.0 >> i & 1 != 0 {
                to[i] = lane as u32;
            }
        }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    #[inline(always)]
    fn floor(self) -> Self {
        self.map(f64::floor)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.map(f64::abs)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        self.compare(other, |a, b| a < b)
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        self.compare(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Mask8 {
        self.compare(other, |a, b| a == b)
    }

    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(std::array::from_fn(|i| if mask.0 >> i & 1 != 0 { yes.0[i] } else { no.0[i] }))
    }
}

impl Mask for Mask8 {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(bits as u8)
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.into()
    }
}

impl BitAnd for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Not for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}
