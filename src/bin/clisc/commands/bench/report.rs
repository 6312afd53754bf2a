//! What was measured, as a table and as JSON.

use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

use clisc::plan::Size;
use serde::Serialize;

use super::error::Errors;
use super::measure::REFERENCE_SAMPLES;
use super::plot;
use crate::input;

/// The version of the JSON document: a field may be added, none changes its meaning without a new version.
const VERSION: u32 = 1;

/// What errors of modes are measured against.
const TRUTH: &str = "exact";

/// The whole document of `--json`.
#[derive(Debug, Serialize)]
pub struct Report {
    version: u32,
    threads: usize,
    backend: &'static str,
    repeat: u32,
    /// One for each scene without errors, in the order of the command line.
    pub scenes: Vec<SceneReport>,
}

/// What was measured of one scene.
#[derive(Debug, Serialize)]
pub struct SceneReport {
    scene: String,
    width: u32,
    height: u32,
    truth: &'static str,
    modes: Vec<Measured>,
    reference_samples: u32,
    samples: Vec<Measured>,
}

/// What was measured of one way to render.
#[derive(Debug, Serialize)]
pub struct Measured {
    /// The mode, or `NxN` samples.
    pub name: String,
    /// Pixels that were drafted: none where the scene does not allow a draft.
    pub draft_pixels: u64,
    #[serde(flatten)]
    pub times: Times,
    #[serde(flatten)]
    pub errors: Errors,
    /// Whether nothing else is as fast and as right, and better in one of both.
    pub is_on_front: bool,
}

/// How long it took.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Times {
    pub runs: usize,
    pub median_seconds: f64,
    pub least_seconds: f64,
    pub most_seconds: f64,
}

impl Times {
    /// Sums up some times, at least one.
    pub fn of(mut times: Vec<Duration>) -> Self {
        times.sort_unstable();
        let seconds = |i: usize| times[i].as_secs_f64();
        let n = times.len();
        // Of an even number the mean of the two in the middle.
        let median_seconds = (seconds((n - 1) / 2) + seconds(n / 2)) / 2.0;
        Self { runs: n, median_seconds, least_seconds: seconds(0), most_seconds: seconds(n - 1) }
    }
}

impl Measured {
    /// Brings together what was measured.
    pub fn new(name: impl Into<String>, draft_pixels: u64, times: Times, errors: Errors) -> Self {
        Self { name: name.into(), draft_pixels, times, errors, is_on_front: false }
    }

    /// Tells whether this is no worse than another in time and error, and better in one.
    fn beats(&self, other: &Self) -> bool {
        let (time, other_time) = (self.times.median_seconds, other.times.median_seconds);
        let (error, other_error) = (self.errors.shown(), other.errors.shown());
        time <= other_time && error <= other_error && (time < other_time || error < other_error)
    }
}

/// Marks what nothing beats: the Pareto front.
fn mark_front(all: &mut [Measured]) {
    for i in 0..all.len() {
        all[i].is_on_front = !all.iter().any(|other| other.beats(&all[i]));
    }
}

impl Report {
    /// Makes a report of a call that renders with `n_threads`.
    pub fn new(n_threads: usize, backend: &'static str, repeat: u32) -> Self {
        Self { version: VERSION, threads: n_threads, backend, repeat, scenes: Vec::new() }
    }

    /// Returns the document.
    pub fn json(&self) -> anyhow::Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }
}

impl SceneReport {
    /// Makes the report of a scene.
    pub fn new(path: &Path, size: Size, mut modes: Vec<Measured>, mut samples: Vec<Measured>) -> Self {
        mark_front(&mut modes);
        mark_front(&mut samples);
        Self {
            scene: input::name_of(path),
            width: size.width(),
            height: size.height(),
            truth: TRUTH,
            modes,
            reference_samples: REFERENCE_SAMPLES,
            samples,
        }
    }

    /// Returns the tables for people.
    pub fn table(&self) -> String {
        let mut table = format!("{}  {}x{}\n", self.scene, self.width, self.height);
        add_rows(&mut table, "mode", self.truth, &self.modes);
        if !self.samples.is_empty() {
            let reference = format!("{0}x{0} samples", self.reference_samples);
            add_rows(&mut table, "samples", &reference, &self.samples);
        }
        table
    }

    /// Returns a plot for each comparison, by name.
    pub fn plots(&self) -> anyhow::Result<Vec<(&'static str, String)>> {
        let title = |against: &str| format!("{}, {}x{}, against {against}", self.scene, self.width, self.height);
        let mut plots = vec![("modes", plot::svg(&title(self.truth), "mean error before rounding", &self.modes)?)];
        if !self.samples.is_empty() {
            let title = title(&format!("{0}x{0} samples", self.reference_samples));
            plots.push(("samples", plot::svg(&title, "mean error", &self.samples)?));
        }
        Ok(plots)
    }
}

/// Adds a table of errors against something.
fn add_rows(table: &mut String, what: &str, against: &str, all: &[Measured]) {
    let _ = writeln!(
        table,
        "  {what:<10} {:>10} {:>19} {:>5} {:>8} {:>4} {:>9} {:>10} {:>10}",
        "ms", "(least to most)", "runs", "wrong", "most", "mean", "raw most", "raw mean"
    );
    for Measured { name, draft_pixels, times, errors, is_on_front } in all {
        let star = if *is_on_front { "*" } else { "" };
        let ms = |seconds: f64| format!("{:.2}", 1e3 * seconds);
        let range = format!("({} to {})", ms(times.least_seconds), ms(times.most_seconds));
        let unrounded = |error: Option<f64>| error.map_or("-".to_owned(), |error| format!("{error:.1e}"));
        let _ = writeln!(
            table,
            "{star:>1} {name:<10} {:>10} {range:>19} {:>5} {:>8} {:>4} {:>9.1e} {:>10} {:>10}{}",
            ms(times.median_seconds),
            times.runs,
            errors.wrong_channels,
            errors.largest_levels,
            errors.mean_levels,
            unrounded(errors.largest_unrounded),
            unrounded(errors.mean_unrounded),
            if name == "f32" && *draft_pixels == 0 { "  (no draft of this scene)" } else { "" },
        );
    }
    let _ = writeln!(
        table,
        "  errors in levels against {against}, raw before rounding; * nothing is both faster and nearer"
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(seconds: f64, error: f64) -> Measured {
        let times = Times { runs: 1, median_seconds: seconds, least_seconds: seconds, most_seconds: seconds };
        let errors = Errors { mean_unrounded: Some(error), ..Errors::of_bytes(&[1], &[1]) };
        Measured::new("", 0, times, errors)
    }

    #[test]
    fn the_front_is_what_nothing_beats() {
        let mut all =
            [measured(1.0, 3.0), measured(2.0, 3.0), measured(2.0, 1.0), measured(3.0, 2.0), measured(9.0, 0.0)];
        mark_front(&mut all);
        assert_eq!(all.map(|one| one.is_on_front), [true, false, true, false, true]);
        let mut twins = [measured(1.0, 1.0), measured(1.0, 1.0)];
        mark_front(&mut twins);
        assert!(twins.iter().all(|one| one.is_on_front));
    }

    #[test]
    fn times_are_summed_up_by_their_middle() {
        let times = |ms: &[u64]| Times::of(ms.iter().map(|ms| Duration::from_millis(*ms)).collect());
        let odd = times(&[30, 10, 90]);
        assert_eq!((odd.runs, odd.median_seconds, odd.least_seconds, odd.most_seconds), (3, 0.03, 0.01, 0.09));
        assert!((times(&[40, 10, 20, 30]).median_seconds - 0.025).abs() < 1e-12);
    }
}
