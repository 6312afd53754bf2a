//! Pixels are settled: a colour that is found is rounded to bytes, or added to those of the pixel's other samples; what is
//! not proved is left to finer arithmetic.
//!
//! # Rays that are not cast
//! A reflected ray finds a colour x within 0…1, and the channel min(A + B·x, H) does not fall as x grows. So if 0 and 1 give
//! the same bytes, both proved, the pixel has them whatever the ray meets; a ray of a small weight B often ends so.

use crate::trace::kernels::{Lanes, Mask};
use crate::trace::wide::queue::{Packet, Paths};
use crate::trace::wide::tile::{TileJob, numbers};
use crate::trace::wide::{TILE_PIXELS, eye, mirror, shade};

/// Of a ray that weighs more than some levels it is not asked whether its pixel is settled: it seldom is.
pub(super) const MAX_SETTLED_WEIGHT: f64 = 1.0 / 64.0;

impl TileJob<'_> {
    /// Leaves the pixels of these lanes of a packet to finer arithmetic.
    #[inline(always)]
    pub fn mark_slow<L: Lanes>(&mut self, packet: usize, lanes: L::Mask) {
        mark(&mut self.scratch.slow, packet * L::N, lanes.bits());
    }

    /// Writes the pixels of a packet whose colours are found.
    #[inline(always)]
    pub fn settle_packet<L: Lanes>(&mut self, packet: usize, color: [L; 3], error: L, lanes: L::Mask) {
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
    pub fn add_up<L: Lanes>(&mut self, packet: usize, color: [L; 3], error: L, lanes: L::Mask) {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let channels = [color[0].min(one).max(zero), color[1].min(one).max(zero), color[2].min(one).max(zero), error];
        for k in 0..4 {
            let sums = &mut self.scratch.sums[k][packet * L::N..];
            (L::load(sums) + L::select(lanes, channels[k], zero)).store(sums);
        }
    }

    /// Settles pixels by the sums of their samples.
    #[inline(always)]
    pub fn average<L: Lanes>(&mut self) {
        let n_samples = f64::from(self.wide.samples * self.wide.samples);
        // Each sum of n numbers up to 1 loses at most n roundings of n, and the division one more.
        let rounding = L::splat(2.0 * (n_samples + 1.0) * L::U);
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

    /// Settles the pixels of rays that have found their colour.
    #[inline(always)]
    pub fn finish<L: Lanes>(&mut self, packet: &Packet, color: [L; 3], error: L, lanes: L::Mask) {
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
        self.note(paths.pixel, color, error, lanes & proved);
        self.put(paths.pixel, bytes, lanes & proved);
    }

    /// Settles the pixels whose bytes are the same whatever their rays find, and returns their lanes.
    #[inline(always)]
    pub fn finish_settled<L: Lanes>(&mut self, paths: &Paths<L>, lanes: L::Mask) -> L::Mask {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let (least, error) = mirror::compose(paths, [zero; 3], zero);
        let (most, _) = mirror::compose(paths, [one; 3], zero);
        let error = self.wide.fault.bound(error);
        let (bytes, is_low_proved) = shade::quantise(least, error);
        let (high_bytes, is_high_proved) = shade::quantise(most, error);
        let settled = lanes & is_low_proved & is_high_proved & bytes.eq(high_bytes);
        // What was rounded are two ends between which the colour lies: of the colour itself there is nothing to note.
        if let Some(notes) = &mut self.scratch.notes {
            notes.note_errors(error, settled);
        }
        self.put(paths.pixel, bytes, settled);
        self.scratch.counts.settled_rays += u64::from(settled.bits().count_ones());
        settled
    }

    /// Writes the bytes of pixels, wherever they lie.
    #[inline(always)]
    fn put<L: Lanes>(&mut self, places_of_lanes: L, bytes: L, lanes: L::Mask) {
        let (mut places, mut found) = ([0.0; eye::MAX_LANES], [0; eye::MAX_LANES]);
        places_of_lanes.store(&mut places);
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
    pub fn mark_places<L: Lanes>(&mut self, places: L, lanes: L::Mask) {
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
