//! Tells the program from which commit it is built, for `clisc --version`.
//!
//! The commit is asked of git, or read from what `cargo package` leaves in a published package. Without either the version
//! is told alone. Whether the tree was changed since the commit is not told: that would build everything anew each time.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// How many digits of a commit are told; enough to be unique in any repository of this kind.
const DIGITS: usize = 12;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if let Some(commit) = of_git().or_else(of_package) {
        println!("cargo::rustc-env=CLISC_COMMIT={}", &commit[..DIGITS.min(commit.len())]);
    }
}

/// Returns the commit of the repository whose top level is this package; of no other, in which the sources may merely lie.
fn of_git() -> Option<String> {
    let top = git(&["rev-parse", "--show-toplevel"])?;
    if fs::canonicalize(top).ok()? != fs::canonicalize(env!("CARGO_MANIFEST_DIR")).ok()? {
        return None;
    }
    // The log of HEAD grows with each commit and checkout. Cargo would take a missing file for one that always changes.
    let log = PathBuf::from(git(&["rev-parse", "--git-path", "logs/HEAD"])?);
    if log.exists() {
        println!("cargo::rerun-if-changed={}", log.display());
    }
    git(&["rev-parse", "HEAD"])
}

/// Returns what git answers; `None` where it has no answer, or is missing.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}

/// Returns the commit that a published package was made of.
fn of_package() -> Option<String> {
    let info = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(".cargo_vcs_info.json")).ok()?;
    let (_, behind) = info.split_once("\"sha1\"")?;
    behind.split('"').nth(1).map(str::to_owned)
}
