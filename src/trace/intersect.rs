//! Where a ray meets spheres and cylinders.
//!
//! # Method
//! With m = c − o, b = m·d, a = d·d and the power p = |m|² − r² of the origin, the roots are (b ± √D)/a, D = b² − a·p.
//! Three precautions keep the bounds narrow. D is a·r² − |m × d|² when the origin is outside, which does not cancel for
//! a small sphere far away. The power is computed in twice the precision, which it needs beside a large sphere. And of
//! the two roots the one that would cancel is computed from the other by their product p/a.
//!
//! What no precision decides, because it is equal, is known where it follows from numbers of the scene:
//! - The eye is one of them, so the sign of p is known for eye rays, also where it is 0.
//! - So is a light, which a shadow ray meets at t = 1: see `occlude`.
//! - An eye ray is made of its place in the image and one more number, so whether it touches a surface or meets a rim is
//!   known too: see `touch`.
//! - Of two surfaces with the same equation a ray meets the same roots, and of two caps in one plane the same point.
//!
//! # Source
//! Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems (2019), chapter 7. We keep the
//! direction unnormalised and take |m × d| where they take the rejection of m from d.

use std::cmp::Ordering;

use glam::DVec3;

use crate::math::{Real, Sign, Vector, side_of};
use crate::plan::{Candidates, Object, Scene};
use crate::trace::integrator::Integrator;
use crate::trace::judge::{Doubt, Judge};
use crate::trace::ray::{Face, Hit, Leaving, Ray};
use crate::trace::reject;
use crate::trace::touch::Touch;

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
        let scene = &self.plan.scene;
        let mut nearest: Option<(Hit<R>, u32)> = None;
        self.any_kept(ray, among, |judge, object| {
            let Some(hit) = intersect_object(judge, scene, ray, object)? else { return Ok(false) };
            let order = match object {
                Object::Sphere(i) => scene.sphere_primitives[i as usize].order,
                Object::Cylinder(i) => scene.cylinder_primitives[i as usize].order,
            };
            let replaces = match &nearest {
                None => true,
                Some((best, best_order)) => match compare(judge, scene, best, &hit)? {
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

    /// Tells whether one of the candidates is met at all.
    ///
    /// # Errors
    /// [`Doubt`] when it cannot be decided.
    pub(super) fn meets_anything(&mut self, ray: &Ray<R>, among: Candidates<'_>) -> Result<bool, Doubt> {
        let scene = &self.plan.scene;
        self.any_kept(ray, among, |judge, object| Ok(intersect_object(judge, scene, ray, object)?.is_some()))
    }

    /// Tells whether `test` answers `true` for one of the candidates that are not rejected, and asks no further then.
    ///
    /// A doubt is put off: it is returned only if there is none.
    pub(super) fn any_kept(
        &mut self,
        ray: &Ray<R>,
        among: Candidates<'_>,
        mut test: impl FnMut(&mut Judge, Object) -> Result<bool, Doubt>,
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
            let object = if k < n_spheres { Object::Sphere(i) } else { Object::Cylinder(i) };
            match test(&mut self.judge, object) {
                Ok(true) => return Ok(true),
                Ok(false) => {}
                Err(found) => doubt = Some(found),
            }
        }
        doubt.map_or(Ok(false), Err)
    }
}

/// Returns the nearest hit on an object.
fn intersect_object<R: Real>(
    judge: &mut Judge,
    scene: &Scene<'_>,
    ray: &Ray<R>,
    object: Object,
) -> Result<Option<Hit<R>>, Doubt> {
    match object {
        Object::Sphere(i) => intersect_sphere(judge, scene, ray, i),
        Object::Cylinder(i) => intersect_cylinder(judge, scene, ray, i),
    }
}

/// Compares two hits of one ray by t.
///
/// Those of one equation are hits of the same one or two points. In a plane there is one. Of a sphere or wall the near one is
/// met from outside and the far one from inside, or from within the far one alone; if they coincide, as the ray touches,
/// only the near one is met.
fn compare<R: Real>(judge: &mut Judge, scene: &Scene<'_>, one: &Hit<R>, other: &Hit<R>) -> Result<Ordering, Doubt> {
    if one.face.equation(scene) != other.face.equation(scene) {
        return judge.compare_zero(one.t - other.t);
    }
    Ok(match one.face {
        Face::Sphere(_) | Face::Wall(_) => one.from_inside.cmp(&other.from_inside),
        Face::LowerCap(_) | Face::UpperCap(_) => Ordering::Equal,
    })
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
    let touches = || ray.aim.is_some_and(|aim| aim.touches_sphere(center, spheres.radius[i]));
    let [nearest, _] = roots(judge, leaving, false, quadric, touches)?;
    Ok(nearest.map(|root| Hit { t: root.t, face: Face::Sphere(sphere_idx), from_inside: root.from_inside }))
}

pub(super) fn intersect_cylinder<R: Real>(
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
    let center = [cylinders.x[i], cylinders.z[i]];
    let quadric = || {
        let x = R::exact(center[0]) - ray.origin.x;
        let z = R::exact(center[1]) - ray.origin.z;
        Quadric {
            dir_squared,
            along: x * ray.dir.x + z * ray.dir.z,
            cross_squared: (z * ray.dir.x - x * ray.dir.z).square(),
            power: R::power_of_point([ray.origin.x, ray.origin.z], center, cylinders.radius[i]),
            radius: R::exact(cylinders.radius[i]),
        }
    };
    let is_on = |light: DVec3| side_of([light.x, light.z], center, cylinders.radius[i]) == Some(Ordering::Equal);
    let ends_on = ray.light.is_some_and(is_on);
    let touches = || ray.aim.is_some_and(|aim| aim.touches_wall(center, cylinders.radius[i]));
    let roots = roots(judge, leaving, ends_on, quadric, touches)?;
    let level = |root: &Root<R>| ray.origin.y + ray.dir.y * root.t;
    for root in roots.iter().flatten() {
        // The ray is level with a rim once: at this root, unless it may be at the other.
        let is_level_elsewhere = |height: f64| {
            let others = roots.iter().flatten().filter(|other| other.from_inside != root.from_inside);
            let mut signs = others.map(|other| (level(other) - R::exact(height)).sign());
            signs.any(|sign| matches!(sign, Sign::Zero | Sign::Unknown))
        };
        let is_rim = |height: f64| {
            let meets_rim = ray.aim.is_some_and(|aim| aim.meets_rim(center, cylinders.radius[i], height));
            meets_rim && !is_level_elsewhere(height)
        };
        let (y, bottom, top) = (level(root), cylinders.y_min[i], cylinders.y_max[i]);
        if reaches(judge, y - R::exact(bottom), ray.dir.y, root, || is_rim(bottom))?
            && reaches(judge, R::exact(top) - y, -ray.dir.y, root, || is_rim(top))?
        {
            return Ok(Some(Hit { t: root.t, face: Face::Wall(cylinder_idx), from_inside: root.from_inside }));
        }
    }
    Ok(None)
}

/// Tells whether a meeting with the infinite wall lies on a cylinder's side of one of its caps, or on the rim.
///
/// `height`: of the meeting, from the cap into the cylinder. `climb`: of the ray's direction, the same way. `is_rim`: whether
/// the height is known to be 0, asked where it may be.
///
/// A rim counts, but for one case: where the ray leaves the infinite wall just as it comes down to the cap, it touches
/// nothing but that one point. The semantics call rims hits, yet count two pixels in which the original image of scene
/// i6 may differ, and pixel (0, 180) would be the third: there the ray touches the far rim of the ground so, exactly, and
/// the image shows the background. We follow the image.
fn reaches<R: Real>(
    judge: &mut Judge,
    height: R,
    climb: R,
    root: &Root<R>,
    is_rim: impl FnOnce() -> bool,
) -> Result<bool, Doubt> {
    Ok(match judge.compare_zero_asking(height, Touch::Rim, is_rim)? {
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
    if ray.light.is_some_and(|light| light.y == height) {
        // The plane is met where the light is, and casts no shadow there.
        return Ok(None);
    }
    let rise = R::exact(height) - ray.origin.y;
    let vertical = judge.compare_zero(ray.dir.y)?;
    if vertical.is_eq() || judge.compare_zero(rise)? != vertical {
        return Ok(None);
    }
    let t = rise / ray.dir.y;
    let point = [ray.origin.x + ray.dir.x * t, ray.origin.z + ray.dir.z * t];
    let (center, radius) = ([cylinders.x[i], cylinders.z[i]], cylinders.radius[i]);
    let power = R::power_of_point(point, center, radius);
    let is_rim = || ray.aim.is_some_and(|aim| aim.meets_rim(center, radius, height));
    let from_inside = vertical.is_gt() == is_upper;
    // Of the rim, what a ray from outside meets belongs to the wall: see `reaches`.
    let is_met = match judge.compare_zero_asking(power, Touch::Rim, is_rim)? {
        Ordering::Less => true,
        Ordering::Equal => from_inside,
        Ordering::Greater => false,
    };
    Ok(is_met.then_some(Hit { t, face, from_inside }))
}

/// Finds the meetings with a sphere or an infinite wall, but for one at t = 1 if the ray ends on it.
///
/// For the surface that the ray leaves, 0 is a root and no meeting; the other is 2b/a. It lies ahead exactly when the ray
/// leads inward. The same holds, by the sign of b, if the origin lies on the surface all the same.
///
/// For the surface that holds the light at the end of the ray, 1 is a root, and the other is p/a. From outside that is ahead;
/// it is the near one if it is before the light, and else of no matter.
///
/// `touches`: whether the discriminant is known to be 0, asked where it may be.
fn roots<R: Real>(
    judge: &mut Judge,
    leaving: Option<Leaving>,
    ends_on: bool,
    quadric: impl FnOnce() -> Quadric<R>,
    touches: impl FnOnce() -> bool,
) -> Result<Roots<R>, Doubt> {
    if leaving.is_some_and(|leaving| !leaving.inward) {
        return Ok([None, None]);
    }
    let Quadric { dir_squared, along, cross_squared, power, radius } = quadric();
    let opposite = || Root { t: along * R::exact(2.0) / dir_squared, from_inside: true };
    if leaving.is_some() {
        return Ok([(!ends_on).then(opposite), None]);
    }
    let side = judge.compare_zero(power)?;
    if ends_on {
        let other = Root { t: power / dir_squared, from_inside: false };
        return Ok([side.is_gt().then_some(other), None]);
    }
    match side {
        Ordering::Equal => Ok([judge.is_positive(along)?.then(opposite), None]),
        Ordering::Less => {
            let spread = (along.square() - dir_squared * power).sqrt();
            let t = if along.value() >= 0.0 { (along + spread) / dir_squared } else { -power / (spread - along) };
            Ok([Some(Root { t, from_inside: true }), None])
        }
        Ordering::Greater => {
            // Where one of the two answers that there is no meeting, a doubt about the other is of no matter.
            if matches!(along.sign(), Sign::Negative | Sign::Zero) {
                return Ok([None, None]);
            }
            let discriminant = dir_squared * radius.square() - cross_squared;
            let touches = match judge.compare_zero_asking(discriminant, Touch::Tangent, touches)? {
                Ordering::Less => return Ok([None, None]),
                Ordering::Equal => true,
                Ordering::Greater => false,
            };
            if !judge.is_positive(along)? {
                return Ok([None, None]);
            }
            let sum = if touches { along } else { along + discriminant.sqrt() };
            let near = Root { t: power / sum, from_inside: false };
            let far = Root { t: sum / dir_squared, from_inside: true };
            Ok([Some(near), (!touches).then_some(far)])
        }
    }
}
