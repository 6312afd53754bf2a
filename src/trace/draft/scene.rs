//! The constants of one image in binary32: worked out in binary64, rounded once.

use std::sync::OnceLock;

use crate::ir;
use crate::plan::{Object, Part, Plan, Scene};
use crate::trace::draft::shadow::FaceLights;
use crate::trace::wide::FaceKind;

/// How far the cheap test for a silhouette may be off, as a share of |c|² + r²: some ten roundings of binary32.
const SILHOUETTE_SLACK: f64 = 1.0 / 1_048_576.0;

/// Lengths beyond these are left to binary64: products of four of them would leave binary32.
const MAX_LENGTH: f64 = 1_048_576.0;
const MIN_RADIUS: f64 = 1.0 / 1_073_741_824.0;

/// Coefficients beyond this are left to binary64.
const MAX_COEFFICIENT: f64 = 1_048_576.0;

/// A sphere with a radius above this share of its distance from the eye is met at p/(b + √D), which does not lose a near
/// hit in the differences of long lengths.
const LARGE: f64 = 0.5;

/// The smallest that (n·H)^P may become is 2 to this: below it numbers would be subnormal, which is slow and not seen.
const MIN_POWER_EXPONENT: f64 = -100.0;

/// A face: the whole of a sphere, or the wall or a cap of a cylinder.
#[derive(Debug)]
pub(super) struct Face {
    pub kind: FaceKind,
    pub object: Object,
    /// The centre, that of the axis, or that of the cap.
    pub center: [f32; 3],
    pub inv_radius: f32,
    pub surface: usize,
    /// What lights it, worked out when it is first met.
    pub lights: OnceLock<FaceLights>,
}

/// A sphere as rays see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sphere {
    pub center: [f32; 3],
    pub radius_squared: f32,
    /// p = |c|² − r², and somewhat less.
    pub power: f32,
    pub power_low: f32,
    pub is_large: bool,
    pub face: f32,
    pub equation: f32,
}

/// A cylinder as rays see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cylinder {
    pub x: f32,
    pub z: f32,
    pub radius_squared: f32,
    pub y_min: f32,
    pub y_max: f32,
    /// Its wall; the caps follow.
    pub face: f32,
    pub equation: f32,
}

/// A surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    pub ambient: [f32; 3],
    pub has_specular: bool,
    pub power: Power,
    /// (n·H)² is raised to this first, so that no power is subnormal.
    pub min_squared: f32,
    /// 0 when nothing is reflected.
    pub reflectance: f32,
    /// Whether a hit's own colour is the same in all channels.
    pub is_grey: bool,
}

/// How (n·H)^P is computed from (n·H)².
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Power {
    /// Whole P: twice `half`, or one more.
    Whole { half: u32, is_odd: bool },
    /// P/2 of another P, by `libm`.
    Other(f32),
}

/// The constants of one image.
#[derive(Debug)]
pub(super) struct DraftScene {
    /// Three for each object in the order of declaration, so that of two the one declared first has the smaller number.
    pub faces: Vec<Face>,
    pub spheres: Vec<Sphere>,
    pub cylinders: Vec<Cylinder>,
    pub surfaces: Vec<Surface>,
}

impl DraftScene {
    /// Works out the constants; `None` for what binary32 cannot start from: an eye inside of an object or on it, lengths
    /// or coefficients out of range, mirrors with negative terms.
    pub fn new(plan: &Plan<'_>) -> Option<Self> {
        let scene = &plan.scene;
        if !is_moderate(scene) {
            return None;
        }
        let surfaces: Vec<_> = scene.surfaces.iter().map(|s| surface(s, scene, plan.settings.part)).collect();
        if scene.surfaces.iter().zip(&surfaces).any(|(s, draft)| draft.reflectance > 0.0 && has_negative(s, scene)) {
            return None;
        }
        let first_faces = first_faces(scene);
        let n_spheres = scene.spheres.radius.len();
        let n_cylinders = scene.cylinders.radius.len();
        let spheres = (0..n_spheres).map(|i| sphere(scene, i, first_faces[i])).collect::<Option<Vec<_>>>()?;
        let cylinders =
            (0..n_cylinders).map(|i| cylinder(scene, i, first_faces[n_spheres + i])).collect::<Option<Vec<_>>>()?;
        let mut objects: Vec<_> = (0..n_spheres as u32).map(Object::Sphere).collect();
        objects.extend((0..n_cylinders as u32).map(Object::Cylinder));
        let mut by_order: Vec<_> = first_faces.into_iter().zip(objects).collect();
        by_order.sort_unstable_by_key(|&(first, _)| first);
        let faces = by_order.into_iter().flat_map(|(_, object)| faces_of(scene, object)).collect();
        Some(Self { faces, spheres, cylinders, surfaces })
    }
}

/// Returns the number of each object's first face, spheres first.
fn first_faces(scene: &Scene<'_>) -> Vec<usize> {
    let orders: Vec<_> =
        scene.sphere_primitives.iter().chain(&scene.cylinder_primitives).map(|primitive| primitive.order).collect();
    let mut by_order: Vec<_> = (0..orders.len()).collect();
    by_order.sort_unstable_by_key(|&i| orders[i]);
    let mut first = vec![0; orders.len()];
    for (rank, i) in by_order.into_iter().enumerate() {
        first[i] = 3 * rank;
    }
    first
}

/// Tells whether all numbers lie where binary32 neither overflows nor underflows.
fn is_moderate(scene: &Scene<'_>) -> bool {
    let (s, c) = (&scene.spheres, &scene.cylinders);
    let lengths = [&s.x, &s.y, &s.z, &s.radius, &c.x, &c.z, &c.radius, &c.y_min, &c.y_max];
    let lights = scene.lights.iter().flat_map(|light| light.position.to_array());
    let colors = scene.lights.iter().flat_map(|light| light.color.to_array());
    let surfaces = scene.surfaces.iter().flat_map(|s| [s.ambient, s.diffuse, s.specular].map(|c| c.to_array()));
    lengths.into_iter().flatten().copied().chain(lights).all(|length| length.abs() <= MAX_LENGTH)
        && s.radius.iter().chain(&c.radius).all(|&radius| radius >= MIN_RADIUS)
        && colors.chain(surfaces.flatten()).all(|c| c.abs() <= MAX_COEFFICIENT)
        && scene.surfaces.iter().all(|s| s.reflectance <= MAX_COEFFICIENT && s.shininess <= MAX_COEFFICIENT)
}

/// Tells whether a surface has a negative term under some light.
fn has_negative(surface: &ir::Surface, scene: &Scene<'_>) -> bool {
    let is_negative = |color: glam::DVec3| color.min_element() < 0.0;
    is_negative(surface.ambient)
        || scene
            .lights
            .iter()
            .any(|l| is_negative(l.color * surface.diffuse) || is_negative(l.color * surface.specular))
}

/// Tells whether a surface has the same colour in all channels, whatever light falls on it.
fn is_grey(surface: &ir::Surface, scene: &Scene<'_>) -> bool {
    let is_grey = |color: glam::DVec3| color.x == color.y && color.y == color.z;
    is_grey(surface.ambient)
        && (scene.lights.iter())
            .all(|light| is_grey(light.color * surface.diffuse) && is_grey(light.color * surface.specular))
}

fn surface(surface: &ir::Surface, scene: &Scene<'_>, part: Part) -> Surface {
    let is_b = part == Part::B;
    let shininess = surface.shininess;
    let power = if shininess.fract() == 0.0 {
        Power::Whole { half: (shininess / 2.0) as u32, is_odd: shininess % 2.0 == 1.0 }
    } else {
        Power::Other((shininess / 2.0) as f32)
    };
    Surface {
        ambient: if is_b { single(surface.ambient.to_array()) } else { [0.0; 3] },
        has_specular: is_b && surface.specular != glam::DVec3::ZERO,
        power,
        min_squared: libm::exp2(2.0 * MIN_POWER_EXPONENT / shininess.max(2.0)) as f32,
        reflectance: if is_b { surface.reflectance.max(0.0) as f32 } else { 0.0 },
        is_grey: is_grey(surface, scene),
    }
}

/// Rounds.
pub(super) fn single(numbers: [f64; 3]) -> [f32; 3] {
    numbers.map(|number| number as f32)
}

fn sphere(scene: &Scene<'_>, i: usize, face: usize) -> Option<Sphere> {
    let s = &scene.spheres;
    let (center, radius) = ([s.x[i], s.y[i], s.z[i]], s.radius[i]);
    let distance_squared = center.iter().map(|c| c * c).sum::<f64>();
    let power = distance_squared - radius * radius;
    let squares = distance_squared + radius * radius;
    (power > 1e-12 * squares).then(|| Sphere {
        center: single(center),
        radius_squared: (radius * radius) as f32,
        power: power as f32,
        power_low: (power - SILHOUETTE_SLACK * squares) as f32,
        is_large: radius * radius > LARGE * LARGE * distance_squared,
        face: face as f32,
        equation: scene.sphere_equations[i].number() as f32,
    })
}

fn cylinder(scene: &Scene<'_>, i: usize, face: usize) -> Option<Cylinder> {
    let c = &scene.cylinders;
    let (x, z, radius, y_min, y_max) = (c.x[i], c.z[i], c.radius[i], c.y_min[i], c.y_max[i]);
    let (power, squares) = (x * x + z * z - radius * radius, x * x + z * z + radius * radius);
    let is_outside = power > 1e-12 * squares || y_min > 0.0 || y_max < 0.0;
    is_outside.then(|| Cylinder {
        x: x as f32,
        z: z as f32,
        radius_squared: (radius * radius) as f32,
        y_min: y_min as f32,
        y_max: y_max as f32,
        face: face as f32,
        equation: scene.wall_equations[i].number() as f32,
    })
}

fn faces_of(scene: &Scene<'_>, object: Object) -> [Face; 3] {
    let face = |kind, center, radius: f64, surface| Face {
        kind,
        object,
        center: single(center),
        inv_radius: (1.0 / radius) as f32,
        surface,
        lights: OnceLock::new(),
    };
    match object {
        Object::Sphere(i) => {
            let (i, s) = (i as usize, &scene.spheres);
            let surface = scene.sphere_primitives[i].surface.index();
            let center = [s.x[i], s.y[i], s.z[i]];
            [FaceKind::Sphere; 3].map(|kind| face(kind, center, s.radius[i], surface))
        }
        Object::Cylinder(i) => {
            let (i, c) = (i as usize, &scene.cylinders);
            let surface = scene.cylinder_primitives[i].surface.index();
            let kinds = [(FaceKind::Wall, 0.0), (FaceKind::LowerCap, c.y_min[i]), (FaceKind::UpperCap, c.y_max[i])];
            kinds.map(|(kind, y)| face(kind, [c.x[i], y, c.z[i]], c.radius[i], surface))
        }
    }
}
