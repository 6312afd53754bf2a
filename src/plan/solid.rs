//! How solids lie to points and to each other, proved or not said.

use std::cmp::Ordering;

use glam::DVec3;

use crate::math::{Ball64, Expansion, Real, Sign, Vector, compare_sum_zero};
use crate::plan::bodies::{Solid, are_apart};

/// Which faces of an object are meant; a sphere has but its wall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Faces {
    /// The wall of a cylinder, or a sphere.
    pub wall: bool,
    /// The lower cap of a cylinder.
    pub lower: bool,
    /// The upper cap of a cylinder.
    pub upper: bool,
}

impl Faces {
    /// All faces.
    pub const ALL: Self = Self { wall: true, lower: true, upper: true };

    /// Tells whether no face is meant.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        !(self.wall || self.lower || self.upper)
    }

    /// Returns the faces of either.
    #[must_use]
    pub const fn or(self, other: Self) -> Self {
        Self { wall: self.wall || other.wall, lower: self.lower || other.lower, upper: self.upper || other.upper }
    }

    /// Returns the faces of both.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self { wall: self.wall && other.wall, lower: self.lower && other.lower, upper: self.upper && other.upper }
    }
}

impl Solid {
    /// Proves, if it can, that a point lies outside, not on the surface.
    pub fn excludes(&self, point: DVec3) -> bool {
        match *self {
            Self::Sphere { .. } => self.power(point) == Sign::Positive,
            Self::Cylinder { y_min, y_max, .. } => {
                point.y < y_min || point.y > y_max || self.power(point) == Sign::Positive
            }
        }
    }

    /// Proves, if it can, that a point lies inside, not on the surface.
    pub fn holds(&self, point: DVec3) -> bool {
        let is_between = match *self {
            Self::Sphere { .. } => true,
            Self::Cylinder { y_min, y_max, .. } => y_min < point.y && point.y < y_max,
        };
        is_between && self.power(point) == Sign::Negative
    }

    /// Returns on which side of the sphere or of the infinite wall a point lies: positive is outside.
    pub fn power(&self, point: DVec3) -> Sign {
        let exact = Ball64::exact;
        match *self {
            Self::Sphere { center, radius } => {
                Ball64::power_of_point(point.to_array().map(exact), center.to_array(), radius).sign()
            }
            Self::Cylinder { x, z, radius, .. } => {
                Ball64::power_of_point([exact(point.x), exact(point.z)], [x, z], radius).sign()
            }
        }
    }

    /// Proves, if it can, that all of `inner` lies inside, off the surface.
    ///
    /// In a sphere lies a sphere when the distance of the centres and its radius are together below the radius, and a
    /// cylinder when both its rims do at their farthest points. In a cylinder all lies that lies within its infinite wall
    /// and between its caps.
    pub fn contains(&self, inner: &Self) -> bool {
        if self.is_clear_of(inner) {
            return false;
        }
        let is_between = || {
            let [[bottom, top], [inner_bottom, inner_top]] = [self.heights(), inner.heights()];
            let is_less = |[a, b]: [f64; 2], [c, d]: [f64; 2]| compare_sum_zero([c, d, -a, -b]).is_gt();
            is_less(bottom, inner_bottom) && is_less(inner_top, top)
        };
        match (*self, *inner) {
            (Self::Sphere { center, radius }, Self::Sphere { center: inner_center, radius: inner_radius }) => {
                let reach = length_between(center, inner_center) + Ball64::exact(inner_radius);
                (Ball64::exact(radius) - reach).sign() == Sign::Positive
            }
            (Self::Sphere { center, radius }, Self::Cylinder { x, z, radius: inner_radius, y_min, y_max }) => {
                let across = length_between(DVec3::new(center.x, 0.0, center.z), DVec3::new(x, 0.0, z))
                    + Ball64::exact(inner_radius);
                [y_min, y_max].into_iter().all(|y| {
                    let rise = Ball64::exact(y) - Ball64::exact(center.y);
                    let free = Ball64::exact(radius).square() - across.square() - rise.square();
                    free.sign() == Sign::Positive
                })
            }
            (Self::Cylinder { .. }, _) => is_between() && self.contains_within_wall(inner),
        }
    }

    /// Proves, if it can, that all of `inner` lies strictly within the infinite wall of this cylinder.
    pub fn contains_within_wall(&self, inner: &Self) -> bool {
        let Self::Cylinder { x, z, radius, .. } = *self else { return false };
        let (center, inner_radius) = match *inner {
            Self::Sphere { center, radius } => (DVec3::new(center.x, 0.0, center.z), radius),
            Self::Cylinder { x, z, radius, .. } => (DVec3::new(x, 0.0, z), radius),
        };
        let reach = length_between(DVec3::new(x, 0.0, z), center) + Ball64::exact(inner_radius);
        (Ball64::exact(radius) - reach).sign() == Sign::Positive
    }

    /// Proves, if it can, that this has no rim, or that `other` does not come to it.
    pub fn keeps_rims_from(&self, other: &Self) -> bool {
        matches!(self, Self::Sphere { .. }) || self.contains_within_wall(other)
    }

    /// Proves, if it can, that the surfaces have no point in common, or are spheres that touch from outside.
    pub fn does_not_cut(&self, other: &Self) -> bool {
        self.is_clear_of(other)
            || are_apart(self, other)
            || self.contains(other)
            || other.contains(self)
            || touch_from_outside(self, other)
    }

    /// Returns the faces that rays from `origin`, a point outside, can meet from outside.
    ///
    /// A ray meets a cap from outside only from beyond the cap's plane. One that starts within the infinite wall or on it
    /// does not come back to the wall from outside once it has left it; and where it would meet the wall from inside, or
    /// at the rim, it has come down to the cap's plane within the cap, which it meets first: see `reaches` in
    /// `src/trace/intersect.rs` for the rim itself.
    pub fn faces_toward(&self, origin: DVec3) -> Faces {
        match *self {
            Self::Sphere { .. } => Faces::ALL,
            Self::Cylinder { y_min, y_max, .. } => Faces {
                wall: !matches!(self.power(origin), Sign::Negative | Sign::Zero),
                lower: origin.y < y_min,
                upper: origin.y > y_max,
            },
        }
    }

    /// Returns the faces that rays from the surface of `origin`, another solid, can meet from outside: by the reasons of
    /// [`Solid::faces_toward`].
    pub fn faces_toward_solid(&self, origin: &Self) -> Faces {
        match *self {
            Self::Sphere { .. } => Faces::ALL,
            Self::Cylinder { y_min, y_max, .. } => {
                let [[bottom, above_bottom], [top, above_top]] = origin.heights();
                Faces {
                    wall: !self.contains_within_wall(origin),
                    lower: compare_sum_zero([y_min, -bottom, -above_bottom]).is_gt(),
                    upper: compare_sum_zero([top, above_top, -y_max]).is_gt(),
                }
            }
        }
    }
}

/// Returns the distance of two points.
fn length_between(a: DVec3, b: DVec3) -> Ball64 {
    (Vector::<Ball64>::exact(a) - Vector::exact(b)).length_squared().sqrt()
}

/// Tells whether two spheres lie outside of each other, though they may touch: |c − c'|² ≥ (r + r')², exactly.
fn touch_from_outside(one: &Solid, other: &Solid) -> bool {
    let (Solid::Sphere { center: a, radius: r }, Solid::Sphere { center: b, radius: s }) = (*one, *other) else {
        return false;
    };
    let mut sum = Expansion::new();
    let is_exact = sum.add_square(a.x, -b.x, 1.0)
        & sum.add_square(a.y, -b.y, 1.0)
        & sum.add_square(a.z, -b.z, 1.0)
        & sum.add_square(r, s, -1.0);
    is_exact && sum.compare_zero() != Ordering::Less
}
