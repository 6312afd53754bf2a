//! Annotations of GitHub Actions: a line each on standard output, which the runner turns into notes beside the code.
//!
//! # Source
//! "Workflow commands for GitHub Actions", docs.github.com; the escapes are those of `@actions/core`.

use std::io::{self, Write};

use crate::diag::Diagnostic;
use crate::diag::render::Notification;
use crate::diag::render::place::ends;
use crate::source::Source;

/// Writes `::error file=…,line=…,col=…::message` for each diagnostic.
///
/// # Errors
/// Those of `out`.
pub fn render_github(source: &Source, diagnostics: &[Diagnostic], out: &mut dyn Write) -> io::Result<()> {
    diagnostics.iter().try_for_each(|diagnostic| write_line(source, diagnostic, out))
}

fn write_line(source: &Source, diagnostic: &Diagnostic, out: &mut dyn Write) -> io::Result<()> {
    let command = diagnostic.severity().word();
    let [start, end] = ends(source, diagnostic.primary.span);
    write!(out, "::{command} file={},line={},endLine={}", property(source.name()), start.line, end.line)?;
    if start.line == end.line {
        // Columns across lines are refused.
        write!(out, ",col={},endColumn={}", start.column, end.column)?;
    }
    let help = diagnostic.help.as_ref().map_or_else(String::new, |help| format!("\nhelp: {help}"));
    let message = data(&format!("{}{help}", diagnostic.message));
    writeln!(out, ",title={}::{message}", property(&diagnostic.code.label()))
}

/// Writes the annotation of a notification, at its file if it has one.
pub(super) fn write_notification(notification: &Notification, out: &mut dyn Write) -> io::Result<()> {
    let Notification { severity, path, message } = notification;
    let file = path.as_ref().map_or_else(String::new, |path| format!(" file={},", property(path)));
    let space = if file.is_empty() { " " } else { "" };
    writeln!(out, "::{}{file}{space}title={}::{}", severity.word(), env!("CARGO_PKG_NAME"), data(message))
}

/// Escapes the text of a message.
fn data(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

/// Escapes the value of a property.
fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::codes;
    use crate::source::Span;

    #[test]
    fn what_the_runner_would_read_is_escaped() {
        let source = Source::new("a,b: 50%.cli", "fov 0\nwrite a.png\n");
        let found = |span| Diagnostic::new(&codes::NO_FOV, span, "100% of\nit").help("look: here");
        let mut out = Vec::new();
        render_github(&source, &[found(Span::new(4, 5)), found(Span::new(0, 9))], &mut out).expect("written to memory");
        assert_eq!(
            String::from_utf8(out).expect("text"),
            "::warning file=a%2Cb%3A 50%25.cli,line=1,endLine=1,col=5,endColumn=6,title=W0302 no-fov\
             ::100%25 of%0Ait%0Ahelp: look: here\n\
             ::warning file=a%2Cb%3A 50%25.cli,line=1,endLine=2,title=W0302 no-fov\
             ::100%25 of%0Ait%0Ahelp: look: here\n"
        );
    }
}
