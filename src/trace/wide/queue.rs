//! Reflected rays that wait to be traced, packet by packet, in the order in which they came.
//!
//! Neighbouring pixels see the same mirrors, so most packets go on as a whole: they are stored as they are, with the lanes
//! that are left. Packets of which less is left are packed into others. All rays that wait are followed by one level before
//! any is followed further: packets that follow each other then do not depend on each other, and are about alike.

use crate::trace::kernels::{Lanes, Mask};
use crate::trace::wide::eye::MAX_LANES;

/// How many numbers there are for each ray.
const N_NUMBERS: usize = 19;

/// A packet with less than this share of its lanes left is packed with others.
const MIN_SHARE: f64 = 7.0 / 8.0;

/// How many rays wait before they are followed: about two times as many, each of 120 bytes or more, stay in the nearest cache.
const BATCH: usize = 48;

/// What one of a ray's numbers is.
#[derive(Clone, Copy, Debug)]
#[repr(usize)]
pub(super) enum Number {
    OriginX,
    OriginY,
    OriginZ,
    DirX,
    DirY,
    DirZ,
    OriginError,
    DirError,
    Leaving,
    Weight,
    Error,
    Pixel,
    Level,
    Sum,
    Ceiling,
    SumGreen,
    SumBlue,
    CeilingGreen,
    CeilingBlue,
}

/// A packet of reflected rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rays<L: Lanes> {
    pub origin: [L; 3],
    /// A unit vector.
    pub dir: [L; 3],
    pub origin_error: L,
    pub dir_error: L,
    /// The number of the equation that the ray leaves.
    pub leaving: L,
}

/// What becomes of the colours that a packet of rays finds.
///
/// The pixel's channel is min(A + B·x, H) for the colour x, within 0…1, of the ray, and off by `error` for an exact x.
#[derive(Clone, Copy, Debug)]
pub(super) struct Paths<L: Lanes> {
    /// A.
    pub sum: [L; 3],
    /// H.
    pub ceiling: [L; 3],
    /// B.
    pub weight: L,
    pub error: L,
    /// The place in the tile.
    pub pixel: L,
    /// How many mirrors lie before it.
    pub level: L,
}

/// A packet of rays in memory. What is needed is read when it is needed: all numbers at once are more than there are
/// registers.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Packet {
    numbers: [[f64; MAX_LANES]; N_NUMBERS],
    /// The lanes that hold a ray.
    lanes: u32,
}

impl Packet {
    const EMPTY: Self = Self { numbers: [[0.0; MAX_LANES]; N_NUMBERS], lanes: 0 };

    /// Returns the lanes that hold a ray.
    #[inline(always)]
    pub fn lanes<L: Lanes>(&self) -> L::Mask {
        L::Mask::from_bits(self.lanes)
    }

    /// Reads one of the numbers.
    #[inline(always)]
    pub fn get<L: Lanes>(&self, number: Number) -> L {
        L::load(&self.numbers[number as usize])
    }

    /// Returns what one of the numbers is in every lane that holds a ray, if it is the same in all.
    #[inline(always)]
    pub fn common<L: Lanes>(&self, number: Number) -> Option<f64> {
        let first = self.numbers[number as usize][self.lanes.trailing_zeros() as usize % MAX_LANES];
        let others = self.lanes::<L>() & !self.get::<L>(number).eq(L::splat(first));
        (!others.any()).then_some(first)
    }

    /// Reads the rays.
    #[inline(always)]
    pub fn rays<L: Lanes>(&self) -> Rays<L> {
        Rays {
            origin: [self.get(Number::OriginX), self.get(Number::OriginY), self.get(Number::OriginZ)],
            dir: [self.get(Number::DirX), self.get(Number::DirY), self.get(Number::DirZ)],
            origin_error: self.get(Number::OriginError),
            dir_error: self.get(Number::DirError),
            leaving: self.get(Number::Leaving),
        }
    }

    /// Reads what becomes of the colours.
    #[inline(always)]
    pub fn paths<L: Lanes>(&self, channels: Channels) -> Paths<L> {
        let (sum, ceiling) = (self.get(Number::Sum), self.get(Number::Ceiling));
        let (sum, ceiling) = match channels {
            Channels::Equal => ([sum; 3], [ceiling; 3]),
            Channels::Three => (
                [sum, self.get(Number::SumGreen), self.get(Number::SumBlue)],
                [ceiling, self.get(Number::CeilingGreen), self.get(Number::CeilingBlue)],
            ),
        };
        Paths {
            sum,
            ceiling,
            weight: self.get(Number::Weight),
            error: self.get(Number::Error),
            pixel: self.get(Number::Pixel),
            level: self.get(Number::Level),
        }
    }
}

/// Which channels of A and H there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channels {
    /// Every mirror gives all three channels the same, so that one stands for all.
    Equal,
    Three,
}

impl Channels {
    /// Returns how many numbers there are for each ray.
    #[inline(always)]
    fn n_numbers(self) -> usize {
        match self {
            Self::Equal => Number::SumGreen as usize,
            Self::Three => N_NUMBERS,
        }
    }
}

/// Reflected rays that wait to be traced.
#[derive(Debug)]
pub(super) struct Waiting {
    channels: Channels,
    /// The first `n_packets` of these wait.
    packets: Vec<Packet>,
    n_packets: usize,
    /// Fewer rays than fill a packet.
    rest: Box<[[f64; 2 * MAX_LANES]; N_NUMBERS]>,
    n_rest: usize,
}

/// Stores each number of a packet by an expression.
macro_rules! put {
    ($channels:expr, $rays:expr, $paths:expr, |$number:ident, $lanes:ident| $put:expr) => {{
        put!(@ $rays.origin[0], OriginX, $number, $lanes, $put);
        put!(@ $rays.origin[1], OriginY, $number, $lanes, $put);
        put!(@ $rays.origin[2], OriginZ, $number, $lanes, $put);
        put!(@ $rays.dir[0], DirX, $number, $lanes, $put);
        put!(@ $rays.dir[1], DirY, $number, $lanes, $put);
        put!(@ $rays.dir[2], DirZ, $number, $lanes, $put);
        put!(@ $rays.origin_error, OriginError, $number, $lanes, $put);
        put!(@ $rays.dir_error, DirError, $number, $lanes, $put);
        put!(@ $rays.leaving, Leaving, $number, $lanes, $put);
        put!(@ $paths.weight, Weight, $number, $lanes, $put);
        put!(@ $paths.error, Error, $number, $lanes, $put);
        put!(@ $paths.pixel, Pixel, $number, $lanes, $put);
        put!(@ $paths.level, Level, $number, $lanes, $put);
        put!(@ $paths.sum[0], Sum, $number, $lanes, $put);
        put!(@ $paths.ceiling[0], Ceiling, $number, $lanes, $put);
        if $channels == Channels::Three {
            put!(@ $paths.sum[1], SumGreen, $number, $lanes, $put);
            put!(@ $paths.sum[2], SumBlue, $number, $lanes, $put);
            put!(@ $paths.ceiling[1], CeilingGreen, $number, $lanes, $put);
            put!(@ $paths.ceiling[2], CeilingBlue, $number, $lanes, $put);
        }
    }};
    (@ $value:expr, $name:ident, $number:ident, $lanes:ident, $put:expr) => {{
        let ($number, $lanes) = (Number::$name as usize, $value);
        $put
    }};
}

impl Waiting {
    /// Makes room in which no ray waits.
    pub fn new(channels: Channels) -> Self {
        Self {
            channels,
            packets: vec![Packet::EMPTY; BATCH / 8],
            n_packets: 0,
            rest: Box::new([[0.0; 2 * MAX_LANES]; N_NUMBERS]),
            n_rest: 0,
        }
    }

    /// Tells whether enough packets wait to be followed.
    pub fn is_full<L: Lanes>(&self) -> bool {
        self.n_packets * L::N >= BATCH
    }

    /// Adds the rays of the mask.
    #[inline(always)]
    pub fn push<L: Lanes>(&mut self, rays: &Rays<L>, paths: &Paths<L>, mask: L::Mask) {
        let n_rays = mask.bits().count_ones();
        if f64::from(n_rays) >= MIN_SHARE * L::N as f64 {
            let channels = self.channels;
            let packet = self.add(mask.bits());
            put!(channels, rays, paths, |number, lanes| lanes.store(&mut packet.numbers[number]));
        } else if n_rays > 0 {
            let first = self.n_rest.min(L::N);
            put!(self.channels, rays, paths, |number, lanes| lanes.store_packed(mask, &mut self.rest[number][first..]));
            self.n_rest += n_rays as usize;
            if self.n_rest >= L::N {
                self.pack::<L>();
            }
        }
    }

    /// Adds a packet that is still to be written.
    #[inline(always)]
    fn add(&mut self, lanes: u32) -> &mut Packet {
        let place = self.n_packets;
        if place == self.packets.len() {
            self.packets.push(Packet::EMPTY);
        }
        self.n_packets += 1;
        let packet = &mut self.packets[place];
        packet.lanes = lanes;
        packet
    }

    /// Makes a packet of rays that were packed.
    #[inline(always)]
    fn pack<L: Lanes>(&mut self) {
        let n_rays = self.n_rest.min(L::N);
        self.n_rest -= n_rays;
        let place = self.n_packets;
        self.add((1 << n_rays) - 1);
        let packet = &mut self.packets[place];
        for number in 0..self.channels.n_numbers() {
            let rest = &mut self.rest[number];
            L::load(rest).store(&mut packet.numbers[number]);
            L::load(&rest[L::N..]).store(rest);
        }
    }

    /// Takes out the packets that wait, into `packets`, and returns how many they are. Rays that do not fill a packet stay,
    /// unless they are the last.
    #[inline(always)]
    pub fn take<L: Lanes>(&mut self, packets: &mut Vec<Packet>, is_last: bool) -> usize {
        if self.n_packets == 0 && self.n_rest > 0 && is_last {
            self.pack::<L>();
        }
        std::mem::swap(&mut self.packets, packets);
        std::mem::take(&mut self.n_packets)
    }
}
