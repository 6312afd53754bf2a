//! The one thing that formatting does to a number: it gets a digit on both sides of its point.

/// A number, taken apart for alignment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parts<'s> {
    sign: &'s str,
    /// The digits before the point.
    whole: &'s str,
    /// From the point on, without the exponent.
    fraction: &'s str,
    exponent: &'s str,
    /// Whether a zero is missing before the point.
    has_zero_before: bool,
    /// Whether a zero is missing behind the point.
    has_zero_behind: bool,
}

impl<'s> Parts<'s> {
    /// Takes a number of the language apart.
    pub(super) fn of(number: &'s str) -> Self {
        let bytes = number.as_bytes();
        let end_of_digits = |from: usize| from + bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        let n_sign = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
        let point = end_of_digits(n_sign);
        let has_point = bytes.get(point) == Some(&b'.');
        let end = if has_point { end_of_digits(point + 1) } else { point };
        Self {
            sign: &number[..n_sign],
            whole: &number[n_sign..point],
            fraction: &number[point..end],
            exponent: &number[end..],
            has_zero_before: has_point && point == n_sign,
            has_zero_behind: has_point && end == point + 1,
        }
    }

    /// Returns how many characters stand before the place of the point.
    pub(super) fn n_before(&self) -> usize {
        self.sign.len() + self.whole.len() + usize::from(self.has_zero_before)
    }

    /// Returns how many characters stand from the place of the point on.
    pub(super) fn n_behind(&self) -> usize {
        self.fraction.len() + self.exponent.len() + usize::from(self.has_zero_behind)
    }

    /// Appends the number, completed.
    pub(super) fn push_to(&self, out: &mut String) {
        out.push_str(self.sign);
        out.push_str(if self.has_zero_before { "0" } else { self.whole });
        out.push_str(self.fraction);
        if self.has_zero_behind {
            out.push('0');
        }
        out.push_str(self.exponent);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_bare_point_gets_zeros() {
        for (number, expected) in [
            (".5", "0.5"),
            ("1.", "1.0"),
            ("-.5e3", "-0.5e3"),
            ("+1.E-3", "+1.0E-3"),
            ("-.0", "-0.0"),
            ("007", "007"),
            ("0.50", "0.50"),
            ("+4", "+4"),
            ("1e-3", "1e-3"),
        ] {
            for text in [number, expected] {
                let parts = Parts::of(text);
                let mut completed = String::new();
                parts.push_to(&mut completed);
                assert_eq!(completed, expected);
                assert_eq!(parts.n_before() + parts.n_behind(), expected.len(), "{text}");
            }
            let bits = |number: &str| number.parse().map(f64::to_bits);
            assert_eq!(bits(number), bits(expected), "{number}");
        }
    }
}
