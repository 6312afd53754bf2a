//! Finding and reading scenes.

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use anyhow::Context;
use clisc::source::{Source, SourceError};
use rayon::prelude::*;

use crate::walk::{self, Found};

/// What messages call standard input.
const STDIN_NAME: &str = "<stdin>";

/// From so many bytes on no source is made: there is no need to read on.
const TOO_LARGE: u64 = u32::MAX as u64;

/// Reads a scene file; `-` is standard input.
///
/// # Errors
/// When it cannot be read or is too large for a scene; the message names it.
pub fn read(path: &Path) -> anyhow::Result<Source> {
    if is_stdin(path) {
        let mut bytes = Vec::new();
        io::stdin().lock().take(TOO_LARGE).read_to_end(&mut bytes).context("cannot read standard input")?;
        return Ok(Source::from_bytes(STDIN_NAME, bytes)?);
    }
    let name = path.display();
    let read = || anyhow::Ok(Source::from_bytes(name.to_string(), read_file(path)?)?);
    read().with_context(|| format!("cannot read `{name}`"))
}

/// Tells whether an argument means standard input.
pub fn is_stdin(path: &Path) -> bool {
    path == Path::new("-")
}

/// Returns the name by which other programs find a scene, as far as it has one.
pub fn file_name<'a>(source: &'a Source, path: &'a Path) -> &'a Path {
    if is_stdin(path) { Path::new(source.name()) } else { path }
}

/// How many scenes are in memory at a time, and how many bytes of them.
const MAX_BATCH: (usize, u64) = (32, 64 << 20);

/// Does `work` on each scene, on all cores, and hands the results to `take`, in order.
///
/// # Errors
/// The first of `take`, which ends it all.
pub fn for_each_scene<T: Send>(
    scenes: &[PathBuf],
    work: impl Fn(&Path) -> T + Sync,
    mut take: impl FnMut(&Path, T) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let mut rest = scenes;
    while !rest.is_empty() {
        let (batch, others) = rest.split_at(batch_len(rest));
        let results: Vec<T> = match batch {
            // A single scene may use all cores itself.
            [only] => vec![work(only)],
            _ => batch.par_iter().map(|path| work(path)).collect(),
        };
        batch.iter().zip(results).try_for_each(|(path, result)| take(path, result))?;
        rest = others;
    }
    Ok(())
}

/// Returns how many of the first scenes fit in memory together, at least one.
fn batch_len(scenes: &[PathBuf]) -> usize {
    let mut n_bytes = 0;
    let fits = |path: &&PathBuf| {
        n_bytes += fs::metadata(path).map_or(0, |found| found.len());
        n_bytes <= MAX_BATCH.1
    };
    scenes.iter().take(MAX_BATCH.0).take_while(fits).count().max(1)
}

/// Returns the scenes that the arguments mean, each once, as far as they can be found: a path that is no folder means
/// itself, a folder every scene [below](walk::scenes_below) it.
pub fn find_all_scenes(paths: &[PathBuf]) -> Found {
    let mut seen = HashSet::new();
    let mut all = Found::default();
    for path in paths {
        let found = if path.is_dir() { walk::scenes_below(path) } else { Found::only(path) };
        let is_new = |path: &PathBuf| seen.insert(fs::canonicalize(path).unwrap_or_else(|_| path.clone()));
        all.scenes.extend(found.scenes.into_iter().filter(is_new));
        all.problems.extend(found.problems);
    }
    all
}

fn read_file(path: &Path) -> anyhow::Result<Vec<u8>> {
    let file = File::open(path)?;
    let n_bytes = file.metadata().map_or(0, |found| found.len());
    if n_bytes >= TOO_LARGE {
        let n_bytes = usize::try_from(n_bytes).unwrap_or(usize::MAX);
        return Err(SourceError::TooLarge { n_bytes }.into());
    }
    if n_bytes > PIECE_BYTES as u64
        && let Some(bytes) = read_in_pieces(&file, n_bytes)
    {
        return Ok(bytes);
    }
    let mut bytes = Vec::with_capacity(usize::try_from(n_bytes).unwrap_or(0));
    file.take(TOO_LARGE).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// How much of a large file one thread reads at a time; most of the work is making room for it in memory.
const PIECE_BYTES: usize = 1 << 20;

/// Reads a large file on all cores; `None` when that is not possible or the file has another length than it said.
#[cfg(unix)]
fn read_in_pieces(file: &File, n_bytes: u64) -> Option<Vec<u8>> {
    use std::os::unix::fs::FileExt;

    // Room that is known to be zero is not touched before it is read into.
    let mut bytes = vec![0; usize::try_from(n_bytes).ok()?];
    let pieces = bytes.par_chunks_mut(PIECE_BYTES).enumerate();
    pieces.try_for_each(|(i, piece)| file.read_exact_at(piece, (i * PIECE_BYTES) as u64)).ok()?;
    let is_whole = matches!(file.read_at(&mut [0], n_bytes), Ok(0));
    is_whole.then_some(bytes)
}

#[cfg(not(unix))]
fn read_in_pieces(_: &File, _: u64) -> Option<Vec<u8>> {
    None
}
