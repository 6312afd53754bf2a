//! One JSON document for all diagnostics of a run.
//!
//! The shape is versioned: a field may be added, none changes its meaning without a new [`VERSION`].

use std::io::{self, Write};

use serde::Serialize;

use crate::diag::{Diagnostic, Label, Severity};
use crate::source::{Position, Source, Span};

/// The version of the document's shape.
pub const VERSION: u32 = 1;

/// A document that grows a source at a time, so that no run has to keep all its diagnostics.
#[derive(Debug)]
pub struct JsonReport<W: Write> {
    out: W,
    n_listed: usize,
    n_errors: usize,
    n_warnings: usize,
}

impl<W: Write> JsonReport<W> {
    /// Writes the head of the document.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn begin(mut out: W) -> io::Result<Self> {
        write!(out, "{{\n  \"version\": {VERSION},\n  \"diagnostics\": [")?;
        Ok(Self { out, n_listed: 0, n_errors: 0, n_warnings: 0 })
    }

    /// Writes the diagnostics of one source.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn add(&mut self, source: &Source, diagnostics: &[Diagnostic]) -> io::Result<()> {
        for diagnostic in diagnostics {
            let separator = if self.n_listed == 0 { "\n    " } else { ",\n    " };
            self.out.write_all(separator.as_bytes())?;
            serde_json::to_writer(&mut self.out, &JsonDiagnostic::new(source, diagnostic))?;
            self.n_listed += 1;
            self.count(diagnostic.severity(), 1);
        }
        Ok(())
    }

    /// Counts `n` more that were found and are not listed.
    pub fn count(&mut self, severity: Severity, n: usize) {
        match severity {
            Severity::Error => self.n_errors += n,
            Severity::Warning => self.n_warnings += n,
        }
    }

    /// Writes the end of the document, with the counts of all that was found, and gives the writer back.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn finish(mut self) -> io::Result<W> {
        let Self { n_listed, n_errors, n_warnings, .. } = self;
        let n_unlisted = n_errors + n_warnings - n_listed;
        let close = if n_listed == 0 { "]" } else { "\n  ]" };
        writeln!(self.out, "{close},\n  \"errors\": {n_errors},\n  \"warnings\": {n_warnings},")?;
        writeln!(self.out, "  \"unlisted\": {n_unlisted}\n}}")?;
        Ok(self.out)
    }
}

/// Writes the diagnostics of one source as a whole document.
///
/// # Errors
/// Those of `out`.
pub fn render_json(source: &Source, diagnostics: &[Diagnostic], out: &mut dyn Write) -> io::Result<()> {
    let mut report = JsonReport::begin(out)?;
    report.add(source, diagnostics)?;
    report.finish()?;
    Ok(())
}

#[derive(Serialize)]
struct JsonDiagnostic<'a> {
    path: &'a str,
    code: &'a str,
    severity: Severity,
    message: &'a str,
    primary: JsonLabel<'a>,
    secondary: Vec<JsonLabel<'a>>,
    help: Option<&'a str>,
    note: Option<&'a str>,
}

/// A label with its place in bytes and as line and column.
#[derive(Serialize)]
struct JsonLabel<'a> {
    bytes: Span,
    start: Position,
    end: Position,
    label: &'a str,
}

impl<'a> JsonDiagnostic<'a> {
    fn new(source: &'a Source, diagnostic: &'a Diagnostic) -> Self {
        Self {
            path: source.name(),
            code: diagnostic.code.id,
            severity: diagnostic.severity(),
            message: &diagnostic.message,
            primary: JsonLabel::new(source, &diagnostic.primary),
            secondary: diagnostic.secondary.iter().map(|label| JsonLabel::new(source, label)).collect(),
            help: diagnostic.help.as_deref(),
            note: diagnostic.note.as_deref(),
        }
    }
}

impl<'a> JsonLabel<'a> {
    fn new(source: &'a Source, label: &'a Label) -> Self {
        let place = |offset| source.lines().position(source.text(), offset);
        Self { bytes: label.span, start: place(label.span.start), end: place(label.span.end), label: &label.message }
    }
}
