//! The ray tracer: a [`Plan`] in, rows of pixels out, each the pixel that exact arithmetic gives.
//!
//! Most pixels are traced by `wide`, many at once in plain binary64, where everything is decided beyond bounds that are
//! known beforehand. Every other pixel is traced in binary64 with a running bound on every number ([`Ball64`]). If each
//! comparison on its way and the rounding of its channels are decided by the bounds, it is proved. If not, it is traced
//! again in double-double ([`Ball106`]), and in numbers of some hundred bits (`long`) if it is to be certified; what that
//! cannot decide either is left to a [`Referee`], and what that does not settle gets its best value (`best`) and is counted.
//! The code is the same for all, generic over [`Real`].
//!
//! Reading order: [`Tracer::render_rows`], `pixel`, `integrator`, `intersect`, `shade`, `occlude`. `reject` keeps most
//! primitives away from them.
//!
//! Never here: files, encoding, progress (see `exec`); an epsilon.

mod best;
mod camera;
mod canvas;
mod counts;
mod draft;
mod integrator;
mod intersect;
mod judge;
pub mod kernels;
mod long;
mod look_up;
mod occlude;
mod pixel;
mod ray;
mod referee;
mod reject;
mod shade;
mod touch;
mod unrounded;
mod wide;

pub use best::BestValues;
pub use canvas::Canvas;
pub use counts::{Counts, Spared};
pub use referee::{Place, Referee};
pub use touch::Touches;
pub use unrounded::Unrounded;
#[cfg(feature = "testing")]
pub use wide::{fault::Fault, notes::Proved};

use std::ops::Range;
use std::sync::OnceLock;

use rayon::prelude::*;

use crate::math::{Ball64, Ball106, Real};
use crate::plan::{Plan, Settings, TileMask};
use crate::trace::camera::Camera;
use crate::trace::draft::Draft;
use crate::trace::integrator::Integrator;
use crate::trace::kernels::Backend;
use crate::trace::long::{LongCameras, LongStages};
use crate::trace::pixel::Sampling;
use crate::trace::wide::Wide;

/// Renders one image, rows at a time.
#[derive(Debug)]
pub struct Tracer<'p> {
    plan: Plan<'p>,
    sampling: Sampling,
    camera: Camera<Ball64>,
    fine_camera: Camera<Ball106>,
    long_cameras: OnceLock<LongCameras>,
    draft: Option<Draft>,
    wide: Option<Wide>,
    upon: Option<Upon<'p>>,
    referee: Option<&'p dyn Referee>,
    /// Makes what nothing decides, once it is needed.
    best: OnceLock<BestValues<'p>>,
}

/// An earlier image that an image is traced upon.
#[derive(Debug)]
struct Upon<'p> {
    canvas: &'p Canvas,
    /// The tiles that may differ; without it all do.
    changed: Option<TileMask>,
}

impl<'p> Tracer<'p> {
    /// Bands whose rows begin and end at multiples of this are rendered fastest.
    pub const TILE_ROWS: u32 = 16;

    /// Prepares to render what a plan has left.
    ///
    /// # Panics
    /// When the settings ask for samples not within 1…[`Settings::MAX_SAMPLES`], a `max_level` above
    /// [`Settings::MAX_LEVEL`], or a backend that this machine does not have.
    #[must_use]
    pub fn new(plan: Plan<'p>) -> Self {
        let backend = Backend::chosen(plan.settings.backend);
        Self::with_backend(plan, Some(backend))
    }

    /// Prepares to render by the packets of one backend, or none of them: no pixel depends on it.
    ///
    /// # Panics
    /// As [`Tracer::new`], and when this machine has no such backend.
    #[must_use]
    pub fn with_backend(plan: Plan<'p>, backend: Option<Backend>) -> Self {
        assert!(plan.settings.max_level <= Settings::MAX_LEVEL, "at most {} levels", Settings::MAX_LEVEL);
        let sampling = Sampling::new(&plan.settings);
        let camera: Camera<Ball64> = Camera::new(plan.fov_deg, sampling.steps_per_half_height());
        let draft = Draft::new(&plan, camera.step().value(), backend.unwrap_or(Backend::Scalar));
        let wide_backend = backend.filter(|_| draft.is_none());
        Self {
            draft,
            wide: wide_backend.and_then(|backend| Wide::new(&plan, camera.step(), backend)),
            camera,
            fine_camera: Camera::new(plan.fov_deg, sampling.steps_per_half_height()),
            long_cameras: OnceLock::new(),
            sampling,
            plan,
            upon: None,
            referee: None,
            best: OnceLock::new(),
        }
    }

    /// Takes the pixels outside of the tiles that may have changed from a canvas, and leaves all pixels there. Rows that
    /// are not rendered, because they are proved to be background, are taken to be that on the canvas too.
    #[must_use]
    pub fn upon(self, canvas: &'p Canvas, changed: Option<TileMask>) -> Self {
        Self { upon: Some(Upon { canvas, changed }), ..self }
    }

    /// Leaves to a referee the pixels that double-double does not decide.
    #[must_use]
    pub fn settled_by(self, referee: &'p dyn Referee) -> Self {
        Self { referee: Some(referee), ..self }
    }

    /// Makes packets wrong on purpose.
    #[cfg(feature = "testing")]
    #[must_use]
    pub fn with_fault(mut self, fault: Fault) -> Self {
        if let Some(wide) = &mut self.wide {
            wide.fault = fault;
        }
        self
    }

    /// Calls `visit` with the column, the row and the channels of each pixel of which packets prove the colour, not the bytes
    /// alone; of none, if there are no packets.
    #[cfg(feature = "testing")]
    pub fn for_proved(&self, mut visit: impl FnMut(u32, u32, &Proved)) {
        let Some(wide) = &self.wide else { return };
        let mut scratch = wide.scratch(true);
        for rect in Wide::tiles(&self.plan, 0..self.plan.settings.size.height()) {
            scratch.notes.iter_mut().for_each(|notes| notes.trail = Some(Vec::new()));
            wide.trace(&self.plan, &self.sampling, &rect, &mut scratch);
            for proved in scratch.notes.iter_mut().filter_map(|notes| notes.trail.take()).flatten() {
                let (column, row) = Wide::pixel_at(&rect, proved.place);
                if rect.columns.contains(&column) && rect.rows.contains(&row) {
                    visit(column, row, &proved);
                }
            }
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

    /// Does the work of [`Tracer::render_rows`] until `is_cancelled`, which is asked before each tile and each pixel that a tile
    /// leaves open, says so; what is
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
        // The first band ends where the tiles do.
        let n_first = (Self::TILE_ROWS - rows.start % Self::TILE_ROWS).min(rows.len() as u32);
        let (first, rest) = rgb.split_at_mut(n_first as usize * row_bytes);
        let middle = rows.start + n_first;
        let rest_bands = rest.par_chunks_mut(Self::TILE_ROWS as usize * row_bytes).enumerate().map(|(band, rgb)| {
            let start = middle + band as u32 * Self::TILE_ROWS;
            self.render_band(start..rows.end.min(start + Self::TILE_ROWS), rgb, is_cancelled)
        });
        let first_band = || self.render_band(rows.start..middle, first, is_cancelled);
        let sum = |mut total: Counts, counts: Counts| {
            total += counts;
            total
        };
        let (first, rest) = rayon::join(first_band, || rest_bands.reduce(Counts::default, sum));
        sum(first, rest)
    }

    /// Does the work of [`Tracer::render_rows_unless`] on the calling thread alone.
    ///
    /// # Panics
    /// As [`Tracer::render_rows`].
    pub fn render_band(&self, rows: Range<u32>, rgb: &mut [u8], is_cancelled: &(dyn Fn() -> bool + Sync)) -> Counts {
        let Some(Upon { canvas, changed }) = &self.upon else {
            return self.trace_band(rows, rgb, is_cancelled);
        };
        if changed.is_some() {
            canvas.get(&rows, rgb);
        }
        let counts = self.trace_band(rows.clone(), rgb, is_cancelled);
        canvas.put(&rows, rgb);
        counts
    }

    /// Gives a pixel its best value, in `rgb`, which holds `rows`, and on the canvas if there is one: for one that the referee
    /// has settled and takes back.
    pub fn take_back(&self, place: Place, rows: &Range<u32>, rgb: &mut [u8], counts: &mut Counts) {
        let width = self.plan.settings.size.width() as usize;
        let bytes = self.best_values().pixel(place.column, place.row, counts);
        pixel_of(rgb, rows, width, place).copy_from_slice(&bytes);
        if let Some(upon) = &self.upon {
            upon.canvas.put_pixel(place, bytes);
        }
    }

    fn best_values(&self) -> &BestValues<'p> {
        self.best.get_or_init(|| BestValues::new(self.plan.view, &self.plan.settings))
    }

    fn long_cameras(&self) -> &LongCameras {
        self.long_cameras.get_or_init(|| LongCameras::new(self.plan.fov_deg, self.sampling.steps_per_half_height()))
    }

    /// Tells whether a pixel has to be traced.
    fn is_new(&self, column: u32, row: u32) -> bool {
        let changed = self.upon.as_ref().and_then(|upon| upon.changed.as_ref());
        changed.is_none_or(|changed| changed.contains(column, row))
    }

    /// Traces the pixels of a band that are new.
    fn trace_band(&self, rows: Range<u32>, rgb: &mut [u8], is_cancelled: &(dyn Fn() -> bool + Sync)) -> Counts {
        self.assert_fits(&rows, rgb);
        if let Some(draft) = &self.draft {
            return self.draft_band(draft, rows, rgb, is_cancelled);
        }
        let mut settler = Settler::new(self);
        let Some(wide) = &self.wide else {
            settler.settle_all(&rows, rgb, is_cancelled);
            settler.close(&rows, rgb, is_cancelled);
            return settler.counts();
        };
        let width = self.plan.settings.size.width() as usize;
        let mut scratch = wide.scratch(self.referee.is_some());
        for rect in Wide::tiles(&self.plan, rows.clone()) {
            if is_cancelled() {
                break;
            }
            if !self.is_new(rect.columns.start, rect.rows.start) {
                continue;
            }
            wide.trace(&self.plan, &self.sampling, &rect, &mut scratch);
            scratch.write(&rect, rgb, width, rows.start);
            scratch.for_slow(&rect, |column, row| {
                if !is_cancelled() {
                    settler.settle(Place { row, column }, pixel_of(rgb, &rows, width, Place { row, column }));
                }
            });
        }
        settler.close(&rows, rgb, is_cancelled);
        let mut counts = settler.counts();
        counts += scratch.counts();
        counts
    }

    /// Does the work of [`Tracer::render_band`] in binary32.
    fn draft_band(
        &self,
        draft: &Draft,
        rows: Range<u32>,
        rgb: &mut [u8],
        is_cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Counts {
        let width = self.plan.settings.size.width() as usize;
        let mut scratch = draft.scratch();
        for rect in Wide::tiles(&self.plan, rows.clone()) {
            if is_cancelled() {
                break;
            }
            draft.trace(&self.plan, &self.sampling, &rect, &mut scratch);
            scratch.write(&rect, rgb, width, rows.start);
        }
        scratch.counts
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
}

/// Returns the bytes of a pixel among those of whole rows.
fn pixel_of<'a>(rgb: &'a mut [u8], rows: &Range<u32>, width: usize, place: Place) -> &'a mut [u8] {
    let first = ((place.row - rows.start) as usize * width + place.column as usize) * 3;
    &mut rgb[first..first + 3]
}

/// Settles the pixels of some rows one by one, in as fine an arithmetic as each needs.
struct Settler<'a, 'p> {
    tracer: &'a Tracer<'p>,
    coarse: Integrator<'a, 'p, Ball64>,
    fine: Integrator<'a, 'p, Ball106>,
    long: LongStages<'a, 'p>,
    /// What none of them decides.
    open: Vec<Place>,
    /// What is done for that.
    counts: Counts,
}

impl<'a, 'p> Settler<'a, 'p> {
    fn new(tracer: &'a Tracer<'p>) -> Self {
        Self {
            tracer,
            coarse: Integrator::new(&tracer.plan),
            fine: Integrator::new(&tracer.plan),
            long: LongStages::new(&tracer.plan),
            open: Vec::new(),
            counts: Counts::default(),
        }
    }

    /// Writes the bytes of a pixel, or keeps its place if it stays open.
    fn settle(&mut self, place: Place, rgb: &mut [u8]) {
        self.counts.settled_pixels += 1;
        match self.decide(place) {
            Some(bytes) => rgb.copy_from_slice(&bytes),
            None => self.open.push(place),
        }
    }

    /// Returns the bytes of a pixel; `None` when bounds leave it open.
    fn decide(&mut self, Place { row, column }: Place) -> Option<[u8; 3]> {
        let tracer = self.tracer;
        let pixel = tracer.sampling.pixel(column, row);
        let among = tracer.plan.tiles.candidates(column, row);
        if let Ok(bytes) = pixel::settle(&mut self.coarse, &tracer.camera, &pixel, among) {
            self.tell_touches(column, row, self.coarse.judge.touches);
            return Some(bytes);
        }
        if let Ok(bytes) = pixel::settle(&mut self.fine, &tracer.fine_camera, &pixel, among) {
            self.tell_touches(column, row, self.fine.judge.touches);
            self.fine.judge.counts.refined_pixels += 1;
            return Some(bytes);
        }
        if tracer.referee.is_some()
            && let Some(bytes) = self.long.settle(tracer.long_cameras(), row, &pixel, among, self.fine.given_up)
        {
            self.tell_touches(column, row, self.long.touches);
            self.counts.long_pixels += 1;
            return Some(bytes);
        }
        None
    }

    /// Counts the ties that were proved on the way to a pixel, and tells the referee.
    fn tell_touches(&mut self, column: u32, row: u32, touches: Touches) {
        if touches == Touches::default() {
            return;
        }
        self.counts.ties += u64::from(touches.total());
        if let Some(referee) = self.tracer.referee {
            referee.hear(column, row, touches);
        }
    }

    /// Settles all pixels of these rows that are new.
    fn settle_all(&mut self, rows: &Range<u32>, rgb: &mut [u8], is_cancelled: &dyn Fn() -> bool) {
        let row_bytes = self.tracer.plan.settings.size.width() as usize * 3;
        for (row, rgb) in rows.clone().zip(rgb.chunks_exact_mut(row_bytes)) {
            for (column, rgb) in (0..).zip(rgb.chunks_exact_mut(3)) {
                if is_cancelled() {
                    return;
                }
                if self.tracer.is_new(column, row) {
                    self.settle(Place { row, column }, rgb);
                }
            }
        }
    }

    /// Leaves to the referee what is open, and gives its best value to what stays so.
    fn close(&mut self, rows: &Range<u32>, rgb: &mut [u8], is_cancelled: &(dyn Fn() -> bool + Sync)) {
        if self.open.is_empty() || is_cancelled() {
            return;
        }
        let tracer = self.tracer;
        self.open.sort_unstable();
        let settled = match tracer.referee {
            Some(referee) => referee.settle(rows, &self.open, is_cancelled),
            None => vec![None; self.open.len()],
        };
        let width = tracer.plan.settings.size.width() as usize;
        for (&place, bytes) in self.open.iter().zip(settled) {
            if is_cancelled() {
                return;
            }
            let bytes = bytes.unwrap_or_else(|| {
                self.counts.unproved_pixels += 1;
                tracer.best_values().pixel(place.column, place.row, &mut self.counts)
            });
            pixel_of(rgb, rows, width, place).copy_from_slice(&bytes);
        }
    }

    /// Returns what has been done so far.
    fn counts(&self) -> Counts {
        let mut counts = self.counts;
        counts += self.coarse.judge.counts;
        counts += self.fine.judge.counts;
        counts += self.long.counts();
        counts
    }
}
