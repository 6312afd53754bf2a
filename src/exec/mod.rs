//! The executor: a valid program in, images in a sink out.
//!
//! [`execute`] walks the command list; each `write` is traced a band of rows at a time, and a band is encoded while the
//! next is traced, so that memory does not grow with the image. Where images go ([`Sink`]), who watches
//! ([`Observer`]) and what ends it early ([`CancellationToken`]) are parameters: a command line, a test and a web page
//! drive the same code. Every name is looked at before anything is rendered.
//!
//! Never here: files, the clock, threads of its own (it works in the current rayon pool).

mod cancel;
mod name;
mod observe;
mod sink;

pub use cancel::CancellationToken;
pub use name::{Refusal, refuse_name};
pub use observe::{Event, Observer, WriteReport};
pub use sink::{ImageRequest, MemoryFile, MemorySink, Sink, SinkError, Step};

use std::io;
use std::mem;
use std::time::Duration;

use crate::diag::Diagnostic;
use crate::image::PngStream;
use crate::ir::{Command, Registers, SceneView, Valid};
use crate::trace::{Counts, Settings, Size, Tracer};

/// The most bytes of pixels in one band; two bands are in memory at a time.
const BAND_BYTES: u64 = 4 << 20;

/// The most samples in one band: about a second's work, after which progress is told and a cancellation seen.
const BAND_SAMPLES: u64 = 1 << 20;

/// How to execute a program.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// What every render is asked for.
    pub settings: &'a Settings,
    /// Is told what happens, and has the clock.
    pub observer: &'a dyn Observer,
    /// Ends the execution early.
    pub cancellation: &'a CancellationToken,
}

/// Why a program was not executed to its end. Images committed before stay.
#[derive(Debug)]
#[non_exhaustive]
pub enum ExecError {
    /// The scene may not write where it wants to; nothing was rendered. Holds a diagnostic for each such name.
    Refused(Vec<Diagnostic>),
    /// The sink cannot take an image.
    Sink(SinkError),
    /// The file of the image with this name cannot be written.
    Write {
        /// The name as in the source.
        name: String,
        /// Why not.
        source: io::Error,
    },
    /// The token was set.
    Cancelled,
}

impl std::fmt::Display for ExecError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Refused(diagnostics) => write!(f, "{} names of images are refused", diagnostics.len()),
            Self::Sink(error) => error.fmt(f),
            Self::Write { name, .. } => write!(f, "cannot write `{name}`"),
            Self::Cancelled => write!(f, "cancelled"),
        }
    }
}

impl std::error::Error for ExecError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Refused(_) | Self::Cancelled => None,
            Self::Sink(error) => error.source(),
            Self::Write { source, .. } => Some(source),
        }
    }
}

/// Carries out every command of a program, in order; returns what each `write` took.
///
/// # Errors
/// See [`ExecError`]. The image that was being written is abandoned.
pub fn execute<S: Sink>(program: &Valid, options: Options<'_>, sink: &mut S) -> Result<Vec<WriteReport>, ExecError> {
    let refused = check_names(program, sink)?;
    if !refused.is_empty() {
        return Err(ExecError::Refused(refused));
    }
    let mut reports = Vec::new();
    let mut registers = Registers::default();
    for (idx, command) in program.commands.iter().enumerate() {
        registers.step(command);
        if let Command::Write(name) = command {
            let view = SceneView::new(program, registers);
            let write = Write { program, command_idx: idx, write_idx: reports.len(), name, options };
            reports.push(write.run(view, sink)?);
        }
    }
    Ok(reports)
}

/// Finds the names that the program may not write to, without rendering: one diagnostic for each, in order.
///
/// # Errors
/// When the sink could not take one of the others, as far as that can be known.
pub fn check_names<S: Sink>(program: &Valid, sink: &mut S) -> Result<Vec<Diagnostic>, ExecError> {
    let mut refused = Vec::new();
    for (idx, command) in program.commands.iter().enumerate() {
        let Command::Write(name) = command else { continue };
        let checked = match refuse_name(name) {
            Some(refusal) => Err(SinkError::Refused(refusal)),
            None => sink.check(name),
        };
        match checked {
            Ok(()) => {}
            Err(SinkError::Refused(refusal)) => refused.push(refusal.diagnostic(program, idx)),
            Err(error) => return Err(ExecError::Sink(error)),
        }
    }
    Ok(refused)
}

/// One `write` on its way.
struct Write<'a> {
    program: &'a Valid,
    command_idx: usize,
    write_idx: usize,
    name: &'a str,
    options: Options<'a>,
}

impl Write<'_> {
    fn run<S: Sink>(&self, view: SceneView<'_>, sink: &mut S) -> Result<WriteReport, ExecError> {
        let Options { settings, observer, .. } = self.options;
        let size = settings.size;
        let start = observer.now();
        observer.event(&Event::Started { write_idx: self.write_idx, name: self.name, size });
        self.check_cancelled()?;
        let file = sink.create(&ImageRequest { name: self.name, size }).map_err(|error| self.sink_error(error))?;
        let mut report = WriteReport::new(self.write_idx, self.name, size);
        let file = self.stream(&Tracer::new(view, settings), file, &mut report)?;
        let (saved, save_time) = self.timed(|| sink.commit(file));
        saved.map_err(|error| self.sink_error(error))?;
        report.save_time = save_time;
        report.total_time = observer.now().saturating_sub(start);
        observer.event(&Event::Finished(&report));
        Ok(report)
    }

    /// Traces the image into `file`, encoding each band while the next is traced.
    fn stream<F>(&self, tracer: &Tracer<'_>, file: F, report: &mut WriteReport) -> Result<F, ExecError>
    where
        F: io::Write + Send,
    {
        let size = report.size;
        let row_bytes = size.width() as usize * 3;
        let band_rows = band_rows(self.options.settings);
        let file = Counted { inner: file, n_bytes: 0 };
        let mut png = PngStream::new(file, size.width(), size.height()).map_err(|e| self.write_error(e))?;
        let (mut done, mut next) = (Vec::new(), Vec::new());
        for first in (0..size.height()).step_by(band_rows as usize) {
            let rows = first..size.height().min(first + band_rows);
            next.resize(rows.len() * row_bytes, 0);
            let (traced, encoded) = rayon::join(
                || self.timed(|| tracer.render_rows(rows.clone(), &mut next)),
                || self.timed(|| png.write_rows(&done)),
            );
            report.add_band(traced, encoded.1);
            encoded.0.map_err(|error| self.write_error(error))?;
            self.check_cancelled()?;
            mem::swap(&mut done, &mut next);
            self.options.observer.event(&Event::RowsDone { write_idx: self.write_idx, n_rows: rows.end });
        }
        let (ended, time) = self.timed(|| png.write_rows(&done).and_then(|()| png.finish()));
        let file = ended.map_err(|error| self.write_error(error))?;
        report.encode_time += time;
        report.n_bytes = file.n_bytes;
        Ok(file.inner)
    }

    fn timed<T>(&self, f: impl FnOnce() -> T) -> (T, Duration) {
        let start = self.options.observer.now();
        let result = f();
        (result, self.options.observer.now().saturating_sub(start))
    }

    fn check_cancelled(&self) -> Result<(), ExecError> {
        if self.options.cancellation.is_cancelled() { Err(ExecError::Cancelled) } else { Ok(()) }
    }

    fn sink_error(&self, error: SinkError) -> ExecError {
        match error {
            SinkError::Refused(refusal) => ExecError::Refused(vec![refusal.diagnostic(self.program, self.command_idx)]),
            error => ExecError::Sink(error),
        }
    }

    fn write_error(&self, source: io::Error) -> ExecError {
        ExecError::Write { name: self.name.to_owned(), source }
    }
}

impl WriteReport {
    fn new(write_idx: usize, name: &str, size: Size) -> Self {
        Self {
            write_idx,
            name: name.to_owned(),
            size,
            n_bytes: 0,
            counts: Counts::default(),
            trace_time: Duration::ZERO,
            encode_time: Duration::ZERO,
            save_time: Duration::ZERO,
            total_time: Duration::ZERO,
        }
    }

    fn add_band(&mut self, (counts, trace_time): (Counts, Duration), encode_time: Duration) {
        self.counts += counts;
        self.trace_time += trace_time;
        self.encode_time += encode_time;
    }
}

/// Returns how many rows make a band, at least 1.
fn band_rows(settings: &Settings) -> u32 {
    let width = u64::from(settings.size.width());
    let samples = u64::from(settings.samples).pow(2);
    let rows = (BAND_BYTES / (width * 3)).min(BAND_SAMPLES / (width * samples)).max(1);
    rows.min(u64::from(Size::MAX_SIDE)) as u32
}

/// Counts the bytes on their way to a file.
struct Counted<F> {
    inner: F,
    n_bytes: u64,
}

impl<F: io::Write> io::Write for Counted<F> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n_written = self.inner.write(bytes)?;
        self.n_bytes += n_written as u64;
        Ok(n_written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}
