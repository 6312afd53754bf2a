//! Sorting along Morton's curve.

use rayon::prelude::*;

use crate::plan::tree::Bounds;

/// Bits of each coordinate in a code.
const BITS: u32 = 21;

/// Sorts objects by the Morton codes of the middles of their boxes.
pub fn sorted(objects: Vec<u32>, bounds_of: &(impl Fn(u32) -> Bounds + Send + Sync)) -> Vec<u32> {
    let middle = |i: u32| {
        let [low, high] = bounds_of(i);
        std::array::from_fn::<f32, 3, _>(|k| 0.5 * low[k] + 0.5 * high[k])
    };
    let widen = |[low, high]: Bounds, middle: [f32; 3]| {
        [std::array::from_fn(|k| low[k].min(middle[k])), std::array::from_fn(|k| high[k].max(middle[k]))]
    };
    let nothing = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    let [low, high] = objects.iter().fold(nothing, |range, &i| widen(range, middle(i)));
    let extent = (0..3).map(|k| f64::from(high[k]) - f64::from(low[k])).fold(f64::MIN_POSITIVE, f64::max);
    let scale = f64::from((1 << BITS) - 1) / extent;
    let code = |i: u32| {
        let middle = middle(i);
        let cell = |k: usize| spread(((f64::from(middle[k]) - f64::from(low[k])) * scale) as u64);
        (cell(0) | cell(1) << 1 | cell(2) << 2, i)
    };
    let mut codes: Vec<_> = objects.into_par_iter().map(code).collect();
    codes.par_sort_unstable();
    codes.into_par_iter().map(|(_, i)| i).collect()
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
        // The corners of a cube, eight in each.
        let bounds = |i: u32| {
            let corner = [i & 1, i >> 1 & 1, i >> 2 & 1].map(|bit| 10.0 * bit as f32 + (i / 8) as f32 * 0.1);
            [corner, corner]
        };
        let sorted = sorted((0..64).collect(), &bounds);
        for eight in sorted.chunks(8) {
            assert!(eight.iter().all(|i| i % 8 == eight[0] % 8), "{eight:?}");
        }
    }

    #[test]
    fn bits_are_spread_three_apart() {
        assert_eq!(spread(0b1011), 0b001_000_001_001);
        assert_eq!(spread(0x1F_FFFF).count_ones(), BITS);
        assert_eq!(spread(1 << 20), 1 << 60);
    }
}
