//! Cones: what a light sees of a solid, bounded cheaply.
//!
//! # Why it is safe
//! With the light outside of a sphere around the solid, all of the solid lies in the cone with its apex in the light that
//! touches the sphere, and between two distances from the light. So does every segment from a point of the solid to the
//! light, but for the nearer distance. Two cones have no common ray when the angle between their axes is more than both half angles together;
//! what begins beyond the farther distance lies on no such segment.
//!
//! The way to the centre is off by a rounding of each coordinate, so that sines, cosines and distances, all at most 1 or
//! relative, are off by a few roundings, and a cosine, whose square is above 10⁻³, by some hundred: far less than [`SLACK`].

use glam::DVec3;

use crate::plan::bodies::{SMALLEST_SQUARE, Solid};

/// What comparisons are widened by.
const SLACK: f64 = 1e-9;

/// Wider cones, and lights inside, are left alone.
const MAX_SINE: f64 = 0.999;

/// What a light sees of a solid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    /// The way to its middle, of unit length.
    axis: DVec3,
    /// Of half its angle.
    sine: f64,
    cosine: f64,
    /// No point of the solid is nearer, and none is farther.
    near: f64,
    far: f64,
}

impl Cone {
    /// All that the light sees.
    const ALL: Self = Self { axis: DVec3::ZERO, sine: 0.0, cosine: 0.0, near: 0.0, far: f64::INFINITY };

    /// Bounds a solid.
    pub fn new(solid: &Solid, light: DVec3) -> Self {
        let (center, radius) = solid.sphere_around();
        let way = center - light;
        let squared = way.length_squared();
        let distance = squared.sqrt();
        let sine = radius / distance;
        // Also of what is no number nothing is said.
        if !(sine <= MAX_SINE && squared >= SMALLEST_SQUARE && squared.is_finite()) {
            return Self::ALL;
        }
        Self {
            axis: way / distance,
            sine,
            cosine: (1.0 - sine * sine).sqrt(),
            near: (distance - radius) * (1.0 - SLACK) - SLACK * radius,
            far: (distance + radius) * (1.0 + SLACK),
        }
    }

    /// Proves, if it can, that no point of the other solid lies on a segment from a point of this one to the light.
    #[inline]
    pub fn parts(&self, other: &Self) -> bool {
        let together = self.cosine * other.cosine - self.sine * other.sine;
        other.near > self.far || self.axis.dot(other.axis) < together - SLACK
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DoubleDouble;
    use crate::testing::Stream;

    /// A segment to the light from a point of one sphere touches another from inside by a rounding: they are not parted.
    #[test]
    fn what_a_segment_grazes_is_not_parted() {
        let mut stream = Stream::new(51);
        let (mut n_tested, mut n_parted) = (0, 0);
        for _ in 0..200_000 {
            let mut vector = |size: f64| DVec3::from([0; 3].map(|_| size * stream.between(-1.0, 1.0)));
            let (light, start, aside) = (vector(1.0), vector(1.0), vector(1.0));
            let [size, reach] = [0; 2].map(|_| libm::exp2(stream.between(-30.0, 0.0)));
            let share = stream.between(0.01, 1.5);
            let center = light + (start - light) * share + aside * size;
            // The distance of the centre from the line, exactly: (m × d)² / d².
            let d: [_; 3] = std::array::from_fn(|k| DoubleDouble::sum(start[k], -light[k]));
            let m: [_; 3] = std::array::from_fn(|k| DoubleDouble::sum(center[k], -light[k]));
            let cross: [_; 3] =
                std::array::from_fn(|k| m[(k + 1) % 3] * d[(k + 2) % 3] - m[(k + 2) % 3] * d[(k + 1) % 3]);
            let squared = |a: [DoubleDouble; 3]| a[0].square() + a[1].square() + a[2].square();
            let radius = (squared(cross) / squared(d)).sqrt().hi().next_up();
            let along = ((m[0] * d[0] + m[1] * d[1] + m[2] * d[2]) / squared(d)).hi();
            // The segment starts on the far side of the first sphere.
            let way = (start - light) / (start - light).length();
            let first = Solid::Sphere { center: start - way * (reach * 0.999_999), radius: reach };
            let second = Solid::Sphere { center, radius };
            let is_parted = Cone::new(&first, light).parts(&Cone::new(&second, light));
            if along > 0.0 && along < 1.0 && radius > 1e-9 * size {
                n_tested += 1;
                assert!(!is_parted, "{light} {first:?} {second:?}");
            }
            n_parted += usize::from(is_parted);
        }
        assert!(n_tested > 50_000 && n_parted > 1000, "{n_tested} {n_parted}");
    }

    #[test]
    fn most_of_what_is_apart_is_parted() {
        let sphere = |x: f64, y: f64, z: f64, radius: f64| Solid::Sphere { center: DVec3::new(x, y, z), radius };
        let light = DVec3::new(0.0, 10.0, 0.0);
        let parts = |a: &Solid, b: &Solid| Cone::new(a, light).parts(&Cone::new(b, light));
        let (under, over) = (sphere(0.0, 0.0, 0.0, 1.0), sphere(0.5, 3.0, 0.0, 1.0));
        assert!(!parts(&under, &over) && parts(&over, &under), "what is nearer hides what is farther");
        assert!(parts(&under, &sphere(3.0, 2.0, 0.0, 1.0)), "aside");
        assert!(!parts(&under, &sphere(0.0, 9.5, 0.0, 1.0)), "the light is inside");
        let pillar = Solid::Cylinder { x: 4.0, z: 0.0, radius: 0.5, y_min: 0.0, y_max: 1.0 };
        assert!(parts(&under, &pillar) && parts(&pillar, &under));
    }
}
