//! Whole numbers on the command line.

use std::ops::RangeInclusive;

/// Returns the reader of a whole number in a range; a fault explains itself.
pub fn whole<T: TryFrom<u32>>(range: RangeInclusive<u32>) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text: &str| {
        let is_plain = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
        let number = text.parse().ok().filter(|number| is_plain && range.contains(number));
        let number = number.and_then(|number| T::try_from(number).ok());
        number.ok_or_else(|| format!("a whole number from {} to {} is meant", range.start(), range.end()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_taken_or_the_range_is_told() {
        let parse = whole::<u16>(1..=256);
        assert_eq!((parse("1"), parse("256")), (Ok(1), Ok(256)));
        for text in ["", "0", "257", "-1", "+1", "1.5", "x", "99999999999"] {
            assert_eq!(parse(text), Err("a whole number from 1 to 256 is meant".to_owned()), "{text}");
        }
    }
}
