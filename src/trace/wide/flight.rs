//! Flocks are followed: packets of rays that go the same way, from the eye to the end.
//!
//! See `flock` for what is known of them. A ray that goes another way than most waits with the others, and a packet that most
//! have left is given up.

use crate::trace::kernels::{Lanes, Mask};
use crate::trace::wide::PacketHit;
use crate::trace::wide::flock::{Ahead, Flight, Flock};
use crate::trace::wide::horizon::BallLight;
use crate::trace::wide::mirror;
use crate::trace::wide::queue::{Paths, Rays};
use crate::trace::wide::shade::{Points, dot, splat_each};
use crate::trace::wide::shadow::shadow;
use crate::trace::wide::tile::{TileJob, eye_paths};

/// A packet of which less than this share is left is followed as others are.
const MIN_SHARE: f64 = 3.0 / 4.0;

/// What becomes of the colours that a flock finds; see [`Paths`]. The channels are equal.
#[derive(Clone, Copy, Debug)]
struct Story<L: Lanes> {
    sum: L,
    ceiling: L,
    /// A bound on the error of the sum, beside roundings.
    error: L,
    weight: f64,
}

impl TileJob<'_> {
    /// Follows a packet of hits of eye rays on a sphere of a cluster, if they set out as a flock.
    #[inline(always)]
    pub fn follow_flock<L: Lanes>(&mut self, flock: &Flock, hit: PacketHit) -> bool {
        let lanes = L::Mask::from_bits(hit.lanes);
        let Some(ball) = flock.ball_of(hit.face as usize) else { return false };
        if !is_enough::<L>(lanes) {
            return false;
        }
        let packet = hit.packet as usize;
        let (dir, normal) = self.unit_hit::<L>(hit.face as usize, packet);
        let mut flight = flock.set_out(ball, lanes, normal, dir);
        if (lanes & !flight.slack.lt(L::splat(flock.max_eye_slack))).any() {
            return false;
        }
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let mut story = Story { sum: zero, ceiling: one, error: zero, weight: 1.0 };
        let max_level = self.plan.settings.max_level;
        let n_ways = flock.balls.len() - 1;
        loop {
            self.light_flock(flock, packet, &mut flight, &mut story);
            let n_rays = flight.lanes.bits().count_ones();
            self.scratch.counts.reflected_rays += u64::from(n_rays);
            self.scratch.counts.add_reflected_tests(n_rays, n_ways);
            let ahead = flock.look_ahead(&flight);
            let group = ahead.lead & ahead.sure & !ahead.wild;
            if group.bits() != flight.lanes.bits() || flight.level > max_level {
                if flight.level > max_level || !is_enough::<L>(group) {
                    self.part::<L>(flock, packet, &flight, &story, &ahead, L::Mask::from_bits(0));
                    return true;
                }
                self.part::<L>(flock, packet, &flight, &story, &ahead, group);
            }
            flight = flock.go_to(&flight, &ahead, group);
        }
    }

    /// Returns the directions of a packet of eye rays and, not of unit length, the normals where they meet a sphere.
    #[inline(always)]
    fn unit_hit<L: Lanes>(&self, face: usize, packet: usize) -> ([L; 3], [L; 3]) {
        let face = &self.bounds.faces[face];
        let (dx, dy) = self.directions::<L>(packet);
        let t = L::load(&self.scratch.t[packet * L::N..]);
        let (dy, one, per_radius) = (L::splat(dy), L::splat(1.0), L::splat(face.per_radius));
        let per_length = one / dx.mul_add(dx, dy.mul_add(dy, one)).sqrt();
        let [cx, cy, cz] = splat_each::<L>(face.center);
        let normal = [(dx * t - cx) * per_radius, (dy * t - cy) * per_radius, (-t - cz) * per_radius];
        ([dx * per_length, dy * per_length, -per_length], normal)
    }

    /// Adds the colour of a packet of hits to what becomes of it, and the mirror; lanes in doubt are left out.
    #[inline(always)]
    fn light_flock<L: Lanes>(&mut self, flock: &Flock, packet: usize, flight: &mut Flight<L>, story: &mut Story<L>) {
        let n_hits = flight.lanes.bits().count_ones();
        self.scratch.counts.lightings += u64::from(flock.n_lightings) * u64::from(n_hits);
        let weight = L::splat(story.weight);
        let before = story.sum;
        if flock.ambient > 0.0 {
            story.sum = story.sum + L::splat(story.weight * flock.ambient);
        }
        let lights = &flock.balls[flight.ball].lights;
        for i in 0..lights.len() {
            let light = &lights[i];
            let height = light.height(flight.normal);
            let mut lit = height.gt(flight.slack + L::splat(light.open));
            let seen = flight.lanes & !height.lt(-flight.slack);
            let unknown = seen & !lit;
            if unknown.any() {
                let (others, doubt) = self.seek_light(flock, light, flight, height, unknown);
                lit = lit | others;
                self.mark_slow::<L>(packet, doubt);
                flight.lanes = flight.lanes & !doubt;
            }
            let share = L::select(lit, light.cosine(height), L::splat(0.0));
            story.sum = share.mul_add(L::splat(story.weight * light.diffuse), story.sum);
        }
        story.ceiling = story.ceiling.min(before + weight);
        let slacks = story.weight * flock.balls[flight.ball].color_slacks;
        story.error = flight.slack.mul_add(L::splat(slacks), story.error);
        story.weight *= flock.reflectance;
    }

    /// Tells which of the lanes see a light, given its height, and which perhaps.
    #[inline(always)]
    fn seek_light<L: Lanes>(
        &mut self,
        flock: &Flock,
        light: &BallLight,
        flight: &Flight<L>,
        height: L,
        lanes: L::Mask,
    ) -> (L::Mask, L::Mask) {
        let zero = L::splat(0.0);
        let facing = lanes & height.gt(flight.slack);
        let Rays { origin, origin_error, leaving, .. } = flock.rays(flight);
        let at = Points {
            point: origin,
            point_error: origin_error,
            normal: flight.normal,
            view: [zero; 3],
            cosine: flight.cosine,
            normal_error: zero,
            length_error: zero,
            dir_error: zero,
            equation: leaving,
            active: lanes,
        };
        let wide_light = &self.bounds.lights[light.light_idx];
        let position = splat_each::<L>(wide_light.position);
        let w = [origin[0] - position[0], origin[1] - position[1], origin[2] - position[2]];
        let a = dot(w, w);
        let occluders = &flock.balls[flight.ball].occluders;
        let (hidden, doubt, n_tested) = shadow(wide_light, occluders, light.light_idx, &w, a, a.sqrt(), &at, facing);
        let n_rays = facing.bits().count_ones();
        self.scratch.counts.add_shadow_rays(n_rays, n_rays * n_tested);
        (facing & !(hidden | doubt), doubt | (lanes & !facing))
    }

    /// Parts a packet of rays from those of its lanes that go on as a flock.
    #[inline(always)]
    fn part<L: Lanes>(
        &mut self,
        flock: &Flock,
        packet: usize,
        flight: &Flight<L>,
        story: &Story<L>,
        ahead: &Ahead<L>,
        group: L::Mask,
    ) {
        let tame = flight.lanes & !ahead.wild;
        let background = self.plan.scene.background.to_array();
        let paths = story.paths(flock, flight.level, eye_paths::<L>(packet).pixel);
        self.finish_flock(packet, &paths, background, tame & !ahead.met);
        self.mark_slow::<L>(packet, tame & ahead.met & !ahead.sure);
        let mut others = tame & ahead.sure & !group;
        if flight.level > self.plan.settings.max_level {
            self.finish_flock(packet, &paths, [0.0; 3], others);
            others = L::Mask::from_bits(0);
        }
        let others = others | ahead.wild;
        if others.any() {
            self.scratch.waiting.push(&flock.rays(flight), &paths, others);
        }
    }

    /// Settles the pixels of rays that have found their colour.
    #[inline(always)]
    fn finish_flock<L: Lanes>(&mut self, packet: usize, paths: &Paths<L>, color: [f64; 3], lanes: L::Mask) {
        if !lanes.any() {
            return;
        }
        let (color, error) = mirror::compose(paths, splat_each(color), L::splat(0.0));
        if self.wide.samples > 1 {
            self.add_up(packet, color, error, lanes);
        } else {
            self.settle_packet(packet, color, error, lanes);
        }
    }
}

impl<L: Lanes> Story<L> {
    /// Tells it as others do.
    #[inline(always)]
    fn paths(&self, flock: &Flock, level: u32, pixel: L) -> Paths<L> {
        let rounding = flock.color_rounding * f64::from(level);
        Paths {
            sum: [self.sum; 3],
            ceiling: [self.ceiling; 3],
            weight: L::splat(self.weight),
            error: self.error + L::splat(rounding),
            pixel,
            level: L::splat(f64::from(level)),
        }
    }
}

/// Tells whether enough of a packet is left.
#[inline(always)]
fn is_enough<L: Lanes>(lanes: L::Mask) -> bool {
    f64::from(lanes.bits().count_ones()) >= MIN_SHARE * L::N as f64
}
