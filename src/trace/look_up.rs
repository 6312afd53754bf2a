//! What a secondary ray of a scene of many objects may meet.

use crate::math::Real;
use crate::plan::{Candidates, Object, ObjectLists, Plan, Scene, SearchRay};
use crate::trace::ray::Ray;
use crate::trace::reject::PlainRay;

/// Half an ulp of 1.
const ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// What bounds on sure meetings are widened by, far more than their roundings.
const WIDEN: f64 = 1.0 + 1e-9;

/// Lists what a reflected ray may meet; `unless_found` when the plan does not look it up.
pub fn along<'a, R: Real>(
    plan: &Plan<'_>,
    ray: &Ray<R>,
    found: &'a mut ObjectLists,
    unless_found: Candidates<'a>,
) -> Candidates<'a> {
    let plain_ray = ray.plain();
    let PlainRay { origin, dir, origin_error, dir_error, .. } = plain_ray;
    found.clear();
    let leaving = ray.leaving.map(|leaving| leaving.equation);
    let mut matters = f64::INFINITY;
    let search_ray = SearchRay { origin, dir, origin_error, dir_error };
    let looked_up = plan.visit_along(&search_ray, |object| {
        found.push(object);
        if let Object::Sphere(i) = object
            && leaving != Some(plan.scene.sphere_equations[i as usize])
        {
            matters = matters.min(met_before(&plain_ray, &plan.scene, i as usize));
        }
        matters
    });
    match looked_up {
        Some(()) => found.as_candidates(),
        None => unless_found,
    }
}

/// Lists what may lie between a light and where a shadow ray starts; `unless_found` when the plan does not look it up.
///
/// `ray`: leads to the light at t = 1.
pub fn before_light<'a, R: Real>(
    plan: &Plan<'_>,
    light_idx: usize,
    ray: &Ray<R>,
    found: &'a mut ObjectLists,
    unless_found: Candidates<'a>,
) -> Candidates<'a> {
    let PlainRay { dir, dir_error, .. } = ray.plain();
    found.clear();
    let looked_up = plan.visit_between(light_idx, dir.map(|d| -d), dir_error, |object| {
        found.push(object);
        false
    });
    match looked_up {
        Some(_) => found.as_candidates(),
        None => unless_found,
    }
}

/// Returns a t before which a sphere is met beyond doubt; ∞ when there is doubt.
///
/// With m, b, a as in `intersect`, the line meets the sphere when |m × d|² < a·r², and no meeting is behind
/// (b + r·√a)/a. When b > 0 the last one is ahead. Each component of m × d is off by at most twice the slack δ of
/// `reject`, b by three times.
pub fn met_before(ray: &PlainRay, scene: &Scene<'_>, i: usize) -> f64 {
    let (spheres, d) = (&scene.spheres, ray.dir);
    let m = [spheres.x[i] - ray.origin[0], spheres.y[i] - ray.origin[1], spheres.z[i] - ray.origin[2]];
    let sum = |v: [f64; 3]| v[0].abs() + v[1].abs() + v[2].abs();
    let slack = 6.0 * ROUNDOFF * sum(m) * sum(d)
        + sum(d) * ray.origin_error
        + sum(m) * ray.dir_error
        + 2.0 * ray.origin_error * ray.dir_error
        + f64::MIN_POSITIVE;
    let along = m[0] * d[0] + m[1] * d[1] + m[2] * d[2];
    let cross = [m[1] * d[2] - m[2] * d[1], m[2] * d[0] - m[0] * d[2], m[0] * d[1] - m[1] * d[0]];
    let distance = (cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]).sqrt() * WIDEN + 4.0 * slack;
    let speed = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
    let (slowest, fastest) = (speed / WIDEN - 2.0 * ray.dir_error, speed * WIDEN + 2.0 * ray.dir_error);
    let radius = spheres.radius[i];
    if slowest > 0.0 && distance * WIDEN < slowest * radius && along > 4.0 * slack {
        (along + 4.0 * slack + fastest * radius) / (slowest * slowest) * WIDEN
    } else {
        f64::INFINITY
    }
}
