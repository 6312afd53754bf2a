//! Diagnostics as text and JSON, written to any writer.
//!
//! Six forms of one list: [`render_human`] draws the places, [`render_short`] gives one line each; for programs there is
//! [`JsonReport`], a document of our own, [`SarifReport`], [`render_github`] and [`GitlabReport`]. [`Report`] is any of
//! them. All show the message as it is; none decides what is worth showing. What no scene is to blame for is a
//! [`Notification`]: a report in a form for programs holds it too, so that none looks whole that is not.

mod canvas;
mod explained;
mod github;
mod gitlab;
mod human;
mod json;
mod notification;
mod place;
mod report;
mod sarif;
mod short;

pub use explained::Explained;
pub use github::render_github;
pub use gitlab::GitlabReport;
pub use human::{Color, Screen, render_human};
pub use json::{JsonReport, render_json};
pub use notification::Notification;
pub use report::{Format, Report};
pub use sarif::SarifReport;
pub use short::render_short;

use std::borrow::Cow;

use crate::diag::words::is_unseen;

/// Replaces what a terminal would obey and what does not show, as the name of a file may hold it, by question marks.
#[must_use]
pub fn harmless(text: &str) -> Cow<'_, str> {
    let is_harmful = |character: char| is_unseen(character) && !matches!(character, '\n' | '\t');
    if text.contains(is_harmful) { text.replace(is_harmful, "?").into() } else { text.into() }
}
