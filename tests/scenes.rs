//! The scenes that come with the project are fit to be copied from.

use std::fs;
use std::path::{Path, PathBuf};

use clisc::compile;
use clisc::ir::Command;
use clisc::source::Source;

/// The longest line, as in the code.
const MAX_COLUMNS: usize = 120;

/// Returns the scenes of every folder but `invalid`, sorted.
fn scenes() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let entries = |folder: &Path| -> Vec<_> {
        fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect()
    };
    let folders = entries(&root).into_iter().filter(|path| path.is_dir() && !path.ends_with("invalid"));
    let is_config = |path: &PathBuf| path.ends_with("clisc.toml");
    let mut scenes: Vec<_> = folders.flat_map(|folder| entries(&folder)).filter(|path| !is_config(path)).collect();
    scenes.sort();
    assert!(scenes.len() > 25 && scenes.iter().all(|path| path.extension().is_some_and(|ending| ending == "cli")));
    scenes
}

/// Calls `check` with path and text of each scene; it returns what is wrong.
fn check_all(check: impl Fn(&Path, &str) -> Option<String>) {
    let faults: Vec<_> = scenes()
        .iter()
        .filter_map(|path| {
            let text = fs::read_to_string(path).expect("a scene in UTF-8");
            check(path, &text).map(|fault| format!("{}: {fault}", path.display()))
        })
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn a_scene_begins_with_what_to_look_at() {
    check_all(|_, text| {
        let head: Vec<_> = text.lines().take_while(|line| line.starts_with('#')).collect();
        let says = head.join(" ").contains("Look ");
        (!says).then(|| "the comment at its head does not say what to look at".to_owned())
    });
}

#[test]
fn a_scene_raises_nothing() {
    check_all(|path, text| {
        let found = compile(&Source::new(path.display().to_string(), text)).diagnostics;
        (!found.is_empty()).then(|| format!("{found:#?}"))
    });
}

#[test]
fn a_scene_ends_by_writing_its_own_name() {
    check_all(|path, text| {
        let program = compile(&Source::new("test.cli", text)).program;
        let own = path.with_extension("png");
        let own = own.file_name().and_then(|name| name.to_str()).expect("a name");
        let ends_so = matches!(program.commands.last(), Some(Command::Write(name)) if **name == *own);
        (!ends_so).then(|| format!("does not end with `write {own}`"))
    });
}

#[test]
fn a_scene_is_tidy() {
    check_all(|_, text| {
        if text.contains(['\r', '\t']) || text.contains("\n\n\n") || !text.ends_with('\n') || text.ends_with("\n\n") {
            return Some("a tab, a carriage return, or too many or too few line ends".to_owned());
        }
        let untidy = |line: &&str| line.ends_with(' ') || line.chars().count() > MAX_COLUMNS;
        text.lines().find(untidy).map(|line| format!("ends with a blank or is too long: {line}"))
    });
}
