//! Who decides a comparison, and says so when bounds leave it open.

use std::cmp::Ordering;

use crate::math::{Real, Sign};
use crate::trace::Counts;
use crate::trace::touch::{Touch, Touches};

/// A comparison that lies within the error bounds: a finer arithmetic has to be asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Doubt;

/// Decides comparisons and keeps the counts.
#[derive(Debug, Default)]
pub struct Judge {
    /// What has been done so far.
    pub counts: Counts,
    /// What was proved equal for the pixel at hand where bounds left it open.
    pub touches: Touches,
    /// Whether algebra is asked of every number that it knows of, because the bounds are none.
    pub asks_algebra: bool,
}

impl Judge {
    /// Compares a number with 0. The semantics say what equality means at every comparison: a tangent ray and a rim are met, a
    /// root at 0 and a light at the distance of a surface are not, of hits at equal t the first declared is met.
    ///
    /// # Errors
    /// [`Doubt`] when the bounds allow several answers.
    #[inline]
    pub fn compare_zero<R: Real>(&mut self, number: R) -> Result<Ordering, Doubt> {
        match number.sign() {
            Sign::Negative => Ok(Ordering::Less),
            Sign::Zero => Ok(Ordering::Equal),
            Sign::Positive => Ok(Ordering::Greater),
            Sign::Unknown => Err(Doubt),
        }
    }

    /// Compares a number with 0 as [`Judge::compare_zero`] does, but where the bounds leave it open asks `is_zero` whether it is
    /// known to be 0: that is no tie that is taken, but one that is proved.
    ///
    /// # Errors
    /// As [`Judge::compare_zero`].
    #[inline]
    pub fn compare_zero_asking<R: Real>(
        &mut self,
        number: R,
        touch: Touch,
        is_zero: impl FnOnce() -> bool,
    ) -> Result<Ordering, Doubt> {
        if (self.asks_algebra || number.sign() == Sign::Unknown) && is_zero() {
            self.touches.count(touch);
            return Ok(Ordering::Equal);
        }
        self.compare_zero(number)
    }

    /// Tells whether a number is above 0; a tie is not.
    ///
    /// # Errors
    /// As [`Judge::compare_zero`].
    #[inline]
    pub fn is_positive<R: Real>(&mut self, number: R) -> Result<bool, Doubt> {
        Ok(self.compare_zero(number)?.is_gt())
    }

    /// Notes the bound of a channel that was rounded; one of half a level or more has been clamped for sure.
    pub fn note_bound(&mut self, error: f64) {
        if error < 0.5 {
            self.counts.largest_bound = self.counts.largest_bound.max(error);
        }
    }

    /// Returns ⌊number⌋.
    ///
    /// # Errors
    /// [`Doubt`] when the bounds allow several answers.
    pub fn floor<R: Real>(&mut self, number: R) -> Result<f64, Doubt> {
        number.floor().ok_or(Doubt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Ball64;

    #[test]
    fn what_may_lie_on_either_side_is_in_doubt() {
        let third = Ball64::exact(1.0) / Ball64::exact(3.0);
        let in_doubt = third + third + third;
        let mut judge = Judge::default();
        assert_eq!((judge.floor(Ball64::exact(1.5)), judge.floor(in_doubt)), (Ok(1.0), Err(Doubt)));
        assert_eq!(judge.compare_zero(in_doubt - Ball64::exact(1.0)), Err(Doubt));
    }

    #[test]
    fn algebra_is_asked_in_doubt_alone_where_there_are_bounds() {
        for (asks_algebra, expected) in [(false, Ordering::Greater), (true, Ordering::Equal)] {
            let mut judge = Judge { asks_algebra, ..Judge::default() };
            assert_eq!(judge.compare_zero_asking(Ball64::exact(1.0), Touch::Rim, || true), Ok(expected));
        }
    }

    #[test]
    fn the_largest_bound_is_that_of_channels_that_were_rounded() {
        let mut judge = Judge::default();
        [1e-9, 1e-7, 0.5, 1e-8].into_iter().for_each(|error| judge.note_bound(error));
        assert!((judge.counts.largest_bound - 1e-7).abs() < 1e-20);
    }
}
