//! The colour of a ray: what it meets, the lights there, and what is reflected.
//!
//! What a doubt leaves open need not matter: a light that may be in shadow or not adds a number between 0 and its full
//! share, and a reflected ray that cannot be followed has a colour from 0 to 1. Whether that reaches a byte of the pixel is
//! seen when the channels are rounded; only then are more bits asked for.

use std::cmp::Ordering;

use crate::exact::Part;
use crate::exact::attempt::{Attempt, Decided, Undecided, WORK_OF_LIGHT};
use crate::exact::intersect::{Hit, Ray};
use crate::exact::real::Real;
use crate::exact::scene::{Equation, Light, Surface};
use crate::exact::tie::Tie;
use crate::exact::vec3::{Vec3, add, divide, dot, forget, negate, scale, sub};

/// A hit with what its shading needs: its point, and the normal turned against the ray.
struct Meeting<'r> {
    ray: &'r Ray,
    /// The equations of the surfaces that it lies on.
    on: Vec<Equation>,
    p: Vec3,
    n: Vec3,
}

/// What a hit adds to the colour of its reflected ray, and how much of that it takes.
struct Bounce {
    local: Vec3,
    reflectance: Real,
}

/// What lies at the end of a ray.
enum End {
    /// A colour, and nothing more to follow.
    Color(Vec3),
    /// A mirror, and the reflected ray.
    Mirror(Bounce, Box<Ray>),
}

impl Attempt<'_> {
    /// Returns the colour of an eye ray, clamped.
    pub fn radiance(&self, eye_ray: Ray) -> Decided<Vec3> {
        let mut bounces = Vec::new();
        let mut ray = eye_ray;
        let last = loop {
            let level = bounces.len();
            match self.follow(&ray, level as u32) {
                Ok(End::Color(color)) => break color.map(|channel| channel.clamp01()),
                Ok(End::Mirror(bounce, reflected)) => {
                    bounces.push(bounce);
                    ray = *reflected;
                }
                Err(Undecided) if level == 0 => return Err(Undecided),
                Err(Undecided) => break [0.0; 3].map(|_: f64| self.number(1.0).or_zero()),
            }
        };
        Ok(bounces.iter().rev().fold(last, |color, bounce| {
            add(&bounce.local, &scale(&bounce.reflectance, &color)).map(|channel| channel.clamp01())
        }))
    }

    /// Follows one ray to what it meets.
    fn follow(&self, ray: &Ray, level: u32) -> Decided<End> {
        match self.intersect(ray)? {
            None => Ok(End::Color(self.scene.background.clone())),
            Some(_) if level > self.settings.max_level => Ok(End::Color(self.vec3([0.0; 3]))),
            Some(hit) => self.shade(ray, hit),
        }
    }

    fn shade(&self, ray: &Ray, hit: Hit) -> Decided<End> {
        let body = self.bodies[hit.body_idx];
        let surface = Surface::new(&self.surfaces[body.surface_idx()], self.scene.arithmetic.forgetful());
        let mut p = ray.at(&hit.t);
        let mut n = match hit.cap {
            Some(cap) => {
                p[1] = cap.y;
                self.vec3([0.0, cap.normal, 0.0])
            }
            None => {
                let quadric = body.quadric(self.scene.arithmetic);
                divide(&quadric.offset(&p), &quadric.radius)
            }
        };
        if hit.is_from_inside {
            n = negate(&n);
        }
        match self.settings.part {
            Part::A => self.shade_part_a(&surface, &p, &n).map(End::Color),
            Part::B => {
                let on = [&[hit.equation], &*hit.also].concat();
                self.shade_part_b(surface, &Meeting { ray, on, p, n })
            }
        }
    }

    /// Part A: c = Σ Cl · Cd · max(0, n·L).
    fn shade_part_a(&self, surface: &Surface, p: &Vec3, n: &Vec3) -> Decided<Vec3> {
        let mut color = self.vec3([0.0; 3]);
        for light in &self.scene.lights {
            self.check_work()?;
            let to_light = sub(&light.position, p);
            let square = dot(&to_light, &to_light);
            if self.sign(&square, Tie::AtLight)? == Ordering::Equal {
                continue;
            }
            let n_dot_l = (&dot(n, &to_light) / &square.sqrt()).max0();
            color = std::array::from_fn(|axis| {
                let term = &(&light.color[axis] * &surface.diffuse[axis]) * &n_dot_l;
                &color[axis] + &term
            });
        }
        Ok(color)
    }

    /// Part B: c = Ca + Σ Cl · (Cd · (n·L) + Cs · (n·H)^P) + Krefl · colour(reflected ray).
    fn shade_part_b(&self, surface: Surface, meeting: &Meeting<'_>) -> Decided<End> {
        let Meeting { ray, on, p, n } = meeting;
        let dir = forget(&ray.dir);
        let v = divide(&negate(&dir), &dot(&dir, &dir).sqrt());
        let mut color = surface.ambient.clone();
        for (light_idx, light) in self.scene.lights.iter().enumerate() {
            self.check_work()?;
            let share = match self.is_lit(meeting, light_idx) {
                Ok(false) => continue,
                Ok(true) => self.share_of_light(&surface, meeting, &v, light),
                Err(Undecided) => self.share_of_light(&surface, meeting, &v, light).map(|share| share.or_zero()),
            };
            color = add(&color, &share);
        }
        if surface.reflectance.sign() != Some(Ordering::Greater) {
            return Ok(End::Color(color));
        }
        let turned = scale(&dot(n, &ray.dir).double(), n);
        let reflected = Ray::new(p.clone(), sub(&ray.dir, &turned), on.clone());
        Ok(End::Mirror(Bounce { local: color, reflectance: surface.reflectance }, Box::new(reflected)))
    }

    /// Tells whether a light counts at a hit.
    fn is_lit(&self, meeting: &Meeting<'_>, light_idx: usize) -> Decided<bool> {
        let Meeting { on, p, n, .. } = meeting;
        let to_light = sub(&self.scene.lights[light_idx].position, p);
        let square = dot(&to_light, &to_light);
        if self.sign(&square, Tie::AtLight)? == Ordering::Equal {
            return Ok(false);
        }
        if self.sign(&dot(n, &to_light), Tie::Lit)? != Ordering::Greater {
            return Ok(false);
        }
        Ok(!self.is_occluded(&Ray::new(p.clone(), to_light, on.clone()), light_idx)?)
    }

    /// Returns Cl · (Cd · (n·L) + Cs · (n·H)^P).
    fn share_of_light(&self, surface: &Surface, meeting: &Meeting<'_>, v: &Vec3, light: &Light) -> Vec3 {
        self.spend(WORK_OF_LIGHT);
        // Nothing is decided by this.
        let [p, n, light_position] = [&meeting.p, &meeting.n, &light.position].map(forget);
        let to_light = sub(&light_position, &p);
        let distance = dot(&to_light, &to_light).sqrt();
        let n_dot_l = &dot(&n, &to_light) / &distance;
        let highlight = if surface.specular.iter().all(Real::is_zero) {
            self.number(0.0)
        } else {
            let l_plus_v = add(&divide(&to_light, &distance), v);
            let n_dot_h = &dot(&n, &l_plus_v) / &dot(&l_plus_v, &l_plus_v).sqrt();
            n_dot_h.pow(surface.shininess)
        };
        std::array::from_fn(|axis| {
            let diffuse = &surface.diffuse[axis] * &n_dot_l;
            let specular = &surface.specular[axis] * &highlight;
            &light.color[axis] * &(&diffuse + &specular)
        })
    }
}
