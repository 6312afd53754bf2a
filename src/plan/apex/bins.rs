//! Bins: for each cell of a grid the objects in it.

use std::ops::Range;

use rayon::prelude::*;

/// A block of cells: an outline on a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cells {
    /// First and last column.
    pub columns: [u16; 2],
    /// First and last row.
    pub rows: [u16; 2],
    /// No part of the object is nearer; not negative.
    pub near: f32,
}

impl Cells {
    /// Returns the block in a grid whose cells are 2ᵘ columns wide and 2ᵛ rows high.
    pub fn coarser(self, [u, v]: [u32; 2]) -> Self {
        let coarser = |cells: [u16; 2], shift: u32| cells.map(|cell| (u32::from(cell) >> shift) as u16);
        Self { columns: coarser(self.columns, u), rows: coarser(self.rows, v), near: self.near }
    }
}

/// For each cell of a grid the indices of the objects in it, nearest first.
#[derive(Debug, Default)]
pub struct Bins {
    /// Where the list of each cell starts, row by row, and where the last ends.
    starts: Vec<u32>,
    indices: Vec<u32>,
}

/// Objects from which on several threads are worth it.
const PARALLEL_FROM: usize = 8192;

impl Bins {
    /// Sorts objects into the cells of a grid of `n_columns` and `n_rows`, by counting: few nearest first, many as they come,
    /// since neighbours then mostly go to neighbouring cells, and each cell afterwards.
    ///
    /// `objects`: indices, rising, and the cells of each; `coarser` makes these cells of the grid. The order in a cell is by
    /// `near`, then by index, on any number of threads.
    ///
    /// # Panics
    /// When the lists have 2³² indices or more together.
    pub fn new(
        objects: &[(u32, Cells)],
        [n_columns, n_rows]: [u32; 2],
        coarser: impl Fn(Cells) -> Cells + Send + Sync,
    ) -> Self {
        let (n_columns, n_rows, n_objects) = (n_columns as usize, n_rows as usize, objects.len());
        let n_bands = if n_objects < PARALLEL_FROM { 1 } else { rayon::current_num_threads() * 2 };
        let band_rows = n_rows.div_ceil(n_bands);
        let order = (n_objects < PARALLEL_FROM).then(|| nearest_first(objects));
        let sorted = order.as_deref().unwrap_or(objects);
        let blocks = || sorted.iter().map(|&(i, cells)| (coarser(cells), i));
        let band = |i: usize| Band { rows: i * band_rows..n_rows.min((i + 1) * band_rows), n_columns };

        let mut starts = vec![0; n_columns * n_rows + 1];
        let counts = starts[1..].par_chunks_mut(band_rows * n_columns);
        counts.enumerate().for_each(|(i, counts)| band(i).count(blocks(), counts));
        accumulate(&mut starts);

        let mut indices = vec![0; starts[n_columns * n_rows] as usize];
        let mut rest = indices.as_mut_slice();
        let mut parts = Vec::new();
        for band in (0..n_rows.div_ceil(band_rows)).map(band) {
            let starts = &starts[band.rows.start * n_columns..=band.rows.end * n_columns];
            let (part, others) = rest.split_at_mut((starts[starts.len() - 1] - starts[0]) as usize);
            parts.push((band, starts, part));
            rest = others;
        }
        let is_sorted = order.is_some();
        parts.into_par_iter().for_each(|(band, starts, part)| band.fill(blocks(), is_sorted, starts, part));
        Self { starts, indices }
    }

    /// Returns the objects in a cell, counted row by row.
    pub fn list(&self, cell_idx: usize) -> &[u32] {
        &self.indices[self.starts[cell_idx] as usize..self.starts[cell_idx + 1] as usize]
    }

    /// Tells whether no object is in any of these cells.
    pub fn are_empty(&self, cells: Range<usize>) -> bool {
        self.starts[cells.start] == self.starts[cells.end]
    }
}

/// Returns all objects, nearest first.
fn nearest_first(objects: &[(u32, Cells)]) -> Vec<(u32, Cells)> {
    let mut objects = objects.to_vec();
    objects.sort_unstable_by_key(|(i, cells)| entry(cells, *i));
    objects
}

/// Returns a number that is larger for what is farther or, at the same depth, has a higher index.
fn entry(block: &Cells, i: u32) -> u64 {
    // Numbers that are not negative are ordered as their bits are.
    u64::from(block.near.to_bits()) << 32 | u64::from(i)
}

/// Turns counts behind a 0 into starts and the end of the last.
fn accumulate(counts: &mut [u32]) {
    let mut sum = 0u32;
    for count in counts {
        sum = sum.checked_add(*count).expect("fewer than 2^32 indices");
        *count = sum;
    }
}

/// Some rows of a grid, the work of one thread.
struct Band {
    rows: Range<usize>,
    n_columns: usize,
}

impl Band {
    /// Returns the cells of a block in each row of the band, counted from its first.
    fn cells(&self, block: &Cells) -> impl Iterator<Item = Range<usize>> + use<> {
        let [first, last] = block.rows.map(usize::from);
        let [left, right] = block.columns.map(usize::from);
        let (top, n_columns) = (self.rows.start, self.n_columns);
        (first.max(top)..(last + 1).min(self.rows.end)).map(move |row| {
            let start = (row - top) * n_columns;
            start + left..start + right + 1
        })
    }

    /// Counts the blocks in each cell.
    fn count(&self, blocks: impl Iterator<Item = (Cells, u32)>, counts: &mut [u32]) {
        for (block, _) in blocks {
            for cells in self.cells(&block) {
                counts[cells].iter_mut().for_each(|count| *count += 1);
            }
        }
    }

    /// Writes the lists of the cells, whose starts are given and the end of the last.
    fn fill(&self, blocks: impl Iterator<Item = (Cells, u32)>, is_sorted: bool, starts: &[u32], indices: &mut [u32]) {
        let mut entries = vec![0; indices.len()];
        let mut next: Vec<u32> = starts.iter().map(|start| start - starts[0]).collect();
        for (block, i) in blocks {
            let entry = entry(&block, i);
            for cells in self.cells(&block) {
                for next in &mut next[cells] {
                    entries[*next as usize] = entry;
                    *next += 1;
                }
            }
        }
        let start = |cell: usize| (starts[cell] - starts[0]) as usize;
        for cell in (0..starts.len() - 1).filter(|_| !is_sorted) {
            entries[start(cell)..start(cell + 1)].sort_unstable();
        }
        indices.iter_mut().zip(entries).for_each(|(index, entry)| *index = entry as u32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Stream;

    fn random_cells(stream: &mut Stream) -> Cells {
        let mut range = |n: usize| {
            let first = stream.below(n);
            [first as u16, (first + stream.below(n - first)) as u16]
        };
        Cells { columns: range(13), rows: range(37), near: stream.below(50) as f32 }
    }

    #[test]
    fn each_cell_lists_its_objects_nearest_first() {
        for n_objects in [0, 1, 100, PARALLEL_FROM + 1] {
            let mut stream = Stream::new(n_objects as u64);
            let cells: Vec<_> = (0..n_objects).map(|_| random_cells(&mut stream)).collect();
            let is_listed = |i: &u32| !i.is_multiple_of(5);
            let objects: Vec<_> = (0..n_objects as u32).filter(is_listed).map(|i| (i, cells[i as usize])).collect();
            let bins = Bins::new(&objects, [13, 37], |cells| cells);
            for (row, column) in (0..37).flat_map(|row| (0..13).map(move |column| (row, column))) {
                let is_in = |i: &u32| {
                    let Cells { columns, rows, .. } = cells[*i as usize];
                    columns[0] <= column && column <= columns[1] && rows[0] <= row && row <= rows[1]
                };
                let mut expected: Vec<u32> = (0..n_objects as u32).filter(is_listed).filter(is_in).collect();
                expected.sort_by(|a, b| cells[*a as usize].near.total_cmp(&cells[*b as usize].near));
                assert_eq!(bins.list(usize::from(row) * 13 + usize::from(column)), expected);
            }
            assert_eq!(bins.are_empty(0..13 * 37), objects.is_empty());
        }
    }

    #[test]
    fn coarser_cells_hold_what_the_finer_ones_hold() {
        let block = Cells { columns: [3, 17], rows: [8, 8], near: 1.0 };
        assert_eq!(block.coarser([3, 2]), Cells { columns: [0, 2], rows: [2, 2], near: 1.0 });
    }
}
