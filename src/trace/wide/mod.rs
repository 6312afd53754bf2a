//! The wide tracer: packets of pixels in plain binary64, with bounds that are known beforehand.
//!
//! A tile goes through four stages ([`tile`]). Its eye rays find what they meet first ([`eye`]); the hits are shaded,
//! face by face ([`shade`], [`shadow`]); mirrors send rays on ([`mirror`]), which wait until a batch of them is
//! followed ([`queue`], [`follow`]), or are followed at once as long as they stay together ([`flock`], [`flight`],
//! [`horizon`]); what has found its colour is settled ([`settle`]). The bounds on all errors are worked out once for an
//! image ([`bounds`]), where they can be, and carried with the rays where not. A pixel of which every comparison and
//! the rounding of every channel is decided beyond them is the pixel that exact arithmetic gives. Every other pixel is
//! left to `pixel::settle`: silhouettes, edges of shadows, colours at a step, and what is not dealt with here at all.
//! So nothing here has to be right about a hard case, only about what is easy.
//!
//! The colour of a mirror's pixel is composed on the way in: it is min(A + B·x, H) for the colour x that is still to be
//! found, because no term of these mirrors is negative.
//!
//! Never here: ties, an epsilon.
#![allow(
    clippy::needless_range_loop,
    reason = "what is not inlined, as many an iterator, misses the backend's instructions"
)]

mod beam;
mod bounds;
mod cluster;
mod crowd;
mod eye;
pub(super) mod fault;
mod flight;
mod flock;
mod follow;
mod horizon;
mod mirror;
pub(super) mod notes;
mod patch;
mod queue;
mod settle;
mod shade;
mod shadow;
mod tile;

#[cfg(test)]
mod tests;

use std::ops::Range;
use std::sync::OnceLock;

pub(super) use self::bounds::FaceKind;

use crate::math::{Ball64, Real};
use crate::plan::{ObjectLists, Part, Pass, Plan, Search};
use crate::trace::Counts;
use crate::trace::kernels::Backend;
use crate::trace::pixel::Sampling;

use self::beam::Balls;
use self::bounds::{Bounds, Eye};
use self::cluster::Table;
use self::crowd::{Around, Few};
use self::eye::RowSphere;
use self::fault::Fault;
use self::flock::Flock;
use self::notes::Notes;
use self::patch::{Outlines, Patches};
use self::queue::{Channels, Packet, Waiting};
use self::shadow::LightOccluders;
use self::tile::TileJob;

/// The most columns of a tile.
const TILE_WIDTH: usize = 64;

/// The most rows of a tile.
const TILE_HEIGHT: usize = 16;

const TILE_PIXELS: usize = TILE_WIDTH * TILE_HEIGHT;

/// More objects that mirrors show are held against a packet of rays as balls, before they are tested.
const MAX_GONE_THROUGH: usize = 24;

/// More samples along a side of a pixel are left to the slower way: a cancellation is seen between tiles.
const MAX_SAMPLES: u32 = 16;

/// Images whose eye rays' coordinates are off by a larger share, in units of u, are left to finer arithmetic.
const MAX_DIR_ERROR: f64 = 8192.0;

/// What is prepared for one image.
#[derive(Debug)]
pub(super) struct Wide {
    backend: Backend,
    bounds: Bounds,
    /// Whether there are so many objects that what a packet may meet is looked up.
    is_crowd: bool,
    /// For each face, and then for each group, what can hide the lights from it, once it is met; none of a crowd.
    occluders: Vec<OnceLock<LightOccluders>>,
    /// What patches of faces are held against; none of a crowd, and where the plan is not to leave out occluders.
    outlines: Option<Outlines>,
    /// What packets of reflected rays are held against first.
    balls: Balls,
    /// Of the camera, rounded.
    step: f64,
    background: u32,
    /// Along a side of a pixel.
    samples: u32,
    /// Of a reflected ray that weighs less it is asked whether its pixel is settled; see `settle`.
    max_settled_weight: f64,
    /// Which channels the paths of mirrored colours have.
    channels: Channels,
    /// Whether all that mirrors show are spheres of a cluster, of one surface which is grey.
    shows_grey_cluster: bool,
    /// What is known of the cluster, if packets of its rays may go together.
    flock: Option<Flock>,
    /// What a test makes wrong.
    pub fault: Fault,
}

/// A rectangle of pixels inside of one tile of the plan.
#[derive(Clone, Debug)]
pub(super) struct Rect {
    pub columns: Range<u32>,
    pub rows: Range<u32>,
}

/// What a thread needs to trace tiles.
#[derive(Debug)]
pub(super) struct Scratch {
    /// Red + 2⁸·green + 2¹⁶·blue, row by row.
    pixels: Vec<u32>,
    /// For each pixel of several samples the sums of their channels and of the bounds on their errors.
    sums: [Vec<f64>; 4],
    /// For each packet the lanes that are left to finer arithmetic.
    slow: Vec<u32>,
    /// t of the nearest hits.
    t: Vec<f64>,
    hits: Vec<PacketHit>,
    rows: Vec<RowSphere>,
    waiting: Waiting,
    /// The rays that are followed.
    followed: Vec<Packet>,
    /// What is looked up in a crowd: for a packet of hits, and for one of reflected rays.
    around: Around,
    found: ObjectLists,
    /// What can hide the lights from the packets of the tile.
    patches: Patches,
    /// What is noted beside the pixels, if it is asked for.
    pub notes: Option<Notes>,
    counts: Counts,
}

/// The lanes of a packet that meet a face.
#[derive(Clone, Copy, Debug)]
struct PacketHit {
    face: u32,
    packet: u32,
    lanes: u32,
}

impl Wide {
    /// Prepares what a plan has left; `None` when none of it can be done wide.
    pub fn new(plan: &Plan<'_>, step: Ball64, backend: Backend) -> Option<Self> {
        let settings = &plan.settings;
        if settings.samples > MAX_SAMPLES {
            return None;
        }
        let is_crowd = plan.search == Search::Structures;
        let precision = backend.precision();
        let dir_error = 1.01 * step.error() / step.value() + 2.0 * precision.u;
        let samples = f64::from(settings.samples);
        let max_slope = 1.01 * step.value() * samples * f64::from(settings.size.height() + 2);
        let max_side = step.value() * samples * f64::from(settings.size.width() + 2);
        let is_moderate =
            step.value() > 1e-9 && max_slope < 1e6 && max_side < 1e6 && dir_error < MAX_DIR_ERROR * precision.u;
        let background = crate::trace::pixel::bytes_of(plan.scene.background)?;
        let eye = Eye::new(precision, dir_error, max_slope);
        let bounds = match (is_moderate, is_crowd) {
            (false, _) => return None,
            (true, false) => Bounds::new(plan, eye)?,
            (true, true) => Bounds::of_crowd(plan, eye)?.with_objects(plan),
        };
        let has_objects = bounds.has_objects;
        let ends_bounces = settings.samples == 1 && settings.passes.contains(Pass::Bounces);
        let max_settled_weight = if ends_bounces { settle::MAX_SETTLED_WEIGHT } else { 0.0 };
        let finds_shadows = !is_crowd && settings.part == Part::B && settings.passes.contains(Pass::Shadows);
        let outlines = finds_shadows.then(|| Outlines::new(&bounds.lights));
        let n_slots = if is_crowd { 0 } else { bounds.faces.len() + bounds.groups.len() };
        let are_equal = bounds.terms.iter().all(|terms| terms.reflectance == 0.0 || terms.is_grey());
        let table = bounds.cluster.as_ref().and_then(|cluster| cluster.table.as_ref());
        let is_grey = |table: &Table| bounds.terms[bounds.faces[table.face].surface].is_grey();
        let flock = match (&bounds.cluster, table) {
            (Some(cluster), Some(table)) if are_equal => Flock::new(plan, &bounds, cluster, table),
            _ => None,
        };
        Some(Self {
            backend,
            flock,
            shows_grey_cluster: are_equal && table.is_some_and(is_grey),
            bounds,
            channels: if are_equal { Channels::Equal } else { Channels::Three },
            is_crowd,
            occluders: std::iter::repeat_with(OnceLock::new).take(n_slots).collect(),
            outlines,
            balls: if has_objects && plan.mirrored().len() > MAX_GONE_THROUGH {
                Balls::new(&plan.scene, precision)
            } else {
                Balls::default()
            },
            step: step.value(),
            background: u32::from_le_bytes([background[0], background[1], background[2], 0]),
            samples: settings.samples,
            max_settled_weight,
            fault: Fault::NONE,
        })
    }

    /// Makes what a thread needs.
    ///
    /// `takes_notes`: whether notes are asked for.
    pub fn scratch(&self, takes_notes: bool) -> Scratch {
        Scratch {
            pixels: vec![0; TILE_PIXELS],
            sums: std::array::from_fn(|_| vec![0.0; if self.samples > 1 { TILE_PIXELS } else { 0 }]),
            slow: vec![0; TILE_PIXELS / 8],
            t: vec![0.0; TILE_PIXELS],
            hits: Vec::new(),
            rows: Vec::new(),
            waiting: Waiting::new(self.channels),
            followed: Vec::new(),
            around: Around::default(),
            found: ObjectLists::default(),
            patches: Patches::default(),
            notes: takes_notes.then(Notes::new),
            counts: Counts::default(),
        }
    }

    /// Cuts rows into tiles; each lies within one tile of the plan and starts at a multiple of eight columns.
    pub fn tiles(plan: &Plan<'_>, rows: Range<u32>) -> impl Iterator<Item = Rect> {
        let (width, height) = (plan.settings.size.width(), plan.tiles.height().min(TILE_HEIGHT as u32));
        let plan_width = plan.tiles.width();
        let cut = move |from: u32, end: u32, step: u32| end.min((from / step + 1) * step);
        let mut row = rows.start;
        let bands = std::iter::from_fn(move || {
            let band = row..cut(row, rows.end, height);
            row = band.end;
            (!band.is_empty()).then_some(band)
        });
        bands.flat_map(move |rows| {
            let mut column = 0;
            std::iter::from_fn(move || {
                let end = width.min(column + TILE_WIDTH as u32).min(cut(column, width, plan_width));
                let columns = column..end;
                column = end;
                (!columns.is_empty()).then(|| Rect { columns, rows: rows.clone() })
            })
        })
    }

    /// Returns the column and the row of a pixel by its number within a tile; it may lie beyond the image.
    #[cfg(feature = "testing")]
    pub fn pixel_at(rect: &Rect, place: usize) -> (u32, u32) {
        (rect.columns.start + (place % TILE_WIDTH) as u32, rect.rows.start + (place / TILE_WIDTH) as u32)
    }

    /// Traces a tile into the scratch.
    pub fn trace(&self, plan: &Plan<'_>, sampling: &Sampling, rect: &Rect, scratch: &mut Scratch) {
        let among = plan.tiles.candidates(rect.columns.start, rect.rows.start);
        if self.bounds.has_objects {
            let bounds = &self.bounds;
            let job = TileJob { wide: self, bounds, among, plan, sampling, rect, scratch, sample: [0; 2] };
            // Packets of sixteen would reach beyond narrower tiles.
            return if plan.tiles.width() >= 16 { self.backend.run_twofold(job) } else { self.backend.run(job) };
        }
        let Some(few) = Few::new(&self.bounds, plan, among) else {
            scratch.slow.fill(u32::MAX);
            return;
        };
        let (bounds, among) = (&few.bounds, few.candidates());
        self.backend.run(TileJob { wide: self, bounds, among, plan, sampling, rect, scratch, sample: [0; 2] });
    }
}

impl Scratch {
    /// Returns what has been done so far.
    pub fn counts(&self) -> Counts {
        Counts { largest_bound: self.notes.as_ref().map_or(0.0, Notes::largest_bound), ..self.counts }
    }

    /// Writes the pixels of the tile that was traced into an image `width` pixels wide, whose first row is `first_row`.
    pub fn write(&self, rect: &Rect, rgb: &mut [u8], width: usize, first_row: u32) {
        write_pixels(&self.pixels, rect, rgb, width, first_row);
    }

    /// Calls `settle` with the column and row of each pixel of the tile that is left to finer arithmetic.
    pub fn for_slow(&self, rect: &Rect, mut settle: impl FnMut(u32, u32)) {
        for (packet, lanes) in self.slow.iter().enumerate() {
            let mut rest = *lanes;
            while rest != 0 {
                let pixel = packet * 8 + rest.trailing_zeros() as usize;
                rest &= rest - 1;
                let (column, row) = ((pixel % TILE_WIDTH) as u32, (pixel / TILE_WIDTH) as u32);
                if column < rect.columns.len() as u32 && row < rect.rows.len() as u32 {
                    settle(rect.columns.start + column, rect.rows.start + row);
                }
            }
        }
    }
}

/// Writes the pixels of a tile, red + 2⁸·green + 2¹⁶·blue each, into an image.
pub(super) fn write_pixels(pixels: &[u32], rect: &Rect, rgb: &mut [u8], width: usize, first_row: u32) {
    let n_columns = rect.columns.len();
    for (pixels, row) in pixels.chunks_exact(TILE_WIDTH).zip(rect.rows.clone()) {
        let first = ((row - first_row) as usize * width + rect.columns.start as usize) * 3;
        let to = &mut rgb[first..first + n_columns * 3];
        for (to, pixel) in to.chunks_exact_mut(3).zip(pixels) {
            to.copy_from_slice(&pixel.to_le_bytes()[..3]);
        }
    }
}
