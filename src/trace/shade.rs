//! The colour that a hit has by itself: ambient, diffuse and specular light.

use std::mem;

use glam::DVec3;

use crate::ir::{EquationId, Surface};
use crate::math::{Real, Vector};
use crate::plan::{Light, Object, Part, Scene};
use crate::trace::integrator::Integrator;
use crate::trace::judge::Doubt;
use crate::trace::look_up;
use crate::trace::ray::{Face, Hit, Leaving, Ray};

/// A hit with all that shading needs.
#[derive(Debug)]
pub struct HitPoint<'p, R> {
    /// World space, scaled as the scene is.
    pub point: Vector<R>,
    /// The unit normal on the side from which the surface is met.
    pub normal: Vector<R>,
    /// The direction of the ray that met it.
    pub incoming: Vector<R>,
    /// Whether it is met from inside.
    pub from_inside: bool,
    /// What is met.
    pub object: Object,
    /// The equation of the surface.
    pub equation: EquationId,
    /// How it answers light.
    pub surface: &'p Surface,
}

impl<'p, R: Real> HitPoint<'p, R> {
    /// Works out where `ray` meets what it hits.
    pub fn new(scene: &'p Scene<'_>, ray: &Ray<R>, hit: &Hit<R>) -> Self {
        let mut point = ray.origin + ray.dir.scale(hit.t);
        let zero = R::exact(0.0);
        let (outward, primitive) = match hit.face {
            Face::Sphere(i) => {
                let (i, spheres) = (i as usize, &scene.spheres);
                let center = Vector::exact(DVec3::new(spheres.x[i], spheres.y[i], spheres.z[i]));
                let radius = R::exact(spheres.radius[i]);
                let normal = (point - center).map(|coordinate| coordinate / radius);
                (normal, scene.sphere_primitives[i])
            }
            Face::Wall(i) => {
                let (i, cylinders) = (i as usize, &scene.cylinders);
                let radius = R::exact(cylinders.radius[i]);
                let x = (point.x - R::exact(cylinders.x[i])) / radius;
                let z = (point.z - R::exact(cylinders.z[i])) / radius;
                (Vector::new(x, zero, z), scene.cylinder_primitives[i])
            }
            Face::LowerCap(i) => {
                let i = i as usize;
                point.y = R::exact(scene.cylinders.y_min[i]);
                (Vector::exact(DVec3::NEG_Y), scene.cylinder_primitives[i])
            }
            Face::UpperCap(i) => {
                let i = i as usize;
                point.y = R::exact(scene.cylinders.y_max[i]);
                (Vector::exact(DVec3::Y), scene.cylinder_primitives[i])
            }
        };
        let normal = if hit.from_inside { outward.map(|coordinate| -coordinate) } else { outward };
        let surface = scene.surface(primitive);
        Self {
            point,
            normal,
            incoming: ray.dir,
            from_inside: hit.from_inside,
            object: hit.face.object(),
            equation: hit.face.equation(scene),
            surface,
        }
    }
}

impl<R: Real> Integrator<'_, '_, R> {
    /// Returns the colour of a hit without its reflection, not clamped.
    ///
    /// # Errors
    /// [`Doubt`] when it cannot be decided whether a light is lit.
    pub(super) fn shade(&mut self, at: &HitPoint<'_, R>) -> Result<Vector<R>, Doubt> {
        let ambient = match self.plan.settings.part {
            Part::A => DVec3::ZERO,
            Part::B => at.surface.ambient,
        };
        if !answers_light(at.surface, self.plan.settings.part) {
            return Ok(Vector::exact(ambient));
        }
        // Lights first: those that outshine the rest and cancel each other leave it as it is.
        let mut lit = Vector::exact(DVec3::ZERO);
        let plan = self.plan;
        if plan.settings.part == Part::B {
            self.judge.counts.lightings += plan.scene.lights.len() as u64;
        }
        let lights = plan.lights(at.object).iter().map(|&light| light as usize);
        for light_idx in lights.filter(|&light_idx| plan.adds(at.surface, light_idx)) {
            let light = &plan.scene.lights[light_idx];
            let to_light = Vector::exact(light.position) - at.point;
            if self.judge.is_positive(at.normal.dot(to_light))? && !self.is_shadowed(at, light_idx, to_light)? {
                lit = lit + lit_by(at, light, to_light, plan.settings.part);
            }
        }
        Ok(Vector::exact(ambient) + lit)
    }

    /// Tells whether a surface is met on the way to a light.
    fn is_shadowed(&mut self, at: &HitPoint<'_, R>, light_idx: usize, to_light: Vector<R>) -> Result<bool, Doubt> {
        if self.plan.settings.part == Part::A {
            return Ok(false);
        }
        let leaving = Leaving { equation: at.equation, inward: at.from_inside };
        let light = self.plan.scene.lights[light_idx].position;
        let ray = Ray { origin: at.point, dir: to_light, aim: None, leaving: Some(leaving), light: Some(light) };
        let mut found = mem::take(&mut self.found);
        let listed = self.plan.occluders(at.object, light_idx);
        let among = look_up::before_light(self.plan, light_idx, &ray, &mut found, listed);
        let answer = among.and_then(|among| {
            self.judge.counts.shadow_rays += u64::from(!among.is_empty());
            self.judge.counts.shadow_tests += among.len() as u64;
            self.occluded(&ray, light, among)
        });
        self.found = found;
        answer
    }
}

/// Tells whether a surface has a term that lights contribute to.
fn answers_light(surface: &Surface, part: Part) -> bool {
    surface.diffuse != DVec3::ZERO || (part == Part::B && surface.specular != DVec3::ZERO)
}

/// Returns what a lit light contributes: Cl · (Cd · (n·L) + Cs · (n·H)^P).
fn lit_by<R: Real>(at: &HitPoint<'_, R>, light: &Light, to_light: Vector<R>, part: Part) -> Vector<R> {
    let distance = to_light.length_squared().sqrt();
    let n_dot_l = at.normal.dot(to_light) / distance;
    let surface = at.surface;
    let mut reflected = Vector::exact(surface.diffuse).scale(n_dot_l);
    if part == Part::B && surface.specular != DVec3::ZERO {
        let n_dot_h = n_dot_half(at, to_light, distance);
        reflected = reflected + Vector::exact(surface.specular).scale(n_dot_h.pow(surface.shininess));
    }
    Vector::exact(light.color).times(reflected)
}

/// Returns n·H, with H = (L + V) / |L + V|.
fn n_dot_half<R: Real>(at: &HitPoint<'_, R>, to_light: Vector<R>, distance: R) -> R {
    let speed = at.incoming.length_squared().sqrt();
    let half = to_light.map(|coordinate| coordinate / distance) - at.incoming.map(|coordinate| coordinate / speed);
    at.normal.dot(half) / half.length_squared().sqrt()
}
