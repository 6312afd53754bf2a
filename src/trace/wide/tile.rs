//! One tile: its eye rays find what they meet, and what they have met is shaded.

use crate::plan::{Candidates, Object, Plan};
use crate::trace::kernels::{Job, Lanes, Mask};
use crate::trace::pixel::Sampling;
use crate::trace::wide::bounds::{Bounds, Face, FaceKind};
use crate::trace::wide::eye::{self, EyeRays, Nearest, RowSphere};
use crate::trace::wide::mirror;
use crate::trace::wide::queue::Paths;
use crate::trace::wide::shade::{self, Colors, Points};
use crate::trace::wide::shadow::LightOccluders;
use crate::trace::wide::{PacketHit, Rect, Scratch, TILE_WIDTH, Wide};

/// One tile.
pub(super) struct TileJob<'a> {
    pub wide: &'a Wide,
    /// The constants of what its rays can meet, of all objects or of its own.
    pub bounds: &'a Bounds,
    /// What its eye rays can meet, by number in the constants.
    pub among: Candidates<'a>,
    pub plan: &'a Plan<'a>,
    pub sampling: &'a Sampling,
    pub rect: &'a Rect,
    pub scratch: &'a mut Scratch,
    /// Column and row, within its pixel, of the sample at hand.
    pub sample: [u32; 2],
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
            self.look_at_patches::<L>();
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
    pub fn directions<L: Lanes>(&self, packet: usize) -> (L, f64) {
        let (column, row) = (packet * L::N % TILE_WIDTH, packet * L::N / TILE_WIDTH);
        let (left, top) =
            self.sampling.first_sample(self.rect.columns.start + column as u32, self.rect.rows.start + row as u32);
        let (left, top) = (left + i64::from(2 * self.sample[0]), top - i64::from(2 * self.sample[1]));
        let steps = numbers::<L>() * L::splat(f64::from(2 * self.wide.samples));
        (
            (L::splat(left as f64) + steps) * L::splat(self.wide.step),
            L::rounded(top as f64 * L::rounded(self.wide.step)),
        )
    }

    /// Finds what each eye ray meets first.
    #[inline(always)]
    pub fn meet<L: Lanes>(&mut self, among: Candidates<'_>) {
        let bounds = self.bounds;
        let n_packets = self.rect.columns.len().div_ceil(L::N);
        self.scratch.hits.clear();
        self.scratch.counts.tests += (n_packets * self.rect.rows.len() * among.len() * L::N) as u64;
        for row in 0..self.rect.rows.len() {
            let first = row * (TILE_WIDTH / L::N);
            let (_, dy) = self.directions::<L>(first);
            self.scratch.rows.clear();
            for &i in among.spheres {
                self.scratch.rows.push(RowSphere::new::<L>(&bounds.spheres[i as usize], dy));
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

    /// Shades what eye rays have met, and sends on the rays of mirrors.
    #[inline(always)]
    fn shade<L: Lanes>(&mut self) {
        let n_hits = self.scratch.hits.len();
        let mut hit_idx = 0;
        loop {
            while hit_idx < n_hits && !self.scratch.waiting.is_full::<L>() {
                self.shade_packet::<L>(hit_idx);
                hit_idx += 1;
            }
            let is_last = hit_idx == n_hits;
            while self.follow::<L>(is_last) {}
            if is_last {
                return;
            }
        }
    }

    /// Shades a packet of hits of eye rays.
    #[inline(always)]
    fn shade_packet<L: Lanes>(&mut self, hit_idx: usize) {
        let hit = self.scratch.hits[hit_idx];
        if let Some(flock) = &self.wide.flock
            && self.follow_flock::<L>(flock, hit)
        {
            return;
        }
        let (packet, lanes) = (hit.packet as usize, L::Mask::from_bits(hit.lanes));
        let face = &self.bounds.faces[hit.face as usize];
        let terms = &self.wide.bounds.terms[face.surface];
        let at = self.points::<L>(face, packet, lanes);
        let colors = self.local_on_patch(hit_idx, face, &at);
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

    /// Works out the points where a packet of eye rays meets a face.
    #[inline(always)]
    pub fn points<L: Lanes>(&self, face: &Face, packet: usize, active: L::Mask) -> Points<L> {
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
            normal_error = point_error * per_radius.abs() + L::splat(4.0 * L::U);
        }
        let dir_error = L::splat(2.0 * self.wide.bounds.eye.roundoff);
        let length_error = normal_error * L::splat(0.5);
        let equation = L::splat(f64::from(face.equation));
        Points { point, normal, view, cosine, point_error, normal_error, length_error, dir_error, equation, active }
    }

    /// Shades a packet of hits of eye rays without their reflections.
    #[inline(always)]
    fn local_on_patch<L: Lanes>(&mut self, hit_idx: usize, face: &Face, at: &Points<L>) -> Colors<L> {
        if self.wide.is_crowd {
            return self.local_in_crowd(face, at);
        }
        let whole = self.occluders(face, None);
        let (bounds, Scratch { patches, counts, .. }) = (&self.wide.bounds, &mut *self.scratch);
        let occluders = patches.at(hit_idx).unwrap_or(whole);
        let colors = shade::shade::<L, false>(&bounds.lights, &bounds.terms[face.surface], occluders, at);
        counts.add_shadow_rays(colors.shadow_rays, colors.shadow_tests);
        self.count_lightings::<L>(face, at.active);
        colors
    }

    /// Returns what can hide the lights from a face, or from all of its group.
    #[inline(always)]
    pub fn occluders(&self, face: &Face, group: Option<usize>) -> &'a LightOccluders {
        let (wide, plan) = (self.wide, self.plan);
        let bounds = &wide.bounds;
        let slot = group.map_or_else(|| face_index(bounds, face), |group| bounds.faces.len() + group);
        wide.occluders[slot].get_or_init(|| collect_occluders(bounds, plan, face, group))
    }

    /// Shades a packet of hits without their reflections, on one face or, if it is shared, on those of its group.
    ///
    /// `GREY`: as in [`shade::shade`].
    #[inline(always)]
    pub fn local<L: Lanes, const GREY: bool>(&mut self, face: &Face, is_shared: bool, at: &Points<L>) -> Colors<L> {
        if !GREY && self.wide.is_crowd {
            return self.local_in_crowd(face, at);
        }
        let bounds = &self.wide.bounds;
        let shared = face.group.filter(|_| is_shared).map(|group| group as usize);
        let occluders = self.occluders(face, shared);
        let colors = shade::shade::<L, GREY>(&bounds.lights, &bounds.terms[face.surface], occluders, at);
        self.count_lightings::<L>(face, at.active);
        self.scratch.counts.add_shadow_rays(colors.shadow_rays, colors.shadow_tests);
        colors
    }

    /// Does the work of [`TileJob::local`] with what is looked up for the packet.
    #[inline(always)]
    fn local_in_crowd<L: Lanes>(&mut self, face: &Face, at: &Points<L>) -> Colors<L> {
        let (all, Scratch { around, counts, .. }) = (&self.wide.bounds, &mut *self.scratch);
        let terms = &all.terms[face.surface];
        let is_known = !terms.answers() || around.look_up(all, self.plan, face, at);
        if !is_known {
            let zero = L::splat(0.0);
            return Colors { color: [zero; 3], error: zero, doubt: at.active, shadow_rays: 0, shadow_tests: 0 };
        }
        let colors = shade::shade::<L, false>(around.lights(all), terms, &around.occluders, at);
        counts.add_shadow_rays(colors.shadow_rays, colors.shadow_tests);
        self.count_lightings::<L>(face, at.active);
        colors
    }

    /// Counts what lights may be to a packet of hits.
    #[inline(always)]
    fn count_lightings<L: Lanes>(&mut self, face: &Face, active: L::Mask) {
        let terms = &self.wide.bounds.terms[face.surface];
        self.scratch.counts.lightings += u64::from(terms.n_lightings) * u64::from(active.bits().count_ones());
    }

    /// Puts the reflections of a packet of hits into the queue, but for those of which the pixel is settled.
    #[inline(always)]
    pub fn send_on<L: Lanes>(
        &mut self,
        face: &Face,
        at: &Points<L>,
        colors: &Colors<L>,
        paths: &Paths<L>,
        lanes: L::Mask,
    ) {
        let terms = &self.wide.bounds.terms[face.surface];
        if !terms.is_nonnegative {
            self.mark_places(paths.pixel, lanes);
            return;
        }
        let paths = mirror::go_on(terms, colors, paths);
        let mut lanes = lanes;
        let light = lanes & paths.weight.lt(L::splat(self.wide.max_settled_weight));
        if light.any() {
            lanes = lanes & !self.finish_settled(&paths, light);
        }
        self.scratch.counts.reflected_rays += u64::from(lanes.bits().count_ones());
        self.scratch.waiting.push(&mirror::reflect(at), &paths, lanes);
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
        (Object::Sphere(i), _) => i as usize,
        (Object::Cylinder(i), FaceKind::LowerCap) => n_spheres + 3 * i as usize + 1,
        (Object::Cylinder(i), FaceKind::UpperCap) => n_spheres + 3 * i as usize + 2,
        (Object::Cylinder(i), _) => n_spheres + 3 * i as usize,
    }
}

/// Returns the number of each lane.
#[inline(always)]
pub(super) fn numbers<L: Lanes>() -> L {
    L::load(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0])
}

/// Returns what becomes of the colours that eye rays find: they are those of the pixels.
#[inline(always)]
pub(super) fn eye_paths<L: Lanes>(packet: usize) -> Paths<L> {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let pixel = numbers::<L>() + L::splat((packet * L::N) as f64);
    Paths { sum: [zero; 3], ceiling: [one; 3], weight: one, error: zero, pixel, level: zero }
}
