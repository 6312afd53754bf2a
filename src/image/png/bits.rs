//! Bits into bytes, the first bit in the lowest place, as deflate wants them.

use crate::image::png::code::{Bits, Header};

/// The bytes that a flush stores, whole or not.
const FLUSHED: usize = 8;

/// Bits that are no whole byte yet.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BitBuffer {
    /// The first in the lowest place; above the last are zeros.
    bits: u64,
    /// How many they are: at most 7 behind a flush.
    n_bits: u32,
}

/// Writes bits into room that was made before.
///
/// It is moved, not borrowed, through the hot loop, so that it can live in registers.
#[derive(Debug)]
pub(super) struct BitWriter<'a> {
    room: &'a mut [u8],
    /// The whole bytes written.
    n_bytes: usize,
    buffer: BitBuffer,
}

impl<'a> BitWriter<'a> {
    /// Makes room for `n_bytes` behind what `out` holds, and begins with the bits of another writer.
    pub fn new(out: &'a mut Vec<u8>, buffer: BitBuffer, n_bytes: usize) -> Self {
        let start = out.len();
        out.resize(start + n_bytes + FLUSHED, 0);
        Self { room: &mut out[start..], n_bytes: 0, buffer }
    }

    /// Appends bits, at most [`MAX_BITS_AT_ONCE`](super::code::MAX_BITS_AT_ONCE) since the last flush.
    #[inline(always)]
    pub fn push(&mut self, bits: Bits) {
        self.push_value(bits.value(), bits.n_bits());
    }

    /// Appends the lowest `n_bits` of `value`, which has no others.
    #[inline(always)]
    pub fn push_value(&mut self, value: u64, n_bits: u32) {
        self.buffer.bits |= value << self.buffer.n_bits;
        self.buffer.n_bits += n_bits;
    }

    /// Writes whole bytes out.
    #[inline(always)]
    pub fn flush(&mut self) {
        let BitBuffer { bits, n_bits } = self.buffer;
        self.room[self.n_bytes..][..FLUSHED].copy_from_slice(&bits.to_le_bytes());
        self.n_bytes += (n_bits / 8) as usize;
        self.buffer = BitBuffer { bits: bits >> (n_bits & !7), n_bits: n_bits & 7 };
    }

    /// Begins a block.
    pub fn push_header(&mut self, header: &Header) {
        let mut n_left = header.n_bits as u32;
        for byte in header.bytes {
            self.push_value(byte.into(), n_left.min(8));
            self.flush();
            n_left = n_left.saturating_sub(8);
        }
    }

    /// Ends on a whole byte by an empty stored block, behind which the bits of another writer may stand.
    pub fn push_sync(&mut self) {
        let is_last_and_kind = 3;
        let n_free = (8 - (self.buffer.n_bits + is_last_and_kind) % 8) % 8;
        self.push_value(0, is_last_and_kind + n_free);
        self.flush();
        let (n_bytes, not_n_bytes) = (0x0000, 0xFFFF);
        self.push_value(n_bytes | not_n_bytes << 16, 32);
        self.flush();
    }

    /// Returns how many whole bytes were written, and the bits behind them.
    pub fn finish(self) -> (usize, BitBuffer) {
        (self.n_bytes, self.buffer)
    }
}
