//! The colour of an eye ray: from hit to hit along the mirror directions, and back.

use std::mem;

use crate::math::{Real, Vector};
use crate::plan::{Candidates, Object, ObjectLists, Part, Plan};
use crate::trace::judge::{Doubt, Judge};
use crate::trace::look_up;
use crate::trace::ray::{Leaving, Ray};
use crate::trace::shade::HitPoint;

/// Follows rays through one scene, in one arithmetic.
#[derive(Debug)]
pub struct Integrator<'a, 'p, R> {
    pub(super) plan: &'a Plan<'p>,
    /// Decides comparisons and counts.
    pub judge: Judge,
    /// The primitives that were not rejected for the ray at hand.
    pub(super) kept: Vec<u32>,
    /// What was looked up for the ray at hand.
    pub(super) found: ObjectLists,
    /// The hits of the ray so far, outermost first.
    bounces: Vec<Bounce<R>>,
    /// The least level at which a ray of the pixel at hand ended in doubt.
    pub given_up: Option<u32>,
}

/// What a hit adds to the colour of its reflected ray, and how much of that it takes.
#[derive(Clone, Copy, Debug)]
struct Bounce<R> {
    local: Vector<R>,
    reflectance: f64,
}

/// What lies at the end of a ray.
enum End<R> {
    /// A colour, and nothing more to follow.
    Color(Vector<R>),
    /// A mirror: its bounce, the reflected ray and what reflects it.
    Mirror(Bounce<R>, Ray<R>, Object),
}

impl<'a, 'p, R: Real> Integrator<'a, 'p, R> {
    /// Makes an integrator that has counted nothing yet.
    pub fn new(plan: &'a Plan<'p>) -> Self {
        Self {
            plan,
            judge: Judge::default(),
            kept: Vec::new(),
            found: ObjectLists::default(),
            bounces: Vec::new(),
            given_up: None,
        }
    }

    /// Returns the colour of an eye ray, each channel clamped to 0…1.
    ///
    /// `among`: what the eye ray can meet.
    ///
    /// # Errors
    /// [`Doubt`] when a comparison at the first hit cannot be decided. Behind a mirror a doubt becomes a colour that may
    /// be anything: whether it matters is seen when the channel is rounded.
    pub fn color(&mut self, eye_ray: Ray<R>, among: Candidates<'_>) -> Result<Vector<R>, Doubt> {
        self.judge.counts.eye_rays += 1;
        self.bounces.clear();
        let mut ray = eye_ray;
        let mut among = among;
        let last = loop {
            let level = self.bounces.len();
            match self.follow(&ray, level as u32, among) {
                Ok(End::Color(color)) => break color,
                Ok(End::Mirror(bounce, reflected, mirror)) => {
                    self.bounces.push(bounce);
                    self.judge.counts.reflected_rays += 1;
                    ray = reflected;
                    among = self.plan.mirrored_by(mirror);
                }
                Err(doubt) => {
                    self.given_up = Some(self.given_up.map_or(level as u32, |least| least.min(level as u32)));
                    if level == 0 {
                        return Err(doubt);
                    }
                    break Vector::exact(glam::DVec3::ZERO).map(|_: R| R::unit_interval());
                }
            }
        };
        let through = |color: Vector<R>, bounce: &Bounce<R>| {
            (bounce.local + color.scale(R::exact(bounce.reflectance))).map(R::clamp_unit)
        };
        Ok(self.bounces.iter().rev().fold(last.map(R::clamp_unit), through))
    }

    /// Follows one ray to the first of the candidates that it meets.
    fn follow(&mut self, ray: &Ray<R>, level: u32, among: Candidates<'_>) -> Result<End<R>, Doubt> {
        let background = Vector::exact(self.plan.scene.background);
        if level > self.plan.settings.max_level {
            let black = Vector::exact(glam::DVec3::ZERO);
            return Ok(End::Color(if self.searching(ray, among, Self::meets_anything)? { black } else { background }));
        }
        let Some(hit) = self.searching(ray, among, Self::intersect)? else {
            return Ok(End::Color(background));
        };
        let at = HitPoint::new(&self.plan.scene, ray, &hit);
        let local = self.shade(&at)?;
        let reflectance = at.surface.reflectance;
        if self.plan.settings.part == Part::A || reflectance <= 0.0 {
            return Ok(End::Color(local));
        }
        Ok(End::Mirror(Bounce { local, reflectance }, reflect(ray, &at), at.object))
    }

    /// Tests a ray against what it may meet: the candidates, or what is looked up for a reflected ray.
    fn searching<T>(
        &mut self,
        ray: &Ray<R>,
        among: Candidates<'_>,
        test: impl FnOnce(&mut Self, &Ray<R>, Candidates<'_>) -> Result<T, Doubt>,
    ) -> Result<T, Doubt> {
        if ray.leaving.is_none() {
            return test(self, ray, among);
        }
        let mut found = mem::take(&mut self.found);
        let answer = look_up::along(self.plan, ray, &mut found, among).and_then(|among| {
            self.judge.counts.reflected_tests += among.len() as u64;
            test(self, ray, among)
        });
        self.found = found;
        answer
    }
}

/// Returns the ray that leaves a hit along d − 2(n·d)n.
fn reflect<R: Real>(ray: &Ray<R>, at: &HitPoint<'_, R>) -> Ray<R> {
    let twice = at.normal.dot(ray.dir) * R::exact(2.0);
    Ray {
        origin: at.point,
        dir: ray.dir - at.normal.scale(twice),
        aim: None,
        leaving: Some(Leaving { equation: at.equation, inward: at.from_inside }),
        light: None,
    }
}
