//! What a secondary ray of a scene of many objects may meet.

use std::marker::PhantomData;

use crate::math::Real;
use crate::plan::{Beam, Boxes, Candidates, Expect, MeetBoxes, Object, ObjectLists, OneByOne, Plan, Scene, SearchRay};
use crate::trace::judge::Doubt;
use crate::trace::kernels::{Mask, SingleLanes, prefetch};
use crate::trace::ray::Ray;
use crate::trace::reject::PlainRay;

/// Half an ulp of 1.
const ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// What bounds on sure meetings are widened by, far more than their roundings.
const WIDEN: f64 = 1.0 + 1e-9;

/// Tests a beam against all boxes of a group at once.
#[derive(Clone, Copy, Debug)]
pub struct SideBySide<S>(PhantomData<S>);

impl<S: SingleLanes> MeetBoxes for SideBySide<S> {
    #[inline(always)]
    fn meet(boxes: &Boxes, beam: &Beam) -> ([f32; 16], u32) {
        let (mut near, mut far) = (S::splat(0.0), S::same(beam.t_max));
        for k in 0..3 {
            let inverse = beam.inverse[k];
            let (enter, leave) =
                if inverse >= 0.0 { (&boxes.low[k], &boxes.high[k]) } else { (&boxes.high[k], &boxes.low[k]) };
            let entered = (S::load(enter) - S::same(beam.ahead[k])) * S::same(inverse);
            let left = (S::load(leave) - S::same(beam.behind[k])) * S::same(inverse);
            (near, far) = (entered.max(near), left.min(far));
        }
        let mut nears = [0.0; 16];
        near.store(&mut nears);
        (nears, near.le(far).bits())
    }
}

impl<S> Expect for SideBySide<S> {
    #[inline(always)]
    fn expect<T>(items: &[T], i: usize) {
        prefetch(items, i);
    }
}

/// With more candidates than these a ray that is too vague to be looked up is not tested in any arithmetic but the finest: the
/// test would take longer than that, and end in doubt. Nor is a packet for which more are found: a ray of it is vague.
pub const MANY: usize = 1024;

/// Directions that are off by a larger share, 2⁻¹², are vague.
const VAGUE: f64 = 1.0 / 4096.0;

/// Returns all candidates of a ray for which the plan has nothing to look up, or too little is known.
///
/// # Errors
/// [`Doubt`] when finer arithmetic can look them up.
fn unless_vague<R: Real>(looks_up: bool, all: Candidates<'_>) -> Result<Candidates<'_>, Doubt> {
    if looks_up && !R::IS_FINE && all.len() > MANY { Err(Doubt) } else { Ok(all) }
}

/// Lists what a reflected ray may meet; `unless_found` when the plan does not look it up.
///
/// # Errors
/// [`Doubt`] when there are many objects and too little is known of the ray.
pub fn along<'a, R: Real>(
    plan: &Plan<'_>,
    ray: &Ray<R>,
    found: &'a mut ObjectLists,
    unless_found: Candidates<'a>,
) -> Result<Candidates<'a>, Doubt> {
    let plain_ray = ray.plain();
    let PlainRay { origin, dir, origin_error, dir_error, .. } = plain_ray;
    let speed = dir.into_iter().fold(0.0, |speed: f64, d| speed.max(d.abs()));
    if !R::IS_FINE && dir_error > VAGUE * speed {
        return unless_vague::<R>(plan.looks_along(), unless_found);
    }
    found.clear();
    let leaving = ray.leaving.map(|leaving| leaving.equation);
    let mut matters = f64::INFINITY;
    let search_ray = SearchRay { origin, dir, origin_error, dir_error };
    let looked_up = plan.visit_along::<OneByOne>(&search_ray, |object| {
        found.push(object);
        if let Object::Sphere(i) = object
            && leaving != Some(plan.scene.sphere_equations[i as usize])
        {
            matters = matters.min(met_before(&plain_ray, &plan.scene, i as usize));
        }
        matters
    });
    match looked_up {
        Some(()) => Ok(found.as_candidates()),
        None => unless_vague::<R>(plan.looks_along(), unless_found),
    }
}

/// Lists what may lie between a light and where a shadow ray starts; `unless_found` when the plan does not look it up.
///
/// `ray`: leads to the light at t = 1.
///
/// # Errors
/// [`Doubt`] when there are many objects and too little is known of the ray.
pub fn before_light<'a, R: Real>(
    plan: &Plan<'_>,
    light_idx: usize,
    ray: &Ray<R>,
    found: &'a mut ObjectLists,
    unless_found: Candidates<'a>,
) -> Result<Candidates<'a>, Doubt> {
    let PlainRay { dir, dir_error, .. } = ray.plain();
    found.clear();
    let looked_up = plan.visit_between(light_idx, dir.map(|d| -d), dir_error, |object| {
        found.push(object);
        false
    });
    match looked_up {
        Some(_) => Ok(found.as_candidates()),
        None => unless_vague::<R>(plan.looks_between(), unless_found),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Ball64, Ball106};
    use crate::plan::{CylinderLanes, SphereLanes};
    use crate::testing::Stream;
    use crate::trace::kernels::{Backend, SingleJob};
    use crate::trace::reject::tests::{blurred, passing_ray};

    struct Meet<'a>(&'a Boxes, &'a Beam);

    impl SingleJob for Meet<'_> {
        type Output = ([f32; 16], u32);

        #[inline(always)]
        fn run<S: SingleLanes>(self) -> Self::Output {
            SideBySide::<S>::meet(self.0, self.1)
        }
    }

    /// Also where boxes are missing, touch the beam or lie behind it, and where the beam runs along an axis.
    #[test]
    fn boxes_side_by_side_are_met_as_one_by_one() {
        let mut stream = Stream::new(7);
        for _ in 0..20_000 {
            let n = 1 + stream.below(16);
            let mut corner = || [0; 3].map(|_| stream.below(9) as f32 - 4.0);
            let boxes = (0..n).map(|_| {
                let (a, b) = (corner(), corner());
                [std::array::from_fn(|k| a[k].min(b[k])), std::array::from_fn(|k| a[k].max(b[k]))]
            });
            let boxes = Boxes::new(boxes.collect::<Vec<_>>().into_iter());
            let [origin, dir] = [0; 2].map(|_| [0; 3].map(|_| stream.below(9) as f64 - 4.0));
            let ray = SearchRay { origin, dir, origin_error: 0.0, dir_error: 0.0 };
            let Some(mut beam) = Beam::new(&ray, 4.0) else { continue };
            if stream.below(2) == 0 {
                beam.limit(stream.unit() * 4.0);
            }
            let expected = OneByOne::meet(&boxes, &beam);
            for backend in Backend::ALL.into_iter().filter(|backend| backend.is_available()) {
                assert_eq!(backend.run_single(Meet(&boxes, &beam)), expected, "{}", backend.name());
            }
        }
    }

    #[test]
    fn many_candidates_of_a_vague_ray_are_left_to_finer_arithmetic() {
        let numbers: Vec<u32> = (0..=MANY as u32).collect();
        let all = |n: usize| Candidates { spheres: &numbers[..n], cylinders: &[] };
        assert!(unless_vague::<Ball64>(true, all(MANY + 1)).is_err());
        for found in [
            unless_vague::<Ball64>(true, all(MANY)),
            unless_vague::<Ball64>(false, all(MANY + 1)),
            unless_vague::<Ball106>(true, all(MANY + 1)),
        ] {
            assert!(found.is_ok_and(|found| found.len() >= MANY));
        }
    }

    /// A sphere at 0 and a ray that passes it at `share` of the radius, `far` radii from where it starts.
    fn passing(stream: &mut Stream, share: f64, far: f64) -> (f64, [[f64; 3]; 2]) {
        let radius = libm::exp2(stream.between(-20.0, 20.0));
        let [origin, dir] = passing_ray(stream, ([0.0; 3], radius), share, far, false);
        let speed = libm::exp2(stream.between(-10.0, 10.0));
        (radius, [origin, dir.map(|d| d * speed)])
    }

    /// Errors of a ray, of its direction so much less as it is far.
    fn errors(stream: &mut Stream, radius: f64, dir: [f64; 3], far: f64) -> [f64; 3] {
        let mut error =
            |most: f64| if stream.below(4) == 0 { 0.0 } else { most * libm::exp2(stream.between(-30.0, -5.0)) };
        let speed = dir.into_iter().map(f64::abs).fold(0.0, f64::max);
        let (of_origin, of_dir) = (error(radius), error(speed / (1.0 + far)));
        [of_origin, of_origin, of_dir]
    }

    fn ask(radius: f64, ray: &PlainRay) -> f64 {
        let spheres = SphereLanes { x: vec![0.0], y: vec![0.0], z: vec![0.0], radius: vec![radius] };
        met_before(ray, &Scene::of_shapes(spheres, CylinderLanes::default()), 0)
    }

    #[test]
    fn what_the_true_ray_misses_is_met_before_no_end() {
        let mut stream = Stream::new(13);
        for _ in 0..100_000 {
            let far = libm::exp2(stream.between(-10.0, 6.0));
            let (radius, [origin, dir]) = passing(&mut stream, 1.0 + 1e-12, far);
            // From behind it no ray leads back.
            let dir = if stream.below(4) == 0 { dir.map(|d| -d) } else { dir };
            let errors = errors(&mut stream, radius, dir, far);
            let near = blurred(&mut stream, [origin, dir], errors);
            assert_eq!(ask(radius, &near), f64::INFINITY, "{origin:?} {dir:?} seen as {near:?}: {radius}");
        }
    }

    #[test]
    fn what_the_true_ray_meets_it_meets_in_time() {
        let mut stream = Stream::new(14);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        for _ in 0..100_000 {
            let (share, far) = (0.9 * stream.unit(), libm::exp2(stream.between(-10.0, 6.0)));
            let (radius, [origin, dir]) = passing(&mut stream, share, far);
            let errors = errors(&mut stream, radius, dir, far);
            let near = blurred(&mut stream, [origin, dir], errors);
            let found = ask(radius, &near);
            let (a, b) = (dot(dir, dir), -dot(origin, dir));
            let root = (b * b - a * (dot(origin, origin) - radius * radius)).sqrt();
            let first = if b > root { (b - root) / a } else { (b + root) / a };
            assert!(found > first, "{found} {first} {origin:?} {dir:?} seen as {near:?}: {radius}");
            if errors[0] < 1e-6 * radius && errors[2] * (1.0 + far) < 1e-6 * a.sqrt() && b > 1e-3 * radius * a.sqrt() {
                let last = (b + radius * a.sqrt()) / a;
                assert!(found < 1.01 * last, "{found} {last} {origin:?} {dir:?}: {radius}");
            }
        }
    }
}
