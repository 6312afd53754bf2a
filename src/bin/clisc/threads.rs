//! The threads to render with, started when they are worth it.
//!
//! To start a thread and to end it takes a tenth of a millisecond, and it works a tenth later. So a call for one small
//! image of a short scene is left to the main thread, and else the others begin before the first scene is read.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clisc::plan::Settings;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Shorter text is read by one thread, in bytes.
const SMALL_TEXT: u64 = 16 << 10;

/// The samples of an image that one thread makes in a few tenths of a millisecond.
const SMALL_IMAGE: u64 = 1 << 14;

/// On so few cores all are used, also if a control group grants less than their whole time: to read what it grants takes
/// half as long as to start a thread.
#[cfg(target_os = "linux")]
const FEW_CORES: u32 = 4;

/// Starts the threads of one call. The main thread is one of them, and does not wait for the others: work begins before
/// they are awake.
///
/// `asked`: how many; 0 means one a core, or one for little work.
///
/// # Errors
/// When they cannot be started.
pub fn start(asked: u16, scenes: &[PathBuf], settings: &Settings) -> anyhow::Result<ThreadPool> {
    let n_threads = match asked {
        0 if is_little(scenes, settings) => 1,
        0 => one_a_core(),
        n => n.into(),
    };
    let threads = ThreadPoolBuilder::new().num_threads(n_threads).use_current_thread();
    threads.build().with_context(|| format!("cannot start {n_threads} threads"))
}

/// Tells whether all is done before another thread would be of use.
fn is_little(scenes: &[PathBuf], settings: &Settings) -> bool {
    let side = |pixels: u32| u64::from(pixels) * u64::from(settings.samples);
    let n_samples = side(settings.size.width()).saturating_mul(side(settings.size.height()));
    let is_short = |path: &Path| fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() < SMALL_TEXT);
    n_samples < SMALL_IMAGE && matches!(scenes, [scene] if is_short(scene))
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
