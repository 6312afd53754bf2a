//! What a ray may meet is kept, whatever rounding hides and however far the ray is off; what it clearly misses is not.

use super::*;
use crate::plan::{CylinderLanes, SphereLanes};
use crate::testing::Stream;

fn vector(stream: &mut Stream) -> [f64; 3] {
    [(); 3].map(|()| stream.between(-1.0, 1.0))
}

fn length(v: [f64; 3]) -> f64 {
    v.into_iter().map(|c| c * c).sum::<f64>().sqrt()
}

fn ray(origin: [f64; 3], dir: [f64; 3], error: f64) -> PlainRay {
    PlainRay { origin, dir, origin_error: error, origin_y_error: error, dir_error: error }
}

/// Returns the origin and the direction of a ray that passes `center` at `share` of the radius, `far` radii from where it
/// starts. A level one stays in the plane of x and z.
pub(in crate::trace) fn passing_ray(
    stream: &mut Stream,
    (center, radius): ([f64; 3], f64),
    share: f64,
    far: f64,
    is_level: bool,
) -> [[f64; 3]; 2] {
    let flat = |[x, y, z]: [f64; 3]| if is_level { [x, 0.0, z] } else { [x, y, z] };
    let (aside, along) = (flat(vector(stream)), flat(vector(stream)));
    // The part of `aside` across `along`, as long as the radius.
    let dot: f64 = (0..3).map(|k| aside[k] * along[k]).sum::<f64>() / (length(along) * length(along));
    let across: [f64; 3] = std::array::from_fn(|k| aside[k] - dot * along[k]);
    let factor = share * radius / length(across);
    let origin = std::array::from_fn(|k| center[k] + across[k] * factor - along[k] * far * radius);
    [origin, along]
}

/// A ray that grazes a sphere: it passes at `share` of the radius, with all of it known to `error`.
fn grazing_ray(stream: &mut Stream, center: [f64; 3], radius: f64, share: f64, error: f64) -> PlainRay {
    let far = 1.0 + 50.0 * stream.unit();
    let [origin, dir] = passing_ray(stream, (center, radius), share, far, false);
    ray(origin, dir, error)
}

/// Returns a ray that is off by up to these errors.
pub(in crate::trace) fn blurred(
    stream: &mut Stream,
    [origin, dir]: [[f64; 3]; 2],
    [origin_error, origin_y_error, dir_error]: [f64; 3],
) -> PlainRay {
    // The sum is rounded too.
    let mut off = |number: f64, error: f64| number + 0.99 * error * stream.between(-1.0, 1.0);
    let [x, y, z] = origin;
    PlainRay {
        origin: [off(x, origin_error), off(y, origin_y_error), off(z, origin_error)],
        dir: dir.map(|d| off(d, dir_error)),
        origin_error,
        origin_y_error,
        dir_error,
    }
}

/// A hit that rounding hides must not be rejected: rays aimed a few roundings inside of the silhouette, at spheres of
/// all sizes far from the origin of coordinates, are kept.
#[test]
fn grazing_hits_are_kept() {
    let mut stream = Stream::new(3);
    for _ in 0..200_000 {
        let radius = libm::exp2(stream.between(-30.0, 30.0));
        let center = vector(&mut stream).map(|c| c * 100.0 * radius);
        // The ray is off by the roundings of its making, at most this.
        let error = 200.0 * radius * 8.0 * f64::EPSILON;
        let ray = grazing_ray(&mut stream, center, radius, 1.0, error);
        let [x, y, z] = center.map(|c| vec![c]);
        let mut kept = Vec::new();
        keep_spheres(&ray, &SphereLanes { x, y, z, radius: vec![radius] }, &[0], &mut kept);
        assert_eq!(kept, [0], "{ray:?} {center:?} {radius}");
    }
}

/// What a ray touches from inside, or leaves from inside, is kept for every ray from which that one may be off.
#[test]
fn what_the_true_ray_meets_is_kept_for_any_ray_so_near() {
    let mut stream = Stream::new(9);
    for _ in 0..100_000 {
        let is_cylinder = stream.below(2) == 0;
        let radius = libm::exp2(stream.between(-20.0, 20.0));
        let reach = radius * libm::exp2(stream.between(-3.0, 7.0));
        let center = vector(&mut stream).map(|c| c * reach);
        let far = if stream.below(3) == 0 { 0.0 } else { libm::exp2(stream.between(-10.0, 6.0)) };
        let [origin, mut dir] = passing_ray(&mut stream, (center, radius), 1.0 - 1e-12, far, is_cylinder);
        if far == 0.0 {
            // From within it leads out.
            let outward = stream.unit() / radius;
            dir = std::array::from_fn(|k| dir[k] + outward * (origin[k] - center[k]));
        }
        let speed = libm::exp2(stream.between(-10.0, 10.0));
        let level = length(dir);
        dir[1] += if is_cylinder { stream.between(-2.0, 2.0) } else { 0.0 };
        let mut error =
            |most: f64| if stream.below(4) == 0 { 0.0 } else { most * libm::exp2(stream.between(-30.0, -2.0)) };
        let origin_error = error(radius);
        let origin_y_error = origin_error.min(error(radius));
        let dir_error = error(level * speed / (1.0 + far));
        let near = blurred(&mut stream, [origin, dir.map(|d| d * speed)], [origin_error, origin_y_error, dir_error]);

        let mut kept = Vec::new();
        let [x, y, z] = center.map(|c| vec![c]);
        if is_cylinder {
            // It is in the wall for a millionth of the radius.
            let height = origin[1] + far * radius * dir[1];
            let mut room = || 1e-5 * radius * (1.0 + 2.0 / level) + radius * stream.below(2) as f64;
            let (y_min, y_max) = (vec![height - room()], vec![height + room()]);
            let cylinders = CylinderLanes { x, z, radius: vec![radius], y_min, y_max };
            keep_cylinders(&near, &cylinders, &[0], &mut kept);
        } else {
            keep_spheres(&near, &SphereLanes { x, y, z, radius: vec![radius] }, &[0], &mut kept);
        }
        assert_eq!(kept, [0], "{origin:?} {dir:?} by {speed} seen as {near:?}: {center:?} {radius}");
    }
}

#[test]
fn clear_misses_are_rejected() {
    let mut stream = Stream::new(5);
    for _ in 0..10_000 {
        let center = vector(&mut stream).map(|c| c * 100.0);
        let ray = grazing_ray(&mut stream, center, 1.0, 1.0 + 1e-9, 1e-15);
        let [x, y, z] = center.map(|c| vec![c]);
        let mut kept = Vec::new();
        keep_spheres(&ray, &SphereLanes { x, y, z, radius: vec![1.0] }, &[0], &mut kept);
        assert!(kept.is_empty(), "{ray:?} {center:?}");
    }
}

#[test]
fn what_lies_behind_is_rejected_and_what_surrounds_is_kept() {
    let toward_minus_z = ray([0.0; 3], [0.1, 0.0, -1.0], 0.0);
    let spheres = SphereLanes { x: vec![0.0; 2], y: vec![0.0; 2], z: vec![3.0, 3.0], radius: vec![1.0, 4.0] };
    let mut kept = Vec::new();
    keep_spheres(&toward_minus_z, &spheres, &[0, 1], &mut kept);
    assert_eq!(kept, [1]);

    let cylinders = CylinderLanes {
        x: vec![0.0; 4],
        z: vec![3.0, 3.0, -3.0, -3.0],
        radius: vec![1.0, 4.0, 1.0, 1.0],
        y_min: vec![-1.0, -1.0, -1.0, 0.5],
        y_max: vec![1.0, 1.0, 1.0, 1.0],
    };
    kept.clear();
    keep_cylinders(&ray([0.0; 3], [0.1, -0.1, -1.0], 0.0), &cylinders, &[0, 1, 2, 3], &mut kept);
    assert_eq!(kept, [1, 2], "behind; around; ahead; ahead but above a ray that falls");
}

#[test]
fn a_ray_in_the_plane_of_a_cap_keeps_its_cylinder() {
    let cylinders =
        CylinderLanes { x: vec![0.0], z: vec![-3.0], radius: vec![1.0], y_min: vec![-1.0], y_max: vec![0.0] };
    let mut kept = Vec::new();
    keep_cylinders(&ray([0.0; 3], [0.0, 0.0, -1.0], 0.0), &cylinders, &[0], &mut kept);
    assert_eq!(kept, [0]);
}
