//! The pixels of one `write` on their way from the tracer through the encoder to the file.
//!
//! As a rule each thread takes whole bands: it traces one into memory that stays in its cache, and encodes it while it is
//! hot. If that leaves threads idle or the user without news, since bands are few or take long, all threads trace some
//! rows together and then encode their bands. The bytes are the same.

use std::io;
use std::ops::Range;
use std::time::Duration;

use rayon::prelude::*;

use crate::exec::colors::Colors;
use crate::exec::in_order::in_order;
use crate::exec::painter::Painter;
use crate::exec::pieces::PieceSize;
use crate::exec::write::Write;
use crate::exec::{Event, ExecError, WriteReport};
use crate::image::{Crc32, EncodedBand, PngBands, PngWriter};
use crate::trace::Counts;

/// Threads take bands of their own if there are so many for each: a thread that finds none left waits at most as long as
/// one takes.
const MIN_BANDS_PER_THREAD: usize = 4;

/// Threads take bands of their own if these have at most so many samples: some seconds of a hard scene.
const MAX_BAND_SAMPLES: u64 = 1 << 22;

/// The bands on their way for each thread.
const BANDS_AHEAD_PER_THREAD: usize = 4;

/// The most memory of bands that wait to be written, if there are more than one for each thread.
const MAX_BYTES_AHEAD: usize = 64 << 20;

/// A band made by one thread.
#[derive(Default)]
struct Band {
    encoded: EncodedBand,
    rows: Range<u32>,
    /// Its pixels, if some may have to be taken back.
    pixels: Vec<u8>,
    colors: Colors,
    counts: Counts,
    trace_time: Duration,
    encode_time: Duration,
}

impl Write<'_> {
    /// Traces the image into `file`.
    pub(super) fn stream<F>(&self, painter: &Painter<'_, '_>, file: F, report: &mut WriteReport) -> Result<F, ExecError>
    where
        F: io::Write + Send,
    {
        let bands = PngBands::new(report.size.width(), report.size.height()).map_err(|e| self.write_error(e))?;
        let is_proved = self.options.settings.precision.is_proved();
        let file = Counted { inner: file, n_bytes: 0, crc32: is_proved.then(Crc32::default) };
        let png = PngWriter::new(file, &bands).map_err(|error| self.write_error(error))?;
        let mut output = Output { write: self, png, colors: Colors::None, report };
        if !painter.is_slow() && self.are_bands_for_one_thread(&bands) {
            self.render_bands(painter, &bands, &mut output)?;
        } else {
            self.render_together(painter, &bands, &mut output)?;
        }
        output.finish()
    }

    /// Tells whether each thread is to take bands of its own.
    fn are_bands_for_one_thread(&self, bands: &PngBands) -> bool {
        let samples = u64::from(self.options.settings.samples).pow(2);
        let band_samples = u64::from(bands.width()) * u64::from(bands.rows_per_band()) * samples;
        let n_threads = rayon::current_num_threads();
        let are_many = n_threads == 1 || bands.n_bands() as usize >= n_threads * MIN_BANDS_PER_THREAD;
        are_many && band_samples <= MAX_BAND_SAMPLES
    }

    /// Lets each thread trace and encode bands of its own.
    fn render_bands<F>(
        &self,
        painter: &Painter<'_, '_>,
        bands: &PngBands,
        output: &mut Output<'_, F>,
    ) -> Result<(), ExecError>
    where
        F: io::Write + Send,
    {
        let band_bytes = bands.rgb_bytes(&bands.rows(0));
        let n_threads = rayon::current_num_threads();
        let n_ahead = (MAX_BYTES_AHEAD / band_bytes).clamp(n_threads + 1, n_threads * BANDS_AHEAD_PER_THREAD);
        let make =
            |pixels: &mut Vec<u8>, band_idx, band: &mut Band| self.make_band(painter, bands, band_idx, pixels, band);
        in_order(bands.n_bands(), n_ahead as u32, make, |band_idx, band| {
            output.close_band(painter, bands, band_idx, band);
            output.put_band(band)
        })
    }

    /// Traces and encodes a band on this thread.
    fn make_band(
        &self,
        painter: &Painter<'_, '_>,
        bands: &PngBands,
        band_idx: u32,
        pixels: &mut Vec<u8>,
        band: &mut Band,
    ) -> Result<(), ExecError> {
        let rows = bands.rows(band_idx);
        band.rows = rows.clone();
        band.pixels.clear();
        if let Some(color) = painter.uniform_rows(rows.clone()) {
            (band.counts, band.trace_time) = Default::default();
            band.colors = Colors::One(color);
            ((), band.encode_time) = self.timed(|| bands.encode_uniform(band_idx, color, &mut band.encoded));
            return self.check_cancelled();
        }
        pixels.resize(bands.rgb_bytes(&rows), 0);
        let is_cancelled = || self.is_cancelled();
        (band.counts, band.trace_time) = self.timed(|| painter.render_band(rows.clone(), pixels, &is_cancelled));
        self.check_cancelled()?;
        band.colors = Colors::of(pixels);
        if painter.has_pending(&rows) {
            band.pixels.extend_from_slice(pixels);
        }
        ((), band.encode_time) = self.timed(|| bands.encode(band_idx, pixels, &mut band.encoded));
        Ok(())
    }

    /// Lets all threads trace the same rows, some at a time, and then encode the bands that are whole.
    fn render_together<F>(
        &self,
        painter: &Painter<'_, '_>,
        bands: &PngBands,
        output: &mut Output<'_, F>,
    ) -> Result<(), ExecError>
    where
        F: io::Write + Send,
    {
        let n_threads = rayon::current_num_threads();
        let mut size = PieceSize::new(self.options.settings, n_threads);
        // Those of the rows behind the last whole band.
        let mut pixels = Vec::new();
        let (mut n_rows, mut n_bands) = (0, 0);
        while n_rows < bands.height() {
            let rows = n_rows..size.end(n_rows);
            n_rows = rows.end;
            let start = pixels.len();
            pixels.resize(start + bands.rgb_bytes(&rows), 0);
            let (counts, time) = self.timed(|| {
                let mut counts = self.render_piece(painter, bands, rows.clone(), &mut pixels[start..]);
                painter.close(&rows, &mut pixels[start..], &mut counts);
                counts
            });
            self.check_cancelled()?;
            size.adapt(time);
            output.report.counts += counts;
            output.report.trace_time += time * n_threads as u32;
            n_bands += output.put_whole_bands(bands, n_bands, n_rows, &mut pixels)?;
            output.tell(n_rows);
        }
        Ok(())
    }

    /// Lets all threads trace some rows, but for bands that are proved to have one colour.
    fn render_piece(&self, painter: &Painter<'_, '_>, bands: &PngBands, rows: Range<u32>, rgb: &mut [u8]) -> Counts {
        let is_cancelled = || self.is_cancelled();
        let at = |row: u32| bands.rgb_bytes(&(rows.start..row));
        let mut counts = Counts::default();
        let mut n_done = rows.start;
        let mut next = rows.start;
        while next < rows.end {
            let band = bands.rows(next / bands.rows_per_band());
            let part = next..band.end.min(rows.end);
            next = part.end;
            if let Some(color) = painter.uniform_rows(band) {
                let before = &mut rgb[at(n_done)..at(part.start)];
                counts += painter.render_rows(n_done..part.start, before, &is_cancelled);
                rgb[at(part.start)..at(part.end)].as_chunks_mut().0.fill(color);
                n_done = part.end;
            }
        }
        counts += painter.render_rows(n_done..rows.end, &mut rgb[at(n_done)..], &is_cancelled);
        counts
    }
}

/// Where bands meet the file.
struct Output<'a, F> {
    write: &'a Write<'a>,
    png: PngWriter<Counted<F>>,
    /// Those of the bands so far.
    colors: Colors,
    report: &'a mut WriteReport,
}

impl<F: io::Write> Output<'_, F> {
    /// Writes the next band.
    fn put(&mut self, encoded: &EncodedBand) -> Result<(), ExecError> {
        let (written, time) = self.write.timed(|| self.png.write_band(encoded));
        self.report.encode_time += time;
        written.map_err(|error| self.write.write_error(error))
    }

    /// Takes back what is too much exact work, and encodes the band anew if there is any.
    fn close_band(&self, painter: &Painter<'_, '_>, bands: &PngBands, band_idx: u32, band: &mut Band) {
        if !band.pixels.is_empty() && painter.close(&band.rows, &mut band.pixels, &mut band.counts) {
            band.colors = Colors::of(&band.pixels);
            bands.encode(band_idx, &band.pixels, &mut band.encoded);
        }
    }

    /// Writes the next band and reports what it took.
    fn put_band(&mut self, band: &Band) -> Result<(), ExecError> {
        self.colors = self.colors.and(band.colors);
        self.report.counts += band.counts;
        self.report.trace_time += band.trace_time;
        self.report.encode_time += band.encode_time;
        self.put(&band.encoded)?;
        self.tell(band.rows.end);
        Ok(())
    }

    /// Encodes and writes the bands from `n_bands` on that are whole when `n_rows` are traced, and takes them off
    /// `pixels`; returns how many they are.
    fn put_whole_bands(
        &mut self,
        bands: &PngBands,
        n_bands: u32,
        n_rows: u32,
        pixels: &mut Vec<u8>,
    ) -> Result<u32, ExecError> {
        let is_all = n_rows == bands.height();
        let end = if is_all { bands.n_bands() } else { n_rows / bands.rows_per_band() };
        let band_bytes = bands.rgb_bytes(&bands.rows(0));
        let encode = |(band_idx, rgb): (u32, &[u8])| {
            self.write.timed(|| {
                let mut encoded = EncodedBand::default();
                bands.encode(band_idx, rgb, &mut encoded);
                (encoded, Colors::of(rgb))
            })
        };
        let whole = (n_bands..end).into_par_iter().zip(pixels.par_chunks(band_bytes));
        for ((encoded, colors), time) in whole.map(encode).collect::<Vec<_>>() {
            self.colors = self.colors.and(colors);
            self.report.encode_time += time;
            self.put(&encoded)?;
        }
        pixels.drain(..pixels.len().min((end - n_bands) as usize * band_bytes));
        Ok(end - n_bands)
    }

    /// Tells that rows are traced.
    fn tell(&self, n_rows: u32) {
        self.write.options.observer.event(&Event::RowsDone { write_idx: self.write.write_idx, n_rows });
    }

    /// Ends the file.
    fn finish(self) -> Result<F, ExecError> {
        let (ended, time) = self.write.timed(|| self.png.finish());
        let file = ended.map_err(|error| self.write.write_error(error))?;
        self.report.encode_time += time;
        self.report.n_bytes = file.n_bytes;
        self.report.color = self.colors.one();
        self.report.crc32 = file.crc32.map(|crc32| crc32.value());
        Ok(file.inner)
    }
}

/// Counts the bytes on their way to a file, and sums them up where everything is proved.
struct Counted<F> {
    inner: F,
    n_bytes: u64,
    crc32: Option<Crc32>,
}

impl<F: io::Write> io::Write for Counted<F> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n_written = self.inner.write(bytes)?;
        self.n_bytes += n_written as u64;
        if let Some(crc32) = &mut self.crc32 {
            crc32.update(&bytes[..n_written]);
        }
        Ok(n_written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}
