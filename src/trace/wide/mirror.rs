//! Reflected rays: what they carry, where they go and what they meet first.
//!
//! # Errors
//! A ray is the line through o along the unit vector d; the exact ray starts within e of o and its direction is within ε of
//! d. With m from o to a centre, b = m·d is off by e + |m|(ε + 8u), and D = b² − |m|² + r², or for a wall, where
//! a = dx² + dz² stands before |m|² − r², by at most 8|m|²(ε + 8u) + 6|m|e + 16u·r². Of |m| only the square is at hand;
//! for any length ℓ, |m| ≤ (|m|²/ℓ + ℓ)/2, and ℓ is a usual radius of the scene. In a cluster (see there) |m| has a bound
//! beforehand.
//!
//! *How far off a hit is*, is measured, not predicted. Let P be the computed point, off the surface by ρ (for a sphere
//! | |P − c| − r |, known from the length of the computed normal), and γ the cosine between normal and ray. The exact ray
//! passes P at a distance of at most e + t·ε + 8u(|P| + t) =: δ. Along the ray its distance from the surface changes by γ for each
//! unit of length, up to second order, so the exact ray meets the surface within (δ·sin + ρ)/γ of the point where it passes
//! P, and that point is within (δ + ρ)/γ of P. The second order is below a 20th of that as long as the error of the normal is
//! below a 64th of γ, which is made sure.
//!
//! *The reflected direction* d − 2(n·d)n depends on d as an isometry does; a normal that is off by η across itself turns
//! it by 2η, and one that is not of unit length by ζ stretches it by 4ζ.

use crate::trace::kernels::{Lanes, Mask};
use crate::trace::wide::bounds::{Bounds, Face, FaceKind, MIN_CAP_COSINE, MirroredSphere, Terms};
use crate::trace::wide::cluster::{Cluster, Table};
use crate::trace::wide::eye::Nearest;
use crate::trace::wide::queue::{Paths, Rays};
use crate::trace::wide::shade::{Colors, Points, dot, splat_each};

/// What the bounds of a packet of reflected rays have in common.
#[derive(Clone, Copy, Debug)]
struct Reach<L> {
    /// The error of b is at most |m|²·`along` + `along_least`.
    along: L,
    along_least: L,
    /// The error of D is at most |m|²·`square` + `square_least` + 16u·r².
    square: L,
    square_least: L,
}

impl<L: Lanes> Reach<L> {
    #[inline(always)]
    fn new(bounds: &Bounds, rays: &Rays<L>) -> Self {
        let size = bounds.size;
        let turned = rays.dir_error + L::splat(8.0 * L::U);
        Self {
            along: turned * L::splat(0.5 / size),
            along_least: rays.origin_error.mul_add(L::splat(1.01), turned * L::splat(0.5 * size)),
            square: turned.mul_add(L::splat(8.0), rays.origin_error * L::splat(3.0 / size)),
            square_least: rays.origin_error * L::splat(3.0 * size),
        }
    }

    #[inline(always)]
    fn along(&self, m_squared: L) -> L {
        m_squared.mul_add(self.along, self.along_least)
    }

    #[inline(always)]
    fn square(&self, m_squared: L, radius_squared: f64) -> L {
        m_squared.mul_add(self.square, self.square_least + L::splat(16.0 * L::U * radius_squared))
    }
}

/// Finds what a packet of reflected rays meets first.
#[inline(always)]
pub(super) fn nearest_hit<L: Lanes>(
    bounds: &Bounds,
    spheres: &[u32],
    cylinders: &[u32],
    rays: &Rays<L>,
    active: L::Mask,
) -> Nearest<L> {
    let mut nearest = Nearest::nothing();
    let reach = Reach::new(bounds, rays);
    match &bounds.cluster {
        Some(cluster) => {
            nearest = meet_cluster(cluster, &bounds.mirrored, spheres, rays, !cylinders.is_empty());
        }
        None => {
            for &i in spheres {
                meet_sphere(&mut nearest, bounds, &bounds.mirrored[i as usize], rays, &reach, active);
            }
        }
    }
    for &i in cylinders {
        let first = bounds.spheres.len() + 3 * i as usize;
        meet_cylinder(&mut nearest, bounds, first, rays, &reach, active);
    }
    nearest
}

/// Finds which of some spheres that are apart a packet meets first: that with the smallest b.
///
/// The sphere that a ray leaves is among those that it leaves behind. `compares`: whether t is still to be compared.
#[inline(always)]
pub(super) fn meet_cluster<L: Lanes>(
    cluster: &Cluster,
    spheres: &[MirroredSphere],
    among: &[u32],
    rays: &Rays<L>,
    compares: bool,
) -> Nearest<L> {
    let (turned, span) = (rays.dir_error + L::splat(8.0 * L::U), cluster.span);
    let off = rays.origin_error.mul_add(L::splat(1.01), turned * L::splat(span));
    let slack = turned.mul_add(
        L::splat(8.0 * span * span),
        rays.origin_error.mul_add(L::splat(6.06 * span), L::splat(cluster.radius_rounding)),
    );
    let (minus_off, minus_slack) = (-off, -slack);
    let mut nearest = Nearest::nothing();
    let mut b_first = nearest.t;
    let mut discriminant_first = nearest.t;
    for &i in among {
        let sphere = &spheres[i as usize];
        let m: [L; 3] = [
            L::splat(sphere.center[0]) - rays.origin[0],
            L::splat(sphere.center[1]) - rays.origin[1],
            L::splat(sphere.center[2]) - rays.origin[2],
        ];
        let b = dot(m, rays.dir);
        let power = m[0].mul_add(m[0], m[1].mul_add(m[1], m[2].mul_add(m[2], -L::splat(sphere.radius_squared))));
        let discriminant = b.mul_add(b, -power);
        let first = b.lt(b_first) & b.ge(minus_off) & discriminant.ge(minus_slack);
        b_first = L::select(first, b, b_first);
        discriminant_first = L::select(first, discriminant, discriminant_first);
        nearest.face = L::select(first, L::splat(sphere.face_number), nearest.face);
    }
    let is_met = b_first.lt(nearest.t);
    let root = discriminant_first.sqrt();
    let t = b_first - root;
    // The power is b² − D.
    let power = t * (b_first + root);
    let is_sure = discriminant_first.gt(slack + L::splat(cluster.least)) & b_first.gt(off) & power.gt(slack + slack);
    nearest.doubt = (is_met & !is_sure) | !off.lt(L::splat(cluster.gap));
    nearest.t = L::select(is_met, t, nearest.t);
    if compares {
        let margin = off + slack / root;
        nearest.margin = margin + margin;
    }
    nearest
}

#[inline(always)]
fn meet_sphere<L: Lanes>(
    nearest: &mut Nearest<L>,
    bounds: &Bounds,
    sphere: &MirroredSphere,
    rays: &Rays<L>,
    reach: &Reach<L>,
    active: L::Mask,
) {
    let m: [L; 3] = [
        L::splat(sphere.center[0]) - rays.origin[0],
        L::splat(sphere.center[1]) - rays.origin[1],
        L::splat(sphere.center[2]) - rays.origin[2],
    ];
    let (squared, face) = (sphere.radius_squared, sphere.face);
    let b = dot(m, rays.dir);
    let m_squared = dot(m, m);
    let power = m_squared - L::splat(squared);
    let discriminant = b.mul_add(b, -power);
    let is_other = !rays.leaving.eq(L::splat(sphere.equation));
    let slack = reach.square(m_squared, squared);
    let least = slack + L::splat(sphere.least);
    if sphere.is_shell {
        // A shell: where the ray leaves it the power is 0.
        let discriminant = L::select(is_other, discriminant, b * b);
        let off = reach.along(m_squared);
        let is_inside = (is_other & power.lt(-slack - slack)) | (!is_other & b.gt(off));
        let hit = active & is_inside & discriminant.gt(least);
        nearest.doubt = nearest.doubt | (active & !hit);
        let root = discriminant.sqrt();
        let margin = off + slack / root;
        nearest.consider(bounds, hit, b + root, margin + margin, face);
        return;
    }
    let line_meets = active & is_other & discriminant.ge(-slack);
    if !line_meets.any() {
        return;
    }
    let off = reach.along(m_squared);
    let maybe = line_meets & b.ge(-off);
    if !maybe.any() {
        return;
    }
    let hit = maybe & discriminant.gt(least) & b.gt(off) & power.gt(slack + slack);
    nearest.doubt = nearest.doubt | (maybe & !hit);
    if hit.any() {
        let root = discriminant.sqrt();
        // A root is off by at most the error of its square, divided by it.
        let margin = off + slack / root;
        nearest.consider(bounds, hit, b - root, margin + margin, face);
    }
}

/// Tests a packet against a cylinder whose wall is the face `first`.
///
/// The origin lies outside of the cylinder or on it. Inside of the infinite wall runs the part of the ray from `enter` to
/// `leave`; the ray meets the wall if it enters at a height of the cylinder's, and a cap if it enters on one side of it and
/// leaves, or would leave, on the other.
#[inline(always)]
fn meet_cylinder<L: Lanes>(
    nearest: &mut Nearest<L>,
    bounds: &Bounds,
    first: usize,
    rays: &Rays<L>,
    reach: &Reach<L>,
    active: L::Mask,
) {
    let (wall, lower, upper) = (&bounds.faces[first], &bounds.faces[first + 1], &bounds.faces[first + 2]);
    let ([ox, oy, oz], [dx, dy, dz]) = (rays.origin, rays.dir);
    let (mx, mz) = (L::splat(wall.center[0]) - ox, L::splat(wall.center[2]) - oz);
    let squared = wall.radius * wall.radius;
    let a = dx * dx + dz * dz;
    let b = mx * dx + mz * dz;
    let m_squared = mx * mx + mz * mz;
    let power = m_squared - L::splat(squared);
    let discriminant = b * b - a * power;
    let slack = reach.square(m_squared, squared);
    let off = reach.along(m_squared);
    let is_other = !rays.leaving.eq(L::splat(f64::from(wall.equation)));
    let is_outside = power.gt(slack);
    let is_inside = power.lt(-slack);
    let leads_away = is_outside & b.lt(-off);
    let maybe = active & is_other & discriminant.ge(-slack) & !leads_away;
    if !maybe.any() {
        return;
    }
    let (y_min, y_max) = (L::splat(lower.center[1]), L::splat(upper.center[1]));
    // A ray that leaves this cap, or one level with it.
    let zero = L::splat(0.0);
    let leaves_top = rays.leaving.eq(L::splat(f64::from(upper.equation))) & dy.gt(zero);
    let leaves_bottom = rays.leaving.eq(L::splat(f64::from(lower.equation))) & dy.lt(zero);

    let min_cosine = L::PRECISION.min_cosine;
    let is_proper = discriminant.gt(slack * L::splat(4.0) + L::splat(squared * min_cosine * min_cosine));
    let root = discriminant.max(zero).sqrt();
    let per_a = L::splat(1.0) / a;
    let (enter, leave) = ((b - root) * per_a, (b + root) * per_a);
    let stretch = leave.abs() * (rays.dir_error * L::splat(2.0) + L::splat(8.0 * L::U));
    let slip = per_a * (off + slack / root + stretch) * L::splat(1.5);
    let height_slip = slip + stretch + rays.origin_error * L::splat(2.0) + oy.abs() * L::splat(8.0 * L::U);
    let (first_height, last_height) = (oy + enter * dy, oy + leave * dy);
    let (floor, ceiling) = (y_min + height_slip, y_max - height_slip);
    let (below, above) = (y_min - height_slip, y_max + height_slip);

    let starts_above = (is_outside & first_height.gt(above)) | (is_inside & oy.gt(y_max + rays.origin_error));
    let starts_below = (is_outside & first_height.lt(below)) | (is_inside & oy.lt(y_min - rays.origin_error));
    let meets_wall = is_outside & b.gt(off) & enter.gt(slip) & first_height.gt(floor) & first_height.lt(ceiling);
    let meets_top = starts_above & last_height.lt(ceiling) & dy.lt(L::splat(-MIN_CAP_COSINE));
    let meets_bottom = starts_below & last_height.gt(floor) & dy.gt(L::splat(MIN_CAP_COSINE));
    let passes = (starts_above & last_height.gt(above)) | (starts_below & last_height.lt(below));

    let sure = maybe & is_proper;
    let (on_wall, on_top, on_bottom) = (sure & meets_wall, sure & meets_top, sure & meets_bottom);
    let misses = (sure & passes) | (is_inside & (leaves_top | leaves_bottom));
    nearest.doubt = nearest.doubt | (maybe & !(on_wall | on_top | on_bottom | misses));
    let first = first as u32;
    if on_wall.any() {
        nearest.consider(bounds, on_wall, enter, slip + slip, first);
    }
    for (lanes, height, face) in [(on_bottom, y_min, first + 1), (on_top, y_max, first + 2)] {
        if lanes.any() {
            let rise = L::splat(1.0) / dy;
            let margin = (rays.origin_error + (height.abs() + oy.abs()) * L::splat(8.0 * L::U)) * rise.abs() + stretch;
            nearest.consider(bounds, lanes, (height - oy) * rise, margin + margin, face);
        }
    }
}

/// What a packet of reflected rays meets: one face, or spheres of one group.
#[derive(Clone, Copy, Debug)]
pub(super) struct Met<L> {
    kind: FaceKind,
    center: [L; 3],
    radius: L,
    per_radius: L,
    equation: L,
}

impl<L: Lanes> Met<L> {
    /// Makes every lane meet one face.
    #[inline(always)]
    pub fn one(face: &Face) -> Self {
        Self {
            kind: face.kind,
            center: splat_each(face.center),
            radius: L::splat(face.radius),
            per_radius: L::splat(face.per_radius),
            equation: L::splat(f64::from(face.equation)),
        }
    }

    /// Makes each lane meet the sphere of its face.
    #[inline(always)]
    pub fn of_table(table: &Table, face: L) -> Self {
        Self {
            kind: FaceKind::Sphere,
            center: [
                L::look_up(&table.center[0], face),
                L::look_up(&table.center[1], face),
                L::look_up(&table.center[2], face),
            ],
            radius: L::look_up(&table.radius, face),
            per_radius: L::look_up(&table.per_radius, face),
            equation: L::look_up(&table.equation, face),
        }
    }

    /// Makes the lanes of the mask meet another sphere.
    #[inline(always)]
    pub fn but(self, mask: L::Mask, face: &Face) -> Self {
        let other = Self::one(face);
        Self {
            kind: self.kind,
            center: [
                L::select(mask, other.center[0], self.center[0]),
                L::select(mask, other.center[1], self.center[1]),
                L::select(mask, other.center[2], self.center[2]),
            ],
            radius: L::select(mask, other.radius, self.radius),
            per_radius: L::select(mask, other.per_radius, self.per_radius),
            equation: L::select(mask, other.equation, self.equation),
        }
    }
}

/// Works out the points where a packet of reflected rays meets one face, and how far they are off; returns them with the
/// lanes of which too little is known.
#[inline(always)]
pub(super) fn points<L: Lanes>(
    bounds: &Bounds,
    met: &Met<L>,
    rays: &Rays<L>,
    t: L,
    lanes: L::Mask,
) -> (Points<L>, L::Mask) {
    let zero = L::splat(0.0);
    let [x, y, z] = [
        t.mul_add(rays.dir[0], rays.origin[0]),
        t.mul_add(rays.dir[1], rays.origin[1]),
        t.mul_add(rays.dir[2], rays.origin[2]),
    ];
    let per_radius = met.per_radius;
    let nx = (x - met.center[0]) * per_radius;
    let nz = (z - met.center[2]) * per_radius;
    let (point, normal) = match met.kind {
        FaceKind::Sphere => ([x, y, z], [nx, (y - met.center[1]) * per_radius, nz]),
        FaceKind::Wall => ([x, y, z], [nx, zero, nz]),
        FaceKind::LowerCap => ([x, met.center[1], z], [zero, L::splat(-1.0), zero]),
        FaceKind::UpperCap => ([x, met.center[1], z], [zero, L::splat(1.0), zero]),
    };
    let cosine = -dot(normal, rays.dir);
    let rounding = match (&bounds.cluster, met.kind) {
        (Some(cluster), FaceKind::Sphere) => L::splat(cluster.hit_rounding),
        _ => (x.abs() + y.abs() + z.abs() + t) * L::splat(8.0 * L::U),
    };
    let passes_within = t.mul_add(rays.dir_error, rays.origin_error + rounding);
    let per_cosine = cosine.reciprocal_bound();
    let is_curved = matches!(met.kind, FaceKind::Sphere | FaceKind::Wall);
    let (point_error, normal_error, length_error, vague) = if is_curved {
        // | |n|² − 1 | / 2, with what the normal's own roundings hide.
        let [nx, ny, nz] = normal;
        let excess = nx.mul_add(nx, ny.mul_add(ny, nz.mul_add(nz, -L::splat(1.0))));
        let length_error = excess.abs().mul_add(L::splat(0.5), L::splat(8.0 * L::U));
        let point_error = length_error.mul_add(met.radius, passes_within) * (per_cosine * L::splat(1.06));
        let normal_error = point_error.mul_add(per_radius.abs(), L::splat(4.0 * L::U));
        let is_known = cosine.gt(L::splat(L::PRECISION.min_cosine)) & normal_error.lt(cosine * L::splat(1.0 / 64.0));
        (point_error, normal_error, length_error, lanes & !is_known)
    } else {
        let point_error = passes_within * (per_cosine * L::splat(1.01));
        (point_error, zero, zero, lanes & !cosine.gt(L::splat(MIN_CAP_COSINE)))
    };
    let view = [-rays.dir[0], -rays.dir[1], -rays.dir[2]];
    // Far below one, so that errors of second order do not count.
    let is_small = point_error.lt(L::splat(bounds.size / 1024.0)) & rays.dir_error.lt(L::splat(1.0 / 256.0));
    let vague = vague | (lanes & !is_small);
    let active = lanes & !vague;
    let (dir_error, equation) = (rays.dir_error, met.equation);
    (
        Points { point, normal, view, cosine, point_error, normal_error, length_error, dir_error, equation, active },
        vague,
    )
}

/// Returns the rays that leave a packet of hits on a mirror.
#[inline(always)]
pub(super) fn reflect<L: Lanes>(at: &Points<L>) -> Rays<L> {
    let twice = at.cosine + at.cosine;
    let dir = [
        at.normal[0].mul_add(twice, -at.view[0]),
        at.normal[1].mul_add(twice, -at.view[1]),
        at.normal[2].mul_add(twice, -at.view[2]),
    ];
    let of_length = at.length_error.mul_add(L::splat(4.0), L::splat(16.0 * L::U));
    let of_normal = at.normal_error.mul_add(L::splat(2.05), of_length);
    let dir_error = at.dir_error.mul_add(L::splat(1.001), of_normal);
    Rays { origin: at.point, dir, origin_error: at.point_error, dir_error, leaving: at.equation }
}

/// Returns what becomes of the colours behind a packet of hits on a mirror, given what becomes of their own.
#[inline(always)]
pub(super) fn go_on<L: Lanes>(terms: &Terms, local: &Colors<L>, paths: &Paths<L>) -> Paths<L> {
    let weight = paths.weight;
    let sum = [
        weight.mul_add(local.color[0], paths.sum[0]),
        weight.mul_add(local.color[1], paths.sum[1]),
        weight.mul_add(local.color[2], paths.sum[2]),
    ];
    let ceiling = [
        paths.ceiling[0].min(paths.sum[0] + weight),
        paths.ceiling[1].min(paths.sum[1] + weight),
        paths.ceiling[2].min(paths.sum[2] + weight),
    ];
    Paths {
        sum,
        ceiling,
        weight: weight * L::splat(terms.reflectance),
        error: weight.mul_add(local.error, paths.error),
        pixel: paths.pixel,
        level: paths.level + L::splat(1.0),
    }
}

/// Returns the colour of the pixels whose last rays found `color`, and its error.
///
/// Each level has lost at most eight roundings of the sum.
#[inline(always)]
pub(super) fn compose<L: Lanes>(paths: &Paths<L>, color: [L; 3], error: L) -> ([L; 3], L) {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let mut channels = color;
    let mut largest = one;
    for k in 0..3 {
        channels[k] = paths.weight.mul_add(color[k].min(one).max(zero), paths.sum[k]).min(paths.ceiling[k]);
        largest = largest.max(paths.sum[k] + paths.weight);
    }
    let rounding = largest * (paths.level + L::splat(2.0)) * L::splat(8.0 * L::U);
    (channels, paths.weight.mul_add(error, paths.error + rounding))
}
