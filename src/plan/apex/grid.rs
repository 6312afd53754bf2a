//! Grids of records: which of many outlines hold a point.
//!
//! A grid cuts a window of the plane into cells of some [`PER_CELL`] records each. What covers many cells is kept apart,
//! and a crowded cell is a grid of its own, so that clusters, giants and dust all find cells of their size.
//!
//! # Why nothing is lost to rounding
//! Outlines and queries come to places through one function, [`Axis::place`], and to shares of a cell through whole
//! numbers. Both are monotone: an outline from a to b holds a query from c to d when a ≤ d and c ≤ b, and then the same is
//! true of their places, whatever was rounded on the way. Likewise for depths, of which the leading bits are kept.

use std::mem;
use std::ops::Range;

use crate::plan::apex::cube::Expect;

/// Bits of a place within its cell.
const SHARE_BITS: u32 = 11;

/// The last place within a cell.
const LAST_SHARE: u32 = (1 << SHARE_BITS) - 1;

/// Records aimed at in each cell: two registers of 8, or one line of memory and its neighbour.
const PER_CELL: usize = 12;

/// A cell with more records becomes a grid.
const CROWD: usize = 4 * PER_CELL;

/// An outline that covers more cells is kept apart.
const MAX_CELLS: usize = 16;

/// How many records an outline may become on the average.
const MAX_GROWTH: f64 = 2.5;

/// Outlines that are looked at to choose the cells.
const N_SAMPLES: usize = 1024;

/// Grids within grids.
const MAX_DEPTH: u32 = 6;

/// Columns and rows of a grid: their places fit 32 bits.
const MAX_SIDE: f64 = 8192.0;

/// Numbers of binary64 from here on, 2⁵², to twice as much are whole.
const WHOLE: f64 = (1u64 << 52) as f64;

/// A bound of what an apex sees of an object through one face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// The least slopes.
    pub low: [f32; 2],
    /// The largest slopes.
    pub high: [f32; 2],
    /// Not above the least coordinate ahead.
    pub near: f32,
    /// Whose it is.
    pub object: u32,
}

/// What may lie on a segment from the apex: at a slope between two, and not deeper than its end.
#[derive(Clone, Copy, Debug)]
pub struct Query {
    /// The least slopes.
    pub low: [f64; 2],
    /// The largest slopes.
    pub high: [f64; 2],
    /// At least the coordinate ahead of the segment's end.
    pub far: f32,
}

impl Query {
    /// Returns a query that holds both.
    pub fn and(&self, other: &Self) -> Self {
        Self {
            low: std::array::from_fn(|k| self.low[k].min(other.low[k])),
            high: std::array::from_fn(|k| self.high[k].max(other.high[k])),
            far: self.far.max(other.far),
        }
    }
}

/// A side of a grid, cut into cells and those into places.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    low: f64,
    places_per_slope: f64,
    last: f64,
}

impl Axis {
    /// Cuts a range into `n_cells`.
    pub fn new([low, high]: [f64; 2], n_cells: u32) -> Self {
        let n_places = f64::from(n_cells << SHARE_BITS);
        let places_per_slope = n_places / (high - low);
        let places_per_slope = if places_per_slope.is_finite() { places_per_slope } else { 0.0 };
        Self { low, places_per_slope, last: n_places - 1.0 }
    }

    /// Returns the place of a slope; what is outside of the range is at its end.
    #[inline]
    pub fn place(&self, slope: f64) -> u32 {
        // What is no number is at the first. The sum is rounded to a whole number, in its lowest bits.
        let place = ((slope - self.low) * self.places_per_slope).max(0.0).min(self.last);
        (place + WHOLE).to_bits() as u32
    }

    /// Returns the number of cells.
    pub fn cells(&self) -> usize {
        (self.last as usize >> SHARE_BITS) + 1
    }

    /// Returns the range of slopes of a cell, to a rounding; of the only cell of a range that is one number that number.
    pub fn range(&self, cell: usize) -> [f64; 2] {
        if self.places_per_slope == 0.0 {
            return [self.low; 2];
        }
        [cell, cell + 1].map(|cell| self.low + (cell << SHARE_BITS) as f64 / self.places_per_slope)
    }
}

/// Returns the cell of a place.
#[inline]
pub(super) fn cell(place: u32) -> usize {
    (place >> SHARE_BITS) as usize
}

/// Five numbers that are compared at once, each below a bit that is set in a query and clear in a record: the depth and
/// the shares of a cell where the outline begins and, counted backward, where it ends.
mod record {
    use super::LAST_SHARE;

    /// The bits between the numbers.
    const GUARDS: u64 = 1 << 63 | 1 << 47 | 1 << 35 | 1 << 23 | 1 << 11;

    /// Packs an outline.
    #[inline]
    pub fn new(low: [u32; 2], high: [u32; 2], near: f32) -> u64 {
        pack(low, high.map(|share| LAST_SHARE - share), near)
    }

    /// Packs a query.
    #[inline]
    pub fn query(low: [u32; 2], high: [u32; 2], far: f32) -> u64 {
        pack(high, low.map(|share| LAST_SHARE - share), far) | GUARDS
    }

    /// Depths keep the 15 bits behind the sign: truncation is monotone.
    #[inline]
    fn pack(first: [u32; 2], second: [u32; 2], depth: f32) -> u64 {
        u64::from(depth.to_bits() >> 16) << 48
            | u64::from(first[0]) << 36
            | u64::from(first[1]) << 24
            | u64::from(second[0]) << 12
            | u64::from(second[1])
    }

    /// Tells whether each number of the query is at least that of the record: then no difference borrows its guard.
    #[inline]
    pub fn is_held(query: u64, record: u64) -> bool {
        (query - record) & GUARDS == GUARDS
    }
}

/// A list of records, or a grid.
#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    start: u32,
    /// [`Cell::GRID`] when `start` is the place of a grid.
    len: u32,
}

impl Cell {
    const GRID: u32 = u32::MAX;

    /// Makes the list one longer and returns the place of its new end.
    fn push(&mut self) -> usize {
        self.len += 1;
        (self.start + self.len - 1) as usize
    }

    fn records(self) -> Range<usize> {
        self.start as usize..self.start as usize + self.len as usize
    }
}

/// One grid of a tree.
#[derive(Debug)]
struct Node {
    axes: [Axis; 2],
    first_cell: usize,
    /// What covers many cells, with places in the whole grid cut to shares.
    large: Cell,
    /// By how many bits places in the whole grid are cut.
    large_shift: u32,
}

/// Grids within grids over one window.
#[derive(Debug, Default)]
pub(super) struct Grid {
    nodes: Vec<Node>,
    cells: Vec<Cell>,
    records: Vec<u64>,
    /// Whose each record is.
    objects: Vec<u32>,
}

impl Grid {
    /// Sorts outlines, some parts of them, into a grid over their window.
    pub fn new(parts: &[&[Spot]], window: [[f64; 2]; 2]) -> Self {
        let mut grid = Self::default();
        if parts.iter().all(|part| part.is_empty()) {
            return grid;
        }
        grid.add_node(parts, window, 0);
        grid
    }

    /// Calls `visit` with each object whose outline holds the query until it answers `true`, and tells whether it did. An
    /// object may come several times.
    pub fn visit(&self, query: &Query, visit: &mut impl FnMut(u32) -> bool) -> bool {
        !self.nodes.is_empty() && self.visit_node(0, query, visit)
    }

    /// Tells whether a query looks into at most so many cells, of grids within grids too.
    pub fn is_narrow(&self, query: &Query, max_cells: usize) -> bool {
        self.nodes.is_empty() || self.count_cells(0, query, max_cells) <= max_cells
    }

    /// Returns into how many cells of a node a query looks, if they are at most `max_cells`; otherwise a larger number.
    fn count_cells(&self, node_idx: usize, query: &Query, max_cells: usize) -> usize {
        let node = &self.nodes[node_idx];
        let [columns, rows] = [0, 1].map(|k| {
            let [first, last] = [query.low[k], query.high[k]].map(|slope| cell(node.axes[k].place(slope)));
            first..=last
        });
        if columns.clone().count() * rows.clone().count() > max_cells {
            return usize::MAX;
        }
        let n_columns = node.axes[0].cells();
        let mut n_cells: usize = 0;
        for at in rows.flat_map(|row| columns.clone().map(move |column| row * n_columns + column)) {
            let found = self.cells[node.first_cell + at];
            n_cells = n_cells.saturating_add(match found.len {
                Cell::GRID => self.count_cells(found.start as usize, query, max_cells),
                _ => 1,
            });
        }
        n_cells
    }

    /// Asks for the first cell that a query looks into.
    #[inline]
    pub fn expect_cell<E: Expect>(&self, query: &Query) {
        if let Some(cell) = self.first_cell(query) {
            E::expect(&self.cells, cell);
        }
    }

    /// Asks for what is in the first cell that a query looks into.
    #[inline]
    pub fn expect_records<E: Expect>(&self, query: &Query) {
        match self.first_cell(query).map(|cell| self.cells[cell]) {
            Some(Cell { start, len: Cell::GRID }) => E::expect(&self.nodes, start as usize),
            Some(list) if list.len > 0 => {
                let Range { start, end } = list.records();
                E::expect(&self.records, start);
                E::expect(&self.records, end - 1);
                E::expect(&self.objects, start);
            }
            _ => {}
        }
    }

    /// Returns the place of the first cell that a query looks into.
    #[inline]
    fn first_cell(&self, query: &Query) -> Option<usize> {
        let node = self.nodes.first()?;
        let [column, row] = [0, 1].map(|k| cell(node.axes[k].place(query.low[k])));
        Some(node.first_cell + row * node.axes[0].cells() + column)
    }

    fn visit_node(&self, node_idx: usize, query: &Query, visit: &mut impl FnMut(u32) -> bool) -> bool {
        let node = &self.nodes[node_idx];
        let low: [u32; 2] = std::array::from_fn(|k| node.axes[k].place(query.low[k]));
        let high: [u32; 2] = std::array::from_fn(|k| node.axes[k].place(query.high[k]));
        let cut = |place: u32| place >> node.large_shift;
        if node.large.len > 0 && self.scan(node.large, record::query(low.map(cut), high.map(cut), query.far), visit) {
            return true;
        }
        let n_columns = node.axes[0].cells();
        for row in cell(low[1])..=cell(high[1]) {
            for column in cell(low[0])..=cell(high[0]) {
                let found = self.cells[node.first_cell + row * n_columns + column];
                let is_met = if found.len == Cell::GRID {
                    self.visit_node(found.start as usize, query, visit)
                } else {
                    let (from, to) = shares([column, row], low, high);
                    self.scan(found, record::query(from, to, query.far), visit)
                };
                if is_met {
                    return true;
                }
            }
        }
        false
    }

    #[inline]
    fn scan(&self, list: Cell, query: u64, visit: &mut impl FnMut(u32) -> bool) -> bool {
        let range = list.records();
        let records = self.records[range.clone()].iter().zip(&self.objects[range]);
        for (&record, &object) in records {
            if record::is_held(query, record) && visit(object) {
                return true;
            }
        }
        false
    }

    /// Adds the grid of a window and returns its place.
    fn add_node(&mut self, parts: &[&[Spot]], window: [[f64; 2]; 2], depth: u32) -> usize {
        let axes = cut_window(parts, window);
        let n_cells = axes.map(|axis| axis.cells());
        let large_shift = n_cells[0].max(n_cells[1]).next_power_of_two().trailing_zeros();
        let (node_idx, first_cell) = (self.nodes.len(), self.cells.len());
        self.cells.resize(first_cell + n_cells[0] * n_cells[1], Cell::default());
        let mut large = self.make_room(parts, &axes, first_cell, depth);
        let mut crowds: Vec<Vec<Spot>> = Vec::new();
        large.len = 0;
        for spot in parts.iter().copied().flatten() {
            let places = places(spot, &axes);
            let block = Block::between(places);
            if block.is_large() {
                let [low, high] = places.map(|places| places.map(|place| place >> large_shift));
                self.put(large.push(), record::new(low, high, spot.near), spot.object);
                continue;
            }
            block.for_each(|at| {
                let found = &mut self.cells[first_cell + at[1] * n_cells[0] + at[0]];
                if found.len == Cell::GRID {
                    let crowd_idx = found.start as usize;
                    crowds.resize_with(crowds.len().max(crowd_idx + 1), Vec::new);
                    crowds[crowd_idx].push(*spot);
                } else {
                    let (from, to) = shares(at, places[0], places[1]);
                    let at = found.push();
                    self.put(at, record::new(from, to, spot.near), spot.object);
                }
            });
        }
        self.nodes.push(Node { axes, first_cell, large, large_shift });
        self.add_crowds(node_idx, &crowds, depth);
        node_idx
    }

    /// Makes room for the records of a node, by counting, and numbers the cells that are to be grids; returns where those
    /// lie that are kept apart.
    fn make_room(&mut self, parts: &[&[Spot]], axes: &[Axis; 2], first_cell: usize, depth: u32) -> Cell {
        let n_columns = axes[0].cells();
        let cells = &mut self.cells[first_cell..];
        let mut large = Cell { start: self.records.len() as u32, len: 0 };
        for spot in parts.iter().copied().flatten() {
            let block = Block::between(places(spot, axes));
            if block.is_large() {
                large.len += 1;
            } else {
                block.for_each(|[column, row]| cells[row * n_columns + column].len += 1);
            }
        }
        let may_nest = depth < MAX_DEPTH && cells.len() > 1;
        let mut n_crowds = 0;
        let mut n_records = large.start as usize + large.len as usize;
        for cell in cells {
            if may_nest && cell.len as usize > CROWD {
                *cell = Cell { start: n_crowds, len: Cell::GRID };
                n_crowds += 1;
            } else {
                cell.start = u32::try_from(n_records).expect("fewer than 2^32 records");
                n_records += mem::take(&mut cell.len) as usize;
            }
        }
        if self.records.is_empty() {
            // Room that is known to be zero is not touched before it is written to.
            (self.records, self.objects) = (vec![0; n_records], vec![0; n_records]);
        } else {
            self.records.resize(n_records, 0);
            self.objects.resize(n_records, 0);
        }
        large
    }

    fn put(&mut self, at: usize, record: u64, object: u32) {
        self.records[at] = record;
        self.objects[at] = object;
    }

    /// Adds the grids of the crowded cells of a node.
    fn add_crowds(&mut self, node_idx: usize, crowds: &[Vec<Spot>], depth: u32) {
        if crowds.is_empty() {
            return;
        }
        let Node { axes, first_cell, .. } = self.nodes[node_idx];
        let n_columns = axes[0].cells();
        for i in 0..n_columns * axes[1].cells() {
            if self.cells[first_cell + i].len == Cell::GRID {
                let at = [i % n_columns, i / n_columns];
                let window = std::array::from_fn(|k| axes[k].range(at[k]));
                let crowd = &crowds[self.cells[first_cell + i].start as usize];
                self.cells[first_cell + i].start = self.add_node(&[crowd], window, depth + 1) as u32;
            }
        }
    }
}

/// Returns the first and the last place of an outline.
#[inline]
fn places(spot: &Spot, [columns, rows]: &[Axis; 2]) -> [[u32; 2]; 2] {
    let [low, high] = [spot.low, spot.high];
    [
        [columns.place(low[0].into()), rows.place(low[1].into())],
        [columns.place(high[0].into()), rows.place(high[1].into())],
    ]
}

/// Returns the shares of a cell that lie between two places.
#[inline]
fn shares(at: [usize; 2], low: [u32; 2], high: [u32; 2]) -> ([u32; 2], [u32; 2]) {
    let share = |k: usize, place: u32, beyond: u32| if cell(place) == at[k] { place & LAST_SHARE } else { beyond };
    (std::array::from_fn(|k| share(k, low[k], 0)), std::array::from_fn(|k| share(k, high[k], LAST_SHARE)))
}

/// The cells of an outline: the first column and row, and the last.
#[derive(Clone, Copy)]
struct Block {
    first: [usize; 2],
    last: [usize; 2],
}

impl Block {
    /// Returns the cells between two places.
    #[inline]
    fn between([low, high]: [[u32; 2]; 2]) -> Self {
        Self { first: low.map(cell), last: high.map(cell) }
    }

    fn n_cells(self) -> usize {
        (self.last[0] - self.first[0] + 1) * (self.last[1] - self.first[1] + 1)
    }

    /// Tells whether what covers these cells is kept apart.
    fn is_large(self) -> bool {
        self.n_cells() > MAX_CELLS
    }

    /// Calls `visit` with each cell.
    #[inline]
    fn for_each(self, mut visit: impl FnMut([usize; 2])) {
        // Most outlines lie in one cell.
        if self.first == self.last {
            return visit(self.first);
        }
        for row in self.first[1]..self.last[1] + 1 {
            for column in self.first[0]..self.last[0] + 1 {
                visit([column, row]);
            }
        }
    }
}

/// Chooses the cells of a window so that a cell has about as many records as it should, and the outlines, of which some
/// are looked at, do not become too many records.
fn cut_window(parts: &[&[Spot]], window: [[f64; 2]; 2]) -> [Axis; 2] {
    debug_assert!(window.as_flattened().iter().all(|end| end.is_finite()));
    let [width, height] = window.map(|[low, high]| high - low);
    let n_spots: usize = parts.iter().map(|part| part.len()).sum();
    let n_cells = (n_spots / PER_CELL).max(1) as f64;
    let mut side = libm::sqrt(width * height / n_cells).max(width.max(height) / n_cells.min(MAX_SIDE));
    let samples: Vec<_> = parts.iter().copied().flatten().step_by(n_spots / N_SAMPLES + 1).collect();
    loop {
        let n = |extent: f64| if side > 0.0 { (extent / side).ceil().clamp(1.0, MAX_SIDE) as u32 } else { 1 };
        let counts = [n(width), n(height)];
        let axes = [Axis::new(window[0], counts[0]), Axis::new(window[1], counts[1])];
        let n_records: usize = samples.iter().map(|spot| covered(places(spot, &axes))).sum();
        if counts == [1, 1] || n_records as f64 <= MAX_GROWTH * samples.len() as f64 {
            return axes;
        }
        side *= 1.5;
    }
}

/// Returns how many cells an outline is listed in; one that is kept apart is listed once.
fn covered(places: [[u32; 2]; 2]) -> usize {
    let block = Block::between(places);
    if block.is_large() { 1 } else { block.n_cells() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Stream;

    /// Outlines of all sizes, some of them in clusters, many at one place.
    fn random_spots(stream: &mut Stream, n: usize) -> Vec<Spot> {
        let spot = |object: u32| {
            let size = libm::exp2(stream.between(-20.0, -2.0)) as f32;
            let spread = [1.0, 1e-3, 1e-7][stream.below(3)];
            let middle = [0; 2].map(|_| (0.3 + spread * stream.between(-0.5, 0.5)) as f32);
            let extent = [0; 2].map(|_| size * stream.unit() as f32);
            let (low, high) = ([0, 1].map(|k| middle[k] - extent[k]), [0, 1].map(|k| middle[k] + extent[k]));
            Spot { low, high, near: stream.between(0.0, 9.0) as f32, object }
        };
        (0..n as u32).map(spot).collect()
    }

    #[test]
    fn a_query_finds_every_outline_that_holds_it() {
        for n in [1, 7, 500, 6000] {
            let mut stream = Stream::new(n as u64);
            let spots = random_spots(&mut stream, n);
            let grid = Grid::new(&[&spots], [[-0.2, 0.8]; 2]);
            let n_listed = grid.records.len();
            assert!(n_listed < 10 * n, "{n_listed} records of {n}");
            for _ in 0..2000 {
                // At a corner of an outline, as often as not.
                let near = spots[stream.below(n)];
                let corner = [near.low, near.high][stream.below(2)].map(f64::from);
                let size = [0.0, 0.0, 1e-9, 1e-4][stream.below(4)];
                let low =
                    if stream.below(2) == 0 { corner } else { corner.map(|c| c + 1e-3 * stream.between(-1.0, 1.0)) };
                let high = low.map(|slope| slope + size);
                let query = Query { low, high, far: [near.near, 20.0][stream.below(2)] };
                let mut found = Vec::new();
                grid.visit(&query, &mut |object| {
                    found.push(object);
                    false
                });
                for spot in &spots {
                    let holds = |k: usize| f64::from(spot.low[k]) <= high[k] && low[k] <= f64::from(spot.high[k]);
                    let is_held = holds(0) && holds(1) && spot.near <= query.far;
                    assert!(!is_held || found.contains(&spot.object), "{query:?} {spot:?}");
                }
            }
        }
    }

    #[test]
    fn a_query_stops_when_it_is_told() {
        let spot = |object| Spot { low: [0.0; 2], high: [1.0; 2], near: 1.0, object };
        let grid = Grid::new(&[&[0, 1, 2].map(spot)], [[0.0, 1.0]; 2]);
        let query = Query { low: [0.5; 2], high: [0.5; 2], far: 2.0 };
        let mut n_visits = 0;
        let mut stop = |_| {
            n_visits += 1;
            n_visits == 2
        };
        assert!(grid.visit(&query, &mut stop));
        assert_eq!(n_visits, 2);
    }
}
