//! Who makes the rows of an image.

use std::ops::Range;

use crate::exec::exactly::Exactly;
use crate::trace::{Counts, Tracer};

/// Makes the rows of an image.
#[derive(Debug)]
pub(super) enum Painter<'a, 'p> {
    /// The tracer.
    Traced(Box<Tracer<'a>>),
    /// `exact`, every pixel.
    Exact(&'a Exactly<'p>),
}

impl Painter<'_, '_> {
    /// Returns the colour that all pixels of these rows are proved to have, if that is known without making them.
    pub fn uniform_rows(&self, rows: Range<u32>) -> Option<[u8; 3]> {
        match self {
            Self::Traced(tracer) => tracer.uniform_rows(rows),
            Self::Exact(_) => None,
        }
    }

    /// Renders rows on the calling thread, or on all if `exact` does it.
    pub fn render_band(&self, rows: Range<u32>, rgb: &mut [u8], is_cancelled: &(dyn Fn() -> bool + Sync)) -> Counts {
        match self {
            Self::Traced(tracer) => tracer.render_band(rows, rgb, is_cancelled),
            Self::Exact(exactly) => exactly.render_rows(rows, rgb, is_cancelled),
        }
    }

    /// Renders rows on all threads of the current rayon pool.
    pub fn render_rows(&self, rows: Range<u32>, rgb: &mut [u8], is_cancelled: &(dyn Fn() -> bool + Sync)) -> Counts {
        match self {
            Self::Traced(tracer) => tracer.render_rows_unless(rows, rgb, is_cancelled),
            Self::Exact(exactly) => exactly.render_rows(rows, rgb, is_cancelled),
        }
    }

    /// Tells whether a band is so much work that threads had better share it.
    pub fn is_slow(&self) -> bool {
        matches!(self, Self::Exact(_))
    }
}
