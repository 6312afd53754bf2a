//! Byte offsets to lines and columns.

use crate::source::Span;

/// A place as people and editors name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
pub struct Position {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters (Unicode scalar values), from 1.
    pub column: u32,
}

/// The line starts of one text, for looking up many places in it.
#[derive(Debug, Clone)]
pub struct LineIndex {
    /// Byte offset at which each line starts; never empty, the first is 0.
    starts: Vec<u32>,
}

impl LineIndex {
    /// Finds the line starts of `text`. A line ends with LF; the CR of a CRLF belongs to its line.
    #[must_use]
    pub fn new(text: &str) -> Self {
        let ends = memchr::memchr_iter(b'\n', text.as_bytes());
        let starts = std::iter::once(0).chain(ends.map(|end| end as u32 + 1)).collect();
        Self { starts }
    }

    /// Returns the number of lines; a text that ends with LF has an empty last line.
    #[must_use]
    pub fn n_lines(&self) -> usize {
        self.starts.len()
    }

    /// Returns the 0-based line that holds `offset`.
    #[must_use]
    pub fn line_of(&self, offset: u32) -> usize {
        self.starts.partition_point(|&start| start <= offset) - 1
    }

    /// Returns the bytes of 0-based `line` in `text` without its line end.
    #[must_use]
    pub fn line_span(&self, text: &str, line: usize) -> Span {
        let start = self.starts[line];
        let end = self.starts.get(line + 1).map_or(text.len() as u32, |&next| next - 1);
        let bytes = &text.as_bytes()[start as usize..end as usize];
        let has_cr = bytes.last() == Some(&b'\r') && line + 1 < self.starts.len();
        Span::new(start, end - u32::from(has_cr))
    }

    /// Returns line and column of a byte offset in `text`.
    ///
    /// An offset inside a character counts as that character; a byte-order mark takes no column.
    #[must_use]
    pub fn position(&self, text: &str, offset: u32) -> Position {
        let line = self.line_of(offset);
        let before = &text.as_bytes()[self.starts[line] as usize..(offset as usize).min(text.len())];
        let n_chars = before.iter().filter(|&&byte| byte & 0xC0 != 0x80).count();
        let has_bom = line == 0 && before.starts_with("\u{FEFF}".as_bytes());
        Position { line: line as u32 + 1, column: (n_chars - usize::from(has_bom)) as u32 + 1 }
    }
}
