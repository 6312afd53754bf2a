//! What is seen from a point through the faces of a cube around it, object by object.
//!
//! Neighbours in a scene of many objects are neighbours in space, so that a block of spheres is mostly seen through one
//! face: the block is held against all faces, and its outlines are worked out side by side for those that may see it.

use std::ops::Range;

use crate::plan::Scene;
use crate::plan::apex::cube::{CubeFace, Frame};
use crate::plan::apex::grid::Spot;
use crate::plan::apex::{BLOCK, Outline, Outlines, ROUNDOFF};

/// Faces reach to slopes of this, 1 + 2⁻¹⁰.
pub const LIMIT: f64 = 1.0 + 1.0 / 1024.0;

/// Calls `add` with each face that sees one of the objects, counted spheres first, and what it sees of it, in the order of
/// the objects for each face.
pub fn for_each_spot(scene: &Scene<'_>, apex: [f64; 3], objects: Range<usize>, mut add: impl FnMut(usize, Spot)) {
    let n_spheres = scene.spheres.radius.len();
    let mut i = objects.start;
    while i < objects.end.min(n_spheres) {
        let block = if i + BLOCK <= objects.end { Block::new(scene, apex, i) } else { None };
        match block {
            Some(block) => block.look(&mut add),
            None => look_at_sphere(scene, apex, i, &mut add),
        }
        i += if block.is_some() { BLOCK } else { 1 };
    }
    for i in i..objects.end {
        look_at_cylinder(scene, apex, i - n_spheres, i as u32, &mut add);
    }
}

/// Returns a radius with which a sphere holds the exact one, though the subtraction of the apex may have moved its centre.
#[inline]
fn widened(center: [f64; 3], radius: f64) -> f64 {
    let moved = ROUNDOFF * (center[0].abs() + center[1].abs() + center[2].abs());
    (radius + 2.0 * moved) * (1.0 + 4.0 * ROUNDOFF)
}

/// Tells whether a sphere may be seen through a face: it is not beyond the plane slope = LIMIT, from which the centre is
/// this far times √2.
#[inline]
fn may_be_seen([u, v, ahead]: [f64; 3], radius: f64) -> bool {
    u.abs().max(v.abs()) - LIMIT * ahead <= 1.5 * radius
}

/// Some spheres, lane by lane.
#[derive(Clone, Copy)]
struct Block {
    first: u32,
    /// From the apex.
    center: [[f64; BLOCK]; 3],
    radius: [f64; BLOCK],
}

impl Block {
    /// Takes the spheres from the `first` on; `None` when they are too few.
    #[inline]
    fn new(scene: &Scene<'_>, apex: [f64; 3], first: usize) -> Option<Self> {
        let spheres = &scene.spheres;
        let lanes = |lanes: &[f64]| lanes[first..].first_chunk::<BLOCK>().copied();
        let mut center = [lanes(&spheres.x)?, lanes(&spheres.y)?, lanes(&spheres.z)?];
        let mut radius = lanes(&spheres.radius)?;
        for k in 0..3 {
            center[k].iter_mut().for_each(|c| *c -= apex[k]);
        }
        for i in 0..BLOCK {
            radius[i] = widened([center[0][i], center[1][i], center[2][i]], radius[i]);
        }
        Some(Self { first: first as u32, center, radius })
    }

    /// Calls `add` with each face that sees one of the spheres, and what it sees of it.
    #[inline]
    fn look(&self, add: &mut impl FnMut(usize, Spot)) {
        for face in 0..CubeFace::N {
            let Frame { across, ahead, is_backward } = CubeFace::nth(face).frame();
            let [u, v] = across.map(|k| &self.center[k]);
            let ahead = self.center[ahead].map(|c| if is_backward { -c } else { c });
            let may_see: [bool; BLOCK] = std::array::from_fn(|i| may_be_seen([u[i], v[i], ahead[i]], self.radius[i]));
            if may_see == [false; BLOCK] {
                continue;
            }
            let outlines = Outlines::of_spheres([u, v, &ahead], &self.radius);
            for i in (0..BLOCK).filter(|&i| may_see[i]) {
                let outline = outlines.get(i).or_else(|| Outline::of_sphere([u[i], v[i], ahead[i]], self.radius[i]));
                if let Some(spot) = outline.and_then(|outline| spot(&outline, self.first + i as u32)) {
                    add(face, spot);
                }
            }
        }
    }
}

/// Calls `add` with each face that sees a sphere, and what it sees of it.
fn look_at_sphere(scene: &Scene<'_>, apex: [f64; 3], i: usize, add: &mut impl FnMut(usize, Spot)) {
    let spheres = &scene.spheres;
    let center = [spheres.x[i] - apex[0], spheres.y[i] - apex[1], spheres.z[i] - apex[2]];
    let radius = widened(center, spheres.radius[i]);
    for face in 0..CubeFace::N {
        let way = CubeFace::nth(face).look(center);
        if may_be_seen(way, radius)
            && let Some(spot) = Outline::of_sphere(way, radius).and_then(|outline| spot(&outline, i as u32))
        {
            add(face, spot);
        }
    }
}

/// Calls `add` with each face that sees a cylinder, and what it sees of it.
fn look_at_cylinder(scene: &Scene<'_>, apex: [f64; 3], i: usize, object: u32, add: &mut impl FnMut(usize, Spot)) {
    let cylinders = &scene.cylinders;
    let axis = [cylinders.x[i] - apex[0], 0.0, cylinders.z[i] - apex[2]];
    let moved = ROUNDOFF * (axis[0].abs() + axis[2].abs());
    let radius = (cylinders.radius[i] + 2.0 * moved) * (1.0 + 4.0 * ROUNDOFF);
    let heights = [(cylinders.y_min[i] - apex[1]).next_down(), (cylinders.y_max[i] - apex[1]).next_up()];
    for face in 0..CubeFace::N {
        let Frame { ahead, is_backward, .. } = CubeFace::nth(face).frame();
        let [u, v, depth] = CubeFace::nth(face).look(axis);
        let outline = match (ahead, is_backward) {
            (1, false) => Outline::of_cylinder_from_below([u, v], radius, heights),
            (1, true) => Outline::of_cylinder_from_below([u, v], radius, [-heights[1], -heights[0]]),
            _ => Outline::of_upright_cylinder([u, depth], radius, heights),
        };
        if let Some(spot) = outline.and_then(|outline| spot(&outline, object)) {
            add(face, spot);
        }
    }
}

/// Returns what a face sees of an outline, if it does.
#[inline]
fn spot(outline: &Outline, object: u32) -> Option<Spot> {
    let [[u_low, u_high], [v_low, v_high]] = outline.slopes;
    let is_seen = u_low.max(v_low) <= LIMIT && u_high.min(v_high) >= -LIMIT;
    is_seen.then(|| Spot {
        low: [rounded_down(u_low), rounded_down(v_low)],
        high: [-rounded_down(-u_high), -rounded_down(-v_high)],
        near: rounded_down(outline.near).max(0.0),
        object,
    })
}

/// Returns a number of binary32 that is not above a number that is not +∞.
///
/// What is taken off, 2⁻²³ of the number and more than any of the least, is twice what rounding to binary32 can add. Which
/// way it was rounded need not be asked; the answer would be hard to foresee.
#[inline]
pub fn rounded_down(number: f64) -> f32 {
    let lowered = number - (number.abs() * f64::from(f32::EPSILON) + f64::from(f32::MIN_POSITIVE));
    (lowered as f32).min(f32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{CylinderLanes, SphereLanes};
    use crate::testing::Stream;

    #[test]
    fn what_is_rounded_down_is_not_above() {
        let mut stream = Stream::new(5);
        for _ in 0..100_000 {
            let number = stream.of_any_scale(1000);
            for number in [number, -number] {
                let rounded = f64::from(rounded_down(number));
                let room = number.abs() * 2e-7 + 3e-38;
                let is_close = rounded >= number - room || number > f64::from(f32::MAX) || rounded < -1e38;
                assert!(rounded <= number && is_close, "{number}: {rounded}");
            }
        }
        assert_eq!(rounded_down(f64::NEG_INFINITY), f32::NEG_INFINITY);
        assert!(rounded_down(0.0) < 0.0 && rounded_down(f64::MAX) == f32::MAX);
    }

    /// A block sees what its spheres are seen as one by one.
    #[test]
    fn spheres_of_a_block_are_seen_as_alone() {
        let mut stream = Stream::new(6);
        let mut lanes = SphereLanes::default();
        for i in 0..40 * BLOCK + 7 {
            let spread = [1.0, 1e-3, 1e-9][i / BLOCK % 3];
            for lane in [&mut lanes.x, &mut lanes.y, &mut lanes.z] {
                lane.push(stream.between(0.0, 0.3) + spread * stream.between(-1.0, 1.0));
            }
            lanes.radius.push(spread * libm::exp2(stream.between(-12.0, 1.0)));
        }
        let n = lanes.x.len();
        let scene = Scene::of_shapes(lanes, CylinderLanes::default());
        let apex = [0.1, 0.2, 0.3];
        let mut spots = [const { Vec::new() }; CubeFace::N];
        for_each_spot(&scene, apex, 0..n, |face, spot| spots[face].push(spot));
        let mut alone = [const { Vec::new() }; CubeFace::N];
        for i in 0..n {
            look_at_sphere(&scene, apex, i, &mut |face, spot| alone[face].push(spot));
        }
        assert_eq!(spots, alone);
        assert!(spots.iter().all(|spots| !spots.is_empty()));
    }
}
