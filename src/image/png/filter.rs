//! What a row differs in from what its neighbours let expect.
//!
//! A block is 64 bytes of a row. It is given with the pixel left of it, since a byte is predicted of the one three bytes
//! before. The loops have no branch, so that the compiler makes 16 bytes of one.

/// The bytes that are filtered at a time.
pub(super) const BLOCK: usize = 64;

/// Bytes of a pixel.
pub(super) const PIXEL: usize = 3;

/// The bytes of a block and of the pixel left of it.
pub(super) const WINDOW: usize = PIXEL + BLOCK;

/// A filter of PNG (PNG specification, section 9).
pub(super) trait Filter {
    /// Its number, which stands in front of each row.
    const TYPE: u8;

    /// Returns what is left of the first pixel of a row.
    fn first(row: [u8; PIXEL], above: [u8; PIXEL]) -> [u8; PIXEL];

    /// Returns what is left of a block; `None` when all of it is 0, as far as that is seen at a glance.
    fn block(row: &[u8; WINDOW], above: &[u8; WINDOW]) -> Option<[u8; BLOCK]>;
}

/// Predicts the pixel to the left; for the first row of a band, which knows no row above.
pub(super) struct Sub;

impl Filter for Sub {
    const TYPE: u8 = 1;

    #[inline(always)]
    fn first(row: [u8; PIXEL], _: [u8; PIXEL]) -> [u8; PIXEL] {
        row
    }

    #[inline(always)]
    fn block(row: &[u8; WINDOW], _: &[u8; WINDOW]) -> Option<[u8; BLOCK]> {
        let (left, here) = (&row[..BLOCK], &row[PIXEL..]);
        (left != here).then(|| std::array::from_fn(|i| here[i].wrapping_sub(left[i])))
    }
}

/// Predicts the neighbour, left, above or left above, that is nearest to left + above − left above.
pub(super) struct Paeth;

impl Filter for Paeth {
    const TYPE: u8 = 4;

    #[inline(always)]
    fn first(row: [u8; PIXEL], above: [u8; PIXEL]) -> [u8; PIXEL] {
        std::array::from_fn(|i| row[i].wrapping_sub(above[i]))
    }

    /// Where a row equals the one above, also to the left, the prediction is right: the pixel above is taken.
    #[inline(always)]
    fn block(row: &[u8; WINDOW], above: &[u8; WINDOW]) -> Option<[u8; BLOCK]> {
        if is_equal(row, above) {
            return None;
        }
        Some(std::array::from_fn(|i| row[i + PIXEL].wrapping_sub(predict(row[i], above[i + PIXEL], above[i]))))
    }
}

/// Compares without a call, which a comparison of arrays of this length would be.
#[inline(always)]
fn is_equal(a: &[u8; WINDOW], b: &[u8; WINDOW]) -> bool {
    let word = |bytes: &[u8]| u64::from_le_bytes(*bytes.first_chunk().expect("eight bytes"));
    let differing = |at: usize| word(&a[at..]) ^ word(&b[at..]);
    (0..BLOCK / 8).map(|idx| differing(idx * 8)).fold(differing(WINDOW - 8), |all, word| all | word) == 0
}

/// Predicts by Paeth: of `left`, `above` and `corner` the nearest to left + above − corner, the first of equals.
///
/// With the corner outside the two, that is the one farther from it. Else the distances of `left` and `above` from the
/// estimate, |above − corner| and |left − corner|, add up to that of the two, and the corner's is their difference. All
/// of this fits in 8 bits, unlike the estimate.
#[inline(always)]
fn predict(left: u8, above: u8, corner: u8) -> u8 {
    let (low, high) = (left.min(above), left.max(above));
    let of_left = above.abs_diff(corner);
    let of_above = left.abs_diff(corner);
    let within = if of_left.saturating_add(of_left) <= of_above {
        left
    } else if of_above.saturating_add(of_above) <= of_left {
        above
    } else {
        corner
    };
    if corner >= high {
        low
    } else if corner <= low {
        high
    } else {
        within
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_prediction_is_that_of_the_specification() {
        for (left, above, corner) in (0..1 << 24).map(|i: u32| ((i >> 16) as u8, (i >> 8) as u8, i as u8)) {
            let [a, b, c] = [left, above, corner].map(i32::from);
            let [pa, pb, pc] = [a, b, c].map(|x| (a + b - c - x).abs());
            let expected = if pa <= pb && pa <= pc {
                left
            } else if pb <= pc {
                above
            } else {
                corner
            };
            assert_eq!(predict(left, above, corner), expected, "{left} {above} {corner}");
        }
    }
}
