//! What lights a face, and what hides each light from it.
//!
//! Segments are followed from the light, as in `trace::wide`: w leads from it to the point. Points lie outside of every
//! object, so a sphere that the light is outside of lies between when D > 0 and 0 < b < a, for b = m·w, a = |w|²,
//! D = b² − a·p; a light inside of an object is hidden from everything else. The receiver is left out by identity, so that
//! no epsilon is needed.

use crate::plan::{Object, Part, Plan, Scene};
use crate::trace::draft::meet::{dot, minus};
use crate::trace::draft::scene::{Face, single};
use crate::trace::kernels::{Mask, SingleLanes};
use crate::trace::wide::FaceKind;

/// How far the cheap form of D may be off, as a share of (|m|² + r²)·a: some ten roundings of binary32.
const SHADOW_SLACK: f64 = 1.0 / 1_048_576.0;

/// A sphere with a radius below this share of its distance from the light is tested by a cross product, if near at all.
const FAR: f64 = 1.0 / 8.0;

/// The lights that may shine on a face.
#[derive(Debug)]
pub(super) struct FaceLights {
    pub lights: Vec<FaceLight>,
    /// How many lights there are in the scene, if the face answers any and shadows matter.
    pub n_lightings: u32,
}

/// A light as a face sees it.
#[derive(Debug)]
pub(super) struct FaceLight {
    pub position: [f32; 3],
    /// Cl·Cd and Cl·Cs.
    pub diffuse: [f32; 3],
    pub specular: [f32; 3],
    spheres: Vec<SphereBetween>,
    cylinders: Vec<CylinderBetween>,
}

/// A sphere that may hide a light.
#[derive(Clone, Copy, Debug)]
struct SphereBetween {
    /// From the light to the centre.
    m: [f32; 3],
    /// p, less a slack if `is_far`.
    power: f32,
    center: [f32; 3],
    radius_squared: f32,
    is_far: bool,
}

/// A cylinder that may hide a light.
#[derive(Clone, Copy, Debug)]
struct CylinderBetween {
    m: [f32; 2],
    radius_squared: f32,
    y_min: f32,
    y_max: f32,
}

impl FaceLights {
    /// Collects what the plan has left.
    pub fn new(plan: &Plan<'_>, face: &Face) -> Self {
        let scene = &plan.scene;
        let surface = &scene.surfaces[face.surface];
        let is_b = plan.settings.part == Part::B;
        let lights = (plan.lights(face.object).iter())
            .filter(|&&light_idx| plan.adds(surface, light_idx as usize))
            .filter_map(|&light_idx| {
                let light = &scene.lights[light_idx as usize];
                let (spheres, cylinders) =
                    if is_b { between(plan, face, light_idx as usize)? } else { (Vec::new(), Vec::new()) };
                let specular = if is_b { surface.specular } else { glam::DVec3::ZERO };
                Some(FaceLight {
                    position: single(light.position.to_array()),
                    diffuse: single((light.color * surface.diffuse).to_array()),
                    specular: single((light.color * specular).to_array()),
                    spheres,
                    cylinders,
                })
            })
            .collect();
        let zero = glam::DVec3::ZERO;
        let answers = is_b && (surface.diffuse != zero || surface.specular != zero);
        Self { lights, n_lightings: if answers { scene.lights.len() as u32 } else { 0 } }
    }
}

/// Returns what may lie between a light and a face; `None` when the light is hidden everywhere.
///
/// What shares the equation of the face is left out, and so is the rest of its object, as in `trace::wide`.
fn between(plan: &Plan<'_>, face: &Face, light_idx: usize) -> Option<(Vec<SphereBetween>, Vec<CylinderBetween>)> {
    let scene = &plan.scene;
    let light = scene.lights[light_idx].position.to_array();
    let among = plan.occluders(face.object, light_idx);
    let (mut spheres, mut cylinders) = (Vec::new(), Vec::new());
    for i in among.spheres.iter().map(|&i| i as usize) {
        let is_same = matches!(face.object, Object::Sphere(own)
            if scene.sphere_equations[own as usize] == scene.sphere_equations[i]);
        if !is_same {
            spheres.push(sphere_between(scene, i, light)?);
        }
    }
    for i in among.cylinders.iter().map(|&i| i as usize) {
        let is_same = matches!(face.object, Object::Cylinder(own) if own as usize == i
            || face.kind == FaceKind::Wall && scene.wall_equations[own as usize] == scene.wall_equations[i]);
        if !is_same {
            cylinders.push(cylinder_between(scene, i, light)?);
        }
    }
    Some((spheres, cylinders))
}

/// Returns a sphere as a light sees it; `None` when it is around the light.
fn sphere_between(scene: &Scene<'_>, i: usize, light: [f64; 3]) -> Option<SphereBetween> {
    let s = &scene.spheres;
    let (center, radius) = ([s.x[i], s.y[i], s.z[i]], s.radius[i]);
    let m = [center[0] - light[0], center[1] - light[1], center[2] - light[2]];
    let distance_squared = m.iter().map(|m| m * m).sum::<f64>();
    let power = distance_squared - radius * radius;
    let is_far = radius * radius < FAR * FAR * distance_squared;
    let slack = if is_far { SHADOW_SLACK * (distance_squared + radius * radius) } else { 0.0 };
    (power >= 0.0).then(|| SphereBetween {
        m: single(m),
        power: (power - slack) as f32,
        center: single(center),
        radius_squared: (radius * radius) as f32,
        is_far,
    })
}

/// Returns a cylinder as a light sees it; `None` when it is around the light.
fn cylinder_between(scene: &Scene<'_>, i: usize, light: [f64; 3]) -> Option<CylinderBetween> {
    let c = &scene.cylinders;
    let (m, radius) = ([c.x[i] - light[0], c.z[i] - light[2]], c.radius[i]);
    let is_inside_wall = m[0] * m[0] + m[1] * m[1] < radius * radius;
    let is_around = is_inside_wall && c.y_min[i] < light[1] && light[1] < c.y_max[i];
    (!is_around).then(|| CylinderBetween {
        m: m.map(|m| m as f32),
        radius_squared: (radius * radius) as f32,
        y_min: c.y_min[i] as f32,
        y_max: c.y_max[i] as f32,
    })
}

impl FaceLight {
    /// Tells to which of the facing points the light comes, and how many objects were tested.
    ///
    /// `w`, `a`: from the light to the points, and the squared lengths.
    #[inline(always)]
    pub fn reaches<L: SingleLanes>(&self, w: [L; 3], a: L, point: [L; 3], facing: L::Mask) -> (L::Mask, u32) {
        let zero = L::same(0.0);
        let mut open = facing;
        let mut n_tested = 0;
        for sphere in &self.spheres {
            n_tested += 1;
            let b = w[0] * L::same(sphere.m[0]) + w[1] * L::same(sphere.m[1]) + w[2] * L::same(sphere.m[2]);
            let mut blocked = open & (b * b).gt(a * L::same(sphere.power)) & b.gt(zero) & b.lt(a);
            if blocked.any() {
                if sphere.is_far {
                    blocked = blocked & crosses_far(sphere, w, a, point);
                }
                open = open & !blocked;
                if !open.any() {
                    return (open, n_tested);
                }
            }
        }
        for cylinder in &self.cylinders {
            n_tested += 1;
            open = open & !self.is_behind(cylinder, w, point[1], open);
            if !open.any() {
                break;
            }
        }
        (open, n_tested)
    }

    /// Tells which of the open segments meet a cylinder.
    #[inline(always)]
    fn is_behind<L: SingleLanes>(&self, cylinder: &CylinderBetween, w: [L; 3], height: L, open: L::Mask) -> L::Mask {
        let (zero, one) = (L::same(0.0), L::same(1.0));
        let (mx, mz) = (L::same(cylinder.m[0]), L::same(cylinder.m[1]));
        // An upright segment has some width, so that nothing is divided by 0.
        let a = w[0] * w[0] + w[2] * w[2] + L::same(1e-20);
        let cross = mx * w[2] - mz * w[0];
        let discriminant = a * L::same(cylinder.radius_squared) - cross * cross;
        let near = open & discriminant.gt(zero);
        if !near.any() {
            return near;
        }
        let b = mx * w[0] + mz * w[2];
        let (root, inv_a) = (discriminant.max(zero).sqrt(), one / a);
        let enter = ((b - root) * inv_a).max(zero);
        let leave = (b + root) * inv_a;
        let light_height = L::same(self.position[1]);
        let first = light_height + enter * w[1];
        let last = L::select(leave.lt(one), light_height + leave * w[1], height);
        let (low, high) = (first.min(last), first.max(last));
        near & enter.lt(one) & leave.gt(zero) & low.lt(L::same(cylinder.y_max)) & high.gt(L::same(cylinder.y_min))
    }
}

/// Tells which lines meet a sphere far from the light: |m × w|² = |(c − P) × w|² < a·r², whose left side is small where it
/// matters.
#[inline(always)]
fn crosses_far<L: SingleLanes>(sphere: &SphereBetween, w: [L; 3], a: L, point: [L; 3]) -> L::Mask {
    let q = minus(point, sphere.center);
    let cross = [q[1] * w[2] - q[2] * w[1], q[2] * w[0] - q[0] * w[2], q[0] * w[1] - q[1] * w[0]];
    dot(cross, cross).lt(a * L::same(sphere.radius_squared))
}
