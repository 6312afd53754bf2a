//! Reflected rays, and what becomes of the colours they find.

use crate::trace::draft::meet::{Reflected, dot, plus_times, times};
use crate::trace::draft::shade::{Points, bytes};
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

/// Rays that wait to be traced, number by number.
#[derive(Clone, Debug)]
pub(super) struct Queue {
    len: usize,
    numbers: [Vec<f32>; N_NUMBERS],
}

impl Queue {
    /// Makes a queue for as many rays.
    pub fn new(capacity: usize) -> Self {
        // Packets are written and read as a whole, whatever number of rays is in them.
        Self { len: 0, numbers: std::array::from_fn(|_| vec![0.0; capacity + 2 * MAX_LANES]) }
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
        let ([ox, oy, oz], [dx, dy, dz]) = (rays.path.origin, rays.path.dir);
        let ([ar, ag, ab], [hr, hg, hb]) = (rays.sum, rays.ceiling);
        let (leaving, equation) = (rays.path.leaving, rays.path.equation);
        let numbers: [L; N_NUMBERS] =
            [ox, oy, oz, dx, dy, dz, leaving, equation, ar, ag, ab, hr, hg, hb, rays.weight, rays.pixel];
        for (lanes, to) in numbers.into_iter().zip(&mut self.numbers) {
            lanes.store_packed(mask, &mut to[self.len..]);
        }
        self.len += mask.bits().count_ones() as usize;
    }

    /// Returns the packet from this ray on, and which of its lanes hold a ray.
    #[inline(always)]
    pub fn packet<L: SingleLanes>(&self, first: usize) -> (Rays<L>, L::Mask) {
        let mut numbers = [L::same(0.0); N_NUMBERS];
        for (lanes, from) in numbers.iter_mut().zip(&self.numbers) {
            *lanes = L::load(&from[first..]);
        }
        let [ox, oy, oz, dx, dy, dz, leaving, equation, ar, ag, ab, hr, hg, hb, weight, pixel] = numbers;
        let path = Reflected { origin: [ox, oy, oz], dir: [dx, dy, dz], leaving, equation };
        let rays = Rays { path, sum: [ar, ag, ab], ceiling: [hr, hg, hb], weight, pixel };
        let n_rays = (self.len - first).min(L::N);
        (rays, L::Mask::from_bits((1 << n_rays) - 1))
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
    // The normal's length is off by a rounding of the point: it is made 1, so that directions stay of unit length.
    let per_length = L::same(1.0) / dot(at.normal, at.normal).sqrt();
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
    let (zero, one) = (L::same(0.0), L::same(1.0));
    let (least, most) = (bytes(compose(&reflected, [zero; 3])), bytes(compose(&reflected, [one; 3])));
    let is_settled = least[0].eq(most[0]) & least[1].eq(most[1]) & least[2].eq(most[2]);
    (reflected, !is_settled)
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
