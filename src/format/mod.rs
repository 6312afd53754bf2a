//! Scenes in their canonical form: source in, text out.
//!
//! The form, whole (docs/formatting.md tells it to users):
//!
//! - A command begins in the first column. Its numbers stand apart by one blank, the groups that mean one thing (a colour,
//!   a place: the `groups` of the command table) by three.
//! - In a paragraph, the lines up to a blank one, the numbers of all commands begin in one column, and those of like
//!   commands stand below each other, point below point. A number beyond [`MAX_ALIGNED`] characters moves no other.
//! - A number keeps the digits that were written; `.5` and `1.` alone get their zeros.
//! - A comment stays on its line. Behind a command it stands two blanks behind the longest of the like commands of its
//!   paragraph that have one; alone it begins in the first column, or below the comment that it stood exactly below.
//! - Blanks at the end of a line go, and of several blank lines all but one; those at the start and the end of the file go
//!   as well. The last line has an end. Lines end in LF, or in CRLF if all do. A byte-order mark stays.
//! - What lies between the comments `# clisc: off` and `# clisc: on`, each alone on its line, stays as it is, and so does
//!   a line with an error or a NUL byte. These lines take no part in the columns of others.
//!
//! **Formatting twice is formatting once, the program stays the same to the bit, and every comment stays, in order**
//! (`testing::assert_formats_soundly`).
//!
//! Never here: deciding what is an error, files.

mod columns;
mod errors;
mod findings;
mod layout;
mod lines;
mod number;

use std::borrow::Cow;
use std::ops::Range;

use crate::source::{Source, Span};

pub use findings::{NOT_CANONICAL, findings};
pub use layout::Piece;

/// The longest number, in characters, for which others move: longer than any that binary64 needs.
pub const MAX_ALIGNED: usize = 32;

/// Returns the bytes of a scene in canonical form. They are those of the file, but for what the form changes.
#[must_use]
pub fn format(source: &Source) -> Vec<u8> {
    let mut formatted = Vec::with_capacity(source.text().len() + source.text().len() / 4);
    layout::lay_out(source, |piece| formatted.extend_from_slice(&piece.new));
    formatted
}

/// Returns the stretches of whole lines that change, with what they become, in order.
#[must_use]
pub fn changes(source: &Source) -> Vec<Piece<'static>> {
    let original = source.original_bytes();
    let mut changes = Vec::new();
    layout::lay_out(source, |piece| {
        if original[piece.old.range()] != *piece.new {
            changes.push(Piece { old: piece.old, new: Cow::Owned(piece.new.into_owned()) });
        }
    });
    changes
}

/// Returns those of [`changes`] that touch one of `lines`, counted from 0; columns are still those of whole paragraphs.
#[must_use]
pub fn changes_in(source: &Source, lines: Range<usize>) -> Vec<Piece<'static>> {
    let index = source.lines();
    let start_of =
        |line: usize| if line < index.n_lines() { index.line_span(source.text(), line).start } else { u32::MAX };
    let (start, end) = (start_of(lines.start), start_of(lines.end));
    let touches = |old: Span| old.start < end && old.end > start;
    changes(source).into_iter().filter(|change| touches(change.old)).collect()
}
