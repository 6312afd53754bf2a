//! The `clisc.toml` of open documents: what they said when they were last read, and what is wrong with them.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::io;
use std::path::{Path, PathBuf};

use clisc::ide::position::{Lines, Position, Unit};
use clisc::lint::{ConfigError, Options, parse_config};
use lsp_types::{Diagnostic, DiagnosticSeverity, Range};

use crate::config;

/// What a broken configuration is told with.
const HELP: &str = "until this is mended, what the file said before holds, or the default";

/// The configurations of all open documents.
#[derive(Debug, Default)]
pub struct Configs {
    /// What holds in each folder.
    by_folder: HashMap<PathBuf, Options>,
    /// What each file said when it was last sound.
    sound: HashMap<PathBuf, Options>,
    /// What is wrong with files.
    faults: BTreeMap<PathBuf, Diagnostic>,
}

impl Configs {
    /// Reads the configurations of these folders, and forgets all others. Returns the files with which something else is
    /// wrong than before, each with what that is, if it is anything.
    pub fn read(&mut self, folders: BTreeSet<PathBuf>, unit: Unit) -> Vec<(PathBuf, Option<Diagnostic>)> {
        let old = std::mem::take(self);
        for folder in folders {
            let options = config::look_up(&folder).map(|(holder, text)| {
                let path = as_opened(&holder, &folder);
                self.take(path, text, &old, unit)
            });
            self.by_folder.insert(folder, options.unwrap_or_default());
        }
        let paths: BTreeSet<_> = old.faults.keys().chain(self.faults.keys()).collect();
        let changed = paths.into_iter().filter(|path| old.faults.get(*path) != self.faults.get(*path));
        changed.map(|path| (path.clone(), self.faults.get(path).cloned())).collect()
    }

    /// Takes what a file says; when it is not sound, what it said before holds.
    fn take(&mut self, path: PathBuf, text: io::Result<String>, old: &Self, unit: Unit) -> Options {
        let options = match sound(text, unit) {
            Ok(options) => options,
            Err(fault) => {
                self.faults.insert(path.clone(), *fault);
                old.sound.get(&path).cloned().unwrap_or_default()
            }
        };
        self.sound.insert(path, options.clone());
        options
    }

    /// Returns what holds for a scene of this folder.
    pub fn options(&self, folder: &Path, file_stem: Option<String>) -> Options {
        self.by_folder.get(folder).cloned().unwrap_or_default().for_file(file_stem)
    }
}

/// Returns the path of the configuration in `holder` by the folder of a scene as the editor named it, where links may be on
/// the way.
fn as_opened(holder: &Path, folder: &Path) -> PathBuf {
    let is_it = |folder: &&Path| folder.canonicalize().is_ok_and(|folder| folder == holder);
    folder.ancestors().find(is_it).unwrap_or(holder).join(config::FILE_NAME)
}

/// Returns what a file says, or what is wrong with it.
fn sound(text: io::Result<String>, unit: Unit) -> Result<Options, Box<Diagnostic>> {
    let fault = |range, message: String| {
        Box::new(Diagnostic {
            range,
            severity: Some(DiagnosticSeverity::ERROR),
            source: Some("clisc".to_owned()),
            message: format!("{message}\nhelp: {HELP}"),
            ..Diagnostic::default()
        })
    };
    let text = text.map_err(|error| fault(Range::default(), format!("cannot be read: {error}")))?;
    parse_config(&text).map_err(|error| fault(range_of(&error, &text, unit), error.message))
}

/// Returns the place of an error: from where it is to the end of its line.
fn range_of(error: &ConfigError, text: &str, unit: Unit) -> Range {
    let Some(place) = error.position else { return Range::default() };
    let lines = Lines::new(text);
    let line = place.line.saturating_sub(1);
    // The library counts characters, from 1.
    let start = Position { line, column: place.column.saturating_sub(1) };
    let start = lines.offset(text, start, Unit::Utf32);
    let end = lines.span(text, line).end.max(start);
    let position = |offset| {
        let Position { line, column } = lines.position(text, offset, unit);
        lsp_types::Position::new(line, column)
    };
    Range::new(position(start), position(end))
}
