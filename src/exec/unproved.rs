//! The pixels of an image that are not proved.

use crate::trace::Place;

/// Pixels that have their best value, because nothing was proved of them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Unproved {
    /// How many there are.
    pub n_pixels: u64,
    /// The first of them, row by row from the top, at most [`Unproved::MAX_LISTED`]; none in f32 and f64.
    pub listed: Vec<Place>,
}

impl Unproved {
    /// The most pixels that are listed: memory does not grow with the image.
    pub const MAX_LISTED: usize = 10_000;

    /// Counts so many without a list.
    pub(super) fn unlisted(n_pixels: u64) -> Self {
        Self { n_pixels, listed: Vec::new() }
    }

    /// Adds a pixel.
    pub(super) fn add(&mut self, place: Place) {
        self.n_pixels += 1;
        self.listed.push(place);
        if self.listed.len() >= 2 * Self::MAX_LISTED {
            self.sort();
        }
    }

    /// Puts the list in order, and keeps its first places.
    pub(super) fn sort(&mut self) {
        self.listed.sort_unstable();
        self.listed.truncate(Self::MAX_LISTED);
    }
}
