//! The text that is drawn for people: that of a source, without what a terminal would obey, and with long lines cut around
//! the places that are marked.

use std::collections::HashMap;
use std::ops::Range;

use unicode_width::UnicodeWidthChar;

use crate::diag::words::is_unseen;
use crate::source::{Source, Span};

/// What stands for a part of a line that is not shown.
const ELLIPSIS: &str = "…";
/// The least columns around one of several places of a line.
const MIN_COLUMNS: usize = 12;
/// The byte-order mark, in UTF-8. It is not drawn and takes no column.
const BOM: &str = "\u{FEFF}";

/// The places that are marked in each line that is too long, by its index.
pub(super) type Marks = HashMap<usize, Vec<Span>>;

/// The text of a source made ready for drawing.
pub(super) struct Canvas<'s> {
    source: &'s Source,
    text: String,
    /// Where each line starts in the text; empty when no line is cut.
    starts: Vec<usize>,
    cuts: HashMap<usize, Cut>,
}

impl<'s> Canvas<'s> {
    /// Makes the canvas on which the lines of `marks` are cut to `width` columns. Other long lines are left out.
    pub fn new(source: &'s Source, marks: &Marks, width: usize) -> Self {
        let text = source.text();
        let mut canvas = Self { source, text: String::new(), starts: Vec::new(), cuts: HashMap::new() };
        if marks.is_empty() {
            canvas.text = harmless(text.strip_prefix(BOM).unwrap_or(text));
            return canvas;
        }
        for line in 0..source.lines().n_lines() {
            let span = visible_line(source, line);
            canvas.starts.push(canvas.text.len());
            if let Some(marks) = marks.get(&line) {
                let cut = Cut::new(text, span, marks, width);
                canvas.text.push_str(&cut.text);
                canvas.cuts.insert(line, cut);
            } else if !is_long(source, line, width) {
                canvas.text.push_str(&harmless(source.slice(span)));
            }
            canvas.text.push('\n');
        }
        canvas
    }

    /// Gives the text away.
    pub fn take_text(&mut self) -> String {
        std::mem::take(&mut self.text)
    }

    /// Returns the place of a span in the text.
    pub fn place(&self, span: Span) -> Range<usize> {
        let start = self.offset(span.start, Cut::start);
        let end = if span.is_empty() { start } else { self.offset(span.end, Cut::end) };
        start..end.max(start)
    }

    fn offset(&self, offset: u32, in_cut: fn(&Cut, u32) -> usize) -> usize {
        if self.starts.is_empty() {
            let n_cut = if self.source.text().starts_with(BOM) { BOM.len() } else { 0 };
            return (offset as usize).saturating_sub(n_cut);
        }
        let line = self.source.lines().line_of(offset);
        let within = match self.cuts.get(&line) {
            Some(cut) => in_cut(cut, offset),
            None => offset.saturating_sub(visible_line(self.source, line).start) as usize,
        };
        self.starts[line] + within
    }
}

/// Tells whether a line takes more than `width` columns.
pub(super) fn is_long(source: &Source, line: usize, width: usize) -> bool {
    const TAB: usize = 4;
    let text = source.slice(visible_line(source, line));
    // No character is wider than its bytes are many, but a tab.
    if text.len() <= width && !text.contains('\t') {
        return false;
    }
    let mut column = 0;
    text.chars().any(|character| {
        column = if character == '\t' { (column / TAB + 1) * TAB } else { column + columns(character) };
        column > width
    })
}

/// Returns the place of a line without a byte-order mark.
fn visible_line(source: &Source, line: usize) -> Span {
    let span = source.lines().line_span(source.text(), line);
    let n_cut = if line == 0 && source.text().starts_with(BOM) { BOM.len() as u32 } else { 0 };
    Span::new(span.start + n_cut, span.end.max(span.start + n_cut))
}

/// Returns how many columns a character takes, a tab as if it were a blank.
fn columns(character: char) -> usize {
    character.width().unwrap_or(1)
}

/// The pieces of a long line that are shown.
struct Cut {
    text: String,
    pieces: Vec<Piece>,
}

/// A piece of a line.
struct Piece {
    /// Where it stands in the source.
    span: Span,
    /// Where it stands in the cut line.
    start: usize,
}

impl Cut {
    fn new(text: &str, line: Span, marks: &[Span], width: usize) -> Self {
        let width = (width / marks.len().max(1)).max(MIN_COLUMNS);
        let mut windows: Vec<_> = marks.iter().map(|mark| window(text, line, *mark, width)).collect();
        windows.sort_unstable_by_key(|window| window.start);
        let mut cut = Self { text: String::new(), pieces: Vec::new() };
        let mut end = line.start;
        for window in merged(&windows) {
            if window.start > end {
                cut.text.push_str(ELLIPSIS);
            }
            cut.pieces.push(Piece { span: window, start: cut.text.len() });
            cut.text.push_str(&harmless(&text[window.range()]).replace('\t', " "));
            end = window.end;
        }
        if end < line.end {
            cut.text.push_str(ELLIPSIS);
        }
        cut
    }

    /// Returns where the character at `offset` stands, or the sign for what is left out.
    fn start(&self, offset: u32) -> usize {
        self.at(offset).unwrap_or_else(|left_out| left_out.start)
    }

    /// Returns where what ends at `offset` ends.
    fn end(&self, offset: u32) -> usize {
        self.at(offset).unwrap_or_else(|left_out| left_out.end)
    }

    /// Returns the place of `offset`, or that of the sign for what is left out there.
    fn at(&self, offset: u32) -> Result<usize, Range<usize>> {
        let next = self.pieces.partition_point(|piece| piece.span.start <= offset);
        let Some(piece) = next.checked_sub(1).map(|before| &self.pieces[before]) else {
            return Err(0..ELLIPSIS.len());
        };
        if offset <= piece.span.end {
            return Ok(piece.start + (offset - piece.span.start) as usize);
        }
        let end = piece.start + piece.span.len();
        Err(end..(end + ELLIPSIS.len()).min(self.text.len()))
    }
}

/// Joins windows that touch; they are sorted.
fn merged(windows: &[Span]) -> Vec<Span> {
    let mut merged: Vec<Span> = Vec::new();
    for &window in windows {
        match merged.last_mut() {
            Some(last) if window.start <= last.end + 1 => last.end = last.end.max(window.end),
            _ => merged.push(window),
        }
    }
    merged
}

/// Returns the part of a line that shows a mark, or as much of it as fits, in `width` columns with signs for what is left out.
fn window(text: &str, line: Span, mark: Span, width: usize) -> Span {
    let mark = Span::new(mark.start.clamp(line.start, line.end), mark.end.clamp(line.start, line.end));
    let mut room = width.saturating_sub(2);
    let before = &text[line.start as usize..mark.start as usize];
    // The words on a place stand behind its middle.
    let own_room = room / 2;
    let (own, taken) = fitting(text[mark.range()].chars(), own_room);
    room -= taken;
    let end = mark.start + own as u32;
    let after = &text[end as usize..line.end as usize];
    // What one side does not need the other gets.
    let (_, needed_after) = fitting(after.chars(), room / 2);
    let (n_before, taken) = fitting(before.chars().rev(), room - needed_after);
    let (n_after, _) = fitting(after.chars(), room - taken);
    Span::new(mark.start - n_before as u32, end + n_after as u32)
}

/// Returns how many bytes of `characters` fit into `room` columns, and how many columns they take.
fn fitting(characters: impl Iterator<Item = char>, room: usize) -> (usize, usize) {
    let (mut n_bytes, mut taken) = (0, 0);
    for character in characters {
        if taken + columns(character) > room {
            break;
        }
        (n_bytes, taken) = (n_bytes + character.len_utf8(), taken + columns(character));
    }
    (n_bytes, taken)
}

/// Replaces what a terminal would obey and what ariadne, unlike us, takes for a line end; every byte keeps its place.
fn harmless(text: &str) -> String {
    let is_blank = |character: char| character.is_whitespace() && !character.is_control();
    let is_kept = |character: char| {
        let is_shown = !is_unseen(character) || is_blank(character);
        matches!(character, '\n' | '\t') || (is_shown && !is_line_end(character))
    };
    if text.chars().all(is_kept) {
        return text.to_owned();
    }
    let mut harmless = String::with_capacity(text.len());
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        let is_crlf = character == '\r' && characters.peek() == Some(&'\n');
        match character.len_utf8() {
            _ if is_kept(character) || is_crlf => harmless.push(character),
            1 => harmless.push('?'),
            2 => harmless.push('¿'),
            3 => harmless.push('\u{FFFD}'),
            _ => harmless.push_str("\u{FFFD}?"),
        }
    }
    harmless
}

fn is_line_end(character: char) -> bool {
    matches!(character, '\u{85}' | '\u{2028}' | '\u{2029}')
}
