//! What the executor asks of `exact`: whole images, or the pixels that the tracer leaves open.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use crate::exact::{self, Record, Renderer, Tie, TiePlace, Ties};
use crate::exec::limit::Limit;
use crate::ir::SceneView;
use crate::plan::{Part, Precision, SampleAt, Settings, is_within_range, plan};
use crate::trace::{Counts, Referee, Touches, Tracer};

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
    let limit = Limit::none();
    let exactly = Exactly::new(view, settings, &limit);
    let rows = 0..settings.size.height();
    if exactly.makes_all() {
        return exactly.render_rows(rows, rgb, is_cancelled);
    }
    let tracer = Tracer::new(plan(view, settings));
    let tracer = if settings.precision.is_proved() { tracer.settled_by(&exactly) } else { tracer };
    tracer.render_rows_unless(rows, rgb, is_cancelled)
}

/// The exact renderer of one image, and what it has found.
#[derive(Debug)]
pub(super) struct Exactly<'p> {
    /// Makes all pixels, or those that double-double leaves open.
    renderer: Renderer<'p>,
    makes_all: bool,
    record: Mutex<Record>,
    limit: &'p Limit,
}

impl<'p> Exactly<'p> {
    /// Prepares an image; costs nothing until a pixel is asked for. What it takes is spent of `limit`.
    pub fn new(view: SceneView<'p>, settings: &Settings, limit: &'p Limit) -> Self {
        let makes_all = makes_all(&view, settings);
        let new = if makes_all { Renderer::new } else { Renderer::for_open_pixels };
        Self { renderer: new(view, &exact_settings(settings)), makes_all, record: Mutex::default(), limit }
    }

    /// Tells whether it is to make every pixel.
    pub fn makes_all(&self) -> bool {
        self.makes_all
    }

    /// Renders rows as [`Renderer::render_rows`] does.
    pub fn render_rows(&self, rows: Range<u32>, rgb: &mut [u8], is_cancelled: &(dyn Fn() -> bool + Sync)) -> Counts {
        let record = self.renderer.render_rows(rows, rgb, is_cancelled);
        let counts = Counts { exact_pixels: record.n_pixels(), ties: record.n_ties, ..Counts::default() };
        self.limit.spend(record.work);
        self.note(|total| total.merge(record));
        counts
    }

    /// Takes over what was found in pixels of an earlier image.
    pub fn take_over(&self, record: Record) {
        self.note(|total| total.merge(record));
    }

    /// Returns what was found, which does not depend on the order in which pixels were asked for.
    pub fn into_record(self) -> Record {
        Record::default().merged(self.record.into_inner().unwrap_or_else(PoisonError::into_inner))
    }

    fn note(&self, change: impl FnOnce(&mut Record)) {
        change(&mut self.record.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

/// Tells whether `exact` is to make every pixel: when asked to, or where lengths differ too much for the tracer's numbers, so
/// that nothing it says is proved.
fn makes_all(view: &SceneView<'_>, settings: &Settings) -> bool {
    match settings.precision {
        Precision::F32 | Precision::F64 => false,
        Precision::Certified => !is_within_range(view, settings.part),
        Precision::Exact => true,
    }
}

impl Referee for Exactly<'_> {
    fn settle(&self, column: u32, row: u32) -> ([u8; 3], u32) {
        let pixel = self.renderer.pixel(column, row);
        self.limit.spend(pixel.work);
        self.note(|record| record.add(column, row, &pixel));
        (pixel.rgb, TiePlace::of(column, row, &pixel).map_or(0, |place| place.n_ties()))
    }

    fn hear(&self, column: u32, row: u32, touches: Touches) {
        let proved = Ties::new(&[(Tie::Tangent, touches.n_tangents), (Tie::Rim, touches.n_rims)]);
        self.note(|record| record.add_ties(TiePlace { row, column, open: Ties::default(), proved }));
    }
}
