//! The ray tracer: a [`Plan`] in, rows of pixels out, each the pixel that exact arithmetic gives.
//!
//! A pixel is traced in binary64 with a running bound on every number ([`Ball64`]). If each comparison on its way and the
//! rounding of its channels are decided by the bounds, it is proved. If not, it is traced again in double-double
//! ([`Ball106`]); what that cannot decide either is a tie, counted and drawn as equality asks. The code is the same for
//! both, generic over [`Real`](crate::math::Real).
//!
//! Reading order: [`Tracer::render_rows`], `pixel`, `integrator`, `intersect`, `shade`. `kernels` reject
//! primitives cheaply.
//!
//! Never here: files, encoding, progress (see `exec`); an epsilon.

mod camera;
mod counts;
mod integrator;
mod intersect;
mod judge;
pub mod kernels;
mod look_up;
mod pixel;
mod ray;
mod shade;

pub use counts::Counts;

use std::ops::Range;

use rayon::prelude::*;

use crate::math::{Ball64, Ball106};
use crate::plan::{Plan, Settings};
use crate::trace::camera::Camera;
use crate::trace::integrator::Integrator;
use crate::trace::pixel::Sampling;

/// Renders one image, rows at a time.
#[derive(Debug)]
pub struct Tracer<'p> {
    plan: Plan<'p>,
    sampling: Sampling,
    camera: Camera<Ball64>,
    fine_camera: Camera<Ball106>,
}

impl<'p> Tracer<'p> {
    /// Bands whose rows begin and end at multiples of this are rendered fastest.
    pub const TILE_ROWS: u32 = 16;

    /// Prepares to render what a plan has left.
    ///
    /// # Panics
    /// When the settings ask for samples not within 1…[`Settings::MAX_SAMPLES`] or a `max_level` above
    /// [`Settings::MAX_LEVEL`].
    #[must_use]
    pub fn new(plan: Plan<'p>) -> Self {
        assert!(plan.settings.max_level <= Settings::MAX_LEVEL, "at most {} levels", Settings::MAX_LEVEL);
        let sampling = Sampling::new(&plan.settings);
        Self {
            camera: Camera::new(plan.fov_deg, sampling.steps_per_half_height()),
            fine_camera: Camera::new(plan.fov_deg, sampling.steps_per_half_height()),
            sampling,
            plan,
        }
    }

    /// Renders `rows` into `rgb`, 3 bytes a pixel, row by row from the top, on all threads of the current rayon pool.
    ///
    /// The bytes do not depend on the number of threads, nor on how an image is cut into rows.
    ///
    /// # Panics
    /// When `rgb` does not hold exactly the pixels of `rows`, or a row lies outside the image.
    pub fn render_rows(&self, rows: Range<u32>, rgb: &mut [u8]) -> Counts {
        self.render_rows_unless(rows, rgb, &|| false)
    }

    /// Does the work of [`Tracer::render_rows`] until `is_cancelled`, which is asked before each pixel, says so; what is
    /// then in `rgb` is no image.
    ///
    /// # Panics
    /// As [`Tracer::render_rows`].
    pub fn render_rows_unless(
        &self,
        rows: Range<u32>,
        rgb: &mut [u8],
        is_cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Counts {
        let row_bytes = self.assert_fits(&rows, rgb);
        (rows.into_par_iter())
            .zip(rgb.par_chunks_mut(row_bytes))
            .map(|(row, rgb)| self.render_row(row, rgb, is_cancelled))
            .reduce(Counts::default, |mut total, counts| {
                total += counts;
                total
            })
    }

    /// Does the work of [`Tracer::render_rows_unless`] on the calling thread alone.
    ///
    /// # Panics
    /// As [`Tracer::render_rows`].
    pub fn render_band(&self, rows: Range<u32>, rgb: &mut [u8], is_cancelled: &(dyn Fn() -> bool + Sync)) -> Counts {
        let row_bytes = self.assert_fits(&rows, rgb);
        let mut counts = Counts::default();
        for (row, rgb) in rows.zip(rgb.chunks_exact_mut(row_bytes)) {
            counts += self.render_row(row, rgb, is_cancelled);
        }
        counts
    }

    /// Returns the colour that all pixels of these rows are proved to have, if they are.
    #[must_use]
    pub fn uniform_rows(&self, rows: Range<u32>) -> Option<[u8; 3]> {
        self.plan.tiles.are_empty(rows).then(|| pixel::bytes_of(self.plan.scene.background)).flatten()
    }

    /// Checks the size of `rgb` and returns the bytes of a row.
    fn assert_fits(&self, rows: &Range<u32>, rgb: &[u8]) -> usize {
        let size = self.plan.settings.size;
        let row_bytes = size.width() as usize * 3;
        assert!(rows.end <= size.height());
        assert_eq!(rgb.len(), rows.len() * row_bytes);
        row_bytes
    }

    fn render_row(&self, row: u32, rgb: &mut [u8], is_cancelled: &dyn Fn() -> bool) -> Counts {
        let mut coarse = Integrator::new(&self.plan);
        let mut fine = Integrator::new(&self.plan);
        for (column, rgb) in (0..).zip(rgb.chunks_exact_mut(3)) {
            if is_cancelled() {
                break;
            }
            let pixel = self.sampling.pixel(column, row);
            let among = self.plan.tiles.candidates(column, row);
            let settled = pixel::settle(&mut coarse, &self.camera, &pixel, among).unwrap_or_else(|_| {
                fine.judge.counts.refined_pixels += 1;
                pixel::settle(&mut fine, &self.fine_camera, &pixel, among)
                    .expect("the finest arithmetic decides ties by rule")
            });
            rgb.copy_from_slice(&settled);
        }
        let mut counts = coarse.judge.counts;
        counts += fine.judge.counts;
        counts
    }
}
