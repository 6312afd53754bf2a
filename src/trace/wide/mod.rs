//! The wide tracer: packets of pixels in plain binary64, with bounds that are known beforehand.
//!
//! A tile goes through three stages. Its eye rays find what they meet first ([`eye`]); the hits are shaded, face by face
//! ([`shade`], [`shadow`]); mirrors send rays on ([`mirror`]), which wait until a batch of them is followed ([`queue`]). The
//! bounds on all errors are worked out once for an image ([`bounds`]), where they can be, and carried with the rays where
//! not. A pixel of which every comparison and the rounding of every channel is decided beyond them is the pixel that
//! exact arithmetic gives. Every other pixel is left to `pixel::settle`: silhouettes, edges of shadows, colours at a step,
//! and what is not dealt with here at all. So nothing here has to be right about a hard case, only about what is easy.
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
mod mirror;
pub(super) mod notes;
mod queue;
mod shade;
mod shadow;

#[cfg(test)]
mod tests;

use std::ops::Range;
use std::sync::OnceLock;

pub(super) use self::bounds::FaceKind;

use crate::math::{Ball64, Real};
use crate::plan::{Candidates, ObjectLists, Plan, Search};
use crate::trace::Counts;
use crate::trace::kernels::{Backend, Job, Lanes, Mask};
use crate::trace::pixel::Sampling;

use self::beam::Balls;
use self::bounds::{Bounds, Face};
use self::cluster::{Cluster, Table};
use self::crowd::{Around, Few};
use self::eye::{EyeRays, Nearest, RowSphere};
use self::fault::Fault;
use self::mirror::Met;
use self::notes::Notes;
use self::queue::{Channels, Number, Packet, Paths, Waiting};
use self::shade::{Colors, Points};
use self::shadow::LightOccluders;

/// The most columns of a tile.
const TILE_WIDTH: usize = 64;

/// The most rows of a tile.
const TILE_HEIGHT: usize = 16;

const TILE_PIXELS: usize = TILE_WIDTH * TILE_HEIGHT;

/// More objects that mirrors show are held against a packet of rays as balls, before they are tested.
const MAX_GONE_THROUGH: usize = 24;

/// More samples along a side of a pixel are left to the slower way: a cancellation is seen between tiles.
const MAX_SAMPLES: u32 = 16;

/// What is prepared for one image.
#[derive(Debug)]
pub(super) struct Wide {
    backend: Backend,
    bounds: Bounds,
    /// Whether there are so many objects that what a packet may meet is looked up.
    is_crowd: bool,
    /// For each face, and then for each group, what can hide the lights from it, once it is met; none of a crowd.
    occluders: Vec<OnceLock<LightOccluders>>,
    /// What packets of reflected rays are held against first.
    balls: Balls,
    /// Of the camera, rounded.
    step: f64,
    background: u32,
    /// Along a side of a pixel.
    samples: u32,
    /// Which channels the paths of mirrored colours have.
    channels: Channels,
    /// Whether all that mirrors show are spheres of a cluster, of one surface which is grey.
    shows_grey_cluster: bool,
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
        let dir_error = 1.01 * step.error() / step.value() + 2.0 * bounds::U;
        let samples = f64::from(settings.samples);
        let max_slope = 1.01 * step.value() * samples * f64::from(settings.size.height() + 2);
        let max_side = step.value() * samples * f64::from(settings.size.width() + 2);
        let is_moderate = step.value() > 1e-9 && max_slope < 1e6 && max_side < 1e6 && dir_error < 1e-12;
        let background = crate::trace::pixel::bytes_of(plan.scene.background)?;
        let bounds = match (is_moderate, is_crowd) {
            (false, _) => return None,
            (true, false) => Bounds::new(plan, dir_error, max_slope)?,
            (true, true) => Bounds::of_crowd(plan, dir_error, max_slope)?.with_objects(plan),
        };
        let has_objects = bounds.has_objects;
        let n_slots = if is_crowd { 0 } else { bounds.faces.len() + bounds.groups.len() };
        let are_equal = bounds.terms.iter().all(|terms| terms.reflectance == 0.0 || terms.is_grey());
        let table = bounds.cluster.as_ref().and_then(|cluster| cluster.table.as_ref());
        let is_grey = |table: &Table| bounds.terms[bounds.faces[table.face].surface].is_grey();
        Some(Self {
            backend,
            shows_grey_cluster: are_equal && table.is_some_and(is_grey),
            bounds,
            channels: if are_equal { Channels::Equal } else { Channels::Three },
            is_crowd,
            occluders: std::iter::repeat_with(OnceLock::new).take(n_slots).collect(),
            balls: if has_objects && plan.mirrored().len() > MAX_GONE_THROUGH {
                Balls::new(&plan.scene)
            } else {
                Balls::default()
            },
            step: step.value(),
            background: u32::from_le_bytes([background[0], background[1], background[2], 0]),
            samples: settings.samples,
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

/// One tile.
struct TileJob<'a> {
    wide: &'a Wide,
    /// The constants of what its rays can meet, of all objects or of its own.
    bounds: &'a Bounds,
    /// What its eye rays can meet, by number in the constants.
    among: Candidates<'a>,
    plan: &'a Plan<'a>,
    sampling: &'a Sampling,
    rect: &'a Rect,
    scratch: &'a mut Scratch,
    /// Column and row, within its pixel, of the sample at hand.
    sample: [u32; 2],
}

impl Job for TileJob<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self) {
        self.scratch.slow.fill(0);
        self.scratch.pixels.fill(self.wide.background);
        let samples = self.wide.samples;
        let n_pixels = self.rect.columns.len() * self.rect.rows.len();
        self.scratch.counts.eye_rays += n_pixels as u64 * u64::from(samples * samples);
        if self.among.is_empty() {
            return;
        }
        self.scratch.sums.iter_mut().for_each(|sums| sums.fill(0.0));
        // The lanes of a packet are the same sample of neighbouring pixels.
        for sample in 0..samples * samples {
            self.sample = [sample % samples, sample / samples];
            self.meet::<L>(self.among);
            self.wide.fault.spoil_roots(&mut self.scratch.t);
            self.scratch.hits.sort_unstable_by_key(|hit| (hit.face, hit.packet));
            self.shade::<L>();
        }
        if samples > 1 {
            self.average::<L>();
        }
    }
}

impl<'a> TileJob<'a> {
    /// Returns dx of the packet's eye rays and dy of its row.
    #[inline(always)]
    fn directions<L: Lanes>(&self, packet: usize) -> (L, f64) {
        let (column, row) = (packet * L::N % TILE_WIDTH, packet * L::N / TILE_WIDTH);
        let (left, top) =
            self.sampling.first_sample(self.rect.columns.start + column as u32, self.rect.rows.start + row as u32);
        let (left, top) = (left + i64::from(2 * self.sample[0]), top - i64::from(2 * self.sample[1]));
        let steps = numbers::<L>() * L::splat(f64::from(2 * self.wide.samples));
        ((L::splat(left as f64) + steps) * L::splat(self.wide.step), top as f64 * self.wide.step)
    }

    /// Finds what each eye ray meets first.
    #[inline(always)]
    fn meet<L: Lanes>(&mut self, among: Candidates<'_>) {
        let bounds = self.bounds;
        let n_packets = self.rect.columns.len().div_ceil(L::N);
        self.scratch.hits.clear();
        self.scratch.counts.tests += (n_packets * self.rect.rows.len() * among.len() * L::N) as u64;
        for row in 0..self.rect.rows.len() {
            let first = row * (TILE_WIDTH / L::N);
            let (_, dy) = self.directions::<L>(first);
            self.scratch.rows.clear();
            for &i in among.spheres {
                self.scratch.rows.push(RowSphere::new(&bounds.spheres[i as usize], dy));
            }
            for packet in first..first + n_packets {
                let (dx, _) = self.directions::<L>(packet);
                let a_wall = dx * dx + L::splat(1.0);
                let rays = EyeRays { dx, a_wall, a: a_wall + L::splat(dy * dy), dy };
                let mut nearest = Nearest::nothing();
                for k in 0..among.spheres.len() {
                    let sphere = &bounds.spheres[among.spheres[k] as usize];
                    eye::meet_sphere(&mut nearest, bounds, &rays, sphere, &self.scratch.rows[k]);
                }
                for &i in among.cylinders {
                    eye::meet_cylinder(&mut nearest, bounds, &rays, &bounds.cylinders[i as usize]);
                }
                let met = nearest.met() & !nearest.doubt;
                self.mark_slow::<L>(packet, nearest.doubt);
                if met.any() {
                    self.record(packet, &nearest, met.bits());
                }
                if self.wide.samples > 1 {
                    let background = shade::splat_each(self.plan.scene.background.to_array());
                    self.add_up(packet, background, L::splat(0.0), !nearest.met());
                }
            }
        }
    }

    /// Records the hits of a packet, face by face.
    #[inline(always)]
    fn record<L: Lanes>(&mut self, packet: usize, nearest: &Nearest<L>, met: u32) {
        nearest.t.store(&mut self.scratch.t[packet * L::N..]);
        let mut faces = [0.0; eye::MAX_LANES];
        nearest.face.store(&mut faces);
        let mut rest = met;
        while rest != 0 {
            let face = faces[rest.trailing_zeros() as usize];
            let lanes = nearest.face.eq(L::splat(face)).bits() & rest;
            rest &= !lanes;
            self.scratch.hits.push(PacketHit { face: face as u32, packet: packet as u32, lanes });
        }
    }

    #[inline(always)]
    fn mark_slow<L: Lanes>(&mut self, packet: usize, lanes: L::Mask) {
        mark(&mut self.scratch.slow, packet * L::N, lanes.bits());
    }

    /// Shades what eye rays have met, and sends on the rays of mirrors.
    #[inline(always)]
    fn shade<L: Lanes>(&mut self) {
        let n_hits = self.scratch.hits.len();
        let mut hit_idx = 0;
        loop {
            while hit_idx < n_hits && !self.scratch.waiting.is_full::<L>() {
                self.shade_packet::<L>(self.scratch.hits[hit_idx]);
                hit_idx += 1;
            }
            let is_last = hit_idx == n_hits;
            while self.follow::<L>(is_last) {}
            if is_last {
                return;
            }
        }
    }

    /// Follows all rays that wait by one level; `false` when there are none, or only fewer than fill a packet, which stay
    /// unless they are the last.
    #[inline(always)]
    fn follow<L: Lanes>(&mut self, is_last: bool) -> bool {
        let mut followed = std::mem::take(&mut self.scratch.followed);
        let n_packets = self.scratch.waiting.take::<L>(&mut followed, is_last);
        for packet in &followed[..n_packets] {
            self.follow_packet::<L>(packet);
        }
        self.scratch.followed = followed;
        n_packets > 0
    }

    /// Shades a packet of hits of eye rays.
    #[inline(always)]
    fn shade_packet<L: Lanes>(&mut self, hit: PacketHit) {
        let (packet, lanes) = (hit.packet as usize, L::Mask::from_bits(hit.lanes));
        let face = &self.bounds.faces[hit.face as usize];
        let terms = &self.wide.bounds.terms[face.surface];
        let at = self.points::<L>(face, packet, lanes);
        let colors = self.local::<L, false>(face, false, &at);
        self.mark_slow::<L>(packet, lanes & colors.doubt);
        let sure = lanes & !colors.doubt;
        if terms.reflectance > 0.0 {
            self.send_on(face, &at, &colors, &eye_paths(packet), sure);
        } else if self.wide.samples > 1 {
            self.add_up(packet, colors.color, colors.error, sure);
        } else {
            self.settle_packet(packet, colors.color, colors.error, sure);
        }
    }

    /// Writes the pixels of a packet whose colours are found.
    #[inline(always)]
    fn settle_packet<L: Lanes>(&mut self, packet: usize, color: [L; 3], error: L, lanes: L::Mask) {
        let error = self.wide.fault.bound(error);
        let (bytes, proved) = shade::quantise(color, error);
        bytes.store_whole(lanes & proved, &mut self.scratch.pixels[packet * L::N..]);
        self.note(numbers::<L>() + L::splat((packet * L::N) as f64), color, error, lanes & proved);
        self.mark_slow::<L>(packet, lanes & !proved);
    }

    /// Notes what was rounded to bytes, if notes are asked for.
    #[inline(always)]
    #[cfg_attr(not(feature = "testing"), allow(unused_variables, reason = "only tests note every pixel"))]
    fn note<L: Lanes>(&mut self, places: L, color: [L; 3], error: L, lanes: L::Mask) {
        if let Some(notes) = &mut self.scratch.notes {
            notes.note_errors(error, lanes);
            #[cfg(feature = "testing")]
            notes.note_pixels(places, color, error, lanes);
        }
    }

    /// Adds a packet of samples to their pixels.
    #[inline(always)]
    fn add_up<L: Lanes>(&mut self, packet: usize, color: [L; 3], error: L, lanes: L::Mask) {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let channels = [color[0].min(one).max(zero), color[1].min(one).max(zero), color[2].min(one).max(zero), error];
        for k in 0..4 {
            let sums = &mut self.scratch.sums[k][packet * L::N..];
            (L::load(sums) + L::select(lanes, channels[k], zero)).store(sums);
        }
    }

    /// Settles pixels by the sums of their samples.
    #[inline(always)]
    fn average<L: Lanes>(&mut self) {
        let n_samples = f64::from(self.wide.samples * self.wide.samples);
        // Each sum of n numbers up to 1 loses at most n roundings of n, and the division one more.
        let rounding = L::splat(2.0 * (n_samples + 1.0) * bounds::U);
        let n = L::splat(n_samples);
        for packet in 0..TILE_PIXELS / L::N {
            let mut sums = [n; 4];
            for k in 0..4 {
                sums[k] = L::load(&self.scratch.sums[k][packet * L::N..]);
            }
            let [red, green, blue, error] = sums;
            let every = L::Mask::from_bits(u32::MAX);
            self.settle_packet(packet, [red / n, green / n, blue / n], error / n + rounding, every);
        }
    }

    /// Works out the points where a packet of eye rays meets a face.
    #[inline(always)]
    fn points<L: Lanes>(&self, face: &Face, packet: usize, active: L::Mask) -> Points<L> {
        let (dx, dy) = self.directions::<L>(packet);
        let t = L::load(&self.scratch.t[packet * L::N..]);
        let (dy, zero, one) = (L::splat(dy), L::splat(0.0), L::splat(1.0));
        let terms = &self.wide.bounds.terms[face.surface];
        let is_mirror = terms.reflectance > 0.0;
        let mut view = [zero; 3];
        if terms.has_specular || is_mirror || face.is_vague {
            let per_length = one / (dx * dx + (dy * dy + one)).sqrt();
            view = [-(dx * per_length), -(dy * per_length), per_length];
        }
        let [x, y, z] = [dx * t, dy * t, -t];
        let per_radius = L::splat(face.per_radius);
        let [cx, cy, cz] = face.center;
        let (nx, nz) = ((x - L::splat(cx)) * per_radius, (z - L::splat(cz)) * per_radius);
        let (point, normal) = match face.kind {
            FaceKind::Sphere => ([x, y, z], [nx, (y - L::splat(cy)) * per_radius, nz]),
            FaceKind::Wall => ([x, y, z], [nx, zero, nz]),
            FaceKind::LowerCap => ([x, L::splat(cy), z], [zero, L::splat(-1.0), zero]),
            FaceKind::UpperCap => ([x, L::splat(cy), z], [zero, one, zero]),
        };
        let cosine = shade::dot(normal, view);
        let mut point_error = L::splat(face.eye_point_error);
        let mut normal_error = L::splat(face.eye_normal_error);
        if face.is_vague || (is_mirror && matches!(face.kind, FaceKind::Sphere | FaceKind::Wall)) {
            // Reflections multiply the error, so it is taken as it is here, not as it may be at the silhouette.
            point_error = L::splat(1.1 * face.eye_error_at_right_angles) / cosine;
            normal_error = point_error * per_radius.abs() + L::splat(4.0 * bounds::U);
        }
        let dir_error = L::splat(2.0 * self.wide.bounds.eye_roundoff);
        let length_error = normal_error * L::splat(0.5);
        let equation = L::splat(f64::from(face.equation));
        Points { point, normal, view, cosine, point_error, normal_error, length_error, dir_error, equation, active }
    }

    /// Shades a packet of hits without their reflections, on one face or, if it is shared, on those of its group.
    #[inline(always)]
    fn local<L: Lanes, const GREY: bool>(&mut self, face: &Face, is_shared: bool, at: &Points<L>) -> Colors<L> {
        if !GREY && self.wide.is_crowd {
            return self.local_in_crowd(face, at);
        }
        let bounds = &self.wide.bounds;
        let shared = face.group.filter(|_| is_shared).map(|group| group as usize);
        let slot = shared.map_or_else(|| face_index(bounds, face), |group| bounds.faces.len() + group);
        let occluders = self.wide.occluders[slot].get_or_init(|| collect_occluders(bounds, self.plan, face, shared));
        let colors = shade::shade::<L, GREY>(&bounds.lights, &bounds.terms[face.surface], occluders, at);
        self.scratch.counts.shadow_rays += u64::from(colors.shadow_rays);
        colors
    }

    /// Does the work of [`TileJob::local`] with what is looked up for the packet.
    #[inline(always)]
    fn local_in_crowd<L: Lanes>(&mut self, face: &Face, at: &Points<L>) -> Colors<L> {
        let (all, Scratch { around, counts, .. }) = (&self.wide.bounds, &mut *self.scratch);
        let terms = &all.terms[face.surface];
        let is_known = !(terms.has_diffuse || terms.has_specular) || around.look_up(all, self.plan, face, at);
        if !is_known {
            let zero = L::splat(0.0);
            return Colors { color: [zero; 3], error: zero, doubt: at.active, shadow_rays: 0 };
        }
        let colors = shade::shade::<L, false>(around.lights(all), terms, &around.occluders, at);
        counts.shadow_rays += u64::from(colors.shadow_rays);
        colors
    }

    /// Puts the reflections of a packet of hits into the queue.
    #[inline(always)]
    fn send_on<L: Lanes>(&mut self, face: &Face, at: &Points<L>, colors: &Colors<L>, paths: &Paths<L>, lanes: L::Mask) {
        let terms = &self.wide.bounds.terms[face.surface];
        if !terms.is_nonnegative {
            self.mark_places(paths.pixel, lanes);
            return;
        }
        self.scratch.counts.reflected_rays += u64::from(lanes.bits().count_ones());
        self.scratch.waiting.push(&mirror::reflect(at), &mirror::go_on(terms, colors, paths), lanes);
    }

    /// Follows a packet of rays.
    #[inline(always)]
    fn follow_packet<L: Lanes>(&mut self, packet: &Packet) {
        if self.wide.shows_grey_cluster
            && let Some(cluster) = &self.bounds.cluster
            && let Some(table) = &cluster.table
        {
            self.follow_in_cluster::<L>(cluster, table, packet);
            return;
        }
        if self.wide.is_crowd || !self.wide.balls.are_none() {
            self.find_and_follow::<L>(packet);
            return;
        }
        self.follow_among::<L>(self.listed::<L>(packet), packet);
    }

    /// Returns what the plan lists for a packet of rays.
    #[inline(always)]
    fn listed<L: Lanes>(&self, packet: &Packet) -> Candidates<'a> {
        let leaving = packet.common::<L>(Number::Leaving).and_then(|equation| self.bounds.owner(equation));
        leaving.map_or_else(|| self.plan.mirrored(), |object| self.plan.mirrored_by(object))
    }

    /// Finds what a packet of rays may meet, and follows it.
    #[inline(always)]
    fn find_and_follow<L: Lanes>(&mut self, packet: &Packet) {
        let TileJob { wide, plan, sampling, rect, sample, bounds, .. } = *self;
        let (rays, lanes) = (packet.rays::<L>(), packet.lanes::<L>());
        let mut found = std::mem::take(&mut self.scratch.found);
        let among = if wide.balls.list(&rays, lanes, &mut found) {
            Some(found.as_candidates())
        } else if !wide.is_crowd {
            Some(self.listed::<L>(packet))
        } else {
            crowd::find_along::<L>(plan, &rays, lanes, &mut found).then(|| found.as_candidates())
        };
        // The constants of a crowd may still have to be worked out.
        let few = among.filter(|_| !wide.bounds.has_objects).and_then(|among| Few::new(&wide.bounds, plan, among));
        let known = match &few {
            Some(few) => Some((&few.bounds, few.candidates())),
            None => among.filter(|_| wide.bounds.has_objects).map(|among| (bounds, among)),
        };
        match known {
            None => self.mark_places::<L>(packet.get(Number::Pixel), lanes),
            Some((bounds, among)) => {
                let scratch = &mut *self.scratch;
                TileJob { wide, bounds, among, plan, sampling, rect, scratch, sample }.follow_among::<L>(among, packet);
            }
        }
        self.scratch.found = found;
    }

    /// Follows a packet of rays among spheres of one grey surface that form a cluster.
    #[inline(always)]
    fn follow_in_cluster<L: Lanes>(&mut self, cluster: &Cluster, table: &Table, packet: &Packet) {
        let bounds = self.bounds;
        let among = self.plan.mirrored().spheres;
        self.scratch.counts.tests += among.len() as u64 * u64::from(packet.lanes::<L>().bits().count_ones());
        let rays = packet.rays::<L>();
        let nearest = mirror::meet_cluster(cluster, &bounds.mirrored, among, &rays, false);
        let met = self.finish_missed(packet, &nearest);
        if met.any() {
            let hit = Met::of_table(table, nearest.face);
            let (at, vague) = mirror::points::<L>(bounds, &hit, &rays, nearest.t, met);
            self.mark_places::<L>(packet.get(Number::Pixel), vague);
            self.shade_reflected::<L, true>(&bounds.faces[table.face], true, packet, &at);
        }
    }

    /// Follows a packet of rays to what it meets of the candidates.
    #[inline(always)]
    fn follow_among<L: Lanes>(&mut self, among: Candidates<'_>, packet: &Packet) {
        let (bounds, active) = (self.bounds, packet.lanes::<L>());
        self.scratch.counts.tests += among.len() as u64 * u64::from(active.bits().count_ones());
        let nearest = mirror::nearest_hit::<L>(bounds, among.spheres, among.cylinders, &packet.rays(), active);
        let met = self.finish_missed(packet, &nearest);
        let mut faces = eye::LaneArray([0.0; eye::MAX_LANES]);
        nearest.face.store(&mut faces.0);
        let faces = &faces.0;
        let mut rest = met.bits();
        while rest != 0 {
            let number = faces[rest.trailing_zeros() as usize];
            let face = &bounds.faces[number as usize];
            let mut lanes = nearest.face.eq(L::splat(number)).bits() & rest;
            rest &= !lanes;
            let mut hit = Met::one(face);
            let (mut others, mut is_shared) = (if face.group.is_some() { rest } else { 0 }, false);
            while others != 0 {
                let number = faces[others.trailing_zeros() as usize];
                let other = &bounds.faces[number as usize];
                let its_lanes = nearest.face.eq(L::splat(number)).bits() & others;
                others &= !its_lanes;
                if other.group == face.group {
                    hit = hit.but(L::Mask::from_bits(its_lanes), other);
                    lanes |= its_lanes;
                    rest &= !its_lanes;
                    is_shared = true;
                }
            }
            let (at, vague) = mirror::points::<L>(bounds, &hit, &packet.rays(), nearest.t, L::Mask::from_bits(lanes));
            self.mark_places::<L>(packet.get(Number::Pixel), vague);
            self.shade_reflected::<L, false>(face, is_shared, packet, &at);
        }
    }

    /// Settles the pixels of rays that meet nothing, or one mirror too many, and returns the lanes of the others.
    #[inline(always)]
    fn finish_missed<L: Lanes>(&mut self, packet: &Packet, nearest: &Nearest<L>) -> L::Mask {
        let active = packet.lanes::<L>();
        self.mark_places::<L>(packet.get(Number::Pixel), active & nearest.doubt);
        let sure = active & !nearest.doubt;
        let met = sure & nearest.met();
        let zero = L::splat(0.0);
        self.finish::<L>(packet, shade::splat_each(self.plan.scene.background.to_array()), zero, sure & !met);
        let beyond = met & packet.get::<L>(Number::Level).gt(L::splat(f64::from(self.plan.settings.max_level)));
        self.finish::<L>(packet, [zero; 3], zero, beyond);
        met & !beyond
    }

    /// Shades the hits of reflected rays, and sends them on from mirrors.
    #[inline(always)]
    fn shade_reflected<L: Lanes, const GREY: bool>(
        &mut self,
        face: &Face,
        is_shared: bool,
        packet: &Packet,
        at: &Points<L>,
    ) {
        let colors = self.local::<L, GREY>(face, is_shared, at);
        self.mark_places::<L>(packet.get(Number::Pixel), at.active & colors.doubt);
        let sure = at.active & !colors.doubt;
        if self.wide.bounds.terms[face.surface].reflectance > 0.0 {
            let channels = if GREY { Channels::Equal } else { self.wide.channels };
            self.send_on(face, at, &colors, &packet.paths(channels), sure);
        } else {
            self.finish::<L>(packet, colors.color, colors.error, sure);
        }
    }

    /// Settles the pixels of rays that have found their colour.
    #[inline(always)]
    fn finish<L: Lanes>(&mut self, packet: &Packet, color: [L; 3], error: L, lanes: L::Mask) {
        if !lanes.any() {
            return;
        }
        let paths = packet.paths::<L>(self.wide.channels);
        let (color, error) = mirror::compose(&paths, color, error);
        if self.wide.samples > 1 {
            self.add_up_each(paths.pixel, [color[0], color[1], color[2], error], lanes);
            return;
        }
        let error = self.wide.fault.bound(error);
        let (bytes, proved) = shade::quantise(color, error);
        self.mark_places(paths.pixel, lanes & !proved);
        let (mut places, mut found) = ([0.0; eye::MAX_LANES], [0; eye::MAX_LANES]);
        paths.pixel.store(&mut places);
        let lanes = lanes & proved;
        self.note(paths.pixel, color, error, lanes);
        bytes.store_whole(lanes, &mut found);
        let mut rest = lanes.bits();
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            self.scratch.pixels[places[lane] as usize] = found[lane];
        }
    }

    /// Adds samples, within 0…1, and the bounds on their errors to their pixels, wherever they lie.
    #[inline(always)]
    fn add_up_each<L: Lanes>(&mut self, places: L, sample: [L; 4], lanes: L::Mask) {
        let mut numbers = [[0.0; eye::MAX_LANES]; 5];
        places.store(&mut numbers[4]);
        for k in 0..4 {
            sample[k].store(&mut numbers[k]);
        }
        let mut rest = lanes.bits();
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            for k in 0..4 {
                self.scratch.sums[k][numbers[4][lane] as usize] += numbers[k][lane];
            }
        }
    }

    /// Leaves the pixels of these rays to finer arithmetic.
    #[inline(always)]
    fn mark_places<L: Lanes>(&mut self, places: L, lanes: L::Mask) {
        let mut rest = lanes.bits();
        if rest == 0 {
            return;
        }
        let mut numbers = [0.0; eye::MAX_LANES];
        places.store(&mut numbers);
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            mark(&mut self.scratch.slow, numbers[lane] as usize, 1);
        }
    }
}

/// Marks pixels from one on by the bits; they lie in one group of eight, or in two that begin at `first`.
fn mark(slow: &mut [u32], first: usize, bits: u32) {
    slow[first / 8] |= (bits << (first % 8)) & 0xff;
    if bits > 0xff {
        slow[first / 8 + 1] |= bits >> 8;
    }
}

/// Collects what can hide the lights from a face, or from all of a group. It is called once for each: what calls it keeps its
/// registers otherwise.
#[cold]
#[inline(never)]
fn collect_occluders(bounds: &Bounds, plan: &Plan<'_>, face: &Face, group: Option<usize>) -> LightOccluders {
    match group {
        Some(group) => LightOccluders::of_group(bounds, plan, &bounds.groups[group]),
        None => LightOccluders::new(bounds, plan, face),
    }
}

/// A face's number: faces lie side by side.
fn face_index(bounds: &Bounds, face: &Face) -> usize {
    let n_spheres = bounds.spheres.len();
    match (face.object, face.kind) {
        (crate::plan::Object::Sphere(i), _) => i as usize,
        (crate::plan::Object::Cylinder(i), FaceKind::LowerCap) => n_spheres + 3 * i as usize + 1,
        (crate::plan::Object::Cylinder(i), FaceKind::UpperCap) => n_spheres + 3 * i as usize + 2,
        (crate::plan::Object::Cylinder(i), _) => n_spheres + 3 * i as usize,
    }
}

/// Returns the number of each lane.
#[inline(always)]
fn numbers<L: Lanes>() -> L {
    L::load(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0])
}

/// Returns what becomes of the colours that eye rays find: they are those of the pixels.
#[inline(always)]
fn eye_paths<L: Lanes>(packet: usize) -> Paths<L> {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let pixel = numbers::<L>() + L::splat((packet * L::N) as f64);
    Paths { sum: [zero; 3], ceiling: [one; 3], weight: one, error: zero, pixel, level: zero }
}
