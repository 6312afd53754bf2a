//! What is measured: times in turns, and errors once.

use std::path::Path;
use std::time::{Duration, Instant};

use clap::ValueEnum;
use clisc::exact::Renderer;
use clisc::exec::{exact_settings, render_whole};
use clisc::ir::SceneView;
use clisc::plan::{self, BackendChoice, Settings, Size, plan};
use clisc::trace::{Tracer, Unrounded};
use rayon::prelude::*;

use super::error::Errors;
use super::report::{Measured, SceneReport, Times};
use crate::args::Precision;

/// What has been timed for so long is not timed again.
const ENOUGH: Duration = Duration::from_secs(10);

/// Samples a pixel, N by N, that stand for infinitely many.
pub const REFERENCE_SAMPLES: u32 = 32;

/// One scene to be measured.
pub struct Bench<'a> {
    /// The scene as the last `write` sees it.
    pub view: SceneView<'a>,
    pub size: Size,
    pub backend: BackendChoice,
    pub repeat: u32,
    pub is_cancelled: &'a (dyn Fn() -> bool + Sync),
}

/// An image and the times it took.
struct Timed {
    rgb: Vec<u8>,
    draft_pixels: u64,
    times: Vec<Duration>,
}

/// Returns all modes, the coarsest first.
pub fn every_mode() -> Vec<Precision> {
    let mut modes = Precision::value_variants().to_vec();
    modes.sort_by_key(|mode| mode.fineness());
    modes
}

impl Bench<'_> {
    /// Measures modes, and numbers of samples; `None` when that was cancelled.
    pub fn run(&self, path: &Path, modes: &[Precision], samples: &[u32]) -> Option<SceneReport> {
        let usual = Settings { size: self.size, backend: self.backend, ..Settings::default() };
        let of_modes: Vec<_> =
            modes.iter().map(|mode| Settings { precision: (*mode).into(), ..usual.clone() }).collect();
        // What samples cost and gain is not a matter of proofs.
        let usual = Settings { precision: plan::Precision::F64, ..usual };
        let of_samples: Vec<_> = samples.iter().map(|n| Settings { samples: *n, ..usual.clone() }).collect();
        let mut timed = self.time_all(&[of_modes.clone(), of_samples].concat())?;
        let timed_samples = timed.split_off(modes.len());

        let truth = self.unrounded_exactly(&usual);
        let modes = modes.iter().zip(&of_modes).zip(timed).map(|((mode, settings), timed)| {
            let errors = Errors::of_unrounded(&self.unrounded(settings, &timed), &truth);
            Measured::new(mode.name(), timed.draft_pixels, Times::of(timed.times), errors)
        });
        let modes = modes.collect();

        let samples = if samples.is_empty() {
            Vec::new()
        } else {
            let reference = self.render(&Settings { samples: REFERENCE_SAMPLES, ..usual })?;
            let measured = samples.iter().zip(timed_samples).map(|(n, timed)| {
                let errors = Errors::of_bytes(&timed.rgb, &reference.rgb);
                Measured::new(format!("{n}x{n}"), timed.draft_pixels, Times::of(timed.times), errors)
            });
            measured.collect()
        };
        Some(SceneReport::new(path, self.size, modes, samples))
    }

    /// Returns the image of one mode before rounding, with the bytes of the image that was timed.
    fn unrounded(&self, settings: &Settings, timed: &Timed) -> Unrounded {
        let unrounded = match settings.precision {
            plan::Precision::Exact => self.unrounded_exactly(settings),
            _ => Tracer::new(plan(self.view, settings)).unrounded(),
        };
        Unrounded { rgb: timed.rgb.as_chunks().0.to_vec(), ..unrounded }
    }

    /// Makes the image in arbitrary precision, before rounding.
    fn unrounded_exactly(&self, settings: &Settings) -> Unrounded {
        let renderer = Renderer::new(self.view, &exact_settings(settings));
        let (width, height) = (settings.size.width(), settings.size.height());
        let pixels = (0..width * height).into_par_iter().map(|i| {
            let pixel = renderer.pixel(i % width, i / width);
            (pixel.rgb, pixel.channels)
        });
        let (rgb, levels) = pixels.unzip();
        Unrounded { rgb, levels }
    }

    /// Times each of the settings, all of them in turn, so that what disturbs one disturbs all.
    fn time_all(&self, all: &[Settings]) -> Option<Vec<Timed>> {
        let mut timed: Vec<Timed> = all.iter().map(|settings| self.render(settings)).collect::<Option<_>>()?;
        for _ in 1..self.repeat {
            for (settings, timed) in all.iter().zip(&mut timed) {
                if timed.times.iter().sum::<Duration>() < ENOUGH {
                    timed.times.extend(self.render(settings)?.times);
                }
            }
        }
        Some(timed)
    }

    /// Renders an image; `None` when that was cancelled.
    fn render(&self, settings: &Settings) -> Option<Timed> {
        let start = Instant::now();
        let (width, height) = (settings.size.width(), settings.size.height());
        let mut rgb = vec![0; width as usize * height as usize * 3];
        let counts = render_whole(self.view, settings, &mut rgb, self.is_cancelled);
        let time = start.elapsed();
        (!(self.is_cancelled)()).then(|| Timed { rgb, draft_pixels: counts.draft_pixels, times: vec![time] })
    }
}
