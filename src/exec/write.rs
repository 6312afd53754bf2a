//! One `write`: its image from the first band to its name.

use std::io;
use std::time::Duration;

use crate::exec::earlier::Earlier;
use crate::exec::exactly::Exactly;
use crate::exec::limit::Limit;
use crate::exec::painter::Painter;
use crate::exec::{Event, ExecError, ImageRequest, Options, Origin, Proof, Sink, SinkError, WriteReport};
use crate::image::Crc32;
use crate::ir::{SceneView, Valid};
use crate::plan::{Precision, Savings, Settings, plan};
use crate::trace::{Counts, Spared, Tracer};

/// What is copied between two looks at the cancellation.
const CHUNK_BYTES: usize = 1 << 20;

/// One `write` on its way.
#[derive(Clone, Copy)]
pub(super) struct Write<'a> {
    pub program: &'a Valid,
    pub command_idx: usize,
    pub write_idx: usize,
    pub name: &'a str,
    pub options: Options<'a>,
    /// How much `exact` may work for it.
    pub limit: &'a Limit,
}

impl Write<'_> {
    /// Renders the scene as it stands in `view`, and saves it; takes what it shares with `earlier` images from there. If it
    /// takes more exact work than it may, the image is made in plain [`Precision::F64`].
    pub fn run<S: Sink>(
        &self,
        view: SceneView<'_>,
        earlier: &mut Earlier,
        sink: &mut S,
    ) -> Result<WriteReport, ExecError> {
        let start = self.options.observer.now();
        let saved = self.run_within_limit(view, earlier, sink, start);
        let is_passed = matches!(saved, Err(ExecError::Cancelled)) && self.limit.is_passed();
        if !is_passed || self.options.cancellation.is_cancelled() {
            return saved;
        }
        earlier.forget_pixels();
        let settings = Settings { precision: Precision::F64, ..self.options.settings.clone() };
        let (options, limit) = (Options { settings: &settings, ..self.options }, Limit::none());
        Write { options, limit: &limit, ..*self }.run_within_limit(view, earlier, sink, start)
    }

    /// Does the work of [`Write::run`] within the limit; passing it is being cancelled.
    ///
    /// `start`: when the first attempt began, for the report.
    fn run_within_limit<S: Sink>(
        &self,
        view: SceneView<'_>,
        earlier: &mut Earlier,
        sink: &mut S,
        start: Duration,
    ) -> Result<WriteReport, ExecError> {
        let Options { settings, observer, .. } = self.options;
        let size = settings.size;
        observer.event(&Event::Started { write_idx: self.write_idx, name: self.name, size });
        self.check_cancelled()?;
        let file = sink.create(&ImageRequest { name: self.name, size }).map_err(|error| self.sink_error(error))?;
        let mut report = self.new_report();
        let file = self.fill(view, earlier, file, &mut report)?;
        earlier.keep_proof(report.precision, report.proof.clone());
        earlier.keep_color(report.color);
        let (saved, save_time) = self.timed(|| sink.commit(file));
        saved.map_err(|error| self.sink_error(error))?;
        report.save_time = save_time;
        report.total_time = observer.now().saturating_sub(start);
        observer.event(&Event::Finished(&report));
        Ok(report)
    }

    /// Makes the image in `file`: copied, traced upon an earlier one, or traced.
    fn fill<F: io::Write + Send>(
        &self,
        view: SceneView<'_>,
        earlier: &mut Earlier,
        file: F,
        report: &mut WriteReport,
    ) -> Result<F, ExecError> {
        if let Some((write_idx, bytes)) = earlier.same_scene(self.write_idx) {
            report.proof = earlier.proof(write_idx).cloned();
            report.precision = earlier.precision(write_idx);
            report.color = earlier.color(write_idx);
            return self.copy(write_idx, bytes, file, report);
        }
        let settings = self.options.settings;
        let exactly = Exactly::new(view, settings, self.limit);
        let referee = settings.precision.is_proved().then_some(&exactly);
        let file = if exactly.makes_all() {
            self.limit.expect_all(settings);
            self.check_cancelled()?;
            let file = Kept::new(file, earlier.n_bytes_to_keep(self.write_idx));
            self.stream(&Painter::Exact(&exactly), file, report)?
        } else {
            self.trace(view, referee, earlier, file, report)?
        };
        if let Some(bytes) = file.bytes {
            earlier.keep_file(self.write_idx, bytes);
        }
        if !matches!(report.origin, Origin::CopiedFrom { .. }) {
            let record = exactly.into_record();
            report.proof = Proof::new(settings.precision, report, record);
        }
        Ok(file.inner)
    }

    /// Does the work of [`Write::fill`] by the tracer.
    ///
    /// `referee`: settles what it leaves open.
    fn trace<F: io::Write + Send>(
        &self,
        view: SceneView<'_>,
        referee: Option<&Exactly<'_>>,
        earlier: &mut Earlier,
        file: F,
        report: &mut WriteReport,
    ) -> Result<Kept<F>, ExecError> {
        let plan = plan(view, self.options.settings);
        report.savings = plan.savings();
        if let Some((write_idx, bytes)) = earlier.same_image(&plan) {
            report.proof = earlier.proof(write_idx).cloned();
            report.precision = earlier.precision(write_idx);
            report.color = earlier.color(write_idx);
            return Ok(Kept::new(self.copy(write_idx, bytes, file, report)?, 0));
        }
        let file = Kept::new(file, earlier.n_bytes_to_keep(self.write_idx));
        let shared = earlier.shared_pixels(&plan);
        if let Some((write_idx, changed)) = &shared {
            if let (Some(exactly), Some(proof)) = (referee, earlier.proof(*write_idx)) {
                exactly.take_over(proof.exact.taken_over(|column, row| !changed.contains(column, row)));
            }
            let n_pixels = u64::from(report.size.width()) * u64::from(report.size.height());
            report.origin = Origin::SharedWith {
                write_idx: *write_idx,
                n_traced_tiles: changed.n_tiles(),
                n_tiles: changed.n_all_tiles(),
                n_shared_pixels: n_pixels - changed.n_pixels(report.size),
            };
        }
        let canvas = earlier.canvas(self.write_idx, &plan, shared.is_some());
        let n_objects = (plan.report.n_spheres + plan.report.n_cylinders) as u64;
        let tracer = Tracer::new(plan);
        let tracer = match canvas {
            Some(canvas) => tracer.upon(canvas, shared.map(|(_, changed)| changed)),
            None => tracer,
        };
        let tracer = match referee {
            Some(referee) => tracer.settled_by(referee),
            None => tracer,
        };
        let file = self.stream(&Painter::Traced(Box::new(tracer)), file, report)?;
        report.spared = report.counts.spared(n_objects);
        Ok(file)
    }

    /// Copies the file of an earlier `write`.
    fn copy<F: io::Write>(
        &self,
        write_idx: usize,
        bytes: &[u8],
        mut file: F,
        report: &mut WriteReport,
    ) -> Result<F, ExecError> {
        report.origin = Origin::CopiedFrom { write_idx };
        for chunk in bytes.chunks(CHUNK_BYTES) {
            self.check_cancelled()?;
            let (written, time) = self.timed(|| file.write_all(chunk));
            report.encode_time += time;
            written.map_err(|error| self.write_error(error))?;
        }
        report.n_bytes = bytes.len() as u64;
        if report.proof.is_some() {
            let mut crc32 = Crc32::default();
            crc32.update(bytes);
            report.crc32 = Some(crc32.value());
        }
        let n_rows = report.size.height();
        self.options.observer.event(&Event::RowsDone { write_idx: self.write_idx, n_rows });
        Ok(file)
    }

    fn new_report(&self) -> WriteReport {
        WriteReport {
            write_idx: self.write_idx,
            name: self.name.to_owned(),
            size: self.options.settings.size,
            precision: self.options.settings.precision,
            n_bytes: 0,
            color: None,
            origin: Origin::Traced,
            savings: Savings::default(),
            spared: Spared::default(),
            counts: Counts::default(),
            proof: None,
            crc32: None,
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
        if self.is_cancelled() { Err(ExecError::Cancelled) } else { Ok(()) }
    }

    /// Tells whether the image is to be given up.
    pub(super) fn is_cancelled(&self) -> bool {
        self.options.cancellation.is_cancelled() || self.limit.is_passed()
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

/// A file of which a copy is kept while it is small.
struct Kept<F> {
    inner: F,
    bytes: Option<Vec<u8>>,
    max_bytes: usize,
}

impl<F> Kept<F> {
    fn new(inner: F, max_bytes: usize) -> Self {
        Self { inner, bytes: (max_bytes > 0).then(Vec::new), max_bytes }
    }
}

impl<F: io::Write> io::Write for Kept<F> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n_written = self.inner.write(bytes)?;
        match &mut self.bytes {
            Some(kept) if kept.len() + n_written <= self.max_bytes => kept.extend_from_slice(&bytes[..n_written]),
            kept => *kept = None,
        }
        Ok(n_written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}
