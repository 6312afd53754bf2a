//! Sixteen boxes, and a beam that may meet them.

use crate::plan::Expect;
use crate::plan::tree::{Bounds, FARTHEST, SearchRay};

/// Boxes in a group: as many as a register of binary32 has lanes, and as one level less of groups to wait for.
pub const LANES: usize = 16;

/// The share of the coordinates that a pad has for binary32, 2⁻¹⁹.
const ROUNDING: f64 = 1.0 / 524_288.0;

/// More than underflow takes from a number in binary32, 2⁻¹⁰⁰.
const UNDERFLOW: f64 = f64::from_bits((1023 - 100) << 52);

/// The least magnitude of a coordinate of the direction, 2⁻⁴⁰.
const FLATTEST: f64 = f64::from_bits((1023 - 40) << 52);

/// Sixteen boxes, coordinate by coordinate. Boxes that are missing have all coordinates at ∞.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Boxes {
    /// The least coordinates.
    pub low: [[f32; LANES]; 3],
    /// The largest.
    pub high: [[f32; LANES]; 3],
}

const _: () = assert!(size_of::<Boxes>() == 384);

/// How a beam is tested against boxes: the answer is that of [`OneByOne`], whatever instructions it takes.
pub trait MeetBoxes: Expect {
    /// Returns for each box a lower bound of t in it, and a bit if the beam may meet it up to the t that matters.
    fn meet(boxes: &Boxes, beam: &Beam) -> ([f32; LANES], u32);
}

/// One box after the other: the specification.
#[derive(Clone, Copy, Debug)]
pub struct OneByOne;

/// A ray that is as wide as it may be off: see the module's documentation.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// The origin, moved by the pad towards where the ray goes.
    pub ahead: [f32; 3],
    /// The origin, moved by the pad away from where the ray goes.
    pub behind: [f32; 3],
    /// The reciprocals of the direction's coordinates.
    pub inverse: [f32; 3],
    /// Meetings beyond do not matter; below the ∞ at which missing boxes lie.
    pub t_max: f32,
    /// What t is multiplied by.
    speed: f64,
}

impl Beam {
    /// Makes the beam of a ray among boxes whose coordinates are bounded by `extent`; `None` when it is too far off.
    pub fn new(ray: &SearchRay, extent: f64) -> Option<Self> {
        let largest = |v: [f64; 3]| v.into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let speed = largest(ray.dir);
        let extent = extent.max(largest(ray.origin)) * 1.25 + ray.origin_error;
        let dir_error = ray.dir_error / speed * 1.25;
        let pad = ray.origin_error + 4.0 * extent * (dir_error + FLATTEST) + ROUNDING * extent + UNDERFLOW;
        // Also false for what is no number.
        if !(dir_error < 0.25 && pad <= FARTHEST && speed.is_normal()) {
            return None;
        }
        let dir = ray.dir.map(|d| d / speed);
        let dir = dir.map(|d| if d.abs() < FLATTEST { FLATTEST.copysign(d) } else { d });
        let moved = |outward: f64| std::array::from_fn(|k| (ray.origin[k] + outward * pad.copysign(dir[k])) as f32);
        Some(Self {
            ahead: moved(1.0),
            behind: moved(-1.0),
            inverse: dir.map(|d| (1.0 / d) as f32),
            t_max: f32::MAX,
            speed,
        })
    }

    /// Learns that meetings beyond `t` do not matter.
    pub fn limit(&mut self, t: f64) {
        self.t_max = self.t_max.min(((t * self.speed) as f32).next_up());
    }
}

impl Boxes {
    /// Makes a group of at most sixteen.
    pub fn new(bounds: impl Iterator<Item = Bounds>) -> Self {
        let mut boxes = Self { low: [[f32::INFINITY; LANES]; 3], high: [[f32::INFINITY; LANES]; 3] };
        for (lane, [low, high]) in bounds.enumerate() {
            for k in 0..3 {
                boxes.low[k][lane] = low[k];
                boxes.high[k][lane] = high[k];
            }
        }
        boxes
    }

    /// Returns the box around all.
    pub fn union(&self) -> Bounds {
        let least = |lanes: &[f32; LANES]| lanes.iter().copied().fold(f32::INFINITY, f32::min);
        let largest = |lanes: &[f32; LANES]| {
            lanes.iter().copied().filter(|c| *c < f32::INFINITY).fold(f32::NEG_INFINITY, f32::max)
        };
        [std::array::from_fn(|k| least(&self.low[k])), std::array::from_fn(|k| largest(&self.high[k]))]
    }
}

impl MeetBoxes for OneByOne {
    #[inline]
    fn meet(boxes: &Boxes, beam: &Beam) -> ([f32; LANES], u32) {
        let mut near = [0.0f32; LANES];
        let mut far = [beam.t_max; LANES];
        for k in 0..3 {
            let inverse = beam.inverse[k];
            let (enter, leave) = match inverse >= 0.0 {
                true => (&boxes.low[k], &boxes.high[k]),
                false => (&boxes.high[k], &boxes.low[k]),
            };
            for lane in 0..LANES {
                // A missing box: enters or leaves at ∞ or −∞.
                let entered = (enter[lane] - beam.ahead[k]) * inverse;
                let left = (leave[lane] - beam.behind[k]) * inverse;
                near[lane] = if entered > near[lane] { entered } else { near[lane] };
                far[lane] = if left < far[lane] { left } else { far[lane] };
            }
        }
        let mut met = 0;
        for lane in 0..LANES {
            met |= u32::from(near[lane] <= far[lane]) << lane;
        }
        (near, met)
    }
}

impl Expect for OneByOne {
    #[inline]
    fn expect<T>(_: &[T], _: usize) {}
}
