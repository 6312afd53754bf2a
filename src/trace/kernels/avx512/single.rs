//! Binary32 lanes in one register of 512 bits.
//!
//! Features: avx512f, avx512dq, avx512vl, avx512bw, and what they include.

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use crate::trace::kernels::{Mask, Numbers, SingleLanes};

/// Sixteen numbers. Only `run_single` names this type to others, so that it exists only where the instructions do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lanes16(__m512);

/// Sixteen truths, a bit each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mask16(__mmask16);

impl Add for Lanes16 {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { _mm512_add_ps(self.0, other.0) })
    }
}

impl Sub for Lanes16 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { _mm512_sub_ps(self.0, other.0) })
    }
}

impl Mul for Lanes16 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { _mm512_mul_ps(self.0, other.0) })
    }
}

impl Div for Lanes16 {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { _mm512_div_ps(self.0, other.0) })
    }
}

impl Neg for Lanes16 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { _mm512_xor_ps(self.0, _mm512_set1_ps(-0.0)) })
    }
}

impl Numbers for Lanes16 {
    const N: usize = 16;

    type Mask = Mask16;

    type Element = f32;

    #[inline(always)]
    fn splat(number: f64) -> Self {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { _mm512_set1_ps(number as f32) })
    }

    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        let from = &from[..16];
        // SAFETY: as above; the sixteen numbers are there.
        Self(unsafe { _mm512_loadu_ps(from.as_ptr()) })
    }

    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        let to = &mut to[..16];
        // SAFETY: as above; there is room for sixteen numbers.
        unsafe { _mm512_storeu_ps(to.as_mut_ptr(), self.0) }
    }

    /// Packs in a register: the instruction that packs into memory is many times slower on some machines.
    #[inline(always)]
    fn store_packed(self, mask: Mask16, to: &mut [f32]) {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { _mm512_maskz_compress_ps(mask.0, self.0) }).store(to);
    }

    #[inline(always)]
    fn store_whole(self, mask: Mask16, to: &mut [u32]) {
        let to = &mut to[..16];
        // SAFETY: as above; there is room for sixteen numbers.
        unsafe { _mm512_mask_storeu_epi32(to.as_mut_ptr().cast(), mask.0, _mm512_cvttps_epi32(self.0)) }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { _mm512_sqrt_ps(self.0) })
    }

    #[inline(always)]
    fn floor(self) -> Self {
        const DOWN: i32 = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC;
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { _mm512_roundscale_ps::<DOWN>(self.0) })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { _mm512_abs_ps(self.0) })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { _mm512_min_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { _mm512_max_ps(self.0, other.0) })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask16 {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Mask16(unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask16 {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Mask16(unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Mask16 {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Mask16(unsafe { _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn select(mask: Mask16, yes: Self, no: Self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { _mm512_mask_blend_ps(mask.0, no.0, yes.0) })
    }
}

impl SingleLanes for Lanes16 {
    #[inline(always)]
    fn same(number: f32) -> Self {
        // SAFETY: lanes of this kind exist inside of `run_single` alone.
        Self(unsafe { _mm512_set1_ps(number) })
    }
}

impl Mask for Mask16 {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(bits as __mmask16)
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
