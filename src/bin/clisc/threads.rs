//! The threads to render with, started when it is known that they are worth it.
//!
//! To start a thread and to end it takes a tenth of a millisecond, and it works a tenth later. So a call for one small
//! scene is looked at first: text that one thread reads, and an image without mirrors, of few pixels and objects, is left
//! to the main thread.

use std::fs;
use std::path::Path;

use anyhow::Context;
use clisc::ir::{Command, Valid};
use clisc::plan::{Precision, Settings};
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Shorter text is read by one thread, in bytes.
const SMALL_TEXT: u64 = 16 << 10;

/// Samples times objects times lights of an image that one thread makes in a third of a millisecond.
const SMALL_WORK: usize = 1 << 19;

/// On so few cores all are used, also if a control group grants less than their whole time: to read what it grants takes
/// half as long as to start a thread.
#[cfg(target_os = "linux")]
const FEW_CORES: u32 = 4;

/// The threads of one call.
#[derive(Debug)]
pub struct Threads {
    /// As asked for; 0 means one a core.
    asked: u16,
    /// Whether one thread may be enough.
    may_be_one: bool,
    /// Once they are started.
    pool: Option<ThreadPool>,
}

impl Threads {
    /// Prepares `asked` threads, 0 for one a core, for so many scenes.
    pub fn new(asked: u16, n_scenes: usize) -> Self {
        Self { asked, may_be_one: asked == 0 && n_scenes == 1, pool: None }
    }

    /// Starts them if a file may be long enough for them.
    ///
    /// # Errors
    /// When they cannot be started.
    pub fn start_for_file(&mut self, path: &Path) -> anyhow::Result<()> {
        let is_short = || fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() < SMALL_TEXT);
        if self.may_be_one && is_short() { Ok(()) } else { self.start(self.asked) }
    }

    /// Starts as many as the images of a program are worth.
    ///
    /// # Errors
    /// When they cannot be started.
    pub fn start_for_images(&mut self, program: &Valid, settings: &Settings) -> anyhow::Result<()> {
        self.start(if self.may_be_one && is_small(program, settings) { 1 } else { self.asked })
    }

    /// The main thread is one of them, and does not wait for the others: work begins before they are awake.
    fn start(&mut self, n_threads: u16) -> anyhow::Result<()> {
        if self.pool.is_none() {
            let n_threads = if n_threads == 0 { one_a_core() } else { n_threads.into() };
            let threads = ThreadPoolBuilder::new().num_threads(n_threads).use_current_thread();
            self.pool = Some(threads.build().with_context(|| format!("cannot start {n_threads} threads"))?);
        }
        Ok(())
    }
}

/// Returns how many threads one a core are.
fn one_a_core() -> usize {
    #[cfg(target_os = "linux")]
    if let Ok(cores) = rustix::thread::sched_getaffinity(None)
        && cores.count() <= FEW_CORES
    {
        return cores.count().max(1) as usize;
    }
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Tells whether all images together are less work than a thread.
fn is_small(program: &Valid, settings: &Settings) -> bool {
    let n_images = program.commands.iter().filter(|command| matches!(command, Command::Write(_))).count();
    let side = |pixels: u32| pixels as usize * settings.samples as usize;
    let n_samples = side(settings.size.width()).saturating_mul(side(settings.size.height()));
    let per_sample = (program.spheres.len() + program.cylinders.len()) * (1 + program.lights.len());
    let has_mirrors = program.surfaces.as_slice().iter().any(|surface| surface.reflectance > 0.0);
    let is_quick = !has_mirrors && settings.precision != Precision::Exact;
    is_quick && n_samples.saturating_mul(n_images).saturating_mul(per_sample as usize) <= SMALL_WORK
}
