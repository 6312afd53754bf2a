//! Whether anything is met on the way to a light.
//!
//! # Method
//! A shadow ray p + t·d ends at t = 1 in the light l. Along it f(t) = |p + t·d − c|² − r² = a·t² − 2b·t + f(0) is a parabola
//! that opens upwards, and whether a sphere is met with 0 < t < 1 follows from signs, without the roots:
//! - f(0) and f(1) are of opposite signs: there is a root between.
//! - Neither is above 0: there is none, since a sphere is convex. If f(0) = 0 and the ray leads inside, the other root lies
//!   before the light exactly if f(1) > 0.
//! - Both are above 0: there are roots if D = b² − a·f(0) ≥ 0, and they lie between if f falls at 0 and rises at 1: if b > 0 and
//!   a − b = d·(l − c) > 0.
//! - f(1) = 0 < f(0): the root besides 1, where no shadow is cast, lies before it if f rises there.
//!
//! The light is one of the scene's numbers, so the sign of f(1) is known however near to the surface it lies, or on it; and
//! a light within a sphere is hidden from all that is outside, however small the sphere is.

use std::cmp::Ordering;

use glam::DVec3;

use crate::math::{Real, Sign, Vector, side_of};
use crate::plan::{Candidates, Object, Scene};
use crate::trace::integrator::Integrator;
use crate::trace::intersect::intersect_cylinder;
use crate::trace::judge::{Doubt, Judge};
use crate::trace::ray::Ray;

impl<R: Real> Integrator<'_, '_, R> {
    /// Tells whether one of the candidates is met with 0 < t < 1 by a ray that leads to `light` at t = 1.
    ///
    /// # Errors
    /// [`Doubt`] when it cannot be decided.
    pub(super) fn occluded(&mut self, ray: &Ray<R>, light: DVec3, among: Candidates<'_>) -> Result<bool, Doubt> {
        let scene = &self.plan.scene;
        self.any_kept(ray, among, |judge, object| match object {
            Object::Sphere(i) => sphere_occludes(judge, scene, ray, light, i as usize),
            Object::Cylinder(i) => cylinder_occludes(judge, scene, ray, light, i),
        })
    }
}

/// Tells whether a sphere is met before the light: see the module's documentation.
fn sphere_occludes<R: Real>(
    judge: &mut Judge,
    scene: &Scene<'_>,
    ray: &Ray<R>,
    light: DVec3,
    i: usize,
) -> Result<bool, Doubt> {
    let leaving = ray.leaving.filter(|leaving| leaving.equation == scene.sphere_equations[i]);
    if leaving.is_some_and(|leaving| !leaving.inward) {
        return Ok(false);
    }
    let spheres = &scene.spheres;
    let (center, radius) = ([spheres.x[i], spheres.y[i], spheres.z[i]], spheres.radius[i]);
    let side_of_light = match side_of(light.to_array(), center, radius) {
        Some(side) => side,
        None => judge.compare_zero(R::power_of_point(light.to_array().map(R::exact), center, radius))?,
    };
    if leaving.is_some() {
        return Ok(side_of_light.is_gt());
    }
    let power = || R::power_of_point(ray.origin.to_array(), center, radius);
    let center = Vector::exact(center.into());
    let rise_at_light = || ray.dir.dot(Vector::exact(light) - center);
    match side_of_light {
        Ordering::Less => judge.is_positive(power()),
        Ordering::Equal => Ok(judge.is_positive(power())? && judge.is_positive(rise_at_light())?),
        Ordering::Greater => {
            let to_center = center - ray.origin;
            // The line goes through both ends: from the nearer one its distance from the centre cancels less.
            let from_light = center - Vector::exact(light);
            let is_near_light = from_light.length_squared().value() < to_center.length_squared().value();
            let arm = if is_near_light { from_light } else { to_center };
            let cross_squared = arm.cross(ray.dir).length_squared();
            let discriminant = ray.dir.length_squared() * R::exact(radius).square() - cross_squared;
            let rise_at_light = rise_at_light();
            // Either says that nothing is met, wherever the ray starts.
            if discriminant.sign() == Sign::Negative || matches!(rise_at_light.sign(), Sign::Negative | Sign::Zero) {
                return Ok(false);
            }
            let along = to_center.dot(ray.dir);
            match judge.compare_zero(power())? {
                Ordering::Less => Ok(true),
                Ordering::Equal => judge.is_positive(along),
                Ordering::Greater if matches!(along.sign(), Sign::Negative | Sign::Zero) => Ok(false),
                Ordering::Greater => Ok(judge.compare_zero(discriminant)?.is_ge()
                    && judge.is_positive(along)?
                    && judge.is_positive(rise_at_light)?),
            }
        }
    }
}

/// Tells whether a cylinder is met before the light.
///
/// Its caps cut the wall's roots off, so that these are needed, with one exception: a light within the cylinder is hidden
/// from whatever is outside.
fn cylinder_occludes<R: Real>(
    judge: &mut Judge,
    scene: &Scene<'_>,
    ray: &Ray<R>,
    light: DVec3,
    cylinder_idx: u32,
) -> Result<bool, Doubt> {
    let (i, cylinders) = (cylinder_idx as usize, &scene.cylinders);
    let (center, radius) = ([cylinders.x[i], cylinders.z[i]], cylinders.radius[i]);
    let (y_min, y_max) = (cylinders.y_min[i], cylinders.y_max[i]);
    let is_between = y_min < light.y && light.y < y_max;
    if is_between && side_of([light.x, light.z], center, radius) == Some(Ordering::Less) {
        let is_below_0 = |number: R| number.sign() == Sign::Negative;
        let starts_outside = is_below_0(ray.origin.y - R::exact(y_min))
            || is_below_0(R::exact(y_max) - ray.origin.y)
            || is_below_0(-R::power_of_point([ray.origin.x, ray.origin.z], center, radius));
        if starts_outside {
            return Ok(true);
        }
    }
    let Some(hit) = intersect_cylinder(judge, scene, ray, cylinder_idx)? else { return Ok(false) };
    judge.is_positive(R::exact(1.0) - hit.t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Ball64, Ball106};
    use crate::plan::{CylinderLanes, SphereLanes};
    use crate::testing::Stream;

    /// A point, a light and a sphere of whole numbers.
    struct Case {
        point: [i64; 3],
        light: [i64; 3],
        center: [i64; 3],
        radius: i64,
    }

    impl Case {
        fn random(stream: &mut Stream) -> Self {
            let mut place = || [0; 3].map(|_| stream.below(13) as i64 - 6);
            let (point, light, center) = (place(), place(), place());
            Self { point, light, center, radius: 1 + stream.below(6) as i64 }
        }

        /// f(0) and f(1) of the module's documentation.
        fn powers(&self) -> [i64; 2] {
            [self.point, self.light].map(|end| {
                let offsets = (0..3).map(|axis| end[axis] - self.center[axis]);
                offsets.map(|offset| offset * offset).sum::<i64>() - self.radius * self.radius
            })
        }

        /// a and b of the module's documentation.
        fn coefficients(&self) -> [i64; 2] {
            let dir: [i64; 3] = std::array::from_fn(|axis| self.light[axis] - self.point[axis]);
            let a = dir.iter().map(|d| d * d).sum();
            [a, (0..3).map(|axis| dir[axis] * (self.center[axis] - self.point[axis])).sum()]
        }

        /// Tells by whole numbers whether f has a root with 0 < t < 1: where its ends differ in sign, or its least value lies
        /// between them, is not above 0, and an end is above 0.
        fn is_occluded(&self) -> bool {
            let ([a, b], [start, end]) = (self.coefficients(), self.powers());
            let has_low_between = 0 < b && b < a && b * b >= a * start;
            start.signum() * end.signum() < 0 || has_low_between && (start > 0 || end > 0)
        }

        /// Asks the tracer.
        fn ask<R: Real>(&self) -> Result<bool, Doubt> {
            let [point, light, center] =
                [self.point, self.light, self.center].map(|v| DVec3::from_array(v.map(|c| c as f64 / 8.0)));
            let spheres = SphereLanes {
                x: vec![center.x],
                y: vec![center.y],
                z: vec![center.z],
                radius: vec![self.radius as f64 / 8.0],
            };
            let scene = Scene::of_shapes(spheres, CylinderLanes::default());
            let origin = Vector::<R>::exact(point);
            let ray = Ray { origin, dir: Vector::exact(light) - origin, aim: None, leaving: None, light: Some(light) };
            sphere_occludes(&mut Judge::default(), &scene, &ray, light, 0)
        }
    }

    #[test]
    fn spheres_occlude_as_whole_numbers_say() {
        let mut stream = Stream::new(17);
        let (mut n_doubts, mut n_on) = (0, 0);
        for _ in 0..200_000 {
            let case = Case::random(&mut stream);
            if case.point == case.light {
                continue;
            }
            let ([a, b], [start, end]) = (case.coefficients(), case.powers());
            for answer in [case.ask::<Ball64>(), case.ask::<Ball106>()] {
                match answer {
                    Ok(answer) => assert_eq!(
                        answer,
                        case.is_occluded(),
                        "from {:?} to {:?} past {:?} {}",
                        case.point,
                        case.light,
                        case.center,
                        case.radius
                    ),
                    Err(Doubt) => {
                        n_doubts += 1;
                        let touches_at_light = end == 0 && a == b;
                        assert!(end > 0 || touches_at_light, "a light on or in the sphere leaves no doubt");
                    }
                }
            }
            n_on += usize::from(start != 0 && end == 0);
        }
        assert!(n_on > 500 && n_doubts < 2_000, "{n_on} lights on spheres, {n_doubts} doubts");
    }

    /// A point, a light and a cylinder of whole numbers.
    #[derive(Debug)]
    struct CylinderCase {
        point: [i64; 3],
        light: [i64; 3],
        center: [i64; 2],
        radius: i64,
        heights: [i64; 2],
    }

    impl CylinderCase {
        fn random(stream: &mut Stream) -> Self {
            let mut any = |n: usize| stream.below(n) as i64;
            let [point, light] = [0; 2].map(|_| [0; 3].map(|_| any(13) - 6));
            let bottom = any(9) - 5;
            Self {
                point,
                light,
                center: [any(7) - 3, any(7) - 3],
                radius: 1 + any(6),
                heights: [bottom, bottom + 1 + any(4)],
            }
        }

        /// The power of a place with regard to the wall.
        fn power(&self, [x, _, z]: [i64; 3]) -> i64 {
            let offsets = [x - self.center[0], z - self.center[1]];
            offsets.map(|offset| offset * offset).iter().sum::<i64>() - self.radius * self.radius
        }

        /// Tells on which side of the surface a place lies: `Less` inside.
        fn side(&self, place: [i64; 3]) -> Ordering {
            let ([bottom, top], y) = (self.heights, place[1]);
            self.power(place).cmp(&0).max(bottom.cmp(&y)).max(y.cmp(&top))
        }

        /// Tells by whole numbers whether something is met with 0 < t < 1; `None` from the surface itself, and if it is only
        /// touched.
        fn is_occluded(&self) -> Option<bool> {
            match self.side(self.point) {
                // The inside is convex.
                Ordering::Less => return Some(self.side(self.light).is_gt()),
                Ordering::Equal => return None,
                Ordering::Greater => {}
            }
            let dir: [i64; 3] = std::array::from_fn(|axis| self.light[axis] - self.point[axis]);
            let y = self.point[1];
            // Between the planes of the caps it is from `enter` to `leave`, in units of 1/n.
            let n = dir[1].abs().max(1);
            let to_planes = self.heights.map(|height| (height - y) * dir[1].signum());
            let [enter, leave] = match dir[1] {
                0 if self.heights.contains(&y) => return None,
                0 if self.heights[0] < y && y < self.heights[1] => [0, 1],
                0 => return Some(false),
                _ => [to_planes[0].min(to_planes[1]).max(0), to_planes[0].max(to_planes[1]).min(n)],
            };
            if enter >= leave {
                return Some(false);
            }
            // The least power on the way, by its sign: a·t² − 2b·t + p.
            let a = dir[0] * dir[0] + dir[2] * dir[2];
            let b = dir[0] * (self.center[0] - self.point[0]) + dir[2] * (self.center[1] - self.point[2]);
            let p = self.power(self.point);
            let at = |t: i64| a * t * t - 2 * b * t * n + p * n * n;
            let least = if enter * a < b * n && b * n < leave * a { p * a - b * b } else { at(enter).min(at(leave)) };
            (least != 0).then_some(least < 0)
        }

        /// Asks the tracer.
        fn ask<R: Real>(&self) -> Result<bool, Doubt> {
            let scaled = |number: i64| number as f64 / 8.0;
            let [point, light] = [self.point, self.light].map(|v| DVec3::from_array(v.map(scaled)));
            let cylinders = CylinderLanes {
                x: vec![scaled(self.center[0])],
                z: vec![scaled(self.center[1])],
                radius: vec![scaled(self.radius)],
                y_min: vec![scaled(self.heights[0])],
                y_max: vec![scaled(self.heights[1])],
            };
            let scene = Scene::of_shapes(SphereLanes::default(), cylinders);
            let origin = Vector::<R>::exact(point);
            let ray = Ray { origin, dir: Vector::exact(light) - origin, aim: None, leaving: None, light: Some(light) };
            cylinder_occludes(&mut Judge::default(), &scene, &ray, light, 0)
        }
    }

    #[test]
    fn cylinders_occlude_as_whole_numbers_say() {
        let mut stream = Stream::new(19);
        let (mut n_known, mut n_doubts) = (0, 0);
        for _ in 0..200_000 {
            let case = CylinderCase::random(&mut stream);
            let Some(expected) = case.is_occluded().filter(|_| case.point != case.light) else { continue };
            for answer in [case.ask::<Ball64>(), case.ask::<Ball106>()] {
                match answer {
                    Ok(answer) => assert_eq!(answer, expected, "{case:?}"),
                    Err(Doubt) => {
                        n_doubts += 1;
                        assert!(case.side(case.light).is_ge() || case.side(case.point).is_lt(), "{case:?}");
                    }
                }
                n_known += 1;
            }
        }
        assert!(n_known > 200_000 && n_doubts < n_known / 50, "{n_known} {n_doubts}");
    }
}
