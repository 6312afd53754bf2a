//! Lanes in one register of 512 bits.
//!
//! Features: avx512f, avx512dq, avx512vl, avx512bw, bmi1, popcnt, and what they include.

mod single;

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use crate::trace::kernels::pair::Pair;
use crate::trace::kernels::{Job, Lanes, Mask, Numbers, SingleJob};

/// Tells whether the machine has the instructions.
pub(super) fn is_available() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("popcnt")
}

/// Carries out a job on lanes of this kind.
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,bmi1,popcnt")]
pub(super) fn run<J: Job>(job: J) -> J::Output {
    job.run::<Lanes8>()
}

/// Carries out a job on two of these lanes side by side: there are registers enough for much of two packets.
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,bmi1,popcnt")]
pub(super) fn run_twofold<J: Job>(job: J) -> J::Output {
    job.run::<Pair<Lanes8>>()
}

/// Carries out a job on binary32 lanes of this kind.
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,bmi1,popcnt")]
pub(super) fn run_single<J: SingleJob>(job: J) -> J::Output {
    job.run::<single::Lanes16>()
}

/// Eight numbers. Only [`run`] names this type to others, so that it exists only where the instructions do.
#[derive(Clone, Copy, Debug)]
struct Lanes8(__m512d);

/// Eight truths, a bit each.
#[derive(Clone, Copy, Debug)]
struct Mask8(__mmask8);

impl Add for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { _mm512_add_pd(self.0, other.0) })
    }
}

impl Sub for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { _mm512_sub_pd(self.0, other.0) })
    }
}

impl Mul for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { _mm512_mul_pd(self.0, other.0) })
    }
}

impl Div for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { _mm512_div_pd(self.0, other.0) })
    }
}

impl Neg for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { _mm512_sub_pd(_mm512_set1_pd(-0.0), self.0) })
    }
}

impl Numbers for Lanes8 {
    const N: usize = 8;

    type Mask = Mask8;

    type Element = f64;

    #[inline(always)]
    fn splat(number: f64) -> Self {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { _mm512_set1_pd(number) })
    }

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        let from = &from[..8];
        // SAFETY: as above; the eight numbers are there.
        Self(unsafe { _mm512_loadu_pd(from.as_ptr()) })
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        let to = &mut to[..8];
        // SAFETY: as above; there is room for eight numbers.
        unsafe { _mm512_storeu_pd(to.as_mut_ptr(), self.0) }
    }

    /// Packs in a register: the instruction that packs into memory is many times slower on some machines.
    #[inline(always)]
    fn store_packed(self, mask: Mask8, to: &mut [f64]) {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { _mm512_maskz_compress_pd(mask.0, self.0) }).store(to);
    }

    #[inline(always)]
    fn store_whole(self, mask: Mask8, to: &mut [u32]) {
        let to = &mut to[..8];
        // SAFETY: as above; there is room for eight numbers.
        unsafe { _mm256_mask_storeu_epi32(to.as_mut_ptr().cast(), mask.0, _mm512_cvttpd_epi32(self.0)) }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }

    #[inline(always)]
    fn floor(self) -> Self {
        const DOWN: i32 = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC;
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { _mm512_roundscale_pd::<DOWN>(self.0) })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { _mm512_abs_pd(self.0) })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { _mm512_min_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { _mm512_max_pd(self.0, other.0) })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Mask8(unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Mask8(unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Mask8 {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Mask8(unsafe { _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(self.0, other.0) })
    }

    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { _mm512_mask_blend_pd(mask.0, no.0, yes.0) })
    }
}

impl Lanes for Lanes8 {
    type Single = single::Lanes16;

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { _mm512_fmadd_pd(self.0, factor.0, addend.0) })
    }

    /// The instruction is off by at most a share of 2⁻¹⁴.
    #[inline(always)]
    fn reciprocal_bound(self) -> Self {
        const WIDENED: f64 = 1.0 + 1.0 / 8192.0;
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { _mm512_rcp14_pd(self.0) }) * Self::splat(WIDENED)
    }

    #[inline(always)]
    fn look_up(table: &[f64; 16], places: Self) -> Self {
        // SAFETY: as above; the sixteen numbers are there, and of each place only four bits are taken.
        Self(unsafe {
            let (low, high) = (_mm512_loadu_pd(table.as_ptr()), _mm512_loadu_pd(table.as_ptr().add(8)));
            _mm512_permutex2var_pd(low, _mm512_cvttpd_epi64(places.0), high)
        })
    }
}

impl Mask for Mask8 {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(bits as __mmask8)
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
