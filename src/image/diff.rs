//! How far two images differ.

use std::ops::Range;

use crate::image::RgbImage;

/// The difference-image value of the smallest difference, so that one step in 255 can be seen.
const FAINTEST: u32 = 64;

/// How far an image differs from the one expected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Difference {
    /// Pixels compared.
    pub n_pixels: u64,
    /// Pixels of which some channel differs.
    pub n_differing: u64,
    /// The largest difference of a channel.
    pub max_channel: u8,
    /// The first of the pixels with that difference; absent when the images are equal.
    pub worst: Option<WorstPixel>,
}

/// The pixel that differs most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorstPixel {
    /// Column from the left, from 0.
    pub column: u32,
    /// Row from the top, from 0.
    pub row: u32,
    /// Its red, green and blue in the image.
    pub actual: [u8; 3],
    /// Those expected.
    pub expected: [u8; 3],
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} of {} pixels differ", self.n_differing, self.n_pixels)?;
        let Some(WorstPixel { column, row, actual, expected }) = self.worst else { return Ok(()) };
        let max = self.max_channel;
        write!(f, ", by {max} at most: column {column}, row {row} is {actual:?}, expected {expected:?}")
    }
}

/// Two images of different size, which cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SizeMismatch {
    /// Columns and rows of the image.
    pub actual: (u32, u32),
    /// Those expected.
    pub expected: (u32, u32),
}

impl std::fmt::Display for SizeMismatch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ((w, h), (expected_w, expected_h)) = (self.actual, self.expected);
        write!(f, "the image is {w}x{h}, expected {expected_w}x{expected_h}")
    }
}

impl std::error::Error for SizeMismatch {}

/// Measures how far `actual` differs from `expected`.
///
/// # Errors
/// When their sizes differ.
pub fn compare(actual: &RgbImage, expected: &RgbImage) -> Result<Difference, SizeMismatch> {
    compare_rows(actual, expected, 0..expected.height())
}

/// Measures how far some rows of `actual` differ from those of `expected`; rows beyond the image are left out.
///
/// # Errors
/// When the sizes of the images differ.
pub fn compare_rows(actual: &RgbImage, expected: &RgbImage, rows: Range<u32>) -> Result<Difference, SizeMismatch> {
    check_sizes(actual, expected)?;
    let mut found = Difference::default();
    for row in rows.start..rows.end.min(expected.height()) {
        for column in 0..expected.width() {
            let (a, e) = (actual.pixel(column, row), expected.pixel(column, row));
            let difference = max_difference(a, e);
            found.n_pixels += 1;
            found.n_differing += u64::from(difference > 0);
            if difference > found.max_channel {
                found.max_channel = difference;
                found.worst = Some(WorstPixel { column, row, actual: a, expected: e });
            }
        }
    }
    Ok(found)
}

/// Draws where two images differ: black where they are equal, else brighter the more a channel differs.
///
/// # Errors
/// When their sizes differ.
pub fn difference_image(actual: &RgbImage, expected: &RgbImage) -> Result<RgbImage, SizeMismatch> {
    check_sizes(actual, expected)?;
    let mut drawn = RgbImage::new(expected.width(), expected.height());
    let pairs = actual.rgb().iter().zip(expected.rgb());
    for (byte, (a, e)) in drawn.rgb_mut().iter_mut().zip(pairs) {
        *byte = match a.abs_diff(*e) {
            0 => 0,
            difference => (FAINTEST + u32::from(difference) * (255 - FAINTEST) / 255) as u8,
        };
    }
    Ok(drawn)
}

fn check_sizes(actual: &RgbImage, expected: &RgbImage) -> Result<(), SizeMismatch> {
    let sizes = [actual, expected].map(|image| (image.width(), image.height()));
    let [actual, expected] = sizes;
    if actual == expected { Ok(()) } else { Err(SizeMismatch { actual, expected }) }
}

fn max_difference(a: [u8; 3], b: [u8; 3]) -> u8 {
    a[0].abs_diff(b[0]).max(a[1].abs_diff(b[1])).max(a[2].abs_diff(b[2]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(rgb: &[u8]) -> RgbImage {
        RgbImage::from_rgb(2, 2, rgb.to_vec()).unwrap()
    }

    const EXPECTED: [u8; 12] = [0, 0, 0, 10, 20, 30, 255, 255, 255, 1, 2, 3];

    #[test]
    fn equal_images_do_not_differ() {
        let found = compare(&image(&EXPECTED), &image(&EXPECTED)).unwrap();
        assert_eq!(found, Difference { n_pixels: 4, ..Difference::default() });
        assert_eq!(found.to_string(), "0 of 4 pixels differ");
    }

    #[test]
    fn the_worst_pixel_is_named() {
        let actual = image(&[0, 0, 1, 10, 20, 30, 255, 250, 255, 1, 2, 8]);
        let found = compare(&actual, &image(&EXPECTED)).unwrap();
        let worst = WorstPixel { column: 0, row: 1, actual: [255, 250, 255], expected: [255; 3] };
        assert_eq!(found, Difference { n_pixels: 4, n_differing: 3, max_channel: 5, worst: Some(worst) });
        let words = "3 of 4 pixels differ, by 5 at most: column 0, row 1 is [255, 250, 255], expected [255, 255, 255]";
        assert_eq!(found.to_string(), words);
    }

    #[test]
    fn rows_can_be_left_out() {
        let mut rgb = EXPECTED;
        rgb[0] = 9;
        let (actual, expected) = (image(&rgb), image(&EXPECTED));
        assert_eq!(compare(&actual, &expected).unwrap().n_differing, 1);
        let found = compare_rows(&actual, &expected, 1..9).unwrap();
        assert_eq!((found.n_pixels, found.n_differing), (2, 0));
    }

    #[test]
    fn other_sizes_are_an_error() {
        let wide = RgbImage::new(4, 1);
        let mismatch = SizeMismatch { actual: (4, 1), expected: (2, 2) };
        assert_eq!(compare(&wide, &image(&EXPECTED)), Err(mismatch));
        assert!(difference_image(&wide, &image(&EXPECTED)).is_err());
        assert_eq!(mismatch.to_string(), "the image is 4x1, expected 2x2");
    }

    #[test]
    fn a_difference_image_shows_one_step() {
        let mut rgb = EXPECTED;
        rgb[4] += 1;
        rgb[6] = 0;
        let drawn = difference_image(&image(&rgb), &image(&EXPECTED)).unwrap();
        assert_eq!(drawn.rgb(), [0, 0, 0, 0, 64, 0, 255, 0, 0, 0, 0, 0]);
    }
}
