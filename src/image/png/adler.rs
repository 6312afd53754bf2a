//! Adler-32, the checksum of a zlib stream, of bands that are put together later.
//!
//! # Source
//! RFC 1950, section 8; the combination is that of zlib's `adler32_combine`.

/// The largest prime below 2^16.
const MODULUS: u64 = 65521;

/// The most bytes of a band. The sums of their values and places stay below 2^62 unreduced.
pub(super) const MAX_BYTES: u32 = 1 << 27;

/// The checksum of some bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Adler32 {
    /// 1 and the sum of the bytes.
    a: u64,
    /// The sum of what `a` was behind each byte.
    b: u64,
    n_bytes: u64,
}

/// The sums of bytes of which most are 0, and need no look: a byte at place p of n is n − p times in `b`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SparseSum {
    /// The sum of the bytes.
    values: u64,
    /// The sum of each byte times its place.
    places: u64,
}

impl Default for Adler32 {
    /// The checksum of no bytes.
    fn default() -> Self {
        Self { a: 1, b: 0, n_bytes: 0 }
    }
}

impl Adler32 {
    /// Appends what another checksum is of.
    pub fn append(&mut self, next: &Self) {
        // Each byte of `next` sees the whole of `self` before it, and a 1 less.
        let a = self.a + next.a + MODULUS - 1;
        let b = self.b + next.b + next.n_bytes % MODULUS * (self.a + MODULUS - 1);
        *self = Self { a: a % MODULUS, b: b % MODULUS, n_bytes: self.n_bytes + next.n_bytes };
    }

    /// Returns the checksum.
    pub fn value(&self) -> u32 {
        (self.b << 16 | self.a) as u32
    }
}

impl SparseSum {
    /// Adds eight bytes, the one in the lowest place of the word standing at place `at`.
    #[inline(always)]
    pub fn add(&mut self, bytes: u64, at: u32) {
        /// Every other byte.
        const EVEN: u64 = 0x00FF_00FF_00FF_00FF;
        /// Multiplied by it, the top of four places becomes the sum of all.
        const SUM: u64 = 0x0001_0001_0001_0001;
        /// Multiplied by it, the top of four places becomes the sum of each times its number, 0 to 3.
        const SUM_OF_PLACES: u64 = 0x0000_0001_0002_0003;
        let odd = bytes >> 8 & EVEN;
        let pairs = (bytes & EVEN) + odd;
        let values = pairs.wrapping_mul(SUM) >> 48;
        let places = 2 * (pairs.wrapping_mul(SUM_OF_PLACES) >> 48) + (odd.wrapping_mul(SUM) >> 48);
        self.values += values;
        self.places += values * u64::from(at) + places;
    }

    /// Returns the checksum of `n_bytes`, of which those not added are 0.
    pub fn finish(self, n_bytes: u32) -> Adler32 {
        debug_assert!(n_bytes <= MAX_BYTES);
        let n_bytes = u64::from(n_bytes);
        let b = n_bytes + self.values * n_bytes - self.places;
        Adler32 { a: (1 + self.values) % MODULUS, b: b % MODULUS, n_bytes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definition.
    fn of(bytes: &[u8]) -> u32 {
        let (a, b) = bytes.iter().fold((1, 0), |(a, b), byte| {
            let a = (a + u32::from(*byte)) % 65521;
            (a, (b + a) % 65521)
        });
        b << 16 | a
    }

    fn summed(bytes: &[u8]) -> Adler32 {
        let mut sum = SparseSum::default();
        for (idx, chunk) in (0..).zip(bytes.chunks(8)) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            sum.add(u64::from_le_bytes(word), 8 * idx);
        }
        sum.finish(bytes.len() as u32)
    }

    fn bytes(n: usize) -> Vec<u8> {
        (0..n).map(|i| if i % 1000 < 400 { 255 } else { ((i * i) >> 5) as u8 }).collect()
    }

    #[test]
    fn words_give_the_sum_of_the_definition() {
        assert_eq!(summed(b"Wikipedia").value(), 0x11E6_0398);
        for n in [0, 1, 7, 8, 9, 5551, 5553, 700_000] {
            let bytes = bytes(n);
            assert_eq!(summed(&bytes).value(), of(&bytes), "{n}");
        }
    }

    #[test]
    fn zeros_need_no_look() {
        let mut sum = SparseSum::default();
        sum.add(u64::from_le_bytes([1, 2, 3, 4, 5, 6, 7, 255]), 99_993);
        let mut bytes = vec![0; 200_000];
        bytes[99_993..100_001].copy_from_slice(&[1, 2, 3, 4, 5, 6, 7, 255]);
        assert_eq!(sum.finish(200_000).value(), of(&bytes));
    }

    #[test]
    fn the_largest_band_does_not_overflow() {
        let mut sum = SparseSum { values: 255 * u64::from(MAX_BYTES - 8), places: 0 };
        sum.add(u64::MAX, MAX_BYTES - 8);
        sum.places += (255 * u64::from(MAX_BYTES)).checked_mul(u64::from(MAX_BYTES)).expect("room for all places") / 2;
        sum.finish(MAX_BYTES);
    }

    #[test]
    fn parts_make_the_whole() {
        let bytes = bytes(200_000);
        for cut in [0, 1, 65521, 65522, 131_042, 200_000] {
            let (head, tail) = bytes.split_at(cut);
            let mut sum = summed(head);
            sum.append(&summed(tail));
            assert_eq!(sum.value(), of(&bytes), "cut at {cut}");
        }
    }
}
