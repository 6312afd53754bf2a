//! The language: text in, tokens and a tree out.
//!
//! Never here: what a command means for the scene (see `lower`), opening files, drawing diagnostics.

pub mod ast;
pub mod spec;

use crate::diag::Diagnostic;
use crate::source::Source;

/// A tree and what was found wrong on the way to it.
#[derive(Debug, Default, PartialEq)]
pub struct Parse {
    /// The tree; there always is one.
    pub file: ast::File,
    /// In the order of the text.
    pub diagnostics: Vec<Diagnostic>,
}

/// Parses a scene. A line that is no command becomes a bad node and a diagnostic, and spoils no other line.
#[must_use]
pub fn parse(source: &Source) -> Parse {
    let _ = source;
    Parse::default()
}
