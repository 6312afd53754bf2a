//! Scenes below a folder.
//!
//! Left out are names that begin with a dot, what git ignores, and what `exclude` in `clisc.toml` names: the file that
//! counts in a folder is the one that counts for the rules of its scenes. Links to scenes are followed and links to
//! folders are not, so that every walk ends. What an argument names is never left out.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::{fs, io};

use anyhow::Context;
use clisc::diag::render::Notification;
use clisc::diag::words::counted;
use clisc::lint::parse_exclude;
use ignore::gitignore::{Gitignore, GitignoreBuilder};
use ignore::{DirEntry, WalkBuilder};

use crate::{config, problems};

/// What arguments mean.
#[derive(Debug, Default)]
pub struct Found {
    /// The scenes, in order.
    pub scenes: Vec<PathBuf>,
    /// What could not be found or read, and links that lead nowhere.
    pub problems: Vec<Notification>,
}

impl Found {
    /// Makes what a path means that is no folder.
    pub fn only(path: &Path) -> Self {
        Self { scenes: vec![path.to_owned()], problems: Vec::new() }
    }
}

/// Returns the scenes below a folder, sorted by name folder by folder, as far as it can be read.
pub fn scenes_below(folder: &Path) -> Found {
    let excludes = Arc::new(Excludes::default());
    let mut builder = builder(folder);
    // Outside of a repository a .gitignore file is meant as well.
    builder.hidden(true).require_git(false);
    let filter = Arc::clone(&excludes);
    builder.filter_entry(move |entry| entry.depth() == 0 || !filter.has(entry));
    let mut found = walk(&builder);
    found.problems.extend(excludes.take_problems());
    if found.scenes.is_empty() && found.problems.is_empty() {
        found.problems.push(Notification::error(Some(folder), nothing_below(folder)));
    }
    found
}

/// Says why there is no scene below a folder.
fn nothing_below(folder: &Path) -> String {
    let folder_name = folder.display();
    let n_ignored = walk(builder(folder).standard_filters(false)).scenes.len();
    match n_ignored {
        0 => format!("there is no .cli file below `{folder_name}`"),
        n => format!(
            "there is no .cli file below `{folder_name}` but {} left out, by its name, by .gitignore or by `exclude` in \
             clisc.toml; name a file to have it read",
            counted(n, "file")
        ),
    }
}

fn builder(folder: &Path) -> WalkBuilder {
    let mut builder = WalkBuilder::new(folder);
    builder.ignore(false).sort_by_file_name(OsStr::cmp);
    builder
}

fn walk(builder: &WalkBuilder) -> Found {
    let mut found = Found::default();
    for entry in builder.build() {
        match entry {
            Ok(entry) if entry.depth() > 0 && is_scene_name(entry.path()) => take(&entry, &mut found),
            Ok(_) => {}
            Err(error) => found.problems.push(unreadable(&error)),
        }
    }
    found
}

/// Tells whether a file is called as scenes are.
fn is_scene_name(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("cli"))
}

/// Adds what is called as scenes are, if it is a file.
fn take(entry: &DirEntry, found: &mut Found) {
    let path = shown(entry.path());
    let is_link = entry.path_is_symlink();
    let warn = |what: &str| Notification::warning(Some(&path), format!("`{}` {what}", path.display()));
    match fs::metadata(entry.path()) {
        Ok(metadata) if metadata.is_file() => found.scenes.push(path),
        Ok(metadata) if metadata.is_dir() => {}
        Ok(_) => found.problems.push(warn("is no regular file and is left out")),
        Err(_) if is_link => found.problems.push(warn("is a link that leads nowhere and is left out")),
        // Reading it says why.
        Err(_) => found.scenes.push(path),
    }
}

/// Returns a path as messages show it: without the `.` of the folder where the program runs.
fn shown(path: &Path) -> PathBuf {
    path.strip_prefix(".").unwrap_or(path).to_owned()
}

/// Says that a folder cannot be read.
fn unreadable(error: &ignore::Error) -> Notification {
    let path = path_of(error).map(shown);
    // The system's error is wrapped in one that names the path again.
    let cause = error.io_error().and_then(io::Error::get_ref).and_then(|wrapped| wrapped.source());
    let why = cause.map_or_else(|| error.to_string(), ToString::to_string);
    let message = match &path {
        Some(path) => format!("cannot read the folder `{}`: {why}", path.display()),
        None => format!("cannot read a folder: {why}"),
    };
    Notification::error(path.as_deref(), message)
}

/// Returns the path that an error is about.
fn path_of(error: &ignore::Error) -> Option<&Path> {
    match error {
        ignore::Error::WithPath { path, .. } => Some(path),
        ignore::Error::WithDepth { err, .. } | ignore::Error::WithLineNumber { err, .. } => path_of(err),
        ignore::Error::Loop { child, .. } => Some(child),
        _ => None,
    }
}

/// What configurations leave out, by folder.
#[derive(Debug, Default)]
struct Excludes {
    by_folder: Mutex<HashMap<PathBuf, Option<Arc<Exclude>>>>,
    problems: Mutex<Vec<Notification>>,
}

/// What the configuration of a folder leaves out.
#[derive(Debug)]
struct Exclude {
    /// The folder, all links followed.
    folder: PathBuf,
    patterns: Gitignore,
}

impl Excludes {
    /// Tells whether a file or folder is left out.
    fn has(&self, entry: &DirEntry) -> bool {
        let Some((folder, name)) = entry.path().parent().zip(entry.path().file_name()) else { return false };
        let is_folder = entry.file_type().is_some_and(|found| found.is_dir());
        self.of(folder)
            .is_some_and(|exclude| exclude.patterns.matched(exclude.folder.join(name), is_folder).is_ignore())
    }

    /// Returns what is left out in a folder. A configuration that cannot be read leaves out nothing and is told.
    fn of(&self, folder: &Path) -> Option<Arc<Exclude>> {
        let mut by_folder = self.by_folder.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = by_folder.get(folder) {
            return known.clone();
        }
        let read = read_exclude(folder).unwrap_or_else(|error| {
            let mut problems = self.problems.lock().unwrap_or_else(PoisonError::into_inner);
            problems.push(problems::error(None, &error));
            None
        });
        let read = read.map(Arc::new);
        by_folder.insert(folder.to_owned(), read.clone());
        read
    }

    fn take_problems(&self) -> Vec<Notification> {
        std::mem::take(&mut self.problems.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Reads what is left out in a folder.
fn read_exclude(folder: &Path) -> anyhow::Result<Option<Exclude>> {
    let Some(file) = config::find(folder)? else { return Ok(None) };
    let named = || format!("`{}`", file.path().display());
    let mut patterns = GitignoreBuilder::new(&file.folder);
    for pattern in parse_exclude(&file.text).with_context(named)? {
        patterns.add_line(None, &pattern).with_context(|| format!("{}: `exclude`", named()))?;
    }
    let patterns = patterns.build().with_context(named)?;
    let folder = fs::canonicalize(folder)?;
    Ok((!patterns.is_empty()).then_some(Exclude { folder, patterns }))
}
