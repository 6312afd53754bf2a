//! A tree of boxes: what a ray from anywhere may meet.
//!
//! # Method
//! Objects stand in the order of the scene, which is that of a curve that fills space (`curve`). Each sixteen in a row make
//! a group with a box about each, each sixteen groups in a row a group of the next level, up to one. No node needs a
//! pointer: child k of group g is group 16·g + k of the level below. Objects of different sizes stand in different trees, so that large ones do not blow up the
//! boxes of small ones; giants, and sizes that few have, stand in none and are visited always.
//!
//! # Why a grazing ray is not lost
//! Boxes are rounded outward to binary32. A ray is tested as a beam as wide as its *pad*. Let the direction's largest
//! coordinate be 1, E bound the coordinates of all boxes and of the origin, and the true ray be off by e in its origin and
//! by f < ½ in its direction. A true point at t in a box has t ≤ 4E, so that the ray as given is off from it by at most
//! e + 4E·f. The slope of a plane's distance c, c/d, is computed with three roundings, each of at most 2⁻²⁴ of c, which is
//! at most 2E and the pad; the origin is rounded by 2⁻²⁴·E; a coordinate of the direction below 2⁻⁴⁰ counts as 2⁻⁴⁰. So
//! the pad e + 4E·f + 2⁻¹⁹·E, and a bit for underflow, covers all of it: for each axis the computed interval of t holds
//! the true t.
//!
//! # Source
//! Kamel and Faloutsos, "Hilbert R-tree: an improved R-tree using fractals", VLDB 1994: boxes about runs of Hilbert's curve.
//! Built in a tenth of the time of a tree by clusters (obvhs), for scenes of which few rays are reflected.

mod boxes;

use rayon::prelude::*;

use crate::plan::apex::rounded_down;
use crate::plan::curve;
use crate::plan::tree::boxes::LANES;
use crate::plan::{Object, Scene};

pub use boxes::{Beam, Boxes, MeetBoxes, OneByOne};

/// Beyond this, 2⁶⁰, neither boxes nor origins are looked at in binary32.
const FARTHEST: f64 = f64::from_bits((1023 + 60) << 52);

/// Objects in one tree are at most this many times as large as another, 2³, about.
const SIZES_PER_TREE: i32 = 3;

/// Sizes that fewer objects have are in no tree.
const MIN_OBJECTS: usize = LANES;

/// Sizes below 2⁻³⁰ of the largest are in one tree.
const SMALLEST: i32 = -30;

/// Fewer objects than this may not stand in the order of the curve in their scene, and are sorted here.
const SORTED_FROM: usize = 1024;

/// Objects that a thread takes at a time.
const OBJECTS_PER_TASK: usize = 4096;

/// A ray, and how far it is off.
#[derive(Clone, Copy, Debug)]
pub struct SearchRay {
    /// Where it starts.
    pub origin: [f64; 3],
    /// Where it goes; need not be of unit length.
    pub dir: [f64; 3],
    /// A bound on the error of each coordinate of the origin.
    pub origin_error: f64,
    /// A bound on the error of each coordinate of the direction.
    pub dir_error: f64,
}

/// What rays may meet.
#[derive(Debug, Default)]
pub(super) struct Forest {
    trees: Vec<Tree>,
    /// In no tree.
    apart: Vec<u32>,
    /// Bounds every coordinate of every box in a tree.
    extent: f64,
    n_spheres: u32,
}

/// One tree.
#[derive(Debug)]
struct Tree {
    /// Groups of sixteen boxes: of objects, of those groups, and so on up to one group.
    levels: Vec<Vec<Boxes>>,
    /// The objects in the order of their boxes.
    objects: Vec<u32>,
}

/// A box in binary32, outside of an object: least and largest coordinates.
type Bounds = [[f32; 3]; 2];

impl Forest {
    /// Sorts the objects of a scene.
    pub fn new(scene: &Scene<'_>) -> Self {
        let n_spheres = scene.spheres.radius.len();
        let n_objects = n_spheres + scene.cylinders.radius.len();
        let bounds_of = |i: u32| bounds(scene, i as usize);
        let mut forest = Self { n_spheres: n_spheres as u32, ..Self::default() };
        let sizes = (0..n_objects).into_par_iter().with_min_len(OBJECTS_PER_TASK).map(|i| size_class(scene, i));
        let sizes: Vec<i8> = sizes.collect();
        let mut is_present = [false; 1 << u8::BITS];
        sizes.iter().for_each(|size| is_present[usize::from(size.cast_unsigned())] = true);
        // What is large is met before what is small.
        for size in (i8::MIN..=i8::MAX).rev().filter(|size| is_present[usize::from(size.cast_unsigned())]) {
            let all = (0..n_objects).into_par_iter().with_min_len(OBJECTS_PER_TASK);
            let objects: Vec<_> = all.filter(|&i| sizes[i] == size).map(|i| i as u32).collect();
            if size == APART || objects.len() < MIN_OBJECTS {
                forest.apart.extend(objects);
            } else {
                let tree = Tree::new(objects, bounds_of);
                forest.extent = forest.extent.max(tree.extent());
                forest.trees.push(tree);
            }
        }
        forest
    }

    /// Calls `visit` with each object that the ray may meet, roughly from near to far, and is told by it up to which t
    /// meetings still matter, below 0 for none; `None` when the ray is too far off to tell.
    #[inline(always)]
    pub fn visit<M: MeetBoxes>(&self, ray: &SearchRay, mut visit: impl FnMut(Object) -> f64) -> Option<()> {
        let mut beam = Beam::new(ray, self.extent)?;
        let mut visit = |i: u32| {
            visit(match i.checked_sub(self.n_spheres) {
                None => Object::Sphere(i),
                Some(i) => Object::Cylinder(i),
            })
        };
        for &i in &self.apart {
            beam.limit(visit(i));
            if beam.t_max < 0.0 {
                return Some(());
            }
        }
        for tree in &self.trees {
            tree.visit::<M>(&mut beam, &mut visit);
        }
        Some(())
    }
}

impl Tree {
    fn new(mut objects: Vec<u32>, bounds_of: impl Fn(u32) -> Bounds + Send + Sync) -> Self {
        if objects.len() < SORTED_FROM {
            let low = |i: usize| bounds_of(objects[i])[0].map(f64::from);
            objects = curve::order(objects.len(), low).into_iter().map(|i| objects[i as usize]).collect();
        }
        let leaves = objects.par_chunks(LANES).with_min_len(OBJECTS_PER_TASK / LANES);
        let mut levels: Vec<Vec<Boxes>> =
            vec![leaves.map(|group| Boxes::new(group.iter().map(|&i| bounds_of(i)))).collect()];
        while levels[levels.len() - 1].len() > 1 {
            let below = &levels[levels.len() - 1];
            levels.push(below.chunks(LANES).map(|groups| Boxes::new(groups.iter().map(Boxes::union))).collect());
        }
        Self { levels, objects }
    }

    /// Returns the largest coordinate of its boxes.
    fn extent(&self) -> f64 {
        let [root] = &self.levels[self.levels.len() - 1][..] else { return 0.0 };
        root.union().as_flattened().iter().fold(0.0, |extent, &c| extent.max(f64::from(c.abs())))
    }

    #[inline(always)]
    fn visit<M: MeetBoxes>(&self, beam: &mut Beam, visit: &mut impl FnMut(u32) -> f64) {
        // A group leaves at most fifteen others behind on each of at most eight levels.
        let mut stack = [(0.0f32, 0u32, 0u32); 128];
        stack[0] = (0.0, self.levels.len() as u32 - 1, 0);
        let mut n_stacked = 1;
        while n_stacked > 0 {
            n_stacked -= 1;
            let (near, level, group) = stack[n_stacked];
            if near > beam.t_max {
                continue;
            }
            let (nears, mut met) = M::meet(&self.levels[level as usize][group as usize], beam);
            let first = n_stacked;
            while met != 0 {
                let lane = met.trailing_zeros();
                met &= met - 1;
                let child = group * LANES as u32 + lane;
                if level == 0 {
                    if nears[lane as usize] <= beam.t_max {
                        beam.limit(visit(self.objects[child as usize]));
                    }
                    continue;
                }
                M::expect(&self.levels[level as usize - 1], child as usize);
                // The nearest is to be on top.
                let mut at = n_stacked;
                while at > first && stack[at - 1].0 < nears[lane as usize] {
                    stack[at] = stack[at - 1];
                    at -= 1;
                }
                stack[at] = (nears[lane as usize], level - 1, child);
                n_stacked += 1;
            }
        }
    }
}

/// The size of what is in no tree, wherever it is.
const APART: i8 = i8::MAX;

/// Returns the size of an object as an exponent, in steps, or [`APART`].
fn size_class(scene: &Scene<'_>, i: usize) -> i8 {
    let [low, high] = exact_bounds(scene, i);
    let is_near = low.iter().chain(&high).all(|c| c.abs() <= FARTHEST);
    let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    // Of a number that is normal and positive.
    let exponent = |size: f64| (size.to_bits() >> (f64::MANTISSA_DIGITS - 1)) as i32 - (f64::MAX_EXP - 1);
    if is_near { exponent(size.max(f64::MIN_POSITIVE)).max(SMALLEST).div_euclid(SIZES_PER_TREE) as i8 } else { APART }
}

/// Returns the least and the largest coordinates of an object, each to a rounding.
fn exact_bounds(scene: &Scene<'_>, i: usize) -> [[f64; 3]; 2] {
    let (spheres, cylinders) = (&scene.spheres, &scene.cylinders);
    match i.checked_sub(spheres.radius.len()) {
        None => {
            let (center, radius) = ([spheres.x[i], spheres.y[i], spheres.z[i]], spheres.radius[i]);
            [center.map(|c| c - radius), center.map(|c| c + radius)]
        }
        Some(i) => {
            let (x, z, radius) = (cylinders.x[i], cylinders.z[i], cylinders.radius[i]);
            [[x - radius, cylinders.y_min[i], z - radius], [x + radius, cylinders.y_max[i], z + radius]]
        }
    }
}

/// Returns a box in binary32 outside of an object.
fn bounds(scene: &Scene<'_>, i: usize) -> Bounds {
    let [low, high] = exact_bounds(scene, i);
    // What is taken off is more than a rounding of binary32 and one of binary64.
    [low.map(rounded_down), high.map(|c| -rounded_down(-c))]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DoubleDouble;
    use crate::plan::{CylinderLanes, SphereLanes};
    use crate::testing::Stream;

    /// Spheres of some sizes in some clusters.
    fn crowd(stream: &mut Stream, n: usize) -> Scene<'static> {
        let mut lanes = SphereLanes::default();
        for _ in 0..n {
            let spread = [1.0, 1e-3][stream.below(2)];
            let radius = libm::exp2(stream.between(-24.0, -3.0)) * spread;
            lanes.x.push(0.3 + spread * stream.between(-1.0, 1.0));
            lanes.y.push(-0.2 + spread * stream.between(-1.0, 1.0));
            lanes.z.push(-1.0 + spread * stream.between(-0.9, 0.9));
            lanes.radius.push(radius);
        }
        Scene::of_shapes(lanes, CylinderLanes::default())
    }

    fn found(forest: &Forest, ray: &SearchRay) -> Vec<Object> {
        let mut found = Vec::new();
        let seen = forest.visit::<OneByOne>(ray, |object| {
            found.push(object);
            f64::INFINITY
        });
        assert!(seen.is_some());
        found
    }

    /// Each ray passes one sphere at its radius, as exactly as binary64 can say.
    #[test]
    fn what_a_ray_grazes_is_found() {
        let mut stream = Stream::new(41);
        for n in [20, 300, 5000] {
            let scene = crowd(&mut stream, n);
            let forest = Forest::new(&scene);
            let mut n_found = 0;
            let n_rays = 250_000;
            for _ in 0..n_rays {
                let i = stream.below(n);
                let s = &scene.spheres;
                let (center, radius) = ([s.x[i], s.y[i], s.z[i]], s.radius[i]);
                let mut vector = || [0; 3].map(|_| stream.between(-1.0, 1.0));
                let (dir, aside) = (vector(), vector());
                let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
                let across: [f64; 3] = std::array::from_fn(|k| aside[k] - dir[k] * dot(aside, dir) / dot(dir, dir));
                let share = radius / libm::sqrt(dot(across, across));
                let back = stream.unit();
                let origin: [f64; 3] = std::array::from_fn(|k| center[k] + across[k] * share - back * dir[k]);
                // Whether it meets the sphere, exactly: (m × d)² ≤ r²·d².
                let m: [_; 3] = std::array::from_fn(|k| DoubleDouble::sum(center[k], -origin[k]));
                let cross: [_; 3] =
                    std::array::from_fn(|k| m[(k + 1) % 3] * dir[(k + 2) % 3] - m[(k + 2) % 3] * dir[(k + 1) % 3]);
                let squared = cross[0].square() + cross[1].square() + cross[2].square();
                let d: [_; 3] = dir.map(DoubleDouble::from);
                let reach = DoubleDouble::product(radius, radius) * (d[0].square() + d[1].square() + d[2].square());
                let speed = libm::exp2(stream.between(-300.0, 300.0));
                let ray = SearchRay { origin, dir: dir.map(|c| c * speed), origin_error: 0.0, dir_error: 0.0 };
                let is_found = found(&forest, &ray).contains(&Object::Sphere(i as u32));
                assert!(is_found || (reach - squared).hi() < 0.0, "{ray:?} {center:?} {radius}");
                n_found += usize::from(is_found);
            }
            assert!(n_found > n_rays / 3);
        }
    }

    /// A ray that is off is given what the true ray meets.
    #[test]
    fn what_the_true_ray_meets_is_found_from_the_ray_that_is_off() {
        let mut stream = Stream::new(42);
        let scene = crowd(&mut stream, 1000);
        let forest = Forest::new(&scene);
        for _ in 0..3000 {
            let error = libm::exp2(stream.between(-50.0, -3.0));
            let mut vector = |size: f64| [0; 3].map(|_| stream.between(-size, size));
            let (origin, dir) = (vector(1.0), vector(1.0));
            let (origin_off, dir_off) = (vector(error), vector(error * 0.1));
            let exact = found(&forest, &SearchRay { origin, dir, origin_error: 0.0, dir_error: 0.0 });
            let off = SearchRay {
                origin: std::array::from_fn(|k| origin[k] + origin_off[k]),
                dir: std::array::from_fn(|k| dir[k] + dir_off[k]),
                origin_error: error,
                dir_error: 0.1 * error,
            };
            let mut among = Vec::new();
            let seen = forest.visit::<OneByOne>(&off, |object| {
                among.push(object);
                f64::INFINITY
            });
            let is_hit = |object: &&Object| {
                let Object::Sphere(i) = object else { return true };
                let (i, s) = (*i as usize, &scene.spheres);
                let m = [s.x[i] - origin[0], s.y[i] - origin[1], s.z[i] - origin[2]];
                let b = m[0] * dir[0] + m[1] * dir[1] + m[2] * dir[2];
                let [a, m2] = [dir, m].map(|v| v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
                let r2 = s.radius[i] * s.radius[i];
                b * b - a * (m2 - r2) > 1e-12 * b * b && (b > 0.0 || m2 < r2)
            };
            assert!(seen.is_none() || exact.iter().filter(is_hit).all(|object| among.contains(object)));
        }
    }

    #[test]
    fn what_no_longer_matters_is_not_visited() {
        let mut stream = Stream::new(43);
        let forest = Forest::new(&crowd(&mut stream, 5000));
        let ray = SearchRay { origin: [0.3, -0.2, 1.0], dir: [0.0, 0.0, -1.0], origin_error: 0.0, dir_error: 0.0 };
        assert!(found(&forest, &ray).len() > 1);
        let mut n_visits = 0;
        let seen = forest.visit::<OneByOne>(&ray, |_| {
            n_visits += 1;
            -1.0
        });
        assert_eq!((seen, n_visits), (Some(()), 1));
        let nowhere = SearchRay { dir: [0.0; 3], ..ray };
        assert!(forest.visit::<OneByOne>(&nowhere, |_| 0.0).is_none());
        assert!(forest.visit::<OneByOne>(&SearchRay { dir_error: 0.5, ..ray }, |_| 0.0).is_none());
    }
}
