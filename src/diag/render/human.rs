//! The drawing for people.

use std::io::{self, Write};

use crate::diag::Diagnostic;
use crate::source::Source;

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
pub fn render_human(source: &Source, diagnostics: &[Diagnostic], _color: Color, out: &mut dyn Write) -> io::Result<()> {
    super::render_short(source, diagnostics, out)
}
