//! What a packet of eye rays meets first.
//!
//! Comparisons are those of `bounds`. Of two hits the nearer is the one whose t is smaller by more than both margins;
//! hits on one equation have equal t, and the one declared first is met.

use crate::trace::kernels::{Lanes, Mask};
use crate::trace::wide::bounds::{Bounds, EyeCap, EyeCylinder, EyeSphere, EyeWall};

/// The most lanes that a packet has.
pub(super) const MAX_LANES: usize = 16;

/// Room for one number a lane. A function that has some lays its registers down at whole cache lines too when it runs out of
/// them; without, each would lie across two.
#[repr(align(64))]
pub(super) struct LaneArray(pub [f64; MAX_LANES]);

/// The nearest hits so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest<L: Lanes> {
    /// Infinite where nothing is met.
    pub t: L,
    /// How far `t` must be away from another to be smaller or larger, half of it.
    pub margin: L,
    /// The number of the face.
    pub face: L,
    /// The lanes in which something may or may not be nearer.
    pub doubt: L::Mask,
}

impl<L: Lanes> Nearest<L> {
    /// Nothing is met yet.
    #[inline(always)]
    pub fn nothing() -> Self {
        let zero = L::splat(0.0);
        Self { t: L::splat(f64::INFINITY), margin: zero, face: zero, doubt: L::Mask::from_bits(0) }
    }

    /// Tells which lanes meet something.
    #[inline(always)]
    pub fn met(&self) -> L::Mask {
        self.t.lt(L::splat(f64::INFINITY))
    }

    /// Takes notice of a sure hit in the lanes of the mask.
    #[inline(always)]
    pub fn consider(&mut self, bounds: &Bounds, hit: L::Mask, t: L, margin: L, face: u32) {
        let apart = self.margin + margin;
        let nearer = hit & t.lt(self.t - apart);
        let close = hit & !(nearer | t.gt(self.t + apart));
        let mut takes = nearer;
        if close.any() {
            let mut faces = [0.0; MAX_LANES];
            self.face.store(&mut faces);
            let (first, unknown) = order_of_copies(bounds, &faces, close.bits(), face);
            takes = takes | L::Mask::from_bits(first);
            self.doubt = self.doubt | L::Mask::from_bits(unknown);
        }
        self.t = L::select(takes, t, self.t);
        self.margin = L::select(takes, margin, self.margin);
        self.face = L::select(takes, L::splat(f64::from(face)), self.face);
    }
}

/// Tells in which lanes `face` is a copy of what is there but declared before it, and in which it is none.
fn order_of_copies(bounds: &Bounds, faces: &[f64; MAX_LANES], close: u32, face: u32) -> (u32, u32) {
    let face = &bounds.faces[face as usize];
    let (mut first, mut unknown) = (0, 0);
    for lane in (0..MAX_LANES).filter(|lane| close >> lane & 1 != 0) {
        let other = &bounds.faces[faces[lane] as usize];
        if face.equation != other.equation {
            unknown |= 1 << lane;
        } else if face.order < other.order {
            first |= 1 << lane;
        }
    }
    (first, unknown)
}

/// What a row of packets has in common for a sphere.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowSphere {
    /// cy·dy − cz.
    pub along: f64,
}

impl RowSphere {
    /// Prepares a row.
    #[inline(always)]
    pub fn new<L: Lanes>(sphere: &EyeSphere, dy: f64) -> Self {
        Self { along: L::rounded(L::rounded(sphere.center[1] * dy) - sphere.center[2]) }
    }
}

/// A packet of eye rays of one row.
#[derive(Clone, Copy, Debug)]
pub(super) struct EyeRays<L: Lanes> {
    pub dx: L,
    /// dx² + 1.
    pub a_wall: L,
    /// |d|².
    pub a: L,
    pub dy: f64,
}

/// Tests a packet against a sphere.
#[inline(always)]
pub(super) fn meet_sphere<L: Lanes>(
    nearest: &mut Nearest<L>,
    bounds: &Bounds,
    rays: &EyeRays<L>,
    sphere: &EyeSphere,
    row: &RowSphere,
) {
    let b = rays.dx.mul_add(L::splat(sphere.center[0]), L::splat(row.along));
    let b_squared = b * b;
    if sphere.is_shell {
        let hit = b_squared.gt(rays.a * L::splat(sphere.power_high));
        let t = (b + (b_squared - rays.a * L::splat(sphere.power)).sqrt()) / rays.a;
        nearest.doubt = nearest.doubt | !hit;
        nearest.consider(bounds, hit, t, L::splat(sphere.margin), sphere.face);
        return;
    }
    let maybe = b_squared.ge(rays.a * L::splat(sphere.power_low)) & b.gt(L::splat(0.0));
    if !maybe.any() {
        return;
    }
    let hit = maybe & b_squared.gt(rays.a * L::splat(sphere.power_high));
    nearest.doubt = nearest.doubt | (maybe & !hit);
    let discriminant =
        if sphere.is_far { far_discriminant(rays, sphere) } else { rays.a.mul_add(L::splat(-sphere.power), b_squared) };
    let t = L::splat(sphere.power) / (b + discriminant.sqrt());
    nearest.consider(bounds, hit, t, L::splat(sphere.margin), sphere.face);
}

/// Returns a·r² − |c × d|².
#[inline(always)]
fn far_discriminant<L: Lanes>(rays: &EyeRays<L>, sphere: &EyeSphere) -> L {
    let [cx, cy, cz] = sphere.center;
    let x = L::splat(-cy - L::rounded(cz * rays.dy));
    let y = rays.dx * L::splat(cz) + L::splat(cx);
    let z = L::splat(cx * rays.dy) - rays.dx * L::splat(cy);
    rays.a * L::splat(sphere.radius_squared) - (x * x + y * y + z * z)
}

/// Tests a packet against a cylinder.
#[inline(always)]
pub(super) fn meet_cylinder<L: Lanes>(
    nearest: &mut Nearest<L>,
    bounds: &Bounds,
    rays: &EyeRays<L>,
    cylinder: &EyeCylinder,
) {
    // A cap is met from its own side only.
    let cap = cylinder.cap.as_ref().filter(|cap| cap.height * rays.dy > 0.0);
    let mut toward_cap = L::Mask::from_bits(u32::MAX);
    if let Some(wall) = &cylinder.wall {
        toward_cap = meet_wall(nearest, bounds, rays, cylinder, wall);
    }
    if let Some(cap) = cap
        && toward_cap.any()
    {
        meet_cap(nearest, bounds, rays, cylinder, cap, toward_cap);
    }
}

/// Tests a packet against a wall, and returns the lanes that pass the infinite wall elsewhere.
#[inline(always)]
fn meet_wall<L: Lanes>(
    nearest: &mut Nearest<L>,
    bounds: &Bounds,
    rays: &EyeRays<L>,
    cylinder: &EyeCylinder,
    wall: &EyeWall,
) -> L::Mask {
    let b = rays.dx * L::splat(cylinder.x) - L::splat(cylinder.z);
    let b_squared = b * b;
    let maybe = b_squared.ge(rays.a_wall * L::splat(wall.power_low)) & b.gt(L::splat(0.0));
    if !maybe.any() {
        return maybe;
    }
    let sure = maybe & b_squared.gt(rays.a_wall * L::splat(wall.power_high));
    let discriminant = if wall.is_far {
        let cross = rays.dx * L::splat(cylinder.z) + L::splat(cylinder.x);
        rays.a_wall * L::splat(wall.radius_squared) - cross * cross
    } else {
        b_squared - rays.a_wall * L::splat(wall.power)
    };
    let t = L::splat(wall.power) / (b + discriminant.sqrt());
    let height = t * L::splat(rays.dy);
    let hit = sure & height.gt(L::splat(wall.floor)) & height.lt(L::splat(wall.ceiling));
    let passes = sure & (height.lt(L::splat(wall.below)) | height.gt(L::splat(wall.above)));
    nearest.doubt = nearest.doubt | (maybe & !(hit | passes));
    if hit.any() {
        nearest.consider(bounds, hit, t, L::splat(wall.margin), wall.face);
    }
    passes
}

#[inline(always)]
fn meet_cap<L: Lanes>(
    nearest: &mut Nearest<L>,
    bounds: &Bounds,
    rays: &EyeRays<L>,
    cylinder: &EyeCylinder,
    cap: &EyeCap,
    lanes: L::Mask,
) {
    let t = L::rounded(cap.height / rays.dy);
    let x = rays.dx * L::splat(t) - L::splat(cylinder.x);
    let z = L::rounded(-t - cylinder.z);
    let from_axis = x * x + L::splat(z * z);
    let hit = lanes & from_axis.lt(L::splat(cap.within));
    nearest.doubt = nearest.doubt | (lanes & !(hit | from_axis.gt(L::splat(cap.beyond))));
    if hit.any() {
        nearest.consider(bounds, hit, L::splat(t), L::splat(cap.margin), cap.face);
    }
}
