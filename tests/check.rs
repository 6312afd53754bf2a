//! `clisc check`, `ir` and `explain` as one calls them: exit codes, streams, files.

mod support;

use std::fs;
use std::path::Path;

use crate::support::{Call, Folder, scene};

const BAD: &str = "fov 0\nwrite a.png\n";

#[test]
fn a_sound_scene_is_fine() {
    let call = Folder::with_scene(&scene("a.png")).clisc(&["check", "a.cli"]);
    assert_eq!((call.code, call.stdout.as_str()), (Some(0), ""));
    assert_eq!(call.stderr, "1 scene checked: no error, no warning\n");
}

#[test]
fn a_scene_with_errors_is_1_and_told_on_standard_output() {
    let call = Folder::with_scene(BAD).clisc(&["check", "a.cli"]);
    assert_eq!(call.code, Some(1));
    assert!(call.stdout.contains("error[E0401]: a field of view of 0 degrees is out of range"), "{}", call.stdout);
    assert!(call.stdout.contains("a.cli:1:5") && !call.stdout.contains('\u{1B}'), "{}", call.stdout);
    assert_eq!(call.stderr, "1 scene checked: 1 error, no warning\n");
}

#[test]
fn the_short_form_is_a_line_each() {
    let call = Folder::with_scene(BAD).clisc(&["check", "a.cli", "--format", "short"]);
    assert_eq!(call.stdout, "a.cli:1:5: error[E0401]: a field of view of 0 degrees is out of range\n");
}

#[test]
fn json_is_one_document_for_all_scenes() {
    let folder = Folder::with_scene(BAD);
    folder.put("b.cli", "# π\nwrite a.png");
    let call = folder.clisc(&["check", "--format", "json", "a.cli", "missing.cli", "b.cli"]);
    assert_eq!(call.code, Some(2));
    let document: serde_json::Value = serde_json::from_str(&call.stdout).expect("one document");
    assert_eq!((&document["version"], &document["errors"], &document["warnings"]), (&1.into(), &1.into(), &1.into()));
    let found = document["diagnostics"].as_array().expect("a list");
    assert_eq!(found.len(), 2);
    assert_eq!((&found[0]["path"], &found[0]["code"]), (&"a.cli".into(), &"E0401".into()));
    assert_eq!(found[0]["primary"]["bytes"], serde_json::json!({ "start": 4, "end": 5 }));
    assert_eq!(found[0]["primary"]["end"], serde_json::json!({ "line": 1, "column": 6 }));
    assert_eq!(found[1]["primary"]["bytes"]["start"], 5, "bytes, not characters");
    assert!(call.stderr.contains("cannot read `missing.cli`"), "{}", call.stderr);
    let empty = Folder::with_scene(&scene("a.png")).clisc(&["check", "--format", "json", "a.cli"]);
    let document: serde_json::Value = serde_json::from_str(&empty.stdout).expect("one document");
    assert_eq!(document["diagnostics"], serde_json::json!([]));
}

#[test]
fn every_format_tells_of_all_scenes_in_the_order_given() {
    let folder = Folder::with_scene(BAD);
    (0..40).for_each(|i| folder.put(&format!("many/{i:02}.cli"), "write a.png\nfov 0\n"));
    let call = |format: &str| folder.clisc(&["check", "many", "a.cli", "--format", format]).stdout;
    let paths = |paths: Vec<String>| {
        assert_eq!(paths.len(), 40 * 3 + 1, "{paths:?}");
        assert!(paths.is_sorted_by_key(|path| (path == "a.cli", path.clone())), "{paths:?}");
    };
    let json: serde_json::Value = serde_json::from_str(&call("json")).expect("JSON");
    let of = |list: &serde_json::Value, pointer: &str| {
        let list = list.as_array().expect("a list");
        list.iter()
            .map(|found| found.pointer(pointer).and_then(|path| path.as_str()).expect("a path").to_owned())
            .collect()
    };
    paths(of(&json["diagnostics"], "/path"));
    let sarif: serde_json::Value = serde_json::from_str(&call("sarif")).expect("SARIF");
    paths(of(&sarif["runs"][0]["results"], "/locations/0/physicalLocation/artifactLocation/uri"));
    let gitlab: serde_json::Value = serde_json::from_str(&call("gitlab")).expect("JSON");
    paths(of(&gitlab, "/location/path"));
    let until = |line: &str, end: char| line.split(end).next().unwrap_or_default().to_owned();
    paths(call("short").lines().map(|line| until(line, ':')).collect());
    paths(call("github").lines().map(|line| until(line.split("file=").nth(1).unwrap_or_default(), ',')).collect());
}

#[test]
fn warnings_are_fine_until_they_are_denied() {
    let folder = Folder::with_scene(&scene("a.png").replace("fov 60\n", ""));
    let call = folder.clisc(&["check", "a.cli"]);
    assert_eq!(call.code, Some(0));
    assert!(call.stdout.contains("warning[W0302]"), "{}", call.stdout);
    assert_eq!(folder.clisc(&["check", "a.cli", "--deny-warnings"]).code, Some(1));
}

/// The first ten thousand are more than anyone reads; the others are counted, so that memory is bounded.
#[test]
fn of_a_great_many_mistakes_the_first_are_listed_and_all_are_counted() {
    let mut scene = "sphere x\n".repeat(10_050) + "surface 2 0 0  0 0 0  0 0 0  1 0\n" + "foo\n";
    scene.insert_str(0, "# a comment\n");
    let folder = Folder::with_scene(&scene);
    let call = folder.clisc(&["check", "a.cli", "--format", "short"]);
    assert_eq!(call.code, Some(1));
    // Warnings have room of their own: here for a colour and for the write that is missing.
    assert_eq!(call.stdout.lines().count(), 10_002);
    assert!(call.stdout.starts_with("a.cli:2:8: error[E0205]"), "{}", call.stdout);
    assert!(!call.stdout.contains("E0201"), "the last error is not among the first");
    assert_eq!(
        call.stderr,
        "`a.cli` has 51 more errors and no more warning that are not listed\n\
         1 scene checked: 10051 errors, 2 warnings\n"
    );
    let call = folder.clisc(&["check", "a.cli", "--format", "json"]);
    let document: serde_json::Value = serde_json::from_str(&call.stdout).expect("one document");
    assert_eq!(document["diagnostics"].as_array().map(Vec::len), Some(10_002));
    assert_eq!((&document["errors"], &document["warnings"]), (&10_051.into(), &2.into()));
    assert_eq!(document["unlisted"], 51);
}

#[test]
fn a_folder_means_every_scene_below_it() {
    let folder = Folder::new();
    folder.put("b.cli", "x");
    folder.put("c/a.cli", "x");
    folder.put("a.cli", "x");
    folder.put("c/notes.txt", "x");
    let call = folder.clisc(&["check", ".", "--format", "short"]);
    let paths: Vec<_> =
        call.stdout.lines().filter(|line| line.contains("E0201")).map(|line| line.split(':').next()).collect();
    assert_eq!(paths, [Some("a.cli"), Some("b.cli"), Some("c/a.cli")]);
    assert!(call.stderr.ends_with("3 scenes checked: 3 errors, 3 warnings\n"), "{}", call.stderr);
    assert_eq!(folder.clisc(&["check", "./", "--format", "short"]).stdout, call.stdout);
}

/// Returns the scenes that `check` finds wrong, in order.
fn scenes_found(folder: &Folder, args: &[&str]) -> Vec<String> {
    let call = folder.clisc(&[&["check", "--format", "short"], args].concat());
    let errors = call.stdout.lines().filter(|line| line.contains("E0201"));
    errors.map(|line| line.split(':').next().unwrap_or_default().to_owned()).collect()
}

#[test]
fn what_is_hidden_or_ignored_is_read_only_when_it_is_named() {
    let folder = Folder::new();
    for name in [
        "a.cli",
        "B.CLI",
        ".git/x.cli",
        ".#a.cli",
        "._a.cli",
        ".cli",
        "built/x.cli",
        "deep/old.cli",
        "deep/new.cli",
        "drafts/x.cli",
        "deep/drafts/x.cli",
        "own/kept.cli",
    ] {
        folder.put(name, "x");
    }
    folder.put(".gitignore", "built/\n");
    folder.put("deep/.gitignore", "old.cli\n");
    folder.put("clisc.toml", "exclude = [\"drafts/\", \"kept.cli\"]\n");
    folder.put("own/clisc.toml", "");
    assert_eq!(scenes_found(&folder, &["."]), ["B.CLI", "a.cli", "deep/new.cli", "own/kept.cli"]);
    let named = ["built", ".git/x.cli", "drafts/x.cli", "deep/old.cli", "deep/drafts"];
    let expected = ["built/x.cli", ".git/x.cli", "drafts/x.cli", "deep/old.cli", "deep/drafts/x.cli"];
    assert_eq!(scenes_found(&folder, &named), expected);
    let call = folder.clisc(&["fmt", "--check", "."]);
    assert!(call.stderr.contains("4 scenes to be formatted"), "{}", call.stderr);
    let help = folder.clisc(&["check", "--help"]).stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(help.contains("A path that is named here is always read"), "{help}");
}

#[test]
fn a_folder_of_which_all_is_left_out_says_so() {
    let folder = Folder::new();
    folder.put("x/.gitignore", "*.cli\n");
    folder.put("x/a.cli", "x");
    let call = folder.clisc(&["check", "x"]);
    assert_eq!(call.code, Some(2));
    assert!(call.stderr.contains("there is no .cli file below `x` but 1 file left out"), "{}", call.stderr);
    folder.put("clisc.toml", "exclude = [\"{a\"]\n");
    folder.put("b.cli", scene("b.png"));
    for args in [&["fmt", "."][..], &["check", "."]] {
        let call = folder.clisc(args);
        assert_eq!(call.code, Some(2), "{}", call.stderr);
        assert!(call.stderr.contains("clisc.toml`: `exclude`: ") && call.stderr.contains("{a"), "{}", call.stderr);
    }
}

#[test]
#[cfg(unix)]
fn links_are_followed_to_files_and_dangling_ones_are_told() {
    use std::os::unix::fs::symlink;

    let folder = Folder::new();
    folder.put("elsewhere/a.cli", "x");
    folder.put("x/b.cli", scene("b.png"));
    for (to, link) in
        [("../elsewhere/a.cli", "x/a.cli"), ("missing", "x/gone.cli"), ("c.cli", "x/c.cli"), ("../x", "x/x")]
    {
        symlink(to, folder.at(link)).expect("a link");
    }
    symlink("../elsewhere", folder.at("x/folder.cli")).expect("a link");
    assert_eq!(scenes_found(&folder, &["x"]), ["x/a.cli"]);
    std::fs::remove_file(folder.at("x/a.cli")).expect("a link");
    let call = folder.clisc(&["check", "x", "--format", "json"]);
    assert_eq!(call.code, Some(0), "{}", call.stderr);
    let warned = "warning: `x/c.cli` is a link that leads nowhere and is left out\n\
                  warning: `x/gone.cli` is a link that leads nowhere and is left out\n";
    assert!(call.stderr.starts_with(warned), "{}", call.stderr);
    let document: serde_json::Value = serde_json::from_str(&call.stdout).expect("one document");
    assert_eq!(document["notifications"][1]["path"], "x/gone.cli");
    assert_eq!(document["notifications"][1]["severity"], "warning");
    assert_eq!(folder.clisc(&["check", "x/gone.cli"]).code, Some(2), "named, it cannot be read");
}

/// A report for programs may not look whole when it is not.
#[test]
fn what_cannot_be_read_is_in_every_report_for_programs() {
    let folder = Folder::with_scene("fov 60\n\n\nx\n");
    for command in [&["check"][..], &["lint"], &["fmt", "--check"]] {
        let call = |format: &str| {
            let call = folder.clisc(&[command, &["missing file.cli", "a.cli", "--format", format]].concat());
            assert_eq!(call.code, Some(2), "{command:?} {format}");
            assert!(call.stderr.contains("error: cannot read `missing file.cli`: No such file"), "{}", call.stderr);
            assert!(call.stdout.contains("a.cli"), "the others are told: {}", call.stdout);
            call.stdout
        };
        let document = |format: &str| serde_json::from_str::<serde_json::Value>(&call(format)).expect("one document");
        let json = document("json");
        assert_eq!(json["notifications"][0]["severity"], "error");
        assert_eq!(json["notifications"][0]["path"], "missing file.cli");
        let run = &document("sarif")["runs"][0];
        let invocation = &run["invocations"][0];
        assert_eq!(invocation["executionSuccessful"], false);
        let told = &invocation["toolExecutionNotifications"][0];
        assert_eq!(told["level"], "error");
        assert!(
            told["message"]["text"].as_str().is_some_and(|text| text.starts_with("cannot read `missing file.cli`"))
        );
        let place = told.pointer("/locations/0/physicalLocation/artifactLocation/uri");
        assert_eq!(place, Some(&"missing%20file.cli".into()));
        let gitlab = document("gitlab");
        assert_eq!(gitlab[0]["location"]["path"], "missing file.cli");
        assert_eq!(gitlab[0]["severity"], "major");
        assert!(
            call("github").starts_with("::error file=missing file.cli,title=clisc::cannot read `missing file.cli`")
        );
    }
    let sound = Folder::with_scene(&scene("a.png")).clisc(&["check", "a.cli", "--format", "sarif"]);
    let document: serde_json::Value = serde_json::from_str(&sound.stdout).expect("one document");
    assert_eq!(document["runs"][0]["invocations"][0]["executionSuccessful"], true);
}

#[test]
fn a_folder_without_scenes_is_a_slip() {
    let folder = Folder::new();
    folder.put("empty/notes.txt", "x");
    let call = folder.clisc(&["check", "empty"]);
    assert_eq!(call.code, Some(2));
    assert!(call.stderr.contains("there is no .cli file below `empty`"), "{}", call.stderr);
}

/// What `run` would refuse on every system is wrong with the scene.
#[test]
fn a_name_that_leaves_the_output_folder_is_an_error() {
    let folder = Folder::with_scene(&(scene("/tmp/a.png") + "write ../b.png\nwrite sub/c.png\n"));
    let call = folder.clisc(&["check", "a.cli", "--format", "short"]);
    assert_eq!(call.code, Some(1));
    let codes: Vec<_> =
        call.stdout.lines().filter_map(|line| line.get(6..).and_then(|line| line.split(']').next())).collect();
    assert_eq!(codes, ["6:7: error[E0501", "7:7: error[E0502"], "{}", call.stdout);
    assert_eq!(call.stderr, "1 scene checked: 2 errors, no warning\n");
}

#[test]
#[cfg(unix)]
fn the_name_of_a_scene_commands_no_terminal() {
    let folder = Folder::new();
    let name = "a\u{1B}]0;x\u{7}.cli";
    folder.put(name, BAD);
    for args in [&["check", name][..], &["check", name, "--format", "short"], &["run", name], &["run", "b\u{1B}.cli"]] {
        let call = folder.clisc(args);
        let told = call.stdout + &call.stderr;
        assert!(!told.contains(['\u{1B}', '\u{7}']), "{told:?}");
        assert!(told.contains("a?]0;x?.cli") || told.contains("b?.cli"), "{told:?}");
    }
}

#[test]
fn standard_input_is_a_scene() {
    let folder = Folder::new();
    let call = folder.command(&["check", "-", "--format", "short"]).write_stdin(BAD).output().expect("a call");
    assert_eq!(call.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&call.stdout).starts_with("<stdin>:1:5: error[E0401]"));
}

#[test]
fn what_cannot_be_read_is_2_and_the_others_are_checked() {
    let folder = Folder::with_scene(BAD);
    let call = folder.clisc(&["check", "missing.cli", "a.cli", "--format", "short"]);
    assert_eq!(call.code, Some(2));
    assert!(call.stderr.contains("cannot read `missing.cli`: No such file"), "{}", call.stderr);
    assert!(call.stdout.contains("a.cli:1:5"), "{}", call.stdout);
}

#[test]
fn every_stage_can_be_shown() {
    let folder = Folder::with_scene(&scene("a.png"));
    for (stage, words) in [
        ("tokens", "6:7  path           \"a.png\""),
        ("ast", "5:1  sphere x=0.0 y=0.0 z=-4.0 radius=1.0"),
        ("ir", "#0  center 0.0 0.0 -4.0  radius 1.0  surface #0  order 0  equation 0  ; line 5"),
        ("commands", "   4  write       \"a.png\""),
        ("plan", "write 0  \"a.png\"  300x300  fov 60.0  ; line 6"),
    ] {
        let call = folder.clisc(&["ir", "a.cli", "--emit", stage]);
        assert_eq!((call.code, call.stderr.as_str()), (Some(0), ""));
        assert!(call.stdout.contains(words), "{stage}: {}", call.stdout);
        let call = folder.clisc(&["ir", "a.cli", "--emit", stage, "--format", "json"]);
        let document: serde_json::Value = serde_json::from_str(&call.stdout).expect("one document");
        assert_eq!(document["version"], 1, "{stage}");
    }
}

#[test]
fn a_bad_scene_has_tokens_and_a_tree_but_no_program() {
    let folder = Folder::with_scene(BAD);
    for (stage, is_shown) in [("tokens", true), ("ast", true), ("ir", false), ("commands", false), ("plan", false)] {
        let call = folder.clisc(&["ir", "a.cli", "--emit", stage]);
        assert_eq!(call.code, Some(1));
        assert_eq!(!call.stdout.is_empty(), is_shown, "{stage}: {}", call.stdout);
        assert!(call.stderr.contains("error[E0401]"), "{}", call.stderr);
    }
}

/// Once a run, for people only.
#[test]
fn the_last_words_name_the_command_that_says_more() {
    let folder = Folder::with_scene(BAD);
    let one = "For more information try `clisc explain E0401`.\n";
    let call = folder.clisc(&["check", "a.cli", "a.cli"]);
    assert!(call.stdout.ends_with(one) && call.stdout.matches("explain").count() == 1, "{}", call.stdout);
    let call = folder.clisc(&["run", "a.cli"]);
    assert!(call.stderr.ends_with(one), "{}", call.stderr);
    assert!(folder.clisc(&["ir", "a.cli"]).stderr.ends_with(one));
    folder.put("b.cli", "x\nfov 200\nsphere 0 0 -5 1\n");
    let call = folder.clisc(&["check", "a.cli", "b.cli"]);
    let several = "These codes have explanations: E0201, E0301, E0401, W0301.\n\
                   For more information on one try `clisc explain E0201`.\n";
    assert!(call.stdout.ends_with(several), "{}", call.stdout);
    for args in [
        &["run", "a.cli", "--quiet"][..],
        &["check", "a.cli", "--format", "short"],
        &["check", "a.cli", "--format", "json"],
        &["check", "a.cli", "--format", "github"],
    ] {
        let call = folder.clisc(args);
        assert!(!(call.stdout + &call.stderr).contains("clisc explain"), "{args:?}");
    }
    folder.put("a.cli", scene("a.png"));
    assert_eq!(folder.clisc(&["check", "a.cli"]).stdout, "");
}

#[test]
fn codes_are_explained_in_any_case() {
    let folder = Folder::new();
    for name in ["E0203", "e0203", "No-FOV", "NO-FOV", "l0101", "Unused-Surface", "f0101"] {
        assert_eq!(folder.clisc(&["explain", name]).code, Some(0), "{name}");
    }
    for (name, meant) in [("E203", "E0203"), ("e 0203", "E0203"), ("w302", "W0302 no-fov"), ("no_fov", "W0302 no-fov")]
    {
        let call = folder.clisc(&["explain", name]);
        assert!(call.stderr.contains(&format!("did you mean {meant}?")), "{name}: {}", call.stderr);
    }
}

#[test]
fn codes_are_explained() {
    let folder = Folder::new();
    let list = folder.clisc(&["explain"]);
    assert_eq!(list.code, Some(0));
    assert!(list.stdout.lines().any(|line| line == "E0203  error    missing argument"), "{}", list.stdout);
    assert!(list.stdout.lines().any(|line| line == "W0301  warning  no `write` (no-write)"), "{}", list.stdout);
    let page = folder.clisc(&["explain", "e0203"]);
    assert!(page.stdout.starts_with("# E0203: missing argument\n"), "{}", page.stdout);
    let unknown = folder.clisc(&["explain", "E0215"]);
    assert_eq!((unknown.code, unknown.stdout.as_str()), (Some(2), ""));
    assert!(unknown.stderr.contains(" `E0215`; did you mean E0205?"), "{}", unknown.stderr);
}

#[test]
fn the_language_is_explained_by_commands_and_topics() {
    let folder = Folder::new();
    let list = folder.clisc(&["explain"]).stdout;
    assert!(list.lines().any(|line| line == "sphere      Adds a sphere."), "{list}");
    let page =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("grammar/semantics.md")).expect("the page");
    for heading in page.lines().filter(|line| line.starts_with("##")).map(|line| line.trim_start_matches(['#', ' '])) {
        let name = heading.split(' ').next().expect("a word").to_lowercase();
        assert!(list.lines().any(|line| line.starts_with(&format!("{name} "))), "not listed: {name}");
        let call = folder.clisc(&["explain", &name]);
        assert_eq!(call.code, Some(0), "{}", call.stderr);
        assert!(call.stdout.starts_with(&format!("# {heading}\n\n")), "{}", call.stdout);
    }
    let shading = folder.clisc(&["explain", "Shading"]).stdout;
    assert!(shading.contains("Cl · (Cd · (n·L) + Cs · (n·H)^P)"), "{shading}");
    assert!(shading.ends_with("See also: clisc explain pixels, shadows, levels\n"), "{shading}");
    assert_eq!(folder.clisc(&["explain", "reflection"]).stdout, folder.clisc(&["explain", "levels"]).stdout);
    let unknown = folder.clisc(&["explain", "sphare"]);
    assert_eq!((unknown.code, unknown.stdout.as_str()), (Some(2), ""));
    assert!(unknown.stderr.contains("did you mean sphere?"), "{}", unknown.stderr);
}

/// A reader that has seen enough ends nothing: as `clisc ir a.cli --emit tokens | head -1` does.
#[test]
#[cfg(unix)]
fn a_closed_pipe_is_no_fault() {
    use std::io::{BufRead, BufReader, Read};
    use std::process::{Command, Stdio};

    let folder = Folder::with_scene(&"sphere x\n".repeat(20_000));
    folder.put("b.cli", "# a comment\n".repeat(20_000) + &scene("b.png"));
    for (args, code) in [
        (&["check", "a.cli"][..], 1),
        (&["check", "a.cli", "--format", "json"], 1),
        (&["ir", "b.cli", "--emit", "tokens"], 0),
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_clisc"));
        command.current_dir(folder.at(".")).args(args).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("a command that starts");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("a pipe")).read_line(&mut line).expect("a line");
        let mut stderr = String::new();
        child.stderr.take().expect("a pipe").read_to_string(&mut stderr).expect("text");
        assert_eq!(child.wait().expect("an end").code(), Some(code), "{args:?}");
        assert!(!stderr.contains("panicked") && !stderr.contains("cannot write"), "{stderr}");
    }
}

#[test]
fn color_is_as_it_is_asked_for() {
    let folder = Folder::with_scene(BAD);
    let is_colored = |args: &[&str]| folder.clisc(args).stdout.contains('\u{1B}');
    assert!(is_colored(&["check", "a.cli", "--color", "always"]));
    assert!(is_colored(&["--color=always", "check", "a.cli"]), "before the command as well as behind it");
    assert!(!is_colored(&["check", "a.cli", "--color", "never"]));
    assert!(!is_colored(&["check", "a.cli"]), "a pipe is no terminal");
}

/// As an editor has it, which knows the file of a text that is not saved.
#[test]
fn standard_input_stands_for_the_file_that_is_named() {
    let folder = Folder::new();
    folder.put("sub/clisc.toml", "[lint.rules]\nno-fov = \"off\"\n");
    let text = scene("b.png").replace("fov 60\n", "");
    let call = |args: &[&str]| -> Call {
        folder.command(args).write_stdin(text.as_str()).output().expect("a command that starts").into()
    };
    let named = ["-", "--stdin-filename", "sub/a.cli", "--format", "short"];
    for command in ["check", "lint"] {
        let unnamed = call(&[command, "-", "--format", "short"]).stdout;
        assert!(unnamed.starts_with("<stdin>:") && unnamed.contains("W0302"), "{unnamed}");
        let found = call(&[&[command][..], &named].concat()).stdout;
        assert!(!found.contains("W0302") && !found.contains("<stdin>"), "{found}");
    }
    folder.put("sub/clisc.toml", "[lint.rules]\nno-fov = \"error\"\n");
    let found = call(&[&["check"][..], &named].concat());
    assert_eq!(
        (found.code, found.stdout.starts_with("sub/a.cli:5:1: error[W0302]")),
        (Some(1), true),
        "{}",
        found.stdout
    );
    let formatted = call(&["fmt", "-", "--stdin-filename", "sub/a.cli", "--check"]);
    assert_eq!((formatted.code, formatted.stdout.as_str()), (Some(1), "sub/a.cli\n"));
    let other = call(&["check", "sub/a.cli", "--stdin-filename", "sub/a.cli"]);
    assert_eq!(other.code, Some(2));
    assert!(other.stderr.contains("write `-` for it"), "{}", other.stderr);
}

#[test]
fn a_file_called_as_standard_input_is_another() {
    let folder = Folder::new();
    folder.put("-", "fov 0\n");
    let call = folder.command(&["check", "-", "./-", "-", "--format", "short"]).write_stdin("fov 181\n").output();
    let call: Call = call.expect("a command that starts").into();
    let places: Vec<_> =
        call.stdout.lines().filter(|line| line.contains("E0401")).map(|line| line.split(':').next()).collect();
    assert_eq!(places, [Some("<stdin>"), Some("./-")], "{}", call.stdout);
}

#[test]
fn a_file_that_is_no_text_is_named_once() {
    let folder = Folder::with_scene(&scene("first.png"));
    assert_eq!(folder.clisc(&["run", "a.cli", "--size", "4x4"]).code, Some(0));
    folder.put("photo.cli", b"\xFF\xD8\xFF\xE0\0\x10JFIF");
    folder.put("b.cli.gz", b"\x1F\x8B\x08\0");
    for (file, what) in
        [("first.png", "a PNG image"), ("photo.cli", "a JPEG image"), ("b.cli.gz", "compressed with gzip")]
    {
        for command in ["check", "lint", "run", "ir", "fmt", "bench"] {
            let call = folder.clisc(&[command, file]);
            assert_eq!((call.code, call.stdout.as_str()), (Some(2), ""), "{command}: {}", call.stderr);
            let message = format!("error: cannot read `{file}`: it is {what}, not a scene\n");
            assert!(call.stderr.starts_with(&message), "{command}: {}", call.stderr);
        }
    }
}

#[test]
fn a_forgotten_ending_is_offered() {
    let folder = Folder::with_scene(&scene("a.png"));
    for command in ["check", "run", "ir"] {
        let call = folder.clisc(&[command, "a"]);
        assert_eq!(call.code, Some(2));
        assert!(
            call.stderr.contains("cannot read `a`: ") && call.stderr.contains("did you mean `a.cli`?"),
            "{}",
            call.stderr
        );
        assert!(!folder.clisc(&[command, "b"]).stderr.contains("mean"));
    }
}
