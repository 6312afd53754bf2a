//! A band of rows into bytes of deflate that stand for themselves.
//!
//! Nothing is known of the row above the band, and its last block ends on a whole byte: bands can be encoded in any order
//! and put one behind the other. Filtered bytes are nearly all 0. They are looked at in words of eight; those that are
//! not 0 are found in one loop and written in another ([`TokenWriter`]).

use crate::image::png::adler::{Adler32, SparseSum};
use crate::image::png::code::{Code, PIXELS, UNIFORM};
use crate::image::png::filter::{BLOCK, Filter, PIXEL, Paeth, Sub, WINDOW};
use crate::image::png::tokens::{TokenWriter, Word};

/// The most bytes of one stored block.
const MAX_STORED: usize = 65535;

/// Appends rows of 8-bit RGB pixels to `out`; returns the checksum of their filtered bytes.
///
/// # Panics
/// When `rgb` does not hold rows of `width` pixels.
pub(super) fn deflate_rows(width: usize, rgb: &[u8], out: &mut Vec<u8>) -> Adler32 {
    let row_bytes = width * PIXEL;
    assert!(row_bytes > 0 && rgb.len().is_multiple_of(row_bytes), "whole rows");
    let start = out.len();
    let mut filtered = Filtered::new(&PIXELS, out);
    let mut above = None;
    for row in rgb.chunks_exact(row_bytes) {
        match above {
            None => filtered.push_row::<Sub>(row, row),
            Some(above) => filtered.push_row::<Paeth>(row, above),
        }
        above = Some(row);
    }
    let adler = filtered.finish();
    let n_filtered = rgb.len() + rgb.len() / row_bytes;
    if out.len() - start <= stored_bytes(n_filtered) {
        return adler;
    }
    out.truncate(start);
    store_rows(row_bytes, rgb, out)
}

/// Appends `n_rows` rows of one colour to `out`; returns the checksum of their filtered bytes.
pub(super) fn deflate_uniform_rows(width: usize, n_rows: usize, color: [u8; PIXEL], out: &mut Vec<u8>) -> Adler32 {
    let mut filtered = Filtered::new(&UNIFORM, out);
    for row in 0..n_rows {
        let (filter, first) = if row == 0 { (Sub::TYPE, color) } else { (Paeth::TYPE, [0; PIXEL]) };
        filtered.begin_row(filter, first);
        filtered.n_bytes += ((width - 1) * PIXEL) as u32;
    }
    filtered.finish()
}

/// Returns how many bytes so many take when they are stored.
fn stored_bytes(n_bytes: usize) -> usize {
    n_bytes + n_bytes.div_ceil(MAX_STORED) * 5
}

/// Appends rows as they are, for pixels without order, which would take more otherwise.
fn store_rows(row_bytes: usize, rgb: &[u8], out: &mut Vec<u8>) -> Adler32 {
    let mut bytes = Vec::with_capacity(rgb.len() + rgb.len() / row_bytes);
    for row in rgb.chunks_exact(row_bytes) {
        let no_filter = 0;
        bytes.push(no_filter);
        bytes.extend(row);
    }
    for stored in bytes.chunks(MAX_STORED) {
        let n_bytes = stored.len() as u16;
        let is_last_and_kind = 0;
        out.push(is_last_and_kind);
        out.extend(n_bytes.to_le_bytes());
        out.extend((!n_bytes).to_le_bytes());
        out.extend(stored);
    }
    let mut sum = SparseSum::default();
    for (idx, chunk) in (0..).zip(bytes.chunks(8)) {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        sum.add(u64::from_le_bytes(word), 8 * idx);
    }
    sum.finish(bytes.len() as u32)
}

/// Words that are found before they are written. One loop that does both has more branches that surprise the processor.
const N_WORDS: usize = 512;

/// The most words that a block adds.
const WORDS_OF_BLOCK: usize = BLOCK / 8;

/// The filtered bytes of a band.
struct Filtered<'a> {
    tokens: TokenWriter<'a>,
    /// What is found and not yet written; all between is 0.
    words: [Word; N_WORDS],
    n_words: usize,
    /// The filtered bytes so far.
    n_bytes: u32,
}

impl<'a> Filtered<'a> {
    fn new(code: &'static Code, out: &'a mut Vec<u8>) -> Self {
        Self { tokens: TokenWriter::new(code, out), words: [Word::default(); N_WORDS], n_words: 0, n_bytes: 0 }
    }

    /// Appends the number of the row's filter and what is left of its first pixel.
    fn begin_row(&mut self, filter: u8, [r, g, b]: [u8; PIXEL]) {
        self.find(u64::from_le_bytes([filter, r, g, b, 0, 0, 0, 0]), 0);
        self.n_bytes += 1 + PIXEL as u32;
        self.make_room();
    }

    /// Appends a row.
    fn push_row<F: Filter>(&mut self, row: &[u8], above: &[u8]) {
        let first = |row: &[u8]| [row[0], row[1], row[2]];
        self.begin_row(F::TYPE, F::first(first(row), first(above)));
        let (mut row, mut above) = (row, above);
        while let (Some(window), Some(window_above)) = (row.first_chunk(), above.first_chunk()) {
            self.push_block::<F>(window, window_above, BLOCK);
            (row, above) = (&row[BLOCK..], &above[BLOCK..]);
        }
        let n_left = row.len() - PIXEL;
        if n_left > 0 {
            self.push_block::<F>(&padded(row), &padded(above), n_left);
        }
    }

    /// Appends the first `n` bytes of a block.
    #[inline(always)]
    fn push_block<F: Filter>(&mut self, row: &[u8; WINDOW], above: &[u8; WINDOW], n: usize) {
        if let Some(mut residuals) = F::block(row, above) {
            residuals[n..].fill(0);
            let (words, _) = residuals.as_chunks();
            for (idx, word) in (0..).zip(words) {
                self.find(u64::from_le_bytes(*word), 8 * idx);
            }
            self.make_room();
        }
        self.n_bytes += n as u32;
    }

    /// Keeps a word at a distance from the end so far, unless it is 0.
    #[inline(always)]
    fn find(&mut self, bytes: u64, distance: u32) {
        self.words[self.n_words % N_WORDS] = Word { bytes, at: self.n_bytes + distance };
        self.n_words += usize::from(bytes != 0);
    }

    /// Makes room for the words of another block.
    #[inline(always)]
    fn make_room(&mut self) {
        if self.n_words > N_WORDS - WORDS_OF_BLOCK {
            self.tokens.write(&self.words[..self.n_words]);
            self.n_words = 0;
        }
    }

    fn finish(mut self) -> Adler32 {
        self.tokens.write(&self.words[..self.n_words]);
        self.tokens.finish(self.n_bytes)
    }
}

/// Returns the end of a row as a window; what is behind it is 0.
fn padded(bytes: &[u8]) -> [u8; WINDOW] {
    let mut window = [0; WINDOW];
    window[..bytes.len()].copy_from_slice(bytes);
    window
}
