//! The scene of one image, laid out in lanes and scaled so that no square overflows.

use glam::DVec3;

use crate::ir::{self, EquationId, SceneView};
use crate::plan::Part;

/// Spheres, coordinate by coordinate.
#[derive(Clone, Debug, Default)]
pub struct SphereLanes {
    /// Centres, x.
    pub x: Vec<f64>,
    /// Centres, y.
    pub y: Vec<f64>,
    /// Centres, z.
    pub z: Vec<f64>,
    /// Radii.
    pub radius: Vec<f64>,
}

/// Cylinders, coordinate by coordinate.
#[derive(Clone, Debug, Default)]
pub struct CylinderLanes {
    /// Axes, x.
    pub x: Vec<f64>,
    /// Axes, z.
    pub z: Vec<f64>,
    /// Radii.
    pub radius: Vec<f64>,
    /// Lower caps.
    pub y_min: Vec<f64>,
    /// Upper caps.
    pub y_max: Vec<f64>,
}

/// A light that shines.
#[derive(Clone, Copy, Debug)]
pub struct Light {
    /// Per channel; not all 0.
    pub color: DVec3,
    /// World space, scaled.
    pub position: DVec3,
}

/// What a face is apart from its shape.
#[derive(Clone, Copy, Debug)]
pub struct Primitive {
    /// Its surface.
    pub surface: ir::Handle<ir::Surface>,
    /// Its place in the order of declaration.
    pub order: u32,
}

/// The scene of one image.
///
/// All positions and radii are multiplied by one power of two, so that the largest object is between 1 and 2: that changes
/// no bit of the image as long as nothing underflows, and keeps squares in range from 2⁻³⁰⁰ to 2³⁰⁰ and beyond. What is
/// smaller than 2⁻²⁴⁰ of that, about 10⁻⁷², loses the products of four lengths that a shadow ray's discriminant is; a
/// light or the end of a cylinder may be 2⁴⁵⁰ away, about 10¹³⁵.
#[derive(Debug)]
pub struct Scene<'p> {
    /// The colour of a ray that meets nothing.
    pub background: DVec3,
    /// The lights whose colour is not black, in order.
    pub lights: Vec<Light>,
    /// All surfaces.
    pub surfaces: &'p [ir::Surface],
    /// The spheres.
    pub spheres: SphereLanes,
    /// What else is known of each sphere.
    pub sphere_primitives: Vec<Primitive>,
    /// The identity of each sphere.
    pub sphere_equations: &'p [EquationId],
    /// The cylinders.
    pub cylinders: CylinderLanes,
    /// What else is known of each cylinder.
    pub cylinder_primitives: Vec<Primitive>,
    /// The identity of each wall.
    pub wall_equations: &'p [EquationId],
    /// The identities of each lower and upper cap.
    pub cap_equations: &'p [[EquationId; 2]],
}

impl<'p> Scene<'p> {
    /// Lays out what `part` draws of `view`.
    pub fn new(view: SceneView<'p>, part: Part) -> Self {
        let cylinders = match part {
            Part::A => &[],
            Part::B => view.cylinders(),
        };
        let scale = scale_to_unit(&view, cylinders);
        let equations = view.equations();
        Self {
            background: view.background(),
            lights: shining(&view)
                .map(|light| Light { color: light.color, position: light.position * scale })
                .collect(),
            surfaces: view.surfaces(),
            spheres: lay_out_spheres(view.spheres(), scale),
            sphere_primitives: (view.spheres().iter())
                .map(|s| Primitive { surface: s.surface, order: s.order })
                .collect(),
            sphere_equations: &equations.spheres,
            cylinders: lay_out_cylinders(cylinders, scale),
            cylinder_primitives: cylinders.iter().map(|c| Primitive { surface: c.surface, order: c.order }).collect(),
            wall_equations: &equations.walls,
            cap_equations: &equations.caps,
        }
    }

    /// Returns the surface of a primitive.
    pub fn surface(&self, primitive: Primitive) -> &'p ir::Surface {
        &self.surfaces[primitive.surface.index()]
    }
}

/// Returns the lights that are not black.
fn shining<'p>(view: &SceneView<'p>) -> impl Iterator<Item = &'p ir::Light> + use<'p> {
    view.lights().iter().filter(|light| light.color != DVec3::ZERO)
}

fn lay_out_spheres(spheres: &[ir::Sphere], scale: f64) -> SphereLanes {
    let lane = |coordinate: fn(&ir::Sphere) -> f64| spheres.iter().map(|s| coordinate(s) * scale).collect();
    SphereLanes {
        x: lane(|s| s.center.x),
        y: lane(|s| s.center.y),
        z: lane(|s| s.center.z),
        radius: lane(|s| s.radius),
    }
}

fn lay_out_cylinders(cylinders: &[ir::Cylinder], scale: f64) -> CylinderLanes {
    let lane = |coordinate: fn(&ir::Cylinder) -> f64| cylinders.iter().map(|c| coordinate(c) * scale).collect();
    CylinderLanes {
        x: lane(|c| c.x),
        z: lane(|c| c.z),
        radius: lane(|c| c.radius),
        y_min: lane(|c| c.y_min),
        y_max: lane(|c| c.y_max),
    }
}

/// The largest exponent that a scaled length may have: its square times a few others stays below 2⁹⁹⁰.
const MAX_EXPONENT: i32 = 450;

/// Returns the power of two that brings the largest of the spheres' and the cylinders' sizes and places between 1 and 2.
///
/// How far a cylinder reaches up and down and where the lights are does not count, so that an endless pillar or a distant
/// sun does not make the rest vanish, as long as they do not overflow.
fn scale_to_unit(view: &SceneView<'_>, cylinders: &[ir::Cylinder]) -> f64 {
    let largest_of = |lengths: &[f64]| lengths.iter().fold(0.0, |largest: f64, length| largest.max(length.abs()));
    let spheres = view.spheres().iter().map(|s| s.center.abs().max_element().max(s.radius));
    let walls = cylinders.iter().map(|c| largest_of(&[c.x, c.z, c.radius]));
    let largest = spheres.chain(walls).fold(0.0, f64::max);

    let heights = cylinders.iter().map(|c| largest_of(&[c.y_min, c.y_max]));
    let lights = shining(view).map(|light| light.position.abs().max_element());
    let farthest = heights.chain(lights).fold(largest, f64::max);

    let exponent = |length: f64| libm::ilogb(length.max(f64::MIN_POSITIVE));
    let shift = (-exponent(largest)).min(MAX_EXPONENT - exponent(farthest));
    // 2^1022 is the largest power whose reciprocal is normal.
    libm::ldexp(1.0, shift.clamp(-1022, 1022))
}
