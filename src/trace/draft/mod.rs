//! The draft tracer: packets of pixels in binary32, sixteen lanes, and no proofs.
//!
//! It does what [`wide`](crate::trace::wide) does for the same plan, but takes every lane's first answer: no bounds, no
//! lane that is left open, no ties. Pixels may be wrong at silhouettes, edges of shadows and steps of a channel, and where
//! mirrors multiply a rounding; how many is measured by `tests/draft.rs`. They depend neither on the backend nor on the
//! number of threads.
//!
//! Never here: an image with several samples a pixel, of very many objects, or with the eye inside of one. Those are left
//! to binary64, as a whole.

mod meet;
mod mirror;
mod scene;
mod shade;
mod shadow;

use crate::plan::{Candidates, Object, Plan, Precision, Search};
use crate::trace::Counts;
use crate::trace::draft::meet::{EyeRays, Lines, Nearest, Reflected, RowSphere};
use crate::trace::draft::mirror::{MAX_LANES, Mirror, Queue, Rays};
use crate::trace::draft::scene::{DraftScene, Face};
use crate::trace::draft::shade::Points;
use crate::trace::draft::shadow::FaceLights;
use crate::trace::kernels::{Backend, Mask, SingleJob, SingleLanes};
use crate::trace::pixel::Sampling;
use crate::trace::wide::FaceKind;
use crate::trace::wide::Rect;

/// The most columns and rows of a tile.
const TILE_WIDTH: usize = 64;
const TILE_HEIGHT: usize = 16;
const TILE_PIXELS: usize = TILE_WIDTH * TILE_HEIGHT;

/// What is prepared for one image.
#[derive(Debug)]
pub(super) struct Draft {
    backend: Backend,
    scene: DraftScene,
    /// Of the camera.
    step: f64,
    background: u32,
}

/// What a thread needs to trace tiles.
#[derive(Debug)]
pub(super) struct Scratch {
    /// Red + 2⁸·green + 2¹⁶·blue, row by row.
    pixels: Vec<u32>,
    /// The channels before they became bytes, 0…255, where they are asked for.
    pub unrounded: Option<Vec<[f32; 3]>>,
    rows: Vec<RowSphere>,
    waiting: Queue,
    next: Queue,
    pub counts: Counts,
}

impl Draft {
    /// Prepares what a plan has left; `None` when the settings do not ask for it or binary32 cannot start from it.
    ///
    /// `step`: of the camera.
    pub fn new(plan: &Plan<'_>, step: f64, backend: Backend) -> Option<Self> {
        let settings = &plan.settings;
        if settings.precision != Precision::F32 || settings.samples != 1 || plan.search != Search::Lists {
            return None;
        }
        let max_side = step * f64::from(settings.size.width().max(settings.size.height()) + 2);
        if step < 1e-9 || max_side > 1e4 {
            return None;
        }
        let [red, green, blue] = crate::trace::pixel::bytes_of(plan.scene.background)?;
        let background = u32::from_le_bytes([red, green, blue, 0]);
        Some(Self { backend, scene: DraftScene::new(plan)?, step, background })
    }

    /// Makes what a thread needs.
    pub fn scratch(&self) -> Scratch {
        let mirrors = || self.scene.surfaces.iter().filter(|surface| surface.reflectance > 0.0);
        let (has_mirrors, is_grey) = (mirrors().next().is_some(), mirrors().all(|mirror| mirror.is_grey));
        Scratch {
            pixels: vec![0; TILE_PIXELS],
            unrounded: None,
            rows: Vec::new(),
            waiting: Queue::new(has_mirrors, is_grey),
            next: Queue::new(has_mirrors, is_grey),
            counts: Counts::default(),
        }
    }

    /// Traces a tile, cut as for the wide tracer, into the scratch.
    pub fn trace(&self, plan: &Plan<'_>, sampling: &Sampling, rect: &Rect, scratch: &mut Scratch) {
        let n_pixels = (rect.columns.len() * rect.rows.len()) as u64;
        scratch.counts.eye_rays += n_pixels;
        scratch.counts.draft_pixels += n_pixels;
        scratch.pixels.fill(self.background);
        if let Some(unrounded) = &mut scratch.unrounded {
            let channels =
                scene::single(plan.scene.background.to_array()).map(|channel| 255.0 * channel.clamp(0.0, 1.0));
            unrounded.clear();
            unrounded.resize(TILE_PIXELS, channels);
        }
        let among = plan.tiles.candidates(rect.columns.start, rect.rows.start);
        if !among.is_empty() {
            self.backend.run_single(TileJob { draft: self, plan, sampling, rect, among, scratch });
        }
    }
}

impl Scratch {
    /// Writes the pixels of the tile that was traced into an image `width` pixels wide, whose first row is `first_row`.
    pub fn write(&self, rect: &Rect, rgb: &mut [u8], width: usize, first_row: u32) {
        crate::trace::wide::write_pixels(&self.pixels, rect, rgb, width, first_row);
    }

    /// Writes the channels of the tile that was traced, as they were before they became bytes, into those of a whole image
    /// `width` pixels wide.
    pub fn write_unrounded(&self, rect: &Rect, levels: &mut [[f64; 3]], width: usize) {
        let tile = self.unrounded.as_deref().unwrap_or_default();
        for (tile, row) in tile.chunks_exact(TILE_WIDTH).zip(rect.rows.clone()) {
            let first = row as usize * width + rect.columns.start as usize;
            for (level, channels) in levels[first..first + rect.columns.len()].iter_mut().zip(tile) {
                *level = channels.map(f64::from);
            }
        }
    }
}

/// One tile.
struct TileJob<'a> {
    draft: &'a Draft,
    plan: &'a Plan<'a>,
    sampling: &'a Sampling,
    rect: &'a Rect,
    among: Candidates<'a>,
    scratch: &'a mut Scratch,
}

impl SingleJob for TileJob<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: SingleLanes>(mut self) {
        self.scratch.waiting.clear();
        self.look::<L>();
        let mut level = 1;
        while self.scratch.waiting.len() > 0 {
            std::mem::swap(&mut self.scratch.waiting, &mut self.scratch.next);
            self.scratch.waiting.clear();
            for first in (0..self.scratch.next.len()).step_by(L::N) {
                let (rays, active) = (self.scratch.next.packet::<L>(first), self.scratch.next.lanes::<L>(first));
                self.follow(&rays, active, level);
            }
            level += 1;
        }
    }
}

/// The lanes' numbers.
const LANES: [f32; MAX_LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

impl TileJob<'_> {
    /// Traces the eye rays.
    #[inline(always)]
    fn look<L: SingleLanes>(&mut self) {
        let n_packets = self.rect.columns.len().div_ceil(L::N);
        let scene = &self.draft.scene;
        self.scratch.counts.tests += (n_packets * self.rect.rows.len() * self.among.len() * L::N) as u64;
        for row in 0..self.rect.rows.len() {
            let (left, top) = self.sampling.first_sample(self.rect.columns.start, self.rect.rows.start + row as u32);
            let dy = (top as f64 * self.draft.step) as f32;
            self.scratch.rows.clear();
            for &i in self.among.spheres {
                self.scratch.rows.push(RowSphere::new(&scene.spheres[i as usize], dy));
            }
            for packet in 0..n_packets {
                // Whole steps from the middle are exact.
                let first = left as f32 + 2.0 * (packet * L::N) as f32;
                let dx = (L::same(first) + L::load(&LANES) * L::same(2.0)) * L::splat(self.draft.step);
                let place = row * TILE_WIDTH + packet * L::N;
                let n_rays = (self.rect.columns.len() - packet * L::N).min(L::N);
                self.look_along::<L>(dx, dy, place, L::Mask::from_bits((1 << n_rays) - 1));
            }
        }
    }

    /// Traces a packet of eye rays, whose first is at this place of the tile.
    #[inline(always)]
    fn look_along<L: SingleLanes>(&mut self, dx: L, dy: f32, place: usize, active: L::Mask) {
        let scene = &self.draft.scene;
        let (zero, one) = (L::same(0.0), L::same(1.0));
        let dir = [dx, L::same(dy), -one];
        let a = dx * dx + L::same(1.0 + dy * dy);
        let rays = EyeRays { dx, a, lines: Lines::new(dir) };
        let mut nearest = Nearest::nothing();
        for (&i, row) in self.among.spheres.iter().zip(&self.scratch.rows) {
            meet::eye_meets_sphere(&mut nearest, &rays, &scene.spheres[i as usize], row);
        }
        for &i in self.among.cylinders {
            meet::meet_cylinder(&mut nearest, &scene.cylinders[i as usize], [zero; 3], &rays.lines, active);
        }
        let met = active & nearest.met();
        if !met.any() {
            return;
        }
        let per_length = one / a.sqrt();
        let view = meet::times(dir, -per_length);
        let point = meet::times(dir, nearest.t);
        let path = Reflected { origin: [zero; 3], dir: [zero; 3], leaving: zero, equation: zero };
        let pixel = L::load(&LANES) + L::same(place as f32);
        let rays = Rays { path, sum: [zero; 3], ceiling: [one; 3], weight: one, pixel };
        let mut faces = Faces::new(&nearest, met);
        while let Some((face, lanes)) = faces.next() {
            let at = points(&scene.faces[face], point, view);
            let color = self.local(&scene.faces[face], &at, lanes);
            if scene.surfaces[scene.faces[face].surface].reflectance > 0.0 {
                self.send_on(face, &at, color, &rays, lanes);
            } else {
                let bytes = shade::pack(shade::bytes(color));
                bytes.store_whole(lanes, &mut self.scratch.pixels[place..]);
                self.note(pixel, color, lanes);
            }
        }
    }

    /// Shades a packet of hits without their reflections.
    #[inline(always)]
    fn local<L: SingleLanes>(&mut self, face: &Face, at: &Points<L>, lanes: L::Mask) -> [L; 3] {
        let lights = face.lights.get_or_init(|| FaceLights::new(self.plan, face));
        let (color, counted) = shade::shade(lights, &self.draft.scene.surfaces[face.surface], at, lanes);
        self.scratch.counts.add_shadow_rays(counted.n_rays, counted.n_tests);
        self.scratch.counts.lightings += u64::from(lights.n_lightings) * u64::from(lanes.bits().count_ones());
        color
    }

    /// Puts the reflections of a packet of hits on a mirror into the queue, but for the pixels whose bytes are certain.
    #[inline(always)]
    fn send_on<L: SingleLanes>(&mut self, face: usize, at: &Points<L>, color: [L; 3], rays: &Rays<L>, lanes: L::Mask) {
        let scene = &self.draft.scene;
        let first = face - face % 3;
        let equation = match (scene.faces[face].object, scene.faces[face].kind) {
            (Object::Sphere(i), _) => scene.spheres[i as usize].equation,
            (Object::Cylinder(i), FaceKind::Wall) => scene.cylinders[i as usize].equation,
            _ => -1.0,
        };
        let reflectance = scene.surfaces[scene.faces[face].surface].reflectance;
        let mirror = Mirror { reflectance, leaving: first as f32, equation };
        let (reflected, open) = mirror::reflect(mirror, at, color, rays);
        self.finish(&reflected, [L::same(0.0); 3], lanes & !open);
        self.scratch.counts.settled_rays += u64::from((lanes & !open).bits().count_ones());
        let lanes = lanes & open;
        self.scratch.counts.reflected_rays += u64::from(lanes.bits().count_ones());
        if lanes.any() {
            self.scratch.waiting.push(&reflected, lanes);
        }
    }

    /// Traces a packet of reflected rays.
    #[inline(always)]
    fn follow<L: SingleLanes>(&mut self, rays: &Rays<L>, active: L::Mask, level: u32) {
        let scene = &self.draft.scene;
        let mut leaving = [0.0; MAX_LANES];
        rays.path.leaving.store(&mut leaving);
        let is_one_mirror = !(active & !rays.path.leaving.eq(L::same(leaving[0]))).any();
        let among = if is_one_mirror {
            self.plan.mirrored_by(scene.faces[leaving[0] as usize].object)
        } else {
            self.plan.mirrored()
        };
        self.scratch.counts.add_reflected_tests(active.bits().count_ones(), among.len());
        let nearest = meet::reflected_meets(scene, among.spheres, among.cylinders, &rays.path, active);
        let met = active & nearest.met();
        self.finish(rays, meet::same(scene::single(self.plan.scene.background.to_array())), active & !met);
        if level > self.plan.settings.max_level {
            self.finish(rays, [L::same(0.0); 3], met);
            return;
        }
        let view = meet::times(rays.path.dir, -L::same(1.0));
        let point = meet::plus_times(rays.path.origin, rays.path.dir, nearest.t);
        let mut faces = Faces::new(&nearest, met);
        while let Some((face, lanes)) = faces.next() {
            let at = points(&scene.faces[face], point, view);
            let color = self.local(&scene.faces[face], &at, lanes);
            if scene.surfaces[scene.faces[face].surface].reflectance > 0.0 {
                self.send_on(face, &at, color, rays, lanes);
            } else {
                self.finish(rays, color, lanes);
            }
        }
    }

    /// Settles the pixels of rays that have found their colour.
    #[inline(always)]
    fn finish<L: SingleLanes>(&mut self, rays: &Rays<L>, color: [L; 3], lanes: L::Mask) {
        let mut rest = lanes.bits();
        if rest == 0 {
            return;
        }
        let (mut places, mut found) = ([0.0; MAX_LANES], [0; MAX_LANES]);
        rays.pixel.store(&mut places);
        let color = mirror::compose(rays, color);
        shade::pack(shade::bytes(color)).store_whole(lanes, &mut found);
        self.note(rays.pixel, color, lanes);
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            self.scratch.pixels[places[lane] as usize] = found[lane];
        }
    }
}

impl TileJob<'_> {
    /// Keeps the colours of a packet as they are before they become bytes, if that is asked for.
    ///
    /// `pixel`: their places in the tile.
    #[inline(always)]
    fn note<L: SingleLanes>(&mut self, pixel: L, color: [L; 3], lanes: L::Mask) {
        let Some(unrounded) = &mut self.scratch.unrounded else { return };
        let (mut places, mut channels) = ([0.0; MAX_LANES], [[0.0; MAX_LANES]; 3]);
        pixel.store(&mut places);
        for (channel, lanes) in color.into_iter().zip(&mut channels) {
            channel.store(lanes);
        }
        for lane in (0..L::N).filter(|lane| lanes.bits() >> lane & 1 != 0) {
            unrounded[places[lane] as usize] = channels.map(|channel| 255.0 * channel[lane].clamp(0.0, 1.0));
        }
    }
}

/// The faces that a packet meets, one after the other, each with its lanes.
struct Faces<L: SingleLanes> {
    face: L,
    faces: [f32; MAX_LANES],
    rest: u32,
}

impl<L: SingleLanes> Faces<L> {
    /// Lists the faces of the lanes that have met something.
    #[inline(always)]
    fn new(nearest: &Nearest<L>, met: L::Mask) -> Self {
        let mut faces = [0.0; MAX_LANES];
        nearest.face.store(&mut faces);
        Self { face: nearest.face, faces, rest: met.bits() }
    }

    #[inline(always)]
    fn next(&mut self) -> Option<(usize, L::Mask)> {
        if self.rest == 0 {
            return None;
        }
        let face = self.faces[self.rest.trailing_zeros() as usize];
        let lanes = self.face.eq(L::same(face)).bits() & self.rest;
        self.rest &= !lanes;
        Some((face as usize, L::Mask::from_bits(lanes)))
    }
}

/// Works out the normals of a packet of hits on a face, and moves what is on a cap to its height.
#[inline(always)]
fn points<L: SingleLanes>(face: &Face, [x, y, z]: [L; 3], view: [L; 3]) -> Points<L> {
    let (zero, one) = (L::same(0.0), L::same(1.0));
    let inv_radius = L::same(face.inv_radius);
    let [cx, cy, cz] = meet::same::<L>(face.center);
    let (point, normal) = match face.kind {
        FaceKind::Sphere => ([x, y, z], [(x - cx) * inv_radius, (y - cy) * inv_radius, (z - cz) * inv_radius]),
        FaceKind::Wall => ([x, y, z], [(x - cx) * inv_radius, zero, (z - cz) * inv_radius]),
        FaceKind::LowerCap => ([x, cy, z], [zero, -one, zero]),
        FaceKind::UpperCap => ([x, cy, z], [zero, one, zero]),
    };
    Points { point, normal, view }
}
