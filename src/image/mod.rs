//! Images: rows of 8-bit RGB in, a PNG file out; and how far two images differ.
//!
//! [`PngStream`] writes an image of any size in constant memory. [`decode_png`] and [`compare`] are for tests and
//! benches, which hold whole images as [`RgbImage`].
//!
//! Never here: files, what a pixel's colour is.

mod diff;
mod png_stream;
mod rgb_image;

pub use diff::{Difference, SizeMismatch, WorstPixel, compare, compare_rows, difference_image};
pub use png_stream::PngStream;
pub use rgb_image::{DecodeError, RgbImage, decode_png, encode_png};
