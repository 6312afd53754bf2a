//! The drawing for people: the lines that a diagnostic speaks of, with its places marked.
//!
//! The drawing is ariadne's; this file is the only one that knows it. Three things are ours: the header, because the code
//! belongs to the diagnostic; lines too long for a screen, of which a piece is shown; and the text itself, in which
//! nothing that a terminal would obey is left.

use std::borrow::Cow;
use std::io::{self, Write};
use std::ops::Range;

use ariadne::{Config, IndexType, Label, Report, ReportKind};

use crate::diag::render::{self, short};
use crate::diag::{Diagnostic, Severity};
use crate::source::{Source, Span};

/// A line with more characters than this is not shown whole.
const MAX_LINE_CHARS: usize = 300;
/// How many characters of such a line are shown on either side of a place.
const CONTEXT_CHARS: usize = 30;
/// The most diagnostics of one source that are drawn; the others get a line each.
const MAX_DRAWN: usize = 500;
/// The byte-order mark, in UTF-8. It is not drawn and takes no column.
const BOM: &str = "\u{FEFF}";

/// A place as ariadne takes it: the name of the source and a range of bytes.
type Place<'a> = (&'a str, Range<usize>);

/// Whether the drawing may hold colours (ANSI escapes).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Color {
    /// For a terminal.
    Always,
    /// For a file or a pipe.
    Never,
}

/// Draws each diagnostic with the lines it speaks of.
///
/// # Errors
/// Those of `out`.
pub fn render_human(source: &Source, diagnostics: &[Diagnostic], color: Color, out: &mut dyn Write) -> io::Result<()> {
    if diagnostics.is_empty() {
        return Ok(());
    }
    let canvas = Canvas::new(source, color);
    let (drawn, others) = diagnostics.split_at(diagnostics.len().min(MAX_DRAWN));
    for diagnostic in drawn {
        canvas.write_header(diagnostic, out)?;
        if canvas.fits(diagnostic) {
            canvas.draw(diagnostic, out)?;
        } else {
            canvas.draw_piece(diagnostic, out)?;
        }
        writeln!(out)?;
    }
    others.iter().try_for_each(|diagnostic| short::write_line(source, diagnostic, out))
}

/// A source made ready for drawing.
struct Canvas<'s> {
    source: &'s Source,
    /// The name of the source.
    name: Cow<'s, str>,
    color: Color,
    /// How much shorter the drawn text is than the source: the length of a byte-order mark.
    n_cut: u32,
    drawn: ariadne::Source<String>,
}

impl<'s> Canvas<'s> {
    fn new(source: &'s Source, color: Color) -> Self {
        let text = source.text();
        let visible = text.strip_prefix(BOM).unwrap_or(text);
        let n_cut = (text.len() - visible.len()) as u32;
        let name = render::harmless(source.name());
        Self { source, name, color, n_cut, drawn: ariadne::Source::from(harmless(visible)) }
    }

    /// Tells whether all lines that the diagnostic speaks of can be shown.
    fn fits(&self, diagnostic: &Diagnostic) -> bool {
        let labels = std::iter::once(&diagnostic.primary).chain(&diagnostic.secondary);
        labels.into_iter().all(|label| self.line_at(label.span.start).len() <= MAX_LINE_CHARS)
    }

    fn line_at(&self, offset: u32) -> Span {
        let lines = self.source.lines();
        lines.line_span(self.source.text(), lines.line_of(offset))
    }

    fn write_header(&self, diagnostic: &Diagnostic, out: &mut dyn Write) -> io::Result<()> {
        let (word, id) = (diagnostic.severity().word(), diagnostic.code.id);
        let (on, off) = match (self.color, diagnostic.severity()) {
            (Color::Never, _) => ("", ""),
            (Color::Always, Severity::Error) => ("\u{1B}[31m", "\u{1B}[0m"),
            (Color::Always, Severity::Warning) => ("\u{1B}[33m", "\u{1B}[0m"),
        };
        writeln!(out, "{on}{word}[{id}]{off}: {}", diagnostic.message)
    }

    /// Draws with ariadne, whose own header and trailing blanks are left out.
    fn draw(&self, diagnostic: &Diagnostic, out: &mut dyn Write) -> io::Result<()> {
        let mut drawing = Vec::new();
        self.report(diagnostic).write((&*self.name, &self.drawn), &mut drawing)?;
        let drawing = String::from_utf8_lossy(&drawing);
        drawing.lines().skip(1).try_for_each(|line| writeln!(out, "{}", line.trim_end()))
    }

    fn report<'a>(&'a self, diagnostic: &'a Diagnostic) -> Report<'a, Place<'a>> {
        let has_color = self.color == Color::Always;
        let (kind, primary_color) = match diagnostic.severity() {
            Severity::Error => (ReportKind::Error, ariadne::Color::Red),
            Severity::Warning => (ReportKind::Warning, ariadne::Color::Yellow),
        };
        let mut labels: Vec<_> = diagnostic.secondary.iter().map(|label| (label, ariadne::Color::Blue)).collect();
        labels.push((&diagnostic.primary, primary_color));
        labels.sort_by_key(|(label, _)| label.span);
        let labels = labels
            .into_iter()
            .map(|(label, color)| Label::new(self.place(label.span)).with_message(&label.message).with_color(color));
        let config = Config::new().with_color(has_color).with_index_type(IndexType::Byte);
        let mut report =
            Report::build(kind, self.place(diagnostic.primary.span)).with_config(config).with_labels(labels);
        if let Some(help) = &diagnostic.help {
            report.set_help(help);
        }
        if let Some(note) = &diagnostic.note {
            report.set_note(note);
        }
        report.finish()
    }

    fn place(&self, span: Span) -> Place<'_> {
        let shifted = |offset: u32| offset.saturating_sub(self.n_cut) as usize;
        (&*self.name, shifted(span.start)..shifted(span.end))
    }

    /// Draws the primary place alone, with a piece of its line.
    fn draw_piece(&self, diagnostic: &Diagnostic, out: &mut dyn Write) -> io::Result<()> {
        let text = self.source.text();
        let place = self.source.lines().position(text, diagnostic.primary.span.start);
        let piece = Piece::new(text, self.line_at(diagnostic.primary.span.start), diagnostic.primary.span);
        let number = place.line.to_string();
        let margin = " ".repeat(number.len());
        writeln!(out, " {margin} ╭─[ {}:{}:{} ]", self.name, place.line, place.column)?;
        writeln!(out, " {margin} │")?;
        writeln!(out, " {number} │ {}", piece.text)?;
        writeln!(out, " {margin} │ {}{}", " ".repeat(piece.n_before), "─".repeat(piece.n_marked))?;
        writeln!(out, " {margin} │ {}{}", " ".repeat(piece.n_before), diagnostic.primary.message)?;
        for (word, text) in [("Help", &diagnostic.help), ("Note", &diagnostic.note)] {
            if let Some(text) = text {
                writeln!(out, " {margin} │\n {margin} │ {word}: {text}")?;
            }
        }
        writeln!(out, "─{}─╯", "─".repeat(number.len()))
    }
}

/// The piece of a long line around a place.
struct Piece {
    text: String,
    /// Characters before the place.
    n_before: usize,
    /// Characters of the place itself.
    n_marked: usize,
}

impl Piece {
    fn new(text: &str, line: Span, place: Span) -> Self {
        let before = &text[line.start as usize..place.start as usize];
        let before: Vec<char> = before.chars().rev().take(CONTEXT_CHARS).collect();
        let before: String = before.into_iter().rev().collect();
        let end = place.end.min(line.end).max(place.start);
        let marked: String = text[place.start as usize..end as usize].chars().take(2 * CONTEXT_CHARS).collect();
        let shown_end = place.start as usize + marked.len();
        let after: String =
            text[shown_end..line.end.max(shown_end as u32) as usize].chars().take(CONTEXT_CHARS).collect();
        let is_cut = |is_cut: bool| if is_cut { "…" } else { "" };
        let cut_before = is_cut(line.start as usize + before.len() < place.start as usize);
        let cut_after = is_cut(shown_end + after.len() < line.end as usize);
        let n_before = before.chars().count() + cut_before.chars().count();
        let n_marked = marked.chars().count().max(1);
        let text = harmless(&format!("{cut_before}{before}{marked}{after}{cut_after}")).replace('\t', " ");
        Self { text, n_before, n_marked }
    }
}

/// Replaces what a terminal would obey and what ariadne, unlike us, takes for a line end; every byte keeps its place.
fn harmless(text: &str) -> String {
    let is_kept =
        |character: char| matches!(character, '\n' | '\t') || !(character.is_control() || is_line_end(character));
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
            _ => harmless.push('\u{FFFD}'),
        }
    }
    harmless
}

fn is_line_end(character: char) -> bool {
    matches!(character, '\u{85}' | '\u{2028}' | '\u{2029}')
}
