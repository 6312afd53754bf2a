//! One line for each diagnostic.

use std::io::{self, Write};

use crate::diag::Diagnostic;
use crate::diag::render::harmless;
use crate::source::Source;

/// Writes `path:line:col: error[E0203]: message` for each diagnostic.
///
/// # Errors
/// Those of `out`.
pub fn render_short(source: &Source, diagnostics: &[Diagnostic], out: &mut dyn Write) -> io::Result<()> {
    diagnostics.iter().try_for_each(|diagnostic| write_line(source, diagnostic, out))
}

/// Writes the line of one diagnostic.
pub(super) fn write_line(source: &Source, diagnostic: &Diagnostic, out: &mut dyn Write) -> io::Result<()> {
    let place = source.lines().position(source.text(), diagnostic.primary.span.start);
    let (word, id) = (diagnostic.severity().word(), diagnostic.code.id);
    let name = harmless(source.name());
    writeln!(out, "{name}:{}:{}: {word}[{id}]: {}", place.line, place.column, diagnostic.message)
}
