//! How high a light stands above the horizon of a point of a sphere.
//!
//! With U from the centre of a sphere of radius r to a light, the height of the light at the unit normal n is n·U − r. It
//! tells all about the light's share: |U|² − r² − 2r times the height is the squared distance. Where nothing stands before a
//! cap of the sphere around U (see [`open_height`]), it tells even that the light is seen.
//!
//! # Errors
//! Lengths are those of U; ε bounds the error of directions, that of n is below ε/2, and ε is never below 400u (see `flock`).
//! The height is off by 2ε. The cosine n·L is off, as `shade` says, by ε/2·(1 + 2r/h), where h is the least distance of the
//! light, and by 16u(1 + 1/h²) for roundings.

use crate::trace::kernels::Lanes;
use crate::trace::wide::bounds::{Bounds, Face, Occluder, Side};
use crate::trace::wide::flock::along;
use crate::trace::wide::shadow::LightOccluders;

/// A light is farther from a sphere than this share of its distance from the centre.
const MIN_DISTANCE: f64 = 1.0 / 64.0;

/// What sines and cosines of cones are widened by, relative to 1: some hundred thousand roundings.
const CONE_SLACK: f64 = 1e-11;

/// How often the height above which nothing stands before a light is halved.
const N_HALVINGS: u32 = 30;

/// A light as a sphere of a cluster sees it; lengths are those of U.
#[derive(Clone, Copy, Debug)]
pub(super) struct BallLight {
    pub light_idx: usize,
    /// U.
    toward: [f64; 3],
    /// −r.
    minus_radius: f64,
    /// |U|² − r² and −2r.
    squared: f64,
    minus_twice: f64,
    /// Above this height nothing stands before it.
    pub open: f64,
    pub diffuse: f64,
}

impl BallLight {
    /// Works out what a light is to a sphere that is met from outside; `None` when it is inside or too near.
    pub fn new(face: &Face, light_idx: usize, bounds: &Bounds, occluders: &LightOccluders) -> Option<Self> {
        let light = &bounds.lights[light_idx];
        let way: [f64; 3] = std::array::from_fn(|k| light.position[k] - face.center[k]);
        let length = (way[0] * way[0] + way[1] * way[1] + way[2] * way[2]).sqrt();
        let radius = face.radius / length;
        // False also of what is no number.
        let is_far = 1.0 - radius > MIN_DISTANCE;
        if !is_far {
            return None;
        }
        let toward = way.map(|c| c / length);
        let [spheres, cylinders] = occluders.of_light(light_idx);
        let open = if cylinders.is_empty() {
            let others = spheres.iter().map(|&i| &light.spheres[i as usize]);
            others.map(|other| open_height(toward, length, radius, other)).fold(0.0, f64::max)
        } else {
            f64::INFINITY
        };
        Some(Self {
            light_idx,
            toward,
            minus_radius: -radius,
            squared: 1.0 - radius * radius,
            minus_twice: -2.0 * radius,
            open,
            diffuse: bounds.terms[face.surface].lights[light_idx].diffuse[0],
        })
    }

    /// Returns what ε is multiplied with to bound the error of the light's share.
    pub fn error(&self) -> f64 {
        let per_least = 1.0 / (1.0 + self.minus_radius);
        let of_normal = 0.5 * (1.0 - 2.0 * self.minus_radius * per_least);
        1.1 * self.diffuse * (of_normal + 0.04 * (1.0 + per_least * per_least))
    }

    /// Returns how high the light stands.
    #[inline(always)]
    pub fn height<L: Lanes>(&self, normal: [L; 3]) -> L {
        along(normal, self.toward, L::splat(self.minus_radius))
    }

    /// Returns the cosine between the normal and the way to the light, given its height.
    #[inline(always)]
    pub fn cosine<L: Lanes>(&self, height: L) -> L {
        height / height.mul_add(L::splat(self.minus_twice), L::splat(self.squared)).sqrt()
    }
}

/// Returns a height of a light above which another sphere does not stand before it; infinite if none is known.
///
/// `toward`, `radius`: the direction from the centre to the light, and the radius, in the length of that way.
///
/// A point at height h is seen from the light at an angle β from the centre, cos β = (1 − r² − r·h)/w, where
/// w² = 1 − r² − 2r·h is its squared distance: the higher, the smaller are both. The other is seen within an angle α of its
/// own centre, sin α = R/m. So it stands before no point above the height at which β + α is less than the angle between the
/// centres, or at which w is less than m − R.
fn open_height(toward: [f64; 3], length: f64, radius: f64, other: &Occluder) -> f64 {
    if other.side != Side::Outside {
        return f64::INFINITY;
    }
    let [x, y, z] = other.m;
    let distance = (x * x + y * y + z * z).sqrt();
    let between = -(x * toward[0] + y * toward[1] + z * toward[2]) / distance;
    let sine = (other.radius_squared.sqrt() / distance) * (1.0 + CONE_SLACK) + CONE_SLACK;
    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
    let nearest = distance * (1.0 - sine) / length;
    let is_free = |height: f64| {
        let squared = 1.0 - radius * radius - 2.0 * radius * height;
        let far = squared.sqrt();
        let of_point = (1.0 - radius * radius - radius * height) / far - CONE_SLACK;
        let across = (1.0 - of_point * of_point).max(0.0).sqrt();
        let is_aside = sine < 1.0 && of_point > 0.0 && of_point * cosine - across * sine > between + CONE_SLACK;
        is_aside || far * (1.0 + CONE_SLACK) < nearest
    };
    let (mut low, mut high) = (0.0, 1.0 - radius);
    if is_free(low) {
        return low;
    }
    if !is_free(high) {
        return f64::INFINITY;
    }
    for _ in 0..N_HALVINGS {
        let middle = 0.5 * (low + high);
        (low, high) = if is_free(middle) { (low, middle) } else { (middle, high) };
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Stream;

    /// A ball touches the way from a light to a point of a sphere, from inside by a rounding: the point is not above the
    /// height at which the ball stands before no other.
    #[test]
    fn what_a_way_to_a_light_grazes_is_not_above_the_open_height() {
        let mut stream = Stream::new(71);
        let (mut n_tested, mut n_known) = (0, 0);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        for _ in 0..200_000 {
            let mut vector = |size: f64| [0; 3].map(|_| size * stream.between(-1.0, 1.0));
            let (light, aside) = (vector(4.0), vector(1.0));
            let length = dot(light, light).sqrt();
            let toward = light.map(|c| c / length);
            // A unit sphere around 0, and a point of it that faces the light.
            let mut normal: [f64; 3] = std::array::from_fn(|k| toward[k] + aside[k]);
            let size = dot(normal, normal).sqrt();
            normal = normal.map(|c| c / size);
            let height = dot(normal, toward) - 1.0 / length;
            let way: [f64; 3] = std::array::from_fn(|k| normal[k] - light[k]);
            let share = stream.unit();
            let reach = libm::exp2(stream.between(-6.0, 2.0));
            let off = [0; 3].map(|_| reach * stream.between(-1.0, 1.0));
            let along = dot(off, way) / dot(way, way);
            let across: [f64; 3] = std::array::from_fn(|k| off[k] - along * way[k]);
            let m: [f64; 3] = std::array::from_fn(|k| share * way[k] + across[k]);
            let radius_squared = dot(across, across) * (1.0 + 1e-9);
            if height < 0.0 || length < 1.1 || dot(m, m) < 1.01 * radius_squared {
                continue;
            }
            let other = Occluder {
                m,
                m_length: dot(m, m).sqrt(),
                power: dot(m, m) - radius_squared,
                slack: 0.0,
                radius_squared,
                y_min: 0.0,
                y_max: 0.0,
                side: Side::Outside,
                equation: f64::NAN,
            };
            let open = open_height(toward, length, 1.0 / length, &other);
            assert!(open >= height - 1e-12, "{open} {height} {light:?} {other:?}");
            n_tested += 1;
            n_known += usize::from(open.is_finite());
        }
        assert!(n_tested > 20_000 && n_known > 1000, "{n_tested} {n_known}");
    }
}
