//! The text of one open file.

use std::cell::OnceCell;
use std::ops::Range;

use crate::ide::found::Found;
use crate::ide::position::{Lines, Position, Unit};
use crate::lint::{Options, lint};
use crate::source::{Source, SourceError, Span};
use crate::syntax::ast::{self, File, Shape};
use crate::syntax::spec::CommandKind;
use crate::syntax::{editions, parse};

/// One step of editing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// The places between which the text is replaced; the whole text if there are none. The first lies before the second,
    /// otherwise they are taken the other way round.
    pub range: Option<Range<Position>>,
    /// What stands there afterwards.
    pub text: String,
}

/// An open scene. It is read again only when it is asked after a change, and then once for all questions.
#[derive(Debug)]
pub struct Document {
    source: Source,
    lines: Lines,
    file: OnceCell<File>,
    is_of_other_edition: OnceCell<bool>,
}

impl Document {
    /// Opens a text. `name` is what messages call it.
    ///
    /// # Errors
    /// [`SourceError::TooLarge`] from 4 GiB on.
    pub fn new(name: &str, text: String) -> Result<Self, SourceError> {
        let lines = Lines::new(&text);
        let source = Source::from_bytes(name, text.into_bytes())?;
        Ok(Self { source, lines, file: OnceCell::new(), is_of_other_edition: OnceCell::new() })
    }

    /// Carries out changes, one after the other: the places of each are those that the one before has left.
    ///
    /// Changes that go from the end of the text to its start, as editors send them for many cursors, are carried out in one
    /// pass.
    ///
    /// # Errors
    /// [`SourceError::TooLarge`] when the text would become too long; it is then empty.
    pub fn change(&mut self, changes: Vec<Change>, unit: Unit) -> Result<(), SourceError> {
        // Edits of the text as it stands, from its end to its start.
        let mut pending: Vec<(Span, String)> = Vec::new();
        for Change { range, text } in changes {
            let Some(range) = range else {
                pending = vec![(Span::new(0, self.text().len() as u32), text)];
                self.carry_out(&mut pending)?;
                continue;
            };
            let (start, end) = (range.start.min(range.end), range.start.max(range.end));
            if let Some((next, _)) = pending.last()
                && self.lines.position(self.text(), next.start, unit) < end
            {
                self.carry_out(&mut pending)?;
            }
            let [start, end] = [start, end].map(|position| self.lines.offset(self.text(), position, unit));
            pending.push((Span::new(start, end), text));
        }
        self.carry_out(&mut pending)
    }

    fn carry_out(&mut self, edits: &mut Vec<(Span, String)>) -> Result<(), SourceError> {
        if edits.is_empty() {
            return Ok(());
        }
        let name = self.source.name().to_owned();
        let text = std::mem::replace(&mut self.source, Source::new("", "")).into_text();
        let text = replaced(text, edits);
        edits.clear();
        *self = Self::new(&name, text)?;
        Ok(())
    }

    /// Returns the text.
    #[must_use]
    pub fn text(&self) -> &str {
        self.source.text()
    }

    /// Returns the text as a source.
    #[must_use]
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// Returns the lines as an editor counts them.
    #[must_use]
    pub fn lines(&self) -> &Lines {
        &self.lines
    }

    /// Returns the tree; made at the first call.
    #[must_use]
    pub fn file(&self) -> &File {
        self.file.get_or_init(|| parse(&self.source).file)
    }

    /// Tells whether the scene is written in another edition of the language, so that its numbers mean something else than
    /// the command table says.
    pub(super) fn is_of_other_edition(&self) -> bool {
        let judge = || editions::judge(&self.source).is_some_and(|verdict| verdict.is_certain);
        *self.is_of_other_edition.get_or_init(judge)
    }

    /// Does the work of [`diagnostics_of`].
    #[must_use]
    pub fn diagnostics(&self, options: &Options) -> Found {
        diagnostics_of(&self.source, options)
    }

    /// Returns the commands that start in `span`.
    pub(super) fn commands_in(&self, span: Span) -> impl Iterator<Item = ast::Command<'_>> {
        let is_before = move |command: &ast::Command<'_>| command.span.start < span.start;
        self.file().commands().skip_while(is_before).take_while(move |command| command.span.start < span.end)
    }
}

/// Finds what is wrong with a scene: what the compiler and the rules find and nothing allows.
#[must_use]
pub fn diagnostics_of(source: &Source, options: &Options) -> Found {
    let found = lint(source, options);
    Found { listed: found.diagnostics, n_errors: found.n_errors, n_warnings: found.n_warnings }
}

/// Returns the kind of a command, as far as it can be told.
pub(super) const fn kind_of(command: &ast::Command<'_>) -> Option<CommandKind> {
    match command.shape {
        Shape::Whole(kind) => Some(kind),
        Shape::Bad(kind) => kind,
    }
}

/// Replaces parts of a text. The edits go from its end to its start and do not overlap.
fn replaced(mut text: String, edits: &[(Span, String)]) -> String {
    if let [(span, replacement)] = edits {
        text.replace_range(span.range(), replacement);
        return text;
    }
    let mut whole = String::with_capacity(text.len() + edits.iter().map(|(_, text)| text.len()).sum::<usize>());
    let mut end = 0;
    for (span, replacement) in edits.iter().rev() {
        whole.push_str(&text[end..span.start as usize]);
        whole.push_str(replacement);
        end = span.end as usize;
    }
    whole + &text[end..]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Stream;

    fn change(start: (u32, u32), end: (u32, u32), text: &str) -> Change {
        let position = |(line, column)| Position { line, column };
        Change { range: Some(position(start)..position(end)), text: text.to_owned() }
    }

    fn edited(text: &str, changes: &[Change]) -> String {
        let mut document = Document::new("a.cli", text.to_owned()).unwrap();
        document.change(changes.to_vec(), Unit::Utf16).unwrap();
        document.text().to_owned()
    }

    #[test]
    fn each_change_has_the_places_that_the_one_before_has_left() {
        assert_eq!(edited("ab\ncd\n", &[change((0, 1), (1, 1), "x"), change((0, 2), (0, 3), "y")]), "axy\n");
        assert_eq!(edited("ab\ncd\n", &[change((1, 1), (1, 2), "\n"), change((0, 0), (0, 1), "z")]), "zb\nc\n\n");
        assert_eq!(edited("ab", &[Change { range: None, text: "cde".into() }, change((0, 3), (0, 1), "")]), "c");
        assert_eq!(edited("ab", &[change((0, 1), (0, 1), "x"), change((0, 1), (0, 1), "y")]), "ayxb");
        assert_eq!(edited("π😀b", &[change((0, 3), (9, 0), "")]), "π😀");
    }

    #[test]
    fn many_changes_at_once_are_as_good_as_one_by_one() {
        let mut stream = Stream::new(1);
        for _ in 0..300 {
            let text: String =
                (0..stream.below(30)).map(|_| ["a", "π", "😀", "\n", "\r\n", "\r"][stream.below(6)]).collect();
            let mut place = || (stream.below(5) as u32, stream.below(6) as u32);
            let changes: Vec<_> = (0..4).map(|i| change(place(), place(), ["", "x", "y\nz", "\u{1F600}"][i])).collect();
            let mut one_by_one = Document::new("a.cli", text.clone()).unwrap();
            for change in &changes {
                one_by_one.change(vec![change.clone()], Unit::Utf16).unwrap();
            }
            assert_eq!(edited(&text, &changes), one_by_one.text(), "{text:?} {changes:?}");
        }
    }
}
