//! The pixels of a whole image, for a later one that shares some of them.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use glam::DVec3;

use crate::plan::Size;
use crate::trace::{Place, pixel};

/// The pixels of an image.
#[derive(Debug)]
pub struct Canvas {
    row_bytes: usize,
    rgb: Mutex<Vec<u8>>,
}

impl Canvas {
    /// Makes an image of background alone; `None` if its bytes are not proved.
    #[must_use]
    pub fn new(size: Size, background: DVec3) -> Option<Self> {
        let color = pixel::bytes_of(background)?;
        let n_pixels = size.width() as usize * size.height() as usize;
        Some(Self { row_bytes: size.width() as usize * 3, rgb: Mutex::new(color.repeat(n_pixels)) })
    }

    /// Takes over whole rows.
    pub(super) fn put(&self, rows: &Range<u32>, rgb: &[u8]) {
        let first = rows.start as usize * self.row_bytes;
        self.rgb.lock().unwrap_or_else(PoisonError::into_inner)[first..first + rgb.len()].copy_from_slice(rgb);
    }

    /// Takes over one pixel.
    pub(super) fn put_pixel(&self, place: Place, bytes: [u8; 3]) {
        let first = place.row as usize * self.row_bytes + place.column as usize * 3;
        self.rgb.lock().unwrap_or_else(PoisonError::into_inner)[first..first + 3].copy_from_slice(&bytes);
    }

    /// Copies whole rows.
    pub(super) fn get(&self, rows: &Range<u32>, rgb: &mut [u8]) {
        let first = rows.start as usize * self.row_bytes;
        rgb.copy_from_slice(&self.rgb.lock().unwrap_or_else(PoisonError::into_inner)[first..first + rgb.len()]);
    }
}
