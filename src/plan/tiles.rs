//! Which objects the eye rays of each tile of the image can meet.
//!
//! Each object is bounded by its outline as the eye sees it ([`Outline`]), and listed in every tile that holds a pixel with
//! a sample on or in that rectangle. So a tile lists every object that one of its eye rays meets: the outline holds all
//! slopes of points of the object that are ahead, an eye ray meets nothing that is not ahead, and [`Axis`] rounds outward
//! from slopes to pixels.

use std::ops::Range;

use rayon::prelude::*;

use crate::math::tan_half_degrees;
use crate::plan::apex::{BLOCK, Bins, Cells, Outline, Outlines, rounded_down};
use crate::plan::{Candidates, Pass, SampleAt, Scene, Settings, Size, SphereLanes};

/// No tile has more than 2⁶ columns or rows, however far its list reaches.
const MAX_SHIFT: u32 = 6;

/// The tiles of an image and what their eye rays can meet.
#[derive(Debug)]
pub struct Tiles {
    size: Size,
    shape: Shape,
    n_columns: usize,
    spheres: Bins,
    cylinders: Bins,
}

/// How far a list reaches: 2ᵘ columns of pixels and 2ᵛ rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shape {
    shifts: [u32; 2],
}

impl Tiles {
    /// Finds out what the eye rays of each tile can meet; when the pass is switched off, everything.
    pub(super) fn new(scene: &Scene<'_>, fov_deg: f64, settings: &Settings) -> Self {
        let size = settings.size;
        let [spheres, cylinders] = match settings.passes.contains(Pass::Tiles) {
            true => blocks_of_pixels(scene, fov_deg, settings),
            false => {
                let all = Cells { columns: [0, last_of(size.width())], rows: [0, last_of(size.height())], near: 0.0 };
                let all = |radii: &[f64]| (0..radii.len() as u32).map(|i| (i, all)).collect();
                [all(&scene.spheres.radius), all(&scene.cylinders.radius)]
            }
        };
        let shape = match settings.passes.contains(Pass::Tiles) {
            true => Shape::for_blocks(size, [&spheres, &cylinders]),
            false => Shape { shifts: Shape::LADDER[0] },
        };
        let grid = shape.grid(size);
        let bins = |blocks: &[Block]| Bins::new(blocks, grid, |cells| cells.coarser(shape.shifts));
        Self { size, shape, n_columns: grid[0] as usize, spheres: bins(&spheres), cylinders: bins(&cylinders) }
    }

    /// Returns the columns of a tile, a multiple of 8 and a power of two.
    #[must_use]
    pub fn width(&self) -> u32 {
        1 << self.shape.shifts[0].min(MAX_SHIFT)
    }

    /// Returns the rows of a tile, a power of two.
    #[must_use]
    pub fn height(&self) -> u32 {
        1 << self.shape.shifts[1].min(MAX_SHIFT)
    }

    /// Returns what the eye rays through the samples of a pixel's tile can meet, each kind in the order of the least
    /// depth, the coordinate −z, that it reaches; where those are equal to binary32, by index.
    #[must_use]
    pub fn candidates(&self, column: u32, row: u32) -> Candidates<'_> {
        debug_assert!(column < self.size.width() && row < self.size.height());
        let [u, v] = self.shape.shifts;
        let tile_idx = (row >> v) as usize * self.n_columns + (column >> u) as usize;
        Candidates { spheres: self.spheres.list(tile_idx), cylinders: self.cylinders.list(tile_idx) }
    }

    /// Tells whether the eye rays of all these rows are proved to meet nothing.
    #[must_use]
    pub fn are_empty(&self, rows: Range<u32>) -> bool {
        debug_assert!(rows.end <= self.size.height());
        let first = (rows.start >> self.shape.shifts[1]) as usize;
        let end = rows.end.div_ceil(1 << self.shape.shifts[1]) as usize;
        let tiles = first * self.n_columns..end.max(first) * self.n_columns;
        self.spheres.are_empty(tiles.clone()) && self.cylinders.are_empty(tiles)
    }
}

/// What it costs to make a tile, to list an object in it, to trace a packet of its pixels, and to test the packet against
/// a candidate: roughly in nanoseconds. They choose the size of a tile; no pixel depends on them.
mod cost {
    pub const TILE: f64 = 80.0;
    pub const LISTING: f64 = 6.0;
    pub const TEST: f64 = 3.0;
    pub const PACKET_WIDTH: f64 = 8.0;
}

/// The most tiles and indices in their lists: so many for each object, and so many besides.
const MAX_LISTINGS: [f64; 2] = [16.0, 4e6];

impl Shape {
    /// From everything in one tile to 8 columns and one row, as exponents.
    const LADDER: [[u32; 2]; 10] = [[16, 16], [8, 8], [6, 6], [6, 5], [6, 4], [5, 3], [4, 3], [3, 2], [3, 1], [3, 0]];

    /// Chooses the size of a tile by what tiles of that size will probably cost.
    ///
    /// A block of w×h pixels meets (w/W + 1)·(h/H + 1) tiles of W×H pixels at a random place: sums over 1, w, h and w·h
    /// give the length of all lists.
    fn for_blocks(size: Size, kinds: [&[Block]; 2]) -> Self {
        let [n, w, h, area] = add(extents(kinds[0]), extents(kinds[1])).map(|sum| sum as f64);
        let listings = |[columns, rows]: [f64; 2]| area / (columns * rows) + w / columns + h / rows + n;
        let n_tiles = |shape: &Self| shape.grid(size).map(f64::from).iter().product::<f64>();
        let is_affordable =
            |shape: &Self| n_tiles(shape) + listings(shape.extent()) <= n * MAX_LISTINGS[0] + MAX_LISTINGS[1];
        let cost = |shape: &Self| {
            let [columns, rows] = shape.extent();
            let n_packets = columns / cost::PACKET_WIDTH * rows;
            n_tiles(shape) * cost::TILE + listings([columns, rows]) * (cost::LISTING + n_packets * cost::TEST)
        };
        let shapes = Self::LADDER.iter().map(|&shifts| Self { shifts });
        let cheapest = shapes.filter(is_affordable).min_by(|a, b| cost(a).total_cmp(&cost(b)));
        cheapest.unwrap_or(Self { shifts: Self::LADDER[0] })
    }

    /// Returns columns and rows of a tile.
    fn extent(self) -> [f64; 2] {
        self.shifts.map(|shift| f64::from(1u32 << shift))
    }

    /// Returns how many columns and rows of tiles an image has.
    fn grid(self, size: Size) -> [u32; 2] {
        [size.width().div_ceil(1 << self.shifts[0]), size.height().div_ceil(1 << self.shifts[1])]
    }
}

/// Returns how many blocks there are, and the sums of their widths, heights and areas in pixels.
fn extents(blocks: &[Block]) -> [u64; 4] {
    let extent = |[first, last]: [u16; 2]| u64::from(last - first) + 1;
    let sum = |blocks: &[Block]| {
        let extents = blocks.iter().map(|(_, cells)| [extent(cells.columns), extent(cells.rows)]);
        extents.fold([0; 4], |sums, [w, h]| add(sums, [1, w, h, w * h]))
    };
    blocks.par_chunks(1 << 16).map(sum).reduce(|| [0; 4], add)
}

fn add(a: [u64; 4], b: [u64; 4]) -> [u64; 4] {
    std::array::from_fn(|k| a[k] + b[k])
}

/// An object by its index among those of its kind, and the block of pixels that have a sample on or in its outline.
type Block = (u32, Cells);

/// Returns the spheres, and the cylinders, in whose outlines there are samples.
fn blocks_of_pixels(scene: &Scene<'_>, fov_deg: f64, settings: &Settings) -> [Vec<Block>; 2] {
    let view = View::new(fov_deg, settings);
    let cylinders = &scene.cylinders;
    let add_cylinder = |i: usize, blocks: &mut Vec<Block>| {
        let heights = [cylinders.y_min[i], cylinders.y_max[i]];
        let outline = Outline::of_upright_cylinder([cylinders.x[i], -cylinders.z[i]], cylinders.radius[i], heights);
        view.add(i, outline, blocks);
    };
    let add_cylinders = |range: Range<usize>, blocks: &mut _| range.for_each(|i| add_cylinder(i, blocks));
    let add_spheres = |range: Range<usize>, blocks: &mut _| view.add_spheres(&scene.spheres, range, blocks);
    [collect(scene.spheres.radius.len(), add_spheres), collect(cylinders.radius.len(), add_cylinders)]
}

/// Objects a thread takes at a time.
const OBJECTS_PER_TASK: usize = 4096;

/// Calls `add` with all objects, some at a time, and returns what is added in their order.
fn collect(n_objects: usize, add: impl Fn(Range<usize>, &mut Vec<Block>) + Send + Sync) -> Vec<Block> {
    let some = |first: usize| {
        let mut blocks = Vec::new();
        add(first..n_objects.min(first + OBJECTS_PER_TASK), &mut blocks);
        blocks
    };
    let pieces: Vec<_> = (0..n_objects).into_par_iter().step_by(OBJECTS_PER_TASK).map(some).collect();
    pieces.concat()
}

/// What pixels the slopes of eye rays belong to.
struct View {
    columns: Axis,
    rows: Axis,
}

impl View {
    fn new(fov_deg: f64, settings: &Settings) -> Self {
        let (width, height) = (settings.size.width(), settings.size.height());
        let (k, _) = tan_half_degrees(fov_deg);
        let per_slope = if k.hi() > SMALLEST_TANGENT { f64::from(height) / (2.0 * k.hi()) } else { f64::NAN };
        Self { columns: Axis::new(width, per_slope, settings), rows: Axis::new(height, per_slope, settings) }
    }

    /// Returns the pixels with a sample on or in an outline, if there are some.
    #[inline]
    fn block(&self, outline: &Outline) -> Option<Cells> {
        let [across, [low, high]] = outline.slopes;
        let columns = self.columns.pixels(across)?;
        // Rows are counted downward.
        let rows = self.rows.pixels([-high, -low])?;
        Some(Cells { columns, rows, near: rounded_down(outline.near).max(0.0) })
    }

    /// Adds an object of this outline.
    #[inline]
    fn add(&self, i: usize, outline: Option<Outline>, blocks: &mut Vec<Block>) {
        blocks.extend(outline.and_then(|outline| self.block(&outline)).map(|cells| (i as u32, cells)));
    }

    /// Adds some spheres, side by side as far as that goes.
    fn add_spheres(&self, spheres: &SphereLanes, range: Range<usize>, blocks: &mut Vec<Block>) {
        let SphereLanes { x, y, z, radius } = spheres;
        let [x, y, z, radius] = [x, y, z, radius].map(|lane| lane[range.clone()].as_chunks::<BLOCK>());
        let alone = |[x, y, z]: [f64; 3], radius| Outline::of_sphere([x, y, -z], radius);
        for (k, (((x, y), z), radius)) in x.0.iter().zip(y.0).zip(z.0).zip(radius.0).enumerate() {
            let outlines = Outlines::of_spheres([x, y, &z.map(|z| -z)], radius);
            for i in 0..BLOCK {
                let outline = outlines.get(i).or_else(|| alone([x[i], y[i], z[i]], radius[i]));
                self.add(range.start + k * BLOCK + i, outline, blocks);
            }
        }
        let first = range.end - radius.1.len();
        for i in 0..radius.1.len() {
            self.add(first + i, alone([x.1[i], y.1[i], z.1[i]], radius.1[i]), blocks);
        }
    }
}

/// Fields of view with a smaller tangent than this, 2⁻⁹⁰⁰, see everything everywhere.
const SMALLEST_TANGENT: f64 = f64::from_bits((1023 - 900) << 52);

/// The pixels along a side of the image: a sample at the slope s lies at n/2 + s·H/2k, where pixel i has its upper left
/// corner at i.
struct Axis {
    n_pixels: u32,
    /// H/2k, of which the relative error is at most four roundings; NaN when nothing is known.
    per_slope: f64,
    /// Where in a pixel its first and its last sample lie, to a rounding.
    samples: [f64; 2],
}

impl Axis {
    fn new(n_pixels: u32, per_slope: f64, settings: &Settings) -> Self {
        let middle = match settings.sample_at {
            SampleAt::Corner => 0.0,
            SampleAt::Centre => 0.5,
        };
        let spread = 0.5 - 0.5 / f64::from(settings.samples);
        Self { n_pixels, per_slope, samples: [middle - spread, middle + spread] }
    }

    /// Returns the first and the last pixel with a sample at one of the slopes; `None` when there is none.
    ///
    /// Pixel i has one at the place p at most if i + first ≤ p ≤ i + last. Each place is off by at most eight roundings
    /// of |s·H/2k| and four of n + 1: less than is taken off here. What is no number is no bound.
    fn pixels(&self, [low, high]: [f64; 2]) -> Option<[u16; 2]> {
        let n_pixels = f64::from(self.n_pixels);
        let place = |slope: f64, outward: f64| {
            let offset = slope * self.per_slope;
            0.5 * n_pixels + offset + outward * (8.0 * f64::EPSILON) * (offset.abs() + n_pixels + 1.0)
        };
        let end = f64::from(self.n_pixels - 1);
        let (first, last) = (place(low, -1.0) - self.samples[1], place(high, 1.0) - self.samples[0]);
        if first > end || last < 0.0 {
            return None;
        }
        // Whole numbers by conversion: without SSE4 `ceil` and `floor` are calls.
        let below = first.max(0.0) as u16;
        let first = below + u16::from(f64::from(below) < first);
        let last = if last < end { last as u16 } else { last_of(self.n_pixels) };
        (first <= last).then_some([first, last])
    }
}

/// Returns the last of so many pixels, of which there is one at least.
fn last_of(n_pixels: u32) -> u16 {
    (n_pixels - 1) as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DoubleDouble;
    use crate::plan::{CylinderLanes, SphereLanes};
    use crate::testing::Stream;

    fn pick<T: Copy>(stream: &mut Stream, from: &[T]) -> T {
        from[stream.below(from.len())]
    }

    fn random_settings(stream: &mut Stream) -> Settings {
        let side = |stream: &mut Stream| pick(stream, &[1, 7, 64, 301, 4000, 65535]);
        Settings {
            size: Size::new(side(stream), side(stream)).expect("a size within the limits"),
            samples: pick(stream, &[1, 1, 2, 3, 16]),
            sample_at: pick(stream, &[SampleAt::Corner, SampleAt::Centre]),
            ..Settings::default()
        }
    }

    /// A sample of a pixel with the slopes of its eye ray.
    struct Sample {
        pixel: [u32; 2],
        slopes: [DoubleDouble; 2],
    }

    /// Picks a sample and returns its eye ray as the semantics have it.
    fn random_sample(stream: &mut Stream, fov_deg: f64, settings: &Settings) -> Sample {
        let (k, _) = tan_half_degrees(fov_deg);
        let [width, height] = [settings.size.width(), settings.size.height()];
        let pixel = [stream.below(width as usize) as u32, stream.below(height as usize) as u32];
        let n = i64::from(settings.samples);
        let anchor = if settings.sample_at == SampleAt::Centre { n } else { 0 };
        let mut place = |pixel: u32, n_pixels: u32| {
            let sample = 2 * stream.below(n as usize) as i64 + 1 - n;
            (2 * i64::from(pixel) - i64::from(n_pixels)) * n + anchor + sample
        };
        let slope = |steps: i64| k * steps as f64 / DoubleDouble::from((n * i64::from(height)) as f64);
        let slopes = [slope(place(pixel[0], width)), slope(-place(pixel[1], height))];
        Sample { pixel, slopes }
    }

    fn assert_holds(blocks: &[Block], sample: &Sample, what: &str) {
        let [(0, cells)] = blocks else { panic!("{what}: {blocks:?}") };
        let [column, row] = sample.pixel.map(|i| i as u16);
        let holds = |[first, last]: [u16; 2], i: u16| first <= i && i <= last;
        assert!(holds(cells.columns, column) && holds(cells.rows, row), "{what}: {cells:?} {row} {column}");
    }

    /// The silhouette of the sphere runs through the sample, inside of it by a few roundings.
    #[test]
    fn spheres_that_a_sample_grazes_are_listed() {
        let mut stream = Stream::new(21);
        for _ in 0..40_000 {
            let settings = random_settings(&mut stream);
            let fov_deg = pick(&mut stream, &[0.0002, 1.0, 60.0, 90.0, 175.0, 179.9]);
            let sample = random_sample(&mut stream, fov_deg, &settings);
            let [u, v] = sample.slopes;
            // A point on the ray, and a centre somewhere beside it.
            let depth = libm::exp2(stream.between(-30.0, 0.0));
            let size = depth * libm::exp2(stream.between(-40.0, 2.0));
            let mut aside = |slope: DoubleDouble| (slope * depth).hi() + size * stream.between(-1.0, 1.0);
            let (x, y, z) = (aside(u), aside(v), aside(DoubleDouble::ONE));
            // (m × d)² / d² with d = (u, v, 1).
            let cross = [DoubleDouble::from(y) - v * z, u * z - DoubleDouble::from(x), v * x - u * y];
            let squared = |a: [DoubleDouble; 3]| a[0].square() + a[1].square() + a[2].square();
            let distance = (squared(cross) / squared([u, v, DoubleDouble::ONE])).sqrt();
            let is_ahead = (u * x + v * y + DoubleDouble::from(z)).hi() > 0.0;
            let radius = distance.hi().next_up();
            if !is_ahead || radius < size * 1e-9 {
                continue;
            }
            let mut scene = Scene::of_shapes(SphereLanes::default(), CylinderLanes::default());
            scene.spheres = SphereLanes { x: vec![x], y: vec![y], z: vec![-z], radius: vec![radius] };
            let [spheres, _] = blocks_of_pixels(&scene, fov_deg, &settings);
            assert_holds(&spheres, &sample, "sphere");
        }
    }

    /// The wall is grazed as a sphere is; the ray meets the cap, or the rim, a rounding inside.
    #[test]
    fn cylinders_that_a_sample_grazes_are_listed() {
        let mut stream = Stream::new(22);
        for _ in 0..40_000 {
            let settings = random_settings(&mut stream);
            let fov_deg = pick(&mut stream, &[0.0002, 1.0, 60.0, 90.0, 175.0]);
            let sample = random_sample(&mut stream, fov_deg, &settings);
            let [u, v] = sample.slopes;
            let depth = libm::exp2(stream.between(-30.0, 0.0));
            let size = depth * libm::exp2(stream.between(-40.0, 2.0));
            let (x, z) =
                ((u * depth).hi() + size * stream.between(-1.0, 1.0), depth + size * stream.between(-1.0, 1.0));
            let across = (u * z - DoubleDouble::from(x)) / (u.square() + DoubleDouble::ONE).sqrt();
            let radius = across.hi().abs().next_up();
            // Where the ray touches the wall; the cylinder just reaches that height from above or below.
            let t = (u * x + DoubleDouble::from(z)) / (u.square() + DoubleDouble::ONE);
            let height = (v * t.hi()).hi();
            if t.hi() <= 0.0 || radius < size * 1e-9 {
                continue;
            }
            let slack = 1e-15 * height.abs() + 1e-15 * v.hi().abs() * size;
            let (y_min, y_max) = match stream.below(2) {
                0 => (height - size, height + slack),
                _ => (height - slack, height + size),
            };
            let mut scene = Scene::of_shapes(SphereLanes::default(), CylinderLanes::default());
            scene.cylinders =
                CylinderLanes { x: vec![x], z: vec![-z], radius: vec![radius], y_min: vec![y_min], y_max: vec![y_max] };
            let [_, cylinders] = blocks_of_pixels(&scene, fov_deg, &settings);
            assert_holds(&cylinders, &sample, "cylinder");
        }
    }

    #[test]
    fn a_tile_lists_what_its_pixels_see_in_the_order_of_depth() {
        let mut stream = Stream::new(23);
        for n_objects in [0, 1, 5, 300, 20_000] {
            let mut lane = |low: f64, high: f64| (0..n_objects).map(|_| stream.between(low, high)).collect::<Vec<_>>();
            let mut scene = Scene::of_shapes(SphereLanes::default(), CylinderLanes::default());
            let size = 0.5 / libm::sqrt(n_objects as f64 + 1.0);
            scene.spheres = SphereLanes {
                x: lane(-1.0, 1.0),
                y: lane(-1.0, 1.0),
                z: lane(-2.0, 0.5),
                radius: lane(0.1 * size, size),
            };
            let settings =
                Settings { size: Size::new(333, 217).expect("a size within the limits"), ..Settings::default() };
            let [blocks, _] = blocks_of_pixels(&scene, 70.0, &settings);
            let tiles = Tiles::new(&scene, 70.0, &settings);
            for (row, column) in (0..217).flat_map(|row| (0..333).map(move |column| (row, column))) {
                let listed = tiles.candidates(column, row).spheres;
                let block = |i: &u32| blocks.binary_search_by_key(i, |(i, _)| *i).expect("listed is what has a block");
                assert!(listed.is_sorted_by_key(|i| blocks[block(i)].1.near));
                if n_objects <= 5 {
                    let is_seen = |block: &Cells| {
                        (u32::from(block.columns[0])..=u32::from(block.columns[1])).contains(&column)
                            && (u32::from(block.rows[0])..=u32::from(block.rows[1])).contains(&row)
                    };
                    (blocks.iter().filter(|(_, block)| is_seen(block))).for_each(|(i, _)| assert!(listed.contains(i)));
                }
            }
            let is_row_empty = |row: &u32| (0..333).all(|column| tiles.candidates(column, *row).is_empty());
            assert!((0..217).filter(|row| tiles.are_empty(*row..row + 1)).all(|row| is_row_empty(&row)));
            assert_eq!(tiles.are_empty(0..217), n_objects == 0);
        }
    }

    #[test]
    fn without_the_pass_every_tile_lists_everything() {
        let mut scene = Scene::of_shapes(SphereLanes::default(), CylinderLanes::default());
        scene.spheres = SphereLanes { x: vec![0.0; 3], y: vec![0.0; 3], z: vec![9.0; 3], radius: vec![1.0; 3] };
        let all = Settings::default();
        let none = Settings { passes: all.passes.without(Pass::Tiles), ..all.clone() };
        assert_eq!(Tiles::new(&scene, 60.0, &none).candidates(17, 250).spheres, [0, 1, 2]);
        assert!(Tiles::new(&scene, 60.0, &all).are_empty(0..300), "behind the eye");
    }

    /// Everything everywhere would be 2³² indices and more.
    #[test]
    fn a_crowd_around_the_eye_is_listed_once() {
        let n = 300_000;
        let mut scene = Scene::of_shapes(SphereLanes::default(), CylinderLanes::default());
        scene.spheres = SphereLanes { x: vec![0.0; n], y: vec![0.0; n], z: vec![0.0; n], radius: vec![1.0; n] };
        let size = Size::new(20_000, 20_000).expect("a size within the limits");
        let tiles = Tiles::new(&scene, 60.0, &Settings { size, ..Settings::default() });
        assert_eq!(tiles.candidates(0, 19_999).len(), n);
        assert_eq!([tiles.width(), tiles.height()], [64, 64]);
    }
}
