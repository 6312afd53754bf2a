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

/// What a help line spells out and nobody can have meant otherwise, `--fix` does.
#[test]
fn mistakes_of_one_reading_are_mended() {
    let mended = |text: &str| {
        let folder = Folder::with_scene(text);
        folder.clisc(&["lint", "a.cli", "--fix"]);
        String::from_utf8(folder.bytes("a.cli")).expect("text")
    };
    for (line, repair) in [
        ("sphere 0,0,-5,1", "sphere 0 0 -5 1"),
        ("sphere 0, 0, -5, 1", "sphere 0 0 -5 1"),
        ("sphere(0,0,-5,1)", "sphere 0 0 -5 1"),
        ("sphere (0, 0, -5), 1  # a ball", "sphere 0 0 -5 1  # a ball"),
        ("sphere: 0 0 -5 1", "sphere 0 0 -5 1"),
        ("SPHERE 0 0 -5 1", "sphere 0 0 -5 1"),
        ("Sphere(0;0;-5;1)", "sphere 0 0 -5 1"),
        ("fov60", "fov 60"),
        ("fov 59,5", "fov 59.5"),
        ("sphere 0,5 0 \u{2212}5 1.0f", "sphere 0.5 0 -5 1.0"),
        ("sphere 0 0 - 5 1", "sphere 0 0 -5 1"),
        ("sphere 0\u{a0}0 -5 1", "sphere 0 0 -5 1"),
        ("sphere 0 0 -5 1 sphere 1 0 -5 1", "sphere 0 0 -5 1\nsphere 1 0 -5 1"),
        ("surface 0 0 0  1 0 0\n0 0 0  1 0", "surface 0 0 0  1 0 0 0 0 0  1 0"),
        ("// a ball", "# a ball"),
        ("fov 60 // wide", "fov 60 # wide"),
        ("; a ball", "# a ball"),
        ("write b.jpg", "write b.png"),
        ("write b.PNG", "write b.png"),
        ("write b", "write b.png"),
        ("write 'b.png'", "write b.png"),
        ("write b.png;", "write b.png"),
        ("write \"b c.png", "write \"b c.png\""),
        ("write(\"b.png\")", "write b.png"),
        ("write b.png#last", "write b.png #last"),
    ] {
        // A line that cannot be mended keeps the rules from having their say.
        assert_eq!(mended(&format!("sphere x\n{line}\n")), format!("sphere x\n{repair}\n"));
    }
    for line in [
        "sphere 0 0 -5 radius=1", // an argument of another place, perhaps
        "sphere <0,0,-5>, 1",     // another language, with an order of its own
        "sphere1 0 0 -5",         // the first sphere, or one at 1
        "sphere1 0 -5 1",
        "sphere 0 0 -5\n1", // a radius, or an angle without its command
        "fov 1,000",        // one, or a thousand
        "fov 50%",
        "sphre 0 0 -5 1",
        "write b.tar",
        "write my b.png",
        "write b.png 640 480",
        "fov 60 write later",
        "write \"b # later",
        "'sphere 0 0 -5 1'",
    ] {
        let text = format!("sphere x\n{line}\n");
        assert_eq!(mended(&text), text);
    }
    assert_eq!(
        mended("write a.png\nwrite a.jpg\nwrite b\nwrite b.gif\n"),
        "write a.png\nwrite a.jpg\nwrite b.png\nwrite b.gif\n"
    );
    let whole = scene("a.png").replace("fov 60", "FOV(60)").replace("sphere 0 0 -4 1", "sphere 0,0,-4,1\nfov 60");
    let call = Folder::with_scene(&whole).clisc(&["lint", "a.cli"]);
    assert!(call.stderr.ends_with("2 errors, no warning, 2 that --fix mends\n"), "{}", call.stderr);
    assert_eq!(mended(&whole), scene("a.png"), "and what rules find is mended when no error is left");
}

/// In another edition the line means something else, however it is mended.
#[test]
fn a_scene_of_another_edition_is_left_alone() {
    let text = "FOV 60\nlight 2 5 3  1,1,1\nsurface .5 0 0 .1 0 0 .5 .5 .5 10 0\nsphere 1 0 0 -5\neye 0 0 0\ncone 0 0 -5 1 1\nwrite a\n";
    let folder = Folder::with_scene(text);
    let call = folder.clisc(&["lint", "a.cli", "--fix", "--format", "short"]);
    assert_eq!(folder.bytes("a.cli"), text.as_bytes(), "{}", call.stdout);
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
