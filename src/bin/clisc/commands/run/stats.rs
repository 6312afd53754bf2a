//! `clisc run --stats`: times and counts of each scene.

use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

use clisc::exec::{Origin, WriteReport};
use clisc::plan::Savings;
use clisc::trace::kernels::Backend;
use clisc::trace::{Counts, Spared};
use serde::{Serialize, Serializer};

use crate::disk::Place;
use crate::input;
use crate::outcome::Outcome;

/// The version of the JSON document: a field may be added, none changes its meaning without a new version.
const VERSION: u32 = 1;

/// The whole document of `--stats=json`.
#[derive(Debug, Serialize)]
pub struct StatsReport {
    version: u32,
    /// How many rendered.
    pub threads: usize,
    /// The instructions of the machine that were used.
    pub backend: &'static str,
    /// One for each scene, in the order of the command line.
    pub scenes: Vec<SceneStats>,
}

/// What one scene took; the sums of its images.
#[derive(Debug, Serialize)]
pub struct SceneStats {
    scene: String,
    /// How it ended.
    pub outcome: Outcome,
    /// Text to tree.
    #[serde(rename = "parse_seconds", serialize_with = "seconds")]
    pub parse: Duration,
    /// Tree to valid program.
    #[serde(rename = "lower_seconds", serialize_with = "seconds")]
    pub lower: Duration,
    /// Time of all threads, added up.
    #[serde(rename = "trace_seconds", serialize_with = "seconds")]
    trace: Duration,
    /// Time of all threads, added up.
    #[serde(rename = "encode_seconds", serialize_with = "seconds")]
    encode: Duration,
    #[serde(rename = "save_seconds", serialize_with = "seconds")]
    save: Duration,
    #[serde(flatten)]
    counts: Counts,
    /// Pixels that are not proved: with their best values, with open ties, or copied from such.
    not_proved: u64,
    skipped: Skipped,
    images: Vec<ImageStats>,
}

/// What was left out.
#[derive(Clone, Copy, Debug, Default, Serialize)]
struct Skipped {
    /// By plans, before any ray was cast.
    #[serde(flatten)]
    planned: Savings,
    /// While tracing.
    #[serde(flatten)]
    traced: Spared,
}

/// What one image took.
#[derive(Debug, Serialize)]
struct ImageStats {
    path: String,
    width: u32,
    height: u32,
    /// The arithmetic that was asked for.
    precision: &'static str,
    bytes: u64,
    #[serde(rename = "trace_seconds", serialize_with = "seconds")]
    trace: Duration,
    #[serde(rename = "encode_seconds", serialize_with = "seconds")]
    encode: Duration,
    #[serde(rename = "save_seconds", serialize_with = "seconds")]
    save: Duration,
    #[serde(rename = "total_seconds", serialize_with = "seconds")]
    total: Duration,
    #[serde(flatten)]
    counts: Counts,
    /// Pixels that are not proved.
    not_proved: u64,
    skipped: Skipped,
    /// The earlier `write`, from 0, of which it has all pixels, or all but those of the tiles that are traced.
    shares_with: Option<usize>,
    /// Tiles that are traced, when it shares pixels.
    traced_tiles: Option<usize>,
}

fn seconds<S: Serializer>(time: &Duration, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(time.as_secs_f64())
}

impl StatsReport {
    /// Makes the report of a call that has not rendered yet.
    pub fn new(backend: Backend) -> Self {
        Self { version: VERSION, threads: 0, backend: backend.name(), scenes: Vec::new() }
    }

    /// Returns the worst outcome.
    pub fn outcome(&self) -> Outcome {
        self.scenes.iter().map(|scene| scene.outcome).max().unwrap_or_default()
    }

    /// Returns the document.
    pub fn json(&self) -> anyhow::Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }
}

impl SceneStats {
    /// Makes the stats of a scene of which nothing is done yet.
    pub fn new(path: &Path) -> Self {
        Self {
            scene: input::name_of(path),
            outcome: Outcome::Fine,
            parse: Duration::ZERO,
            lower: Duration::ZERO,
            trace: Duration::ZERO,
            encode: Duration::ZERO,
            save: Duration::ZERO,
            counts: Counts::default(),
            not_proved: 0,
            skipped: Skipped::default(),
            images: Vec::new(),
        }
    }

    /// Adds what the images took.
    pub fn add_writes(&mut self, place: &Place, reports: &[WriteReport]) {
        for report in reports {
            self.trace += report.trace_time;
            self.encode += report.encode_time;
            self.save += report.save_time;
            self.counts += report.counts;
            self.not_proved += report.n_unproved();
            self.skipped.planned += report.savings;
            self.skipped.traced += report.spared;
            let (shares_with, traced_tiles) = shared(report.origin);
            self.images.push(ImageStats {
                path: place.shown(&report.name).display().to_string(),
                width: report.size.width(),
                height: report.size.height(),
                precision: report.precision.name(),
                bytes: report.n_bytes,
                trace: report.trace_time,
                encode: report.encode_time,
                save: report.save_time,
                total: report.total_time,
                counts: report.counts,
                not_proved: report.n_unproved(),
                skipped: Skipped { planned: report.savings, traced: report.spared },
                shares_with,
                traced_tiles,
            });
        }
    }

    /// Returns the table that `--stats` prints.
    pub fn table(&self, backend: &str) -> String {
        let mut table = format!("{}\n", self.scene);
        let _ = writeln!(table, "  {:<15} {backend:>14}", "backend");
        let times = [
            ("parse", self.parse),
            ("lower", self.lower),
            ("trace", self.trace),
            ("encode", self.encode),
            ("save", self.save),
        ];
        for (what, time) in times {
            let _ = writeln!(table, "  {what:<15} {:>14.6} s", time.as_secs_f64());
        }
        let Counts {
            eye_rays,
            reflected_rays,
            shadow_rays,
            tests,
            reflected_tests: _,
            shadow_tests,
            lightings: _,
            settled_rays: _,
            draft_pixels,
            settled_pixels,
            refined_pixels,
            long_pixels,
            exact_pixels,
            unproved_pixels: _,
            ties,
            largest_bound: _,
        } = self.counts;
        let counts = [
            ("eye rays", eye_rays),
            ("reflected rays", reflected_rays),
            ("shadow rays", shadow_rays),
            ("tests", tests),
            ("shadow tests", shadow_tests),
            ("draft pixels", draft_pixels),
            ("settled pixels", settled_pixels),
            ("refined pixels", refined_pixels),
            ("long pixels", long_pixels),
            ("exact pixels", exact_pixels),
            ("ties", ties),
            ("not proved", self.not_proved),
        ];
        for (what, count) in counts {
            let _ = writeln!(table, "  {what:<15} {count:>14}");
        }
        self.add_skipped(&mut table);
        table
    }

    /// Adds what was left out, and where pixels came from.
    fn add_skipped(&self, table: &mut String) {
        let Skipped { planned: skipped, traced } = &self.skipped;
        let rows = [
            ("objects left out", skipped.objects_left_out),
            ("lights left out", skipped.lights_left_out),
            ("terms not computed", skipped.terms_not_computed),
            ("occluders left out", skipped.occluders_left_out),
            ("tiles not visited", skipped.tiles_not_visited),
            ("eye rays not cast", skipped.eye_rays_not_cast),
            ("eye tests not made", skipped.eye_tests_not_made),
            ("reflected rays not cast", traced.reflected_rays_not_cast),
            ("reflected tests not made", traced.reflected_tests_not_made),
            ("shadow rays not cast", traced.shadow_rays_not_cast),
            ("shadow tests not made", traced.shadow_tests_not_made),
        ];
        let _ = writeln!(table, "skipped");
        for (what, count) in rows {
            let _ = writeln!(table, "  {what:<24} {count:>14}");
        }
        for image in &self.images {
            let path = &image.path;
            let _ = match (image.shares_with, image.traced_tiles) {
                (Some(write), Some(n)) => writeln!(table, "  {path} shares all but {n} tiles with write {write}"),
                (Some(write), None) => writeln!(table, "  {path} is the image of write {write}"),
                (None, _) => Ok(()),
            };
        }
    }
}

/// Returns the earlier `write` that an image shares pixels with, and the tiles that it does not, if it shares some alone.
fn shared(origin: Origin) -> (Option<usize>, Option<usize>) {
    match origin {
        Origin::CopiedFrom { write_idx } => (Some(write_idx), None),
        Origin::SharedWith { write_idx, n_traced_tiles, .. } => (Some(write_idx), Some(n_traced_tiles)),
        _ => (None, None),
    }
}
