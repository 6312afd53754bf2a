//! The short way for plain lines: in one pass over the bytes, without tokens.
//!
//! Nearly every line of a large scene is blank, a comment, or a command with as many numbers as it takes. Such a line is
//! read here, some eight times as fast as by way of tokens and grammar. Any other is left to them; what this way takes,
//! they would take too, and make the same of it (`testing::assert_ways_agree` holds both against each other).

use crate::source::Span;
use crate::syntax::spec::{self, Arguments, CommandSpec, MAX_NUMBERS};

/// What a plain line holds.
pub(super) enum PlainLine {
    /// Nothing but blanks and perhaps a comment.
    Empty,
    /// A command with all its arguments.
    Command {
        spec: &'static CommandSpec,
        /// From its name to its last argument.
        span: Span,
        /// Its numbers; the rest is 0.
        numbers: [f64; MAX_NUMBERS],
    },
}

/// Reads plain lines of one text, one after the other.
pub(super) struct PlainLines<'s> {
    text: &'s str,
    /// The next byte.
    at: usize,
    /// The command of the last line; a scene has long runs of one.
    last: &'static CommandSpec,
}

impl<'s> PlainLines<'s> {
    /// Begins at the line that starts at `at`.
    pub(super) fn new(text: &'s str, at: usize) -> Self {
        Self { text, at, last: &spec::COMMANDS[0] }
    }

    /// Returns where the next line starts.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// Goes on at the line that starts at `at`.
    pub(super) fn resume_at(&mut self, at: usize) {
        self.at = at;
    }

    /// Reads the next line and goes behind its end, if it is plain; otherwise goes anywhere.
    pub(super) fn read(&mut self) -> Option<PlainLine> {
        self.skip_blanks();
        let start = self.at;
        if self.skip_line_end()? {
            return Some(PlainLine::Empty);
        }
        let spec = self.read_name()?;
        let Arguments::Numbers(args) = spec.arguments else { return None };
        let mut numbers = [0.0; MAX_NUMBERS];
        for number in &mut numbers[..args.len()] {
            if !self.skip_blanks() {
                return None;
            }
            *number = self.read_number()?;
        }
        let span = Span::new(start as u32, self.at as u32);
        self.skip_blanks();
        self.skip_line_end()?.then_some(PlainLine::Command { spec, span, numbers })
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    /// Passes spaces and tabs; tells whether there were any.
    fn skip_blanks(&mut self) -> bool {
        let start = self.at;
        while let Some(b' ' | b'\t') = self.peek() {
            self.at += 1;
        }
        self.at > start
    }

    /// Passes a comment and the end of the line; tells whether the line ends here. `None` at a lone carriage return.
    fn skip_line_end(&mut self) -> Option<bool> {
        if self.peek() == Some(b'#') {
            let rest = &self.text.as_bytes()[self.at..];
            self.at += memchr::memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        }
        match &self.text.as_bytes()[self.at..] {
            [] => {}
            [b'\n', ..] => self.at += 1,
            [b'\r', b'\n', ..] => self.at += 2,
            [b'\r', ..] => return None,
            _ => return Some(false),
        }
        Some(true)
    }

    /// Reads the name of a command; what follows it is for others to look at.
    fn read_name(&mut self) -> Option<&'static CommandSpec> {
        let rest = &self.text.as_bytes()[self.at..];
        let is_here = |spec: &&CommandSpec| rest.starts_with(spec.name.as_bytes());
        let spec = Some(self.last).filter(is_here).or_else(|| spec::COMMANDS.iter().find(is_here))?;
        self.last = spec;
        self.at += spec.name.len();
        Some(spec)
    }

    /// Reads a number that the language has; what follows it is for others to look at.
    fn read_number(&mut self) -> Option<f64> {
        let start = self.at;
        let is_negative = self.peek() == Some(b'-');
        if let Some(b'+' | b'-') = self.peek() {
            self.at += 1;
        }
        let mut mantissa = Digits::default();
        self.read_digits(&mut mantissa);
        let n_whole = mantissa.n;
        if self.peek() == Some(b'.') {
            self.at += 1;
            self.read_digits(&mut mantissa);
        }
        if mantissa.n == 0 {
            return None;
        }
        let mut exponent = n_whole as i64 - mantissa.n as i64;
        if let Some(b'e' | b'E') = self.peek() {
            exponent += self.read_exponent()?;
        }
        let exact = mantissa.value().and_then(|mantissa| scale_exactly(mantissa, exponent));
        match exact {
            Some(number) => Some(if is_negative { -number } else { number }),
            None => self.text[start..self.at].parse().ok().filter(|number: &f64| number.is_finite()),
        }
    }

    /// Reads the exponent of a number, from its `e` on; one beyond any number stays beyond.
    fn read_exponent(&mut self) -> Option<i64> {
        const BEYOND: i64 = 1 << 40;
        self.at += 1;
        let is_negative = self.peek() == Some(b'-');
        if let Some(b'+' | b'-') = self.peek() {
            self.at += 1;
        }
        let mut digits = Digits::default();
        self.read_digits(&mut digits);
        let size = digits.value().map_or(BEYOND, |value| BEYOND.min(value as i64));
        (digits.n > 0).then_some(if is_negative { -size } else { size })
    }

    /// Appends the digits that stand here, eight at a time.
    fn read_digits(&mut self, digits: &mut Digits) {
        loop {
            let block = self.text.as_bytes().get(self.at..).and_then(<[u8]>::first_chunk::<BLOCK>);
            let n = match block {
                Some(block) => digits.push_block(*block),
                None => digits.push_block(self.last_block()),
            };
            self.at += n;
            if n < BLOCK {
                return;
            }
        }
    }

    /// Returns what is left of the text, filled up with what is no digit.
    #[cold]
    fn last_block(&self) -> [u8; BLOCK] {
        let rest = &self.text.as_bytes()[self.at..];
        std::array::from_fn(|i| rest.get(i).copied().unwrap_or(b'\n'))
    }
}

/// Returns `mantissa`·10^`exponent` where one rounding gives it: where both the mantissa and the power of ten are numbers.
///
/// # Source
/// Clinger, "How to read floating point numbers accurately", PLDI 1990, the fast path.
fn scale_exactly(mantissa: u64, exponent: i64) -> Option<f64> {
    /// The powers of ten that are numbers of binary64.
    const POWERS: [f64; 23] = [
        1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19,
        1e20, 1e21, 1e22,
    ];
    const LARGEST: u64 = 1 << f64::MANTISSA_DIGITS;
    let power = *POWERS.get(usize::try_from(exponent.unsigned_abs()).ok()?)?;
    let mantissa = (mantissa <= LARGEST).then_some(mantissa as f64)?;
    Some(if exponent < 0 { mantissa / power } else { mantissa * power })
}

/// The digits that are read in one step: those of a 64-bit word.
const BLOCK: usize = 8;

/// A whole number while its digits are read.
#[derive(Default)]
struct Digits {
    /// Its value as long as it has no more than [`Digits::MAX`] digits.
    value: u64,
    n: usize,
}

impl Digits {
    /// The most digits that a 64-bit number always holds.
    const MAX: usize = 19;

    fn value(&self) -> Option<u64> {
        (self.n <= Self::MAX).then_some(self.value)
    }

    /// Appends the digits at the beginning of `block` and returns how many there are.
    ///
    /// # Source
    /// Eight digits in three multiplications: Langdale, Lemire, "Parsing gigabytes of JSON per second", VLDB Journal 2019.
    /// We count the digits by the first byte that is none, and shift zeros before them.
    fn push_block(&mut self, block: [u8; BLOCK]) -> usize {
        const POWERS: [u64; BLOCK + 1] = [1, 10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];
        const EACH: u64 = 0x0101_0101_0101_0101;
        // A digit leaves 0 to 9; the first byte that leaves more has its high bit set, whatever the bytes behind it carry.
        let values = u64::from_le_bytes(block) ^ (EACH * u64::from(b'0'));
        let no_digits = (values.wrapping_add(EACH * 0x76) | values) & (EACH * 0x80);
        let n = no_digits.trailing_zeros() as usize / 8;
        let values = values.checked_shl(64 - 8 * n as u32).unwrap_or(0);
        // Pairs, then fours, then all eight; the first digit is in the lowest byte.
        let pairs = values.wrapping_mul(10).wrapping_add(values >> 8);
        const PAIRS: u64 = 0x0000_00FF_0000_00FF;
        let high = (pairs & PAIRS).wrapping_mul(100 + (1_000_000 << 32));
        let low = ((pairs >> 16) & PAIRS).wrapping_mul(1 + (10_000 << 32));
        let eight = high.wrapping_add(low) >> 32;
        self.value = self.value.wrapping_mul(POWERS[n]).wrapping_add(eight);
        self.n += n;
        n
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::spec::CommandKind;
    use crate::testing::Stream;

    /// Reads `number` as the argument of a `fov`, with nothing and with much behind it.
    fn read(number: &str) -> Option<f64> {
        let [end, middle] = ["", "\nfov 1"].map(|rest| {
            let text = format!("fov {number}{rest}");
            match PlainLines::new(&text, 0).read() {
                Some(PlainLine::Command { spec, span, numbers }) => {
                    assert_eq!((spec.kind, span.range()), (CommandKind::Fov, 0..4 + number.len()));
                    Some(numbers[0])
                }
                _ => None,
            }
        });
        assert_eq!(end.map(f64::to_bits), middle.map(f64::to_bits), "{number}");
        end
    }

    #[track_caller]
    fn check(number: &str) {
        let expected: f64 = number.parse().expect("a number");
        let expected = Some(expected).filter(|number| number.is_finite());
        assert_eq!(read(number).map(f64::to_bits), expected.map(f64::to_bits), "{number}");
    }

    #[test]
    fn a_number_is_the_nearest() {
        for number in [
            "0",
            "-0",
            "+0.0",
            "1.",
            ".5",
            "-.5e+1",
            "00000000000000000000007",
            "123456789",
            "1234567.12345678",
            "12345678.12345678",
            "9007199254740992",
            "9007199254740993",
            "9007199254740991e22",
            "1e22",
            "1e23",
            "1e-22",
            "1e-23",
            "0.1e-400",
            "1e400",
            "1e99999999999999999999",
            "1e-99999999999999999999",
            "18446744073709551615",
            "18446744073709551616",
            "9999999999999999999",
            "0.000000000000000000000000001",
            "2.2250738585072011e-308",
            "1.7976931348623157e308",
            "1.7976931348623159e308",
            "4.9406564584124654e-324",
            "179769313486231580793728971405303415079934132710037826936173778980444968292764750946649",
        ] {
            check(number);
        }
    }

    #[test]
    fn random_numbers_are_the_nearest() {
        let mut stream = Stream::new(1);
        for _ in 0..100_000 {
            let number = stream.of_any_scale(1 + stream.clone().bits() % 1000);
            check(&number.to_string());
            check(&format!("{number:e}"));
            check(&format!("{:.*}", stream.below(12), stream.between(-1e6, 1e6)));
            let (whole, n_zeros) = (stream.bits() >> stream.below(64), stream.below(20));
            check(&format!(
                "{whole}.{:0n_zeros$}{}e{}",
                0,
                stream.bits() >> stream.below(64),
                stream.below(40) as i64 - 20
            ));
        }
    }

    #[test]
    fn what_is_no_number_is_left_to_the_grammar() {
        for text in
            ["", ".", "-", "+-1", "1e", "1e+", "1.2.3", "1x", "1e5x", "0x10", "inf", "nan", "1_0", "1,5", "1\u{A0}"]
        {
            assert_eq!(read(text), None, "{text}");
        }
    }

    #[test]
    fn a_line_is_plain_or_left_to_the_grammar() {
        let is_plain = |text: &str| PlainLines::new(text, 0).read().is_some();
        for text in
            ["", "\n", "\r\n", " \t", "# \u{1}é\n", " fov\t60 # x\r\n", "fov 6#\n", "fov 60", "light 1 1 1 0 0 0\n"]
        {
            assert!(is_plain(text), "{text:?}");
        }
        for text in [
            "\r",
            "# x\ry\n",
            "fov",
            "fov 60 1",
            "fov60",
            "fove 60",
            "Fov 60",
            "fov 60\r",
            "fov 6 #\r#",
            "write a.png",
            "\u{FEFF}fov 60",
            "\u{A0}\n",
            "fov \u{1} 6",
            "fov 1e999",
        ] {
            assert!(!is_plain(text), "{text:?}");
        }
    }
}
