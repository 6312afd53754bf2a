//! Images: rows of 8-bit RGB in, a PNG file out; and how far two images differ.
//!
//! [`PngStream`] writes an image of any size in constant memory, [`PngBands`] and [`PngWriter`] do so on any number of
//! cores. [`decode_png`] and [`compare`] are for tests and
//! benches, which hold whole images as [`RgbImage`].
//!
//! Never here: files, what a pixel's colour is.

mod checksum;
mod diff;
mod png;
mod rgb_image;

pub use checksum::Crc32;
pub use diff::{Difference, SizeMismatch, WorstPixel, compare, compare_rows, difference_image};
pub use png::{EncodedBand, PngBands, PngStream, PngWriter};
pub use rgb_image::{DecodeError, RgbImage, decode_png, encode_png};
