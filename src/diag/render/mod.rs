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
