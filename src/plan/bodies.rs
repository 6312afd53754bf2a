//! Convex bodies, and planes that prove that two of them do not meet.
//!
//! # Method
//! Two convex bodies are apart when all of one lies beyond a plane and all of the other before it. [`parts`] looks for the
//! plane's normal in plain binary64 by the Frank-Wolfe method: it steps towards the point of the difference of the bodies
//! that is nearest to 0. A normal found so may be wrong; it counts only when the bounds of [`Ball64`] prove that the two
//! sides differ. What touches or overlaps is never parted, and what is parted by less than a few roundings need not be.
//!
//! # Source
//! Gilbert, "An iterative procedure for computing the minimum of a quadratic form on a convex set", SIAM J. Control 4
//! (1966); that a guess is checked and not trusted is the "a posteriori" proof of Rump, "Verification methods", Acta
//! Numerica 19 (2010).

use std::cmp::Ordering;

use glam::DVec3;

use crate::math::{Ball64, Real, Sign, Vector, compare_sum_zero};

/// Steps towards a parting plane. Most pairs are parted by the first; what is not after this many is taken to meet.
const MAX_STEPS: usize = 12;

/// Squares above this, 2⁻⁸⁰⁰, and sums of them have lost nothing to underflow that their roundings would notice.
pub(super) const SMALLEST_SQUARE: f64 = f64::from_bits((1023 - 800) << 52);

/// A convex set of points that is known by how far it reaches in each direction.
pub(super) trait Body {
    /// Returns a point of the body, or one near it, that lies about as far against `along` as any.
    fn lowest(&self, along: DVec3) -> DVec3;

    /// Returns a number within whose bounds the minimum of along·x over the body lies, or that bounds it from below.
    fn min_along(&self, along: DVec3) -> Ball64;

    /// Returns numbers that the lowest and the highest y of the body are the exact sums of, if they are simple.
    fn y_range(&self) -> Option<[[f64; 2]; 2]> {
        None
    }
}

/// An object as a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Solid {
    Sphere { center: DVec3, radius: f64 },
    Cylinder { x: f64, z: f64, radius: f64, y_min: f64, y_max: f64 },
}

impl Body for Solid {
    fn lowest(&self, along: DVec3) -> DVec3 {
        match *self {
            Self::Sphere { center, radius } => center - along * (radius / along.length()),
            Self::Cylinder { x, z, radius, y_min, y_max } => {
                let y = if along.y > 0.0 { y_min } else { y_max };
                let length = along.x.hypot(along.z).max(f64::MIN_POSITIVE);
                DVec3::new(x - along.x / length * radius, y, z - along.z / length * radius)
            }
        }
    }

    fn min_along(&self, along: DVec3) -> Ball64 {
        match *self {
            Self::Sphere { center, radius } => dot(center, along) - length(along) * Ball64::exact(radius),
            Self::Cylinder { x, z, radius, y_min, y_max } => {
                let across = length(DVec3::new(along.x, 0.0, along.z));
                let y = if along.y > 0.0 { y_min } else { y_max };
                dot(DVec3::new(x, y, z), along) - across * Ball64::exact(radius)
            }
        }
    }

    fn y_range(&self) -> Option<[[f64; 2]; 2]> {
        Some(self.heights())
    }
}

impl Solid {
    /// Returns about that point of the solid that is nearest to a point.
    fn nearest(&self, point: DVec3) -> DVec3 {
        match *self {
            Self::Sphere { center, radius } => {
                let way = point - center;
                center + way * (radius / way.length().max(radius))
            }
            Self::Cylinder { x, z, radius, y_min, y_max } => {
                let way = DVec3::new(point.x - x, 0.0, point.z - z);
                let across = way * (radius / way.length().max(radius));
                DVec3::new(x + across.x, point.y.clamp(y_min, y_max), z + across.z)
            }
        }
    }

    /// Returns the centre and the radius of a sphere around the solid.
    ///
    /// The radius is rounded up by far more than the middle of a cylinder's heights is off and than its own roundings lose.
    pub fn sphere_around(&self) -> (DVec3, f64) {
        match *self {
            Self::Sphere { center, radius } => (center, radius),
            Self::Cylinder { x, z, radius, y_min, y_max } => {
                let reach = radius.hypot(0.5 * y_max - 0.5 * y_min) * (1.0 + 1e-9);
                let center = DVec3::new(x, 0.5 * y_min + 0.5 * y_max, z);
                (center, reach + 1e-15 * (y_min.abs() + y_max.abs()))
            }
        }
    }

    /// Proves cheaply of most solids that have no point in common that they have none: the spheres around them have none.
    pub fn is_clear_of(&self, other: &Self) -> bool {
        let ((a, r), (b, s)) = (self.sphere_around(), other.sphere_around());
        let distance_squared = (a - b).length_squared();
        // Few roundings, each relative, unless the squares underflow.
        distance_squared > (r + s) * (r + s) * (1.0 + 1e-12) && distance_squared > SMALLEST_SQUARE
    }

    /// Returns numbers that the lowest and the highest y are the exact sums of.
    pub fn heights(&self) -> [[f64; 2]; 2] {
        match *self {
            Self::Sphere { center, radius } => [[center.y, -radius], [center.y, radius]],
            Self::Cylinder { y_min, y_max, .. } => [[y_min, 0.0], [y_max, 0.0]],
        }
    }
}

/// The part of a sphere that faces a light outside of it: what lies beyond the plane in which the tangents from the light
/// touch, up to the cone that they make.
///
/// With w from the centre to the light, the sphere's point p faces the light exactly when (p − c)·w > r². That plane cuts
/// the sphere in a disc about e = c + w·r²/|w|² of radius ρ = r·√(1 − r²/|w|²), and what of the sphere lies beyond it lies
/// within the cone over the disc with its apex in the light.
#[derive(Clone, Copy, Debug)]
pub(super) struct FacingDisc {
    center: DVec3,
    light: DVec3,
    /// w
    to_light: Vector<Ball64>,
    /// r²/|w|²
    share: Ball64,
    /// ρ/|w|
    spread: Ball64,
}

impl FacingDisc {
    /// Makes the disc of a sphere towards a light that is proved to lie outside; `None` if it is not.
    pub fn new(center: DVec3, radius: f64, light: DVec3) -> Option<Self> {
        let power = Ball64::power_of_point(light.to_array().map(Ball64::exact), center.to_array(), radius);
        if power.sign() != Sign::Positive {
            return None;
        }
        let to_light = Vector::exact(light) - Vector::exact(center);
        let squared = to_light.length_squared();
        let radius = Ball64::exact(radius);
        let share = radius.square() / squared;
        // 1 − r²/|w|² by the power, which does not cancel.
        let spread = radius * (power / squared / squared).sqrt();
        Some(Self { center, light, to_light, share, spread })
    }

    /// Returns the middle and the radius, roughly.
    fn rough(&self) -> (DVec3, DVec3, f64) {
        let to_light = self.light - self.center;
        let middle = self.center + to_light * self.share.value();
        (middle, to_light, self.spread.value() * to_light.length())
    }
}

impl Body for FacingDisc {
    fn lowest(&self, along: DVec3) -> DVec3 {
        let (middle, axis, radius) = self.rough();
        let across = along - axis * (along.dot(axis) / axis.length_squared());
        middle - across * (radius / across.length().max(f64::MIN_POSITIVE))
    }

    /// The disc's lowest point is ρ·|n × w|/|w| below its middle.
    fn min_along(&self, along: DVec3) -> Ball64 {
        let n = Vector::<Ball64>::exact(along);
        let reach = n.cross(self.to_light).length_squared().sqrt() * self.spread;
        dot(self.center, along) + n.dot(self.to_light) * self.share - reach
    }
}

/// Proves, if it can, that no point of `solid` lies on a segment from a point of `start` to `end`, the two ends left out.
///
/// All of `start` must lie on one side of a plane of which `solid` does not lie on that side, and `end` beyond it; one of
/// the two may touch the plane, so that a ball on the ground does not have the ground in its light.
pub(super) fn parts(start: &impl Body, end: DVec3, solid: &Solid) -> bool {
    parts_by_height(start, end, solid) || finds_plane(start, Some(end), solid)
}

/// Proves, if it can, that two bodies have no point in common.
pub(super) fn are_apart(body: &impl Body, solid: &Solid) -> bool {
    finds_plane(body, None, solid)
}

/// Does the work of [`parts`] for level planes, by exact arithmetic.
fn parts_by_height(start: &impl Body, end: DVec3, solid: &Solid) -> bool {
    let Some([start_min, start_max]) = start.y_range() else { return false };
    let [solid_min, solid_max] = solid.heights();
    let compare = |[a, b]: [f64; 2], [c, d]: [f64; 2]| compare_sum_zero([a, b, -c, -d]);
    let above = |body: [f64; 2]| compare(body, solid_max);
    let below = |body: [f64; 2]| compare(solid_min, body);
    let level = [end.y, 0.0];
    leaves_behind(above(start_min), above(level)) || leaves_behind(below(start_max), below(level))
}

/// Tells whether neither end of a segment is below 0 and not both are 0, so that all between them is above.
fn leaves_behind(start: Ordering, end: Ordering) -> bool {
    start.is_ge() && end.is_ge() && (start.is_gt() || end.is_gt())
}

/// Looks for a plane with all of `start` and `end` beyond it and all of `solid` before it.
fn finds_plane(start: &impl Body, end: Option<DVec3>, solid: &Solid) -> bool {
    // From a point of the solid to one of the other body: a point of their difference.
    let step = |along: DVec3| {
        let near = start.lowest(along);
        let near = end.filter(|end| along.dot(*end) < along.dot(near)).unwrap_or(near);
        near - solid.lowest(-along)
    };
    let mut nearest = first_guess(start, solid);
    for _ in 0..MAX_STEPS {
        let length = nearest.length();
        if length.is_nan() || length == 0.0 {
            return false;
        }
        let along = nearest / length;
        let next = step(along);
        if along.dot(next) > 0.0 && is_plane_between(start, end, solid, along) {
            return true;
        }
        let toward = next - nearest;
        let share = -nearest.dot(toward) / toward.length_squared();
        if share.is_nan() || share <= 0.0 {
            return false;
        }
        nearest += toward * share.min(1.0);
    }
    false
}

/// Returns the way to a point of `start` from the point of `solid` that is nearest to it.
fn first_guess(start: &impl Body, solid: &Solid) -> DVec3 {
    let anywhere = start.lowest(DVec3::Y);
    let near = start.lowest(anywhere - solid.nearest(anywhere));
    let way = near - solid.nearest(near);
    if way == DVec3::ZERO { near - solid.lowest(DVec3::NEG_Y) } else { way }
}

/// Proves that a plane with this normal parts the bodies.
fn is_plane_between(start: &impl Body, end: Option<DVec3>, solid: &Solid, along: DVec3) -> bool {
    let solid_max = -solid.min_along(-along);
    let is_beyond = |number: Ball64| (number - solid_max).sign() == Sign::Positive;
    is_beyond(start.min_along(along)) && end.is_none_or(|end| is_beyond(dot(end, along)))
}

/// Returns a·b with its bound.
pub(super) fn dot(a: DVec3, b: DVec3) -> Ball64 {
    Vector::<Ball64>::exact(a).dot(Vector::exact(b))
}

/// Returns |v| with its bound.
pub(super) fn length(v: DVec3) -> Ball64 {
    Vector::<Ball64>::exact(v).length_squared().sqrt()
}
