//! The one place that prints.
//!
//! A reader that has seen enough (`clisc ir x.cli | head`) is no fault: a broken pipe is ignored.

use std::io::{self, BufWriter, ErrorKind, IsTerminal, Write};

use anyhow::Context;
use clisc::Compilation;
use clisc::diag::Severity;
use clisc::diag::render::{Color, Format, Report, harmless};
use clisc::diag::words::counted;
use clisc::source::Source;

use crate::args::ReportFormat;

/// What it means when results cannot be written.
pub const CANNOT_WRITE: &str = "cannot write to standard output";

/// Returns standard output, buffered, for results of any length; it has to be flushed.
pub fn stdout() -> impl Write {
    BufWriter::new(Patient(io::stdout().lock()))
}

/// Returns standard error, buffered, for messages of any length; it has to be flushed.
pub fn stderr() -> impl Write {
    BufWriter::new(Patient(io::stderr().lock()))
}

/// Begins a report on standard output; it has to be [finished](finish).
///
/// # Errors
/// When it cannot be written.
pub fn report(format: ReportFormat) -> anyhow::Result<Report<impl Write>> {
    let format = match format {
        ReportFormat::Human if stdout_has_color() => Format::Human(Color::Always),
        ReportFormat::Human => Format::Human(Color::Never),
        ReportFormat::Short => Format::Short,
        ReportFormat::Json => Format::Json,
        ReportFormat::Sarif => Format::Sarif,
        ReportFormat::Github => Format::Github,
        ReportFormat::Gitlab => Format::Gitlab,
    };
    Report::begin(format, stdout()).context(CANNOT_WRITE)
}

/// Ends a report.
///
/// # Errors
/// When it cannot be written.
pub fn finish(report: Report<impl Write>) -> anyhow::Result<()> {
    report.finish().and_then(|mut out| out.flush()).context(CANNOT_WRITE)
}

/// Prints results to standard output.
///
/// # Errors
/// When they cannot be written, except that nobody reads them any more.
pub fn to_stdout(text: &str) -> anyhow::Result<()> {
    let mut stdout = Patient(io::stdout().lock());
    stdout.write_all(harmless(text).as_bytes()).and_then(|()| stdout.flush()).context(CANNOT_WRITE)
}

/// Prints messages to standard error. There is no place left to say that this failed.
pub fn to_stderr(text: &str) {
    let mut stderr = io::stderr().lock();
    let _ = stderr.write_all(harmless(text).as_bytes()).and_then(|()| stderr.flush());
}

/// Says of a scene how much was found in it that is not listed, if there is any.
pub fn unlisted_to_stderr(scene: &Source, compilation: &Compilation) {
    let [errors, warnings] = [(Severity::Error, "error"), (Severity::Warning, "warning")]
        .map(|(severity, noun)| counted(compilation.n_unlisted(severity), &format!("more {noun}")));
    if compilation.diagnostics.len() < compilation.n_errors + compilation.n_warnings {
        to_stderr(&format!("`{}` has {errors} and {warnings} that are not listed\n", scene.name()));
    }
}

/// Tells whether text on standard output may be coloured: it is a terminal, and `NO_COLOR` is unset or empty.
pub fn stdout_has_color() -> bool {
    io::stdout().is_terminal() && environment_allows_color()
}

/// Tells whether text on standard error may be coloured: it is a terminal, and `NO_COLOR` is unset or empty.
pub fn stderr_has_color() -> bool {
    io::stderr().is_terminal() && environment_allows_color()
}

fn environment_allows_color() -> bool {
    let no_color = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let dumb = std::env::var_os("TERM").is_some_and(|value| value == "dumb");
    !no_color && !dumb
}

/// A writer that takes it calmly when nobody reads: what is left goes nowhere.
struct Patient<W>(W);

impl<W: Write> Write for Patient<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.write(bytes) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(bytes.len()),
            result => result,
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self.0.flush() {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
            result => result,
        }
    }
}
