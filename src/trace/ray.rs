//! Rays and what they meet.

use glam::DVec3;

use crate::ir::EquationId;
use crate::math::{Real, Vector};
use crate::plan::{Object, Scene};
use crate::trace::reject::PlainRay;
use crate::trace::touch::Aim;

/// A half-line: the points origin + t·dir with t > 0.
#[derive(Clone, Copy, Debug)]
pub struct Ray<R> {
    /// World space, scaled as the scene is.
    pub origin: Vector<R>,
    /// Need not be of unit length; `t` counts multiples of it.
    pub dir: Vector<R>,
    /// The direction of an eye ray, up to a factor: exactly.
    pub aim: Option<Aim>,
    /// The surface on which a secondary ray starts.
    pub leaving: Option<Leaving>,
    /// Where the light is to which a shadow ray leads, at t = 1: exactly.
    pub light: Option<DVec3>,
}

/// The surface that a ray leaves, and to which side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leaving {
    /// The surface, and every coincident copy of it.
    pub equation: EquationId,
    /// Whether the ray starts into the inside of a sphere or wall.
    pub inward: bool,
}

impl<R: Real> Ray<R> {
    /// Returns the ray in plain binary64.
    pub fn plain(&self) -> PlainRay {
        let largest_error = |v: Vector<R>| v.x.error().max(v.y.error()).max(v.z.error());
        let middle = |v: Vector<R>| v.to_array().map(R::value);
        // The middle of a double-double is rounded once more to binary64.
        let rounding = |v: Vector<R>| {
            let largest = middle(v).into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
            if R::IS_FINE { largest * f64::EPSILON } else { 0.0 }
        };
        let y_rounding = if R::IS_FINE { self.origin.y.value().abs() * f64::EPSILON } else { 0.0 };
        PlainRay {
            origin: middle(self.origin),
            dir: middle(self.dir),
            origin_error: largest_error(self.origin) + rounding(self.origin),
            origin_y_error: self.origin.y.error() + y_rounding,
            dir_error: largest_error(self.dir) + rounding(self.dir),
        }
    }
}

/// Which face of which primitive, by its index in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// A sphere.
    Sphere(u32),
    /// The wall of a cylinder.
    Wall(u32),
    /// The lower cap of a cylinder.
    LowerCap(u32),
    /// The upper cap of a cylinder.
    UpperCap(u32),
}

impl Face {
    /// Returns the equation of its surface.
    pub fn equation(self, scene: &Scene<'_>) -> EquationId {
        match self {
            Self::Sphere(i) => scene.sphere_equations[i as usize],
            Self::Wall(i) => scene.wall_equations[i as usize],
            Self::LowerCap(i) => scene.cap_equations[i as usize][0],
            Self::UpperCap(i) => scene.cap_equations[i as usize][1],
        }
    }

    /// Returns the object that the face belongs to.
    pub fn object(self) -> Object {
        match self {
            Self::Sphere(i) => Object::Sphere(i),
            Self::Wall(i) | Self::LowerCap(i) | Self::UpperCap(i) => Object::Cylinder(i),
        }
    }
}

/// The nearest point of a ray on a surface.
#[derive(Clone, Copy, Debug)]
pub struct Hit<R> {
    /// Above 0, in multiples of the ray's direction.
    pub t: R,
    /// What is met.
    pub face: Face,
    /// Whether it is met from inside: the outward normal points along the ray.
    pub from_inside: bool,
}
