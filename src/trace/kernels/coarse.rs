//! Lanes as wrong as they may be: what is decided beyond a bound on their errors is held against the truth.
//!
//! All that bounds assume of an operation is that its result is within a share u of the exact one, and is that one where few
//! digits are enough for it. A machine's roundings are seldom near that, and its u is so small that no ray of a test comes
//! within a margin. Here u is 2⁻²⁵; a result that takes more than twenty-nine digits is moved by nearly u of itself, up, down, or as its
//! digits have it, so that the same operation on the same numbers gives the same. What is bounded by u in theory is then
//! found wrong by one ray in some thousands if a bound is too small.
//!
//! Nothing is inlined: it compiles sooner.

use std::cell::Cell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::trace::kernels::scalar::{Lanes8, Mask8, single};
use crate::trace::kernels::{Lanes, Numbers, Precision};

impl Precision {
    /// That of coarse lanes.
    pub const COARSE: Self = Self { u: 1.0 / (1_u64 << 25) as f64, min_cosine: 1.0 / 16.0 };
}

/// Binary digits of a binary64 number beyond the twenty-ninth.
const DROPPED: u64 = (1 << 24) - 1;

/// What a result is moved by, in units of u; an eighth more is lost when digits are dropped.
const SHARE: f64 = 0.87;

/// How wrong operations are.
#[derive(Clone, Copy, Debug)]
pub(in crate::trace) struct Wrongness {
    /// How many times as wrong as bounds take them to be.
    pub excess: f64,
    pub way: Way,
}

/// Which way results are moved.
#[derive(Clone, Copy, Debug)]
pub(in crate::trace) enum Way {
    /// Away from 0.
    Up,
    /// Toward 0.
    Down,
    /// As their digits have it.
    Mixed,
}

thread_local! {
    static WRONGNESS: Cell<Wrongness> = const { Cell::new(Wrongness { excess: 1.0, way: Way::Mixed }) };
}

/// Sets how wrong the operations of this thread are.
pub(in crate::trace) fn be_wrong(wrongness: Wrongness) {
    WRONGNESS.set(wrongness);
}

/// Rounds a number as wrongly as may be.
#[inline(never)]
fn rounded(number: f64) -> f64 {
    let bits = number.to_bits();
    if bits & DROPPED == 0 || !number.is_finite() {
        return number;
    }
    let Wrongness { excess, way } = WRONGNESS.get();
    let is_up = match way {
        Way::Up => true,
        Way::Down => false,
        Way::Mixed => (bits ^ bits >> 29).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 63 == 0,
    };
    let share = SHARE * Precision::COARSE.u * excess;
    let moved = number + number * if is_up { share } else { -share };
    f64::from_bits(moved.to_bits() & !DROPPED)
}

/// Eight numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coarse(Lanes8);

impl Coarse {
    #[inline(never)]
    fn round(lanes: Lanes8) -> Self {
        let mut numbers = [0.0; 8];
        lanes.store(&mut numbers);
        Self(Lanes8::load(&numbers.map(rounded)))
    }
}

impl Add for Coarse {
    type Output = Self;

    #[inline(never)]
    fn add(self, other: Self) -> Self {
        Self::round(self.0 + other.0)
    }
}

impl Sub for Coarse {
    type Output = Self;

    #[inline(never)]
    fn sub(self, other: Self) -> Self {
        Self::round(self.0 - other.0)
    }
}

impl Mul for Coarse {
    type Output = Self;

    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        Self::round(self.0 * other.0)
    }
}

impl Div for Coarse {
    type Output = Self;

    #[inline(never)]
    fn div(self, other: Self) -> Self {
        Self::round(self.0 / other.0)
    }
}

impl Neg for Coarse {
    type Output = Self;

    #[inline(never)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Lanes for Coarse {
    const PRECISION: Precision = Precision::COARSE;

    type Single = single::Lanes16;

    /// Rounds twice, which is worse.
    #[inline(never)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }

    #[inline(never)]
    fn rounded(number: f64) -> f64 {
        rounded(number)
    }

    #[inline(never)]
    fn reciprocal_bound(self) -> Self {
        Self(Lanes8::splat(1.0 + 2.0 * Self::U) / self.0)
    }

    #[inline(never)]
    fn look_up(table: &[f64; 16], places: Self) -> Self {
        Self::round(Lanes8::look_up(table, places.0))
    }
}

impl Numbers for Coarse {
    const N: usize = 8;

    type Mask = Mask8;

    type Element = f64;

    /// Constants that were worked out beforehand are rounded here.
    #[inline(never)]
    fn splat(number: f64) -> Self {
        Self(Lanes8::splat(rounded(number)))
    }

    #[inline(never)]
    fn load(from: &[f64]) -> Self {
        Self::round(Lanes8::load(from))
    }

    #[inline(never)]
    fn store(self, to: &mut [f64]) {
        self.0.store(to);
    }

    #[inline(never)]
    fn store_packed(self, mask: Mask8, to: &mut [f64]) {
        self.0.store_packed(mask, to);
    }

    #[inline(never)]
    fn store_whole(self, mask: Mask8, to: &mut [u32]) {
        self.0.store_whole(mask, to);
    }

    #[inline(never)]
    fn sqrt(self) -> Self {
        Self::round(self.0.sqrt())
    }

    #[inline(never)]
    fn floor(self) -> Self {
        Self(self.0.floor())
    }

    #[inline(never)]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }

    #[inline(never)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }

    #[inline(never)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }

    #[inline(never)]
    fn lt(self, other: Self) -> Mask8 {
        self.0.lt(other.0)
    }

    #[inline(never)]
    fn le(self, other: Self) -> Mask8 {
        self.0.le(other.0)
    }

    #[inline(never)]
    fn eq(self, other: Self) -> Mask8 {
        self.0.eq(other.0)
    }

    #[inline(never)]
    fn select(mask: Mask8, yes: Self, no: Self) -> Self {
        Self(Lanes8::select(mask, yes.0, no.0))
    }
}
