//! The laws that the fuzz targets check, on every scene, fixture and seed: what `cargo fuzz` starts from, without it.

#[path = "support/tree.rs"]
mod tree;

use std::fs;
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;

use clisc::testing::{
    assert_compiles_soundly, assert_draws_soundly, assert_formats_soundly, assert_parses_soundly,
    assert_renders_soundly, assert_tokens_tile, assert_ways_agree,
};

/// The folders that `fuzz/run` reads.
const FOLDERS: [&str; 3] = ["fuzz/seeds", "scenes", "tests/fixtures"];

/// Checks a law on every input, and names those that break it.
fn check_on_all(law: impl Fn(&[u8])) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut faults = Vec::new();
    for folder in FOLDERS {
        let files = tree::files_below(&root.join(folder));
        assert!(files.len() > 5, "{folder} is as good as empty");
        for path in files {
            let bytes = fs::read(&path).expect("a readable file");
            if panic::catch_unwind(AssertUnwindSafe(|| law(&bytes))).is_err() {
                faults.push(path);
            }
        }
    }
    assert!(faults.is_empty(), "a law is broken by {faults:#?}");
}

#[test]
fn parse_target_accepts_the_corpus() {
    check_on_all(|bytes| {
        assert_tokens_tile(bytes);
        assert_parses_soundly(bytes);
    });
}

#[test]
fn check_target_accepts_the_corpus() {
    check_on_all(assert_compiles_soundly);
}

#[test]
fn ways_target_accepts_the_corpus() {
    check_on_all(assert_ways_agree);
}

#[test]
fn draw_target_accepts_the_corpus() {
    check_on_all(assert_draws_soundly);
}

#[test]
fn format_target_accepts_the_corpus() {
    check_on_all(assert_formats_soundly);
}

#[test]
fn render_target_accepts_the_corpus() {
    check_on_all(assert_renders_soundly);
}

#[test]
fn fuzz_targets_share_what_the_root_compiles() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let [ours, theirs] =
        ["Cargo.toml", "fuzz/Cargo.toml"].map(|path| fs::read_to_string(root.join(path)).expect("a manifest"));
    let (_, packages) = theirs.split_once("[profile.dev.package]\n").expect("the table");
    let (packages, _) = packages.split_once("\n[").expect("a table behind it");
    for line in packages.lines() {
        assert!(ours.contains(&format!("{line}\n")), "{line:?} would compile a dependency twice");
    }
}

#[test]
fn every_target_is_replayed_here() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let this = fs::read_to_string(root.join(file!())).expect("this file");
    for path in tree::files_below(&root.join("fuzz/fuzz_targets")) {
        let target = path.file_stem().expect("a name").to_string_lossy();
        assert!(this.contains(&format!("fn {target}_target_accepts_the_corpus()")), "{target} is not replayed");
    }
}

#[test]
fn fuzz_script_reads_the_same_folders() {
    let script = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/run")).expect("the script");
    assert!(script.contains(&FOLDERS.join(" ")), "fuzz/run and this test read different folders");
}
