//! Where rays meet surfaces: closest hits, shadows, and the roots of the equations.

use std::cmp::Ordering;

use crate::exact::attempt::{Attempt, Decided, WORK_OF_TEST};
use crate::exact::reach::{ApproxRay, approximate_bound};
use crate::exact::real::Real;
use crate::exact::scene::{Body, Cap, Equation, Quadric};
use crate::exact::tie::Tie;
use crate::exact::vec3::{Vec3, add, scale};

/// A ray o + t · d, and the surfaces it starts on.
#[derive(Debug)]
pub struct Ray {
    pub origin: Vec3,
    pub dir: Vec3,
    leaves: Vec<Equation>,
    approx: Option<ApproxRay>,
}

impl Ray {
    /// Makes a ray; `leaves` are the surfaces on which its origin lies.
    pub fn new(origin: Vec3, dir: Vec3, leaves: Vec<Equation>) -> Self {
        let approx = ApproxRay::new(&origin, &dir);
        Self { origin, dir, leaves, approx }
    }

    /// Returns the point at `t`.
    pub fn at(&self, t: &Real) -> Vec3 {
        add(&self.origin, &scale(t, &self.dir))
    }
}

/// Where a ray meets a body.
#[derive(Debug)]
pub struct Hit {
    pub t: Real,
    pub body_idx: usize,
    /// The cap that is met; `None` is the sphere or the wall.
    pub cap: Option<Cap>,
    pub equation: Equation,
    /// The equations of other surfaces that are met at the same t: the point lies on them too.
    pub also: Vec<Equation>,
    /// Whether the outward normal points along the ray. That needs no comparison of its own: along a ray a quadric falls to
    /// its near root and rises from its far one, and a cap's plane is passed upward or downward.
    pub is_from_inside: bool,
    /// Which of the roots of its equation `t` is: hits of one equation compare by this alone.
    root: u8,
}

/// A root t > 0 and its place among the two, rising; of two that are one, the first.
type Root = (u8, Real);

/// a t² + 2 b t + c = 0, the equation of a ray and a quadric.
struct Quadratic {
    a: Real,
    b: Real,
    c: Real,
    /// t = 0 is a root, because the ray leaves this surface.
    starts_on: bool,
    /// t = 1 is a root, because the light at the ray's end lies on this surface.
    ends_on: bool,
}

impl Quadratic {
    fn discriminant(&self) -> Real {
        &(&self.b * &self.b) - &(&self.a * &self.c)
    }
}

impl Attempt<'_> {
    /// Returns the closest hit of a ray; of equal ones that of the body declared first.
    pub fn intersect(&self, ray: &Ray) -> Decided<Option<Hit>> {
        let mut closest: Option<Hit> = None;
        let mut t_max = f64::INFINITY;
        for (body_idx, &body) in self.bodies.iter().enumerate() {
            self.check_work()?;
            if self.is_left_out(ray, body, t_max) {
                continue;
            }
            for hit in self.hits(ray, body_idx, None)? {
                if let Some(best) = &mut closest {
                    match self.compare(&hit, best)? {
                        Ordering::Greater => continue,
                        Ordering::Equal => {
                            best.also.push(hit.equation);
                            continue;
                        }
                        Ordering::Less => {}
                    }
                }
                t_max = approximate_bound(&hit.t);
                closest = Some(hit);
            }
        }
        Ok(closest)
    }

    /// Tells whether any surface is met on the way from a hit (t = 0) to a light (t = 1).
    pub fn is_occluded(&self, to_light: &Ray, light_idx: usize) -> Decided<bool> {
        let one = self.number(1.0);
        for (body_idx, &body) in self.bodies.iter().enumerate() {
            self.check_work()?;
            if self.is_left_out(to_light, body, 1.0) {
                continue;
            }
            for hit in self.hits(to_light, body_idx, Some(light_idx))? {
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
        let tie = if a.body_idx == b.body_idx { Tie::OwnRim } else { Tie::Order };
        self.sign(&(&a.t - &b.t), tie)
    }

    /// Tells whether a body is surely not met before `t_max`.
    fn is_left_out(&self, ray: &Ray, body: Body<'_>, t_max: f64) -> bool {
        self.spend_once(1);
        let approx = ray.approx.as_ref().filter(|_| !self.tests_all);
        approx.is_some_and(|approx| body.reach().is_surely_missed(approx, t_max))
    }

    /// Returns the hits of a ray with one body, t > 0: of the quadric the closest, of caps all.
    ///
    /// `light_idx`: the light that the ray ends in at t = 1, if it does. A surface that holds the light has a root there,
    /// which is left out by algebra.
    fn hits(&self, ray: &Ray, body_idx: usize, light_idx: Option<usize>) -> Decided<Vec<Hit>> {
        self.spend(WORK_OF_TEST);
        let body = self.bodies[body_idx];
        let quadric = body.quadric(self.scene.arithmetic);
        let mut hits = Vec::new();
        for (root, t) in self.quadric_roots(ray, body, &quadric, light_idx)? {
            if self.is_between_caps(ray, body, root, &t)? {
                let (equation, is_from_inside) = (quadric.equation, root == 1);
                hits.push(Hit { t, body_idx, cap: None, equation, also: Vec::new(), is_from_inside, root });
                break;
            }
        }
        for cap in body.caps(self.scene.arithmetic) {
            let equation = Equation::Cap(cap.y_exact);
            let light_y = light_idx.map(|light_idx| self.scene.lights[light_idx].position_exact[1]);
            if light_y == Some(cap.y_exact) || ray.leaves.contains(&equation) {
                continue;
            }
            let t = self.plane_root(&(&cap.y - &ray.origin[1]), &ray.dir[1])?;
            if let Some(t) = t
                && self.is_within_rim(ray, &quadric, &cap, &t)?
            {
                let is_from_inside = !self.comes_down(ray, &cap)?;
                hits.push(Hit { t, body_idx, cap: Some(cap), equation, also: Vec::new(), is_from_inside, root: 0 });
            }
        }
        Ok(hits)
    }

    /// Tells whether a meeting with the quadric is one with the body: always, but for what caps cut off.
    fn is_between_caps(&self, ray: &Ray, body: Body<'_>, root: u8, t: &Real) -> Decided<bool> {
        for cap in body.caps(self.scene.arithmetic) {
            let y = &ray.origin[1] + &(t * &ray.dir[1]);
            let is_within = match self.sign(&cap.inward(&(&y - &cap.y)), Tie::Rim)? {
                Ordering::Less => false,
                // At its far root a ray leaves the infinite wall; it must not come down to the cap just there.
                Ordering::Equal => root == 0 || !self.comes_down(ray, &cap)?,
                Ordering::Greater => true,
            };
            if !is_within {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Tells whether a meeting with a cap's plane is one with the cap.
    fn is_within_rim(&self, ray: &Ray, wall: &Quadric, cap: &Cap, t: &Real) -> Decided<bool> {
        let p = ray.at(t);
        Ok(match self.sign(&wall.at(&p), Tie::Rim)? {
            Ordering::Less => true,
            // The same rule as for the wall, and the same rays.
            Ordering::Equal => {
                let outward = wall.dot(&wall.offset(&p), &ray.dir);
                self.sign(&outward, Tie::Rim)? != Ordering::Greater || !self.comes_down(ray, cap)?
            }
            Ordering::Greater => false,
        })
    }

    /// Tells whether a ray passes a cap's plane into the cylinder.
    fn comes_down(&self, ray: &Ray, cap: &Cap) -> Decided<bool> {
        Ok(self.sign(&cap.inward(&ray.dir[1]), Tie::Parallel)? == Ordering::Greater)
    }

    /// Returns the t > 0 with t · `d_y` = `height`.
    fn plane_root(&self, height: &Real, d_y: &Real) -> Decided<Option<Real>> {
        let direction = self.sign(d_y, Tie::Parallel)?;
        if direction == Ordering::Equal || self.sign(height, Tie::Start)? != direction {
            return Ok(None);
        }
        Ok(Some(height / d_y))
    }

    /// Returns where a ray meets a body's quadric.
    fn quadric_roots(
        &self,
        ray: &Ray,
        body: Body<'_>,
        quadric: &Quadric,
        light_idx: Option<usize>,
    ) -> Decided<Vec<Root>> {
        let is_on = |light_idx: usize| body.side_of(self.scene.lights[light_idx].position_exact) == Ordering::Equal;
        self.roots(&Quadratic {
            a: quadric.dot(&ray.dir, &ray.dir),
            b: quadric.dot(&quadric.offset(&ray.origin), &ray.dir),
            c: quadric.at(&ray.origin),
            starts_on: ray.leaves.contains(&quadric.equation),
            ends_on: light_idx.is_some_and(is_on),
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
            // The roots are 1 and c/a, which is below 0.
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
