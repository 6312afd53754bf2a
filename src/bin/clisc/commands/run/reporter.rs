//! What `clisc run` says while a scene is rendered.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use clisc::exec::{Event, Observer, WriteReport};

use crate::args::{RunArgs, StatsFormat};
use crate::disk::Place;
use crate::print;
use crate::progress::Progress;

/// Watches the execution of one scene: shows its progress, prints a line for each image, keeps the reports.
#[derive(Debug)]
pub struct Reporter<'a> {
    args: &'a RunArgs,
    place: &'a Place,
    progress: Progress,
    told: Mutex<Told>,
}

/// What was told so far.
#[derive(Debug, Default)]
struct Told {
    reports: Vec<WriteReport>,
    /// Why a line could not be printed; nothing is printed after it.
    failure: Option<anyhow::Error>,
}

impl<'a> Reporter<'a> {
    /// Makes the reporter of one scene, whose images go to `place`.
    pub fn new(args: &'a RunArgs, place: &'a Place) -> Self {
        Self { args, place, progress: Progress::new(!args.quiet), told: Mutex::default() }
    }

    /// Prints a line of results, unless quiet or standard output is to be a JSON document.
    pub fn print(&self, line: &str) {
        if self.args.quiet || self.args.stats == Some(StatsFormat::Json) {
            return;
        }
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        if *self.place == Place::Stdout {
            print::to_stderr(line);
        } else if told.failure.is_none() {
            told.failure = print::to_stdout(line).err();
        }
    }

    /// Ends the watch and returns a report for each image saved.
    ///
    /// # Errors
    /// When a line could not be printed.
    pub fn finish(self) -> anyhow::Result<Vec<WriteReport>> {
        self.progress.clear();
        let told = self.told.into_inner().unwrap_or_else(PoisonError::into_inner);
        told.failure.map_or(Ok(told.reports), Err)
    }
}

impl Observer for Reporter<'_> {
    fn event(&self, event: &Event<'_>) {
        self.progress.event(event);
        if let Event::Finished(report) = event {
            self.print(&saved_line(self.place, report));
            self.told.lock().unwrap_or_else(PoisonError::into_inner).reports.push((*report).clone());
        }
    }

    fn now(&self) -> Duration {
        self.progress.now()
    }
}

fn saved_line(place: &Place, report: &WriteReport) -> String {
    let path = place.shown(&report.name);
    let (width, height) = (report.size.width(), report.size.height());
    let (bytes, time) = (show_bytes(report.n_bytes), show_time(report.total_time));
    format!("wrote {} ({width}x{height}, {bytes}) in {time}\n", path.display())
}

/// Shows a length with three digits or so: `812 B`, `5.4 kB`, `61 MB`.
fn show_bytes(n_bytes: u64) -> String {
    let mut value = n_bytes as f64;
    let mut units = ["B", "kB", "MB", "GB", "TB"].iter();
    let mut unit = units.next().unwrap_or(&"");
    while value >= 1000.0
        && let Some(larger) = units.next()
    {
        value /= 1000.0;
        unit = larger;
    }
    if n_bytes < 1000 || value >= 10.0 { format!("{value:.0} {unit}") } else { format!("{value:.1} {unit}") }
}

/// Shows a time with two digits or so: `0.034 s`, `12.3 s`, `3 min 20 s`.
fn show_time(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    if seconds < 1.0 {
        format!("{seconds:.3} s")
    } else if seconds < 60.0 {
        format!("{seconds:.1} s")
    } else {
        format!("{} min {} s", time.as_secs() / 60, time.as_secs() % 60)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_and_times_are_short() {
        for (n_bytes, shown) in [(0, "0 B"), (999, "999 B"), (5432, "5.4 kB"), (61_400_000, "61 MB")] {
            assert_eq!(show_bytes(n_bytes), shown);
        }
        for (millis, shown) in [(34, "0.034 s"), (1234, "1.2 s"), (200_000, "3 min 20 s")] {
            assert_eq!(show_time(Duration::from_millis(millis)), shown);
        }
    }
}
