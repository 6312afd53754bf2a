//! Who makes the rows of an image.

use std::ops::Range;

use crate::exec::exactly::Exactly;
use crate::trace::{Counts, Tracer};

/// Makes the rows of an image.
#[derive(Debug)]
pub(super) enum Painter<'a, 'p> {
    /// The tracer, with what settles the pixels that it leaves open.
    Traced(Box<Tracer<'a>>, &'a Exactly<'p>),
    /// `exact`, every pixel.
    Exact(&'a Exactly<'p>),
}

impl<'p> Painter<'_, 'p> {
    /// Returns the colour that all pixels of these rows are proved to have, if that is known without making them.
    pub fn uniform_rows(&self, rows: Range<u32>) -> Option<[u8; 3]> {
        match self {
            Self::Traced(tracer, _) => tracer.uniform_rows(rows),
            Self::Exact(_) => None,
        }
    }

    /// Renders rows on the calling thread, or on all if `exact` does it.
    pub fn render_band(&self, rows: Range<u32>, rgb: &mut [u8], is_cancelled: &(dyn Fn() -> bool + Sync)) -> Counts {
        match self {
            Self::Traced(tracer, _) => tracer.render_band(rows, rgb, is_cancelled),
            Self::Exact(exactly) => exactly.render_rows(rows, rgb, is_cancelled),
        }
    }

    /// Renders rows on all threads of the current rayon pool.
    pub fn render_rows(&self, rows: Range<u32>, rgb: &mut [u8], is_cancelled: &(dyn Fn() -> bool + Sync)) -> Counts {
        match self {
            Self::Traced(tracer, _) => tracer.render_rows_unless(rows, rgb, is_cancelled),
            Self::Exact(exactly) => exactly.render_rows(rows, rgb, is_cancelled),
        }
    }

    /// Tells whether pixels of some rows may have to be taken back once all above is known.
    pub fn has_pending(&self, rows: &Range<u32>) -> bool {
        self.exactly().has_pending(rows)
    }

    /// Takes back the pixels of some rows that were made and are more exact work than there may be; they get their best
    /// values. All rows above are closed. Tells whether there are any.
    ///
    /// `rgb`: the pixels of these rows, made.
    pub fn close(&self, rows: &Range<u32>, rgb: &mut [u8], counts: &mut Counts) -> bool {
        let taken_back = self.exactly().close(rows);
        for &place in &taken_back {
            counts.unproved_pixels += 1;
            match self {
                Self::Traced(tracer, _) => tracer.take_back(place, rows, rgb, counts),
                Self::Exact(exactly) => exactly.take_back(place, rows, rgb, counts),
            }
        }
        !taken_back.is_empty()
    }

    fn exactly(&self) -> &Exactly<'p> {
        match self {
            Self::Traced(_, exactly) | Self::Exact(exactly) => exactly,
        }
    }

    /// Tells whether a band is so much work that threads had better share it.
    pub fn is_slow(&self) -> bool {
        matches!(self, Self::Exact(_))
    }
}
