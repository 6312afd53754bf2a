//! A PNG file written while its rows are made.

use std::io::{self, Write};

use crate::image::png::bands::{EncodedBand, PngBands};
use crate::image::png::writer::PngWriter;

/// Writes an 8-bit RGB image as a PNG file, some rows at a time and in constant memory.
///
/// Equal rows give equal bytes, however they are cut into calls. Dropping the stream before [`PngStream::finish`] leaves
/// a torso in the writer.
#[derive(Debug)]
pub struct PngStream<W: Write> {
    bands: PngBands,
    file: PngWriter<W>,
    /// Pixels of the band that is not whole yet.
    pending: Vec<u8>,
    band_idx: u32,
    encoded: EncodedBand,
    /// Bytes of the rows that are still to come.
    n_missing: u64,
}

impl<W: Write> PngStream<W> {
    /// Begins an image of `width` columns and `height` rows.
    ///
    /// # Errors
    /// When a side is 0 or above [`PngBands::MAX_SIDE`], or when `out` fails.
    pub fn new(out: W, width: u32, height: u32) -> io::Result<Self> {
        let bands = PngBands::new(width, height)?;
        let file = PngWriter::new(out, &bands)?;
        let n_missing = u64::from(width) * u64::from(height) * 3;
        Ok(Self { bands, file, pending: Vec::new(), band_idx: 0, encoded: EncodedBand::default(), n_missing })
    }

    /// Appends pixels, 3 bytes each, row by row from the top; a call may end within a row.
    ///
    /// # Errors
    /// When `out` fails, or when there are more pixels than the image has.
    pub fn write_rows(&mut self, mut rgb: &[u8]) -> io::Result<()> {
        let Some(n_missing) = self.n_missing.checked_sub(rgb.len() as u64) else {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "more pixels than the image has"));
        };
        self.n_missing = n_missing;
        while !rgb.is_empty() {
            let band_bytes = self.bands.rgb_bytes(&self.bands.rows(self.band_idx));
            let (piece, rest) = rgb.split_at(rgb.len().min(band_bytes - self.pending.len()));
            rgb = rest;
            if piece.len() == band_bytes {
                self.write_band(piece)?;
                continue;
            }
            self.pending.extend(piece);
            if self.pending.len() == band_bytes {
                let pixels = std::mem::take(&mut self.pending);
                self.write_band(&pixels)?;
                self.pending = pixels;
                self.pending.clear();
            }
        }
        Ok(())
    }

    /// Ends the file and returns its writer, flushed.
    ///
    /// # Errors
    /// When `out` fails, or when pixels are missing.
    pub fn finish(self) -> io::Result<W> {
        if self.n_missing > 0 {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "fewer pixels than the image has"));
        }
        self.file.finish()
    }

    fn write_band(&mut self, rgb: &[u8]) -> io::Result<()> {
        self.bands.encode(self.band_idx, rgb, &mut self.encoded);
        self.band_idx += 1;
        self.file.write_band(&self.encoded)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{RgbImage, decode_png, encode_png};

    /// An image in which no two rows are equal.
    fn pattern(width: u32, height: u32) -> RgbImage {
        let n_bytes = width as usize * height as usize * 3;
        let rgb = (0..n_bytes).map(|i| (i.wrapping_mul(i) >> 7) as u8).collect();
        RgbImage::from_rgb(width, height, rgb).unwrap()
    }

    #[test]
    fn what_is_written_is_what_the_image_crate_reads() {
        for (width, height) in [(1, 1), (1, 700), (700, 1), (641, 479)] {
            let image = pattern(width, height);
            assert!(decode_png(&encode_png(&image).unwrap()).unwrap() == image, "{width}x{height}");
        }
    }

    #[test]
    fn the_cut_into_calls_leaves_no_trace() {
        let image = pattern(123, 45);
        let whole = encode_png(&image).unwrap();
        for n_bytes in [1, 3, 369, 1000] {
            let mut stream = PngStream::new(Vec::new(), 123, 45).unwrap();
            for piece in image.rgb().chunks(n_bytes) {
                stream.write_rows(piece).unwrap();
            }
            assert!(stream.finish().unwrap() == whole, "pieces of {n_bytes} bytes");
        }
    }

    #[test]
    fn too_many_or_too_few_pixels_are_an_error() {
        let mut stream = PngStream::new(Vec::new(), 2, 2).unwrap();
        assert!(stream.write_rows(&[0; 13]).is_err());
        stream.write_rows(&[0; 9]).unwrap();
        assert!(stream.finish().is_err());
        assert!(PngStream::new(Vec::new(), 0, 2).is_err());
        assert!(PngStream::new(Vec::new(), 2, PngBands::MAX_SIDE + 1).is_err());
    }

    #[test]
    fn the_largest_image_has_a_header() {
        let mut stream = PngStream::new(Vec::new(), 65535, 65535).unwrap();
        stream.write_rows(&vec![7; 65535 * 3]).unwrap();
        assert_eq!(stream.n_missing, 65535 * 65534 * 3);
        let mut header = Vec::new();
        PngStream::new(&mut header, 65535, 65535).unwrap();
        assert_eq!(header[16..24], [0, 0, 0xFF, 0xFF, 0, 0, 0xFF, 0xFF]);
    }

    /// A disk with room for some bytes.
    #[derive(Debug)]
    struct Disk {
        n_free: usize,
    }

    impl Write for Disk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if self.n_free == 0 {
                return Err(io::ErrorKind::StorageFull.into());
            }
            let n_written = bytes.len().min(self.n_free);
            self.n_free -= n_written;
            Ok(n_written)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_disk_full_at_any_byte_is_an_error() {
        let image = pattern(5, 4);
        let n_bytes = encode_png(&image).unwrap().len();
        let write_to = |disk| {
            let mut stream = PngStream::new(disk, 5, 4)?;
            stream.write_rows(image.rgb())?;
            stream.finish()
        };
        for n_free in 0..n_bytes {
            assert_eq!(write_to(Disk { n_free }).unwrap_err().kind(), io::ErrorKind::StorageFull, "{n_free} bytes");
        }
        assert_eq!(write_to(Disk { n_free: n_bytes }).unwrap().n_free, 0);
    }
}
