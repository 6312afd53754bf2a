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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::bodies::parts;
    use crate::testing::Stream;

    /// A point of whole numbers.
    fn place(stream: &mut Stream) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| stream.below(13) as f64 - 6.0))
    }

    /// A solid of whole numbers.
    fn solid(stream: &mut Stream) -> Solid {
        let (DVec3 { x, y, z }, radius) = (place(stream), 1.0 + stream.below(6) as f64);
        match stream.below(2) {
            0 => Solid::Sphere { center: DVec3::new(x, y, z), radius },
            _ => Solid::Cylinder { x, z, radius, y_min: y, y_max: y + 1.0 + stream.below(6) as f64 },
        }
    }

    /// A solid that a point belongs to.
    fn solid_at(stream: &mut Stream, point: DVec3) -> Solid {
        loop {
            let solid = solid(stream);
            if side(&solid, point).is_le() {
                return solid;
            }
        }
    }

    /// Tells on which side of the surface a point lies: `Less` inside. Nothing is rounded.
    fn side(solid: &Solid, point: DVec3) -> Ordering {
        match *solid {
            Solid::Sphere { center, radius } => (point - center).length_squared().total_cmp(&(radius * radius)),
            Solid::Cylinder { x, z, radius, y_min, y_max } => {
                let across = (point.x - x) * (point.x - x) + (point.z - z) * (point.z - z);
                across.total_cmp(&(radius * radius)).max(y_min.total_cmp(&point.y)).max(point.y.total_cmp(&y_max))
            }
        }
    }

    /// The centre and the radius of the smallest sphere around a solid.
    fn around(solid: &Solid) -> (DVec3, f64) {
        match *solid {
            Solid::Sphere { center, radius } => (center, radius),
            Solid::Cylinder { x, z, radius, y_min, y_max } => {
                (DVec3::new(x, 0.5 * (y_min + y_max), z), radius.hypot(0.5 * (y_max - y_min)))
            }
        }
    }

    /// How far `inner` stays off the surface, in its inside; below 0 when it does not. About.
    fn room(outer: &Solid, inner: &Solid) -> f64 {
        let ((center, _), [[a, b], [c, d]]) = (around(inner), inner.heights());
        let (bottom, top) = (a + b, c + d);
        let (Solid::Sphere { radius: inner_radius, .. } | Solid::Cylinder { radius: inner_radius, .. }) = *inner;
        match (*outer, inner) {
            (Solid::Sphere { center: middle, radius }, Solid::Sphere { .. }) => {
                radius - center.distance(middle) - inner_radius
            }
            (Solid::Sphere { center: middle, radius }, Solid::Cylinder { .. }) => {
                let across = (center.x - middle.x).hypot(center.z - middle.z) + inner_radius;
                radius - across.hypot((bottom - middle.y).abs().max((top - middle.y).abs()))
            }
            (Solid::Cylinder { x, z, radius, y_min, y_max }, _) => {
                let across = (center.x - x).hypot(center.z - z) + inner_radius;
                (radius - across).min(bottom - y_min).min(y_max - top)
            }
        }
    }

    #[test]
    fn points_lie_where_whole_numbers_say() {
        let mut stream = Stream::new(31);
        for _ in 0..20_000 {
            let (solid, point) = (solid(&mut stream), place(&mut stream));
            let side = side(&solid, point);
            assert_eq!((solid.holds(point), solid.excludes(point)), (side.is_lt(), side.is_gt()), "{solid:?} {point}");
        }
    }

    /// Whole numbers do not come near to touching: they touch, or do not by far.
    #[test]
    fn solids_contain_what_stays_off_their_surface() {
        let mut stream = Stream::new(32);
        let mut n_contained = 0;
        for _ in 0..50_000 {
            let (outer, inner) = (solid(&mut stream), solid(&mut stream));
            let expected = room(&outer, &inner) > 1e-9;
            assert_eq!(outer.contains(&inner), expected, "{outer:?} {inner:?}");
            n_contained += usize::from(expected);
        }
        assert!(n_contained > 200, "{n_contained}");
    }

    #[test]
    fn what_shares_a_point_is_not_apart_and_what_is_far_off_is() {
        let mut stream = Stream::new(33);
        for _ in 0..20_000 {
            let point = place(&mut stream);
            let (one, other) = (solid_at(&mut stream, point), solid_at(&mut stream, point));
            assert!(!one.is_clear_of(&other) && !are_apart(&one, &other), "{one:?} {other:?} share {point}");

            let (one, other) = (solid(&mut stream), solid(&mut stream));
            let ((a, r), (b, s)) = (around(&one), around(&other));
            let gap = a.distance(b) - r - s;
            assert!(gap.abs() < 1e-6 || one.is_clear_of(&other) == (gap > 0.0), "{one:?} {other:?}");
            assert!(gap < 0.1 || are_apart(&one, &other), "{one:?} {other:?}");
        }
    }

    /// The plane that plain numbers find between them is for its proof to refuse.
    #[test]
    fn what_overlaps_by_a_rounding_is_not_apart() {
        let mut stream = Stream::new(36);
        for _ in 0..20_000 {
            let mut any = |size: f64| DVec3::from_array([0; 3].map(|_| stream.between(-size, size)));
            // Coordinates are rounded by more than the spheres overlap.
            let place = any(1000.0);
            let (a, b) = (place + any(1.0), place + any(1.0));
            let distance = a.distance(b);
            let radius = distance * stream.unit();
            let rest = distance - radius + 8.0 * f64::EPSILON * distance;
            let [one, other] = [(a, radius), (b, rest)].map(|(center, radius)| Solid::Sphere { center, radius });
            assert!(!one.is_clear_of(&other) && !are_apart(&one, &other), "{one:?} {other:?}");
        }
    }

    #[test]
    fn what_lies_on_a_segment_does_not_part_its_ends() {
        let mut stream = Stream::new(34);
        for _ in 0..20_000 {
            let (start, between) = (place(&mut stream), place(&mut stream));
            if start == between {
                continue;
            }
            let (from, solid) = (solid_at(&mut stream, start), solid_at(&mut stream, between));
            let end = between + (between - start);
            // What only touches at its surface may be parted: a ball on the ground does not have the ground in its light.
            if side(&solid, between).is_lt() {
                assert!(!parts(&from, end, &solid), "{from:?} to {end}: {solid:?} holds {between}");
            }
        }
    }

    #[test]
    fn the_faces_toward_a_solid_are_those_toward_its_points() {
        let mut stream = Stream::new(35);
        for _ in 0..20_000 {
            let point = place(&mut stream);
            let (origin, solid) = (solid_at(&mut stream, point), solid(&mut stream));
            let (of_point, of_all) = (solid.faces_toward(point), solid.faces_toward_solid(&origin));
            assert_eq!(of_point.or(of_all), of_all, "{solid:?} from {point} of {origin:?}");
        }
    }
}
