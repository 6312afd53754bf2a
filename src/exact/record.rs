//! What was found while pixels were made exactly, or nearly so with ties that are proved.

use std::collections::BTreeMap;

use crate::exact::{Pixel, Tie, Ties};

/// A pixel with ties.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TiePlace {
    /// From the top.
    pub row: u32,
    /// From the left.
    pub column: u32,
    /// What no precision could decide.
    pub open: Ties,
    /// What is proved to be equal: rays that touch what they meet or meet its rim, hits at equal t, and whatever took
    /// algebra. Others that need no rounding are common, as a ray that is level with a cap, and not told.
    pub proved: Ties,
}

impl TiePlace {
    /// Returns what is to be told of a pixel, if it has ties.
    #[must_use]
    pub fn of(column: u32, row: u32, pixel: &Pixel) -> Option<Self> {
        let told = pixel.proved_ties.only(&[Tie::Tangent, Tie::Rim, Tie::Order, Tie::OwnRim]);
        let place = Self { row, column, open: pixel.open_ties, proved: told.plus(&pixel.algebraic_ties) };
        (place.n_ties() > 0).then_some(place)
    }

    /// Returns the number of ties.
    #[must_use]
    pub fn n_ties(&self) -> u32 {
        self.open.total() + self.proved.total()
    }
}

/// What was found while some pixels were made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// The pixels that each precision settled, by its bits.
    pub n_pixels: BTreeMap<usize, u64>,
    /// The pixels with ties, of which some are listed: those that are open, and those that are proved.
    pub n_tied_pixels: u64,
    /// The pixels with open ties: all others are proved.
    pub n_open_pixels: u64,
    /// All ties of both kinds.
    pub n_ties: u64,
    /// The first pixels with ties, row by row from the top, at most [`Record::MAX_LISTED`].
    pub ties: Vec<TiePlace>,
    /// What all of them took: see [`Pixel::work`].
    pub work: u64,
    /// The largest bound on the error of a channel of a pixel without open ties, in levels: of 255 c.
    pub largest_error: f64,
}

impl Record {
    /// The most pixels with ties that are listed: memory does not grow with the image.
    pub const MAX_LISTED: usize = 10_000;

    /// Adds a pixel.
    pub fn add(&mut self, column: u32, row: u32, pixel: &Pixel) {
        *self.n_pixels.entry(pixel.bits).or_default() += 1;
        self.work += pixel.work;
        if pixel.open_ties.total() == 0 {
            self.largest_error = self.largest_error.max(pixel.error);
        } else {
            self.n_open_pixels += 1;
        }
        if let Some(place) = TiePlace::of(column, row, pixel) {
            self.add_ties(place);
        }
    }

    /// Adds the ties of a pixel.
    pub fn add_ties(&mut self, place: TiePlace) {
        self.n_tied_pixels += 1;
        self.n_ties += u64::from(place.n_ties());
        self.ties.push(place);
        if self.ties.len() >= 2 * Self::MAX_LISTED {
            self.keep_first();
        }
    }

    /// Takes two records together; which pixels are listed does not depend on the order.
    #[must_use]
    pub fn merged(mut self, other: Self) -> Self {
        self.merge(other);
        self
    }

    /// Takes in another record, as [`Record::merged`].
    pub fn merge(&mut self, other: Self) {
        for (bits, n_pixels) in other.n_pixels {
            *self.n_pixels.entry(bits).or_default() += n_pixels;
        }
        self.work += other.work;
        self.n_tied_pixels += other.n_tied_pixels;
        self.n_open_pixels += other.n_open_pixels;
        self.n_ties += other.n_ties;
        self.largest_error = self.largest_error.max(other.largest_error);
        self.ties.extend(other.ties);
        self.keep_first();
    }

    /// Tells whether the list of pixels with ties is complete.
    #[must_use]
    pub fn lists_all_ties(&self) -> bool {
        self.n_tied_pixels == self.ties.len() as u64
    }

    /// Returns the record of pixels that another image takes over, of which `is_taken` tells by column and row: their ties
    /// alone, as far as they are listed, for nothing is made anew.
    #[must_use]
    pub fn taken_over(&self, is_taken: impl Fn(u32, u32) -> bool) -> Self {
        let ties: Vec<_> = self.ties.iter().filter(|place| is_taken(place.column, place.row)).copied().collect();
        Self {
            n_tied_pixels: ties.len() as u64,
            n_open_pixels: ties.iter().filter(|place| place.open.total() > 0).count() as u64,
            n_ties: ties.iter().map(|place| u64::from(place.n_ties())).sum(),
            ties,
            ..Self::default()
        }
    }

    /// Returns the number of pixels that were made.
    #[must_use]
    pub fn n_pixels(&self) -> u64 {
        self.n_pixels.values().sum()
    }

    fn keep_first(&mut self) {
        self.ties.sort_unstable_by_key(|place| (place.row, place.column));
        self.ties.truncate(Self::MAX_LISTED);
    }
}
