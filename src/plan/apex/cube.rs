//! A cube of grids around a point: what lies between the point and others.
//!
//! The point looks along each axis in both directions, through the six faces of a cube. What it sees through a face
//! (see `seen`) is sorted into strips and those into grids ([`Grid`]), as [`Spot`]s. A query goes through the face of
//! its largest coordinate, where both slopes are at most 1; its error may add a little, which faces overlap by
//! ([`LIMIT`]).

use std::ops::{Add, Div, Mul, Neg, RangeInclusive, Sub};

use rayon::prelude::*;

use crate::plan::apex::ROUNDOFF;
use crate::plan::apex::grid::{Axis, Grid, Query, Spot, cell};
use crate::plan::apex::seen::{LIMIT, for_each_spot};
use crate::plan::{Object, Scene};

/// Objects that a thread takes at a time.
const OBJECTS_PER_TASK: usize = 1 << 12;

/// Objects from which on a face is cut into strips for several threads.
const STRIPS_FROM: usize = 1 << 14;

/// Objects that are looked at to choose what a face is cut into, at least, if there are as many.
const N_SAMPLES: usize = 1 << 12;

/// A face that fewer of these see is not cut to what they show.
const MIN_SAMPLES: usize = 1 << 9;

/// Strips of a face for each thread, so that no thread waits long for another.
const STRIPS_PER_THREAD: u32 = 4;

/// Queries that look into more cells together are made one by one.
const MAX_CELLS_AT_ONCE: usize = 4;

/// The six faces around a point.
#[derive(Debug)]
pub struct Cube {
    faces: [Face; 6],
    n_spheres: u32,
}

/// One face: strips of grids, one behind the other along the second axis.
#[derive(Debug)]
struct Face {
    strips: Axis,
    /// The range of the first axis.
    width: [f64; 2],
    grids: Vec<Grid>,
}

/// One of the six faces of the cube.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CubeFace(usize);

/// Which coordinates a face looks across and ahead, and whether ahead is backward.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub across: [usize; 2],
    pub ahead: usize,
    pub is_backward: bool,
}

impl CubeFace {
    /// How many there are.
    pub(super) const N: usize = 6;

    /// Returns the face of an index below [`CubeFace::N`].
    pub(super) const fn nth(i: usize) -> Self {
        Self(i)
    }

    /// Returns the face of the largest coordinate.
    #[inline]
    #[must_use]
    pub fn toward(way: [f64; 3]) -> Self {
        let [x, y, z] = [way[0].abs(), way[1].abs(), way[2].abs()];
        let axis = if x >= y && x >= z {
            0
        } else if y >= z {
            1
        } else {
            2
        };
        Self(2 * axis + usize::from(way[axis] < 0.0))
    }

    /// Returns the coordinates across and ahead.
    #[inline]
    pub fn look<T: Copy + Neg<Output = T>>(self, v: [T; 3]) -> [T; 3] {
        let Frame { across: [i, j], ahead, is_backward } = self.frame();
        [v[i], v[j], if is_backward { -v[ahead] } else { v[ahead] }]
    }

    /// Returns the coordinates across and ahead. Cylinders stand along y, which is the second axis across where it can be.
    #[inline]
    pub(super) fn frame(self) -> Frame {
        let (across, ahead) = [([2, 1], 0), ([0, 2], 1), ([0, 1], 2)][self.0 / 2];
        Frame { across, ahead, is_backward: self.0 % 2 == 1 }
    }
}

/// What is seen of a segment from the apex through a face: between which slopes it runs, and how far ahead.
///
/// With w the coordinate ahead, s one of the slopes and e the error, the exact slope is off from s by at most
/// e·(1 + |s|)/(w − e), which is below 3e/w, and two roundings.
#[derive(Clone, Copy, Debug)]
pub struct Slopes<T> {
    /// The least slopes.
    pub low: [T; 2],
    /// The largest slopes.
    pub high: [T; 2],
    /// Up to a rounding at least the coordinate ahead of the segment's end.
    pub far: T,
}

impl<T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T> + Div<Output = T>> Slopes<T> {
    /// Looks along a segment of which the coordinate ahead is the largest, at least [`Look::SHORTEST`] and [`Look::MIN_PRECISION`] times
    /// as large as the error of each.
    ///
    /// `roundoff`: what one rounding changes is at most this share of the result.
    #[inline(always)]
    pub fn new([u, v, ahead]: [T; 3], error: T, roundoff: f64, number: impl Fn(f64) -> T) -> Self {
        let inverse = number(1.0) / ahead;
        let slopes = [u * inverse, v * inverse];
        let slack = number(4.0) * error * inverse + number(8.0 * roundoff);
        Self {
            low: [slopes[0] - slack, slopes[1] - slack],
            high: [slopes[0] + slack, slopes[1] + slack],
            far: ahead + error,
        }
    }
}

impl Slopes<f64> {
    fn query(self) -> Query {
        Query { low: self.low, high: self.high, far: (self.far as f32).next_up() }
    }
}

impl Cube {
    /// Sorts the objects of a scene into the grids around a point.
    pub fn new(scene: &Scene<'_>, apex: [f64; 3]) -> Self {
        let n_objects = scene.spheres.radius.len() + scene.cylinders.radius.len();
        let mut faces = choose_strips(scene, apex, n_objects);
        let mut places = [0; CubeFace::N];
        let mut tasks = Vec::new();
        for (face, Face { strips, .. }) in faces.iter().enumerate() {
            places[face] = tasks.len();
            tasks.extend((0..strips.cells()).map(|strip| (face, strip)));
        }
        let sort = |i: usize| {
            let objects = i * OBJECTS_PER_TASK..n_objects.min((i + 1) * OBJECTS_PER_TASK);
            let mut lists = vec![Vec::new(); tasks.len()];
            for_each_spot(scene, apex, objects, |face, spot| {
                for strip in faces[face].strips_between(spot.low[1].into(), spot.high[1].into()) {
                    push(&mut lists[places[face] + strip], spot);
                }
            });
            lists.iter_mut().for_each(Vec::shrink_to_fit);
            lists
        };
        let chunks: Vec<_> = (0..n_objects.div_ceil(OBJECTS_PER_TASK)).into_par_iter().map(sort).collect();
        let make = |(list, &(face, strip)): (usize, &(usize, usize))| {
            let parts: Vec<_> = chunks.iter().map(|lists| &lists[list][..]).filter(|part| !part.is_empty()).collect();
            Grid::new(&parts, [faces[face].width, faces[face].strips.range(strip)])
        };
        // One strip may be all the work.
        let grids: Vec<_> = tasks.par_iter().enumerate().with_max_len(1).map(make).collect();
        for ((face, _), grid) in tasks.into_iter().zip(grids) {
            faces[face].grids.push(grid);
        }
        Self { faces, n_spheres: scene.spheres.radius.len() as u32 }
    }

    /// Calls `visit` with each object that may have a point strictly between the apex and another point, until it answers
    /// `true`, and tells whether it did; `None` when the error is too large to tell which objects those are. An object may
    /// come several times.
    ///
    /// `to_point`: from the apex to the other point. `error`: how far each of its coordinates may be off.
    pub fn visit(&self, to_point: [f64; 3], error: f64, mut visit: impl FnMut(Object) -> bool) -> Option<bool> {
        let (face, query) = query(to_point, error)?;
        Some(self.faces[face].visit(&query, &mut |i| visit(self.object(i))))
    }
}

/// Where a segment from the apex looks, or several that look into the same cells.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    face: usize,
    query: Query,
}

/// How memory is asked for before it is needed; nothing depends on it but time.
pub trait Expect {
    /// Learns that an element will be looked at soon, perhaps.
    fn expect<T>(items: &[T], i: usize);
}

impl Look {
    /// A segment must lead this many times as far as it is off, 2¹³: then its slopes are off by less than 2⁻¹¹.
    pub const MIN_PRECISION: f64 = 8192.0;

    /// Segments that lead less far are not looked up: their error bounds could underflow.
    pub const SHORTEST: f64 = f64::from_bits((1023 - 500) << 52);
}

impl Cube {
    /// Calls `add` with where to look for what lies between the apex and some points, in as few looks as possible; `None`
    /// when an error is too large to tell.
    ///
    /// `points`: from the apex to each point, and how far each of its coordinates may be off.
    #[inline]
    pub fn looks(&self, points: impl Iterator<Item = ([f64; 3], f64)>, mut add: impl FnMut(Look)) -> Option<()> {
        let mut last: Option<Look> = None;
        for (to_point, error) in points {
            let (face, query) = query(to_point, error)?;
            let both = last.filter(|last| last.face == face).map(|last| Look { face, query: last.query.and(&query) });
            let together = both.filter(|both| self.faces[face].is_narrow(&both.query));
            if together.is_none() {
                last.into_iter().for_each(&mut add);
            }
            last = Some(together.unwrap_or(Look { face, query }));
        }
        last.into_iter().for_each(add);
        Some(())
    }

    /// Returns where to look for what lies between the apex and some points, given what is seen of all of them through one
    /// face; `None` when they are too far apart to be looked up as one.
    #[inline]
    pub fn look_at_once(&self, CubeFace(face): CubeFace, sight: Slopes<f64>) -> Option<Look> {
        let query = sight.query();
        self.faces[face].is_narrow(&query).then_some(Look { face, query })
    }

    /// Asks for the cells of a look.
    #[inline]
    pub fn expect_cells<E: Expect>(&self, look: &Look) {
        self.faces[look.face].first_grid(&look.query).expect_cell::<E>(&look.query);
    }

    /// Asks for what is in the cells of a look.
    #[inline]
    pub fn expect_records<E: Expect>(&self, look: &Look) {
        self.faces[look.face].first_grid(&look.query).expect_records::<E>(&look.query);
    }

    /// Calls `visit` with each object that may have a point strictly between the apex and one of the points of a look, and
    /// with some that lie beside. An object may come several times.
    #[inline]
    pub fn visit_look(&self, look: &Look, mut visit: impl FnMut(Object)) {
        self.faces[look.face].visit(&look.query, &mut |i| {
            visit(self.object(i));
            false
        });
    }

    /// Returns the object of an index that counts spheres first.
    fn object(&self, i: u32) -> Object {
        match i.checked_sub(self.n_spheres) {
            None => Object::Sphere(i),
            Some(i) => Object::Cylinder(i),
        }
    }
}

/// Returns the face that a segment from the apex goes through, and where.
#[inline]
fn query(to_point: [f64; 3], error: f64) -> Option<(usize, Query)> {
    let face = CubeFace::toward(to_point);
    let way = face.look(to_point);
    let ahead = way[2];
    // Also false for what is no number.
    if !(ahead >= Look::MIN_PRECISION * error && ahead >= Look::SHORTEST && ahead.is_finite()) {
        return None;
    }
    Some((face.0, Slopes::new(way, error, ROUNDOFF, |number| number).query()))
}

/// A range that holds nothing.
const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

impl Face {
    /// Calls `visit` with each object whose outline holds the query until it answers `true`, and tells whether it did.
    fn visit(&self, query: &Query, visit: &mut impl FnMut(u32) -> bool) -> bool {
        self.grids[self.strips_of(query)].iter().any(|grid| grid.visit(query, visit))
    }

    /// Returns the first strip that a query looks into.
    fn first_grid(&self, query: &Query) -> &Grid {
        &self.grids[*self.strips_of(query).start()]
    }

    /// Tells whether a query looks into few cells, all of one strip.
    fn is_narrow(&self, query: &Query) -> bool {
        let strips = self.strips_of(query);
        strips.start() == strips.end() && self.grids[*strips.start()].is_narrow(query, MAX_CELLS_AT_ONCE)
    }

    /// Returns the strips that a query looks into.
    fn strips_of(&self, query: &Query) -> RangeInclusive<usize> {
        self.strips_between(query.low[1], query.high[1])
    }

    /// Returns the strips between two slopes.
    #[inline]
    fn strips_between(&self, low: f64, high: f64) -> RangeInclusive<usize> {
        cell(self.strips.place(low))..=cell(self.strips.place(high))
    }

    /// Cuts a face into strips, given what is seen of each `step`-th object.
    ///
    /// What the others reach beyond is counted to the ends; that must be little, so few samples choose nothing.
    fn new(samples: &[Spot], step: usize) -> Self {
        let range = |k: usize| {
            samples.iter().fold(NOTHING, |[low, high], spot| {
                [low.min(f64::from(spot.low[k]).max(-LIMIT)), high.max(f64::from(spot.high[k]).min(LIMIT))]
            })
        };
        let [width, height] = match samples.len() {
            0 if step == 1 => [[0.0; 2]; 2],
            ..MIN_SAMPLES if step > 1 => [[-LIMIT, LIMIT]; 2],
            _ => [range(0), range(1)],
        };
        let n_strips = match samples.len() * step {
            ..STRIPS_FROM => 1,
            _ => STRIPS_PER_THREAD * rayon::current_num_threads() as u32,
        };
        Self { strips: Axis::new(height, n_strips), width, grids: Vec::new() }
    }
}

/// Cuts the faces into strips by what is seen of some objects.
fn choose_strips(scene: &Scene<'_>, apex: [f64; 3], n_objects: usize) -> [Face; CubeFace::N] {
    let step = n_objects / N_SAMPLES + 1;
    let mut samples = [const { Vec::new() }; CubeFace::N];
    let mut add = |face: usize, spot| samples[face].push(spot);
    match step {
        1 => for_each_spot(scene, apex, 0..n_objects, add),
        _ => (0..n_objects).step_by(step).for_each(|i| for_each_spot(scene, apex, i..i + 1, &mut add)),
    }
    samples.map(|samples| Face::new(&samples, step))
}

/// Appends to a list that is either long or empty.
#[inline]
fn push(list: &mut Vec<Spot>, spot: Spot) {
    if list.capacity() == 0 {
        list.reserve(OBJECTS_PER_TASK);
    }
    list.push(spot);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DoubleDouble;
    use crate::plan::{CylinderLanes, SphereLanes};
    use crate::testing::Stream;

    #[test]
    fn a_face_is_looked_at_along_its_largest_coordinate() {
        for (face, to_point) in
            [[3.0, 1.0, 2.0], [-3.0, 1.0, 2.0], [1.0, 3.0, 2.0], [1.0, -3.0, 2.0], [2.0, 1.0, 3.0], [2.0, -1.0, -3.0]]
                .into_iter()
                .enumerate()
        {
            let (found, query) = query(to_point, 1e-12).expect("precise enough");
            assert_eq!(found, face);
            let slopes = CubeFace(face).look(to_point);
            for k in 0..2 {
                let slope = slopes[k] / slopes[2];
                assert!(query.low[k] < slope && slope < query.high[k] && query.high[k] - query.low[k] < 1e-11);
            }
            assert!(query.far > 3.0 && query.far < 3.001);
        }
        assert!(query([1.0, 0.5, 0.5], 1e-3).is_none() && query([0.0; 3], 0.0).is_none());
        assert!(query([f64::NAN; 3], 0.0).is_none() && query([1.0; 3], f64::INFINITY).is_none());
    }

    /// Whatever lies before one of the points is found when they are looked up together.
    #[test]
    fn together_points_find_what_each_finds() {
        let mut stream = Stream::new(32);
        let mut lanes = SphereLanes::default();
        for _ in 0..3000 {
            for lane in [&mut lanes.x, &mut lanes.y, &mut lanes.z] {
                lane.push(stream.between(-1.0, 1.0));
            }
            lanes.radius.push(libm::exp2(stream.between(-12.0, -3.0)));
        }
        let cube = Cube::new(&Scene::of_shapes(lanes, CylinderLanes::default()), [0.1, -0.3, 0.2]);
        for _ in 0..2000 {
            let middle = [0; 3].map(|_| stream.between(-2.0, 2.0));
            let spread = libm::exp2(stream.between(-15.0, 1.0));
            let mut one = || (middle.map(|c| c + spread * stream.between(-1.0, 1.0)), 1e-12);
            let points = [0; 6].map(|_| one());
            let (mut together, mut alone) = (Vec::new(), Vec::new());
            let mut is_precise = true;
            for (point, error) in points {
                is_precise &= cube.visit(point, error, |object| {
                    alone.push(object);
                    false
                }) == Some(false);
            }
            let mut looks = Vec::new();
            let seen = cube.looks(points.into_iter(), |look| looks.push(look));
            looks.iter().for_each(|look| cube.visit_look(look, |object| together.push(object)));
            assert_eq!(seen.is_some(), is_precise);
            assert!(!is_precise || alone.iter().all(|object| together.contains(object)));
        }
    }

    fn finds_one(cube: &Cube, apex: [f64; 3], point: [f64; 3]) -> bool {
        let to_point: [f64; 3] = std::array::from_fn(|k| point[k] - apex[k]);
        let error = to_point.map(f64::abs).into_iter().fold(0.0, f64::max) * ROUNDOFF;
        cube.visit(to_point, error, |_| true).unwrap_or(true)
    }

    /// The silhouette of a sphere, or of the wall of a cylinder, runs through the point, inside of it by a rounding.
    #[test]
    fn what_a_segment_grazes_is_found() {
        let mut stream = Stream::new(31);
        let mut n_tested = 0;
        for round in 0..250_000 {
            let mut vector = |size: f64| [0; 3].map(|_| size * stream.between(-1.0, 1.0));
            let (apex, point) = (vector(1.0), vector(1.0));
            let aside = vector(1.0);
            let size = libm::exp2(stream.between(-35.0, 1.0));
            let share = stream.between(0.01, 0.99);
            let center: [f64; 3] = std::array::from_fn(|k| apex[k] + share * (point[k] - apex[k]) + size * aside[k]);
            // Above and in the plane of the axis: a cylinder is a sphere that has no height.
            let is_sphere = round % 2 == 0;
            let exact = |a: f64, b: f64| DoubleDouble::sum(a, -b);
            let mut d: [_; 3] = std::array::from_fn(|k| exact(point[k], apex[k]));
            let mut m: [_; 3] = std::array::from_fn(|k| exact(center[k], apex[k]));
            if !is_sphere {
                (d[1], m[1]) = (DoubleDouble::ZERO, DoubleDouble::ZERO);
            }
            let cross: [_; 3] = std::array::from_fn(|k| {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                m[i] * d[j] - m[j] * d[i]
            });
            let squared = |a: [DoubleDouble; 3]| a[0].square() + a[1].square() + a[2].square();
            let radius = (squared(cross) / squared(d)).sqrt().hi().next_up();
            let along = ((m[0] * d[0] + m[1] * d[1] + m[2] * d[2]) / squared(d)).hi();
            if !(0.0..=1.0).contains(&along) || radius < 1e-9 * size {
                continue;
            }
            n_tested += 1;
            let height = apex[1] + along * (point[1] - apex[1]);
            let slack = 1e-15;
            let scene = match is_sphere {
                true => {
                    let [x, y, z] = center.map(|c| vec![c]);
                    Scene::of_shapes(SphereLanes { x, y, z, radius: vec![radius] }, CylinderLanes::default())
                }
                false => {
                    let [low, high] = [[height - slack, height + size], [height - size, height + slack]][round / 2 % 2];
                    let (x, z) = (vec![center[0]], vec![center[2]]);
                    let lanes = CylinderLanes { x, z, radius: vec![radius], y_min: vec![low], y_max: vec![high] };
                    Scene::of_shapes(SphereLanes::default(), lanes)
                }
            };
            let cube = Cube::new(&scene, apex);
            assert!(finds_one(&cube, apex, point), "{apex:?} {point:?} {center:?} {radius} {is_sphere}");
        }
        assert!(n_tested > 120_000);
    }
}
