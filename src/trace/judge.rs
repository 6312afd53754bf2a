//! Who decides a comparison, and what happens when nobody can.

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
    /// Whether what cannot be decided is a tie, because there is no finer arithmetic to ask.
    pub takes_ties: bool,
}

impl Judge {
    /// Compares a number with 0.
    ///
    /// What cannot be decided, where there is no finer arithmetic, is a tie and counts as equal. The semantics say what equality means at
    /// every comparison: a tangent ray and a rim are met, a root at 0 and a light at the distance of a surface are not, of
    /// hits at equal t the first declared is met.
    ///
    /// # Errors
    /// [`Doubt`] when the bounds allow several answers and ties are not taken.
    #[inline]
    pub fn compare_zero<R: Real>(&mut self, number: R) -> Result<Ordering, Doubt> {
        match number.sign() {
            Sign::Negative => Ok(Ordering::Less),
            Sign::Zero => Ok(Ordering::Equal),
            Sign::Positive => Ok(Ordering::Greater),
            Sign::Unknown if self.takes_ties => {
                self.counts.ties += 1;
                Ok(Ordering::Equal)
            }
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
        if number.sign() == Sign::Unknown && is_zero() {
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

    /// Returns ⌊number⌋; at a tie that of the middle.
    ///
    /// # Errors
    /// As [`Judge::compare_zero`].
    pub fn floor<R: Real>(&mut self, number: R) -> Result<f64, Doubt> {
        match number.floor() {
            Some(floor) => Ok(floor),
            None if self.takes_ties => {
                self.counts.ties += 1;
                Ok(number.value().floor())
            }
            None => Err(Doubt),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Ball64;

    #[test]
    fn a_floor_in_doubt_is_that_of_the_middle_where_ties_are_taken() {
        // Three thirds may lie on either side of 1.
        let third = Ball64::exact(1.0) / Ball64::exact(3.0);
        let in_doubt = third + third + third;
        for takes_ties in [false, true] {
            let mut judge = Judge { takes_ties, ..Judge::default() };
            assert_eq!(judge.floor(Ball64::exact(1.5)), Ok(1.0));
            assert_eq!(judge.counts.ties, 0);
            let expected = if takes_ties { Ok(in_doubt.value().floor()) } else { Err(Doubt) };
            assert_eq!(judge.floor(in_doubt), expected);
            assert_eq!(judge.counts.ties, u64::from(takes_ties));
        }
    }

    #[test]
    fn the_largest_bound_is_that_of_channels_that_were_rounded() {
        let mut judge = Judge::default();
        [1e-9, 1e-7, 0.5, 1e-8].into_iter().for_each(|error| judge.note_bound(error));
        assert!((judge.counts.largest_bound - 1e-7).abs() < 1e-20);
    }
}
