//! `clisc run` as its users meet it: exit codes, streams, files.

mod support;

use std::fs;
#[cfg(target_os = "linux")]
use std::io::Write;

use crate::support::{Call, Folder, scene};

#[track_caller]
fn assert_code(call: &Call, code: i32) {
    assert_eq!(call.code, Some(code), "stdout:\n{}stderr:\n{}", call.stdout, call.stderr);
}

#[track_caller]
fn assert_says(text: &str, words: &str) {
    assert!(text.contains(words), "`{words}` is not in:\n{text}");
}

#[test]
fn an_image_is_saved_and_named_on_standard_output() {
    let folder = Folder::with_scene(&scene("a.png"));
    let call = folder.clisc(&["run", "a.cli"]);
    assert_code(&call, 0);
    assert_says(&call.stdout, "wrote a.png (300x300, ");
    assert_eq!(call.stderr, "");
    let image = folder.image("a.png");
    assert_eq!((image.width(), image.height()), (300, 300));
    assert_eq!(folder.listing(), ["a.cli", "a.png"]);
}

#[test]
fn size_and_folder_are_as_asked() {
    let folder = Folder::with_scene(&scene("deep/er/a.png"));
    let call = folder.clisc(&["run", "a.cli", "-o", "out/dir", "--size", "31x7"]);
    assert_code(&call, 0);
    assert_says(&call.stdout, "wrote out/dir/deep/er/a.png (31x7, ");
    let image = folder.image("out/dir/deep/er/a.png");
    assert_eq!((image.width(), image.height()), (31, 7));
}

#[test]
fn the_image_is_that_of_the_library() {
    let folder = Folder::with_scene(&scene("a.png"));
    assert_code(&folder.clisc(&["run", "a.cli", "--size", "40x30"]), 0);
    let image = folder.image("a.png");
    assert_eq!(image.pixel(0, 0), [25, 51, 76]);
    assert_ne!(image.pixel(20, 15), [25, 51, 76]);
}

#[test]
fn pixels_are_proved_unless_that_takes_too_long() {
    let folder = Folder::with_scene(&scene("a.png"));
    let precision = |args: &[&str]| {
        let call = folder.clisc(&[&["run", "a.cli", "--stats=json", "--threads", "2"], args].concat());
        assert_code(&call, 0);
        let stats: serde_json::Value = serde_json::from_str(&call.stdout).expect("a document");
        (stats["scenes"][0]["images"][0]["precision"].as_str().expect("a name").to_owned(), call.stderr)
    };
    assert_eq!(precision(&["--size", "60x60"]), ("certified".to_owned(), String::new()));
    assert_eq!(precision(&["--size", "60x60", "--precision", "f64"]).0, "f64");
    assert_eq!(precision(&["--size", "8x6", "--precision", "certified"]), ("certified".to_owned(), String::new()));
}

/// A ball in a mirrored ball: after so many bounces nothing is proved but in thousands of bits.
const MIRRORS: &str = "fov 60\nlight 1 1 1 0 0 -1\nsurface .01 0 0 .001 .001 .001 0 0 0 1 1\n\
                       sphere 0 0 0 10\nsphere 0 0 -5 1\nwrite a.png\n";

/// Lengths that differ so much that nothing but arbitrary precision holds, in every pixel of a large image.
const FAR: &str =
    "surface 1 1 1 0 0 0 0 0 0 1 0\nfov 60\nsphere 0 0 -4e-150 1e-150\nsphere 0 0 -4e150 1e150\nwrite a.png\n";

#[test]
fn pixels_that_are_not_proved_are_counted_whatever_is_asked_for() {
    let folder = Folder::with_scene(FAR);
    let limited = ["run", "a.cli", "--size", "540x540", "--stats=json"];
    for more in [&[][..], &["--quiet"]] {
        let call = folder.clisc(&[&limited[..], more].concat());
        assert_code(&call, 0);
        let stats: serde_json::Value = serde_json::from_str(&call.stdout).expect("a document");
        let image = &stats["scenes"][0]["images"][0];
        let n = image["not_proved"].as_u64().expect("a number");
        assert!(n > 0 && n < 540 * 540 && image["precision"] == "certified", "{image}");
        assert_says(&call.stderr, &format!("warning: `a.png`: {n} of 291600 pixels are not proved"));
        assert_says(&call.stderr, "--precision certified takes the time");
    }
    folder.put("a.cli", MIRRORS);
    let plain = folder.clisc(&["run", "a.cli", "-q", "--precision", "f64", "--max-level", "50", "--size", "9x9"]);
    assert_code(&plain, 0);
    assert_says(
        &plain.stderr,
        "of 81 pixels are not proved and have their best value; --precision certified proves more",
    );
    let table = folder.clisc(&["run", "a.cli", "--precision", "f32", "--size", "9x9", "--stats"]);
    assert_code(&table, 0);
    assert_says(&table.stdout, "not proved");
    assert_eq!(table.stderr, "", "of a draft it is no news");
}

#[test]
fn a_proof_can_be_required() {
    let folder = Folder::with_scene(&scene("a.png"));
    let args = ["run", "a.cli", "--size", "9x9", "--require-proof", "--quiet"];
    let call = folder.clisc(&args);
    assert_code(&call, 0);
    assert_eq!(call.stderr, "");
    for precision in ["f32", "f64"] {
        folder.put("a.cli", MIRRORS);
        let call = folder.clisc(&[&args[..], &["--precision", precision, "--max-level", "50"]].concat());
        assert_code(&call, 1);
        assert_says(&call.stderr, "pixels are not proved");
        assert_eq!(folder.listing(), ["a.cli", "a.png"]);
    }
    // Two balls that are each other's mirror image: a tie that stays open is not proved either.
    folder.put(
        "a.cli",
        "fov 50\nlight 1 1 1 0 .5 -2\nsurface .1 .1 .1 0 0 0 0 0 0 1 .9\nsphere 0 .2 1 10\n\
         surface .2 .2 .2 .5 .5 .5 0 0 0 1 0\nsphere -.3 .1 5 1\nsphere .3 .1 5 1\nwrite a.png\n",
    );
    let call = folder.clisc(&["run", "a.cli", "--size", "40x30", "--require-proof", "--quiet", "--stats=json"]);
    assert_code(&call, 1);
    assert_says(&call.stderr, "numbers in them are equal, or nearly so");
    assert_says(&call.stdout, "\"outcome\": \"unproved\"");
}

#[test]
fn options_of_the_render_reach_it() {
    let folder = Folder::with_scene(&scene("a.png"));
    let mut images = Vec::new();
    for options in [&[][..], &["--samples", "3"], &["--sample-at", "centre"], &["--part", "a"]] {
        let args = [&["run", "a.cli", "--size", "40x30"], options].concat();
        assert_code(&folder.clisc(&args), 0);
        images.push(folder.bytes("a.png"));
    }
    for (n, image) in images.iter().enumerate() {
        assert!(!images[..n].contains(image), "option {n} changes nothing");
    }
    let mirror = "fov 60\nlight 1 1 1 0 0 5\nsurface .1 .1 .1 .4 .1 .1 0 0 0 1 .9\nsphere 0 0 -4 1\nsphere 1 1 -3 .5\nwrite a.png\n";
    folder.put("a.cli", mirror);
    let levels = ["0", "8"].map(|level| {
        assert_code(&folder.clisc(&["run", "a.cli", "--size", "40x30", "--max-level", level]), 0);
        folder.bytes("a.png")
    });
    assert_ne!(levels[0], levels[1]);
}

#[test]
fn no_image_depends_on_what_is_skipped() {
    let folder = Folder::with_scene(&scene("a.png"));
    let images = ["--no-skip", "--no-skip=tiles,shadows", "--quiet"].map(|option| {
        assert_code(&folder.clisc(&["run", "a.cli", "--size", "40x30", option]), 0);
        folder.bytes("a.png")
    });
    assert!(images[0] == images[2] && images[1] == images[2]);
    let help = folder.clisc(&["run", "--help"]).stdout;
    for pass in ["writes", "objects", "terms", "saturation", "bounces", "shadows", "tiles"] {
        assert_says(&help, &format!("- {pass}:"));
    }
}

#[test]
fn a_scene_with_errors_renders_nothing_and_the_others_are_rendered() {
    let folder = Folder::with_scene(&scene("a.png"));
    folder.put("bad.cli", "write early.png\nsphere 1 2\nwrite late.png\n");
    folder.put("c.cli", scene("c.png"));
    let call = folder.clisc(&["run", "a.cli", "bad.cli", "c.cli", "--size", "4x4"]);
    assert_code(&call, 1);
    assert_says(&call.stderr, "error[E0203]");
    assert_says(&call.stderr, "bad.cli");
    assert_eq!(call.stdout.lines().count(), 2, "{}", call.stdout);
    assert_eq!(folder.listing(), ["a.cli", "a.png", "bad.cli", "c.cli", "c.png"]);
}

#[test]
fn an_unreadable_scene_is_an_environment_error_and_the_others_are_rendered() {
    let folder = Folder::with_scene(&scene("a.png"));
    folder.put("bad.cli", "sphere\n");
    let call = folder.clisc(&["run", "missing.cli", "bad.cli", "a.cli", "--size", "4x4"]);
    assert_code(&call, 2);
    assert_says(&call.stderr, "error: cannot read `missing.cli`: No such file or directory");
    assert_eq!(folder.listing(), ["a.cli", "a.png", "bad.cli"]);
}

#[test]
fn a_scene_may_come_from_standard_input() {
    let folder = Folder::new();
    let call: Call =
        folder.command(&["run", "-", "--size", "4x4"]).write_stdin(scene("a.png")).output().unwrap().into();
    assert_code(&call, 0);
    assert_eq!(folder.listing(), ["a.png"]);
    let call: Call = folder.command(&["run", "-"]).write_stdin("sphere\n").output().unwrap().into();
    assert_code(&call, 1);
    assert_says(&call.stderr, "<stdin>");
}

#[test]
fn a_scene_without_write_is_warned_of() {
    let folder = Folder::with_scene("fov 60\n");
    let call = folder.clisc(&["run", "a.cli"]);
    assert_code(&call, 0);
    assert_says(&call.stderr, "warning[W0301]");
    assert_eq!(call.stdout, "");
    assert_eq!(folder.listing(), ["a.cli"]);
}

#[test]
fn quiet_prints_errors_alone() {
    let folder = Folder::with_scene(&format!("light 9 9 9 0 0 5\n{}", scene("a.png")));
    let loud = folder.clisc(&["run", "a.cli", "--size", "4x4"]);
    assert_says(&loud.stderr, "warning[W0303]");
    let call = folder.clisc(&["run", "a.cli", "--size", "4x4", "--quiet"]);
    assert_code(&call, 0);
    assert_eq!((call.stdout.as_str(), call.stderr.as_str()), ("", ""));
    folder.put("a.cli", "light 9 9 9 0 0 5\nsphere\n");
    let call = folder.clisc(&["run", "a.cli", "-q"]);
    assert_code(&call, 1);
    assert_says(&call.stderr, "error[E0203]");
    assert!(!call.stderr.contains("warning"), "{}", call.stderr);
}

#[test]
fn a_dry_run_checks_and_writes_nothing() {
    let folder = Folder::with_scene(&scene("sub/a.png"));
    let call = folder.clisc(&["run", "a.cli", "--dry-run", "-o", "out", "--size", "4x5"]);
    assert_code(&call, 0);
    assert_eq!(call.stdout, "would write out/sub/a.png (4x5)\n");
    folder.put("a.cli", scene("../a.png"));
    assert_code(&folder.clisc(&["run", "a.cli", "--dry-run", "-o", "out"]), 1);
    assert_eq!(folder.listing(), ["a.cli"]);
}

#[test]
fn stats_as_json_are_one_document() {
    let folder = Folder::with_scene(&scene("a.png"));
    folder.put("bad.cli", "sphere\n");
    let call = folder.clisc(&["run", "a.cli", "bad.cli", "--stats=json", "--size", "30x20", "--threads", "2"]);
    assert_code(&call, 1);
    let document: serde_json::Value = serde_json::from_str(&call.stdout).unwrap();
    assert_eq!(document["threads"], 2);
    let scene = &document["scenes"][0];
    assert_eq!((&scene["scene"], &scene["outcome"]), (&"a.cli".into(), &"fine".into()));
    for time in ["parse_seconds", "lower_seconds", "trace_seconds", "encode_seconds"] {
        assert!(scene[time].as_f64().unwrap() > 0.0, "{time}");
    }
    assert!(scene["eye_rays"].as_u64().unwrap() >= 600, "one a pixel, and more where pixels are settled twice");
    for count in ["reflected_rays", "shadow_rays", "tests", "refined_pixels", "ties"] {
        assert!(scene[count].is_u64(), "{count}");
    }
    let image = &scene["images"][0];
    assert_eq!((&image["path"], &image["width"], &image["height"]), (&"a.png".into(), &30.into(), &20.into()));
    assert_eq!(image["bytes"], folder.bytes("a.png").len());
    assert!(image["skipped"]["eye_tests_not_made"].is_u64() && image["shares_with"].is_null());
    assert!(image["skipped"]["shadow_tests_not_made"].is_u64());
    assert_eq!(document["scenes"][1]["outcome"], "scene_errors");
}

#[test]
fn stats_as_a_table_name_every_time_and_count() {
    let folder = Folder::with_scene(&scene("a.png"));
    let call = folder.clisc(&["run", "a.cli", "--stats", "--size", "30x20"]);
    assert_code(&call, 0);
    for row in ["parse", "lower", "trace", "encode", "eye rays", "reflected rays", "shadow rays", "tests", "ties"] {
        assert_says(&call.stdout, &format!("\n  {row} "));
    }
    for row in ["objects left out", "tiles not visited", "eye rays not cast", "shadow rays not cast"] {
        assert_says(&call.stdout, &format!("\n  {row} "));
    }
    folder.put("a.cli", scene("a.png") + "write b.png\n");
    let call = folder.clisc(&["run", "a.cli", "--stats", "--size", "30x20"]);
    assert_says(&call.stdout, "\n  b.png is the image of write 0\n");
}

/// `--backend` chooses the instructions, else CLISC_BACKEND does; images are the same, and one that is missing is told of.
#[test]
fn a_backend_can_be_chosen() {
    let mirrors = "fov 60\nbackground .1 .2 .3\nlight 1 1 1 0 2 5\nlight .3 .3 .3 -4 1 2\nsurface .1 .2 0 .4 .1 .1 .5 .5 .5 9 .4\n\
                   sphere 0 0 -4 1\nsphere 1.5 .3 -5 1\nsphere -1.2 .1 -3 .4\ncylinder .3 .2 -2.5 -1 -.4\nwrite a.png\n";
    let folder = Folder::with_scene(mirrors);
    let version = folder.clisc(&["--version"]).stdout;
    let backends = version.lines().find_map(|line| line.strip_prefix("backends: ")).expect("a line of backends");
    let available: Vec<_> = backends.split(" (").next().expect("names").split(", ").collect();
    assert_eq!(available.last(), Some(&"scalar"));
    assert_says(&version, &format!("in use: {}", available[0]));

    for precision in ["certified", "f32"] {
        let mut images = Vec::new();
        for backend in &available {
            let args =
                ["run", "a.cli", "--size", "100x80", "--precision", precision, "--backend", backend, "--stats=json"];
            let call = folder.command(&args).env("CLISC_BACKEND", "scalar").output().expect("a call").into();
            assert_code(&call, 0);
            assert_says(&call.stdout, &format!("\"backend\": \"{backend}\""));
            images.push(folder.bytes("a.png"));
        }
        assert!(images.iter().all(|image| *image == images[0]), "{precision}");
    }

    let with = |value: &str, args: &[&str]| -> support::Call {
        folder.command(args).env("CLISC_BACKEND", value).output().expect("a call").into()
    };
    assert_says(&with("scalar", &["run", "a.cli", "--stats"]).stdout, "\n  backend                 scalar\n");
    assert_says(&with("", &["run", "a.cli", "--stats"]).stdout, &format!("{:>14}\n", available[0]));
    assert_says(&with("scalar", &["--version"]).stdout, "in use: scalar");
    let wrong = with("sse", &["run", "a.cli"]);
    assert_code(&wrong, 2);
    assert_says(&wrong.stderr, "CLISC_BACKEND is `sse`, not auto, avx512, avx2 or scalar");
    assert_code(&with("sse", &["run", "a.cli", "--backend", "auto"]), 0);
    for missing in ["avx512", "avx2"].iter().filter(|name| !available.contains(name)) {
        for call in [folder.clisc(&["run", "a.cli", "--backend", missing]), with(missing, &["bench", "a.cli"])] {
            assert_code(&call, 2);
            assert_says(&call.stderr, &format!("this machine has no {missing}"));
            assert_says(&call.stderr, &format!("it has {}", available.join(", ")));
        }
    }
}

#[test]
fn two_scenes_of_one_file_are_refused_before_anything_is_rendered() {
    let folder = Folder::with_scene(&scene("x/same.png"));
    folder.put("b.cli", scene("./x//same.png"));
    folder.put("sub/a.cli", scene("x/same.png"));
    let before = folder.listing();
    for extra in [&[][..], &["--dry-run"]] {
        let call = folder.clisc(&[&["run", "a.cli", "b.cli", "--size", "4x4"], extra].concat());
        assert_code(&call, 2);
        assert_says(&call.stderr, "`a.cli` and `b.cli` both write `./x//same.png`");
        assert_says(&call.stderr, "--out-dir 'out/{scene}'");
        assert_eq!((call.stdout.as_str(), folder.listing()), ("", before.clone()));
    }
    // What is proposed does it.
    let call = folder.clisc(&["run", ".", "--size", "4x4", "-o", "img"]);
    assert_code(&call, 2);
    assert_says(&call.stderr, "--out-dir 'img/{folder}/{scene}'");
    assert_code(&folder.clisc(&["run", ".", "--size", "4x4", "--out-dir", "img/{folder}/{scene}"]), 0);
    for image in ["img/a/x/same.png", "img/b/x/same.png", "img/sub/a/x/same.png"] {
        assert_eq!(folder.image(image).width(), 4);
    }
    let call = folder.clisc(&["run", "a.cli", "a.cli", "./a.cli", "--size", "4x4"]);
    assert_eq!((call.code, call.stdout.lines().count(), call.stderr.as_str()), (Some(0), 1, ""));
}

#[test]
fn a_folder_means_every_scene_below_it() {
    let folder = Folder::new();
    folder.put("scenes/a.cli", scene("a.png"));
    folder.put("scenes/deep/b.cli", scene("b.png"));
    folder.put("scenes/deep/notes.txt", "x");
    folder.put("c.cli", scene("c.png"));
    let call = folder.clisc(&["run", "scenes", "c.cli", "--size", "4x4", "-o", "out"]);
    assert_code(&call, 0);
    let wrote: Vec<_> = call.stdout.lines().filter_map(|line| line.split(' ').nth(1)).collect();
    assert_eq!(wrote, ["out/a.png", "out/b.png", "out/c.png"]);
    fs::create_dir(folder.at("empty")).unwrap();
    let call = folder.clisc(&["run", "empty"]);
    assert_code(&call, 2);
    assert_says(&call.stderr, "there is no .cli file below `empty`");
}

#[test]
fn placeholders_that_stand_for_nothing_are_told_and_none_leads_out() {
    let folder = Folder::new();
    folder.put("out/x/...cli", scene("a.png"));
    let call = folder.clisc(&["run", "out/x/...cli", "-o", "{sceen}"]);
    assert_code(&call, 2);
    assert_says(&call.stderr, "`{sceen}` in --out-dir stands for nothing");
    assert_code(&folder.clisc(&["run", "out/x/...cli", "-o", "{folder}/y/{scene}", "--size", "4x4"]), 0);
    assert_eq!(folder.image("out/x/y/...cli/a.png").width(), 4);
    let other = Folder::new();
    let absolute = folder.at("out/x/...cli").display().to_string();
    assert_code(&other.clisc(&["run", &absolute, "-o", "new/{folder}", "--size", "4x4"]), 0);
    assert!(other.listing()[0].starts_with("new/"), "{:?}", other.listing());
}

#[test]
fn one_image_goes_to_a_file_or_to_standard_output() {
    let folder = Folder::with_scene(&scene("a.png"));
    folder.put("two.cli", scene("a.png") + "write b.png\n");
    assert_code(&folder.clisc(&["run", "a.cli", "--size", "4x4"]), 0);
    let expected = folder.bytes("a.png");
    let call = folder.clisc(&["run", "a.cli", "-o", "new/first.png", "--size", "4x4"]);
    assert_code(&call, 0);
    assert_says(&call.stdout, "wrote new/first.png (4x4, ");
    assert_eq!(folder.bytes("new/first.png"), expected);
    let output = folder.command(&["run", "a.cli", "-o", "-", "--size", "4x4", "--stats"]).output().unwrap();
    assert_eq!((output.status.code(), &output.stdout), (Some(0), &expected));
    assert_says(&String::from_utf8_lossy(&output.stderr), "wrote <stdout> (4x4, ");
    let call = folder.clisc(&["run", "a.cli", "-o", "{scene}-x.png", "--size", "4x4", "--dry-run"]);
    assert_eq!(call.stdout, "would write a-x.png (4x4)\n");
    for (out, shown) in [("-", "<stdout>"), ("x.png", "x.png")] {
        let call = folder.clisc(&["run", "two.cli", "-o", out]);
        assert_eq!((call.code, call.stdout.as_str()), (Some(2), ""));
        assert_says(&call.stderr, &format!("`two.cli` has 2 images, and `{shown}` is one"));
        assert_says(&call.stderr, "--out-dir out");
        let call = folder.clisc(&["run", "two.cli", "a.cli", "-o", out]);
        assert_eq!((call.code, call.stdout.as_str()), (Some(2), ""));
        assert_says(&call.stderr, &format!("`two.cli` and `a.cli` both write `{shown}`"));
    }
    // A folder that is called as an image is a folder.
    fs::create_dir(folder.at("dir.png")).unwrap();
    assert_code(&folder.clisc(&["run", "a.cli", "-o", "dir.png", "--size", "4x4"]), 0);
    assert_eq!(folder.bytes("dir.png/a.png"), expected);
    folder.put("a.cli", scene("../a.png"));
    assert_code(&folder.clisc(&["run", "a.cli", "-o", "x.png"]), 1);
}

/// One file says what counts, for every command.
#[test]
fn the_configuration_counts_as_for_check() {
    let folder = Folder::new();
    folder.put("sub/a.cli", scene("a.png").replace("fov 60\n", "") + "sphere 0 0 9 1\nwrite b.png\n");
    let scene = "sub/a.cli";
    let commands: [&[&str]; 4] = [
        &["run", scene, "--size", "4x4"],
        &["ir", scene],
        &["bench", scene, "--size", "4x4", "--repeat", "1"],
        &["check", scene],
    ];
    let calls = |config: &str| {
        folder.put("clisc.toml", config);
        commands.map(|args| folder.clisc(args))
    };
    for call in calls("") {
        assert_code(&call, 0);
        assert_says(&(call.stdout + &call.stderr), "warning[W0302]");
    }
    for call in calls("[lint.rules]\nno-fov = \"off\"\n") {
        assert_code(&call, 0);
        assert!(!(call.stdout + &call.stderr).contains("W0302"));
    }
    for rule in ["no-fov", "behind-eye"] {
        for path in ["a.png", "b.png"] {
            let _ = fs::remove_file(folder.at(path));
        }
        for call in calls(&format!("[lint.rules]\n{rule} = \"error\"\n")) {
            assert_code(&call, 1);
            assert_says(&(call.stdout + &call.stderr), if rule == "no-fov" { "error[W0302]" } else { "error[L0302]" });
        }
        assert!(!folder.at("a.png").exists());
    }
    for config in ["[lint.rules]\nno-fog = \"off\"\n", "[lint.rules]\nno-fov = \"off\"\nW0302 = \"error\"\n"] {
        for call in calls(config).into_iter().chain([folder.clisc(&["fmt", scene]), folder.clisc(&["lint", scene])]) {
            assert_code(&call, 2);
            assert_says(&call.stderr, "clisc.toml`: line ");
        }
    }
    let call = folder.clisc(commands[0]);
    assert_says(&call.stderr, "line 3, column 1: `W0302` is \"error\", and `no-fov` in line 2 is \"off\"");
}

/// What is black or empty says why, in `run` by its pixels and in `check` by proof.
#[test]
fn an_image_that_shows_less_than_its_scene_says_why() {
    let light = "fov 60\nlight 1 1 1 0 0 5\nsurface 0 0 0 .5 .5 .5 0 0 0 1 0\n";
    let folder = Folder::new();
    for (text, of_run, of_check) in [
        (
            "sphere 0 0 4 1\nwrite a.png\n",
            "every pixel of `a.png` is black: this `sphere` lies behind the eye (a.cli:4:1)",
            "`a.png` shows nothing but its background: this `sphere` lies behind the eye (a.cli:4:1)",
        ),
        (
            "write a.png\nsphere 0 0 -4 1\n",
            "every pixel of `a.png` is black: the objects stand behind its `write`",
            "`a.png` shows nothing but its background: the objects",
        ),
        (
            "background 1 0 0\nwrite a.png\n",
            "every pixel of `a.png` has the colour #ff0000: the scene has no object",
            "nothing but its background: the scene has no object",
        ),
        (
            "sphere 0 0 -4 1\nsphere 0 0 9 1\nwrite a.png\n",
            "an object cannot be seen in `a.png`: this `sphere` lies behind the eye (a.cli:5:1)",
            "an object cannot be seen in `a.png`: this `sphere`",
        ),
        (
            "sphere 0 0 -4 1\nsphere 0 0 9 1\nsphere 90 0 -1 1\nwrite a.png\n",
            "2 objects cannot be seen in `a.png`, as this `sphere` lies",
            "2 objects cannot be seen",
        ),
        (
            "sphere 0 0 -4 1  # clisc: allow(behind-eye)\nsphere 0 0 9 1  # clisc: allow(behind-eye)\nwrite a.png\n",
            "",
            "",
        ),
    ] {
        folder.put("a.cli", format!("{light}{text}"));
        for (command, words) in [(&["run", "a.cli", "--size", "20x20"][..], of_run), (&["check", "a.cli"], of_check)] {
            let call = folder.clisc(command);
            assert_code(&call, 0);
            let notes: Vec<_> = call.stderr.lines().filter(|line| line.starts_with("note: ")).collect();
            assert_eq!(notes.len(), usize::from(!words.is_empty()), "{text}: {}", call.stderr);
            assert_says(&call.stderr, words);
        }
        assert_eq!(folder.clisc(&["run", "a.cli", "--size", "20x20", "--quiet"]).stderr, "");
    }
    // Lights that light nothing.
    for (text, words) in [
        (
            "fov 60\nsurface 0 0 0 .5 .5 .5 0 0 0 1 0\nsphere 0 0 -4 1\nwrite a.png\n",
            "no `light`, though this `surface`",
        ),
        (
            "fov 60\nlight 1 1 1 0 0 -4\nsurface 0 0 0 .5 .5 .5 0 0 0 1 0\nsphere 0 0 -4 1\nwrite a.png\n",
            "this light stands inside a `sphere`",
        ),
    ] {
        folder.put("a.cli", text);
        let call = folder.clisc(&["run", "a.cli", "--size", "20x20"]);
        assert_says(&call.stderr, "every pixel of `a.png` is black: ");
        assert_says(&call.stderr, words);
    }
}

#[test]
fn usage_errors_explain_themselves() {
    let folder = Folder::with_scene(&scene("a.png"));
    for (args, words) in [
        (&["run"][..], "<PATH>"),
        (&["run", "a.cli", "--size", "70000x2"], "the width 70000 is beyond the limit of 65535"),
        (&["run", "a.cli", "--size", "300"], "such as 300x200"),
        (&["run", "a.cli", "--size", "0x1"], "the width is 0"),
        (&["run", "a.cli", "--samples", "0"], "a whole number from 1 to 256 is meant"),
        (&["run", "a.cli", "--samples", "257"], "a whole number from 1 to 256 is meant"),
        (&["run", "a.cli", "--threads", "1025"], "a whole number from 0 to 1024 is meant"),
        (&["run", "a.cli", "--part", "c"], "'c'"),
        (&["run", "a.cli", "--threads", "-1"], "-1"),
        (&["run", "a.cli", "--no-skip=shadow"], "a similar value exists: 'shadows'"),
        (&["run", "a.cli", "--wat"], "--wat"),
        (&["paint"], "paint"),
    ] {
        let call = folder.clisc(args);
        assert_code(&call, 2);
        assert_says(&call.stderr, words);
        assert_eq!(call.stdout, "");
    }
    assert_eq!(folder.listing(), ["a.cli"]);
}

#[test]
fn help_has_examples_for_each_subcommand() {
    let folder = Folder::new();
    for command in ["check", "run", "ir", "explain"] {
        let call = folder.clisc(&[command, "--help"]);
        assert_code(&call, 0);
        assert_says(&call.stdout, &format!("  clisc {command} "));
    }
}

#[test]
fn one_thread_and_many_save_the_same_bytes() {
    let folder = Folder::with_scene(&scene("a.png"));
    let files = ["1", "2", "3"].map(|n_threads| {
        assert_code(&folder.clisc(&["run", "a.cli", "--size", "1200x1000", "--threads", n_threads]), 0);
        folder.bytes("a.png")
    });
    assert!(files[0] == files[1] && files[1] == files[2]);
}

#[test]
fn the_widest_and_the_tallest_image_can_be_made() {
    let folder = Folder::with_scene("fov 60\nbackground 1 0 1\nwrite a.png\n");
    for (size, sides) in [("65535x2", (65535, 2)), ("2x65535", (2, 65535))] {
        assert_code(&folder.clisc(&["run", "a.cli", "--size", size]), 0);
        let image = folder.image("a.png");
        assert_eq!((image.width(), image.height()), sides);
        assert!(image.rgb().chunks(3).all(|pixel| pixel == [255, 0, 255]));
    }
}

#[test]
fn names_that_lead_out_are_refused_at_their_place() {
    for (name, code) in [
        ("/tmp/clisc-refused.png", "E0501"),
        ("\"C:\\clisc refused.png\"", "E0501"),
        ("\\\\server\\share\\a.png", "E0501"),
        ("../a.png", "E0502"),
        ("sub/../../a.png", "E0502"),
        ("sub\\..\\a.png", "E0502"),
        ("t:30.png", "E0501"),
    ] {
        let folder = Folder::new();
        folder.put("scenes/a.cli", format!("fov 60\nwrite good.png\nwrite {name}\n"));
        let call = folder.clisc(&["run", "scenes/a.cli", "-o", "out"]);
        assert_code(&call, 1);
        assert_says(&call.stderr, &format!("error[{code}]"));
        assert_says(&call.stderr, "scenes/a.cli:3:7");
        assert_eq!(call.stdout, "");
        assert_eq!(folder.listing(), ["scenes/", "scenes/a.cli"], "{name}");
    }
}

#[cfg(unix)]
#[test]
fn links_that_lead_out_are_refused() {
    use std::os::unix::fs::symlink;
    for (link, to, name) in [
        ("out/sub", "../elsewhere", "sub/a.png"),
        ("out/a.png", "../elsewhere/a.png", "a.png"),
        ("out/a.png", "../elsewhere/new.png", "a.png"),
        ("out/sub", "../missing", "sub/deep/a.png"),
    ] {
        let folder = Folder::with_scene(&format!("fov 60\n  write {name}\n"));
        folder.put("elsewhere/a.png", "precious");
        fs::create_dir(folder.at("out")).unwrap();
        symlink(to, folder.at(link)).unwrap();
        let before = folder.listing();
        for extra in [&[][..], &["--dry-run"]] {
            let call = folder.clisc(&[&["run", "a.cli", "-o", "out"], extra].concat());
            assert_code(&call, 1);
            assert_says(&call.stderr, "error[E0503]");
            assert_says(&call.stderr, "a.cli:2:9");
            assert_eq!(folder.listing(), before);
            assert_eq!(folder.bytes("elsewhere/a.png"), b"precious");
        }
    }
}

#[cfg(unix)]
#[test]
fn links_that_stay_inside_are_followed_and_kept() {
    use std::os::unix::fs::symlink;
    let folder = Folder::with_scene(&format!("{}write sub/b.png\n", scene("a.png")));
    folder.put("real/place/old.png", "old");
    symlink("real", folder.at("out")).unwrap();
    symlink("place/old.png", folder.at("real/a.png")).unwrap();
    symlink(folder.at("real/place"), folder.at("real/sub")).unwrap();
    assert_code(&folder.clisc(&["run", "a.cli", "-o", "out", "--size", "4x4"]), 0);
    assert!(fs::symlink_metadata(folder.at("real/a.png")).unwrap().is_symlink());
    assert_eq!(folder.image("real/place/old.png"), folder.image("real/place/b.png"));
}

#[test]
fn output_on_a_pipe_has_no_escapes() {
    let folder = Folder::with_scene("sphere\nwrite a.png\n");
    folder.put("b.cli", scene("b.png"));
    let call = folder.clisc(&["run", "a.cli", "b.cli", "--stats"]);
    assert!(!call.stderr.contains('\x1b') && !call.stdout.contains('\x1b'));
}

/// Calls the command on a terminal that `script` makes, both streams in one; `None` where there is no `script`.
#[cfg(target_os = "linux")]
fn on_a_terminal(folder: &Folder, args: &str, environment: (&str, &str)) -> Option<String> {
    let command = format!("{} {args}", env!("CARGO_BIN_EXE_clisc"));
    let mut script = std::process::Command::new("script");
    script
        .args(["-qec", &command, "/dev/null"])
        .current_dir(folder.at("."))
        .env("TERM", "xterm")
        .env_remove("NO_COLOR");
    let output = script.env(environment.0, environment.1).stdin(std::process::Stdio::null()).output();
    if output.is_err() {
        let _ = writeln!(std::io::stderr(), "\nSKIPPED: there is no `script` to make a terminal");
    }
    Some(String::from_utf8(output.ok()?.stdout).expect("text"))
}

#[cfg(target_os = "linux")]
#[test]
fn a_terminal_gets_colours_and_a_bar_for_what_takes_time() {
    let folder = Folder::with_scene(&scene("a.png"));
    folder.put("bad.cli", "sphere\n");
    let plain = ("CLISC_TEST", "1");
    let Some(short) = on_a_terminal(&folder, "run a.cli --size 20x20", plain) else { return };
    assert!(short.starts_with("wrote a.png"), "{short}");
    let long = on_a_terminal(&folder, "run a.cli --size 5000x5000 --samples 6 --threads 1", plain).unwrap();
    assert_says(&long, "a.png [==");
    assert_says(&long, "left");
    let quiet = on_a_terminal(&folder, "run a.cli --size 5000x5000 --threads 1 --quiet", plain).unwrap();
    assert_eq!(quiet, "");
    assert_says(&on_a_terminal(&folder, "run bad.cli", plain).unwrap(), "\x1b[");
    for no_color in [("NO_COLOR", "1"), ("TERM", "dumb")] {
        let bad = on_a_terminal(&folder, "run bad.cli", no_color).unwrap();
        assert!(bad.contains("error[E0203]") && !bad.contains('\x1b'), "{bad}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn an_image_is_not_printed_on_a_terminal() {
    let folder = Folder::with_scene(&scene("a.png"));
    let Some(shown) = on_a_terminal(&folder, "run a.cli -o - --size 4x4", ("CLISC_TEST", "1")) else { return };
    assert_says(&shown, "an image is nothing for a terminal");
    assert!(!shown.contains("PNG"), "{shown}");
}

#[test]
fn characters_that_do_not_show_are_no_part_of_a_name() {
    for name in ["a\u{200B}.png", "\"a\u{202E}gnp.png\"", "\"a\u{FEFF}b.png\""] {
        let folder = Folder::with_scene(&scene(name));
        for command in ["run", "check", "lint"] {
            for format in [&[][..], &["--format", "short"], &["--format", "github"]] {
                if command == "run" && !format.is_empty() {
                    continue;
                }
                let call = folder.clisc(&[&[command, "a.cli"], format].concat());
                assert_code(&call, 1);
                let said = call.stdout + &call.stderr;
                assert_says(&said, "E0504");
                assert_says(&said, "<U+");
                assert!(!said.contains(['\u{200B}', '\u{202E}', '\u{FEFF}']), "{said}");
            }
        }
        assert_eq!(folder.listing(), ["a.cli"]);
    }
    let folder = Folder::with_scene(&scene("t:30.png"));
    let call = folder.clisc(&["run", "a.cli"]);
    assert_says(&call.stderr, "the file name `t:30.png` starts with a drive of Windows");
    assert_says(&call.stderr, "write `t-30.png`");
    assert!(!call.stderr.contains("absolute"), "{}", call.stderr);
}
