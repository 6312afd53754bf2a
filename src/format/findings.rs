//! What formatting would change, told as findings.

use crate::diag::words::counted;
use crate::diag::{Code, Diagnostic, Edit, Fix, Severity};
use crate::format::{Piece, changes};
use crate::source::{Source, Span};

/// `F0101`: lines that are not in canonical form.
pub static NOT_CANONICAL: Code = Code {
    id: "F0101",
    name: None,
    severity: Severity::Warning,
    title: "lines that are not in canonical form",
    explanation: include_str!("F0101.md"),
};

/// Returns a finding for each stretch of lines that [`format`](crate::format::format) changes, with the fix that does so.
#[must_use]
pub fn findings(source: &Source) -> Vec<Diagnostic> {
    let changes = changes(source);
    changes.chunk_by(|a, b| a.old.end == b.old.start).map(|stretch| finding(source, stretch)).collect()
}

/// Makes the finding of changes side by side.
fn finding(source: &Source, stretch: &[Piece<'_>]) -> Diagnostic {
    let whole = stretch.iter().map(|change| change.old).reduce(Span::to).unwrap_or(Span::at(0));
    let n_lines = source.slice(whole).lines().count().max(1);
    let message = match n_lines {
        1 => "a line is not in canonical form".to_owned(),
        n => format!("{} are not in canonical form", counted(n, "line")),
    };
    let shown = Span::new(whole.start, whole.start + source.slice(whole).trim_end().len() as u32);
    let edits: Option<Vec<_>> = stretch.iter().map(|change| edit(source, change)).collect();
    let diagnostic = Diagnostic::new(&NOT_CANONICAL, shown, message)
        .label("`clisc fmt` writes this in another way")
        .help("run `clisc fmt`");
    match edits {
        Some(edits) => diagnostic.fix(Fix::safe("format it", edits)),
        None => diagnostic,
    }
}

/// Returns a change as an edit; none where bytes are no text.
fn edit(source: &Source, change: &Piece<'_>) -> Option<Edit> {
    let is_text =
        !source.invalid_utf8().iter().any(|(span, _)| span.start < change.old.end && change.old.start < span.end);
    let new = std::str::from_utf8(&change.new).ok().filter(|_| is_text)?;
    Some(Edit::replace(change.old, new))
}
