//! Diagnostics as text and JSON, written to any writer.
//!
//! Three forms of one list: [`render_human`] draws the places, [`render_short`] gives one line each, [`JsonReport`] one
//! document for programs. All show the message as it is; none decides what is worth showing.

mod human;
mod json;
mod short;

pub use human::{Color, render_human};
pub use json::{JsonReport, render_json};
pub use short::render_short;

use std::borrow::Cow;

/// Replaces what a terminal would obey, as the name of a file may hold it, by question marks.
#[must_use]
pub fn harmless(text: &str) -> Cow<'_, str> {
    let is_obeyed = |character: char| character.is_control() && !matches!(character, '\n' | '\t');
    if text.contains(is_obeyed) { text.replace(is_obeyed, "?").into() } else { text.into() }
}
