//! `clisc.toml`: the one in the folder of a scene, or in the nearest above it.

use std::collections::HashMap;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use anyhow::Context;
use clisc::lint::{Options, parse_config};

use crate::input;

/// The name of the file.
pub const FILE_NAME: &str = "clisc.toml";

/// The configurations that have been read so far, by the folder of the scenes that they are for.
#[derive(Debug, Default)]
pub struct Configs(Mutex<HashMap<PathBuf, Options>>);

impl Configs {
    /// Returns the options for a scene.
    ///
    /// # Errors
    /// When its configuration cannot be read or is none.
    pub fn options_for(&self, scene: &Path) -> anyhow::Result<Options> {
        let file = input::file_of(scene);
        let folder = match file.and_then(Path::parent) {
            None => PathBuf::from("."),
            Some(folder) if folder == Path::new("") => PathBuf::from("."),
            Some(folder) => folder.to_owned(),
        };
        let file_stem = file.and_then(Path::file_stem).map(|stem| stem.to_string_lossy().into_owned());
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(options) = known.get(&folder) {
            return Ok(options.clone().for_file(file_stem));
        }
        let options = read_for(&folder)?;
        known.insert(folder, options.clone());
        Ok(options.for_file(file_stem))
    }
}

/// Reads the configuration for the scenes of a folder; the default if there is none.
fn read_for(folder: &Path) -> anyhow::Result<Options> {
    let Some(file) = find(folder)? else { return Ok(Options::default()) };
    parse_config(&file.text).with_context(|| format!("`{}`", file.path().display()))
}

/// The configuration that counts in a folder, as it was read.
#[derive(Debug)]
pub struct ConfigFile {
    /// The folder where it stands, all links followed.
    pub folder: PathBuf,
    /// What it says.
    pub text: String,
}

impl ConfigFile {
    /// Returns the path of the file.
    pub fn path(&self) -> PathBuf {
        self.folder.join(FILE_NAME)
    }
}

/// Reads the configuration that counts in a folder, if there is one: the one in it, or in the nearest folder above.
///
/// # Errors
/// When there is one that cannot be read.
pub fn find(folder: &Path) -> anyhow::Result<Option<ConfigFile>> {
    let Some((folder, text)) = look_up(folder) else { return Ok(None) };
    let text = text.with_context(|| format!("cannot read `{}`", folder.join(FILE_NAME).display()))?;
    Ok(Some(ConfigFile { folder, text }))
}

/// Does the work of [`find`]: returns the folder of the configuration, all links followed, and its text, if that can be read.
pub fn look_up(folder: &Path) -> Option<(PathBuf, io::Result<String>)> {
    let folder = fs::canonicalize(folder).ok()?;
    folder.ancestors().find_map(|folder| match fs::read_to_string(folder.join(FILE_NAME)) {
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => None,
        text => Some((folder.to_owned(), text)),
    })
}
