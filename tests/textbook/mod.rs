//! The tracer of a textbook: plain binary64, the quadratic formula, and a fixed epsilon to keep a ray off its own surface.
//!
//! It is written to be believed, not to be beaten: it follows the semantics in everything but the arithmetic. Directions
//! are unit vectors, so that epsilon is a length. It is what `scenes/stress` is hard for; nothing of clisc depends on it.
//!
//! # Source
//! E. Haines, "Essential Ray Tracing Algorithms", in A. Glassner (ed.), "An Introduction to Ray Tracing" (1989), chapter 2:
//! sphere, quadric, plane. P. Shirley, "Ray Tracing in One Weekend" (2016): the epsilon.

use clisc::ir::{Cylinder, SceneView, Sphere, Surface};
use clisc::plan::Size;
use glam::DVec3;

/// Added before rounding down, as the semantics have it.
const QUANTISATION_BIAS: f64 = 1.0 / 1_048_576.0;

/// The last level that is shaded, as the semantics have it.
const MAX_LEVEL: u32 = 8;

/// A tracer with its epsilon.
#[derive(Clone, Copy)]
pub struct Textbook {
    /// No hit is nearer to the origin of its ray than this, in world units.
    pub epsilon: f64,
}

#[derive(Clone, Copy)]
struct Ray {
    origin: DVec3,
    /// A unit vector.
    dir: DVec3,
}

struct Hit<'s> {
    t: f64,
    /// A unit vector, turned against the ray.
    normal: DVec3,
    surface: &'s Surface,
}

impl Textbook {
    /// Renders a scene, row by row from the top.
    pub fn image(self, view: SceneView<'_>, size: Size) -> Vec<[u8; 3]> {
        let (width, height) = (size.width(), size.height());
        let k = libm::tan(view.fov_deg() * std::f64::consts::PI / 360.0);
        let pixels = (0..height).flat_map(|row| (0..width).map(move |column| (column, row)));
        let steps = |n: u32| f64::from(n);
        pixels
            .map(|(column, row)| {
                let x = (2.0 * steps(column) - steps(width)) * k / steps(height);
                let y = (steps(height) - 2.0 * steps(row)) * k / steps(height);
                let ray = Ray { origin: DVec3::ZERO, dir: DVec3::new(x, y, -1.0).normalize() };
                self.color(view, ray, 0).to_array().map(|channel| (255.0 * channel + QUANTISATION_BIAS) as u8)
            })
            .collect()
    }

    /// Returns the colour of a ray, clamped.
    fn color(self, view: SceneView<'_>, ray: Ray, level: u32) -> DVec3 {
        let color = match self.intersect(view, ray) {
            None => view.background(),
            Some(_) if level > MAX_LEVEL => DVec3::ZERO,
            Some(hit) => self.shade(view, ray, &hit, level),
        };
        color.clamp(DVec3::ZERO, DVec3::ONE)
    }

    fn shade(self, view: SceneView<'_>, ray: Ray, hit: &Hit<'_>, level: u32) -> DVec3 {
        let (point, surface) = (ray.origin + hit.t * ray.dir, hit.surface);
        let mut color = surface.ambient;
        for light in view.lights() {
            let to_light = light.position - point;
            let distance = to_light.length();
            let l = to_light / distance;
            let n_dot_l = hit.normal.dot(l);
            if n_dot_l > 0.0 && !self.occluded(view, Ray { origin: point, dir: l }, distance) {
                let n_dot_h = hit.normal.dot((l - ray.dir).normalize());
                let highlight = libm::pow(n_dot_h, surface.shininess);
                color += light.color * (surface.diffuse * n_dot_l + surface.specular * highlight);
            }
        }
        if surface.reflectance > 0.0 {
            let dir = ray.dir - 2.0 * hit.normal.dot(ray.dir) * hit.normal;
            color += surface.reflectance * self.color(view, Ray { origin: point, dir }, level + 1);
        }
        color
    }

    /// Finds the nearest hit; of equals the first declared.
    fn intersect<'s>(self, view: SceneView<'s>, ray: Ray) -> Option<Hit<'s>> {
        let mut nearest: Option<(Hit<'s>, u32)> = None;
        self.visit_hits(view, ray, |hit, order| {
            let is_nearer = nearest.as_ref().is_none_or(|(best, first)| (hit.t, order) < (best.t, *first));
            if is_nearer {
                nearest = Some((hit, order));
            }
            false
        });
        nearest.map(|(hit, _)| hit)
    }

    fn occluded(self, view: SceneView<'_>, ray: Ray, distance: f64) -> bool {
        self.visit_hits(view, ray, |hit, _| hit.t < distance)
    }

    /// Calls `visit` with the nearest hit on each object until it answers `true`, and tells whether it did.
    fn visit_hits<'s>(self, view: SceneView<'s>, ray: Ray, mut visit: impl FnMut(Hit<'s>, u32) -> bool) -> bool {
        let spheres = view.spheres().iter().filter_map(|sphere| {
            let (t, outward) = self.meet_sphere(sphere, ray)?;
            Some((t, outward, sphere.surface, sphere.order))
        });
        let cylinders = view.cylinders().iter().filter_map(|cylinder| {
            let (t, outward) = self.meet_cylinder(cylinder, ray)?;
            Some((t, outward, cylinder.surface, cylinder.order))
        });
        spheres.chain(cylinders).any(|(t, outward, surface, order)| {
            let normal = if outward.dot(ray.dir) > 0.0 { -outward } else { outward };
            visit(Hit { t, normal, surface: &view.surfaces()[surface.index()] }, order)
        })
    }

    fn meet_sphere(self, sphere: &Sphere, ray: Ray) -> Option<(f64, DVec3)> {
        let from_center = ray.origin - sphere.center;
        let b = 2.0 * from_center.dot(ray.dir);
        let c = from_center.length_squared() - sphere.radius * sphere.radius;
        let t = roots(1.0, b, c)?.into_iter().find(|t| *t > self.epsilon)?;
        Some((t, (ray.origin + t * ray.dir - sphere.center) / sphere.radius))
    }

    fn meet_cylinder(self, cylinder: &Cylinder, ray: Ray) -> Option<(f64, DVec3)> {
        let wall = self.meet_wall(cylinder, ray);
        let caps =
            [(cylinder.y_min, DVec3::NEG_Y), (cylinder.y_max, DVec3::Y)].into_iter().filter_map(|(y, outward)| {
                let t = (y - ray.origin.y) / ray.dir.y;
                let (x, z) = (ray.origin.x + t * ray.dir.x - cylinder.x, ray.origin.z + t * ray.dir.z - cylinder.z);
                (t > self.epsilon && x * x + z * z <= cylinder.radius * cylinder.radius).then_some((t, outward))
            });
        wall.into_iter().chain(caps).min_by(|a, b| a.0.total_cmp(&b.0))
    }

    fn meet_wall(self, cylinder: &Cylinder, ray: Ray) -> Option<(f64, DVec3)> {
        let (x, z) = (ray.origin.x - cylinder.x, ray.origin.z - cylinder.z);
        let a = ray.dir.x * ray.dir.x + ray.dir.z * ray.dir.z;
        let b = 2.0 * (x * ray.dir.x + z * ray.dir.z);
        let c = x * x + z * z - cylinder.radius * cylinder.radius;
        let t = roots(a, b, c)?.into_iter().find(|t| {
            let y = ray.origin.y + t * ray.dir.y;
            *t > self.epsilon && cylinder.y_min <= y && y <= cylinder.y_max
        })?;
        Some((t, DVec3::new(x + t * ray.dir.x, 0.0, z + t * ray.dir.z) / cylinder.radius))
    }
}

/// Solves at² + bt + c = 0; the roots come in rising order.
fn roots(a: f64, b: f64, c: f64) -> Option<[f64; 2]> {
    let discriminant = b * b - 4.0 * a * c;
    let spread = discriminant.sqrt();
    (discriminant >= 0.0).then(|| [(-b - spread) / (2.0 * a), (-b + spread) / (2.0 * a)])
}
