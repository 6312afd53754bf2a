//! The order of objects along a curve that fills space: neighbours in it are neighbours in space.
//!
//! Hilbert's curve. A stretch of it is more compact than one of Morton's, which jumps: a reflected ray through a million
//! spheres meets half as many boxes.
//!
//! # Source
//! Skilling, "Programming the Hilbert curve", AIP Conference Proceedings 707 (2004): the bits of the coordinates are
//! exchanged and inverted, from the highest to the lowest, until taking them in turn gives the place on the curve.

use rayon::prelude::*;

/// Bits of each coordinate in a code.
const BITS: u32 = 16;

/// Points that are looked at to find where most are.
const N_SAMPLES: usize = 512;

/// Points whose codes are worked out side by side.
const BLOCK: usize = 16;

/// Blocks that a thread takes at a time.
const BLOCKS_PER_TASK: usize = 256;

/// Returns the places of the points along the curve: the index of the first point, of the second, and so on.
///
/// Of many points the last bits of the codes give way to their indices: then a code and its index are one number, which
/// sorts in half the time, and there are still hundreds of cells for each point.
///
/// `point(i)`: coordinates, any numbers.
pub fn order(n_points: usize, point: impl Fn(usize) -> [f64; 3] + Send + Sync) -> Vec<u32> {
    let ranges = ranges(n_points, &point);
    let index_bits = usize::BITS - n_points.leading_zeros();
    let n_dropped = (3 * BITS + index_bits).saturating_sub(u64::BITS);
    let mut codes = vec![0_u64; n_points];
    let blocks = codes.par_chunks_mut(BLOCK).with_min_len(BLOCKS_PER_TASK);
    blocks.enumerate().for_each(|(block, codes)| {
        let mut cells = [[0; BLOCK]; 3];
        let first = block * BLOCK;
        for (lane, i) in (first..first + codes.len()).enumerate() {
            let point = point(i);
            (0..3).for_each(|k| cells[k][lane] = cell(point[k], ranges[k]));
        }
        let indexed = places(cells).into_iter().zip(first as u64..);
        let indexed = indexed.map(|(code, i)| code >> n_dropped << index_bits | i);
        codes.iter_mut().zip(indexed).for_each(|(code, indexed)| *code = indexed);
    });
    codes.par_sort_unstable();
    let index = (1 << index_bits) - 1;
    codes.into_par_iter().with_min_len(BLOCK * BLOCKS_PER_TASK).map(|code| (code & index) as u32).collect()
}

/// Returns the cell of a coordinate in a range; what is no number is in cell 0.
fn cell(coordinate: f64, [low, high]: [f64; 2]) -> u32 {
    let last = f64::from((1 << BITS) - 1);
    ((coordinate - low) / (high - low) * last).clamp(0.0, last) as u32
}

/// Returns for each coordinate a range in which most points are: a few that are far away shall not press the others into
/// one cell of the curve.
fn ranges(n_points: usize, point: &impl Fn(usize) -> [f64; 3]) -> [[f64; 2]; 3] {
    let samples: Vec<_> = (0..n_points).step_by(n_points / N_SAMPLES + 1).map(point).collect();
    std::array::from_fn(|k| {
        let mut coordinates: Vec<_> = samples.iter().map(|sample| sample[k]).collect();
        coordinates.sort_by(f64::total_cmp);
        let at = |share: usize| coordinates.get(coordinates.len() * share / 32).copied().unwrap_or(0.0);
        let (low, high) = (at(1), at(31));
        // The outermost sixteenth of the samples, and as much again.
        let margin = (high - low) / 8.0;
        [low - margin, high + margin]
    })
}

/// Returns the places of cells on the curve; each coordinate has [`BITS`] bits.
fn places(cells: [[u32; BLOCK]; 3]) -> [u64; BLOCK] {
    let [mut x, mut y, mut z] = cells;
    for bit in (1..BITS).rev() {
        let lower = (1 << bit) - 1;
        // All ones where the bit is set: then x is inverted below it, otherwise exchanged.
        let is_set = |c: u32| (c >> bit & 1).wrapping_neg();
        for i in 0..BLOCK {
            x[i] ^= lower & is_set(x[i]);
            for other in [&mut y[i], &mut z[i]] {
                let inverted = is_set(*other);
                let exchanged = (x[i] ^ *other) & lower & !inverted;
                x[i] ^= exchanged | (lower & inverted);
                *other ^= exchanged;
            }
        }
    }
    std::array::from_fn(|i| {
        // Gray's code; then each bit takes the parity of the bits above it in z.
        let (x, y) = (x[i], y[i] ^ x[i]);
        let z = z[i] ^ y;
        let mut parity = z >> 1;
        for shift in [1, 2, 4, 8] {
            parity ^= parity >> shift;
        }
        spread(x ^ parity) << 2 | spread(y ^ parity) << 1 | spread(z ^ parity)
    })
}

/// Puts two zeros between each two of the lowest 21 bits.
fn spread(x: u32) -> u64 {
    let x = u64::from(x) & 0x1F_FFFF;
    let x = (x | x << 32) & 0x001F_0000_0000_FFFF;
    let x = (x | x << 16) & 0x001F_0000_FF00_00FF;
    let x = (x | x << 8) & 0x100F_00F0_0F00_F00F;
    let x = (x | x << 4) & 0x10C3_0C30_C30C_30C3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_on_the_curve_are_neighbours_in_space() {
        // The corners of a cube, eight points at each, in turn.
        let point = |i: usize| [i & 1, i >> 1 & 1, i >> 2 & 1].map(|bit| 10.0 * bit as f64 + (i / 8) as f64 * 0.1);
        for eight in order(64, point).chunks(8) {
            assert!(eight.iter().all(|i| i % 8 == eight[0] % 8), "{eight:?}");
        }
    }

    #[test]
    fn every_point_has_one_place() {
        let far = [f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e300, -1e300, 0.0, 1e-300];
        for n in [0, 1, 2, 7, 100] {
            let mut places = order(n, |i| [far[i % 7], far[i % 5], far[i % 3]]);
            places.sort_unstable();
            assert!(places.into_iter().eq(0..n as u32));
        }
    }

    #[test]
    fn bits_are_spread_three_apart() {
        assert_eq!(spread(0b1011), 0b001_000_001_001);
        assert_eq!(spread(0xFFFF).count_ones(), BITS);
        assert_eq!(spread(1 << 20), 1 << 60);
    }

    /// Cells that follow each other on the curve share a side, and each cell has its place.
    #[test]
    fn the_curve_goes_from_neighbour_to_neighbour() {
        const SIDE: u32 = 16;
        let cells = (0..SIDE.pow(3)).map(|i| [i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE]);
        // The curve fills the corner of the cube before it leaves it.
        let place = |cell: [u32; 3]| places(cell.map(|c| [c; BLOCK]))[0];
        let mut along: Vec<_> = cells.map(|cell| (place(cell), cell)).collect();
        along.sort_unstable();
        for (i, (place, _)) in (0..).zip(&along) {
            assert_eq!(*place, i);
        }
        for two in along.windows(2) {
            let apart: u32 = (0..3).map(|k| two[0].1[k].abs_diff(two[1].1[k])).sum();
            assert_eq!(apart, 1, "{two:?}");
        }
    }
}
