//! What the executor asks of `exact`: whole images, or the pixels that the tracer leaves open.

use std::ops::Range;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use rayon::prelude::*;

use crate::exact::{self, Allowance, Pixel, Record, Renderer, Tie, TiePlace, Ties};
use crate::exec::budget::{Attempt, Budget, Closed};
use crate::exec::limit::Limit;
use crate::exec::unproved::Unproved;
use crate::ir::SceneView;
use crate::plan::{Part, Precision, SampleAt, Settings, is_within_range, plan};
use crate::trace::{BestValues, Counts, Place, Referee, Touches, Tracer};

/// Says in the words of `exact` what a render is asked for; of the plan's settings its precision and passes mean nothing
/// there.
#[must_use]
pub fn exact_settings(settings: &Settings) -> exact::Settings {
    exact::Settings {
        width: settings.size.width(),
        height: settings.size.height(),
        part: match settings.part {
            Part::A => exact::Part::A,
            Part::B => exact::Part::B,
        },
        samples: settings.samples,
        sample_at: match settings.sample_at {
            SampleAt::Corner => exact::SampleAt::Corner,
            SampleAt::Centre => exact::SampleAt::Centre,
        },
        max_level: settings.max_level,
    }
}

/// Renders a whole image into `rgb`, 3 bytes a pixel, row by row from the top, in the arithmetic that the settings ask for, on
/// all threads of the current rayon pool, until `is_cancelled` says so; what is then in `rgb` is no image. Exact work is not
/// limited here.
///
/// # Panics
/// When `rgb` does not hold exactly the pixels of the image.
pub fn render_whole(
    view: SceneView<'_>,
    settings: &Settings,
    rgb: &mut [u8],
    is_cancelled: &(dyn Fn() -> bool + Sync),
) -> Counts {
    let exactly = Exactly::new(view, settings, Limit::NONE);
    let rows = 0..settings.size.height();
    if exactly.makes_all() {
        let mut counts = exactly.render_rows(rows, rgb, is_cancelled);
        counts += exactly.counts();
        return counts;
    }
    let tracer = Tracer::new(plan(view, settings));
    let tracer = if settings.precision.is_proved() { tracer.settled_by(&exactly) } else { tracer };
    let mut counts = tracer.render_rows_unless(rows, rgb, is_cancelled);
    counts += exactly.counts();
    counts
}

/// The exact renderer of one image, what it may take and what it has found.
#[derive(Debug)]
pub(super) struct Exactly<'p> {
    /// Makes all pixels, or those that double-double leaves open.
    renderer: Renderer<'p>,
    makes_all: bool,
    /// Makes what is not settled where it makes all: the tracer has its own.
    best: OnceLock<BestValues<'p>>,
    view: SceneView<'p>,
    settings: Settings,
    limit: Limit,
    findings: Mutex<Findings>,
}

/// What threads find out.
#[derive(Debug)]
struct Findings {
    budget: Budget,
    record: Record,
    unproved: Unproved,
    /// Ties of pixels that were made.
    n_ties: u64,
}

impl<'p> Exactly<'p> {
    /// Prepares an image; costs nothing until a pixel is asked for. What it takes is spent of `limit`.
    pub fn new(view: SceneView<'p>, settings: &Settings, limit: Limit) -> Self {
        let makes_all = makes_all(&view, settings);
        let new = if makes_all { Renderer::new } else { Renderer::for_open_pixels };
        let findings = Findings {
            budget: Budget::new(limit),
            record: Record::default(),
            unproved: Unproved::default(),
            n_ties: 0,
        };
        Self {
            renderer: new(view, &exact_settings(settings)),
            makes_all,
            best: OnceLock::new(),
            view,
            settings: settings.clone(),
            limit,
            findings: Mutex::new(findings),
        }
    }

    /// Tells whether it is to make every pixel.
    pub fn makes_all(&self) -> bool {
        self.makes_all
    }

    /// Renders rows into `rgb`, 3 bytes a pixel, on all threads of the current rayon pool; what it may not settle gets its best
    /// value.
    pub fn render_rows(&self, rows: Range<u32>, rgb: &mut [u8], is_cancelled: &(dyn Fn() -> bool + Sync)) -> Counts {
        if self.limit == Limit::NONE {
            let record = self.renderer.render_rows(rows, rgb, is_cancelled);
            let mut findings = self.findings();
            findings.n_ties += record.n_ties;
            findings.record.merge(record);
            return Counts::default();
        }
        let width = self.settings.size.width();
        let by_row = rgb.par_chunks_mut(width as usize * 3).zip(rows.into_par_iter());
        let counts = by_row.map(|(rgb, row)| self.render_row(row, rgb, is_cancelled));
        counts.reduce(Counts::default, |mut total, counts| {
            total += counts;
            total
        })
    }

    fn render_row(&self, row: u32, rgb: &mut [u8], is_cancelled: &(dyn Fn() -> bool + Sync)) -> Counts {
        let mut counts = Counts::default();
        let places: Vec<_> = (0..self.settings.size.width()).map(|column| Place { row, column }).collect();
        let settled = self.settle(&(row..row + 1), &places, is_cancelled);
        for ((rgb, place), settled) in rgb.as_chunks_mut().0.iter_mut().zip(places).zip(settled) {
            if is_cancelled() {
                break;
            }
            *rgb = settled.unwrap_or_else(|| {
                counts.unproved_pixels += 1;
                self.best_value(place, &mut counts)
            });
        }
        counts
    }

    /// Gives a pixel its best value, in `rgb`, which holds `rows`.
    pub fn take_back(&self, place: Place, rows: &Range<u32>, rgb: &mut [u8], counts: &mut Counts) {
        let width = self.settings.size.width() as usize;
        let pixel = (place.row - rows.start) as usize * width + place.column as usize;
        rgb.as_chunks_mut().0[pixel] = self.best_value(place, counts);
    }

    fn best_value(&self, place: Place, counts: &mut Counts) -> [u8; 3] {
        let best = self.best.get_or_init(|| BestValues::new(self.view, &self.settings));
        best.pixel(place.column, place.row, counts)
    }

    /// Tells whether pixels of some rows may have to be taken back.
    pub fn has_pending(&self, rows: &Range<u32>) -> bool {
        self.findings().budget.has_pending(rows)
    }

    /// Pays for what was made in some rows, above which all are closed; returns the places of those pixels that were made and
    /// are more than there may be: they are to be taken back.
    pub fn close(&self, rows: &Range<u32>) -> Vec<Place> {
        let mut findings = self.findings();
        let Closed { paid, taken_back } = findings.budget.close(rows);
        paid.iter().for_each(|(place, pixel)| findings.add(*place, pixel));
        taken_back.iter().for_each(|&place| findings.unproved.add(place));
        taken_back
    }

    /// Takes over what was found in pixels of an earlier image.
    pub fn take_over(&self, record: Record) {
        self.findings().record.merge(record);
    }

    /// Returns what was made so far, as far as it is paid.
    pub fn counts(&self) -> Counts {
        let findings = self.findings();
        Counts { exact_pixels: findings.record.n_pixels(), ties: findings.n_ties, ..Counts::default() }
    }

    /// Returns what was found, which does not depend on the order in which pixels were asked for.
    pub fn into_findings(self) -> (Record, Unproved) {
        let Findings { record, mut unproved, .. } = self.findings.into_inner().unwrap_or_else(PoisonError::into_inner);
        unproved.sort();
        (Record::default().merged(record), unproved)
    }

    fn findings(&self) -> MutexGuard<'_, Findings> {
        self.findings.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Findings {
    /// Adds a pixel that was made.
    fn add(&mut self, place: Place, pixel: &Pixel) {
        let Place { row, column } = place;
        self.record.add(column, row, pixel);
        self.n_ties += TiePlace::of(column, row, pixel).map_or(0, |place| u64::from(place.n_ties()));
    }
}

/// Tells whether `exact` is to make every pixel: when asked to, or where lengths differ too much for the tracer's numbers, so
/// that nothing it says is proved. An arithmetic of the tracer without such a range would do in place of it.
fn makes_all(view: &SceneView<'_>, settings: &Settings) -> bool {
    match settings.precision {
        Precision::F32 | Precision::F64 => false,
        Precision::Certified => !is_within_range(view, settings.part),
        Precision::Exact => true,
    }
}

impl Referee for Exactly<'_> {
    fn settle(
        &self,
        rows: &Range<u32>,
        open: &[Place],
        is_cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Vec<Option<[u8; 3]>> {
        let mut settled = vec![None; open.len()];
        let (mut attempts, mut own) = (Vec::new(), 0u64);
        for (&place, settled) in open.iter().zip(&mut settled) {
            let left = self.findings().budget.most_left(rows.start).saturating_sub(own);
            if left == 0 || is_cancelled() {
                break;
            }
            let max_work = left.min(self.limit.max_a_pixel);
            let pixel = self.renderer.pixel_within(place.column, place.row, Allowance { max_work, is_cancelled });
            *settled = pixel.as_ref().map(|pixel| pixel.rgb);
            match pixel {
                Some(pixel) if self.limit == Limit::NONE => self.findings().add(place, &pixel),
                // One that is not made has taken all that it may, and if that was all that is left, more.
                pixel => {
                    let stopped = if max_work == left { u64::MAX } else { max_work };
                    let charge = pixel.as_ref().map_or(stopped, |pixel| pixel.work);
                    own = own.saturating_add(charge);
                    attempts.push(Attempt { place, charge, pixel });
                }
            }
        }
        let mut findings = self.findings();
        let open_still = open.iter().zip(&settled).filter(|(_, settled)| settled.is_none());
        open_still.for_each(|(place, _)| findings.unproved.add(*place));
        findings.budget.hand_over(rows, attempts);
        settled
    }

    fn hear(&self, column: u32, row: u32, touches: Touches) {
        let proved = Ties::new(&[(Tie::Tangent, touches.n_tangents), (Tie::Rim, touches.n_rims)]);
        self.findings().record.add_ties(TiePlace { row, column, open: Ties::default(), proved });
    }
}
