//! GitLab's code quality report: one JSON array, in which a finding is known by its fingerprint from one commit to the next.
//!
//! # Source
//! "Code Quality report format", docs.gitlab.com, a subset of Code Climate's.

use std::io::{self, Write};

use serde::Serialize;

use crate::diag::render::Notification;
use crate::diag::render::place::{Fingerprints, Items, ends, fingerprint};
use crate::diag::{Diagnostic, Severity};
use crate::source::{Position, Source};

/// A document that grows a source at a time.
#[derive(Debug)]
pub struct GitlabReport<W: Write> {
    out: W,
    issues: Items,
}

impl<W: Write> GitlabReport<W> {
    /// Writes the head of the document.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn begin(mut out: W) -> io::Result<Self> {
        out.write_all(b"[")?;
        Ok(Self { out, issues: Items::default() })
    }

    /// Writes the diagnostics of one source.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn add(&mut self, source: &Source, diagnostics: &[Diagnostic]) -> io::Result<()> {
        let mut fingerprints = Fingerprints::default();
        for diagnostic in diagnostics {
            let issue = Issue::new(source, diagnostic, fingerprints.next(source, diagnostic));
            self.issues.write(&issue, &mut self.out)?;
        }
        Ok(())
    }

    /// Writes a notification, as an issue of the first line of its file.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn notify(&mut self, notification: &Notification) -> io::Result<()> {
        let Notification { severity, path, message } = notification;
        let path = path.as_deref().unwrap_or(".");
        let issue = Issue {
            description: message,
            check_name: env!("CARGO_PKG_NAME"),
            fingerprint: fingerprint(&[path, message]),
            severity: word(*severity),
            location: Location::new(path, [Position { line: 1, column: 1 }; 2]),
        };
        self.issues.write(&issue, &mut self.out)
    }

    /// Writes the end of the document and gives the writer back.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn finish(mut self) -> io::Result<W> {
        self.issues.close(&mut self.out)?;
        writeln!(self.out)?;
        Ok(self.out)
    }
}

#[derive(Serialize)]
struct Issue<'a> {
    description: &'a str,
    check_name: &'a str,
    fingerprint: String,
    severity: &'static str,
    location: Location<'a>,
}

#[derive(Serialize)]
struct Location<'a> {
    path: &'a str,
    lines: Lines,
    positions: Positions,
}

/// What GitLab itself reads.
#[derive(Serialize)]
struct Lines {
    begin: u32,
    end: u32,
}

/// What readers of Code Climate's format read besides.
#[derive(Serialize)]
struct Positions {
    begin: Position,
    end: Position,
}

/// Returns what GitLab calls a severity.
fn word(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "major",
        Severity::Warning => "minor",
    }
}

impl<'a> Location<'a> {
    fn new(path: &'a str, [begin, end]: [Position; 2]) -> Self {
        Self {
            path: path.strip_prefix("./").unwrap_or(path),
            lines: Lines { begin: begin.line, end: end.line },
            positions: Positions { begin, end },
        }
    }
}

impl<'a> Issue<'a> {
    fn new(source: &'a Source, diagnostic: &'a Diagnostic, fingerprint: String) -> Self {
        Self {
            description: &diagnostic.message,
            check_name: diagnostic.code.name.unwrap_or(diagnostic.code.id),
            fingerprint,
            severity: word(diagnostic.severity()),
            location: Location::new(source.name(), ends(source, diagnostic.primary.span)),
        }
    }
}
