//! Binary32 lanes in two registers of 256 bits.
//!
//! Features: avx2 and what it includes.

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use crate::trace::kernels::{Mask, Numbers, SingleLanes};

/// Sixteen numbers. Only `run_single` names this type to others, so that it exists only where the instructions do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lanes16([__m256; 2]);

/// Sixteen truths: all bits of a lane, or none.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mask16([__m256; 2]);

impl Add for Lanes16 {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { [_mm256_add_ps(a, c), _mm256_add_ps(b, d)] })
    }
}

impl Sub for Lanes16 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { [_mm256_sub_ps(a, c), _mm256_sub_ps(b, d)] })
    }
}

impl Mul for Lanes16 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { [_mm256_mul_ps(a, c), _mm256_mul_ps(b, d)] })
    }
}

impl Div for Lanes16 {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { [_mm256_div_ps(a, c), _mm256_div_ps(b, d)] })
    }
}

impl Neg for Lanes16 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        let [a, b] = self.0;
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { [_mm256_xor_ps(a, _mm256_set1_ps(-0.0)), _mm256_xor_ps(b, _mm256_set1_ps(-0.0))] })
    }
}

impl Numbers for Lanes16 {
    const N: usize = 16;

    type Mask = Mask16;

    type Element = f32;

    #[inline(always)]
    fn splat(number: f64) -> Self {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { [_mm256_set1_ps(number as f32); 2] })
    }

    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        let from = &from[..16];
        // SAFETY: as above; the sixteen numbers are there.
        Self(unsafe { [_mm256_loadu_ps(from.as_ptr()), _mm256_loadu_ps(from[8..].as_ptr())] })
    }

    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        let (low, high) = to[..16].split_at_mut(8);
        // SAFETY: as above; there is room for eight numbers each.
        unsafe {
            _mm256_storeu_ps(low.as_mut_ptr(), self.0[0]);
            _mm256_storeu_ps(high.as_mut_ptr(), self.0[1]);
        }
    }

    #[inline(always)]
    fn store_packed(self, mask: Mask16, to: &mut [f32]) {
        let to = &mut to[..16];
        let mut lanes = [0.0; 16];
        self.store(&mut lanes);
        let (bits, mut n) = (mask.bits(), 0);
        for (i, lane) in lanes.into_iter().enumerate() {
            // `n` is at most `i`, so what is written here in vain is written over or lies behind the end.
            to[n] = lane;
            n += (bits >> i & 1) as usize;
        }
    }

    #[inline(always)]
    fn store_whole(self, mask: Mask16, to: &mut [u32]) {
        let to = &mut to[..16];
        let mut lanes = [0_u32; 16];
        // SAFETY: as above; there is room for eight numbers each.
        unsafe {
            _mm256_storeu_si256(lanes.as_mut_ptr().cast(), _mm256_cvttps_epi32(self.0[0]));
            _mm256_storeu_si256(lanes[8..].as_mut_ptr().cast(), _mm256_cvttps_epi32(self.0[1]));
        }
        let bits = mask.bits();
        for (i, lane) in lanes.into_iter().enumerate() {
            if bits >> i & 1 != 0 {
                to[i] = lane;
            }
        }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let [a, b] = self.0;
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { [_mm256_sqrt_ps(a), _mm256_sqrt_ps(b)] })
    }

    #[inline(always)]
    fn floor(self) -> Self {
        let [a, b] = self.0;
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { [_mm256_floor_ps(a), _mm256_floor_ps(b)] })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        let [a, b] = self.0;
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { [_mm256_andnot_ps(_mm256_set1_ps(-0.0), a), _mm256_andnot_ps(_mm256_set1_ps(-0.0), b)] })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { [_mm256_min_ps(a, c), _mm256_min_ps(b, d)] })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { [_mm256_max_ps(a, c), _mm256_max_ps(b, d)] })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask16 {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Mask16(unsafe { [_mm256_cmp_ps::<_CMP_LT_OQ>(a, c), _mm256_cmp_ps::<_CMP_LT_OQ>(b, d)] })
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask16 {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Mask16(unsafe { [_mm256_cmp_ps::<_CMP_LE_OQ>(a, c), _mm256_cmp_ps::<_CMP_LE_OQ>(b, d)] })
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Mask16 {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Mask16(unsafe { [_mm256_cmp_ps::<_CMP_EQ_OQ>(a, c), _mm256_cmp_ps::<_CMP_EQ_OQ>(b, d)] })
    }

    #[inline(always)]
    fn select(mask: Mask16, yes: Self, no: Self) -> Self {
        let ([a, b], [c, d], [m, n]) = (yes.0, no.0, mask.0);
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { [_mm256_blendv_ps(c, a, m), _mm256_blendv_ps(d, b, n)] })
    }
}

impl SingleLanes for Lanes16 {
    #[inline(always)]
    fn same(number: f32) -> Self {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { [_mm256_set1_ps(number); 2] })
    }
}

impl Mask for Mask16 {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        unsafe {
            let bits = _mm256_set1_epi32(bits as i32);
            let low = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let high = _mm256_slli_epi32::<8>(low);
            let low = _mm256_cmpeq_epi32(_mm256_and_si256(bits, low), low);
            let high = _mm256_cmpeq_epi32(_mm256_and_si256(bits, high), high);
            Self([_mm256_castsi256_ps(low), _mm256_castsi256_ps(high)])
        }
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        unsafe { (_mm256_movemask_ps(self.0[0]) | _mm256_movemask_ps(self.0[1]) << 8) as u32 }
    }
}

impl BitAnd for Mask16 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { [_mm256_and_ps(a, c), _mm256_and_ps(b, d)] })
    }
}

impl BitOr for Mask16 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { [_mm256_or_ps(a, c), _mm256_or_ps(b, d)] })
    }
}

impl Not for Mask16 {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        let [a, b] = self.0;
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        unsafe {
            let all = _mm256_castsi256_ps(_mm256_set1_epi64x(-1));
            Self([_mm256_xor_ps(a, all), _mm256_xor_ps(b, all)])
        }
    }
}
