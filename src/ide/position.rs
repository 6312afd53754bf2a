//! Lines and columns as editors count them: from 0, in units that editor and server agree on.
//!
//! A line ends with LF, CRLF or CR here, as the Language Server Protocol has it.

use crate::source::Span;

/// A place as an editor names it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position {
    /// Line, from 0.
    pub line: u32,
    /// Column, from 0, in units of the encoding.
    pub column: u32,
}

/// What a column counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Unit {
    /// Bytes.
    Utf8,
    /// Units of UTF-16.
    #[default]
    Utf16,
    /// Unicode scalar values.
    Utf32,
}

impl Unit {
    /// Returns how many units a character takes.
    const fn width(self, character: char) -> u32 {
        match self {
            Self::Utf8 => character.len_utf8() as u32,
            Self::Utf16 => character.len_utf16() as u32,
            Self::Utf32 => 1,
        }
    }
}

/// The lines of one text.
#[derive(Clone, Debug)]
pub struct Lines {
    /// Byte offset at which each line starts; never empty, the first is 0.
    starts: Vec<u32>,
}

impl Lines {
    /// Finds the lines of `text`.
    #[must_use]
    pub fn new(text: &str) -> Self {
        let bytes = text.as_bytes();
        let is_end = |&end: &usize| bytes[end] == b'\n' || bytes.get(end + 1) != Some(&b'\n');
        let ends = memchr::memchr2_iter(b'\n', b'\r', bytes).filter(is_end);
        Self { starts: std::iter::once(0).chain(ends.map(|end| end as u32 + 1)).collect() }
    }

    /// Returns the number of lines; behind the last line end there is one more.
    #[must_use]
    pub fn n_lines(&self) -> usize {
        self.starts.len()
    }

    /// Returns where a line starts; the end of `text` for lines that do not exist.
    #[must_use]
    pub fn start(&self, text: &str, line: u32) -> u32 {
        self.starts.get(line as usize).map_or(text.len() as u32, |&start| start)
    }

    /// Returns a line without its end.
    #[must_use]
    pub fn span(&self, text: &str, line: u32) -> Span {
        let (start, next) = (self.start(text, line), self.start(text, line.saturating_add(1)));
        Span::new(start, start + text[start as usize..next as usize].trim_end_matches(['\n', '\r']).len() as u32)
    }

    /// Returns the line that holds `offset`.
    #[must_use]
    pub fn line_of(&self, offset: u32) -> u32 {
        self.starts.partition_point(|&start| start <= offset) as u32 - 1
    }

    /// Returns the byte that an editor means. A place behind its line means the end of the line, one inside a character the
    /// start of the character.
    #[must_use]
    pub fn offset(&self, text: &str, position: Position, unit: Unit) -> u32 {
        let line = self.span(text, position.line);
        let mut column = 0;
        for (at, character) in text[line.range()].char_indices() {
            column += unit.width(character);
            if column > position.column {
                return line.start + at as u32;
            }
        }
        line.end
    }

    /// Returns the place of a byte.
    #[must_use]
    pub fn position(&self, text: &str, offset: u32, unit: Unit) -> Position {
        let offset = offset.min(text.len() as u32);
        let line = self.line_of(offset);
        let before = &text.as_bytes()[self.starts[line as usize] as usize..offset as usize];
        let column = match (unit, std::str::from_utf8(before)) {
            (Unit::Utf8, _) | (_, Err(_)) => before.len() as u32,
            (_, Ok(before)) => before.chars().map(|character| unit.width(character)).sum(),
        };
        Position { line, column }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_counted_in_every_unit() {
        let text = "a\u{FEFF}\u{1F600}é\r\n\rx\n";
        let lines = Lines::new(text);
        assert_eq!(lines.n_lines(), 4);
        for (unit, columns) in
            [(Unit::Utf8, [0, 1, 4, 8, 10]), (Unit::Utf16, [0, 1, 2, 4, 5]), (Unit::Utf32, [0, 1, 2, 3, 4])]
        {
            for (offset, column) in [0, 1, 4, 8, 10].into_iter().zip(columns) {
                let position = Position { line: 0, column };
                assert_eq!(lines.position(text, offset, unit), position, "{unit:?}");
                assert_eq!(lines.offset(text, position, unit), offset, "{unit:?}");
            }
        }
        assert_eq!(lines.offset(text, Position { line: 0, column: 3 }, Unit::Utf16), 4, "inside a character");
        assert_eq!(lines.offset(text, Position { line: 0, column: 99 }, Unit::Utf16), 10, "behind a line");
        assert_eq!(lines.offset(text, Position { line: 99, column: 1 }, Unit::Utf16), text.len() as u32);
        assert_eq!(lines.position(text, 13, Unit::Utf16), Position { line: 2, column: 0 });
        assert_eq!((lines.span(text, 1), lines.span(text, 3)), (Span::new(12, 12), Span::new(15, 15)));
    }
}
