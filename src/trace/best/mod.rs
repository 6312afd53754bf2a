//! The best value of a pixel that nothing proves.
//!
//! Where bounds end, or the work that a proof may take, a pixel still has to have a colour. It is traced once more in
//! [`Computed`] numbers, in which every comparison has an answer: the sign of what was computed, as in any tracer, and equality
//! if it is 0 but for roundings or algebra says so. The same rule holds for every such pixel. It takes the scene as it is
//! declared, without anything that a plan finds out: which passes ran does not matter.
//!
//! Never here: a proof.

mod computed;

use crate::ir::SceneView;
use crate::math::{Real, Vector};
use crate::plan::{Plan, Settings, bare_plan};
use crate::trace::Counts;
use crate::trace::camera::Camera;
use crate::trace::integrator::Integrator;
use crate::trace::pixel::{self, Sampling};

use self::computed::Computed;

/// Makes the pixels of one image without proving them.
#[derive(Debug)]
pub struct BestValues<'p> {
    plan: Plan<'p>,
    sampling: Sampling,
    camera: Camera<Computed>,
}

impl<'p> BestValues<'p> {
    /// Prepares an image.
    #[must_use]
    pub fn new(view: SceneView<'p>, settings: &Settings) -> Self {
        let sampling = Sampling::new(settings);
        let camera = Camera::new(view.fov_deg(), sampling.steps_per_half_height());
        Self { plan: bare_plan(view, settings), sampling, camera }
    }

    /// Returns the bytes of a pixel, and adds its rays and tests to `counts`.
    pub fn pixel(&self, column: u32, row: u32, counts: &mut Counts) -> [u8; 3] {
        self.unrounded_pixel(column, row, counts).0
    }

    /// Returns the bytes of a pixel, and what they were rounded from: 255 c of each channel.
    pub(super) fn unrounded_pixel(&self, column: u32, row: u32, counts: &mut Counts) -> ([u8; 3], [f64; 3]) {
        let mut integrator = Integrator::<Computed>::new(&self.plan);
        integrator.judge.asks_algebra = true;
        let among = self.plan.tiles.candidates(column, row);
        let pixel = self.sampling.pixel(column, row);
        let color: Vector<Computed> =
            pixel::mean(&mut integrator, &self.camera, &pixel, among).expect("every computed number has a sign");
        let bytes = pixel::quantise(&mut integrator.judge, color).expect("every computed number has a floor");
        // What is not proved has no bound.
        *counts += Counts { largest_bound: 0.0, ..integrator.judge.counts };
        (bytes, color.to_array().map(|channel| 255.0 * channel.value()))
    }
}
