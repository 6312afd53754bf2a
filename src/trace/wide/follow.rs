//! Reflected rays are followed, packet by packet: to what they meet, and on from mirrors.

use crate::plan::{Candidates, ObjectLists};
use crate::trace::kernels::{Lanes, Mask};
use crate::trace::wide::bounds::Face;
use crate::trace::wide::cluster::{Cluster, Table};
use crate::trace::wide::crowd::{self, Few};
use crate::trace::wide::eye::{self, Nearest};
use crate::trace::wide::mirror::{self, Met};
use crate::trace::wide::queue::{Channels, Number, Packet};
use crate::trace::wide::shade::{self, Points};
use crate::trace::wide::tile::TileJob;

impl<'a> TileJob<'a> {
    /// Follows all rays that wait by one level; `false` when there are none, or only fewer than fill a packet, which stay
    /// unless they are the last.
    #[inline(always)]
    pub fn follow<L: Lanes>(&mut self, is_last: bool) -> bool {
        let mut followed = std::mem::take(&mut self.scratch.followed);
        let n_packets = self.scratch.waiting.take::<L>(&mut followed, is_last);
        for packet in &followed[..n_packets] {
            self.follow_packet::<L>(packet);
        }
        self.scratch.followed = followed;
        n_packets > 0
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
        let mut found = std::mem::take(&mut self.scratch.found);
        let few;
        let known = match self.find::<L>(packet, &mut found) {
            Some(among) if wide.bounds.has_objects => Some((bounds, among)),
            // The constants of a crowd may still have to be worked out.
            Some(among) => {
                few = Few::new(&wide.bounds, plan, among);
                few.as_ref().map(|few| (&few.bounds, few.candidates()))
            }
            None => None,
        };
        match known {
            None => self.mark_places::<L>(packet.get(Number::Pixel), packet.lanes::<L>()),
            Some((bounds, among)) => {
                let scratch = &mut *self.scratch;
                TileJob { wide, bounds, among, plan, sampling, rect, scratch, sample }.follow_among::<L>(among, packet);
            }
        }
        self.scratch.found = found;
    }

    /// Finds what a packet of rays may meet, into `found` or in the plan; `None` when there is no telling.
    #[inline(always)]
    fn find<'b, L: Lanes>(&self, packet: &Packet, found: &'b mut ObjectLists) -> Option<Candidates<'b>>
    where
        'a: 'b,
    {
        let (rays, lanes) = (packet.rays::<L>(), packet.lanes::<L>());
        if self.wide.balls.list(&rays, lanes, found) {
            Some(found.as_candidates())
        } else if self.wide.is_crowd {
            crowd::find_along::<L>(self.plan, &rays, lanes, found).then(|| found.as_candidates())
        } else {
            Some(self.listed::<L>(packet))
        }
    }

    /// Follows a packet of rays among spheres of one grey surface that form a cluster.
    #[inline(always)]
    fn follow_in_cluster<L: Lanes>(&mut self, cluster: &Cluster, table: &Table, packet: &Packet) {
        let bounds = self.bounds;
        let among = self.plan.mirrored().spheres;
        self.scratch.counts.add_reflected_tests(packet.lanes::<L>().bits().count_ones(), among.len());
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
        self.scratch.counts.add_reflected_tests(active.bits().count_ones(), among.len());
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
    ///
    /// `GREY`: as in [`shade::shade`].
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
}
