//! The clock of the executor, and its progress on the terminal.

use std::fmt;
use std::io::{self, IsTerminal};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use clisc::exec::{Event, Observer};
use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};

/// A render shorter than this shows no bar.
const MOMENT: Duration = Duration::from_millis(500);

/// How often the time on a bar moves.
const TICK: Duration = Duration::from_millis(100);

/// Watches an execution: a bar on standard error when that is a terminal and the image takes longer than a moment.
#[derive(Debug)]
pub struct Progress {
    epoch: Instant,
    is_shown: bool,
    image: Mutex<Option<Image>>,
}

/// The image being made.
#[derive(Debug)]
struct Image {
    name: String,
    n_rows: u32,
    start: Instant,
    bar: Option<ProgressBar>,
}

impl Progress {
    /// Makes the watcher; one that is not wanted is only a clock.
    pub fn new(wanted: bool) -> Self {
        Self { epoch: Instant::now(), is_shown: wanted && io::stderr().is_terminal(), image: Mutex::new(None) }
    }

    /// Takes the bar away, however the execution ended.
    pub fn clear(&self) {
        let image = self.image.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(bar) = image.and_then(|image| image.bar) {
            bar.finish_and_clear();
        }
    }

    fn advance(&self, n_rows: u32) {
        let mut image = self.image.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(image) = image.as_mut() else { return };
        if image.bar.is_none() && image.start.elapsed() > MOMENT && n_rows < image.n_rows {
            image.bar = Some(image.new_bar());
        }
        if let Some(bar) = &image.bar {
            bar.set_position(n_rows.into());
        }
    }
}

impl Image {
    fn new_bar(&self) -> ProgressBar {
        let style = ProgressStyle::with_template("{msg} [{bar:40}] {percent:>3}%  {left}")
            .expect("a sound template")
            .progress_chars("=> ")
            .with_key("left", |state: &ProgressState, out: &mut dyn fmt::Write| {
                let _ = write_time_left(state, out);
            });
        let bar = ProgressBar::new(self.n_rows.into()).with_style(style).with_message(self.name.clone());
        let bar = bar.with_elapsed(self.start.elapsed());
        bar.enable_steady_tick(TICK);
        bar
    }
}

/// Writes how long the rest takes at the speed so far; indicatif's own guess knows nothing of the time before the bar.
fn write_time_left(state: &ProgressState, out: &mut dyn fmt::Write) -> fmt::Result {
    let n_left = state.len().unwrap_or_default().saturating_sub(state.pos());
    let seconds = state.elapsed().as_secs_f64() * n_left as f64 / state.pos().max(1) as f64;
    write!(out, "about {} left", HumanDuration(Duration::from_secs_f64(seconds.ceil())))
}

impl Observer for Progress {
    fn event(&self, event: &Event<'_>) {
        match *event {
            Event::Started { name, size, .. } if self.is_shown => {
                // An image may start anew: in f64.
                self.clear();
                let image = Image { name: name.to_owned(), n_rows: size.height(), start: Instant::now(), bar: None };
                *self.image.lock().unwrap_or_else(PoisonError::into_inner) = Some(image);
            }
            Event::RowsDone { n_rows, .. } => self.advance(n_rows),
            Event::Finished(_) => self.clear(),
            _ => {}
        }
    }

    fn now(&self) -> Duration {
        self.epoch.elapsed()
    }
}
