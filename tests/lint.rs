//! What `lint` finds, what comments and options allow, and what its fixes do.

#[path = "support/tree.rs"]
mod tree;

use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::path::Path;

use clisc::diag::{Safety, codes};
use clisc::exec::{CancellationToken, MemorySink, Options as ExecOptions, execute};
use clisc::lint::{Level, Options, RULES, fix_all, lint, parse_config};
use clisc::plan::{Settings, Size};
use clisc::source::Source;
use clisc::testing::{Explanation, explanation};
use clisc::{compile, ir};
use proptest::prelude::*;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The options of a scene that is called `ball.cli`, as the examples are.
fn options() -> Options {
    Options::default().for_file(Some("ball".to_owned()))
}

/// Returns what `lint` finds, a line each: `line: code`.
fn found_with(text: &str, options: &Options) -> Vec<String> {
    let source = Source::new("ball.cli", text);
    let line = |start: u32| source.lines().position(source.text(), start).line;
    let found = lint(&source, options).diagnostics;
    found.iter().map(|found| format!("{}: {}", line(found.primary.span.start), found.code.id)).collect()
}

fn found(text: &str) -> Vec<String> {
    found_with(text, &options())
}

/// A scene in which nothing is found, with more lines before its `write`.
fn scene(more: &str) -> String {
    format!(
        "fov 60\nlight 1 1 1  0 0 5\nsurface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0\nsphere 0 0 -4  1\n{more}write ball.png\n"
    )
}

/// Returns all images of a scene, rendered small.
fn images(text: &str) -> Vec<(String, Vec<u8>)> {
    let compilation = compile(&Source::new("ball.cli", text));
    assert!(!compilation.has_errors(), "{text}\n{:#?}", compilation.diagnostics);
    let program = ir::validate(compilation.program).expect("a sound program");
    let settings = Settings { size: Size::new(60, 60).expect("a size"), ..Settings::default() };
    let mut sink = MemorySink::default();
    let options = ExecOptions { settings: &settings, observer: &(), cancellation: &CancellationToken::default() };
    execute(&program, options, &mut sink).expect("rendered to memory");
    sink.files.into_iter().collect()
}

#[test]
fn each_page_has_an_example_with_one_finding_and_one_without() {
    for rule in RULES {
        let Explanation { title, failing, repaired, needs_run } = explanation(&rule.code);
        assert_eq!(title, format!("{}: {}", rule.code.id, rule.code.title));
        assert!(!needs_run);
        let ids = |text: Vec<u8>| -> Vec<&str> {
            let found = lint(&Source::from_bytes("ball.cli", text).expect("a small scene"), &options()).diagnostics;
            found.iter().map(|found| found.code.id).collect()
        };
        assert_eq!(ids(failing), [rule.code.id], "the example of {:?}", rule.code.name);
        assert_eq!(ids(repaired), [""; 0], "what stands instead for {:?}", rule.code.name);
        for section in ["## Why", "## Example", "## Instead", "## Fix safety", "## Limits"] {
            assert!(rule.code.page().contains(&format!("\n{section}\n")), "{:?} lacks {section}", rule.code.name);
        }
    }
}

#[test]
fn rules_files_and_docs_agree() {
    let names: BTreeSet<_> = RULES.iter().map(|rule| rule.code.name.expect("a name").replace('-', "_")).collect();
    assert_eq!(names.len(), RULES.len(), "each name once");
    assert!(RULES.is_sorted_by_key(|rule| rule.code.id));
    let shared = ["mod", "settings", "cylinders"];
    let files = tree::files_below(&root().join("src/lint/rules"));
    let files = files.iter().map(|path| path.file_stem().and_then(|stem| stem.to_str()).expect("a name").to_owned());
    assert_eq!(files.filter(|name| !shared.contains(&name.as_str())).collect::<BTreeSet<_>>(), names);
    let page = fs::read_to_string(root().join("docs/lint.md")).expect("docs/lint.md");
    for code in clisc::lint::all_codes().filter(|code| code.name.is_some()) {
        let row = format!("| {} | `{}` | {} |", code.id, code.name.expect("a name"), code.title);
        assert!(page.contains(&row), "docs/lint.md lacks the row {row}");
    }
}

#[test]
fn safe_fixes_leave_every_image_as_it_is() {
    let failing = RULES.iter().map(|rule| (rule.fix, rule.code.id, explanation(&rule.code).failing));
    for (fix, id, text) in failing {
        let source = Source::from_bytes("ball.cli", text).expect("a small scene");
        let fixed = fix_all(&source, &options());
        let has_fix = lint(&source, &options()).diagnostics[0].fixes.first().map(|fix| fix.safety);
        assert!(has_fix.is_none() || has_fix == fix, "{id} offers {has_fix:?}, its table says {fix:?}");
        if fix == Some(Safety::Safe) {
            assert_eq!(found(&fixed.text), [""; 0], "{id} is not mended: {}", fixed.text);
            assert_eq!(images(&fixed.text), images(source.text()), "{id} changes an image: {}", fixed.text);
        } else {
            assert_eq!(fixed.text, source.text(), "{id}");
        }
    }
}

#[test]
fn fixes_are_carried_out_until_nothing_is_left() {
    let text = scene(
        "surface 1 0 0  0 0 0  0 0 0  1  0\nsurface 1 0 0  0 0 0  0 0 0  1  0 # why\nsurface 1 0 0  0 0 0  0 0 0  1  0\n\
         light 0 0 0  9 9 9\nsphere 0 0 -4 1\nsphere 0 0 -4 0.5 # inside\nbackground 0 0 1\nbackground 0 0 0\n",
    )
    .replacen("fov 60\n", "", 1);
    let source = Source::new("ball.cli", text.as_str());
    let fixed = fix_all(&source, &options());
    assert_eq!(found(&fixed.text), [""; 0], "{}", fixed.text);
    assert_eq!(images(&fixed.text), images(&text), "{}", fixed.text);
    assert!(fixed.text.contains("# why") && fixed.text.contains("# inside"), "comments stay: {}", fixed.text);
    assert_eq!(fix_all(&Source::new("ball.cli", fixed.text.as_str()), &options()).n_fixes, 0);
}

/// Lines that often repeat, hide or replace each other, and some that are wrong.
fn any_line() -> impl Strategy<Value = String> {
    let color = || prop::sample::select(vec!["0 0 0", "1 1 1", "0.5 0.2 0.1"]);
    let place = || prop::sample::select(vec!["0 0 -4", "1 0.5 -5", "0 2 3", "30 0 -4", "0 0 5"]);
    let radius = || prop::sample::select(vec!["1", "0.5", "0.001", "6"]);
    let comment = prop::sample::select(vec!["", "", "", " # why", "  # clisc: allow(hidden-copy)"]);
    let line = prop_oneof![
        2 => prop::sample::select(vec!["fov 60", "fov 90", "# alone", "", "write ball-2.png"]).prop_map(str::to_owned),
        1 => color().prop_map(|color| format!("background {color}")),
        2 => (color(), place()).prop_map(|(color, place)| format!("light {color}  {place}")),
        3 => (color(), color(), prop::sample::select(vec!["0", "0.5"]))
            .prop_map(|(ambient, diffuse, mirror)| format!("surface {ambient}  {diffuse}  0 0 0  1  {mirror}")),
        4 => (place(), radius()).prop_map(|(place, radius)| format!("sphere {place}  {radius}")),
        3 => (radius(), prop::sample::select(vec!["0 -4", "1 -5"]), prop::sample::select(vec!["-1 1", "0 1", "-1 0"]))
            .prop_map(|(radius, axis, heights)| format!("cylinder {radius}  {axis}  {heights}")),
    ];
    (line, comment).prop_map(|(line, comment)| line + comment)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn fixes_keep_every_image_of_any_scene(lines in prop::collection::vec(any_line(), 0..14), has_crlf in any::<bool>()) {
        let text = format!("surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0\n{}\nwrite ball.png", lines.join("\n"));
        let text = if has_crlf { text.replace('\n', "\r\n") } else { text };
        let fixed = fix_all(&Source::new("ball.cli", text.as_str()), &options()).text;
        prop_assert_eq!(images(&fixed), images(&text), "{}", fixed);
        let left = lint(&Source::new("ball.cli", fixed.as_str()), &options()).diagnostics;
        let is_safe = |fix: &clisc::diag::Fix| fix.safety == Safety::Safe;
        prop_assert!(!left.iter().any(|found| found.fixes.first().is_some_and(is_safe)), "{:#?}", left);
        let comments = |text: &str| text.matches("# why").count() + text.matches("# alone").count();
        prop_assert_eq!(comments(&fixed), comments(&text), "{}", fixed);
    }
}

#[test]
fn nothing_is_fixed_over_an_error() {
    let text = scene("light 0 0 0  1 1 1\nsphere x\n");
    assert_eq!(fix_all(&Source::new("ball.cli", text.as_str()), &options()).text, text);
    assert_eq!(found(&text), ["5: L0201", "6: E0203"].map(String::from).map(|found| found.replace("E0203", "E0205")));
}

/// Tells whether a fix of some finding of a scene is offered as safe.
fn has_safe_fix(text: &str) -> bool {
    let found = lint(&Source::new("ball.cli", text), &options()).diagnostics;
    assert!(!found.is_empty(), "{text}");
    found.iter().flat_map(|found| &found.fixes).any(|fix| fix.safety == Safety::Safe)
}

/// While a `write` is typed or misspelt, what only it would show is not removed; nor is anything else while a line is wrong.
#[test]
fn no_rule_has_a_safe_fix_while_the_scene_has_an_error() {
    for write in
        ["write", "write ", "writ a.png", "write a.jp", "wirte a.png", "save a.png", "foo", "write \"a", "write a b"]
    {
        for object in ["sphere 0 0 -4 0.5", "sphere 0 0 -4 1", "cylinder 0.1 0 -4 -.1 .1"] {
            let text = scene(&format!("{write}\n")).replace("sphere 0 0 -4  1\n", &format!("{object}\n"));
            let text =
                text.replace("write ball.png", "sphere 0 0 -4 1\nsphere 0 0 -4 5\nsphere 0 0 -4 5\nwrite ball.png");
            let hidden = found(&text).into_iter().filter(|found| found.contains("L03")).collect::<Vec<_>>();
            assert_eq!(hidden, [""; 0], "{text}");
            assert!(!has_safe_fix(&text), "{text}");
            assert_eq!(fix_all(&Source::new("ball.cli", text.as_str()), &options()).n_fixes, 0);
        }
    }
    for error in ["sphere x\n", "fov 0\n", "light 1 1 1 1 1\n"] {
        for idle in [
            "light 0 0 0  9 9 9\n",
            "sphere 0 0 -4 0.5\n",
            "sphere 0 0 -4 1\n",
            "fov 50\nfov 60\n",
            "# clisc: allow(x)\n",
        ] {
            assert!(has_safe_fix(&scene(idle)), "{idle}");
            assert!(!has_safe_fix(&scene(&(idle.to_owned() + error))), "{idle}{error}");
        }
    }
    assert!(!has_safe_fix("light 1 1 1 0 0 5\nsphere x\nwrite ball.png\n"), "`fov 60` at the top");
}

/// A line that is whole in another order as well is not removed without a word.
#[test]
fn a_black_light_that_could_be_white_is_left_to_people() {
    for (light, is_safe) in [
        ("light 0 0 0  1 1 1", false),
        ("light 0 0 0  0.5 0.2 0", false),
        ("light 0 0 0  0 0 0", true),
        ("light 0 0 0  5 5 5", true),
        ("light 0 0 0  0 -1 0", true),
    ] {
        let text = scene(&format!("{light}\n"));
        assert_eq!(found(&text), ["5: L0201"]);
        assert_eq!(has_safe_fix(&text), is_safe, "{light}");
    }
    let suspected = "light 0 5 -2  1 1 1\nfov 60\nsurface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0\nwrite ball.png\n";
    assert_eq!(found(suspected), ["1: W0308", "3: L0101"]);
    assert!(!has_safe_fix(suspected));
    let allowed = format!("# clisc: allow(other-edition)\n{suspected}");
    assert_eq!(found(&allowed), ["4: L0101"], "who allows it says that the light is as it should be");
    let mut compilation = compile(&Source::new("ball.cli", allowed.as_str()));
    clisc::lint::leave_out_allowed(&Source::new("ball.cli", allowed.as_str()), &options(), &mut compilation);
    assert_eq!(compilation.diagnostics, [], "`run` says the same");
}

#[test]
fn a_scene_of_another_edition_is_not_linted() {
    let text = "light 0 0 0  1 1 1\nsurface 0.8 0.2 0.2  0.1 0 0  0 0 0  1  0\nsphere 1  0 0 -4\nsphere 1  0 0 -4\n\
        surface 0.8 0.2 0.2  0.1 0 0  0 0 0  1  0\nwrite cube.png # clisc: allow(no-fov)\n";
    assert_eq!(found(text), ["3: E0302"]);
    assert!(!has_safe_fix(text));
    assert_eq!(clisc::lint::check(&Source::new("ball.cli", text), &options()).diagnostics.len(), 1);
    assert_eq!(clisc::format::format(&Source::new("ball.cli", text)), text.as_bytes(), "nor formatted");
}

/// The original scenes have repeated surfaces and nothing else; those of other years are turned into 2018's as far as their
/// spheres go, which is enough to see what surfaces look like.
#[test]
fn the_original_scenes_are_not_too_bright() {
    let folder = root().join("../shared/course");
    if !folder.is_dir() {
        let _ = writeln!(std::io::stderr(), "\nSKIPPED: the original scenes are not at {}", folder.display());
        return;
    }
    let mut n_scenes = 0;
    for path in
        tree::files_below(&folder).into_iter().filter(|path| path.extension().is_some_and(|ending| ending == "cli"))
    {
        let text = fs::read_to_string(&path).expect("a scene");
        let is_ours = path.parent().is_some_and(|folder| folder.ends_with("2018"));
        let text = if is_ours { text } else { turned_into_2018(&text) };
        let stem = path.file_stem().and_then(|stem| stem.to_str()).map(str::to_owned);
        let found = lint(&Source::new("a.cli", text.as_str()), &Options::default().for_file(stem)).diagnostics;
        let wrong: Vec<_> = found
            .iter()
            .filter(|found| {
                matches!(found.code.id, "L0401" | "L0501" | "W0307" | "W0308" | "W0309") || found.is_error()
            })
            .collect();
        assert!(wrong.is_empty(), "{}: {wrong:#?}\n{text}", path.display());
        assert!(!is_ours || found.iter().all(|found| found.code.id == "L0102"), "{}", path.display());
        n_scenes += 1;
    }
    assert_eq!(n_scenes, 62);
}

/// Puts numbers into the order of 2018, moves spheres before the eye, and leaves out what 2018 lacks.
fn turned_into_2018(text: &str) -> String {
    let eye_of = |line: &str| {
        line.strip_prefix("eye ")
            .map(|at| at.split_whitespace().map(|x| x.parse::<f64>().expect("a number")).collect::<Vec<_>>())
    };
    let eye = text.lines().find_map(eye_of).unwrap_or(vec![0.0; 3]);
    let moved = |place: &[&str]| {
        let place = place.iter().zip(&eye).map(|(x, eye)| (x.parse::<f64>().expect("a number") - eye).to_string());
        place.collect::<Vec<_>>().join(" ")
    };
    let lines = text.lines().filter_map(|line| {
        let words: Vec<_> = line.split('#').next().unwrap_or_default().split_whitespace().collect();
        match words[..] {
            ["light", _, _, _, r, g, b] => Some(format!("light {r} {g} {b} {}", moved(&words[1..4]))),
            ["surface", a, b, c, d, e, f, ..] => {
                Some(format!("surface {d} {e} {f} {a} {b} {c} {}", words[7..].join(" ")))
            }
            ["sphere", radius, ..] => Some(format!("sphere {} {radius}", moved(&words[2..]))),
            ["fov" | "background" | "write", ..] => Some(line.to_owned()),
            _ => None,
        }
    });
    lines.map(|line| line + "\n").collect()
}

#[test]
fn only_what_loses_its_shape_is_too_bright() {
    let with = |surface: &str| {
        scene("")
            .replace("0.1 0 0  0.8 0.2 0.2  0 0 0  1  0", surface)
            .replace("light 1 1 1  0 0 5", "light 1 1 1  0 0 5\nlight 1 1 1  3 4 5")
    };
    for (surface, is_found) in [
        ("0.5 0.5 0.5  0.9 0.9 0.9  0 0 0  1  0", true),
        ("0.4 0 0  0.9 0 0  0 0 0  1  0", true),
        // Highlights, mirrors and a second light are as they should be.
        ("0.2 0.2 0.2  0.6 0.6 0.6  0.7 0.7 0.7  20  0.7", false),
        ("0.2 0.2 0.2  0.8 0.8 0.8  0.9 0.9 0.9  5  0.9", false),
        ("0.1 0.1 0.1  0.9 0.9 0.9  0.5 0.5 0.5  50  0", false),
        ("1 1 1  0 0 0  0 0 0  1  0", false),
    ] {
        let expected: &[&str] = if is_found { &["4: L0401"] } else { &[] };
        assert_eq!(found(&with(surface)), expected, "{surface}");
    }
}

#[test]
fn numbered_names_are_like_numbered_files() {
    let named = |file: &str, image: &str| {
        let options = Options::default().for_file(Some(file.to_owned()));
        found_with(&scene("").replace("ball.png", image), &options).is_empty()
    };
    for (file, image) in [
        ("01_one_sphere", "p01.png"),
        ("10_reflections", "p10.png"),
        ("01", "p1.png"),
        ("i1", "i1_partA.png"),
        ("i1_mine", "i1_partA.png"),
        ("scene3", "out/scene_03-big.png"),
        ("p05", "5.png"),
    ] {
        assert!(named(file, image), "{image} in {file}.cli");
    }
    for (file, image) in [
        ("01_one_sphere", "p02.png"),
        ("i1", "i10.png"),
        ("i10", "i1.png"),
        ("cube1", "ball1.png"),
        ("ball", "p01.png"),
    ] {
        assert!(!named(file, image) || image.starts_with(file), "{image} in {file}.cli");
    }
}

#[test]
fn one_cause_is_one_finding() {
    for (more, expected) in [
        // Settings.
        ("surface 0 0 0  1 1 1  0 0 0  1  0\n", vec!["5: L0101"]),
        ("surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0\n", vec!["5: L0102"]),
        ("surface 0 0 0  1 0 1  0 0 0  1  0\nsurface 0 0 0  1 0 0  0 0 0  1  0\nsphere 1 0 -4 1\n", vec!["5: L0103"]),
        ("fov 60\n", vec!["5: L0102"]),
        ("fov 50\n", vec!["1: L0103"]),
        ("background 0 0 1\nbackground 0 1 1\n", vec!["5: L0103"]),
        ("background 0 0 1\nbackground 0 0 1\n", vec!["6: L0102"]),
        ("write ball-1.png\nfov 50\n", vec![]),
        // Lights.
        ("light 0 0 0  9 9 9\n", vec!["5: L0201"]),
        ("light 1 1 1  0 0 -4\n", vec!["5: L0203"]),
        ("light 0 5 -2  1 1 1\n", vec!["5: W0307"]),
        ("light 255 255 255  1 1 1\n", vec!["5: W0303"]),
        ("light 3 3 3  0 0 1\n", vec!["5: W0303"]),
        ("light 3 4 5  1 0.5 1\n", vec!["5: W0307"]),
        // Objects.
        ("sphere 90 0 -4 1\n", vec!["5: L0301"]),
        ("cylinder 1  50 -4  0 1\n", vec!["5: L0301"]),
        ("sphere 0 2 9 1\n", vec!["5: L0302"]),
        ("sphere 0.2 0 -4 0.3\n", vec!["5: L0303"]),
        ("sphere 0 0 -4 1\n", vec!["5: L0304"]),
        ("cylinder 1  3 -9  0 1\ncylinder 1  3 -9  0 1\n", vec!["6: L0304"]),
        ("sphere 1 1 -4 0.001\n", vec!["5: L0305"]),
        ("sphere 0 0 -3006 3000\n", vec![]),
        ("sphere 0 0 -3001.5 3000\n", vec!["5: L0306"]),
        ("sphere 0 0 1 9\n", vec!["5: L0307"]),
        ("cylinder 1  3 -9  0 1\ncylinder 0.5  3 -9  0 2\n", vec!["6: L0308"]),
        ("cylinder 1  3 -9  0 1\ncylinder 1.1  3.5 -9  0 1\n", vec!["6: L0308"]),
        ("cylinder 1  3 -9  0 1\ncylinder 1  3 -9  0.5 2\n", vec!["6: L0309"]),
        ("cylinder 1  3 -9  0 1\ncylinder 1  3 -9  1 2\n", vec![]),
        ("sphere 1 0 0 -4\n", vec!["5: E0402"]),
        // Behind the last `write` one finding says it all.
        ("write ball-1.png\nlight 0 0 0 1 1 1\nsphere 0 0 -4 1\n", vec!["6: L0201", "7: L0304"]),
    ] {
        assert_eq!(found(&scene(more)), expected, "{more}");
    }
    let early =
        "fov 60\nlight 1 1 1  0 0 5\nsurface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0\nwrite ball.png\nsphere 0 0 -4 1\n";
    assert_eq!(found(early), ["5: W0305"]);
    let late =
        "fov 60\nlight 1 1 1  0 0 5\nsphere 0 0 -4 1\nsurface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0\nwrite ball.png\n";
    assert_eq!(found(late), ["3: E0301"]);
    let behind = scene("") + "surface 1 1 1  0 0 0  0 0 0  1  0\nsphere 0 0 9 1\nlight 0 0 0  0 0 0\n";
    assert_eq!(found(&behind), ["6: W0305"]);
    assert_eq!(
        found("fov 60\nsurface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0\nsphere 0 0 -4 1\nwrite ball.png\n"),
        ["2: L0202"]
    );
    assert_eq!(found(&scene("").replace("ball.png", "cube.png")), ["5: L0501"]);
    assert_eq!(found(&scene("").replace("ball.png", "out/Ball-2.png")), [""; 0]);
}

#[test]
fn what_mirrors_and_shadows_show_is_needed() {
    let mirror = "surface 0 0 0  0 0 0  0 0 0  1  0.9\nsphere 0 -2 -4 1\n";
    assert_eq!(
        found(&scene(&format!("{mirror}sphere 0 2 9 1\n"))),
        [""; 0],
        "a mirror may show what is behind the eye"
    );
    assert_eq!(found(&scene("sphere 0 0 3 0.5\n")), [""; 0], "it throws its shadow on the ball");
}

#[test]
fn comments_allow_what_is_behind_and_below_them() {
    let dark = "light 0 0 0  9 9 9";
    for (more, expected) in [
        (format!("{dark} # clisc: allow(dark-light)\n"), vec![]),
        (format!("# clisc: allow(dark-light)\n{dark}\n"), vec![]),
        (format!("# clisc: allow( L0201 , no-fov )\n\n# more\n{dark}\n"), vec!["5: L0901"]),
        (format!("#clisc:allow(dark-light)\n{dark}\n{dark}\n"), vec!["7: L0201"]),
        (format!("{dark}\n# clisc: allow(dark-light)\n"), vec!["5: L0201", "6: L0901"]),
        (format!("# clisc: allow(dark-lihgt)\n{dark}\n"), vec!["5: L0901", "6: L0201"]),
        ("# clisc: allow(E0203)\n".to_owned(), vec!["5: L0901"]),
        ("# clisc: alow(dark-light)\n".to_owned(), vec!["5: L0901"]),
        ("# clisc: allow(unused-allow)\n# clisc: allow(dark-light)\n".to_owned(), vec!["6: L0901"]),
        ("sphere x # clisc: allow(dark-light)\n".to_owned(), vec!["5: E0205"]),
        ("# clisc: off\n# clisc: on\n".to_owned(), vec![]),
    ] {
        assert_eq!(found(&scene(&more)), expected, "{more}");
    }
    let without_fov = "light 1 1 1  0 0 5\nsurface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0\nsphere 0 0 -4  1\n";
    let allowed = format!("{without_fov}write ball.png # clisc: allow(no-fov)\n");
    assert_eq!(found(&allowed), [""; 0]);
    let source = Source::new("ball.cli", allowed);
    assert_eq!(clisc::lint::check(&source, &Options::default()).diagnostics, [], "`check` honours it too");
}

#[test]
fn what_allows_nothing_is_removed() {
    for (before, after) in [
        ("sphere 1 0 -4 1 # clisc: allow(no-fov)\n", "sphere 1 0 -4 1\n"),
        ("# clisc: allow(no-fov)\nsphere 1 0 -4 1\n", "sphere 1 0 -4 1\n"),
        ("light 0 0 0  1 1 1 # clisc: allow(no-fov, dark-light)\n", "light 0 0 0  1 1 1 # clisc: allow(dark-light)\n"),
        ("light 0 0 0  1 1 1 # clisc: allow(dark-light, no-fov)\n", "light 0 0 0  1 1 1 # clisc: allow(dark-light)\n"),
    ] {
        assert_eq!(fix_all(&Source::new("ball.cli", scene(before)), &options()).text, scene(after));
    }
}

#[test]
fn options_choose_rules_and_levels() {
    let text = scene("light 0 0 0  1 1 1\nsphere 90 0 -4 1\n");
    assert_eq!(found(&text), ["5: L0201", "6: L0301"]);
    let mut selected = options();
    selected.select(&["dark-light".to_owned()]).expect("a rule");
    assert_eq!(found_with(&text, &selected), ["5: L0201"]);
    let mut ignored = options();
    ignored.ignore(&["L0201".to_owned()]).expect("a rule");
    assert_eq!(found_with(&text, &ignored), ["6: L0301"]);
    assert!(options().ignore(&["E0203".to_owned()]).is_err() && options().select(&["x".to_owned()]).is_err());
    let strict = parse_config("[lint.rules]\ndark-light = \"error\"\nno-write = \"off\"\n").expect("sound");
    assert_eq!(strict.level(&codes::NO_WRITE), Level::Off);
    let compilation = lint(&Source::new("ball.cli", text), &strict);
    assert_eq!((compilation.n_errors, compilation.n_warnings), (1, 1));
}

#[test]
fn wider_images_show_more() {
    let text = scene("sphere 4 0 -4 1\n");
    assert_eq!(found(&text), ["5: L0301"]);
    let wide = parse_config("[lint]\nsize = \"900x300\"\n").expect("sound");
    assert_eq!(found_with(&text, &wide), [""; 0]);
}

/// Scenes below a folder are linted with the `clisc.toml` that lies in theirs.
#[test]
fn the_scenes_of_the_project_are_clean() {
    let mut faults = Vec::new();
    for path in tree::files_below(&root().join("scenes")) {
        let is_scene = path.extension().is_some_and(|ending| ending == "cli");
        if !is_scene || path.starts_with(root().join("scenes/invalid")) {
            continue;
        }
        let folder = path.parent().expect("a folder");
        let config = fs::read_to_string(folder.join("clisc.toml")).unwrap_or_default();
        let stem = path.file_stem().and_then(|stem| stem.to_str()).map(str::to_owned);
        let options = parse_config(&config).expect("a sound configuration").for_file(stem);
        let source = Source::new(path.display().to_string(), fs::read_to_string(&path).expect("a scene"));
        for found in lint(&source, &options).diagnostics {
            let place = source.lines().position(source.text(), found.primary.span.start);
            faults.push(format!("{}:{}: {}: {}", path.display(), place.line, found.code.label(), found.message));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
