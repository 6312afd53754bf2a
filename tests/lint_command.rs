//! `clisc lint` as one calls it: exit codes, files, `clisc.toml`.

mod support;

use crate::support::{Folder, scene};

/// A scene with one finding that is mended safely and one that is not.
fn smelly() -> String {
    scene("a.png").replacen("write", "light 0 0 0  1 2 3\nsphere 90 0 -4 1\nwrite", 1)
}

#[test]
fn findings_are_1_and_none_is_0() {
    let folder = Folder::with_scene(&smelly());
    let call = folder.clisc(&["lint", "a.cli", "--format", "short"]);
    assert_eq!(call.code, Some(1), "{}", call.stderr);
    assert!(call.stdout.contains("warning[L0201]") && call.stdout.contains("warning[L0301]"), "{}", call.stdout);
    assert_eq!(call.stderr, "1 scene linted: no error, 2 warnings, 1 that --fix mends\n");
    let call = folder.clisc(&["lint", "a.cli", "--ignore", "dark-light,L0301"]);
    assert_eq!((call.code, call.stdout.as_str()), (Some(0), ""));
    let call = folder.clisc(&["lint", "a.cli", "--select", "outside-view", "--format", "short"]);
    assert_eq!(call.stdout.lines().count(), 1);
    let call = folder.clisc(&["lint", "a.cli", "--select", "outside-veiw"]);
    assert_eq!(call.code, Some(2));
    assert!(call.stderr.contains("did you mean `outside-view`?"), "{}", call.stderr);
}

#[test]
fn fixes_are_shown_or_saved() {
    let folder = Folder::with_scene(&smelly());
    let call = folder.clisc(&["lint", "a.cli", "--diff"]);
    assert!(call.stdout.contains("\n-light 0 0 0  1 2 3\n"), "{}", call.stdout);
    assert_eq!(folder.bytes("a.cli"), smelly().as_bytes());
    let call = folder.clisc(&["lint", "a.cli", "--fix", "--format", "short"]);
    assert_eq!(call.code, Some(1), "one finding is left");
    assert_eq!(call.stderr, "1 scene linted: no error, 1 warning, 1 fix carried out\n");
    assert_eq!(folder.bytes("a.cli"), smelly().replace("light 0 0 0  1 2 3\n", "").as_bytes());
    folder.put("bad.cli", smelly() + "sphere x\n");
    folder.clisc(&["lint", "bad.cli", "--fix"]);
    assert_eq!(folder.bytes("bad.cli"), (smelly() + "sphere x\n").as_bytes(), "never over an error");
}

#[test]
fn the_nearest_configuration_above_counts() {
    let folder = Folder::new();
    folder.put("clisc.toml", "[lint.rules]\ndark-light = \"off\"\n");
    folder.put("below/a.cli", smelly());
    folder.put("other/a.cli", smelly());
    folder.put("other/clisc.toml", "[lint.rules]\noutside-view = \"error\"\ndark-light = \"off\"\n");
    let call = folder.clisc(&["lint", "below", "other", "--format", "short"]);
    let lines: Vec<_> = call.stdout.lines().collect();
    assert_eq!(lines.len(), 2, "{}", call.stdout);
    assert!(lines[0].starts_with("below/a.cli") && lines[0].contains("warning[L0301]"), "{}", call.stdout);
    assert!(lines[1].starts_with("other/a.cli") && lines[1].contains("error[L0301]"), "{}", call.stdout);
    folder.put("clisc.toml", "[lint.rules]\nno-such-rule = \"off\"\n");
    let call = folder.clisc(&["check", "below"]);
    assert_eq!(call.code, Some(2));
    assert!(call.stderr.contains("clisc.toml`: line 2, column 1: there is no rule `no-such-rule`"), "{}", call.stderr);
}
