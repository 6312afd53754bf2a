//! What is noted beside the pixels of packets, when it is asked for.

use crate::trace::kernels::Lanes;
#[cfg(feature = "testing")]
use crate::trace::kernels::Mask;
use crate::trace::wide::eye::MAX_LANES;
use crate::trace::wide::shade;

/// What is noted of the channels that packets round to bytes.
#[derive(Clone, Debug)]
pub(in crate::trace) struct Notes {
    /// For each lane the largest bound on an error.
    largest: [f64; MAX_LANES],
    /// Every pixel, where a test asks for it.
    #[cfg(feature = "testing")]
    pub trail: Option<Vec<Proved>>,
}

/// A pixel of which a packet has proved the bytes.
#[cfg(feature = "testing")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proved {
    /// Its number within the tile, 64 to a row.
    pub place: usize,
    /// The channels, not clamped.
    pub color: [f64; 3],
    /// The bound on the error of each.
    pub error: f64,
}

impl Notes {
    /// Makes notes of nothing.
    pub fn new() -> Self {
        Self {
            largest: [0.0; MAX_LANES],
            #[cfg(feature = "testing")]
            trail: None,
        }
    }

    /// Notes the bounds of a packet. What is off by half a level was clamped for sure and not rounded.
    #[inline(always)]
    pub fn note_errors<L: Lanes>(&mut self, error: L, lanes: L::Mask) {
        let rounded = lanes & error.lt(L::splat(shade::HALF_LEVEL));
        let largest = L::load(&self.largest).max(L::select(rounded, error, L::splat(0.0)));
        largest.store(&mut self.largest);
    }

    /// Notes the pixels of a packet.
    #[cfg(feature = "testing")]
    pub fn note_pixels<L: Lanes>(&mut self, places: L, color: [L; 3], error: L, lanes: L::Mask) {
        let Some(trail) = &mut self.trail else { return };
        let lanes_of = |numbers: L| {
            let mut lanes = [0.0; MAX_LANES];
            numbers.store(&mut lanes);
            lanes
        };
        let (places, color, error) = (lanes_of(places), color.map(lanes_of), lanes_of(error));
        let bits = lanes.bits();
        trail.extend((0..L::N).filter(|lane| bits >> lane & 1 != 0).map(|lane| Proved {
            place: places[lane] as usize,
            color: color.map(|channel| channel[lane]),
            error: error[lane],
        }));
    }

    /// Returns the largest bound on the error of 255 c.
    pub fn largest_bound(&self) -> f64 {
        shade::bound_in_levels(self.largest.into_iter().fold(0.0, f64::max))
    }
}
