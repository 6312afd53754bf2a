//! Reflected rays, and what becomes of the colours they find.

use crate::trace::draft::TILE_PIXELS;
use crate::trace::draft::meet::{Reflected, dot, plus_times, times};
use crate::trace::draft::shade::{Points, byte};
use crate::trace::kernels::{Mask, SingleLanes};

/// The most lanes that a packet has.
pub(super) const MAX_LANES: usize = 16;

/// A packet of reflected rays: the pixel's channel is min(A + B·x, H) for the colour x of the ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rays<L: SingleLanes> {
    pub path: Reflected<L>,
    /// A.
    pub sum: [L; 3],
    /// H.
    pub ceiling: [L; 3],
    /// B.
    pub weight: L,
    /// The place in the tile.
    pub pixel: L,
}

/// How many numbers there are for each ray.
const N_NUMBERS: usize = 16;

/// Packets are written and read as a whole, whatever number of rays is in them.
const CAPACITY: usize = TILE_PIXELS + 2 * MAX_LANES;

/// One of the numbers of every ray.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Column([f32; CAPACITY]);

/// Rays that wait to be traced, number by number.
#[derive(Clone, Debug)]
pub(super) struct Queue {
    /// Whether every mirror gives all three channels the same, so that A and H of the first stand for all.
    is_grey: bool,
    len: usize,
    numbers: Box<[Column]>,
}

/// Carries out `$put` for each number of a packet, with its place and its name.
macro_rules! for_each_number {
    ($is_grey:expr, $rays:expr, $put:ident) => {
        $put!(0, $rays.path.origin[0]);
        $put!(1, $rays.path.origin[1]);
        $put!(2, $rays.path.origin[2]);
        $put!(3, $rays.path.dir[0]);
        $put!(4, $rays.path.dir[1]);
        $put!(5, $rays.path.dir[2]);
        $put!(6, $rays.path.leaving);
        $put!(7, $rays.path.equation);
        $put!(8, $rays.weight);
        $put!(9, $rays.pixel);
        $put!(10, $rays.sum[0]);
        $put!(11, $rays.ceiling[0]);
        if !$is_grey {
            $put!(12, $rays.sum[1]);
            $put!(13, $rays.sum[2]);
            $put!(14, $rays.ceiling[1]);
            $put!(15, $rays.ceiling[2]);
        }
    };
}

impl Queue {
    /// Makes a queue; with room for rays if there are mirrors.
    pub fn new(has_mirrors: bool, is_grey: bool) -> Self {
        let n_numbers = if has_mirrors { N_NUMBERS } else { 0 };
        Self { is_grey, len: 0, numbers: vec![Column([0.0; CAPACITY]); n_numbers].into() }
    }

    /// Returns how many rays there are.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Takes all rays out.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds the rays of the mask.
    #[inline(always)]
    pub fn push<L: SingleLanes>(&mut self, rays: &Rays<L>, mask: L::Mask) {
        let n_rays = mask.bits().count_ones() as usize;
        let end = self.len;
        assert!(end + L::N <= CAPACITY && self.numbers.len() == N_NUMBERS);
        if n_rays == L::N {
            macro_rules! put {
                ($place:literal, $lanes:expr) => {
                    $lanes.store(&mut self.numbers[$place].0[end..]);
                };
            }
            for_each_number!(self.is_grey, rays, put);
        } else {
            macro_rules! put {
                ($place:literal, $lanes:expr) => {
                    $lanes.store_packed(mask, &mut self.numbers[$place].0[end..]);
                };
            }
            for_each_number!(self.is_grey, rays, put);
        }
        self.len += n_rays;
    }

    /// Returns where the packet from this ray on goes.
    #[inline(always)]
    pub fn path<L: SingleLanes>(&self, first: usize) -> Reflected<L> {
        let get = |place: usize| L::load(&self.numbers[place].0[first..]);
        Reflected { origin: [get(0), get(1), get(2)], dir: [get(3), get(4), get(5)], leaving: get(6), equation: get(7) }
    }

    /// Returns which lanes of the packet from this ray on hold one.
    #[inline(always)]
    pub fn lanes<L: SingleLanes>(&self, first: usize) -> L::Mask {
        let n_rays = (self.len - first).min(L::N);
        L::Mask::from_bits((1 << n_rays) - 1)
    }

    /// Returns the packet from this ray on.
    #[inline(always)]
    pub fn packet<L: SingleLanes>(&self, first: usize) -> Rays<L> {
        let get = |place: usize| L::load(&self.numbers[place].0[first..]);
        let (sum, ceiling) = if self.is_grey {
            ([get(10); 3], [get(11); 3])
        } else {
            ([get(10), get(12), get(13)], [get(11), get(14), get(15)])
        };
        Rays { path: self.path(first), sum, ceiling, weight: get(8), pixel: get(9) }
    }
}

/// What a mirror is to the rays that leave it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mirror {
    pub reflectance: f32,
    /// As in [`Reflected`].
    pub leaving: f32,
    pub equation: f32,
}

/// Of a ray that weighs more than some levels it is not asked whether a byte is settled.
const MAX_SETTLED_WEIGHT: f32 = 1.0 / 64.0;

/// Returns the rays that leave a packet of hits on a mirror, and those whose colour can still change a byte.
///
/// `local`: the colour of the hits by themselves. `rays`: those that met the mirror.
#[inline(always)]
pub(super) fn reflect<L: SingleLanes>(
    mirror: Mirror,
    at: &Points<L>,
    local: [L; 3],
    rays: &Rays<L>,
) -> (Rays<L>, L::Mask) {
    // The normal's length is off by a rounding of the point: it is made 1, so that directions stay of unit length. Its
    // square is so close to 1 that 1/√x is 3/2 − x/2.
    let per_length = L::same(1.5) - dot(at.normal, at.normal) * L::same(0.5);
    let normal = times(at.normal, per_length);
    let twice = dot(normal, at.view) * L::same(2.0);
    let dir = [normal[0] * twice - at.view[0], normal[1] * twice - at.view[1], normal[2] * twice - at.view[2]];
    let sum = plus_times(rays.sum, local, rays.weight);
    let ceiling = [
        rays.ceiling[0].min(rays.sum[0] + rays.weight),
        rays.ceiling[1].min(rays.sum[1] + rays.weight),
        rays.ceiling[2].min(rays.sum[2] + rays.weight),
    ];
    let weight = rays.weight * L::same(mirror.reflectance);
    let path =
        Reflected { origin: at.point, dir, leaving: L::same(mirror.leaving), equation: L::same(mirror.equation) };
    let reflected = Rays { path, sum, ceiling, weight, pixel: rays.pixel };
    // A heavy ray settles next to nothing, and a first channel that may still change is enough.
    let mut is_settled = weight.lt(L::same(MAX_SETTLED_WEIGHT));
    if is_settled.any() {
        is_settled = is_settled & is_channel_settled(&reflected, 0);
    }
    if is_settled.any() {
        is_settled = is_settled & is_channel_settled(&reflected, 1) & is_channel_settled(&reflected, 2);
    }
    (reflected, !is_settled)
}

/// Tells in which pixels a channel is the same byte whatever the rays find.
#[inline(always)]
fn is_channel_settled<L: SingleLanes>(rays: &Rays<L>, k: usize) -> L::Mask {
    let (sum, ceiling) = (rays.sum[k], rays.ceiling[k]);
    byte(sum.min(ceiling)).eq(byte((sum + rays.weight).min(ceiling)))
}

/// Returns the colour of the pixels whose last rays found `color`.
#[inline(always)]
pub(super) fn compose<L: SingleLanes>(rays: &Rays<L>, color: [L; 3]) -> [L; 3] {
    let (zero, one) = (L::same(0.0), L::same(1.0));
    [
        (rays.sum[0] + rays.weight * color[0].min(one).max(zero)).min(rays.ceiling[0]),
        (rays.sum[1] + rays.weight * color[1].min(one).max(zero)).min(rays.ceiling[1]),
        (rays.sum[2] + rays.weight * color[2].min(one).max(zero)).min(rays.ceiling[2]),
    ]
}
