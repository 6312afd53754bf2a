//! The channels of an image before they are rounded to bytes: for measurements, not for images.

use rayon::prelude::*;

use crate::math::{Real, Vector};
use crate::plan::Candidates;
use crate::trace::camera::Camera;
use crate::trace::draft::Draft;
use crate::trace::integrator::Integrator;
use crate::trace::pixel::{self, Pixel};
use crate::trace::wide::Wide;
use crate::trace::{Counts, Settler, Tracer};

/// The pixels of an image, row by row from the top, and what they were rounded from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unrounded {
    /// The bytes of the pixels.
    pub rgb: Vec<[u8; 3]>,
    /// 255 c of each channel.
    pub levels: Vec<[f64; 3]>,
}

impl Tracer<'_> {
    /// Renders the whole image without losing what lies below a level, on all threads of the current rayon pool.
    ///
    /// Of a draft these are its own numbers. Otherwise each pixel is traced by itself in the first arithmetic that decides
    /// it: its bytes are those of the image, its levels as good as those of the packets, though not the same to the last
    /// bit.
    #[must_use]
    pub fn unrounded(&self) -> Unrounded {
        match &self.draft {
            Some(draft) => self.unrounded_draft(draft),
            None => self.unrounded_pixels(|settler, pixel, among| {
                let coarse = (&mut settler.coarse, &self.camera);
                unrounded_pixel(coarse, pixel, among)
                    .or_else(|| unrounded_pixel((&mut settler.fine, &self.fine_camera), pixel, among))
            }),
        }
    }

    /// Traces each pixel by `trace`; what that cannot decide has its best value.
    fn unrounded_pixels(
        &self,
        trace: impl Fn(&mut Settler<'_, '_>, &Pixel, Candidates<'_>) -> Option<([u8; 3], [f64; 3])> + Sync,
    ) -> Unrounded {
        let size = self.plan.settings.size;
        let rows = (0..size.height()).into_par_iter().map(|row| {
            let mut settler = Settler::new(self);
            let traced = (0..size.width()).map(|column| {
                let among = self.plan.tiles.candidates(column, row);
                trace(&mut settler, &self.sampling.pixel(column, row), among)
                    .unwrap_or_else(|| self.best_values().unrounded_pixel(column, row, &mut Counts::default()))
            });
            traced.collect::<Vec<_>>()
        });
        let (rgb, levels) = rows.flatten_iter().unzip();
        Unrounded { rgb, levels }
    }

    fn unrounded_draft(&self, draft: &Draft) -> Unrounded {
        let size = self.plan.settings.size;
        let (width, height) = (size.width() as usize, size.height());
        let mut rgb = vec![0; width * height as usize * 3];
        let mut levels = vec![[0.0; 3]; width * height as usize];
        let mut scratch = draft.scratch();
        scratch.unrounded = Some(Vec::new());
        for rect in Wide::tiles(&self.plan, 0..height) {
            draft.trace(&self.plan, &self.sampling, &rect, &mut scratch);
            scratch.write(&rect, &mut rgb, width, 0);
            scratch.write_unrounded(&rect, &mut levels, width);
        }
        Unrounded { rgb: rgb.as_chunks().0.to_vec(), levels }
    }
}

/// Traces a pixel in one arithmetic; `None` when that cannot decide it.
fn unrounded_pixel<R: Real>(
    (integrator, camera): (&mut Integrator<'_, '_, R>, &Camera<R>),
    pixel: &Pixel,
    among: Candidates<'_>,
) -> Option<([u8; 3], [f64; 3])> {
    let color: Vector<R> = pixel::mean(integrator, camera, pixel, among).ok()?;
    let bytes = pixel::quantise(&mut integrator.judge, color).ok()?;
    Some((bytes, color.to_array().map(|channel| 255.0 * channel.value())))
}
