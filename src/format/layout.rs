//! Lines in, lines out: paragraph by paragraph.

use std::borrow::Cow;

use crate::format::columns::Columns;
use crate::format::lines::{Line, LineKind, Lines};
use crate::source::{Source, Span};

/// How far apart the stops of the tabulator are when columns of the old text are compared.
const TAB: usize = 8;

/// A stretch of whole lines and what it becomes. The pieces of a scene tile its text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece<'a> {
    /// The lines, with their ends.
    pub old: Span,
    /// What they become, with line ends.
    pub new: Cow<'a, [u8]>,
}

/// Lays a scene out and hands over its pieces in order.
pub(super) fn lay_out(source: &Source, take: impl FnMut(Piece<'_>)) {
    let mut lines = Lines::new(source);
    let whole = Span::new(0, source.text().len() as u32);
    let mut layout = Layout::new(source, take);
    if lines.is_unreadable() {
        return layout.keep(&lines, whole);
    }
    while let Some(line) = lines.next() {
        match line.kind {
            LineKind::Bom => layout.keep(&lines, line.span),
            LineKind::Blank => {
                layout.end_paragraph(&lines);
                layout.blanks = Some(layout.blanks.map_or(line.span, |blanks| blanks.to(line.span)));
            }
            LineKind::Comment(_) | LineKind::Command { .. } | LineKind::Verbatim => {
                layout.settle_blanks(&lines, line.kind);
                layout.paragraph.push(line);
            }
        }
    }
    layout.end_paragraph(&lines);
    if let Some(blanks) = layout.blanks {
        layout.give(blanks, Cow::Borrowed(b""));
    }
}

/// The state between two lines.
struct Layout<'s, F> {
    source: &'s Source,
    take: F,
    /// How every line ends.
    line_end: &'static str,
    /// The lines since the last blank one.
    paragraph: Vec<Line>,
    /// Blank lines that nothing has followed yet.
    blanks: Option<Span>,
    /// Whether a line that is not blank has been seen.
    has_begun: bool,
    /// The line being written; kept from line to line to save allocations.
    text: String,
}

impl<'s, F: FnMut(Piece<'_>)> Layout<'s, F> {
    fn new(source: &'s Source, take: F) -> Self {
        Self {
            source,
            take,
            line_end: line_end(source.text()),
            paragraph: Vec::new(),
            blanks: None,
            has_begun: false,
            text: String::new(),
        }
    }

    fn give(&mut self, old: Span, new: Cow<'_, [u8]>) {
        (self.take)(Piece { old, new });
    }

    /// Leaves a stretch as it is.
    fn keep(&mut self, lines: &Lines<'_>, old: Span) {
        self.give(old, Cow::Borrowed(lines.bytes(old)));
    }

    /// Makes one of the blank lines before a line, none at the start of the file. What begins a file may mean something
    /// there, as a byte-order mark does: no line with an error comes to stand there.
    fn settle_blanks(&mut self, lines: &Lines<'_>, next: LineKind) {
        let has_begun = std::mem::replace(&mut self.has_begun, true);
        let Some(blanks) = self.blanks.take() else { return };
        match (has_begun, next) {
            (true, _) => self.give(blanks, Cow::Borrowed(self.line_end.as_bytes())),
            (false, LineKind::Verbatim) => self.keep(lines, blanks),
            (false, _) => self.give(blanks, Cow::Borrowed(b"")),
        }
    }

    /// Measures the lines of the paragraph, writes them and forgets them.
    fn end_paragraph(&mut self, lines: &Lines<'_>) {
        if self.paragraph.is_empty() {
            return;
        }
        let paragraph = std::mem::take(&mut self.paragraph);
        let mut columns = Columns::default();
        for line in &paragraph {
            if let LineKind::Command { kind, span, comment } = line.kind {
                columns.measure(kind, self.source.slice(span), comment.is_some());
            }
        }
        let mut anchor = None;
        for line in &paragraph {
            self.write(lines, &columns, line, &mut anchor);
        }
        self.paragraph = paragraph;
        self.paragraph.clear();
    }

    /// Writes one line. `anchor` is where the comment of the line above began and begins, if it had one behind a command.
    fn write(&mut self, lines: &Lines<'_>, columns: &Columns, line: &Line, anchor: &mut Option<(usize, usize)>) {
        let mut text = std::mem::take(&mut self.text);
        text.clear();
        let old_column = |at: u32| column_behind(self.source.slice(Span::new(line.span.start, at)));
        match line.kind {
            LineKind::Command { kind, span, comment } => {
                columns.write(kind, self.source.slice(span), &mut text);
                *anchor = comment.map(|comment| {
                    columns.write_blanks_before_comment(kind, text.chars().count(), &mut text);
                    let columns = (old_column(comment.start), column_behind(&text));
                    text.push_str(self.source.slice(comment));
                    columns
                });
            }
            LineKind::Comment(comment) => {
                *anchor = anchor.filter(|(old, _)| *old == old_column(comment.start));
                if let Some((_, new)) = *anchor {
                    text.extend(std::iter::repeat_n(' ', new));
                }
                text.push_str(self.source.slice(comment));
            }
            LineKind::Verbatim | LineKind::Blank | LineKind::Bom => {
                *anchor = None;
                let kept = with_line_end(lines.bytes(line.span), self.line_end);
                self.give(line.span, kept);
                self.text = text;
                return;
            }
        }
        text.push_str(self.line_end);
        self.give(line.span, Cow::Borrowed(text.as_bytes()));
        self.text = text;
    }
}

/// Returns the line end of the whole file: CRLF if all are.
fn line_end(text: &str) -> &'static str {
    let bytes = text.as_bytes();
    let mut ends = memchr::memchr_iter(b'\n', bytes).peekable();
    let has_ends = ends.peek().is_some();
    let all_have_returns = ends.all(|end| end > 0 && bytes[end - 1] == b'\r');
    if has_ends && all_have_returns { "\r\n" } else { "\n" }
}

/// Returns a line with this line end in place of its own. One that ends in a lone carriage return keeps its end, since
/// both would make a CRLF.
fn with_line_end<'l>(line: &'l [u8], line_end: &str) -> Cow<'l, [u8]> {
    let text = match line {
        [text @ .., b'\r', b'\n'] | [text @ .., b'\n'] | text => text,
    };
    if text.ends_with(b"\r") || line[text.len()..] == *line_end.as_bytes() {
        return Cow::Borrowed(line);
    }
    Cow::Owned([text, line_end.as_bytes()].concat())
}

/// Returns the column that follows `text` on its line, from 0.
fn column_behind(text: &str) -> usize {
    text.chars().fold(0, |column, character| match character {
        '\t' => (column / TAB + 1) * TAB,
        _ => column + 1,
    })
}
