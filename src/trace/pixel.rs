//! One pixel: its samples, their mean, its three bytes.

use glam::DVec3;

use crate::math::{Ball64, Real, Vector};
use crate::plan::{Candidates, SampleAt, Settings};
use crate::trace::camera::Camera;
use crate::trace::integrator::Integrator;
use crate::trace::judge::{Doubt, Judge};
use crate::trace::touch::Touches;

/// Added before rounding down, so that a decimal such as 0.6 = 153/255 gives 153. The semantics fix it at 2⁻²⁰.
const QUANTISATION_BIAS: f64 = 1.0 / 1_048_576.0;

/// Where the samples of an image lie, in whole steps: N samples in a row or column of a pixel are 2 steps apart, so a
/// pixel is 2N steps wide and all places are whole numbers.
#[derive(Clone, Copy, Debug)]
pub struct Sampling {
    samples: u32,
    width: u32,
    height: u32,
    /// Steps from a pixel's upper left corner to the point about which its samples lie.
    anchor: i64,
}

/// The samples of one pixel, in steps from the middle of the image, right and up.
#[derive(Clone, Copy, Debug)]
pub struct Pixel {
    left: i64,
    top: i64,
    samples: u32,
}

impl Sampling {
    /// Lays out the samples that `settings` ask for.
    pub fn new(settings: &Settings) -> Self {
        assert!((1..=Settings::MAX_SAMPLES).contains(&settings.samples), "1 to 256 samples");
        let anchor = match settings.sample_at {
            SampleAt::Corner => 0,
            SampleAt::Centre => i64::from(settings.samples),
        };
        Self { samples: settings.samples, width: settings.size.width(), height: settings.size.height(), anchor }
    }

    /// Returns the steps in half the height of the image.
    pub fn steps_per_half_height(&self) -> u32 {
        self.samples * self.height
    }

    /// Returns the place of a pixel's first sample, in steps from the middle of the image, right and up. The samples of a
    /// row of pixels lie 2 steps apart.
    pub fn first_sample(&self, column: u32, row: u32) -> (i64, i64) {
        let Pixel { left, top, .. } = self.pixel(column, row);
        (left, top)
    }

    /// Returns the samples of the pixel in this column and row.
    ///
    /// Sample k of N lies (k + ½)/N − ½ pixel from the anchor, which is 2k + 1 − N steps.
    pub fn pixel(&self, column: u32, row: u32) -> Pixel {
        let n = i64::from(self.samples);
        let first = self.anchor + 1 - n;
        Pixel {
            left: (2 * i64::from(column) - i64::from(self.width)) * n + first,
            top: (i64::from(self.height) - 2 * i64::from(row)) * n - first,
            samples: self.samples,
        }
    }
}

/// Traces a pixel and returns its bytes, red, green, blue.
///
/// `among`: what its eye rays can meet.
///
/// # Errors
/// [`Doubt`] when this arithmetic cannot decide a comparison on the way, or a channel.
pub fn settle<R: Real>(
    integrator: &mut Integrator<'_, '_, R>,
    camera: &Camera<R>,
    pixel: &Pixel,
    among: Candidates<'_>,
) -> Result<[u8; 3], Doubt> {
    let color = mean(integrator, camera, pixel, among)?;
    quantise(&mut integrator.judge, color)
}

/// Traces a pixel and returns its colour, the mean of its samples.
///
/// # Errors
/// As [`settle`], but for the channels.
pub fn mean<R: Real>(
    integrator: &mut Integrator<'_, '_, R>,
    camera: &Camera<R>,
    pixel: &Pixel,
    among: Candidates<'_>,
) -> Result<Vector<R>, Doubt> {
    integrator.judge.touches = Touches::default();
    integrator.given_up = None;
    let n = i64::from(pixel.samples);
    let mut sum = Vector::exact(glam::DVec3::ZERO);
    for row in 0..n {
        for column in 0..n {
            let ray = camera.eye_ray(pixel.left + 2 * column, pixel.top - 2 * row);
            sum = sum + integrator.color(ray, among)?;
        }
    }
    Ok(if n == 1 { sum } else { sum.map(|channel| channel / R::exact((n * n) as f64)) })
}

/// Returns the bytes of a colour that is known exactly; `None` when binary64 cannot decide one of them.
pub fn bytes_of(color: DVec3) -> Option<[u8; 3]> {
    quantise(&mut Judge::default(), Vector::<Ball64>::exact(color).map(Ball64::clamp_unit)).ok()
}

/// Returns the bytes of a colour whose channels lie in 0…1.
pub fn quantise<R: Real>(judge: &mut Judge, color: Vector<R>) -> Result<[u8; 3], Doubt> {
    let mut bytes = [0; 3];
    for (byte, channel) in bytes.iter_mut().zip(color.to_array()) {
        let scaled = channel * R::exact(255.0) + R::exact(QUANTISATION_BIAS);
        *byte = judge.floor(scaled)? as u8;
        judge.note_bound(scaled.error());
    }
    Ok(bytes)
}
