//! Lanes in two registers of 256 bits.
//!
//! Features: avx2, fma, bmi1, popcnt, and what they include.

mod single;

use std::arch::x86_64::*;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use crate::trace::kernels::{Job, Lanes, Mask, Numbers, SingleJob};

/// Tells whether the machine has the instructions.
pub(super) fn is_available() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("fma")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("popcnt")
}

/// Carries out a job on lanes of this kind.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn run<J: Job>(job: J) -> J::Output {
    job.run::<Lanes8>()
}

/// Carries out a job on binary32 lanes of this kind.
#[target_feature(enable = "avx2,fma,bmi1,popcnt")]
pub(super) fn run_single<J: SingleJob>(job: J) -> J::Output {
    job.run::<single::Lanes16>()
}

/// Eight numbers. Only [`run`] names this type to others, so that it exists only where the instructions do.
#[derive(Clone, Copy, Debug)]
struct Lanes8([__m256d; 2]);

/// Eight truths: all bits of a lane, or none.
#[derive(Clone, Copy, Debug)]
struct Mask8([__m256d; 2]);

impl Add for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { [_mm256_add_pd(a, c), _mm256_add_pd(b, d)] })
    }
}

impl Sub for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { [_mm256_sub_pd(a, c), _mm256_sub_pd(b, d)] })
    }
}

impl Mul for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { [_mm256_mul_pd(a, c), _mm256_mul_pd(b, d)] })
    }
}

impl Div for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { [_mm256_div_pd(a, c), _mm256_div_pd(b, d)] })
    }
}

impl Neg for Lanes8 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        let [a, b] = self.0;
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { [_mm256_sub_pd(_mm256_set1_pd(-0.0), a), _mm256_sub_pd(_mm256_set1_pd(-0.0), b)] })
    }
}

impl Numbers for Lanes8 {
    const N: usize = 8;

    type Mask = Mask8;

    type Element = f64;

    #[inline(always)]
    fn splat(number: f64) -> Self {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { [_mm256_set1_pd(number); 2] })
    }

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        let from = &from[..8];
        // SAFETY: as above; the eight numbers are there.
        Self(unsafe { [_mm256_loadu_pd(from.as_ptr()), _mm256_loadu_pd(from[4..].as_ptr())] })
    }

    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        let (low, high) = to[..8].split_at_mut(4);
        // SAFETY: as above; there is room for four numbers each.
        unsafe {
            _mm256_storeu_pd(low.as_mut_ptr(), self.0[0]);
            _mm256_storeu_pd(high.as_mut_ptr(), self.0[1]);
        }
    }

    #[inline(always)]
    fn store_packed(self, mask: Mask8, to: &mut [f64]) {
        let to = &mut to[..8];
        let mut lanes = [0.0; 8];
        self.store(&mut lanes);
        let (bits, mut n) = (mask.bits(), 0);
        for (i, lane) in lanes.into_iter().enumerate() {
            // `n` is at most `i`, so what is written here in vain is written over or lies behind the end.
            to[n] = lane;
            n += (bits >> i & 1) as usize;
        }
    }

    #[inline(always)]
    fn store_whole(self, mask: Mask8, to: &mut [u32]) {
        let to = &mut to[..8];
        let mut lanes = [0_u32; 8];
        // SAFETY: as above; there is room for four numbers each.
        unsafe {
            _mm_storeu_si128(lanes.as_mut_ptr().cast(), _mm256_cvttpd_epi32(self.0[0]));
            _mm_storeu_si128(lanes[4..].as_mut_ptr().cast(), _mm256_cvttpd_epi32(self.0[1]));
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
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { [_mm256_sqrt_pd(a), _mm256_sqrt_pd(b)] })
    }

    #[inline(always)]
    fn floor(self) -> Self {
        let [a, b] = self.0;
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { [_mm256_floor_pd(a), _mm256_floor_pd(b)] })
    }

    #[inline(always)]
    fn abs(self) -> Self {
        let [a, b] = self.0;
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { [_mm256_andnot_pd(_mm256_set1_pd(-0.0), a), _mm256_andnot_pd(_mm256_set1_pd(-0.0), b)] })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { [_mm256_min_pd(a, c), _mm256_min_pd(b, d)] })
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { [_mm256_max_pd(a, c), _mm256_max_pd(b, d)] })
    }

    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Mask8(unsafe { [_mm256_cmp_pd::<_CMP_LT_OQ>(a, c), _mm256_cmp_pd::<_CMP_LT_OQ>(b, d)] })
    }

    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Mask8(unsafe { [_mm256_cmp_pd::<_CMP_LE_OQ>(a, c), _mm256_cmp_pd::<_CMP_LE_OQ>(b, d)] })
    }

    #[inline(always)]
    fn eq(self, other: Self) -> Mask8 {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Mask8(unsafe { [_mm256_cmp_pd::<_CMP_EQ_OQ>(a, c), _mm256_cmp_pd::<_CMP_EQ_OQ>(b, d)] })
    }

    #[inline(always)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        let ([a, b], [c, d], [m, n]) = (yes.0, no.0, mask.0);
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { [_mm256_blendv_pd(c, a, m), _mm256_blendv_pd(d, b, n)] })
    }
}

impl Lanes for Lanes8 {
    type Single = single::Lanes16;

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        let ([a, b], [c, d], [e, f]) = (self.0, factor.0, addend.0);
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { [_mm256_fmadd_pd(a, c, e), _mm256_fmadd_pd(b, d, f)] })
    }

    #[inline(always)]
    fn reciprocal_bound(self) -> Self {
        Self::splat(1.0 + f64::EPSILON) / self
    }

    #[inline(always)]
    fn look_up(table: &[f64; 16], places: Self) -> Self {
        let mut numbers = [0.0; 8];
        places.store(&mut numbers);
        for number in &mut numbers {
            *number = table[*number as usize % 16];
        }
        Self::load(&numbers)
    }
}

impl Mask for Mask8 {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        unsafe {
            let bits = _mm256_set1_epi64x(i64::from(bits));
            let low = _mm256_setr_epi64x(1, 2, 4, 8);
            let high = _mm256_setr_epi64x(16, 32, 64, 128);
            let low = _mm256_cmpeq_epi64(_mm256_and_si256(bits, low), low);
            let high = _mm256_cmpeq_epi64(_mm256_and_si256(bits, high), high);
            Self([_mm256_castsi256_pd(low), _mm256_castsi256_pd(high)])
        }
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        // SAFETY: lanes of this kind exist inside of `run` alone.
        unsafe { (_mm256_movemask_pd(self.0[0]) | _mm256_movemask_pd(self.0[1]) << 4) as u32 }
    }
}

impl BitAnd for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { [_mm256_and_pd(a, c), _mm256_and_pd(b, d)] })
    }
}

impl BitOr for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: lanes of this kind exist inside of `run` alone.
        Self(unsafe { [_mm256_or_pd(a, c), _mm256_or_pd(b, d)] })
    }
}

impl Not for Mask8 {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        let [a, b] = self.0;
        // SAFETY: lanes of this kind exist inside of `run` alone.
        unsafe {
            let all = _mm256_castsi256_pd(_mm256_set1_epi64x(-1));
            Self([_mm256_xor_pd(a, all), _mm256_xor_pd(b, all)])
        }
    }
}
