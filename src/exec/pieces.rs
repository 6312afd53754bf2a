//! How many rows all threads trace together when an image has too few bands for each thread to have its own.

use std::time::Duration;

use crate::plan::Settings;

/// The most bytes of pixels in one piece, unless that is too few rows for the threads.
const MAX_BYTES: u64 = 4 << 20;

/// The most samples in one piece, unless that is too few rows for the threads: at most a second's work for a scene of
/// usual difficulty.
const MAX_SAMPLES: u64 = 1 << 20;

/// The samples of the first piece, when it is not known yet how hard the scene is.
const FIRST_SAMPLES: u64 = 1 << 16;

/// What a piece should take: progress is told between pieces.
const TIME: Duration = Duration::from_millis(200);

/// How many rows make a piece: few at first, then as many as take a fair time. All sizes are powers of two, and pieces
/// end at multiples of their size, so that large ones lie on whole tiles.
#[derive(Debug)]
pub(super) struct PieceSize {
    n_rows: u32,
    min_rows: u32,
    max_rows: u32,
    height: u32,
}

impl PieceSize {
    /// Chooses the size of the first piece. Each of the threads should have a row.
    pub fn new(settings: &Settings, n_threads: usize) -> Self {
        let (width, height) = (settings.size.width(), settings.size.height());
        let row_samples = u64::from(width) * u64::from(settings.samples).pow(2);
        let min_rows = (n_threads as u32).min(height).next_power_of_two();
        let rows = |rows: u64| (1 << rows.clamp(1, height.into()).ilog2()).max(min_rows);
        let max_rows = rows((MAX_BYTES / (u64::from(width) * 3)).min(MAX_SAMPLES / row_samples));
        Self { n_rows: rows(FIRST_SAMPLES / row_samples).min(max_rows), min_rows, max_rows, height }
    }

    /// Returns where a piece that starts at a row ends.
    pub fn end(&self, start: u32) -> u32 {
        ((start / self.n_rows + 1) * self.n_rows).min(self.height)
    }

    /// Chooses the next size by the time that a piece took; without a clock pieces grow to the largest.
    pub fn adapt(&mut self, took: Duration) {
        if took < TIME / 2 {
            self.n_rows = (self.n_rows * 2).min(self.max_rows);
        } else if took > TIME * 2 {
            self.n_rows = (self.n_rows / 2).max(self.min_rows);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Size;

    fn piece(width: u32, height: u32, samples: u32, n_threads: usize) -> PieceSize {
        let size = Size::new(width, height).unwrap();
        PieceSize::new(&Settings { size, samples, ..Settings::default() }, n_threads)
    }

    #[test]
    fn pieces_are_bounded_in_bytes_and_samples_and_hold_a_row_for_each_thread() {
        for (width, height, samples, n_threads, first, most) in [
            (300, 300, 1, 2, 128, 256),
            (300, 300, 1, 64, 128, 256),
            (65535, 65535, 1, 1, 1, 16),
            (1, 65535, 1, 1, 32768, 32768),
            (300, 300, 256, 1, 1, 1),
            (300, 300, 256, 6, 8, 8),
            (300, 3, 256, 64, 4, 4),
            (4000, 4000, 2, 2, 4, 64),
        ] {
            let piece = piece(width, height, samples, n_threads);
            assert_eq!((piece.n_rows, piece.max_rows), (first, most), "{width}x{height}, {samples} samples");
        }
    }

    #[test]
    fn pieces_follow_the_time_they_take() {
        let mut piece = piece(4000, 4000, 1, 2);
        let mut rows = Vec::new();
        for millis in [0, 150, 99, 1000, 1000, 1000, 1000, 1000, 1000, 1000, 1] {
            piece.adapt(Duration::from_millis(millis));
            rows.push(piece.n_rows);
        }
        assert_eq!(rows, [32, 32, 64, 32, 16, 8, 4, 2, 2, 2, 4]);
        (0..20).for_each(|_| piece.adapt(Duration::ZERO));
        assert_eq!(piece.n_rows, piece.max_rows);
    }

    #[test]
    fn pieces_end_at_multiples_of_their_size() {
        let mut piece = piece(4000, 4001, 1, 2);
        let mut ends = vec![piece.end(0)];
        for _ in 0..6 {
            piece.adapt(Duration::ZERO);
            ends.push(piece.end(*ends.last().expect("an end")));
        }
        assert_eq!(ends, [16, 32, 64, 128, 256, 512, 768]);
        assert_eq!(piece.end(4000), 4001);
    }
}
