//! Faults on purpose: what tests make wrong in the packets, to see that it is found.
//!
//! Without the feature `testing` all of this is nothing: a fault has no fields, and what it does to a number is to return
//! it.

use crate::trace::kernels::Lanes;

/// What is made wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// What every root of an eye ray is multiplied by.
    #[cfg(feature = "testing")]
    pub root_factor: f64,
    /// The bits of every root of an eye ray that are left as they are; the others are cleared.
    #[cfg(feature = "testing")]
    pub root_mask: u64,
    /// What every bound on the error of a channel is multiplied by.
    #[cfg(feature = "testing")]
    pub bound_factor: f64,
}

#[cfg(not(feature = "testing"))]
impl Fault {
    /// Nothing is wrong.
    pub const NONE: Self = Self {};

    /// Returns the bound.
    #[inline(always)]
    pub(super) fn bound<L: Lanes>(self, error: L) -> L {
        error
    }

    /// Leaves the roots alone.
    #[inline(always)]
    pub(super) fn spoil_roots(self, _: &mut [f64]) {}
}

#[cfg(feature = "testing")]
impl Fault {
    /// Nothing is wrong.
    pub const NONE: Self = Self { root_factor: 1.0, root_mask: u64::MAX, bound_factor: 1.0 };

    /// Returns the bound, shrunk.
    #[inline(always)]
    pub(super) fn bound<L: Lanes>(self, error: L) -> L {
        error * L::splat(self.bound_factor)
    }

    /// Spoils the roots of a tile.
    pub(super) fn spoil_roots(self, roots: &mut [f64]) {
        if self == Self::NONE {
            return;
        }
        for root in roots {
            *root = f64::from_bits((*root * self.root_factor).to_bits() & self.root_mask);
        }
    }
}
