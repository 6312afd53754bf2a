//! Where rays meet surfaces: closest hits, shadows, and the roots of the equations.

use std::cmp::Ordering;

use clisc::plan::Part;

use super::ball::Ball;
use super::reach::ApproxRay;
use super::run::{Decided, Run};
use super::scene::{Cap, Equation, Primitive, Quadric};
use super::tie::Tie;
use super::vec3::{Vec3, add, scale};

/// A ray o + t · d, and the surface it starts on.
pub struct Ray {
    pub origin: Vec3,
    pub dir: Vec3,
    leaves: Option<Equation>,
    approx: Option<ApproxRay>,
}

impl Ray {
    /// Makes a ray; `leaves` is the surface on which its origin lies.
    pub fn new(origin: Vec3, dir: Vec3, leaves: Option<Equation>) -> Self {
        let approx = ApproxRay::new(&origin, &dir);
        Self { origin, dir, leaves, approx }
    }

    /// Returns the point at `t`.
    pub fn at(&self, t: &Ball) -> Vec3 {
        add(&self.origin, &scale(t, &self.dir))
    }
}

/// Where a ray meets a primitive.
pub struct Hit<'s> {
    pub t: Ball,
    pub primitive: &'s Primitive,
    /// The cap that is met; `None` is the sphere or the wall.
    pub cap: Option<&'s Cap>,
    pub equation: Equation,
    /// Which of the roots of its equation `t` is: hits of one equation compare by this alone.
    root: u8,
}

/// A root t > 0 and its place among the two, rising.
type Root = (u8, Ball);

/// a t² + 2 b t + c = 0, the equation of a ray and a quadric.
struct Quadratic {
    a: Ball,
    b: Ball,
    c: Ball,
    /// t = 0 is a root, because the ray leaves this surface.
    starts_on: bool,
    /// t = 1 is a root, because the light at the ray's end lies on this surface.
    ends_on: bool,
}

impl Quadratic {
    fn discriminant(&self) -> Ball {
        &(&self.b * &self.b) - &(&self.a * &self.c)
    }
}

impl<'s> Run<'s> {
    /// Returns the closest hit of a ray; of equal ones that of the primitive declared first.
    pub fn intersect(&self, ray: &Ray) -> Decided<Option<Hit<'s>>> {
        let mut closest: Option<Hit> = None;
        for primitive in &self.scene.primitives {
            let t_max = closest.as_ref().map_or(f64::INFINITY, |hit| hit.t.to_f64());
            if self.is_left_out(ray, primitive, t_max) {
                continue;
            }
            for hit in self.hits(ray, primitive, None)? {
                let is_closer = match &closest {
                    None => true,
                    Some(best) => self.compare(&hit, best)? == Ordering::Less,
                };
                if is_closer {
                    closest = Some(hit);
                }
            }
        }
        Ok(closest)
    }

    /// Tells whether any surface is met on the way from a hit (t = 0) to a light (t = 1).
    pub fn is_occluded(&self, to_light: &Ray, light_idx: usize) -> Decided<bool> {
        let one = self.ball(1.0);
        for primitive in &self.scene.primitives {
            if self.is_left_out(to_light, primitive, 1.0) {
                continue;
            }
            for hit in self.hits(to_light, primitive, Some(light_idx))? {
                if self.sign(&(&hit.t - &one), Tie::Light)? == Ordering::Less {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// Compares two hits of one ray by t.
    fn compare(&self, a: &Hit, b: &Hit) -> Decided<Ordering> {
        if a.equation == b.equation {
            return Ok(a.root.cmp(&b.root));
        }
        let tie = if std::ptr::eq(a.primitive, b.primitive) { Tie::OwnRim } else { Tie::Order };
        self.sign(&(&a.t - &b.t), tie)
    }

    /// Tells whether a primitive is not there, or surely not met.
    fn is_left_out(&self, ray: &Ray, primitive: &Primitive, t_max: f64) -> bool {
        let is_cylinder = !primitive.caps.is_empty();
        let approx = ray.approx.as_ref().filter(|_| !self.tests_all);
        (is_cylinder && self.settings.part == Part::A)
            || approx.is_some_and(|approx| primitive.reach.is_surely_missed(approx, t_max))
    }

    /// Returns the hits of a ray with one primitive, t > 0: of the quadric the closest, of caps all.
    ///
    /// `light_idx`: the light that the ray ends in at t = 1, if it does. A surface that holds the light has a root there,
    /// which is left out by algebra.
    fn hits(&self, ray: &Ray, primitive: &'s Primitive, light_idx: Option<usize>) -> Decided<Vec<Hit<'s>>> {
        let mut hits = Vec::new();
        for (root, t) in self.quadric_roots(ray, primitive, light_idx)? {
            if self.is_between_caps(ray, primitive, root, &t)? {
                hits.push(Hit { t, primitive, cap: None, equation: primitive.quadric.equation, root });
                break;
            }
        }
        for cap in &primitive.caps {
            let equation = Equation::Cap(cap.y_exact);
            let ends_on = light_idx.is_some_and(|light_idx| self.scene.lights[light_idx].y_exact == cap.y_exact);
            if ends_on || ray.leaves == Some(equation) {
                continue;
            }
            let t = self.plane_root(&(&cap.y - &ray.origin[1]), &ray.dir[1])?;
            if let Some(t) = t
                && self.is_within_rim(ray, &primitive.quadric, cap, &t)?
            {
                hits.push(Hit { t, primitive, cap: Some(cap), equation, root: 0 });
            }
        }
        Ok(hits)
    }

    /// Tells whether a meeting with the quadric is one with the primitive: always, but for what caps cut off.
    fn is_between_caps(&self, ray: &Ray, primitive: &Primitive, root: u8, t: &Ball) -> Decided<bool> {
        let y = &ray.origin[1] + &(t * &ray.dir[1]);
        for cap in &primitive.caps {
            let is_within = match self.sign(&cap.inward(&(&y - &cap.y)), Tie::Rim)? {
                Ordering::Less => false,
                // At its far root a ray leaves the infinite wall; it must not come down to the cap just there.
                Ordering::Equal => root == 0 || !self.comes_down(ray, cap)?,
                Ordering::Greater => true,
            };
            if !is_within {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Tells whether a meeting with a cap's plane is one with the cap.
    fn is_within_rim(&self, ray: &Ray, wall: &Quadric, cap: &Cap, t: &Ball) -> Decided<bool> {
        let p = ray.at(t);
        Ok(match self.sign(&wall.at(&p), Tie::Rim)? {
            Ordering::Less => true,
            // The same rule as for the wall, and the same rays.
            Ordering::Equal => {
                let outward = wall.dot(&wall.offset(&p), &ray.dir);
                self.sign(&outward, Tie::Tangent)? != Ordering::Greater || !self.comes_down(ray, cap)?
            }
            Ordering::Greater => false,
        })
    }

    /// Tells whether a ray passes a cap's plane into the cylinder.
    fn comes_down(&self, ray: &Ray, cap: &Cap) -> Decided<bool> {
        Ok(self.sign(&cap.inward(&ray.dir[1]), Tie::Parallel)? == Ordering::Greater)
    }

    /// Returns the t > 0 with t · `d_y` = `height`.
    fn plane_root(&self, height: &Ball, d_y: &Ball) -> Decided<Option<Ball>> {
        let direction = self.sign(d_y, Tie::Parallel)?;
        if direction == Ordering::Equal || self.sign(height, Tie::Start)? != direction {
            return Ok(None);
        }
        Ok(Some(height / d_y))
    }

    /// Returns where a ray meets a primitive's quadric.
    fn quadric_roots(&self, ray: &Ray, primitive: &Primitive, light_idx: Option<usize>) -> Decided<Vec<Root>> {
        let quadric = &primitive.quadric;
        let ends_on = match light_idx {
            Some(light_idx) => self.decide(primitive.light_sides[light_idx], Tie::Light)? == Ordering::Equal,
            None => false,
        };
        self.roots(&Quadratic {
            a: quadric.dot(&ray.dir, &ray.dir),
            b: quadric.dot(&quadric.offset(&ray.origin), &ray.dir),
            c: quadric.at(&ray.origin),
            starts_on: ray.leaves == Some(quadric.equation),
            ends_on,
        })
    }

    /// Returns the roots t > 0.
    fn roots(&self, quadratic: &Quadratic) -> Decided<Vec<Root>> {
        let Quadratic { a, b, c, starts_on, ends_on } = quadratic;
        if self.sign(a, Tie::Parallel)? == Ordering::Equal {
            return Ok(Vec::new());
        }
        let side = if *starts_on { Ordering::Equal } else { self.sign(c, Tie::Start)? };
        match (side, *ends_on) {
            // The roots are 0 and 1.
            (Ordering::Equal, true) => Ok(Vec::new()),
            // The roots are 0 and −2b/a.
            (Ordering::Equal, false) => {
                let is_positive = self.sign(b, Tie::Start)? == Ordering::Less;
                Ok(if is_positive { vec![(1, &-&b.double() / a)] } else { Vec::new() })
            }
            // The roots are 1 and c/a.
            (Ordering::Less, true) => Ok(Vec::new()),
            (Ordering::Greater, true) => Ok(vec![(0, c / a)]),
            // One root on either side of 0.
            (Ordering::Less, false) => {
                let s = quadratic.discriminant().sqrt();
                Ok(vec![(1, &(&s - b) / a)])
            }
            // Both roots on one side of 0, if there are any.
            (Ordering::Greater, false) => {
                if self.sign(b, Tie::Start)? != Ordering::Less {
                    return Ok(Vec::new());
                }
                let discriminant = quadratic.discriminant();
                match self.sign(&discriminant, Tie::Tangent)? {
                    Ordering::Less => Ok(Vec::new()),
                    Ordering::Equal => Ok(vec![(0, &-b / a)]),
                    Ordering::Greater => {
                        let s = discriminant.sqrt();
                        Ok(vec![(0, &(&-b - &s) / a), (1, &(&s - b) / a)])
                    }
                }
            }
        }
    }
}
