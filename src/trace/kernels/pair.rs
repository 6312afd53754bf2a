//! Two packets side by side: a machine works on one while it waits for the other, and what both share is fetched once.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use crate::trace::kernels::{Lanes, Mask, Numbers};

/// Twice as many numbers, the lanes of the first below those of the second.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair<L>(L, L);

/// The truths of a pair.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairMask<L: Numbers>(L::Mask, L::Mask);

impl<L: Numbers> Add for Pair<L> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0, self.1 + other.1)
    }
}

impl<L: Numbers> Sub for Pair<L> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0, self.1 - other.1)
    }
}

impl<L: Numbers> Mul for Pair<L> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0, self.1 * other.1)
    }
}

impl<L: Numbers> Div for Pair<L> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.0, self.1 / other.1)
    }
}

impl<L: Numbers> Neg for Pair<L> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl<L: Lanes> Lanes for Pair<L> {
    type Single = L::Single;

    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self(self.0.mul_add(factor.0, addend.0), self.1.mul_add(factor.1, addend.1))
    }

    #[inline(always)]
    fn reciprocal_bound(self) -> Self {
        Self(self.0.reciprocal_bound(), self.1.reciprocal_bound())
    }

    #[inline(always)]
    fn look_up(table: &[f64; 16], places: Self) -> Self {
        Self(L::look_up(table, places.0), L::look_up(table, places.1))
    }
}

impl<L: Numbers> Numbers for Pair<L> {
    const N: usize = 2 * L::N;

    type Mask = PairMask<L>;

    type Element = L::Element;

    #[inline(always)]
    fn splat(number: f64) -> Self {
        let lanes = L::splat(number);
        Self(lanes, lanes)
    }

    #[inline(always)]
    fn load(from: &[L::Element]) -> Self {
        Self(L::load(from), L::load(&from[L::N..]))
    }

    #[inline(always)]
    fn store(self, to: &mut [L::Element]) {
        self.0.store(to);
        self.1.store(&mut to[L::N..]);
    }

    #[inline(always)]
    fn store_packed(self, mask: PairMask<L>, to: &mut [L::Element]) {
        let n_first = mask.0.bits().count_ones() as usize;
        self.0.store_packed(mask.0, to);
        self.1.store_packed(mask.1, &mut to[n_first..]);
    }

    #[inline(always)]
    fn store_whole(self, mask: PairMask<L>, to: &mut [u32]) {
        self.0.store_whole(mask.0, to);
        self.1.store_whole(mask.1, &mut to[L::N..]);
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt(), self.1.sqrt())
    }

    #[inline(always)]
    fn floor(self) -> Self {
        Self(self.0.floor(), self.1.floor())
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs(), self.1.abs())
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0), self.1.min(other.1))
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.max(other.1))
    }

    #[inline(always)]
    fn lt(self, other: Self) -> PairMask<L> {
        PairMask(self.0.lt(other.0), self.1.lt(other.1))
    }

    #[inline(always)]
    fn le(self, other: Self) -> PairMask<L> {
        PairMask(self.0.le(other.0), self.1.le(other.1))
    }

    #[inline(always)]
    fn eq(self, other: Self) -> PairMask<L> {
        PairMask(self.0.eq(other.0), self.1.eq(other.1))
    }

    #[inline(always)]
    fn select(mask: PairMask<L>, yes: Self, no: Self) -> Self {
        Self(L::select(mask.0, yes.0, no.0), L::select(mask.1, yes.1, no.1))
    }
}

impl<L: Numbers> Mask for PairMask<L> {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(L::Mask::from_bits(bits), L::Mask::from_bits(bits >> L::N))
    }

    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.bits() | self.1.bits() << L::N
    }

    #[inline(always)]
    fn any(self) -> bool {
        (self.0 | self.1).any()
    }
}

impl<L: Numbers> BitAnd for PairMask<L> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0, self.1 & other.1)
    }
}

impl<L: Numbers> BitOr for PairMask<L> {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0, self.1 | other.1)
    }
}

impl<L: Numbers> Not for PairMask<L> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0, !self.1)
    }
}
