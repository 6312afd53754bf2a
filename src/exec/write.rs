//! One `write`: its image from the first band to its name.

use std::io;
use std::time::Duration;

use crate::exec::earlier::Earlier;
use crate::exec::exactly::Exactly;
use crate::exec::limit::Limit;
use crate::exec::painter::Painter;
use crate::exec::{Event, ExecError, ImageRequest, Options, Origin, Proof, Sink, SinkError, Unproved, WriteReport};
use crate::image::Crc32;
use crate::ir::{SceneView, Valid};
use crate::plan::{Savings, is_within_range, plan};
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
}

impl Write<'_> {
    /// Renders the scene as it stands in `view`, and saves it; takes what it shares with `earlier` images from there.
    pub fn run<S: Sink>(
        &self,
        view: SceneView<'_>,
        earlier: &mut Earlier,
        sink: &mut S,
    ) -> Result<WriteReport, ExecError> {
        let start = self.options.observer.now();
        let Options { settings, observer, .. } = self.options;
        let size = settings.size;
        observer.event(&Event::Started { write_idx: self.write_idx, name: self.name, size });
        self.check_cancelled()?;
        let file = sink.create(&ImageRequest { name: self.name, size }).map_err(|error| self.sink_error(error))?;
        let mut report = self.new_report();
        let file = self.fill(view, earlier, file, &mut report)?;
        earlier.keep_proof(report.proof.clone(), report.unproved.clone());
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
            (report.proof, report.unproved) = earlier.proof(write_idx).clone();
            report.color = earlier.color(write_idx);
            return self.copy(write_idx, bytes, file, report);
        }
        let settings = self.options.settings;
        let exactly = Exactly::new(view, settings, Limit::new(settings));
        let file = if exactly.makes_all() {
            let file = Kept::new(file, earlier.n_bytes_to_keep(self.write_idx));
            self.stream(&Painter::Exact(&exactly), file, report)?
        } else {
            self.trace(view, &exactly, earlier, file, report)?
        };
        if let Some(bytes) = file.bytes {
            earlier.keep_file(self.write_idx, bytes);
        }
        if !matches!(report.origin, Origin::CopiedFrom { .. }) {
            report.counts += exactly.counts();
            let (record, unproved) = exactly.into_findings();
            report.unproved = match settings.precision.is_proved() {
                true => unproved,
                false => Unproved::unlisted(self.n_undecided(view, report)),
            };
            report.proof = Proof::new(settings.precision, report, record);
        }
        Ok(file.inner)
    }

    /// Returns how many pixels of an image that is not to be proved altogether are not: those that the tracer does not decide, or
    /// all of a draft and where lengths differ too much for its bounds.
    fn n_undecided(&self, view: SceneView<'_>, report: &WriteReport) -> u64 {
        let is_bound = report.counts.draft_pixels == 0 && is_within_range(&view, self.options.settings.part);
        if is_bound { report.counts.unproved_pixels } else { report.n_pixels() }
    }

    /// Does the work of [`Write::fill`] by the tracer.
    ///
    /// `exactly`: settles what it leaves open, where everything is to be proved.
    fn trace<F: io::Write + Send>(
        &self,
        view: SceneView<'_>,
        exactly: &Exactly<'_>,
        earlier: &mut Earlier,
        file: F,
        report: &mut WriteReport,
    ) -> Result<Kept<F>, ExecError> {
        let plan = plan(view, self.options.settings);
        report.savings = plan.savings();
        if let Some((write_idx, bytes)) = earlier.same_image(&plan) {
            (report.proof, report.unproved) = earlier.proof(write_idx).clone();
            report.color = earlier.color(write_idx);
            return Ok(Kept::new(self.copy(write_idx, bytes, file, report)?, 0));
        }
        let file = Kept::new(file, earlier.n_bytes_to_keep(self.write_idx));
        let shared = earlier.shared_pixels(&plan);
        if let Some((write_idx, changed)) = &shared {
            if let (Some(proof), _) = earlier.proof(*write_idx) {
                exactly.take_over(proof.exact.taken_over(|column, row| !changed.contains(column, row)));
            }
            report.origin = Origin::SharedWith {
                write_idx: *write_idx,
                n_traced_tiles: changed.n_tiles(),
                n_tiles: changed.n_all_tiles(),
                n_shared_pixels: report.n_pixels() - changed.n_pixels(report.size),
            };
        }
        let canvas = earlier.canvas(self.write_idx, &plan, shared.is_some());
        let n_objects = (plan.report.n_spheres + plan.report.n_cylinders) as u64;
        let tracer = Tracer::new(plan);
        let tracer = match canvas {
            Some(canvas) => tracer.upon(canvas, shared.map(|(_, changed)| changed)),
            None => tracer,
        };
        let is_proved = self.options.settings.precision.is_proved();
        let tracer = if is_proved { tracer.settled_by(exactly) } else { tracer };
        let painter = Painter::Traced(Box::new(tracer), exactly);
        let file = self.stream(&painter, file, report)?;
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
            unproved: Unproved::default(),
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
        self.options.cancellation.is_cancelled()
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
