//! What rays meet first, by plain comparison: of equal t the object declared first.
//!
//! Everything is met from outside alone, because the eye is outside of everything and a ray ends where it first meets
//! something. A ray cannot meet the convex object that it leaves.

use crate::trace::draft::scene::{Cylinder, DraftScene, Sphere};
use crate::trace::kernels::{Mask, SingleLanes};

/// The nearest hits so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest<L: SingleLanes> {
    /// Infinite where nothing is met.
    pub t: L,
    /// The number of the face.
    pub face: L,
}

impl<L: SingleLanes> Nearest<L> {
    /// Nothing is met yet.
    #[inline(always)]
    pub fn nothing() -> Self {
        Self { t: L::same(f32::INFINITY), face: L::same(0.0) }
    }

    /// Tells which lanes meet something.
    #[inline(always)]
    pub fn met(&self) -> L::Mask {
        self.t.lt(L::same(f32::INFINITY))
    }

    /// Takes notice of a hit in the lanes of the mask.
    #[inline(always)]
    fn consider(&mut self, hit: L::Mask, t: L, face: L) {
        let takes = hit & (t.lt(self.t) | (t.eq(self.t) & face.lt(self.face)));
        self.t = L::select(takes, t, self.t);
        self.face = L::select(takes, face, self.face);
    }
}

/// Returns a·b.
#[inline(always)]
pub(super) fn dot<L: SingleLanes>(a: [L; 3], b: [L; 3]) -> L {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns three numbers that all lanes share.
#[inline(always)]
pub(super) fn same<L: SingleLanes>(numbers: [f32; 3]) -> [L; 3] {
    [L::same(numbers[0]), L::same(numbers[1]), L::same(numbers[2])]
}

/// Returns a vector times a number.
#[inline(always)]
pub(super) fn times<L: SingleLanes>(a: [L; 3], factor: L) -> [L; 3] {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

/// Returns a vector plus another times a number.
#[inline(always)]
pub(super) fn plus_times<L: SingleLanes>(a: [L; 3], b: [L; 3], factor: L) -> [L; 3] {
    [a[0] + b[0] * factor, a[1] + b[1] * factor, a[2] + b[2] * factor]
}

/// Returns the differences from numbers that all lanes share.
#[inline(always)]
pub(super) fn minus<L: SingleLanes>(a: [L; 3], b: [f32; 3]) -> [L; 3] {
    [a[0] - L::same(b[0]), a[1] - L::same(b[1]), a[2] - L::same(b[2])]
}

/// What a row of packets has in common for a sphere.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowSphere {
    /// cy·dy − cz.
    along: f32,
    /// (cy + cz·dy)² and cx·dy: of c × d.
    cross_x_squared: f32,
    cross_z: f32,
}

impl RowSphere {
    /// Prepares a row.
    pub fn new(sphere: &Sphere, dy: f32) -> Self {
        let [cx, cy, cz] = sphere.center;
        let cross_x = cy + cz * dy;
        Self { along: cy * dy - cz, cross_x_squared: cross_x * cross_x, cross_z: cx * dy }
    }
}

/// A packet of eye rays of one row, along (dx, dy, −1).
#[derive(Clone, Copy, Debug)]
pub(super) struct EyeRays<L: SingleLanes> {
    pub dx: L,
    /// |d|².
    pub a: L,
    /// What a cylinder needs.
    pub lines: Lines<L>,
}

/// Tests a packet of eye rays against a sphere.
///
/// D = a·r² − |c × d|² is exact enough for far spheres; the cheaper b² − a·p, somewhat widened, tells when it is needed.
#[inline(always)]
pub(super) fn eye_meets_sphere<L: SingleLanes>(
    nearest: &mut Nearest<L>,
    rays: &EyeRays<L>,
    sphere: &Sphere,
    row: &RowSphere,
) {
    let b = rays.dx * L::same(sphere.center[0]) + L::same(row.along);
    let maybe = (b * b).ge(rays.a * L::same(sphere.power_low)) & b.gt(L::same(0.0));
    if !maybe.any() {
        return;
    }
    let y = rays.dx * L::same(sphere.center[2]) + L::same(sphere.center[0]);
    let z = L::same(row.cross_z) - rays.dx * L::same(sphere.center[1]);
    let discriminant = rays.a * L::same(sphere.radius_squared) - (L::same(row.cross_x_squared) + (y * y + z * z));
    let hit = maybe & discriminant.ge(L::same(0.0));
    let t = L::same(sphere.power) / (b + discriminant.sqrt());
    nearest.consider(hit, t, L::same(sphere.face));
}

/// Lines as cylinders see them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lines<L: SingleLanes> {
    pub dir: [L; 3],
    /// dx² + dz², and what to divide by it and by dy with.
    pub a: L,
    pub inv_a: L,
    pub inv_dy: L,
}

impl<L: SingleLanes> Lines<L> {
    /// Prepares the lines along `dir`.
    #[inline(always)]
    pub fn new(dir: [L; 3]) -> Self {
        let [dx, dy, dz] = dir;
        // An upright line has some width, far below what is seen, so that nothing is divided by 0.
        let a = dx * dx + dz * dz + L::same(1e-20);
        Self { dir, a, inv_a: L::same(1.0) / a, inv_dy: L::same(1.0) / dy }
    }
}

/// Tests lines against a cylinder.
///
/// `from`: their origins. The part of a line inside of the infinite wall, and the part between the caps: what is in both
/// is inside of the cylinder, and begins where the line meets it.
#[inline(always)]
pub(super) fn meet_cylinder<L: SingleLanes>(
    nearest: &mut Nearest<L>,
    cylinder: &Cylinder,
    from: [L; 3],
    lines: &Lines<L>,
    active: L::Mask,
) {
    let (mx, mz) = (L::same(cylinder.x) - from[0], L::same(cylinder.z) - from[2]);
    let cross = mx * lines.dir[2] - mz * lines.dir[0];
    let discriminant = lines.a * L::same(cylinder.radius_squared) - cross * cross;
    let maybe = active & discriminant.ge(L::same(0.0));
    if !maybe.any() {
        return;
    }
    let b = mx * lines.dir[0] + mz * lines.dir[2];
    let root = discriminant.max(L::same(0.0)).sqrt();
    let (enter, leave) = ((b - root) * lines.inv_a, (b + root) * lines.inv_a);
    let zero = L::same(0.0);
    let (lower, upper) = (L::same(cylinder.y_min) - from[1], L::same(cylinder.y_max) - from[1]);
    let (to_lower, to_upper) = (lower * lines.inv_dy, upper * lines.inv_dy);
    // A level line at the height of a cap touches the rim, which counts as a hit; 0/0 would not.
    let is_level = lines.dir[1].eq(zero) & lower.le(zero) & upper.ge(zero);
    let endless = L::same(f32::INFINITY);
    let first = L::select(is_level, -endless, to_lower.min(to_upper));
    let last = L::select(is_level, endless, to_lower.max(to_upper));
    let hit = maybe & enter.max(first).le(leave.min(last));
    let face = L::same(cylinder.face);
    let by_wall = hit & enter.ge(first) & enter.gt(zero);
    if by_wall.any() {
        nearest.consider(by_wall, enter, face);
    }
    let by_cap = hit & first.gt(enter) & first.gt(zero);
    if by_cap.any() {
        let is_lower = lines.dir[1].gt(zero);
        let cap = L::select(is_lower, face + L::same(1.0), face + L::same(2.0));
        nearest.consider(by_cap, first, cap);
    }
}

/// A packet of reflected rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reflected<L: SingleLanes> {
    pub origin: [L; 3],
    /// A unit vector.
    pub dir: [L; 3],
    /// The first face of the object that is left.
    pub leaving: L,
    /// The number of the equation that is left; below 0 for a cap.
    pub equation: L,
}

/// Finds what a packet of reflected rays meets first.
#[inline(always)]
pub(super) fn reflected_meets<L: SingleLanes>(
    scene: &DraftScene,
    spheres: &[u32],
    cylinders: &[u32],
    rays: &Reflected<L>,
    active: L::Mask,
) -> Nearest<L> {
    let mut nearest = Nearest::nothing();
    let origin_squared = dot(rays.origin, rays.origin);
    for &i in spheres {
        let sphere = &scene.spheres[i as usize];
        let other = active & !rays.equation.eq(L::same(sphere.equation));
        reflected_meets_sphere(&mut nearest, rays, sphere, origin_squared, other);
    }
    if !cylinders.is_empty() {
        let lines = Lines::new(rays.dir);
        for &i in cylinders {
            let cylinder = &scene.cylinders[i as usize];
            let is_left = rays.leaving.eq(L::same(cylinder.face)) | rays.equation.eq(L::same(cylinder.equation));
            meet_cylinder(&mut nearest, cylinder, rays.origin, &lines, active & !is_left);
        }
    }
    nearest
}

/// D = r² − |m − b·d|², where m − b·d is the centre as seen from the nearest point of the ray.
#[inline(always)]
fn reflected_meets_sphere<L: SingleLanes>(
    nearest: &mut Nearest<L>,
    rays: &Reflected<L>,
    sphere: &Sphere,
    origin_squared: L,
    active: L::Mask,
) {
    let [ox, oy, oz] = rays.origin;
    let m = [L::same(sphere.center[0]) - ox, L::same(sphere.center[1]) - oy, L::same(sphere.center[2]) - oz];
    let b = dot(m, rays.dir);
    let nearest_point = [m[0] - b * rays.dir[0], m[1] - b * rays.dir[1], m[2] - b * rays.dir[2]];
    let discriminant = L::same(sphere.radius_squared) - dot(nearest_point, nearest_point);
    let maybe = active & discriminant.ge(L::same(0.0)) & b.gt(L::same(0.0));
    if !maybe.any() {
        return;
    }
    let root = discriminant.sqrt();
    let t = if sphere.is_large {
        let along = ox * L::same(sphere.center[0]) + oy * L::same(sphere.center[1]) + oz * L::same(sphere.center[2]);
        (origin_squared - L::same(2.0) * along + L::same(sphere.power)) / (b + root)
    } else {
        b - root
    };
    nearest.consider(maybe & t.gt(L::same(0.0)), t, L::same(sphere.face));
}
