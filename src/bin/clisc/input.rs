//! Finding and reading scenes.

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use anyhow::{Context, bail};
use clisc::source::{Source, SourceError};
use rayon::prelude::*;

use crate::args::StdinArgs;
use crate::magic;
use crate::walk::{self, Found};

/// What messages call standard input.
const STDIN_NAME: &str = "<stdin>";

/// From so many bytes on no source is made: there is no need to read on.
const TOO_LARGE: u64 = u32::MAX as u64;

/// The file that standard input stands for; set once, before anything is read.
static STDIN_FILE: OnceLock<PathBuf> = OnceLock::new();

/// Takes `--stdin-filename` into account from now on.
///
/// # Errors
/// When standard input is none of the scenes: what was named is another file than the one that is read.
pub fn name_stdin(stdin: &StdinArgs, paths: &[PathBuf]) -> anyhow::Result<()> {
    let Some(file) = stdin.filename() else { return Ok(()) };
    if !paths.iter().any(|path| is_stdin(path)) {
        bail!("--stdin-filename names standard input, which is not among the scenes: write `-` for it");
    }
    let _ = STDIN_FILE.set(file.to_owned());
    Ok(())
}

/// Returns the file that an argument means; `None` for standard input without a name.
pub fn file_of(path: &Path) -> Option<&Path> {
    if is_stdin(path) { STDIN_FILE.get().map(PathBuf::as_path) } else { Some(path) }
}

/// Returns what messages call a scene.
pub fn name_of(path: &Path) -> String {
    file_of(path).map_or_else(|| STDIN_NAME.to_owned(), |file| file.display().to_string())
}

/// Reads a scene file; `-` is standard input.
///
/// # Errors
/// When it cannot be read, is too large for a scene or is known to be something else; the message names it.
pub fn read(path: &Path) -> anyhow::Result<Source> {
    let name = name_of(path);
    let bytes = if is_stdin(path) { read_stdin() } else { read_file(path).map_err(|error| with_hint(path, error)) };
    let source = bytes.and_then(|bytes| match magic::kind_of(&bytes) {
        Some(kind) => bail!("it is {kind}, not a scene"),
        None => Ok(Source::from_bytes(name.clone(), bytes)?),
    });
    source.with_context(|| format!("cannot read `{name}`"))
}

fn read_stdin() -> anyhow::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    io::stdin().lock().take(TOO_LARGE).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Adds to the error of a file that is not there which one was probably meant.
fn with_hint(path: &Path, error: anyhow::Error) -> anyhow::Error {
    let is_missing = error.downcast_ref::<io::Error>().is_some_and(|error| error.kind() == io::ErrorKind::NotFound);
    let mut meant = path.as_os_str().to_owned();
    meant.push(".cli");
    match Path::new(&meant) {
        meant if is_missing && meant.is_file() => anyhow::anyhow!("{error}; did you mean `{}`?", meant.display()),
        _ => error,
    }
}

/// Tells whether an argument means standard input. A file that is called so is `./-`.
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
        let is_folder = !is_stdin(path) && path.is_dir();
        let found = if is_folder { walk::scenes_below(path) } else { Found::only(path) };
        let identity = |path: &PathBuf| match fs::canonicalize(path) {
            Ok(real) if !is_stdin(path) => real,
            _ => path.clone(),
        };
        let is_new = |path: &PathBuf| seen.insert(identity(path));
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
