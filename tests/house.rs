//! House rules: which module may use which, and what stays in which room.

#[path = "support/tree.rs"]
mod tree;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// For each module of the library the modules it may use besides itself.
const MAY_USE: &[(&str, &[&str])] = &[
    ("source", &[]),
    ("diag", &["source"]),
    ("math", &[]),
    ("image", &["math"]),
    ("syntax", &["source", "diag"]),
    ("ir", &["math", "source"]),
    ("lower", &["syntax", "ir", "diag", "source", "math"]),
    ("compile", &["source", "diag", "syntax", "lower", "ir"]),
    ("plan", &["ir", "math", "source"]),
    ("trace", &["ir", "plan", "math", "image"]),
    ("exact", &["ir", "image"]),
    ("exec", &["source", "ir", "plan", "trace", "exact", "image", "diag"]),
    ("format", &["source", "diag", "syntax", "lower", "exec"]),
    ("lint", &["source", "diag", "syntax", "compile", "ir", "plan", "trace", "exec"]),
    ("ide", &["source", "diag", "syntax", "lint"]),
    (
        "testing",
        &[
            "source", "diag", "math", "image", "syntax", "ir", "lower", "compile", "plan", "trace", "exact", "exec",
            "format",
        ],
    ),
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Every Rust file below `folder`, sorted.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = tree::files_below(folder);
    files.retain(|path| path.extension().is_some_and(|extension| extension == "rs"));
    files
}

/// The code of a file: without comments, and without its unit tests, which stand last.
fn code_of(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("a readable file");
    let before_tests = text.find("#[cfg(test)]").map_or(text.as_str(), |start| &text[..start]);
    before_tests.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

/// Every library file with the module it belongs to; test modules and the crate root are no part of it.
fn library_files() -> Vec<(String, PathBuf)> {
    let src = root().join("src");
    let mut files = Vec::new();
    for path in rust_files(&src) {
        let inside = path.strip_prefix(&src).expect("below src");
        let room = inside.components().next().expect("a name").as_os_str().to_string_lossy().replace(".rs", "");
        let is_tests = path.file_stem().is_some_and(|stem| stem == "tests");
        if room != "bin" && room != "lib" && !is_tests {
            files.push((room, path));
        }
    }
    files
}

/// The names that follow `prefix` in `code`; a brace list counts each of its names.
fn names_after(code: &str, prefix: &str) -> BTreeSet<String> {
    let word = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut names = BTreeSet::new();
    for (at, _) in code.match_indices(prefix) {
        let rest = &code[at + prefix.len()..];
        match rest.strip_prefix('{') {
            Some(list) => {
                let list = &list[..list.find("};").unwrap_or(list.len())];
                names.extend(list.split(',').map(|name| word(name.trim())));
            }
            None => {
                names.insert(word(rest));
            }
        }
    }
    names
}

#[test]
fn modules_use_only_what_the_table_allows() {
    let mut faults = Vec::new();
    for (room, path) in library_files() {
        let Some((_, allowed)) = MAY_USE.iter().find(|(name, _)| *name == room) else {
            faults.push(format!("{}: module `{room}` is not in the table", path.display()));
            continue;
        };
        for used in names_after(&code_of(&path), "crate::") {
            let is_module = MAY_USE.iter().any(|(name, _)| *name == used);
            if is_module && used != room && !allowed.contains(&used.as_str()) {
                faults.push(format!("{}: `{room}` may not use `{used}`", path.display()));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_table_lists_what_exists() {
    let rooms: BTreeSet<String> = library_files().into_iter().map(|(room, _)| room).collect();
    let listed: BTreeSet<String> = MAY_USE.iter().map(|(name, _)| (*name).to_owned()).collect();
    assert_eq!(rooms, listed);
}

#[test]
fn the_library_leaves_files_clock_and_process_to_the_binary() {
    let mut faults = Vec::new();
    for (_, path) in library_files() {
        let code = code_of(&path);
        for forbidden in ["std::fs", "std::env", "std::process", "std::time::Instant", "std::time::SystemTime"] {
            if code.contains(forbidden) {
                faults.push(format!("{}: {forbidden}", path.display()));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn each_foreign_tool_has_one_room() {
    let rooms = [
        ("ariadne::", "src/diag/render"),
        ("logos::", "src/syntax"),
        ("chumsky::", "src/syntax/parser"),
        ("png::", "src/image"),
        ("toml::", "src/lint"),
        ("crc32fast::", "src/image"),
        ("image::ImageFormat", "src/image"),
        ("image::ImageReader", "src/image"),
        ("unsafe {", "src/trace/kernels"),
        ("unsafe fn", "src/trace/kernels"),
    ];
    let mut faults = Vec::new();
    for path in rust_files(&root().join("src")) {
        let inside = path.strip_prefix(root()).expect("below the root").to_string_lossy().into_owned();
        let code = code_of(&path);
        for (tool, room) in rooms {
            if code.contains(tool) && !inside.starts_with(room) {
                faults.push(format!("{inside}: `{tool}` belongs to {room}"));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_architecture_page_has_every_module() {
    let page = fs::read_to_string(root().join("docs/ARCHITECTURE.md")).expect("docs/ARCHITECTURE.md");
    for (name, _) in MAY_USE {
        assert!(page.contains(&format!("`src/{name}")), "docs/ARCHITECTURE.md says nothing of src/{name}");
    }
}

#[test]
fn every_dependency_says_what_it_is_for() {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).expect("Cargo.toml");
    let mut in_dependencies = false;
    for line in manifest.lines() {
        if line.starts_with('[') {
            in_dependencies = line.contains("dependencies");
        } else if in_dependencies && line.contains('=') && !line.starts_with('#') {
            assert!(line.contains(" # "), "no reason beside: {line}");
        }
    }
}

#[test]
fn every_folder_of_the_library_opens_with_its_purpose() {
    for path in rust_files(&root().join("src")) {
        let text = fs::read_to_string(&path).expect("a readable file");
        assert!(text.starts_with("//!"), "{} has no module doc", path.display());
    }
}
