//! Repairs that a program can carry out: edits of the text, and how sure they are.
//!
//! A stage that knows how to mend what it reports adds a [`Fix`] to its diagnostic; an editor offers each, a command line
//! carries out those that are [`Safety::Safe`]. [`apply`] is the one place where edits meet a text.
//!
//! Never here: reading or saving files, choosing which fixes are wanted.

use crate::diag::words::proposed;
use crate::source::{Source, Span};

/// Whether a fix may be carried out without anyone looking.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Safety {
    /// Every image stays as it is, unless the page of the code says otherwise; a mistake has no other reading.
    Safe,
    /// A good guess: images may change, or the text may have been meant otherwise.
    Unsafe,
}

impl Safety {
    /// Returns the word that every format prints.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Safe => "safe",
            Self::Unsafe => "unsafe",
        }
    }
}

/// A piece of text that takes the place of another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edit {
    /// What is replaced; empty to insert.
    pub span: Span,
    /// What stands there afterwards; empty to remove.
    pub replacement: String,
}

impl Edit {
    /// Makes an edit that replaces the text below `span`.
    #[must_use]
    pub fn replace(span: Span, replacement: impl Into<String>) -> Self {
        Self { span, replacement: replacement.into() }
    }

    /// Makes an edit that inserts a text before the byte at `offset`.
    #[must_use]
    pub fn insert(offset: u32, text: impl Into<String>) -> Self {
        Self::replace(Span::at(offset), text)
    }

    /// Makes an edit that removes the text below `span`.
    #[must_use]
    pub fn remove(span: Span) -> Self {
        Self::replace(span, "")
    }

    /// Makes an edit that removes the command below `span`: with its whole line, unless a comment stands there too.
    #[must_use]
    pub fn remove_command(source: &Source, span: Span) -> Self {
        let (text, lines) = (source.text(), source.lines());
        let line = lines.line_of(span.start);
        let line_span = lines.line_span(text, line);
        let is_blank = |span: Span| source.slice(span).trim_start_matches('\u{FEFF}').trim().is_empty();
        let behind = Span::new(span.end, line_span.end.max(span.end));
        if !is_blank(Span::new(line_span.start, span.start)) || !is_blank(behind) {
            let n_blanks = source.slice(behind).len() - source.slice(behind).trim_start().len();
            return Self::remove(Span::new(span.start, span.end + n_blanks as u32));
        }
        let next_line = if line + 1 < lines.n_lines() { lines.line_span(text, line + 1).start } else { line_span.end };
        Self::remove(Span::new(line_span.start + bom_len(source, line_span.start), next_line))
    }

    /// Makes an edit that puts `command` on a line of its own before the line that holds `offset`.
    #[must_use]
    pub fn insert_line_before(source: &Source, offset: u32, command: &str) -> Self {
        let start = source.lines().line_span(source.text(), source.lines().line_of(offset)).start;
        Self::insert(start + bom_len(source, start), format!("{command}{}", line_end(source)))
    }

    /// Makes an edit that puts `command` on a line of its own at the end of the text.
    #[must_use]
    pub fn append_line(source: &Source, command: &str) -> Self {
        let (text, end) = (source.text(), line_end(source));
        let before = if text.is_empty() || text.ends_with('\n') { "" } else { end };
        Self::insert(text.len() as u32, format!("{before}{command}{end}"))
    }
}

/// Returns the length of the byte-order mark that stands at `offset`.
fn bom_len(source: &Source, offset: u32) -> u32 {
    const BOM: &str = "\u{FEFF}";
    if offset == 0 && source.text().starts_with(BOM) { BOM.len() as u32 } else { 0 }
}

/// Returns how the first line of the text ends; LF where there is but one.
#[must_use]
pub fn line_end(source: &Source) -> &'static str {
    match source.text().find('\n') {
        Some(end) if source.text()[..end].ends_with('\r') => "\r\n",
        _ => "\n",
    }
}

/// One way to mend what a diagnostic reports: all of its edits together, or none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// What it does, as a menu of an editor shows it; lower case, no final stop.
    pub title: String,
    /// In any order; a fix whose own edits overlap is never carried out.
    pub edits: Vec<Edit>,
    /// Whether it may be carried out unseen.
    pub safety: Safety,
}

impl Fix {
    /// Makes a fix that may be carried out unseen.
    #[must_use]
    pub fn safe(title: impl Into<String>, edits: Vec<Edit>) -> Self {
        Self { title: title.into(), edits, safety: Safety::Safe }
    }

    /// Makes a fix that writes `text` in place of what stands below `span`.
    #[must_use]
    pub fn write(safety: Safety, span: Span, text: impl Into<String>) -> Self {
        let text = text.into();
        Self { title: proposed(&text), edits: vec![Edit::replace(span, text)], safety }
    }

    /// Makes a fix that someone should look at.
    #[must_use]
    pub fn guess(title: impl Into<String>, edits: Vec<Edit>) -> Self {
        Self { title: title.into(), edits, safety: Safety::Unsafe }
    }
}

/// A text with fixes carried out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fixed {
    /// The text.
    pub text: String,
    /// For each fix, in the order given, whether it was carried out.
    pub is_applied: Vec<bool>,
}

/// Carries out fixes on a text, each wholly or not at all.
///
/// The fixes are tried in the order given. One is left out when it touches what one before it changes, or when it does not
/// fit the text: a place beyond its end, half a character, edits that overlap each other.
#[must_use]
pub fn apply<'f>(text: &str, fixes: impl IntoIterator<Item = &'f Fix>) -> Fixed {
    let mut taken = Taken::default();
    let is_applied = fixes.into_iter().map(|fix| taken.take(text, fix)).collect();
    Fixed { text: taken.carried_out(text), is_applied }
}

/// Edits that do not touch each other, by their places.
#[derive(Default)]
struct Taken<'f>(std::collections::BTreeMap<(u32, u32), &'f str>);

impl<'f> Taken<'f> {
    /// Takes the edits of a fix if all of them find room, and tells whether they did.
    fn take(&mut self, text: &str, fix: &'f Fix) -> bool {
        for (n_taken, edit) in fix.edits.iter().enumerate() {
            if text.get(edit.span.range()).is_none() || !self.has_room_for(edit.span) {
                for edit in &fix.edits[..n_taken] {
                    self.0.remove(&(edit.span.start, edit.span.end));
                }
                return false;
            }
            self.0.insert((edit.span.start, edit.span.end), &edit.replacement);
        }
        true
    }

    /// Tells whether no edit touches `span`. Two that insert at one place do: neither order is right.
    fn has_room_for(&self, span: Span) -> bool {
        let key = (span.start, span.end);
        let before = self.0.range(..=key).next_back();
        let behind = self.0.range(key..).next();
        before.is_none_or(|(&place, _)| place.1 <= span.start && place != key)
            && behind.is_none_or(|(&place, _)| span.end <= place.0 && place != key)
    }

    fn carried_out(&self, text: &str) -> String {
        let mut fixed = String::with_capacity(text.len());
        let mut end = 0;
        for (&(start, next_end), replacement) in &self.0 {
            fixed.push_str(&text[end..start as usize]);
            fixed.push_str(replacement);
            end = next_end as usize;
        }
        fixed + &text[end..]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fix(edits: &[(u32, u32, &str)]) -> Fix {
        let edits = edits.iter().map(|&(start, end, text)| Edit::replace(Span { start, end }, text)).collect();
        Fix::safe("mend it", edits)
    }

    fn applied(text: &str, fixes: &[Fix]) -> (String, Vec<bool>) {
        let Fixed { text, is_applied } = apply(text, fixes);
        (text, is_applied)
    }

    #[test]
    fn fixes_that_do_not_touch_are_carried_out_together() {
        let fixes = [fix(&[(6, 8, "70")]), fix(&[(0, 3, "fov")]), fix(&[(8, 8, "\n")]), fix(&[])];
        assert_eq!(applied("fvo   60", &fixes), ("fov   70\n".into(), vec![true; 4]));
        let beside = [fix(&[(2, 4, "")]), fix(&[(0, 2, "x")]), fix(&[(2, 2, "y")]), fix(&[(4, 4, "z")])];
        assert_eq!(applied("abcdef", &beside), ("xyzef".into(), vec![true; 4]));
    }

    #[test]
    fn of_fixes_that_touch_the_first_is_carried_out_and_a_fix_wholly_or_not() {
        let fixes = [fix(&[(0, 2, "x")]), fix(&[(3, 4, "y"), (1, 3, "z")]), fix(&[(3, 4, "w")])];
        assert_eq!(applied("abcd", &fixes), ("xcw".into(), vec![true, false, true]));
        let at_one_place = [fix(&[(1, 1, "x")]), fix(&[(1, 1, "y")])];
        assert_eq!(applied("ab", &at_one_place), ("axb".into(), vec![true, false]));
        let inside = [fix(&[(0, 4, "x")]), fix(&[(2, 2, "y")]), fix(&[(1, 3, "z")])];
        assert_eq!(applied("abcd", &inside), ("x".into(), vec![true, false, false]));
        let around = [fix(&[(2, 2, "y")]), fix(&[(0, 4, "x")])];
        assert_eq!(applied("abcd", &around), ("abycd".into(), vec![true, false]));
    }

    #[test]
    fn a_fix_that_does_not_fit_the_text_is_left_out() {
        let misfits =
            [fix(&[(0, 1, "x"), (5, 6, "")]), fix(&[(1, 2, "")]), fix(&[(0, 3, "x"), (0, 1, "")]), fix(&[(3, 4, "!")])];
        assert_eq!(applied("πab", &misfits), ("πa!".into(), vec![false, false, false, true]));
    }

    #[test]
    fn commands_and_lines_come_and_go() {
        let edited = |text: &str, edit: fn(&Source) -> Edit| {
            let source = Source::new("test.cli", text);
            apply(text, [&Fix::safe("x", vec![edit(&source)])]).text
        };
        let remove: fn(&Source) -> Edit = |source| {
            let start = source.text().find("fov").expect("a command") as u32;
            Edit::remove_command(source, Span::new(start, start + 6))
        };
        assert_eq!(edited("a\n  fov 60 \nb", remove), "a\nb");
        assert_eq!(edited("a\r\nfov 60\r\nb", remove), "a\r\nb");
        assert_eq!(edited("a\nfov 60", remove), "a\n");
        assert_eq!(edited("\u{FEFF}fov 60\nb", remove), "\u{FEFF}b");
        assert_eq!(edited("a\n fov 60  # wide\nb", remove), "a\n # wide\nb");
        let insert: fn(&Source) -> Edit = |source| Edit::insert_line_before(source, 5, "new");
        assert_eq!(edited("a\nb cde\n", insert), "a\nnew\nb cde\n");
        assert_eq!(edited("\u{FEFF}abc\r\n", insert), "\u{FEFF}new\r\nabc\r\n");
        let append: fn(&Source) -> Edit = |source| Edit::append_line(source, "new");
        assert_eq!(edited("a", append), "a\nnew\n");
        assert_eq!(edited("a\r\n", append), "a\r\nnew\r\n");
        assert_eq!(edited("", append), "new\n");
    }
}
