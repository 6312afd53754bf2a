//! A whole image in memory.

use std::io;

use crate::image::PngStream;

/// An image of 8-bit RGB pixels, row by row from the top.
#[derive(Clone, PartialEq, Eq)]
pub struct RgbImage {
    width: u32,
    height: u32,
    /// `width * height * 3` bytes.
    rgb: Vec<u8>,
}

impl RgbImage {
    /// Makes a black image.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, rgb: vec![0; width as usize * height as usize * 3] }
    }

    /// Makes an image of its bytes, 3 a pixel; `None` when they are too many or too few.
    #[must_use]
    pub fn from_rgb(width: u32, height: u32, rgb: Vec<u8>) -> Option<Self> {
        let n_bytes = (width as usize).checked_mul(height as usize)?.checked_mul(3)?;
        (rgb.len() == n_bytes).then_some(Self { width, height, rgb })
    }

    /// Returns the number of columns.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Returns the number of rows.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Returns the bytes, 3 a pixel.
    #[must_use]
    pub fn rgb(&self) -> &[u8] {
        &self.rgb
    }

    /// Returns the bytes for change, 3 a pixel.
    #[must_use]
    pub fn rgb_mut(&mut self) -> &mut [u8] {
        &mut self.rgb
    }

    /// Returns one pixel.
    ///
    /// # Panics
    /// When it lies outside the image.
    #[must_use]
    pub fn pixel(&self, column: u32, row: u32) -> [u8; 3] {
        assert!(column < self.width && row < self.height);
        let start = (row as usize * self.width as usize + column as usize) * 3;
        [self.rgb[start], self.rgb[start + 1], self.rgb[start + 2]]
    }
}

impl std::fmt::Debug for RgbImage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "RgbImage({}x{})", self.width, self.height)
    }
}

/// Bytes that are no PNG file.
#[derive(Debug)]
pub struct DecodeError(::image::ImageError);

impl std::fmt::Display for DecodeError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "cannot decode the PNG file: {}", self.0)
    }
}

impl std::error::Error for DecodeError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.0.source()
    }
}

/// Reads a PNG file; grey and 16-bit images become 8-bit RGB, transparency is dropped.
///
/// # Errors
/// When the bytes are no PNG file.
pub fn decode_png(bytes: &[u8]) -> Result<RgbImage, DecodeError> {
    let image = ::image::load_from_memory_with_format(bytes, ::image::ImageFormat::Png).map_err(DecodeError)?;
    let rgb = image.into_rgb8();
    Ok(RgbImage { width: rgb.width(), height: rgb.height(), rgb: rgb.into_raw() })
}

/// Writes an image as a PNG file, the same bytes as [`PngStream`] makes of its rows.
///
/// # Errors
/// When a side is 0 or above [`PngBands::MAX_SIDE`](crate::image::PngBands::MAX_SIDE).
pub fn encode_png(image: &RgbImage) -> io::Result<Vec<u8>> {
    let mut stream = PngStream::new(Vec::new(), image.width, image.height)?;
    stream.write_rows(&image.rgb)?;
    stream.finish()
}
