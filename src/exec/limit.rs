//! How much work in arbitrary precision an image may take.

use crate::plan::{ExactWork, Precision, Settings};

/// How much work in arbitrary precision an image may take.
///
/// Each pixel takes what it takes ([`Pixel::work`](crate::exact::Pixel::work)), counted and not timed. It is spent in the order
/// of the pixels, row by row from the top, so which pixels are settled depends on the scene and on what is asked for, not on
/// threads, machine or time: see [`Budget`](crate::exec::budget::Budget).
///
/// What is asked for includes the passes of the plan: without one a ray is tested against more objects, and where it nearly
/// meets one that the plan leaves out, a pixel may be left open that is not with it. So in an image beyond the limit a pixel may
/// be proved with a pass and not without.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Limit {
    /// The most work for the image.
    pub max: u64,
    /// The most work for a pixel: one alone does not take what many others could be settled with.
    pub max_a_pixel: u64,
}

impl Limit {
    /// Work for each row and each column of samples: that of some ties that algebra proves, or of one that takes every bit.
    /// Ties lie along lines of an image, as a rule, and those are settled. Only in scenes made for it do they fill areas.
    const WORK_A_LINE: u64 = 1 << 16;

    /// What every image may take: a second or two of one core.
    const MIN_WORK: u64 = 1 << 25;

    /// The share of the work for an image that a pixel may take.
    const PIXELS: u64 = 4;

    /// As much as it takes.
    pub const NONE: Self = Self { max: u64::MAX, max_a_pixel: u64::MAX };

    /// Makes the limit that the settings ask for.
    pub fn new(settings: &Settings) -> Self {
        match (settings.precision, settings.exact_work) {
            (Precision::Certified, ExactWork::Limited) => {
                let n_lines = u64::from(settings.samples) * u64::from(settings.size.width() + settings.size.height());
                Self::of(Self::MIN_WORK.max(n_lines * Self::WORK_A_LINE))
            }
            (_, _) => Self::NONE,
        }
    }

    /// Makes a limit.
    pub fn of(max: u64) -> Self {
        Self { max, max_a_pixel: max / Self::PIXELS }
    }
}
