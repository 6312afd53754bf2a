//! The scene of one image, laid out in lanes and scaled so that no square overflows.

use std::borrow::Cow;

use glam::DVec3;
use rayon::prelude::*;

use crate::ir::{self, EquationId, SceneView};
use crate::plan::bodies::Solid;
use crate::plan::curve;
use crate::plan::{Object, Part};

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
    /// All surfaces, without the terms that they do not need.
    pub surfaces: Cow<'p, [ir::Surface]>,
    /// The spheres.
    pub spheres: SphereLanes,
    /// What else is known of each sphere.
    pub sphere_primitives: Vec<Primitive>,
    /// The identity of each sphere.
    pub sphere_equations: Cow<'p, [EquationId]>,
    /// The cylinders.
    pub cylinders: CylinderLanes,
    /// What else is known of each cylinder.
    pub cylinder_primitives: Vec<Primitive>,
    /// The identity of each wall.
    pub wall_equations: Cow<'p, [EquationId]>,
    /// The identities of each lower and upper cap.
    pub cap_equations: Cow<'p, [[EquationId; 2]]>,
}

impl<'p> Scene<'p> {
    /// Lays out what `part` draws of `view`.
    pub fn new(view: SceneView<'p>, part: Part) -> Self {
        let cylinders = cylinders_of(&view, part);
        Self::scaled(view, cylinders, scale_to_unit(&view, cylinders))
    }

    /// Lays out what `part` draws of `view` in the units of the program, in which squares may overflow.
    pub(super) fn unscaled(view: SceneView<'p>, part: Part) -> Self {
        Self::scaled(view, cylinders_of(&view, part), 1.0)
    }

    fn scaled(view: SceneView<'p>, cylinders: &'p [ir::Cylinder], scale: f64) -> Self {
        let equations = view.equations();
        Self {
            background: view.background(),
            lights: shining(&view)
                .map(|light| Light { color: light.color, position: light.position * scale })
                .collect(),
            surfaces: view.surfaces().into(),
            spheres: lay_out_spheres(view.spheres(), scale),
            sphere_primitives: (view.spheres().par_iter().with_min_len(SPHERES_PER_TASK))
                .map(|s| Primitive { surface: s.surface, order: s.order })
                .collect(),
            sphere_equations: equations.spheres[..view.spheres().len()].into(),
            cylinders: lay_out_cylinders(cylinders, scale),
            cylinder_primitives: cylinders.iter().map(|c| Primitive { surface: c.surface, order: c.order }).collect(),
            wall_equations: equations.walls[..cylinders.len()].into(),
            cap_equations: equations.caps[..cylinders.len()].into(),
        }
    }

    /// Leaves out the objects, counted spheres first, that are not to be kept. What is left keeps its order.
    pub(super) fn retain(&mut self, keep: impl Fn(usize) -> bool) {
        let n_spheres = self.sphere_primitives.len();
        let n_cylinders = self.cylinder_primitives.len();
        if (0..n_spheres + n_cylinders).all(&keep) {
            return;
        }
        let SphereLanes { x, y, z, radius } = &mut self.spheres;
        [x, y, z, radius].into_iter().for_each(|lane| retain_at(lane, &keep));
        retain_at(&mut self.sphere_primitives, &keep);
        retain_at(self.sphere_equations.to_mut(), &keep);

        let keep = |cylinder: usize| keep(n_spheres + cylinder);
        let CylinderLanes { x, z, radius, y_min, y_max } = &mut self.cylinders;
        [x, z, radius, y_min, y_max].into_iter().for_each(|lane| retain_at(lane, keep));
        retain_at(&mut self.cylinder_primitives, keep);
        retain_at(self.wall_equations.to_mut(), keep);
        retain_at(self.cap_equations.to_mut(), keep);
    }

    /// Sorts the spheres, and the cylinders, so that neighbours in the scene are neighbours in space, and so in memory.
    pub(super) fn sort_by_place(&mut self) {
        let SphereLanes { x, y, z, radius } = &mut self.spheres;
        let order = curve::order(x.len(), |i| [x[i], y[i], z[i]]);
        [x, y, z, radius].into_iter().for_each(|lane| permute(lane, &order));
        permute(&mut self.sphere_primitives, &order);
        permute(self.sphere_equations.to_mut(), &order);

        let CylinderLanes { x, z, radius, y_min, y_max } = &mut self.cylinders;
        let order = curve::order(x.len(), |i| [x[i], 0.5 * y_min[i] + 0.5 * y_max[i], z[i]]);
        [x, z, radius, y_min, y_max].into_iter().for_each(|lane| permute(lane, &order));
        permute(&mut self.cylinder_primitives, &order);
        permute(self.wall_equations.to_mut(), &order);
        permute(self.cap_equations.to_mut(), &order);
    }

    /// Returns the number of spheres and cylinders.
    #[must_use]
    pub fn n_objects(&self) -> usize {
        self.sphere_primitives.len() + self.cylinder_primitives.len()
    }

    /// Returns an object as a solid.
    pub(super) fn solid(&self, object: Object) -> Solid {
        match object {
            Object::Sphere(i) => {
                let (i, SphereLanes { x, y, z, radius }) = (i as usize, &self.spheres);
                Solid::Sphere { center: DVec3::new(x[i], y[i], z[i]), radius: radius[i] }
            }
            Object::Cylinder(i) => {
                let (i, CylinderLanes { x, z, radius, y_min, y_max }) = (i as usize, &self.cylinders);
                Solid::Cylinder { x: x[i], z: z[i], radius: radius[i], y_min: y_min[i], y_max: y_max[i] }
            }
        }
    }

    /// Returns every object, spheres first.
    pub(super) fn objects(&self) -> impl Iterator<Item = Object> + use<> {
        let spheres = (0..self.sphere_primitives.len() as u32).map(Object::Sphere);
        spheres.chain((0..self.cylinder_primitives.len() as u32).map(Object::Cylinder))
    }

    /// Returns every primitive, spheres first.
    pub(super) fn primitives(&self) -> impl Iterator<Item = &Primitive> {
        self.sphere_primitives.iter().chain(&self.cylinder_primitives)
    }

    /// Returns the surface of a primitive.
    pub fn surface(&self, primitive: Primitive) -> &ir::Surface {
        &self.surfaces[primitive.surface.index()]
    }
}

/// Puts elements in the order of their places.
fn permute<T: Copy + Send + Sync>(items: &mut Vec<T>, order: &[u32]) {
    *items = order.par_iter().with_min_len(4096).map(|&i| items[i as usize]).collect();
}

/// Keeps the elements at the places that `keep` names.
pub(super) fn retain_at<T>(items: &mut Vec<T>, keep: impl Fn(usize) -> bool) {
    let mut place = 0;
    items.retain(|_| {
        place += 1;
        keep(place - 1)
    });
}

/// Returns the cylinders that `part` draws.
fn cylinders_of<'p>(view: &SceneView<'p>, part: Part) -> &'p [ir::Cylinder] {
    match part {
        Part::A => &[],
        Part::B => view.cylinders(),
    }
}

/// Returns the lights that are not black.
fn shining<'p>(view: &SceneView<'p>) -> impl Iterator<Item = &'p ir::Light> + use<'p> {
    view.lights().iter().filter(|light| shines(light))
}

/// Tells whether a light is not black.
pub(super) fn shines(light: &ir::Light) -> bool {
    light.color != DVec3::ZERO
}

/// Spheres that a thread lays out at a time.
const SPHERES_PER_TASK: usize = 8192;

fn lay_out_spheres(spheres: &[ir::Sphere], scale: f64) -> SphereLanes {
    let lane = || vec![0.0; spheres.len()];
    let mut lanes = SphereLanes { x: lane(), y: lane(), z: lane(), radius: lane() };
    let SphereLanes { x, y, z, radius } = &mut lanes;
    let [x, y, z, radius] = [x, y, z, radius].map(|lane| lane.par_chunks_mut(SPHERES_PER_TASK));
    x.zip(y).zip(z.zip(radius)).enumerate().for_each(|(i, ((x, y), (z, radius)))| {
        for (k, sphere) in spheres[i * SPHERES_PER_TASK..][..x.len()].iter().enumerate() {
            [x[k], y[k], z[k]] = (sphere.center * scale).to_array();
            radius[k] = sphere.radius * scale;
        }
    });
    lanes
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
    let spheres = view.spheres().par_iter().with_min_len(SPHERES_PER_TASK);
    let spheres = spheres.map(|s| s.center.abs().max_element().max(s.radius)).reduce(|| 0.0, f64::max);
    let walls = cylinders.iter().map(|c| largest_of(&[c.x, c.z, c.radius]));
    let largest = walls.fold(spheres, f64::max);

    let heights = cylinders.iter().map(|c| largest_of(&[c.y_min, c.y_max]));
    let lights = shining(view).map(|light| light.position.abs().max_element());
    let farthest = heights.chain(lights).fold(largest, f64::max);

    let exponent = |length: f64| libm::ilogb(length.max(f64::MIN_POSITIVE));
    let shift = (-exponent(largest)).min(MAX_EXPONENT - exponent(farthest));
    // 2^1022 is the largest power whose reciprocal is normal.
    libm::ldexp(1.0, shift.clamp(-1022, 1022))
}

/// The smallest length, in units of the largest, with which all products of the tracer are good to their bounds: 2⁻⁴⁰⁰.
/// With it the smallest difference of two lengths is 2⁻⁴⁵³, and its square does not underflow.
const MIN_EXPONENT: i32 = -400;

/// Tells whether the lengths of what is drawn of a scene lie within the range of the tracer's numbers: scaled as for a
/// render, none but 0 is below 2⁻⁴⁰⁰. Outside of it pixels are still made, but bounds may not hold.
#[must_use]
pub fn is_within_range(view: &SceneView<'_>, part: Part) -> bool {
    let cylinders = cylinders_of(view, part);
    let scale = scale_to_unit(view, cylinders);
    let min = libm::ldexp(1.0, MIN_EXPONENT);
    let is_within = |length: f64| length == 0.0 || (length * scale).abs() >= min;
    let has_place = |place: DVec3| place.to_array().into_iter().all(is_within);
    let spheres = view.spheres().par_iter().with_min_len(SPHERES_PER_TASK);
    spheres.all(|s| has_place(s.center) && is_within(s.radius))
        && cylinders.iter().all(|c| [c.x, c.z, c.radius, c.y_min, c.y_max].into_iter().all(is_within))
        && shining(view).all(|light| has_place(light.position))
}

#[cfg(test)]
impl Scene<'_> {
    /// Makes a scene of nothing but shapes.
    pub(crate) fn of_shapes(spheres: SphereLanes, cylinders: CylinderLanes) -> Self {
        Self {
            background: DVec3::ZERO,
            lights: Vec::new(),
            surfaces: Cow::default(),
            spheres,
            sphere_primitives: Vec::new(),
            sphere_equations: Cow::default(),
            cylinders,
            cylinder_primitives: Vec::new(),
            wall_equations: Cow::default(),
            cap_equations: Cow::default(),
        }
    }
}
