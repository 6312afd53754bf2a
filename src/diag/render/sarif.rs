//! SARIF 2.1.0, the exchange format of static analysis that code hosts and editors read.
//!
//! One run with its results, streamed; the table of rules, which names what was found, comes behind them. Columns count
//! characters, as everywhere here, and the document says so.
//!
//! # Source
//! OASIS, "Static Analysis Results Interchange Format (SARIF) Version 2.1.0" (2020).

use std::io::{self, Write};

use serde::Serialize;
use serde_json::{Value, json};

use crate::diag::render::Notification;
use crate::diag::render::place::{Fingerprints, Items, ends, uri};
use crate::diag::words::counted;
use crate::diag::{Code, Diagnostic, Edit, Fix, Label, Severity};
use crate::source::{Source, Span};

/// The most results of a run that GitHub takes; it refuses the document of a longer one.
///
/// # Source
/// "SARIF support for code scanning", docs.github.com: "Results per run".
const MAX_RESULTS: usize = 25_000;

/// A document that grows a source at a time.
#[derive(Debug)]
pub struct SarifReport<W: Write> {
    out: W,
    results: Items,
    /// The codes found so far, in the order in which they were.
    codes: Vec<&'static Code>,
    n_unlisted: usize,
    notifications: Vec<Notification>,
}

impl<W: Write> SarifReport<W> {
    /// Writes the head of the document.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn begin(mut out: W) -> io::Result<Self> {
        const SCHEMA: &str = "https://json.schemastore.org/sarif-2.1.0.json";
        write!(out, "{{\n  \"$schema\": \"{SCHEMA}\",\n  \"version\": \"2.1.0\",\n  \"runs\": [{{\n")?;
        write!(out, "  \"columnKind\": \"unicodeCodePoints\",\n  \"results\": [")?;
        Ok(Self { out, results: Items::default(), codes: Vec::new(), n_unlisted: 0, notifications: Vec::new() })
    }

    /// Writes the diagnostics of one source, as far as the run may hold them.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn add(&mut self, source: &Source, diagnostics: &[Diagnostic]) -> io::Result<()> {
        let mut fingerprints = Fingerprints::default();
        let n_listed = diagnostics.len().min(MAX_RESULTS - self.results.n());
        self.n_unlisted += diagnostics.len() - n_listed;
        for diagnostic in &diagnostics[..n_listed] {
            let rule_idx = self.rule_idx(diagnostic.code);
            let result = result(source, diagnostic, rule_idx, fingerprints.next(source, diagnostic));
            self.results.write(&result, &mut self.out)?;
        }
        Ok(())
    }

    /// Counts `n` more that were found and are not listed.
    pub fn count_unlisted(&mut self, n: usize) {
        self.n_unlisted += n;
    }

    /// Takes a notification, which is written at the end.
    pub fn notify(&mut self, notification: Notification) {
        self.notifications.push(notification);
    }

    /// Returns the notification that findings are left out, if there are any.
    fn unlisted(&self) -> Option<Notification> {
        (self.n_unlisted > 0).then(|| {
            let message = format!(
                "{} left out: a run holds {MAX_RESULTS} results, and of one scene the first are listed",
                counted(self.n_unlisted, "finding")
            );
            Notification::warning(None, message)
        })
    }

    /// Writes the end of the document and gives the writer back.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn finish(mut self) -> io::Result<W> {
        self.results.close(&mut self.out)?;
        self.notifications.extend(self.unlisted());
        let is_whole = self.notifications.iter().all(|notification| notification.severity != Severity::Error);
        let notifications: Vec<_> = self.notifications.iter().map(notification).collect();
        let invocation = json!({ "executionSuccessful": is_whole, "toolExecutionNotifications": notifications });
        let rules: Vec<_> = self.codes.iter().map(|code| rule(code)).collect();
        let driver = json!({
            "name": env!("CARGO_PKG_NAME"),
            "semanticVersion": env!("CARGO_PKG_VERSION"),
            "shortDescription": { "text": env!("CARGO_PKG_DESCRIPTION") },
            "rules": rules,
        });
        write!(self.out, ",\n  \"invocations\": [{invocation}]")?;
        write!(self.out, ",\n  \"properties\": {{ \"unlisted\": {} }}", self.n_unlisted)?;
        writeln!(self.out, ",\n  \"tool\": {{ \"driver\": {driver} }}\n  }}]\n}}")?;
        Ok(self.out)
    }

    fn rule_idx(&mut self, code: &'static Code) -> usize {
        self.codes.iter().position(|known| *known == code).unwrap_or_else(|| {
            self.codes.push(code);
            self.codes.len() - 1
        })
    }
}

fn rule(code: &Code) -> Value {
    let mut rule = json!({
        "id": code.id,
        "shortDescription": { "text": code.title },
        "help": { "text": code.page(), "markdown": code.page() },
        "defaultConfiguration": { "level": level(code.severity) },
    });
    if let Some(name) = code.name {
        rule["name"] = name.into();
    }
    rule
}

fn notification(notification: &Notification) -> Value {
    let mut value = json!({ "level": level(notification.severity), "message": { "text": notification.message } });
    if let Some(path) = &notification.path {
        let location = json!({ "physicalLocation": { "artifactLocation": { "uri": uri(path) } } });
        value["locations"] = json!([location]);
    }
    value
}

fn level(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    }
}

/// Returns a result. What to do follows the message, because few readers show anything else.
fn result(source: &Source, diagnostic: &Diagnostic, rule_idx: usize, fingerprint: String) -> Value {
    let extras = [&diagnostic.help, &diagnostic.note].into_iter().flatten();
    let text = extras.fold(diagnostic.message.clone(), |text, extra| text + "\n" + extra);
    let mut result = json!({
        "ruleId": diagnostic.code.id,
        "ruleIndex": rule_idx,
        "level": level(diagnostic.severity()),
        "message": { "text": text },
        "locations": [location(source, &diagnostic.primary)],
        "partialFingerprints": { "line/v1": fingerprint },
    });
    if !diagnostic.secondary.is_empty() {
        let related = diagnostic.secondary.iter().map(|label| location(source, label));
        result["relatedLocations"] = related.collect();
    }
    if !diagnostic.fixes.is_empty() {
        result["fixes"] = diagnostic.fixes.iter().map(|offered| fix(source, offered)).collect();
    }
    result
}

fn fix(source: &Source, fix: &Fix) -> Value {
    let replacements: Vec<_> = fix.edits.iter().map(|edit| replacement(source, edit)).collect();
    json!({
        "description": { "text": format!("{} ({})", fix.title, fix.safety.word()) },
        "artifactChanges": [{ "artifactLocation": { "uri": uri(source.name()) }, "replacements": replacements }],
    })
}

fn location(source: &Source, label: &Label) -> Value {
    json!({
        "physicalLocation": {
            "artifactLocation": { "uri": uri(source.name()) },
            "region": Region::new(source, label.span),
        },
        "message": { "text": label.message },
    })
}

fn replacement(source: &Source, edit: &Edit) -> Value {
    let mut replacement = json!({ "deletedRegion": Region::new(source, edit.span) });
    if !edit.replacement.is_empty() {
        replacement["insertedContent"] = json!({ "text": edit.replacement });
    }
    replacement
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Region {
    start_line: u32,
    start_column: u32,
    end_line: u32,
    end_column: u32,
}

impl Region {
    fn new(source: &Source, span: Span) -> Self {
        let [start, end] = ends(source, span);
        Self { start_line: start.line, start_column: start.column, end_line: end.line, end_column: end.column }
    }
}
