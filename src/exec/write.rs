//! One `write`: its image from the first band to its name.

use std::io;
use std::time::Duration;

use crate::exec::{Event, ExecError, ImageRequest, Options, Sink, SinkError, WriteReport};
use crate::ir::{SceneView, Valid};
use crate::plan::plan;
use crate::trace::{Counts, Tracer};

/// One `write` on its way.
pub(super) struct Write<'a> {
    pub program: &'a Valid,
    pub command_idx: usize,
    pub write_idx: usize,
    pub name: &'a str,
    pub options: Options<'a>,
}

impl Write<'_> {
    /// Renders the scene as it stands in `view`, and saves it.
    pub fn run<S: Sink>(&self, view: SceneView<'_>, sink: &mut S) -> Result<WriteReport, ExecError> {
        let Options { settings, observer, .. } = self.options;
        let size = settings.size;
        let start = observer.now();
        observer.event(&Event::Started { write_idx: self.write_idx, name: self.name, size });
        self.check_cancelled()?;
        let file = sink.create(&ImageRequest { name: self.name, size }).map_err(|error| self.sink_error(error))?;
        let mut report = self.new_report();
        let file = self.stream(&Tracer::new(plan(view, settings)), file, &mut report)?;
        let (saved, save_time) = self.timed(|| sink.commit(file));
        saved.map_err(|error| self.sink_error(error))?;
        report.save_time = save_time;
        report.total_time = observer.now().saturating_sub(start);
        observer.event(&Event::Finished(&report));
        Ok(report)
    }

    fn new_report(&self) -> WriteReport {
        WriteReport {
            write_idx: self.write_idx,
            name: self.name.to_owned(),
            size: self.options.settings.size,
            n_bytes: 0,
            counts: Counts::default(),
            trace_time: Duration::ZERO,
            encode_time: Duration::ZERO,
            save_time: Duration::ZERO,
            total_time: Duration::ZERO,
        }
    }

    pub(super) fn timed<T>(&self, f: impl FnOnce() -> T) -> (T, Duration) {
        let start = self.options.observer.now();
        let result = f();
        (result, self.options.observer.now().saturating_sub(start))
    }

    pub(super) fn check_cancelled(&self) -> Result<(), ExecError> {
        if self.options.cancellation.is_cancelled() { Err(ExecError::Cancelled) } else { Ok(()) }
    }

    fn sink_error(&self, error: SinkError) -> ExecError {
        match error {
            SinkError::Refused(refusal) => ExecError::Refused(vec![refusal.diagnostic(self.program, self.command_idx)]),
            error => ExecError::Sink(error),
        }
    }

    pub(super) fn write_error(&self, source: io::Error) -> ExecError {
        ExecError::Write { name: self.name.to_owned(), source }
    }
}
