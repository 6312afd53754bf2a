//! A PNG file written while its rows are made.

use std::io::{self, Write};
use std::mem;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The most bytes in one IDAT chunk. The encoder keeps one in memory, and each has 12 bytes of frame.
const CHUNK_BYTES: usize = 1 << 18;

/// Writes an 8-bit RGB image as a PNG file, some rows at a time and in constant memory.
///
/// Equal rows give equal bytes, however they are cut into calls. Dropping the stream before [`PngStream::finish`] leaves
/// a torso in the writer.
///
/// # Source
/// The `png` crate with fdeflate and the Paeth filter: eight times as fast as zlib's usual level on renders, for a third
/// more bytes.
pub struct PngStream<W: Write> {
    /// `png` writes the end of the last chunk and the end mark in `drop`, where an error is lost. It therefore writes
    /// into memory, which cannot fail, and every write to `out` is ours.
    encoder: png::StreamWriter<'static, Pipe>,
    encoded: Pipe,
    out: W,
    /// Bytes of the rows that are still to come.
    n_missing: u64,
}

impl<W: Write> PngStream<W> {
    /// Begins an image of `width` columns and `height` rows.
    ///
    /// # Errors
    /// When a side is 0, or when `out` fails.
    pub fn new(out: W, width: u32, height: u32) -> io::Result<Self> {
        let encoded = Pipe::default();
        let mut options = png::Encoder::new(encoded.clone(), width, height);
        options.set_color(png::ColorType::Rgb);
        options.set_depth(png::BitDepth::Eight);
        options.set_compression(png::Compression::Fast);
        options.set_filter(png::Filter::Paeth);
        let encoder = options.write_header()?.into_stream_writer_with_size(CHUNK_BYTES)?;
        let n_missing = u64::from(width) * u64::from(height) * 3;
        let mut stream = Self { encoder, encoded, out, n_missing };
        stream.pass_on()?;
        Ok(stream)
    }

    /// Appends pixels, 3 bytes each, row by row from the top; a call may end within a row.
    ///
    /// # Errors
    /// When `out` fails, or when there are more pixels than the image has.
    pub fn write_rows(&mut self, rgb: &[u8]) -> io::Result<()> {
        let Some(n_missing) = self.n_missing.checked_sub(rgb.len() as u64) else {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "more pixels than the image has"));
        };
        self.encoder.write_all(rgb)?;
        self.n_missing = n_missing;
        self.pass_on()
    }

    /// Ends the file and returns its writer, flushed.
    ///
    /// # Errors
    /// When `out` fails, or when pixels are missing.
    pub fn finish(mut self) -> io::Result<W> {
        if self.n_missing > 0 {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "fewer pixels than the image has"));
        }
        self.encoder.finish()?;
        self.out.write_all(&self.encoded.take())?;
        self.out.flush()?;
        Ok(self.out)
    }

    /// Hands what is encoded so far to `out`.
    fn pass_on(&mut self) -> io::Result<()> {
        let bytes = self.encoded.take();
        self.out.write_all(&bytes)?;
        self.encoded.recycle(bytes);
        Ok(())
    }
}

impl<W: Write> std::fmt::Debug for PngStream<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PngStream").field("n_missing", &self.n_missing).finish_non_exhaustive()
    }
}

/// Bytes on their way from the encoder to the file. Shared, because the encoder owns its writer.
#[derive(Clone, Default)]
struct Pipe(Arc<Mutex<Vec<u8>>>);

impl Pipe {
    /// Takes all bytes out.
    fn take(&self) -> Vec<u8> {
        mem::take(&mut self.lock())
    }

    /// Gives the memory of taken bytes back.
    fn recycle(&self, mut bytes: Vec<u8>) {
        bytes.clear();
        *self.lock() = bytes;
    }

    fn lock(&self) -> MutexGuard<'_, Vec<u8>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Write for Pipe {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.lock().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
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
    }

    #[test]
    fn the_largest_image_has_a_header() {
        let mut stream = PngStream::new(Vec::new(), 65535, 65535).unwrap();
        stream.write_rows(&vec![7; 65535 * 3]).unwrap();
        assert_eq!(&stream.out[16..24], [0, 0, 0xFF, 0xFF, 0, 0, 0xFF, 0xFF]);
        assert_eq!(stream.n_missing, 65535 * 65534 * 3);
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
