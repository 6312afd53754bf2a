//! Binary32 lanes of plain numbers: the specification of the other backends.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use crate::trace::kernels::{Mask, Numbers, SingleLanes};

/// Sixteen numbers.
#[derive(Clone, Copy, Debug)]
pub(in crate::trace::kernels) struct Lanes16([f32; 16]);

/// Sixteen truths, a bit each.
#[derive(Clone, Copy, Debug)]
pub(in crate::trace::kernels) struct Mask16(u16);

impl Lanes16 {
    #[inline(always)]
    fn map(mut self, f: impl Fn(f32) -> f32) -> Self {
        for lane in &mut self.0 {
            *lane = f(*lane);
        }
        self
    }

    #[inline(always)]
    fn zip(mut self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        for (lane, other) in self.0.iter_mut().zip(other.0) {
            *lane = f(*lane, other);
        }
        self
    }

    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(f32, f32) -> bool) -> Mask16 {
        let mut bits = 0;
        for i in 0..16 {
            bits |= u16::from(f(self.0[i], other.0[i])) << i;
        }
        Mask16(bits)
    }
}

impl Add for Lanes16 {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Lanes16 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Lanes16 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Div for Lanes16 {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
}

impl Neg for Lanes16 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl Numbers for Lanes16 {
    const N: usize = 16;

    type Mask = Mask16;

    type Element = f32;

    #[inline(always)]
    fn splat(number: f64) -> Self {
        Self([number as f32; 16])
    }

    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        Self(std::array::from_fn(|i| from[..16][i]))
    }

    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[..16].copy_from_slice(&self.0);
    }

    #[inline(always)]
    fn store_packed(self, mask: Mask16, to: &mut [f32]) {
        let to = &mut to[..16];
        let mut n = 0;
        for (i, lane) in self.0.into_iter().enumerate() {
            if mask.0 >> i & 1 != 0 {
                to[n] = lane;
                n += 1;
            }
        }
    }

    #[inline(always)]
    fn store_whole(self, mask: Mask16, to: &mut [u32]) {
        let to = &mut to[..16];
        for (i, lane) in self.0.into_iter().enumerate() {
            if mask.0 >> i & 1 != 0 {
                to[i] = lane as u32;
            }
        }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(f32::sqrt)
    }

    #[inline(always)]
    fn floor(self) -> Self {
        self.map(f32::floor)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.map(f32::abs)
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
    fn lt(self, other: Self) -> Mask16 {
        self.compare(other, |a, b| a < b)
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask16 {
        self.compare(other, |a, b| a <= b)
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Mask16 {
        self.compare(other, |a, b| a == b)
    }

    #[inline(always)]
    fn select(mask: Mask16, yes: Self, no: Self) -> Self {
        Self(std::array::from_fn(|i| if mask.0 >> i & 1 != 0 { yes.0[i] } else { no.0[i] }))
    }
}

impl SingleLanes for Lanes16 {
    #[inline(always)]
    fn same(number: f32) -> Self {
        Self([number; 16])
    }
}

impl Mask for Mask16 {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(bits as u16)
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.into()
    }
}

impl BitAnd for Mask16 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Mask16 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Not for Mask16 {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}
