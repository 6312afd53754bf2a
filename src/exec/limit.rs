//! How much work in arbitrary precision an image may take.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::plan::{ExactWork, Precision, Settings};

/// How much work in arbitrary precision an image may take, and how much there was.
///
/// Each pixel takes what it takes ([`Pixel::work`](crate::exact::Pixel::work)), and the sum over an image does not depend on the
/// order in which they are made, nor on threads, machine or time. So whether it passes the limit is a matter of the scene and
/// of what is asked for. Nothing is decided by the clock.
///
/// What is asked for includes the passes of the plan: without one a ray is tested against more objects, and where it nearly
/// meets one that the plan leaves out, a pixel may be left open that is not with it. So an image near the limit may be within
/// it with a pass and beyond it without. Each of its pixels is right either way, as far as the arithmetic that is named says.
#[derive(Debug)]
pub(super) struct Limit {
    max: u64,
    spent: AtomicU64,
}

impl Limit {
    /// Work for each row and each column of samples: that of some ties that algebra proves, or of one that takes every bit.
    /// Ties lie along lines of an image, as a rule, and those are settled. Only in scenes made for it do they fill areas.
    const WORK_A_LINE: u64 = 1 << 16;

    /// What every image may take: a second or two of one core.
    const MIN_WORK: u64 = 1 << 25;

    /// What every sample takes at least.
    const WORK_A_SAMPLE: u64 = 256;

    /// Makes the limit that the settings ask for.
    pub fn new(settings: &Settings) -> Self {
        match (settings.precision, settings.exact_work) {
            (Precision::Certified, ExactWork::Limited) => {
                let n_lines = u64::from(settings.samples) * u64::from(settings.size.width() + settings.size.height());
                Self { max: Self::MIN_WORK.max(n_lines * Self::WORK_A_LINE), spent: AtomicU64::new(0) }
            }
            (_, _) => Self::none(),
        }
    }

    /// Makes one that is never passed.
    pub fn none() -> Self {
        Self { max: u64::MAX, spent: AtomicU64::new(0) }
    }

    /// Tells whether there was more work than there may be.
    pub fn is_passed(&self) -> bool {
        self.spent.load(Ordering::Relaxed) > self.max
    }

    /// Tells of work that was done.
    pub fn spend(&self, work: u64) {
        // 2⁶⁴ units are thousands of years, so this does not wrap round.
        self.spent.fetch_add(work, Ordering::Relaxed);
    }

    /// Tells that every pixel of an image will be made. What that takes at least need not be done to know that it is too much.
    pub fn expect_all(&self, settings: &Settings) {
        let n_samples = |pixels: u32| u64::from(pixels) * u64::from(settings.samples);
        let least = n_samples(settings.size.width()).saturating_mul(n_samples(settings.size.height()));
        if least.saturating_mul(Self::WORK_A_SAMPLE) > self.max {
            self.spend(self.max.saturating_add(1));
        }
    }
}
