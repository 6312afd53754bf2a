//! Which kind of line a line is, for layout.

use std::borrow::Cow;

use crate::format::errors::{Known, know};
use crate::source::{Source, Span};
use crate::syntax::directive;
use crate::syntax::spec::CommandKind;

/// The byte-order mark, in UTF-8.
const BOM: &str = "\u{FEFF}";

/// A line from one LF to the next, or what one is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Line {
    /// With its end.
    pub(super) span: Span,
    pub(super) kind: LineKind,
}

/// What a line holds. Spans reach from the first to the last character that is no blank.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LineKind {
    /// The byte-order mark, taken for a line of its own.
    Bom,
    /// Nothing but blanks.
    Blank,
    /// A comment alone.
    Comment(Span),
    /// A whole command.
    Command {
        kind: CommandKind,
        /// Without its comment.
        span: Span,
        /// The comment behind it.
        comment: Option<Span>,
    },
    /// It stays as it is.
    Verbatim,
}

/// Reads the lines of a scene, one after the other.
#[derive(Debug)]
pub(super) struct Lines<'s> {
    source: &'s Source,
    /// The bytes of the file.
    original: Cow<'s, [u8]>,
    known: Known,
    /// Where the next line starts.
    at: usize,
    next_command: usize,
    next_error: usize,
    is_fenced: bool,
}

impl<'s> Lines<'s> {
    /// Begins at the start of the scene.
    pub(super) fn new(source: &'s Source) -> Self {
        let original = source.original_bytes();
        Self { source, original, known: know(source), at: 0, next_command: 0, next_error: 0, is_fenced: false }
    }

    /// Tells whether no line can be read.
    pub(super) fn is_unreadable(&self) -> bool {
        self.known.is_unreadable
    }

    /// Returns the bytes of the file below `span`.
    pub(super) fn bytes(&self, span: Span) -> &[u8] {
        &self.original[span.range()]
    }

    /// Returns the place of the part of `span` without blanks before and behind it.
    fn trimmed(&self, span: Span) -> Span {
        let is_blank = |byte: &u8| matches!(byte, b' ' | b'\t');
        let bytes = &self.source.text().as_bytes()[span.range()];
        let n_before = bytes.iter().take_while(|byte| is_blank(byte)).count();
        let n_behind = bytes[n_before..].iter().rev().take_while(|byte| is_blank(byte)).count();
        Span::new(span.start + n_before as u32, span.end - n_behind as u32)
    }

    /// Tells what the line `text`, without its end, holds; `end` is where the next line starts.
    fn classify(&mut self, text: Span, end: u32) -> LineKind {
        let first = self.next_command;
        while self.known.commands.get(self.next_command).is_some_and(|(span, _)| span.start < end) {
            self.next_command += 1;
        }
        let has_error = self.known.errors.get(self.next_error).is_some_and(|&error| error < end || end == self.end());
        while self.known.errors.get(self.next_error).is_some_and(|&error| error < end) {
            self.next_error += 1;
        }
        let body = self.trimmed(text);
        let directive = Some(self.source.slice(body)).filter(|body| body.starts_with('#')).and_then(directive);
        if has_error || memchr::memchr2(b'\r', 0, self.source.slice(text).as_bytes()).is_some() {
            return LineKind::Verbatim;
        }
        if self.is_fenced && directive != Some("on") {
            return LineKind::Verbatim;
        }
        match directive {
            Some("off") => self.is_fenced = true,
            Some("on") => self.is_fenced = false,
            _ => {}
        }
        match &self.known.commands[first..self.next_command] {
            [] if body.is_empty() => LineKind::Blank,
            [] if self.source.slice(body).starts_with('#') => LineKind::Comment(body),
            &[(span, kind)] if span.start == body.start => {
                let comment = self.trimmed(Span::new(span.end, body.end.max(span.end)));
                LineKind::Command { kind, span, comment: (!comment.is_empty()).then_some(comment) }
            }
            // Nothing else is left once errors are; if it were, it would stay as it is.
            _ => LineKind::Verbatim,
        }
    }

    fn end(&self) -> u32 {
        self.source.text().len() as u32
    }
}

impl Iterator for Lines<'_> {
    type Item = Line;

    fn next(&mut self) -> Option<Line> {
        let rest = &self.source.text().as_bytes()[self.at..];
        if rest.is_empty() {
            return None;
        }
        let start = self.at as u32;
        if start == 0 && self.source.text().starts_with(BOM) {
            self.at = BOM.len();
            return Some(Line { span: Span::new(0, self.at as u32), kind: LineKind::Bom });
        }
        let newline = memchr::memchr(b'\n', rest);
        let text = match newline.map(|newline| &rest[..newline]) {
            None => rest,
            Some([text @ .., b'\r']) => text,
            Some(text) => text,
        };
        let text = Span::new(start, start + text.len() as u32);
        self.at = newline.map_or(self.source.text().len(), |newline| self.at + newline + 1);
        let end = self.at as u32;
        let kind = self.classify(text, end);
        Some(Line { span: Span::new(start, end), kind })
    }
}
