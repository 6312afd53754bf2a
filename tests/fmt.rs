//! `clisc fmt` as one calls it: exit codes, streams, files.

mod support;

use crate::support::Folder;

const LOOSE: &str = "  fov 60 # wide\nbackground .1 0 0\n\n\nwrite a.png";
const TIDY: &str = "fov        60  # wide\nbackground 0.1 0 0\n\nwrite a.png\n";

#[test]
fn scenes_are_formatted_in_place() {
    let folder = Folder::with_scene(LOOSE);
    folder.put("b/tidy.cli", TIDY);
    folder.put("b/notes.txt", LOOSE);
    let call = folder.clisc(&["fmt", "."]);
    assert_eq!((call.code, call.stdout.as_str()), (Some(0), ""));
    assert_eq!(call.stderr, "1 scene formatted, 1 unchanged\n");
    assert_eq!((folder.bytes("a.cli"), folder.bytes("b/notes.txt")), (TIDY.into(), LOOSE.into()));
    assert_eq!(folder.listing(), ["a.cli", "b/", "b/notes.txt", "b/tidy.cli"]);
    assert_eq!(folder.clisc(&["fmt", "a.cli", "./a.cli"]).stderr, "no scene formatted, 1 unchanged\n");
}

#[test]
fn check_lists_and_saves_nothing() {
    let folder = Folder::with_scene(LOOSE);
    folder.put("b.cli", TIDY);
    folder.put("c.cli", LOOSE);
    let call = folder.clisc(&["fmt", "--check", "c.cli", "a.cli", "b.cli"]);
    assert_eq!((call.code, call.stdout.as_str()), (Some(1), "c.cli\na.cli\n"));
    assert_eq!(call.stderr, "2 scenes to be formatted, 1 unchanged\n");
    assert_eq!(folder.bytes("a.cli"), LOOSE.as_bytes());
    assert_eq!(folder.clisc(&["fmt", "--check", "b.cli"]).code, Some(0));
}

#[test]
fn check_tells_programs_what_would_change() {
    let folder = Folder::with_scene("fov  60\n# a\n fov 50\nlight 1 1 1 0 0 5\n");
    folder.put("b.cli", TIDY);
    let call = folder.clisc(&["fmt", "--check", "--format", "json", "a.cli", "b.cli"]);
    assert_eq!(call.code, Some(1));
    let document: serde_json::Value = serde_json::from_str(&call.stdout).expect("one document");
    let found = document["diagnostics"].as_array().expect("a list");
    assert_eq!((found.len(), &found[0]["code"]), (2, &"F0101".into()));
    assert_eq!(found[1]["message"], "2 lines are not in canonical form");
    assert_eq!(found[0]["fixes"][0]["edits"][0]["replacement"], "fov   60\n");
    let short = folder.clisc(&["fmt", "--check", "--format", "short", "a.cli", "b.cli"]);
    assert!(
        short.stdout.starts_with("a.cli:1:1: warning[F0101]: a line is not in canonical form\n"),
        "{}",
        short.stdout
    );
    assert_eq!(
        folder.clisc(&["fmt", "--format", "json", "a.cli"]).code,
        Some(2),
        "without --check there is nothing to tell"
    );
}

#[test]
fn diff_is_a_patch() {
    let folder = Folder::with_scene(LOOSE);
    let call = folder.clisc(&["fmt", "--diff", "a.cli"]);
    assert_eq!(call.code, Some(1));
    assert_eq!(
        call.stdout,
        "--- a/a.cli\n+++ b/a.cli\n@@ -1,5 +1,4 @@\n-  fov 60 # wide\n-background .1 0 0\n-\n-\n-write a.png\n\\ No newline at end \
         of file\n+fov        60  # wide\n+background 0.1 0 0\n+\n+write a.png\n"
    );
    assert_eq!(folder.clisc(&["fmt", "--diff", "--check", "a.cli"]).code, Some(1));
    assert_eq!(folder.bytes("a.cli"), LOOSE.as_bytes());
    folder.put("a.cli", TIDY);
    assert_eq!(folder.clisc(&["fmt", "--diff", "a.cli"]).code, Some(0), "there is no difference");
}

/// Whatever a file is called, `patch` and git find it.
#[test]
fn a_diff_can_be_applied() {
    use std::io::Write;
    use std::process::{Command, Stdio};

    const NAMES: [&str; 6] =
        ["a.cli", "deep/a b.cli", "tab\there.cli", "quo\"te.cli", "back\\slash.cli", "\u{e9}\u{4e16}.cli"];
    for (program, args) in [("patch", &["-p1", "--quiet"][..]), ("git", &["apply"])] {
        let folder = Folder::new();
        NAMES.iter().for_each(|name| folder.put(name, LOOSE));
        for command in [&["fmt", "--diff"][..], &["lint", "--diff", "--select", "repeated-setting"]] {
            let mut call = folder.clisc(&[command, &["."]].concat());
            if command[0] == "lint" {
                NAMES.iter().for_each(|name| folder.put(name, TIDY.replace("write", "fov 60\nwrite")));
                call = folder.clisc(&[command, &["."]].concat());
            }
            assert_eq!(call.code, Some(1), "{}", call.stderr);
            folder.put("patch", &call.stdout);
            let mut apply = Command::new(program);
            apply
                .args(args)
                .current_dir(folder.at("."))
                .stdin(std::fs::File::open(folder.at("patch")).expect("a file"));
            let Ok(output) = apply.stdout(Stdio::piped()).stderr(Stdio::piped()).output() else {
                let _ = writeln!(std::io::stderr(), "\nSKIPPED: there is no {program} here");
                break;
            };
            assert!(output.status.success(), "{program}: {output:?}\n{}", call.stdout);
            let is_tidy = |name: &&str| folder.bytes(name) == TIDY.as_bytes();
            assert!(NAMES.iter().all(is_tidy), "{program}: {}", call.stdout);
        }
    }
}

/// Blank lines that go away at both ends and in the middle, changes far apart and side by side.
#[test]
fn a_diff_has_hunks_with_three_lines_around() {
    let comments = |n: usize| (0..n).map(|i| format!("# {i}\n")).collect::<String>();
    let folder =
        Folder::with_scene(&format!("\n{}fov  60\n{} fov 50\n\n\n{}\n", comments(8), comments(7), comments(2)));
    let call = folder.clisc(&["fmt", "--diff", "a.cli"]);
    let heads: Vec<_> = call.stdout.lines().filter(|line| line.starts_with("@@")).collect();
    assert_eq!(heads, ["@@ -1,4 +1,3 @@", "@@ -7,7 +6,7 @@", "@@ -15,9 +14,7 @@"], "{}", call.stdout);
    assert!(call.stdout.contains("\n- fov 50\n-\n-\n+fov 50\n+\n # 0\n"), "{}", call.stdout);
}

#[test]
fn standard_input_goes_to_standard_output() {
    let folder = Folder::new();
    let format = |args: &[&str], text: &str| {
        let output = folder.command(args).write_stdin(text).output().expect("a call");
        crate::support::Call::from(output)
    };
    for text in [LOOSE, TIDY] {
        let call = format(&["fmt", "-"], text);
        assert_eq!((call.code, call.stdout.as_str(), call.stderr.as_str()), (Some(0), TIDY, ""));
    }
    let call = format(&["fmt", "-", "--check"], LOOSE);
    assert_eq!((call.code, call.stdout.as_str()), (Some(1), "<stdin>\n"));
    let call = format(&["fmt", "-"], "fvo  60\n fov 60");
    assert_eq!((call.code, call.stdout.as_str()), (Some(0), "fvo  60\nfov 60\n"), "a line with an error stays");
}

#[test]
fn what_cannot_be_read_is_2_and_the_others_are_formatted() {
    let folder = Folder::with_scene(LOOSE);
    let call = folder.clisc(&["fmt", "missing.cli", "a.cli"]);
    assert_eq!(call.code, Some(2));
    assert!(call.stderr.starts_with("error: cannot read `missing.cli`: No such file"), "{}", call.stderr);
    assert_eq!(folder.bytes("a.cli"), TIDY.as_bytes());
}

#[cfg(unix)]
mod unix {
    use std::fs;
    use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};

    use super::*;

    #[test]
    fn a_read_only_scene_is_left_alone() {
        let folder = Folder::with_scene(LOOSE);
        fs::set_permissions(folder.at("a.cli"), fs::Permissions::from_mode(0o444)).expect("set rights");
        let call = folder.clisc(&["fmt", "a.cli"]);
        assert_eq!(call.code, Some(2));
        assert_eq!(call.stderr.lines().next(), Some("error: cannot save `a.cli`: it is read-only"));
        assert_eq!(folder.bytes("a.cli"), LOOSE.as_bytes());
        assert_eq!(folder.clisc(&["fmt", "--check", "a.cli"]).code, Some(1));
    }

    #[test]
    fn a_link_stays_a_link_and_rights_stay() {
        let folder = Folder::with_scene(LOOSE);
        fs::set_permissions(folder.at("a.cli"), fs::Permissions::from_mode(0o600)).expect("set rights");
        symlink("a.cli", folder.at("b.cli")).expect("a link");
        assert_eq!(folder.clisc(&["fmt", "b.cli", "a.cli"]).stderr, "1 scene formatted, 0 unchanged\n");
        assert!(fs::symlink_metadata(folder.at("b.cli")).expect("a link").is_symlink());
        assert_eq!(folder.bytes("a.cli"), TIDY.as_bytes());
        let rights = fs::metadata(folder.at("a.cli")).expect("a file").permissions().mode();
        assert_eq!(rights & 0o7777, 0o600);
    }

    #[test]
    fn a_file_keeps_all_its_names() {
        let folder = Folder::with_scene(LOOSE);
        fs::hard_link(folder.at("a.cli"), folder.at("b.cli")).expect("a hard link");
        let call = folder.clisc(&["fmt", "."]);
        assert_eq!(call.code, Some(0), "{}", call.stderr);
        assert_eq!((folder.bytes("a.cli"), folder.bytes("b.cli")), (TIDY.into(), TIDY.into()));
        let id = |name: &str| fs::metadata(folder.at(name)).expect("a file").ino();
        assert_eq!(id("a.cli"), id("b.cli"));
        assert_eq!(folder.listing(), ["a.cli", "b.cli"]);
        folder.put("a.cli", LOOSE);
        fs::set_permissions(folder.at("a.cli"), fs::Permissions::from_mode(0o444)).expect("set rights");
        assert_eq!(folder.clisc(&["fmt", "b.cli"]).code, Some(2), "read-only by any name");
        assert_eq!(folder.bytes("b.cli"), LOOSE.as_bytes());
    }

    #[test]
    fn bytes_that_are_no_text_stay_as_they_are() {
        let folder = Folder::new();
        folder.put("a.cli", b"fov  60 # \xFC\n fov 60\n");
        assert_eq!(folder.clisc(&["fmt", "--diff", "-"]).code, Some(0));
        assert_eq!(folder.clisc(&["fmt", "a.cli"]).code, Some(0));
        assert_eq!(folder.bytes("a.cli"), b"fov  60 # \xFC\nfov 60\n");
    }
}
