//! The PNG encoder: bands of rows in, a PNG file out.
//!
//! One image is one zlib stream, but its bands are encoded apart: on any core, in any order, with nothing known of the
//! others ([`PngBands`]). [`PngWriter`] takes them in order and writes the file; [`PngStream`] is both for those who have
//! rows. Where the bands lie depends on the size of the image alone, so equal pixels give equal bytes.
//!
//! Reading order: `bands`, `deflate`, `filter`, `tokens`, `code`, `bits`, `adler`.
//!
//! Never here: other colour types, threads.
//!
//! # Source
//! The PNG specification (third edition), RFC 1950 (zlib) and RFC 1951 (deflate). One fixed code instead of one for each
//! image, and runs of zeros for matches, are the idea of fdeflate (image-rs); ours looks at eight bytes at a time, and
//! writes four small ones by one look.

mod adler;
mod bands;
mod bits;
mod chunk;
mod code;
mod deflate;
mod filter;
mod stream;
#[cfg(test)]
mod tests;
mod tokens;
mod writer;

pub use bands::{EncodedBand, PngBands};
pub use stream::PngStream;
pub use writer::PngWriter;
