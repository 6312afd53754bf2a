//! The oracle: a scene in, the pixels that exact arithmetic gives out.
//!
//! It follows the semantics page formula by formula in [ball arithmetic](ball), so each comparison is either proved or
//! open. An open one restarts the pixel with more bits; what is still open at the last precision is taken for a tie,
//! counted, and settled by the page's rule for equality. There is no epsilon.
//!
//! One rule is narrower than its text, because the original image of scene i6 says so in pixel (0, 180): the far rim of a
//! cylinder that a ray touches in passing, leaving the infinite wall as it comes down to the cap, is no hit.
//!
//! Never here: anything of `clisc::trace` but what a render is asked for, nor of `clisc::math`. A shared helper would share
//! its bug.

#![allow(dead_code, reason = "each suite uses a part")]

pub mod ball;
mod intersect;
mod reach;
mod run;
mod scene;
mod tie;
mod vec3;

use std::sync::OnceLock;

use clisc::ir::SceneView;
use clisc::plan::Settings;
use rayon::prelude::*;

#[allow(unused_imports, reason = "each suite uses a part")]
pub use self::tie::{Tie, Ties};

use self::run::Run;
use self::scene::Scene;

/// The precisions a pixel is tried with, in bits. The last is for mirrors of 1e-30 of the scene, nine bounces deep.
pub const LADDER: [usize; 4] = [256, 512, 1024, 2048];

/// One pixel as exact arithmetic gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixel {
    /// The bytes of the image.
    pub rgb: [u8; 3],
    /// 255 c per channel, before rounding down.
    pub channels: [f64; 3],
    /// The least distance of a channel's 255 c + 2⁻²⁰ to a whole number.
    pub slack: f64,
    /// The comparisons of equal quantities that were proved equal by exact operations.
    pub proved_ties: Ties,
    /// The comparisons that no precision of the ladder could decide.
    pub open_ties: Ties,
    /// The precision that gave the pixel.
    pub bits: usize,
}

/// Renders one scene exactly.
pub struct Oracle<'p> {
    view: SceneView<'p>,
    settings: Settings,
    ladder: Vec<usize>,
    /// The scene at each precision of the ladder, once it was asked for.
    scenes: Vec<OnceLock<Scene>>,
    tests_all: bool,
}

impl<'p> Oracle<'p> {
    /// Prepares a scene for [`LADDER`].
    pub fn new(view: SceneView<'p>, settings: &Settings) -> Self {
        Self::with_ladder(view, settings, &LADDER)
    }

    /// Prepares a scene for rising precisions of one's own.
    pub fn with_ladder(view: SceneView<'p>, settings: &Settings, ladder: &[usize]) -> Self {
        let scenes = ladder.iter().map(|_| OnceLock::new()).collect();
        Self { view, settings: settings.clone(), ladder: ladder.to_vec(), scenes, tests_all: false }
    }

    /// Tests every ray against every primitive, without the filter in binary64.
    pub fn testing_all(self) -> Self {
        Self { tests_all: true, ..self }
    }

    /// Renders every pixel, row by row from the top.
    pub fn image(&self) -> Vec<Pixel> {
        let width = self.settings.size.width();
        let n_pixels = width * self.settings.size.height();
        (0..n_pixels).into_par_iter().map(|i| self.pixel(i % width, i / width)).collect()
    }

    /// Renders one pixel.
    pub fn pixel(&self, column: u32, row: u32) -> Pixel {
        for (i, &bits) in self.ladder.iter().enumerate() {
            let scene = self.scenes[i].get_or_init(|| Scene::new(&self.view, bits));
            let is_last = i + 1 == self.ladder.len();
            if let Ok(pixel) = Run::new(scene, &self.settings, is_last, self.tests_all).pixel(column, row) {
                return pixel;
            }
        }
        unreachable!("the last precision leaves nothing open")
    }
}
