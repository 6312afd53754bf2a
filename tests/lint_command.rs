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

/// What is not listed counts too, and only as much as it would if it were.
#[test]
fn findings_beyond_those_that_are_listed_are_counted_as_they_are() {
    let dim = "surface 2 0 0  0 0 0  0 0 0  1 0\n";
    let folder = Folder::with_scene(&scene("a.png").replacen("write", &(dim.repeat(12_000) + "write"), 1));
    let counts = |args: &[&str]| {
        let json = folder.clisc(&[args, &["a.cli", "--format", "json"]].concat()).stdout;
        let json: serde_json::Value = serde_json::from_str(&json).expect("one document");
        let n_listed = json["diagnostics"].as_array().map_or(0, Vec::len) as u64;
        let count = |name: &str| json[name].as_u64().expect("a number");
        assert_eq!(n_listed + count("unlisted"), count("errors") + count("warnings"), "{args:?}");
        (count("errors"), count("warnings"), n_listed)
    };
    assert_eq!(counts(&["check"]), (0, 12_000, 10_000));
    // Each is outside 0 to 1, and all but the first set what is set already.
    assert_eq!(counts(&["lint", "--select", "outside-unit-range"]), (0, 12_000, 10_000));
    assert_eq!(counts(&["lint", "--select", "repeated-setting"]), (0, 11_999, 10_000));
    assert_eq!(counts(&["lint", "--select", "repeated-setting,outside-unit-range"]), (0, 23_999, 10_000));
    assert_eq!(counts(&["lint", "--select", "no-fov"]), (0, 0, 0));
    folder.put("clisc.toml", "[lint.rules]\noutside-unit-range = \"error\"\n");
    assert_eq!(counts(&["check"]), (12_000, 0, 10_000));
    folder.put("clisc.toml", "[lint.rules]\noutside-unit-range = \"off\"\n");
    assert_eq!(counts(&["check"]), (0, 0, 0));
    folder.put("clisc.toml", "");
    let allowed = dim.replace('\n', " # clisc: allow(outside-unit-range)\n");
    folder.put("a.cli", scene("a.png").replacen("write", &(allowed.repeat(12_000) + "write"), 1));
    assert_eq!(counts(&["check"]), (0, 0, 0));
    assert_eq!(counts(&["lint", "--select", "outside-unit-range,unused-allow"]), (0, 0, 0));
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
