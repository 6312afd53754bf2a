//! The rigorous renderer: a scene in, the pixels that exact arithmetic gives out, proved.
//!
//! It follows the semantics formula by formula in [ball arithmetic](ball), so each comparison is either proved or open. An
//! open one makes the pixel again with twice the bits ([`LADDER`]); what is still open at the last precision is taken for a
//! tie, counted, listed with its place, and settled by the rule that the semantics have for equality; if its bound is wide, it
//! has the sign that was computed, and is counted and listed all the same. Before that `algebra` is asked, which proves ties
//! and near ties that are not too deep in mirrors. No pixel is decided by an epsilon and said to be proved.
//!
//! One rule is narrower than its text, because the original image of scene i6 says so in pixel (0, 180): the far rim of a
//! cylinder that a ray touches in passing, leaving the infinite wall as it comes down to the cap, is no hit.
//!
//! It settles what `trace` leaves open, and is what `trace` is held against. For that it shares
//! nothing with it but the IR, and takes no short ways but two ([`Renderer::testing_all`], [`Renderer::without_algebra`]). A helper that both used would
//! hide its faults from the comparison.
//!
//! Never here: `plan`, `trace` and `math`; files, the clock.

mod algebra;
mod attempt;
pub mod ball;
mod intersect;
mod reach;
mod real;
mod record;
mod scene;
mod settings;
mod shade;
mod tie;
mod vec3;

pub use attempt::Allowance;
pub use record::{Record, TiePlace};
pub use settings::{Part, SampleAt, Settings};
pub use tie::{Tie, Ties};

use std::ops::Range;
use std::sync::OnceLock;

use rayon::prelude::*;

use crate::exact::attempt::Attempt;
use crate::exact::real::Arithmetic;
use crate::exact::scene::{Body, Equation, Scene};
use crate::image::RgbImage;
use crate::ir::SceneView;

/// The precisions a pixel is tried with, in bits. Mirrors of 10⁻³⁰ of the scene, nine bounces deep, take some 2000.
pub const LADDER: [usize; 6] = [96, 192, 384, 768, 1536, 3072];

/// Pixels that a thread takes at a time.
const PIXELS_A_PIECE: usize = 16;

/// One pixel as exact arithmetic gives it.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixel {
    /// The bytes of the image.
    pub rgb: [u8; 3],
    /// 255 c per channel, before rounding down; nearest binary64 numbers to the midpoints.
    pub channels: [f64; 3],
    /// A bound on the distance of the truth from the midpoint of any of the channels.
    pub error: f64,
    /// The least distance of a channel's 255 c + 2⁻²⁰ to a whole number.
    pub slack: f64,
    /// The comparisons of equal quantities that were computed without rounding.
    pub proved_ties: Ties,
    /// Those that were proved equal by algebra.
    pub algebraic_ties: Ties,
    /// The comparisons that no precision of the ladder could decide. Without any the pixel is proved.
    pub open_ties: Ties,
    /// The precision that gave the pixel.
    pub bits: usize,
    /// What it took, all precisions together, in units of very roughly 50 ns: counted, not timed, so that it is the same
    /// on every machine.
    pub work: u64,
}

/// Renders one scene exactly.
#[derive(Debug)]
pub struct Renderer<'p> {
    view: SceneView<'p>,
    settings: Settings,
    ladder: Vec<usize>,
    bodies: OnceLock<Vec<Body<'p>>>,
    /// The surfaces that the eye lies on.
    eye_on: OnceLock<Vec<Equation>>,
    /// The scene at each precision of the ladder, once it was asked for.
    scenes: Vec<OnceLock<Scene>>,
    tests_all: bool,
    /// The first place on the ladder where algebra is asked; at the last it always is, unless this is beyond the ladder.
    algebra_from: usize,
}

impl<'p> Renderer<'p> {
    /// Prepares a scene for [`LADDER`]. Costs nothing until a pixel is asked for.
    ///
    /// # Panics
    /// When the settings ask for no pixels or no samples.
    #[must_use]
    pub fn new(view: SceneView<'p>, settings: &Settings) -> Self {
        Self::with_ladder(view, settings, &LADDER)
    }

    /// Prepares a scene for rising precisions of one's own, each at least 53.
    ///
    /// # Panics
    /// As [`Renderer::new`], and when there is no precision.
    #[must_use]
    pub fn with_ladder(view: SceneView<'p>, settings: &Settings, ladder: &[usize]) -> Self {
        assert!(settings.width > 0 && settings.height > 0 && settings.samples > 0, "no pixels or no samples");
        assert!(!ladder.is_empty(), "no precision");
        let scenes = ladder.iter().map(|_| OnceLock::new()).collect();
        let (settings, ladder) = (settings.clone(), ladder.to_vec());
        Self {
            view,
            settings,
            ladder,
            bodies: OnceLock::new(),
            eye_on: OnceLock::new(),
            scenes,
            tests_all: false,
            algebra_from: 1,
        }
    }

    /// Tests every ray against every body, without the filter in binary64.
    #[must_use]
    pub fn testing_all(self) -> Self {
        Self { tests_all: true, ..self }
    }

    /// Leaves to precision alone what algebra would decide.
    #[must_use]
    pub fn without_algebra(self) -> Self {
        Self { algebra_from: usize::MAX, ..self }
    }

    /// Prepares for pixels that as many bits as the first of the ladder have left open: those with ties, as a rule. Algebra
    /// is asked at once.
    #[must_use]
    pub fn for_open_pixels(view: SceneView<'p>, settings: &Settings) -> Self {
        Self { algebra_from: 0, ..Self::new(view, settings) }
    }

    /// Renders one pixel, however long it takes.
    ///
    /// # Panics
    /// When it lies outside the image.
    #[must_use]
    pub fn pixel(&self, column: u32, row: u32) -> Pixel {
        self.pixel_within(column, row, Allowance::UNLIMITED).expect("nothing ends the work early")
    }

    /// Renders one pixel unless it takes more work than is allowed, or is cancelled.
    ///
    /// # Panics
    /// As [`Renderer::pixel`].
    #[must_use]
    pub fn pixel_within(&self, column: u32, row: u32, allowance: Allowance<'_>) -> Option<Pixel> {
        assert!(column < self.settings.width && row < self.settings.height, "a pixel outside the image");
        let mut work = 0;
        for (i, &bits) in self.ladder.iter().enumerate() {
            let is_last = i + 1 == self.ladder.len();
            // Most pixels need no algebra, and remembering how numbers were made takes time.
            let has_algebra = i >= self.algebra_from || is_last && self.algebra_from < usize::MAX;
            let arithmetic = Arithmetic { bits, has_algebra };
            let scene = self.scenes[i].get_or_init(|| Scene::new(&self.view, &self.settings, arithmetic));
            let rest = Allowance { max_work: allowance.max_work - work, ..allowance };
            let attempt = Attempt::new(self, scene, is_last, rest);
            let pixel = attempt.pixel(column, row);
            if attempt.is_stopped() || attempt.work() > rest.max_work {
                return None;
            }
            work += attempt.work();
            if let Ok(pixel) = pixel {
                return Some(Pixel { work, ..pixel });
            }
        }
        unreachable!("the last precision leaves nothing open")
    }

    fn bodies(&self) -> &[Body<'p>] {
        self.bodies.get_or_init(|| scene::bodies(&self.view, self.settings.part))
    }

    fn eye_on(&self) -> &[Equation] {
        self.eye_on.get_or_init(|| scene::holding(self.bodies(), [0.0; 3]))
    }

    /// Renders `rows` into `rgb`, 3 bytes a pixel, row by row from the top, on all threads of the current rayon pool, until
    /// `is_cancelled`, which is asked before each pixel and now and then within one, says so; what is then in `rgb` is no image.
    ///
    /// # Panics
    /// When `rgb` does not hold exactly the pixels of `rows`, or a row lies outside the image.
    pub fn render_rows(&self, rows: Range<u32>, rgb: &mut [u8], is_cancelled: &(dyn Fn() -> bool + Sync)) -> Record {
        let width = self.settings.width as usize;
        assert!(rows.end <= self.settings.height, "a row outside the image");
        assert_eq!(rgb.len(), rows.len() * width * 3, "another number of pixels");
        let first = rows.start as usize * width;
        let pieces = rgb.par_chunks_mut(3 * PIXELS_A_PIECE).enumerate();
        let records = pieces.map(|(piece_idx, rgb)| {
            let mut record = Record::default();
            for (i, rgb) in rgb.chunks_exact_mut(3).enumerate() {
                if is_cancelled() {
                    break;
                }
                let place = first + piece_idx * PIXELS_A_PIECE + i;
                let (column, row) = ((place % width) as u32, (place / width) as u32);
                let allowance = Allowance { is_cancelled, ..Allowance::UNLIMITED };
                let Some(pixel) = self.pixel_within(column, row, allowance) else { break };
                rgb.copy_from_slice(&pixel.rgb);
                record.add(column, row, &pixel);
            }
            record
        });
        records.reduce(Record::default, Record::merged)
    }

    /// Renders the whole image.
    #[must_use]
    pub fn image(&self) -> (RgbImage, Record) {
        let (width, height) = (self.settings.width, self.settings.height);
        let mut image = RgbImage::new(width, height);
        let record = self.render_rows(0..height, image.rgb_mut(), &|| false);
        (image, record)
    }
}
