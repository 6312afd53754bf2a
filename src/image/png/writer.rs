//! A PNG file out of encoded bands.

use std::io::{self, Write};

use crate::image::png::adler::Adler32;
use crate::image::png::bands::{EncodedBand, PngBands};
use crate::image::png::chunk::{SIGNATURE, push_chunk};

/// An empty block that is the last, with the codes that every decoder knows.
const LAST_BLOCK: [u8; 2] = [0x03, 0x00];

/// Writes a PNG file of 8-bit RGB pixels, band by band from the top.
///
/// Dropping it before [`PngWriter::finish`] leaves a torso in `out`.
#[derive(Debug)]
pub struct PngWriter<W> {
    out: W,
    adler: Adler32,
    n_missing: u32,
}

impl<W: Write> PngWriter<W> {
    /// Begins a file.
    ///
    /// # Errors
    /// When `out` fails.
    pub fn new(mut out: W, bands: &PngBands) -> io::Result<Self> {
        let mut bytes = SIGNATURE.to_vec();
        push_chunk(&mut bytes, *b"IHDR", |out| {
            out.extend(bands.width().to_be_bytes());
            out.extend(bands.height().to_be_bytes());
            let (depth, color_type, compression, filter, interlace) = (8, 2, 0, 0, 0);
            out.extend([depth, color_type, compression, filter, interlace]);
        });
        out.write_all(&bytes)?;
        Ok(Self { out, adler: Adler32::default(), n_missing: bands.n_bands() })
    }

    /// Appends the next band.
    ///
    /// # Errors
    /// When `out` fails.
    ///
    /// # Panics
    /// When the image has no more bands.
    pub fn write_band(&mut self, band: &EncodedBand) -> io::Result<()> {
        self.n_missing = self.n_missing.checked_sub(1).expect("a band of the image");
        self.adler.append(&band.adler);
        self.out.write_all(&band.bytes)
    }

    /// Ends the file and returns its writer, flushed.
    ///
    /// # Errors
    /// When `out` fails.
    ///
    /// # Panics
    /// When bands are missing.
    pub fn finish(mut self) -> io::Result<W> {
        assert_eq!(self.n_missing, 0, "bands are missing");
        let mut bytes = Vec::new();
        push_chunk(&mut bytes, *b"IDAT", |out| {
            out.extend(LAST_BLOCK);
            out.extend(self.adler.value().to_be_bytes());
        });
        push_chunk(&mut bytes, *b"IEND", |_| ());
        self.out.write_all(&bytes)?;
        self.out.flush()?;
        Ok(self.out)
    }
}
