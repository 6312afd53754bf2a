//! The ray tracer: a [`SceneView`] in, rows of pixels out, each the pixel that exact arithmetic gives.
//!
//! A pixel is traced in binary64 with a running bound on every number ([`Ball64`]). If each comparison on its way and the
//! rounding of its channels are decided by the bounds, it is proved. If not, it is traced again in double-double
//! ([`Ball106`]); what that cannot decide either is a tie, counted and drawn as equality asks. The code is the same for
//! both, generic over [`Real`](crate::math::Real).
//!
//! Reading order: [`Tracer::render_rows`], `pixel`, `integrator`, `intersect`, `shade`. `scene` prepares, `kernels` reject
//! primitives cheaply.
//!
//! Never here: files, encoding, progress (see `exec`); an epsilon.

mod camera;
mod integrator;
mod intersect;
mod judge;
pub mod kernels;
mod pixel;
mod ray;
mod scene;
mod settings;
mod shade;

pub use settings::{Counts, Part, SampleAt, Settings, Size};

use std::ops::Range;

use rayon::prelude::*;

use crate::ir::SceneView;
use crate::math::{Ball64, Ball106};
use crate::trace::camera::Camera;
use crate::trace::integrator::Integrator;
use crate::trace::pixel::Sampling;
use crate::trace::scene::Scene;

/// Pixels of one row that one thread takes at a time.
const TILE_PIXELS: usize = 64;

/// Renders one image, rows at a time.
#[derive(Debug)]
pub struct Tracer<'p> {
    scene: Scene<'p>,
    settings: Settings,
    sampling: Sampling,
    camera: Camera<Ball64>,
    fine_camera: Camera<Ball106>,
}

impl<'p> Tracer<'p> {
    /// Prepares the scene for one image.
    ///
    /// # Panics
    /// When `settings.samples` is not within 1…[`Settings::MAX_SAMPLES`] or `max_level` is above [`Settings::MAX_LEVEL`].
    #[must_use]
    pub fn new(view: SceneView<'p>, settings: &Settings) -> Self {
        assert!(settings.max_level <= Settings::MAX_LEVEL, "at most {} levels", Settings::MAX_LEVEL);
        let sampling = Sampling::new(settings);
        Self {
            scene: Scene::new(view, settings.part),
            settings: settings.clone(),
            camera: Camera::new(view.fov_deg(), sampling.steps_per_half_height()),
            fine_camera: Camera::new(view.fov_deg(), sampling.steps_per_half_height()),
            sampling,
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
        let width = self.settings.size.width() as usize;
        assert!(rows.end <= self.settings.size.height());
        assert_eq!(rgb.len(), rows.len() * width * 3);
        (rows.into_par_iter())
            .zip(rgb.par_chunks_mut(width * 3))
            .flat_map(|(row, bytes)| {
                let tiles = bytes.par_chunks_mut(TILE_PIXELS * 3).enumerate();
                tiles.map(move |(tile, bytes)| self.render_run(row, (tile * TILE_PIXELS) as u32, bytes, is_cancelled))
            })
            .reduce(Counts::default, |mut total, counts| {
                total += counts;
                total
            })
    }

    /// Renders pixels of one row from `first_column` on.
    fn render_run(&self, row: u32, first_column: u32, rgb: &mut [u8], is_cancelled: &dyn Fn() -> bool) -> Counts {
        let mut coarse = Integrator::new(&self.scene, &self.settings);
        let mut fine = Integrator::new(&self.scene, &self.settings);
        for (column, rgb) in (first_column..).zip(rgb.chunks_exact_mut(3)) {
            if is_cancelled() {
                break;
            }
            let pixel = self.sampling.pixel(column, row);
            let settled = pixel::settle(&mut coarse, &self.camera, &pixel).unwrap_or_else(|_| {
                fine.judge.counts.refined_pixels += 1;
                pixel::settle(&mut fine, &self.fine_camera, &pixel).expect("the finest arithmetic decides ties by rule")
            });
            rgb.copy_from_slice(&settled);
        }
        let mut counts = coarse.judge.counts;
        counts += fine.judge.counts;
        counts
    }
}
