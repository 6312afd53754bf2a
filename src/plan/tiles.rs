//! Which objects the eye rays of each tile of the image can meet.

use std::ops::Range;

use crate::plan::{Candidates, ObjectLists, Size};

/// The tiles of an image and what their eye rays can meet.
#[derive(Debug)]
pub struct Tiles {
    size: Size,
    everything: ObjectLists,
}

impl Tiles {
    /// Makes one tile that sees everything.
    pub(super) fn of_everything(size: Size, everything: ObjectLists) -> Self {
        Self { size, everything }
    }

    /// Returns the columns of a tile, a multiple of 8.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.size.width().next_multiple_of(8)
    }

    /// Returns the rows of a tile, a power of two.
    #[must_use]
    pub fn height(&self) -> u32 {
        16
    }

    /// Returns what the eye rays through the samples of a pixel's tile can meet.
    #[must_use]
    pub fn candidates(&self, column: u32, row: u32) -> Candidates<'_> {
        debug_assert!(column < self.size.width() && row < self.size.height());
        self.everything.as_candidates()
    }

    /// Tells whether the eye rays of all these rows are proved to meet nothing.
    #[must_use]
    pub fn are_empty(&self, rows: Range<u32>) -> bool {
        debug_assert!(rows.end <= self.size.height());
        self.everything.as_candidates().is_empty()
    }
}
