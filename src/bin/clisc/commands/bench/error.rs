//! How far an image is from the right one.

use clisc::trace::Unrounded;
use serde::Serialize;

/// Differences of channels, in levels of 1/255.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Errors {
    /// Channels whose bytes differ.
    pub wrong_channels: u64,
    /// The most levels by which a byte differs.
    pub largest_levels: u8,
    /// The mean difference of all bytes.
    pub mean_levels: f64,
    /// Before rounding: the largest difference; `None` where it is not measured.
    pub largest_unrounded: Option<f64>,
    /// Before rounding: the mean difference.
    pub mean_unrounded: Option<f64>,
}

impl Errors {
    /// Compares the bytes of two images of one size.
    pub fn of_bytes(actual: &[u8], expected: &[u8]) -> Self {
        assert_eq!(actual.len(), expected.len(), "images of one size");
        let (mut wrong, mut largest, mut sum) = (0, 0, 0);
        for (a, e) in actual.iter().zip(expected) {
            let off = a.abs_diff(*e);
            wrong += u64::from(off > 0);
            largest = largest.max(off);
            sum += u64::from(off);
        }
        Self {
            wrong_channels: wrong,
            largest_levels: largest,
            mean_levels: sum as f64 / actual.len() as f64,
            largest_unrounded: None,
            mean_unrounded: None,
        }
    }

    /// Compares the bytes of an image, and what they were rounded from.
    pub fn of_unrounded(actual: &Unrounded, expected: &Unrounded) -> Self {
        let (mut largest, mut sum) = (0.0_f64, 0.0);
        for (a, e) in actual.levels.as_flattened().iter().zip(expected.levels.as_flattened()) {
            let off = (a - e).abs();
            largest = largest.max(off);
            sum += off;
        }
        let n_channels = expected.levels.as_flattened().len() as f64;
        Self {
            largest_unrounded: Some(largest),
            mean_unrounded: Some(sum / n_channels),
            ..Self::of_bytes(actual.rgb.as_flattened(), expected.rgb.as_flattened())
        }
    }

    /// Returns the error that a plot shows: the mean before rounding, or else that of the bytes.
    pub fn shown(&self) -> f64 {
        self.mean_unrounded.unwrap_or(self.mean_levels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_compared_channel_by_channel() {
        let errors = Errors::of_bytes(&[0, 10, 255, 7], &[0, 12, 250, 7]);
        assert_eq!((errors.wrong_channels, errors.largest_levels, errors.mean_levels), (2, 5, 1.75));
        assert_eq!((errors.largest_unrounded, errors.shown()), (None, 1.75));
    }

    #[test]
    fn what_rounding_hides_is_measured() {
        let image = |level: f64| Unrounded { rgb: vec![[1, 2, 3]], levels: vec![[1.5, level, 3.0]] };
        let errors = Errors::of_unrounded(&image(2.5), &image(2.25));
        assert_eq!(errors.wrong_channels, 0);
        assert_eq!((errors.largest_unrounded, errors.mean_unrounded), (Some(0.25), Some(0.25 / 3.0)));
    }
}
