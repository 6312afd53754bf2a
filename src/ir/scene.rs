//! What a scene is made of. World units; linear colour, 0…1 by custom, not by rule.

use glam::DVec3;

use crate::ir::Handle;

/// A point light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Cl, per channel.
    pub color: DVec3,
    /// World space.
    pub position: DVec3,
}

/// How a primitive answers light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Ca, per channel: added as it is.
    pub ambient: DVec3,
    /// Cd, per channel: times n·L.
    pub diffuse: DVec3,
    /// Cs, per channel: times (n·H)^shininess.
    pub specular: DVec3,
    /// P, the exponent of the specular term; at least 0 in a valid program.
    pub shininess: f64,
    /// Krefl, the weight of the reflected ray; followed when above 0.
    pub reflectance: f64,
}

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// World space.
    pub center: DVec3,
    /// Above 0 in a valid program.
    pub radius: f64,
    /// Its surface.
    pub surface: Handle<Surface>,
    /// Its place among all primitives in the order of declaration, from 0; decides between hits at equal t.
    pub order: u32,
}

/// A closed vertical cylinder: a wall and two caps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Above 0 in a valid program.
    pub radius: f64,
    /// The axis, parallel to y.
    pub x: f64,
    /// The axis, parallel to y.
    pub z: f64,
    /// The lower cap; below `y_max` in a valid program.
    pub y_min: f64,
    /// The upper cap.
    pub y_max: f64,
    /// Its surface.
    pub surface: Handle<Surface>,
    /// Its place among all primitives in the order of declaration, from 0; decides between hits at equal t.
    pub order: u32,
}
