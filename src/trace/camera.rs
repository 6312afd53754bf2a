//! Eye rays.

use crate::math::{Long, Real, Vector};
use crate::trace::ray::Ray;
use crate::trace::touch::{Aim, HalfTangent};

/// The eye at the origin, looking along −z.
#[derive(Clone, Copy, Debug)]
pub struct Camera<R> {
    /// The share of the view's half height that one step of a sample's place makes, at z = −1.
    step: R,
    steps_per_half_height: u32,
    half_tangent: HalfTangent,
}

impl<R: Real> Camera<R> {
    /// Makes the camera of a vertical field of view in degrees for places counted so that half the image's height has
    /// `steps_per_half_height` steps.
    pub fn new(fov_deg: f64, steps_per_half_height: u32) -> Self {
        Self {
            step: R::tan_half_degrees(fov_deg) / R::exact(f64::from(steps_per_half_height)),
            steps_per_half_height,
            half_tangent: HalfTangent::of_fov(fov_deg),
        }
    }

    /// Returns the share of the view's half height that one step of a sample's place makes, at z = −1.
    pub fn step(&self) -> R {
        self.step
    }

    /// Returns the ray through a place `(x, y)`, counted in steps from the middle of the image, right and up.
    pub fn eye_ray(&self, x: i64, y: i64) -> Ray<R> {
        // At most 65535 · 2 · 256 steps: exact.
        let along = |steps: i64| R::exact(steps as f64) * self.step;
        let zero = R::exact(0.0);
        Ray {
            origin: Vector::new(zero, zero, zero),
            dir: Vector::new(along(x), along(y), R::exact(-1.0)),
            aim: Some(Aim::new(x, y, self.steps_per_half_height, self.half_tangent)),
            leaving: None,
            light: None,
        }
    }
}

impl<const N: usize> Camera<Long<N>> {
    /// Returns the camera whose rays are known to so many bits.
    pub fn shortened(&self, bits: u32) -> Self {
        Self { step: self.step.shortened(bits), ..*self }
    }
}
