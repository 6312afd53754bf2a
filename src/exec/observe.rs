//! What an execution tells while it runs.

use std::time::Duration;

use crate::exec::{Proof, Unproved};
use crate::plan::{Precision, Savings, Size};
use crate::trace::{Counts, Spared};

/// Watches an execution. Any thread of the pool may call it, but events come one at a time and in order; `()` watches
/// nothing.
pub trait Observer: Sync {
    /// Is told what happened.
    fn event(&self, event: &Event<'_>) {
        let _ = event;
    }

    /// Returns the time since a fixed moment; the library has no clock of its own, so by default it stands still.
    fn now(&self) -> Duration {
        Duration::ZERO
    }
}

impl Observer for () {}

/// Something that happened.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Event<'a> {
    /// A `write` begins.
    Started {
        /// Which `write` of the program it is, from 0.
        write_idx: usize,
        /// The name as in the source.
        name: &'a str,
        /// Pixels of the image.
        size: Size,
    },
    /// Some more rows have been traced.
    RowsDone {
        /// Which `write` of the program it is, from 0.
        write_idx: usize,
        /// The rows traced so far, from the top.
        n_rows: u32,
    },
    /// The image is saved.
    Finished(&'a WriteReport),
}

/// Where the pixels of an image come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Origin {
    /// All are traced.
    Traced,
    /// All are those of an earlier `write`, whose file is copied.
    CopiedFrom {
        /// Which `write` of the program it is, from 0.
        write_idx: usize,
    },
    /// Some are those of an earlier `write`, the others are traced.
    SharedWith {
        /// Which `write` of the program it is, from 0.
        write_idx: usize,
        /// Tiles that are traced.
        n_traced_tiles: usize,
        /// All tiles.
        n_tiles: usize,
        /// Pixels that are not traced.
        n_shared_pixels: u64,
    },
}

/// What a `write` made and what it took.
#[derive(Clone, Debug, PartialEq)]
pub struct WriteReport {
    /// Which `write` of the program it is, from 0.
    pub write_idx: usize,
    /// The name as in the source.
    pub name: String,
    /// Pixels of the image.
    pub size: Size,
    /// The arithmetic that was asked for.
    pub precision: Precision,
    /// Length of the file.
    pub n_bytes: u64,
    /// The colour of all its pixels, if they have one.
    pub color: Option<[u8; 3]>,
    /// Where its pixels come from.
    pub origin: Origin,
    /// What its plan leaves out before any ray is cast.
    pub savings: Savings,
    /// What was left out as it was traced.
    pub spared: Spared,
    /// Rays and tests.
    pub counts: Counts,
    /// What stands behind its pixels, where everything is proved.
    pub proof: Option<Proof>,
    /// Its pixels that have their best value and no proof, those with open ties apart.
    pub unproved: Unproved,
    /// CRC-32 of the file, where everything is proved.
    pub crc32: Option<u32>,
    /// Time that threads spent tracing, added up. While they share rows each is counted from the beginning to the end.
    pub trace_time: Duration,
    /// Time that threads spent encoding and writing, added up.
    pub encode_time: Duration,
    /// Time spent giving the file its name.
    pub save_time: Duration,
    /// Time from beginning to end.
    pub total_time: Duration,
}

impl WriteReport {
    /// Returns the number of pixels of the image.
    #[must_use]
    pub fn n_pixels(&self) -> u64 {
        u64::from(self.size.width()) * u64::from(self.size.height())
    }

    /// Returns how many pixels are not proved: those that have their best value, and those with open ties.
    #[must_use]
    pub fn n_unproved(&self) -> u64 {
        self.unproved.n_pixels + self.proof.as_ref().map_or(0, |proof| proof.exact.n_open_pixels)
    }
}
