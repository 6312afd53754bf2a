//! The lanes: eight binary64 numbers, or sixteen of binary32, that go through the same operations at once, on whatever the
//! machine has for it.
//!
//! [`Numbers`] has the operations of IEEE 754 alone, each rounded once: no fused multiply-add, no approximate reciprocal. A
//! computation written over it therefore gives the same bits on every backend; `scalar` is the specification. [`Lanes`]
//! adds both, for computations whose results are relied on only as far as a bound on their error allows. A
//! computation is a [`Job`]; [`Backend::run`] instantiates it for the lanes of a backend, inside a function that may use
//! the instructions of that backend.
//!
//! The only `unsafe` of the library is in here: calls of instructions, and of the functions that contain them.
#![allow(unsafe_code, reason = "instructions that not every machine has")]

#[cfg(test)]
pub(in crate::trace) mod coarse;
mod pair;
mod scalar;

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;

#[cfg(test)]
mod tests;

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use crate::plan::BackendChoice;

/// One truth for each lane.
pub trait Mask: Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Makes a mask from its bits, that of lane 0 lowest; those above the last lane do not matter.
    fn from_bits(bits: u32) -> Self;

    /// Returns the bits, that of lane 0 lowest; those above the last lane are 0.
    fn bits(self) -> u32;

    /// Tells whether any lane is true.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
}

/// Some numbers side by side. Every operation is carried out lane by lane and rounded once, to the nearest, as IEEE 754
/// says.
pub trait Numbers:
    Copy + Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// How many.
    const N: usize;

    /// What comparisons give.
    type Mask: Mask;

    /// What each lane is.
    type Element: Copy;

    /// Makes every lane the same number, rounded if need be.
    fn splat(number: f64) -> Self;

    /// Reads the first `N` numbers.
    ///
    /// # Panics
    /// When there are fewer.
    fn load(from: &[Self::Element]) -> Self;

    /// Writes the first `N` numbers.
    ///
    /// # Panics
    /// When there is room for fewer.
    fn store(self, to: &mut [Self::Element]);

    /// Writes the lanes of the mask side by side, and anything into the rest of the first `N` places.
    ///
    /// # Panics
    /// When there is room for fewer than `N`.
    fn store_packed(self, mask: Self::Mask, to: &mut [Self::Element]);

    /// Writes the lanes of the mask, which must be whole numbers from 0 to 2³¹ − 1, each into its place of the first `N`.
    ///
    /// # Panics
    /// When there is room for fewer than `N`.
    fn store_whole(self, mask: Self::Mask, to: &mut [u32]);

    /// Returns the correctly rounded square root.
    fn sqrt(self) -> Self;

    /// Returns the largest whole number that is not larger.
    fn floor(self) -> Self;

    /// Returns the magnitude.
    fn abs(self) -> Self;

    /// Returns `self` where it is smaller than `other`, else `other`.
    fn min(self, other: Self) -> Self;

    /// Returns `self` where it is larger than `other`, else `other`.
    fn max(self, other: Self) -> Self;

    /// Compares; false where a number is NaN.
    fn lt(self, other: Self) -> Self::Mask;

    /// Compares; false where a number is NaN.
    fn le(self, other: Self) -> Self::Mask;

    /// Compares; false where a number is NaN.
    fn eq(self, other: Self) -> Self::Mask;

    /// Returns `yes` where the mask is true, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// Compares; false where a number is NaN.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }

    /// Compares; false where a number is NaN.
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }
}

/// How precise lanes are: what bounds on their errors are made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// u: what one rounding changes is at most this share of the result.
    pub u: f64,
    /// g: the smallest cosine between a ray and the normal of a curved face at which a hit is taken.
    pub min_cosine: f64,
}

impl Precision {
    /// That of binary64 numbers, for which u is half an ulp of 1.
    pub const BINARY64: Self = Self { u: f64::EPSILON / 2.0, min_cosine: 1.0 / 512.0 };
}

/// Some binary64 numbers.
///
/// What is added here to the operations of [`Numbers`] differs from backend to backend within what is said of it. It is
/// for what is held against a bound on its error: whether a result can be relied on may depend on the machine, a result
/// that is relied on not.
pub trait Lanes: Numbers<Element = f64> {
    /// How far off an operation may be.
    const PRECISION: Precision = Precision::BINARY64;

    /// u: what one rounding changes is at most this share of the result.
    const U: f64 = Self::PRECISION.u;

    /// The binary32 numbers of the same backend.
    type Single: SingleLanes;

    /// Returns `self · factor + addend`, rounded once, or once after the product and once after the sum.
    fn mul_add(self, factor: Self, addend: Self) -> Self;

    /// Returns a number that was worked out beside the lanes as it would be in one of them.
    #[inline(always)]
    fn rounded(number: f64) -> f64 {
        number
    }

    /// Returns what the reciprocal is at most, and at least 0.999 times: of numbers from 2⁻¹⁰⁰⁰ to 2¹⁰⁰⁰.
    fn reciprocal_bound(self) -> Self;

    /// Returns what stands at these places of a table; they must be whole numbers from 0 to 15.
    fn look_up(table: &[f64; 16], places: Self) -> Self;
}

/// Some binary32 numbers.
pub trait SingleLanes: Numbers<Element = f32> {
    /// Makes every lane the same number.
    fn same(number: f32) -> Self;
}

/// A computation over lanes of whatever kind. To be compiled for a backend it must be inlined into it, so
/// [`run`](Job::run), and all that it calls on lanes, is `#[inline(always)]`.
pub trait Job {
    /// What comes out.
    type Output;

    /// Computes it.
    fn run<L: Lanes>(self) -> Self::Output;
}

/// A computation over binary32 lanes of whatever kind; what is said of a [`Job`] holds for it.
pub trait SingleJob {
    /// What comes out.
    type Output;

    /// Computes it.
    fn run<L: SingleLanes>(self) -> Self::Output;
}

/// Asks for an element to be brought near, into the cache; nothing happens where there is none, or no such instruction.
#[inline(always)]
pub fn prefetch<T>(items: &[T], i: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(item) = items.get(i) {
        let lines = size_of::<T>().div_ceil(64).min(MAX_LINES);
        for line in 0..lines {
            // SAFETY: every x86-64 has the instruction, and the address lies within the element.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(item).cast::<i8>().add(64 * line)) };
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (items, i);
}

/// Lines of the cache of an element that are asked for: more come by themselves.
#[cfg(target_arch = "x86_64")]
const MAX_LINES: usize = 8;

/// What the lanes are made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Backend {
    /// One number after the other, on any machine.
    Scalar,
    /// Registers of four.
    Avx2,
    /// Registers of eight.
    Avx512,
    /// Operations that are as wrong as their precision allows, and that is a low one.
    #[cfg(test)]
    Coarse,
}

impl Backend {
    /// Every backend, the slowest first.
    pub const ALL: [Self; 3] = [Self::Scalar, Self::Avx2, Self::Avx512];

    /// Returns the fastest that this machine has.
    #[must_use]
    pub fn best() -> Self {
        Self::ALL.into_iter().rfind(|backend| backend.is_available()).unwrap_or(Self::Scalar)
    }

    /// Returns what a choice means on this machine. It may not be [available](Self::is_available) here.
    #[must_use]
    pub fn chosen(choice: BackendChoice) -> Self {
        match choice {
            BackendChoice::Auto => Self::best(),
            BackendChoice::Avx512 => Self::Avx512,
            BackendChoice::Avx2 => Self::Avx2,
            BackendChoice::Scalar => Self::Scalar,
        }
    }

    /// Returns the name by which a command line calls it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
            #[cfg(test)]
            Self::Coarse => "coarse",
        }
    }

    /// Tells whether this machine has the instructions.
    #[must_use]
    pub fn is_available(self) -> bool {
        match self {
            Self::Scalar => true,
            #[cfg(test)]
            Self::Coarse => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => avx2::is_available(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => avx512::is_available(),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }

    /// Returns how precise its lanes are.
    pub(in crate::trace) const fn precision(self) -> Precision {
        match self {
            Self::Scalar | Self::Avx2 | Self::Avx512 => Precision::BINARY64,
            #[cfg(test)]
            Self::Coarse => Precision::COARSE,
        }
    }

    /// Carries out a job.
    ///
    /// # Panics
    /// When the machine lacks the instructions.
    pub fn run<J: Job>(self, job: J) -> J::Output {
        assert!(self.is_available(), "this machine has no {}", self.name());
        match self {
            // SAFETY: the machine has the instructions, as was just asserted.
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => unsafe { avx2::run(job) },
            // SAFETY: the machine has the instructions, as was just asserted.
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => unsafe { avx512::run(job) },
            #[cfg(test)]
            Self::Coarse => job.run::<coarse::Coarse>(),
            _ => job.run::<scalar::Lanes8>(),
        }
    }

    /// Carries out a job on packets of sixteen where that is faster, else on those of eight.
    ///
    /// # Panics
    /// When the machine lacks the instructions.
    pub fn run_twofold<J: Job>(self, job: J) -> J::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                assert!(self.is_available(), "this machine has no {}", self.name());
                // SAFETY: the machine has the instructions, as was just asserted.
                unsafe { avx512::run_twofold(job) }
            }
            _ => self.run(job),
        }
    }

    /// Carries out a job on binary32 numbers.
    ///
    /// # Panics
    /// When the machine lacks the instructions.
    pub fn run_single<J: SingleJob>(self, job: J) -> J::Output {
        assert!(self.is_available(), "this machine has no {}", self.name());
        match self {
            // SAFETY: the machine has the instructions, as was just asserted.
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => unsafe { avx2::run_single(job) },
            // SAFETY: the machine has the instructions, as was just asserted.
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => unsafe { avx512::run_single(job) },
            _ => job.run::<scalar::single::Lanes16>(),
        }
    }
}
