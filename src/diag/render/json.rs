//! One JSON document for all diagnostics of a run.
//!
//! The shape is versioned: a field may be added, none changes its meaning without a new [`VERSION`]. Its schema is
//! `docs/schemas/diagnostics-v1.schema.json`.

use std::io::{self, Write};

use serde::Serialize;

use crate::diag::render::Notification;
use crate::diag::render::place::{Items, ends};
use crate::diag::{Diagnostic, Edit, Fix, Label, Safety, Severity};
use crate::source::{Position, Source, Span};

/// The version of the document's shape.
pub const VERSION: u32 = 1;

/// A document that grows a source at a time, so that no run has to keep all its diagnostics.
#[derive(Debug)]
pub struct JsonReport<W: Write> {
    out: W,
    listed: Items,
    n_errors: usize,
    n_warnings: usize,
    notifications: Vec<Notification>,
}

impl<W: Write> JsonReport<W> {
    /// Writes the head of the document.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn begin(mut out: W) -> io::Result<Self> {
        write!(out, "{{\n  \"version\": {VERSION},\n  \"diagnostics\": [")?;
        Ok(Self { out, listed: Items::default(), n_errors: 0, n_warnings: 0, notifications: Vec::new() })
    }

    /// Writes the diagnostics of one source.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn add(&mut self, source: &Source, diagnostics: &[Diagnostic]) -> io::Result<()> {
        for diagnostic in diagnostics {
            self.listed.write(&JsonDiagnostic::new(source, diagnostic), &mut self.out)?;
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

    /// Takes a notification, which is written at the end.
    pub fn notify(&mut self, notification: Notification) {
        self.notifications.push(notification);
    }

    /// Writes the end of the document, with the counts of all that was found, and gives the writer back.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn finish(mut self) -> io::Result<W> {
        let Self { n_errors, n_warnings, .. } = self;
        let n_unlisted = n_errors + n_warnings - self.listed.n();
        self.listed.close(&mut self.out)?;
        writeln!(self.out, ",\n  \"errors\": {n_errors},\n  \"warnings\": {n_warnings},")?;
        writeln!(self.out, "  \"unlisted\": {n_unlisted},")?;
        let notifications = serde_json::to_string(&self.notifications)?;
        writeln!(self.out, "  \"notifications\": {notifications}\n}}")?;
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
    name: Option<&'a str>,
    severity: Severity,
    message: &'a str,
    primary: JsonLabel<'a>,
    secondary: Vec<JsonLabel<'a>>,
    help: Option<&'a str>,
    note: Option<&'a str>,
    fixes: Vec<JsonFix<'a>>,
}

/// A fix, with its places as those of a label.
#[derive(Serialize)]
struct JsonFix<'a> {
    title: &'a str,
    safety: Safety,
    edits: Vec<JsonEdit<'a>>,
}

/// An edit: what stands below its place becomes `replacement`.
#[derive(Serialize)]
struct JsonEdit<'a> {
    bytes: Span,
    start: Position,
    end: Position,
    replacement: &'a str,
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
            name: diagnostic.code.name,
            severity: diagnostic.severity(),
            message: &diagnostic.message,
            primary: JsonLabel::new(source, &diagnostic.primary),
            secondary: diagnostic.secondary.iter().map(|label| JsonLabel::new(source, label)).collect(),
            help: diagnostic.help.as_deref(),
            note: diagnostic.note.as_deref(),
            fixes: diagnostic.fixes.iter().map(|fix| JsonFix::new(source, fix)).collect(),
        }
    }
}

impl<'a> JsonFix<'a> {
    fn new(source: &Source, fix: &'a Fix) -> Self {
        let edits = fix.edits.iter().map(|edit| JsonEdit::new(source, edit)).collect();
        Self { title: &fix.title, safety: fix.safety, edits }
    }
}

impl<'a> JsonEdit<'a> {
    fn new(source: &Source, edit: &'a Edit) -> Self {
        let [start, end] = ends(source, edit.span);
        Self { bytes: edit.span, start, end, replacement: &edit.replacement }
    }
}

impl<'a> JsonLabel<'a> {
    fn new(source: &'a Source, label: &'a Label) -> Self {
        let [start, end] = ends(source, label.span);
        Self { bytes: label.span, start, end, label: &label.message }
    }
}
