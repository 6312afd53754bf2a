//! The one place that prints.
//!
//! A reader that has seen enough (`clisc ir x.cli | head`) is no fault: a broken pipe is ignored.

use std::io::{self, BufWriter, ErrorKind, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

use anyhow::Context;
use clap::builder::StyledStr;
use clisc::Compilation;
use clisc::diag::render::{Color, Explained, Format, Report, Screen, harmless, render_human};
use clisc::diag::words::counted;
use clisc::diag::{Diagnostic, Severity};
use clisc::source::Source;
use terminal_size::{Width, terminal_size_of};

use crate::args::{ColorWhen, ReportFormat};

/// What it means when results cannot be written.
pub const CANNOT_WRITE: &str = "cannot write to standard output";

/// Returns standard output, buffered, for results of any length; it has to be flushed.
pub fn stdout() -> impl Write {
    BufWriter::new(Patient(io::stdout().lock()))
}

/// Returns standard error, buffered, for messages of any length; it has to be flushed.
pub fn stderr() -> impl Write {
    BufWriter::new(Watched(Patient(io::stderr().lock())))
}

/// Begins a report on standard output; it has to be [finished](finish).
///
/// # Errors
/// When it cannot be written.
pub fn report(format: ReportFormat) -> anyhow::Result<Report<impl Write>> {
    let format = match format {
        ReportFormat::Human => Format::Human(screen(&io::stdout())),
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

/// Prints text of clap to standard output, with its own colours.
///
/// # Errors
/// As [`to_stdout`].
pub fn help_to_stdout(text: &StyledStr) -> anyhow::Result<()> {
    let mut stdout = stdout();
    let text = if has_color(&io::stdout()) { text.ansi().to_string() } else { text.to_string() };
    stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()).context(CANNOT_WRITE)
}

/// Prints text of clap to standard error, with its own colours.
pub fn usage_to_stderr(text: &StyledStr) {
    let mut stderr = stderr();
    let text = if has_color(&io::stderr()) { text.ansi().to_string() } else { text.to_string() };
    let _ = stderr.write_all(text.as_bytes()).and_then(|()| stderr.flush());
}

/// Prints messages to standard error. There is no place left to say that this failed, but the exit code.
pub fn to_stderr(text: &str) {
    let mut stderr = stderr();
    let _ = stderr.write_all(harmless(text).as_bytes()).and_then(|()| stderr.flush());
}

/// Whether a message could not be written to standard error.
static HAS_LOST_MESSAGES: AtomicBool = AtomicBool::new(false);

/// Tells whether a message could not be written, except that nobody reads them.
pub fn has_lost_messages() -> bool {
    HAS_LOST_MESSAGES.load(Ordering::Relaxed)
}

/// Says of a scene how much was found in it that is not listed, if there is any.
pub fn unlisted_to_stderr(scene: &Source, compilation: &Compilation) {
    let [errors, warnings] = [(Severity::Error, "error"), (Severity::Warning, "warning")]
        .map(|(severity, noun)| counted(compilation.n_unlisted(severity), &format!("more {noun}")));
    if compilation.diagnostics.len() < compilation.n_errors + compilation.n_warnings {
        to_stderr(&format!("`{}` has {errors} and {warnings} that are not listed\n", scene.name()));
    }
}

/// What `--color` asked for; set once, before anything is printed.
static COLOR: OnceLock<ColorWhen> = OnceLock::new();

/// Takes `--color` into account from now on.
pub fn decide_color(when: ColorWhen) {
    let _ = COLOR.set(when);
}

/// The codes that standard error has shown.
static EXPLAINED: Mutex<Explained> = Mutex::new(Explained::new());

/// Draws what was found in a scene on standard error.
///
/// # Errors
/// When it cannot be written.
pub fn diagnostics_to_stderr(scene: &Source, diagnostics: &[Diagnostic]) -> io::Result<()> {
    EXPLAINED.lock().unwrap_or_else(PoisonError::into_inner).add(diagnostics);
    let mut stderr = stderr();
    render_human(scene, diagnostics, screen(&io::stderr()), &mut stderr)?;
    stderr.flush()
}

/// Says, once a run, which command says more of what standard error has shown.
pub fn explained_to_stderr() {
    to_stderr(&std::mem::take(&mut *EXPLAINED.lock().unwrap_or_else(PoisonError::into_inner)).to_string());
}

#[cfg(unix)]
fn screen(stream: &(impl IsTerminal + std::os::fd::AsFd)) -> Screen {
    let size = terminal_size_of(stream.as_fd());
    Screen { color: color(stream), width: size.map(|(Width(width), _)| usize::from(width)) }
}

#[cfg(windows)]
fn screen(stream: &(impl IsTerminal + std::os::windows::io::AsHandle)) -> Screen {
    let size = terminal_size_of(stream.as_handle());
    Screen { color: color(stream), width: size.map(|(Width(width), _)| usize::from(width)) }
}

fn color(stream: &impl IsTerminal) -> Color {
    if has_color(stream) { Color::Always } else { Color::Never }
}

/// Tells whether a stream is coloured: as `--color` says, else if it is a terminal and the environment does not object.
fn has_color(stream: &impl IsTerminal) -> bool {
    match COLOR.get().copied().unwrap_or_default() {
        ColorWhen::Auto => stream.is_terminal() && environment_allows_color(),
        ColorWhen::Always => true,
        ColorWhen::Never => false,
    }
}

/// Tells whether `NO_COLOR` is unset or empty and the terminal is not a dumb one.
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

/// Standard error, which notes when a message is lost.
struct Watched<W>(W);

impl<W: Write> Write for Watched<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.0.write(bytes);
        if written.as_ref().is_err_and(|error| error.kind() != ErrorKind::Interrupted) {
            HAS_LOST_MESSAGES.store(true, Ordering::Relaxed);
        }
        written
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}
