//! How an image is cut into bands, and one band as a chunk of a PNG file.

use std::io;
use std::ops::Range;

use crate::image::png::adler::Adler32;
use crate::image::png::chunk::push_chunk;
use crate::image::png::deflate::{deflate_rows, deflate_uniform_rows};

/// The rows of a band, as a rule: a tracer works in tiles, and this is a multiple of their height.
const ROWS: u32 = 16;

/// The rows of a band where [`ROWS`] would have more than [`MAX_BYTES`].
const ROWS_OF_WIDE: u32 = 8;

/// The bytes of pixels in a band, so that two fit in the cache of a core.
const MAX_BYTES: u32 = 1 << 20;

/// A band of a narrow image has at least these bytes of pixels, for each band has some 70 bytes of frame and codes.
const MIN_BYTES: u32 = 8 << 10;

/// What begins a zlib stream: deflate with a window of 32 KiB, made in haste.
const ZLIB_HEADER: [u8; 2] = [0x78, 0x01];

/// The bands of an image, each of which can be encoded without the others.
///
/// Where they lie depends on nothing but the size of the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PngBands {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) rows_per_band: u32,
}

/// A band in a PNG file. Its memory is used again when another is encoded into it.
#[derive(Clone, Debug, Default)]
pub struct EncodedBand {
    /// One chunk of the file.
    pub(super) bytes: Vec<u8>,
    /// The checksum of the bytes that it holds.
    pub(super) adler: Adler32,
}

impl PngBands {
    /// The longest side.
    pub const MAX_SIDE: u32 = 1 << 20;

    /// Cuts an image of `width` columns and `height` rows into bands.
    ///
    /// # Errors
    /// When a side is 0 or above [`PngBands::MAX_SIDE`].
    pub fn new(width: u32, height: u32) -> io::Result<Self> {
        let sides = 1..=Self::MAX_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "an image of this size cannot be written"));
        }
        let usual_bytes = width * 3 * ROWS;
        let rows = if usual_bytes > MAX_BYTES { ROWS_OF_WIDE } else { ROWS * MIN_BYTES.div_ceil(usual_bytes) };
        Ok(Self { width, height, rows_per_band: rows.min(height) })
    }

    /// Returns the number of columns of the image.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Returns the number of rows of the image.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Returns the number of bands.
    #[must_use]
    pub fn n_bands(&self) -> u32 {
        self.height.div_ceil(self.rows_per_band)
    }

    /// Returns the most rows that a band has; only the last band has fewer.
    #[must_use]
    pub fn rows_per_band(&self) -> u32 {
        self.rows_per_band
    }

    /// Returns the rows of a band.
    ///
    /// # Panics
    /// When there is no such band.
    #[must_use]
    pub fn rows(&self, band_idx: u32) -> Range<u32> {
        assert!(band_idx < self.n_bands());
        let start = band_idx * self.rows_per_band;
        start..self.height.min(start + self.rows_per_band)
    }

    /// Returns the bytes of the pixels of some rows.
    #[must_use]
    pub fn rgb_bytes(&self, rows: &Range<u32>) -> usize {
        rows.len() * self.width as usize * 3
    }

    /// Encodes a band, 3 bytes a pixel, row by row from the top.
    ///
    /// # Panics
    /// When there is no such band or `rgb` does not hold its pixels.
    pub fn encode(&self, band_idx: u32, rgb: &[u8], encoded: &mut EncodedBand) {
        assert_eq!(rgb.len(), self.rgb_bytes(&self.rows(band_idx)), "the pixels of the band");
        if let Some(color) = uniform_color(rgb) {
            return self.encode_uniform(band_idx, color, encoded);
        }
        encoded.fill(band_idx, |out| deflate_rows(self.width as usize, rgb, out));
    }

    /// Encodes a band of one colour without its pixels, to the bytes that [`PngBands::encode`] makes of them.
    ///
    /// # Panics
    /// When there is no such band.
    pub fn encode_uniform(&self, band_idx: u32, color: [u8; 3], encoded: &mut EncodedBand) {
        let n_rows = self.rows(band_idx).len();
        encoded.fill(band_idx, |out| deflate_uniform_rows(self.width as usize, n_rows, color, out));
    }
}

/// Returns the colour of pixels that all have the same.
fn uniform_color(rgb: &[u8]) -> Option<[u8; 3]> {
    let color = *rgb.first_chunk()?;
    (rgb[3..] == rgb[..rgb.len() - 3]).then_some(color)
}

impl EncodedBand {
    /// Returns the length of the band in the file.
    #[must_use]
    pub fn n_bytes(&self) -> usize {
        self.bytes.len()
    }

    fn fill(&mut self, band_idx: u32, deflate: impl FnOnce(&mut Vec<u8>) -> Adler32) {
        self.bytes.clear();
        self.adler = push_chunk(&mut self.bytes, *b"IDAT", |out| {
            if band_idx == 0 {
                out.extend(ZLIB_HEADER);
            }
            deflate(out)
        });
    }
}
