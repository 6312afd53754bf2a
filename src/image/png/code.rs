//! The two Huffman codes of the encoder, made by the compiler.
//!
//! A fixed code needs no look at the data before the first bit is out. Deflate writes the lengths of its codes in front
//! of a block, so every decoder reads it. Matches are runs of zeros: their distance is 1, the only one there is.

/// Literals, the end of the block and the lengths of matches.
const N_SYMBOLS: usize = 286;

/// The symbol that ends a block.
const END: usize = 256;

/// The symbol of the shortest matches.
const FIRST_LENGTH: usize = 257;

/// The shortest match of each length symbol (RFC 1951, 3.2.5).
const LENGTH_BASE: [usize; 29] =
    [3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 15, 17, 19, 23, 27, 31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258];

/// The extra bits behind each length symbol.
const LENGTH_EXTRA: [u32; 29] = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0];

/// The longest match.
pub(super) const MAX_MATCH: usize = 258;

/// The most bits that can be written between two flushes of the bit writer.
pub(super) const MAX_BITS_AT_ONCE: u32 = 56;

/// Room for the header of either code.
pub(super) const HEADER_BYTES: usize = 64;

/// Up to 24 bits to be written, the first in the lowest place.
#[derive(Clone, Copy)]
pub(super) struct Bits(u32);

impl Bits {
    const NONE: Self = Self(0);

    const fn new(value: u32, n_bits: u32) -> Self {
        assert!(n_bits <= 24 && value < 1 << n_bits);
        Self(value << 8 | n_bits)
    }

    /// Returns the bits as a number.
    #[inline]
    pub const fn value(self) -> u64 {
        (self.0 >> 8) as u64
    }

    /// Returns how many they are.
    #[inline]
    pub const fn n_bits(self) -> u32 {
        self.0 & 0xFF
    }

    /// Returns these bits and `next` behind them.
    const fn then(self, next: Self) -> Self {
        Self::new((self.value() | next.value() << self.n_bits()) as u32, self.n_bits() + next.n_bits())
    }
}

/// A Huffman code, ready for use.
pub(super) struct Code {
    /// What begins a block, with the lengths of all codes.
    pub header: Header,
    /// Each byte as a literal.
    pub literals: [Bits; 256],
    /// Four bytes within −2…1 as literals; the index has two bits of each, the first in the lowest place.
    pub quads: Option<&'static [Bits; 256]>,
    /// Each short run of zeros behind another byte.
    pub runs: [Bits; MAX_MATCH + 1],
    /// [`MAX_MATCH`] more zeros.
    pub longest: Bits,
    /// As many of them as fit in a word.
    pub longest_at_once: Matches,
    /// The end of the block.
    pub end: Bits,
}

/// Several matches of the greatest length.
pub(super) struct Matches {
    /// Their bits, the first in the lowest place.
    pub value: u64,
    /// How many bits they are.
    pub n_bits: u32,
    /// How many matches they are.
    pub n_matches: usize,
}

/// The code of pixels: the residuals of smooth shading, most of them 0.
///
/// # Source
/// Fitted to 14 renders, each counted alike: each is 1 to 12 % longer than with a code of its own, 5 % in the median.
/// A residual and its negative have one length, which makes the header short.
pub(super) static PIXELS: Code = Code { quads: Some(&PIXEL_QUADS), ..Code::new(&pixel_lengths()) };

/// The code of rows of one colour: nearly all is the longest match.
pub(super) static UNIFORM: Code = Code::new(&uniform_lengths());

static PIXEL_QUADS: [Bits; 256] = quads(&Code::new(&pixel_lengths()).literals);

const fn pixel_lengths() -> [u8; N_SYMBOLS] {
    let mut lengths = [0; N_SYMBOLS];
    let mut byte = 0;
    while byte < 256 {
        lengths[byte] = match (byte as u8).cast_signed().unsigned_abs() {
            0 => 1,
            1 => 3,
            2 => 6,
            3..=4 => 7,
            5..=6 => 8,
            7..=8 => 9,
            9..=12 => 10,
            13..=18 => 11,
            _ => 12,
        };
        byte += 1;
    }
    lengths[END] = 12;
    // Shorter matches have no code, since their zeros are shorter.
    set(&mut lengths, 264, 276, 8);
    set(&mut lengths, 277, 283, 9);
    lengths[284] = 10;
    lengths[285] = 5;
    lengths
}

const fn uniform_lengths() -> [u8; N_SYMBOLS] {
    let mut lengths = [10; N_SYMBOLS];
    // So many that the code is complete.
    set(&mut lengths, 200, 253, 11);
    lengths[0] = 3;
    lengths[4] = 3;
    lengths[285] = 1;
    lengths
}

/// Gives the symbols from `first` to `last` one length.
const fn set(lengths: &mut [u8; N_SYMBOLS], first: usize, last: usize, length: u8) {
    let mut symbol = first;
    while symbol <= last {
        lengths[symbol] = length;
        symbol += 1;
    }
}

impl Code {
    const fn new(lengths: &[u8; N_SYMBOLS]) -> Self {
        let symbols = canonical(lengths);
        let mut literals = [Bits::NONE; 256];
        let mut byte = 0;
        while byte < 256 {
            literals[byte] = symbols[byte];
            byte += 1;
        }
        let mut runs = [Bits::NONE; MAX_MATCH + 1];
        let mut n = 1;
        while n <= MAX_MATCH {
            runs[n] = run(&symbols, n);
            n += 1;
        }
        let longest = match_of(&symbols, MAX_MATCH);
        let header = Header::new(lengths);
        Self { header, literals, quads: None, runs, longest, longest_at_once: Matches::new(longest), end: symbols[END] }
    }
}

impl Matches {
    const fn new(longest: Bits) -> Self {
        let mut matches = Self { value: 0, n_bits: 0, n_matches: 0 };
        while matches.n_bits + longest.n_bits() <= MAX_BITS_AT_ONCE {
            matches.value |= longest.value() << matches.n_bits;
            matches.n_bits += longest.n_bits();
            matches.n_matches += 1;
        }
        matches
    }
}

/// Assigns codes to lengths (RFC 1951, 3.2.2), each with its first bit in the lowest place.
const fn canonical<const N: usize>(lengths: &[u8; N]) -> [Bits; N] {
    let mut codes = [Bits::NONE; N];
    let (mut next, mut length) = (0u32, 1);
    while length <= 15 {
        next <<= 1;
        let mut symbol = 0;
        while symbol < N {
            if lengths[symbol] == length {
                codes[symbol] = Bits::new(next.reverse_bits() >> (32 - length as u32), length as u32);
                next += 1;
            }
            symbol += 1;
        }
        length += 1;
    }
    assert!(next == 1 << 15, "a code must be complete");
    codes
}

/// Returns the shortest way to write `n` zeros behind another byte.
const fn run(symbols: &[Bits; N_SYMBOLS], n: usize) -> Bits {
    let zero = symbols[0];
    let as_literals = n as u32 * zero.n_bits();
    if n > 3 {
        let matched = match_of(symbols, n - 1);
        if matched.n_bits() > 0 && zero.n_bits() + matched.n_bits() < as_literals {
            return zero.then(matched);
        }
    }
    let mut bits = Bits::NONE;
    let mut n_written = 0;
    while n_written < n {
        bits = bits.then(zero);
        n_written += 1;
    }
    bits
}

/// Returns a match of `length` bytes at distance 1; no bits when its length has no code.
const fn match_of(symbols: &[Bits; N_SYMBOLS], length: usize) -> Bits {
    let mut idx = LENGTH_BASE.len() - 1;
    while LENGTH_BASE[idx] > length {
        idx -= 1;
    }
    let symbol = symbols[FIRST_LENGTH + idx];
    if symbol.n_bits() == 0 {
        return symbol;
    }
    let extra = Bits::new((length - LENGTH_BASE[idx]) as u32, LENGTH_EXTRA[idx]);
    let distance = Bits::new(0, 1);
    symbol.then(extra).then(distance)
}

const fn quads(literals: &[Bits; 256]) -> [Bits; 256] {
    let mut quads = [Bits::NONE; 256];
    let mut idx = 0;
    while idx < 256 {
        let mut place = 0;
        while place < 8 {
            // 0, 1, 2, 3 stand for 0, 1, −2, −1.
            let pair = (idx >> place & 3) as u8;
            let residual = if pair < 2 { pair } else { pair | 0xFC };
            quads[idx] = quads[idx].then(literals[residual as usize]);
            place += 2;
        }
        idx += 1;
    }
    quads
}

/// What begins a block that is not the last and has codes of its own (RFC 1951, 3.2.7).
pub(super) struct Header {
    /// The bits, the first in the lowest place of the first byte.
    pub bytes: [u8; HEADER_BYTES],
    /// How many they are.
    pub n_bits: usize,
}

/// The order in which the lengths of the codes for lengths are written.
const ORDER: [usize; 19] = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];

/// The lengths of the codes for lengths; 16 repeats a length 3 to 6 times, 17 writes 3 to 10 zeros.
const LENGTHS_OF_LENGTHS: [u8; 19] = [5, 5, 0, 5, 0, 5, 5, 4, 4, 4, 4, 5, 5, 0, 0, 0, 1, 5, 0];

/// How many of them are written; the last is 0.
const N_LENGTHS_OF_LENGTHS: usize = 18;

impl Header {
    const fn new(lengths: &[u8; N_SYMBOLS]) -> Self {
        let mut header = Self { bytes: [0; HEADER_BYTES], n_bits: 0 };
        let is_last = 0;
        header.push(Bits::new(is_last | 0b10 << 1, 3));
        header.push(Bits::new((N_SYMBOLS - FIRST_LENGTH) as u32, 5));
        let n_distances = 1;
        header.push(Bits::new(n_distances - 1, 5));
        header.push(Bits::new(N_LENGTHS_OF_LENGTHS as u32 - 4, 4));
        let mut idx = 0;
        while idx < N_LENGTHS_OF_LENGTHS {
            header.push(Bits::new(LENGTHS_OF_LENGTHS[ORDER[idx]] as u32, 3));
            idx += 1;
        }
        header.push_lengths(lengths);
        let distance_length = 1;
        header.push(canonical(&LENGTHS_OF_LENGTHS)[distance_length]);
        header
    }

    const fn push_lengths(&mut self, lengths: &[u8; N_SYMBOLS]) {
        let codes = canonical(&LENGTHS_OF_LENGTHS);
        let mut symbol = 0;
        while symbol < N_SYMBOLS {
            let length = lengths[symbol];
            let mut n = 1;
            while symbol + n < N_SYMBOLS && lengths[symbol + n] == length && n < 7 {
                n += 1;
            }
            if length == 0 && n >= 3 {
                self.push(codes[17].then(Bits::new(n as u32 - 3, 3)));
            } else {
                self.push(codes[length as usize]);
                if n > 3 {
                    self.push(codes[16].then(Bits::new(n as u32 - 4, 2)));
                } else {
                    n = 1;
                }
            }
            symbol += n;
        }
    }

    const fn push(&mut self, bits: Bits) {
        let mut idx = 0;
        while idx < bits.n_bits() {
            let bit = (bits.value() >> idx & 1) as u8;
            self.bytes[self.n_bits / 8] |= bit << (self.n_bits % 8);
            self.n_bits += 1;
            idx += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_in_the_code_of_pixels_are_zero_bits() {
        // The encoder takes them off the end of a word.
        assert_eq!(PIXELS.literals[0].value(), 0);
        assert_eq!((PIXEL_QUADS[0].value(), PIXEL_QUADS[0].n_bits()), (0, 4 * PIXELS.literals[0].n_bits()));
    }

    #[test]
    fn a_word_and_the_run_before_it_have_room() {
        for code in [&PIXELS, &UNIFORM] {
            // Four literals, and seven bits that were left, fit between two flushes.
            assert!(code.literals.iter().all(|bits| (1..=12).contains(&bits.n_bits())));
            assert!(code.runs.iter().all(|run| run.n_bits() <= 24));
            assert!(code.longest.n_bits() <= 6);
        }
        assert!(PIXEL_QUADS.iter().all(|quad| quad.n_bits() <= 24));
    }
}
