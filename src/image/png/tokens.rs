//! Filtered bytes into literals and matches.

use crate::image::png::adler::{Adler32, SparseSum};
use crate::image::png::bits::{BitBuffer, BitWriter};
use crate::image::png::code::{Bits, Code, HEADER_BYTES, MAX_MATCH};

/// What a word takes at most with a run that one match holds before it, in bytes: eight literals of 12 bits, a match.
const MAX_WORD_BYTES: usize = 16;

/// What the end of a band takes at most besides a run, in bytes.
const END_BYTES: usize = 16;

/// Eight filtered bytes that are not all 0.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Word {
    /// The bytes, the first in the lowest place.
    pub bytes: u64,
    /// Where they stand among the filtered bytes of the band.
    pub at: u32,
}

/// Writes the filtered bytes of a band as one block of deflate.
pub(super) struct TokenWriter<'a> {
    code: &'static Code,
    out: &'a mut Vec<u8>,
    /// Bits that are no whole byte of `out` yet.
    buffer: BitBuffer,
    sum: SparseSum,
    /// The filtered bytes that are written; the last of them is not 0.
    n_written: u32,
}

impl<'a> TokenWriter<'a> {
    /// Begins the block.
    pub fn new(code: &'static Code, out: &'a mut Vec<u8>) -> Self {
        let mut writer = Self { code, out, buffer: BitBuffer::default(), sum: SparseSum::default(), n_written: 0 };
        writer.with_bits(HEADER_BYTES, |bits| bits.push_header(&code.header));
        writer
    }

    /// Writes words and the zeros between them, in order; zeros behind the last are left to the next call.
    #[inline(never)]
    pub fn write(&mut self, words: &[Word]) {
        let Some(last) = words.last() else { return };
        let (code, mut sum, mut n_written) = (self.code, self.sum, self.n_written);
        let n_bytes = words.len() * MAX_WORD_BYTES + bytes_of_zeros(last.at - n_written);
        self.with_bits(n_bytes, |bits| {
            for Word { bytes, at } in words.iter().copied() {
                sum.add(bytes, at);
                let n_before = bytes.trailing_zeros() / 8;
                let n_behind = bytes.leading_zeros() / 8;
                push_zeros(code, at + n_before - n_written, bits);
                push_word(code, bytes >> (8 * n_before), n_before + n_behind, bits);
                n_written = at + 8 - n_behind;
            }
        });
        (self.sum, self.n_written) = (sum, n_written);
    }

    /// Ends the block at `n_bytes` filtered bytes and on a whole byte; returns their checksum.
    pub fn finish(mut self, n_bytes: u32) -> Adler32 {
        let (code, n_zeros) = (self.code, n_bytes - self.n_written);
        self.with_bits(bytes_of_zeros(n_zeros) + END_BYTES, |bits| {
            push_zeros(code, n_zeros, bits);
            bits.push(code.end);
            bits.flush();
            bits.push_sync();
        });
        self.sum.finish(n_bytes)
    }

    /// Lets `write` append at most `n_bytes` bytes.
    #[inline(always)]
    fn with_bits(&mut self, n_bytes: usize, write: impl FnOnce(&mut BitWriter<'_>)) {
        let start = self.out.len();
        let mut bits = BitWriter::new(self.out, self.buffer, n_bytes);
        write(&mut bits);
        let (n_written, buffer) = bits.finish();
        self.buffer = buffer;
        self.out.truncate(start + n_written);
    }
}

/// Returns the most bytes that a run takes, as a multiple of its matches of 6 bits.
fn bytes_of_zeros(n: u32) -> usize {
    n as usize / MAX_MATCH + 8
}

/// Writes a run of zeros behind another byte.
#[inline(always)]
fn push_zeros(code: &Code, n: u32, bits: &mut BitWriter<'_>) {
    match code.runs.get(n as usize) {
        Some(run) => bits.push(*run),
        None => push_many_zeros(code, n as usize, bits),
    }
    bits.flush();
}

/// Writes a run that takes several matches, but for at most 24 bits that are not flushed.
#[inline(always)]
fn push_many_zeros(code: &Code, n: usize, bits: &mut BitWriter<'_>) {
    let mut n_matches = (n - 1) / MAX_MATCH;
    bits.push(code.runs[n - n_matches * MAX_MATCH]);
    let at_once = &code.longest_at_once;
    while n_matches >= at_once.n_matches {
        bits.flush();
        bits.push_value(at_once.value, at_once.n_bits);
        n_matches -= at_once.n_matches;
    }
    for _ in 0..n_matches {
        bits.flush();
        bits.push(code.longest);
    }
}

/// Writes a word without the `n_padding` zeros at its end.
#[inline(always)]
fn push_word(code: &Code, word: u64, n_padding: u32, bits: &mut BitWriter<'_>) {
    let padding_bits = n_padding * code.literals[0].n_bits();
    // Whether bits 1 to 7 of each byte are equal: −2, −1, 0 or 1.
    let is_small = (word ^ word << 1) & splat(0xFC) == 0;
    match code.quads {
        Some(quads) if is_small => push_quads(quads, word, padding_bits, bits),
        _ => push_literals(code, word, padding_bits, bits),
    }
}

/// Writes a word of bytes within −2…1, without the last bits, which are of zeros and so 0.
#[inline(always)]
fn push_quads(quads: &[Bits; 256], word: u64, padding_bits: u32, bits: &mut BitWriter<'_>) {
    let twos = word & splat(3);
    let fours = twos | twos >> 6;
    let eights = fours | fours >> 12;
    let [low, high] = [eights, eights >> 32].map(|quad| quads[usize::from(quad as u8)]);
    let n_bits = low.n_bits() + high.n_bits() - padding_bits;
    bits.push_value(low.value() | high.value() << low.n_bits(), n_bits);
    bits.flush();
}

/// Writes a word of any bytes, without the last bits, which are of zeros.
#[inline(always)]
fn push_literals(code: &Code, word: u64, padding_bits: u32, bits: &mut BitWriter<'_>) {
    let [a, b, c, d, e, f, g, h] = word.to_le_bytes().map(|byte| code.literals[usize::from(byte)]);
    let (low, n_low) = joined([a, b, c, d]);
    let (high, n_high) = joined([e, f, g, h]);
    let n_bits = n_low + n_high - padding_bits;
    for (value, n_bits) in [(low, n_low.min(n_bits)), (high, n_bits.saturating_sub(n_low))] {
        bits.push_value(value & ((1 << n_bits) - 1), n_bits);
        bits.flush();
    }
}

/// Puts four literals one behind the other; returns the bits and their number.
#[inline(always)]
fn joined([a, b, c, d]: [Bits; 4]) -> (u64, u32) {
    let n_ab = a.n_bits() + b.n_bits();
    let ab = a.value() | b.value() << a.n_bits();
    let cd = c.value() | d.value() << c.n_bits();
    (ab | cd << n_ab, n_ab + c.n_bits() + d.n_bits())
}

/// Returns a word of equal bytes.
const fn splat(byte: u8) -> u64 {
    u64::from_le_bytes([byte; 8])
}
