//! One `write`: its image from the first band to its name.

use std::io;
use std::mem;
use std::time::Duration;

use crate::exec::{Event, ExecError, ImageRequest, Options, Sink, SinkError, WriteReport};
use crate::image::PngStream;
use crate::ir::{SceneView, Valid};
use crate::plan::{Settings, plan};
use crate::trace::{Counts, Tracer};

/// The most bytes of pixels in one band; two bands are in memory at a time.
const BAND_BYTES: u64 = 4 << 20;

/// The most samples in one band: about a tenth of a second's work for an easy scene on two cores.
const BAND_SAMPLES: u64 = 1 << 20;

/// The samples of the first band, when it is not known yet how hard the scene is.
const FIRST_BAND_SAMPLES: u64 = 1 << 16;

/// What a band should take: progress is told and a cancellation seen between bands.
const BAND_TIME: Duration = Duration::from_millis(200);

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

    /// Traces the image into `file`, encoding each band while the next is traced.
    fn stream<F>(&self, tracer: &Tracer<'_>, file: F, report: &mut WriteReport) -> Result<F, ExecError>
    where
        F: io::Write + Send,
    {
        let size = report.size;
        let row_bytes = size.width() as usize * 3;
        let mut band = BandSize::new(self.options.settings);
        let file = Counted { inner: file, n_bytes: 0 };
        let mut png = PngStream::new(file, size.width(), size.height()).map_err(|e| self.write_error(e))?;
        let cancellation = self.options.cancellation;
        let (mut done, mut next) = (Vec::new(), Vec::new());
        let mut n_rows = 0;
        while n_rows < size.height() {
            let rows = n_rows..size.height().min(n_rows + band.n_rows);
            n_rows = rows.end;
            next.resize(rows.len() * row_bytes, 0);
            let ((counts, trace_time), (encoded, encode_time)) = rayon::join(
                || self.timed(|| tracer.render_rows_unless(rows, &mut next, &|| cancellation.is_cancelled())),
                || self.timed(|| png.write_rows(&done)),
            );
            report.counts += counts;
            report.trace_time += trace_time;
            report.encode_time += encode_time;
            encoded.map_err(|error| self.write_error(error))?;
            self.check_cancelled()?;
            band.adapt(trace_time);
            mem::swap(&mut done, &mut next);
            self.options.observer.event(&Event::RowsDone { write_idx: self.write_idx, n_rows });
        }
        let (ended, time) = self.timed(|| png.write_rows(&done).and_then(|()| png.finish()));
        let file = ended.map_err(|error| self.write_error(error))?;
        report.encode_time += time;
        report.n_bytes = file.n_bytes;
        Ok(file.inner)
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

/// How many rows make a band: few at first, then as many as take a fair time.
struct BandSize {
    n_rows: u32,
    max_rows: u32,
}

impl BandSize {
    fn new(settings: &Settings) -> Self {
        let width = u64::from(settings.size.width());
        let row_samples = width * u64::from(settings.samples).pow(2);
        let rows = |rows: u64| rows.clamp(1, settings.size.height().into()) as u32;
        let max_rows = rows((BAND_BYTES / (width * 3)).min(BAND_SAMPLES / row_samples));
        Self { n_rows: rows(FIRST_BAND_SAMPLES / row_samples).min(max_rows), max_rows }
    }

    /// Chooses the next size by the time that a band took; without a clock bands grow to the largest.
    fn adapt(&mut self, took: Duration) {
        if took < BAND_TIME / 2 {
            self.n_rows = (self.n_rows * 2).min(self.max_rows);
        } else if took > BAND_TIME * 2 {
            self.n_rows = (self.n_rows / 2).max(1);
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Size;

    fn band(width: u32, height: u32, samples: u32) -> BandSize {
        let size = Size::new(width, height).unwrap();
        BandSize::new(&Settings { size, samples, ..Settings::default() })
    }

    #[test]
    fn bands_are_bounded_in_bytes_and_samples_and_hold_a_row() {
        for (width, height, samples, first, most) in [
            (300, 300, 1, 218, 300),
            (65535, 65535, 1, 1, 16),
            (1, 65535, 1, 65535, 65535),
            (300, 300, 256, 1, 1),
            (4000, 4000, 2, 4, 65),
        ] {
            let band = band(width, height, samples);
            assert_eq!((band.n_rows, band.max_rows), (first, most), "{width}x{height}, {samples} samples");
            assert!(u64::from(band.max_rows) * u64::from(width) * 3 <= BAND_BYTES);
        }
    }

    #[test]
    fn bands_follow_the_time_they_take() {
        let mut band = band(4000, 4000, 1);
        let mut rows = Vec::new();
        for millis in [0, 150, 99, 1000, 1000, 1000, 1000, 1000, 1000, 1000, 1] {
            band.adapt(Duration::from_millis(millis));
            rows.push(band.n_rows);
        }
        assert_eq!(rows, [32, 32, 64, 32, 16, 8, 4, 2, 1, 1, 2]);
        (0..20).for_each(|_| band.adapt(Duration::ZERO));
        assert_eq!(band.n_rows, band.max_rows);
    }
}
