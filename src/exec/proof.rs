//! What stands behind the pixels of an image: the facts of its certificate.

use crate::exact::Record;
use crate::exec::{Origin, WriteReport};
use crate::plan::Precision;

/// How the pixels of an image of [`Precision::Certified`] or [`Precision::Exact`] were settled. The numbers of pixels add
/// up to the image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Proof {
    /// Pixels that binary64 and its bounds proved, or the plan before any ray was cast.
    pub n_binary64: u64,
    /// Pixels that double-double and its bounds proved.
    pub n_double_double: u64,
    /// Pixels that long numbers of up to 1024 bits and their bounds proved.
    pub n_long: u64,
    /// Pixels that arbitrary precision made, by their bits, and all ties: every pixel but those with open ties is proved.
    pub exact: Record,
    /// Pixels whose exact work was more than there may be: they have their best values.
    pub n_beyond_limit: u64,
    /// Pixels taken from an earlier image of the same program, whose proof holds for them; their ties are listed here too.
    pub n_shared: u64,
    /// The largest bound on the error of a channel that was rounded, in levels: of 255 c. What a channel loses by being
    /// clamped for sure does not count.
    pub largest_bound: f64,
}

impl Proof {
    /// Makes the proof of an image that was rendered; `None` where not every pixel is to be proved.
    pub(super) fn new(precision: Precision, report: &WriteReport, exact: Record) -> Option<Self> {
        if !precision.is_proved() {
            return None;
        }
        let n_shared = match report.origin {
            Origin::SharedWith { n_shared_pixels, .. } => n_shared_pixels,
            Origin::Traced | Origin::CopiedFrom { .. } => 0,
        };
        let n_double_double = report.counts.refined_pixels;
        let n_long = report.counts.long_pixels;
        let n_beyond_limit = report.unproved.n_pixels;
        Some(Self {
            n_binary64: report.n_pixels() - n_shared - n_double_double - n_long - exact.n_pixels() - n_beyond_limit,
            n_double_double,
            n_long,
            n_beyond_limit,
            largest_bound: exact.largest_error.max(report.counts.largest_bound),
            exact,
            n_shared,
        })
    }

    /// Tells whether every pixel is proved: no tie is open, and none took more work than it may.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.exact.n_open_pixels == 0 && self.n_beyond_limit == 0
    }
}
