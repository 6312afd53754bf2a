//! Fixtures whose expectations stand in their own comments.
//!
//! Below a command, a comment of carets marks the place of a diagnostic in the line above and says what it is; a second
//! one behind it may say its help. The places are counted in characters, so a command is indented to let carets reach it.
//!
//! ```text
//!   sphere 1 0 0
//! # ^^^^^^ error[E0203]: `sphere` takes 4 numbers, found 3
//! #        help: add the missing `radius` after the third number
//! ```

use clisc::diag::Diagnostic;
use clisc::source::Source;

/// Tells whether a line of a fixture says what is expected.
fn is_expectation(line: &str) -> bool {
    let said = line.strip_prefix('#').map(str::trim_start).unwrap_or_default();
    said.starts_with('^') || said.starts_with("help: ")
}

/// Returns the fixture with the expectations that `diagnostics`, those of `source`, fulfil.
pub fn annotate(source: &Source, diagnostics: &[Diagnostic]) -> String {
    let mut annotated = String::new();
    let mut diagnostics = diagnostics.iter().peekable();
    let n_lines = source.text().split_inclusive('\n').count();
    for (i, line) in source.text().split_inclusive('\n').enumerate() {
        if is_expectation(line) {
            continue;
        }
        annotated.push_str(line);
        let is_here = |diagnostic: &&Diagnostic| line_of(source, diagnostic) == i || i + 1 == n_lines;
        while let Some(diagnostic) = diagnostics.next_if(is_here) {
            if !annotated.ends_with('\n') {
                annotated.push('\n');
            }
            expect(source, diagnostic, &mut annotated);
        }
    }
    annotated
}

fn line_of(source: &Source, diagnostic: &Diagnostic) -> usize {
    source.lines().line_of(diagnostic.primary.span.start)
}

/// Appends what to expect of one diagnostic.
fn expect(source: &Source, diagnostic: &Diagnostic, annotated: &mut String) {
    let span = diagnostic.primary.span;
    let n_before = source.lines().position(source.text(), span.start).column as usize - 1;
    let n_marked = source.slice(span).chars().count().max(1);
    assert!(n_before >= 2, "{}: indent the command, so that carets reach it", source.name());
    let (blanks, carets) = (" ".repeat(n_before - 1), "^".repeat(n_marked));
    let (word, id) = (diagnostic.severity().word(), diagnostic.code.id);
    annotated.push_str(&format!("#{blanks}{carets} {word}[{id}]: {}\n", diagnostic.message));
    if let Some(help) = &diagnostic.help {
        annotated.push_str(&format!("#{blanks}{} help: {help}\n", " ".repeat(n_marked)));
    }
}
