//! What several suites share.
#![allow(dead_code, reason = "each suite uses a part")]

pub mod carets;
pub mod ebnf;
pub mod lines;
pub mod views;

use std::fs;
use std::path::{Path, PathBuf};

use clisc::image::{RgbImage, decode_png};
use tempfile::TempDir;

/// Returns a small sound scene that writes `name`.
pub fn scene(name: &str) -> String {
    format!(
        "fov 60\nbackground .1 .2 .3\nlight 1 1 1 0 0 5\nsurface 0 .2 0 .4 .1 .1 0 0 0 1 0\nsphere 0 0 -4 1\nwrite {name}\n"
    )
}

/// What a call of the command gave.
#[derive(Debug)]
pub struct Call {
    /// The exit code; `None` when a signal ended it.
    pub code: Option<i32>,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl From<std::process::Output> for Call {
    fn from(output: std::process::Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).expect("text on standard output"),
            stderr: String::from_utf8(output.stderr).expect("text on standard error"),
        }
    }
}

/// A folder of its own for one test, in which the command runs.
#[derive(Debug)]
pub struct Folder(TempDir);

impl Folder {
    /// Makes an empty folder.
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    /// Makes a folder with one scene, `a.cli`.
    pub fn with_scene(text: &str) -> Self {
        let folder = Self::new();
        folder.put("a.cli", text);
        folder
    }

    /// Returns a path in the folder.
    pub fn at(&self, name: impl AsRef<Path>) -> PathBuf {
        self.0.path().join(name)
    }

    /// Saves a file, in folders that are made.
    pub fn put(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.at(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, content).expect("a written file");
    }

    /// Returns the bytes of a file.
    pub fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.at(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Returns an image.
    pub fn image(&self, name: &str) -> RgbImage {
        decode_png(&self.bytes(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Returns the names of all files, links and folders (with a `/` behind), sorted.
    pub fn listing(&self) -> Vec<String> {
        let mut names = Vec::new();
        list(self.0.path(), "", &mut names);
        names.sort();
        names
    }

    /// Prepares a call with these arguments.
    pub fn command(&self, args: &[&str]) -> assert_cmd::Command {
        let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_clisc"));
        command.current_dir(self.0.path()).args(args);
        command
    }

    /// Calls the command.
    pub fn clisc(&self, args: &[&str]) -> Call {
        self.command(args).output().expect("a command that starts").into()
    }
}

fn list(folder: &Path, prefix: &str, names: &mut Vec<String>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let entry = entry.expect("an entry");
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        if entry.file_type().expect("a type").is_dir() {
            list(&entry.path(), &format!("{name}/"), names);
            names.push(name + "/");
        } else {
            names.push(name);
        }
    }
}
