//! The order of objects along a curve that fills space: neighbours in it are neighbours in space.
//!
//! Morton's curve: the bits of the three coordinates in turn make one number.

use rayon::prelude::*;

/// Bits of each coordinate in a code.
const BITS: u32 = 21;

/// Points that are looked at to find where most are.
const N_SAMPLES: usize = 512;

/// Returns the places of the points along the curve: the index of the first point, of the second, and so on.
///
/// `point(i)`: coordinates, any numbers.
pub fn order(n_points: usize, point: impl Fn(usize) -> [f64; 3] + Send + Sync) -> Vec<u32> {
    let ranges = ranges(n_points, &point);
    let code = |i: usize| {
        let point = point(i);
        let cell = |k: usize| {
            let [low, high] = ranges[k];
            let places = f64::from((1 << BITS) - 1);
            // What is no number is cast to 0.
            spread(((point[k] - low) / (high - low) * places).clamp(0.0, places) as u64)
        };
        (cell(0) | cell(1) << 1 | cell(2) << 2, i as u32)
    };
    let mut codes: Vec<_> = (0..n_points).into_par_iter().map(code).collect();
    codes.par_sort_unstable();
    codes.into_par_iter().map(|(_, i)| i).collect()
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

/// Puts two zeros between each two of the lowest 21 bits.
fn spread(x: u64) -> u64 {
    let x = x & 0x1F_FFFF;
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
        assert_eq!(spread(0x1F_FFFF).count_ones(), BITS);
        assert_eq!(spread(1 << 20), 1 << 60);
    }
}
