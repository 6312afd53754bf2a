//! From text to diagnostics and dumps: the language wing as its users see it.

mod support;

#[path = "support/tree.rs"]
mod tree;

use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use clisc::diag::render::{Color, render_human, render_json, render_short};
use clisc::diag::{Diagnostic, Severity, codes, fix};
use clisc::source::Source;
use clisc::syntax::spec::COMMANDS;
use clisc::syntax::{dump_ast, dump_ast_json, dump_tokens, dump_tokens_json, lex, parse};
use clisc::testing::{
    Explanation, Stream, assert_compiles_soundly, assert_draws_soundly, assert_parses_soundly, assert_tokens_tile,
    assert_ways_agree, explanation,
};
use clisc::{MAX_LISTED, compile, ir};
use proptest::prelude::*;

use crate::support::carets;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the `.cli` files below a folder, sorted. Any other file is a failure, so that none is skipped in silence.
fn scenes_below(folder: &Path) -> Vec<PathBuf> {
    let scenes = tree::files_below(folder);
    for path in &scenes {
        assert!(path.extension().is_some_and(|ending| ending == "cli"), "{} is no fixture", path.display());
    }
    scenes
}

fn read(path: &Path) -> Source {
    let name = path.strip_prefix(root()).expect("a path of the project").display().to_string();
    Source::from_bytes(name, fs::read(path).expect("a readable scene")).expect("a small scene")
}

/// Returns the codes that a scene raises, in order.
fn check(bytes: impl Into<Vec<u8>>) -> Vec<&'static str> {
    let source = Source::from_bytes("test.cli", bytes.into()).expect("a small scene");
    compile(&source).diagnostics.iter().map(|diagnostic| diagnostic.code.id).collect()
}

/// Returns what a scene raises, a line each: `line:column: code`.
fn check_places(bytes: impl Into<Vec<u8>>) -> String {
    let source = Source::from_bytes("test.cli", bytes.into()).expect("a small scene");
    let places = compile(&source).diagnostics;
    let places = places.iter().map(|diagnostic| {
        let place = source.lines().position(source.text(), diagnostic.primary.span.start);
        format!("{}:{}: {}", place.line, place.column, diagnostic.code.id)
    });
    places.collect::<Vec<_>>().join("\n")
}

/// A scene with nothing wrong, to put a line into.
fn around(line: &str) -> String {
    format!("fov 60\nlight 1 1 1 0 0 5\nsurface 0 .2 0 .4 .1 .1 0 0 0 1 0\n{line}\nsphere 0 0 -4 1\nwrite a.png\n")
}

#[test]
fn fixtures_raise_what_their_comments_say() {
    let bless = std::env::var_os("CLISC_BLESS").is_some();
    let scenes = scenes_below(&root().join("tests/fixtures"));
    assert!(scenes.len() > 20);
    for path in scenes {
        let source = read(&path);
        let annotated = carets::annotate(&source, &compile(&source).diagnostics);
        if bless {
            fs::write(&path, &annotated).expect("a blessed fixture");
        } else {
            similar_asserts(&path, source.text(), &annotated);
        }
    }
}

/// Fails with the first line that differs.
fn similar_asserts(path: &Path, expected: &str, actual: &str) {
    let (mut expected, mut actual) = (expected.lines(), actual.lines());
    for number in 1.. {
        let (expected, actual) = (expected.next(), actual.next());
        let place = format!("{}:{number} (CLISC_BLESS=1 rewrites it)", path.display());
        assert_eq!(actual, expected, "{place}");
        if actual.is_none() {
            return;
        }
    }
}

#[test]
fn twenty_mistakes_give_twenty_diagnostics_in_order() {
    let source = read(&root().join("tests/fixtures/whole/twenty_mistakes.cli"));
    let found = compile(&source).diagnostics;
    assert_eq!(found.len(), 20, "{found:#?}");
    assert!(found.is_sorted_by_key(|diagnostic| diagnostic.primary.span.start));
    let lines: BTreeSet<_> = found.iter().map(|found| source.lines().line_of(found.primary.span.start)).collect();
    assert_eq!(lines.len(), 20, "each on a line of its own");
}

#[test]
fn each_page_of_explain_has_a_scene_that_fails_and_its_repair() {
    for code in codes::ALL {
        let Explanation { title, failing, repaired, needs_run } = explanation(code);
        assert_eq!(title, format!("{}: {}", code.id, code.title));
        let expected: &[&str] = if needs_run { &[] } else { &[code.id] };
        assert_eq!(check(failing), expected, "the failing scene of {}", code.id);
        assert_eq!(check(repaired), [""; 0], "the repaired scene of {}", code.id);
    }
}

#[test]
fn each_fix_mends_what_it_is_offered_for() {
    let mut n_fixes = 0;
    for path in
        scenes_below(&root().join("tests/fixtures")).into_iter().chain(scenes_below(&root().join("scenes/invalid")))
    {
        let source = read(&path);
        let found = compile(&source).diagnostics;
        for diagnostic in &found {
            for offered in &diagnostic.fixes {
                let fixed = fix::apply(source.text(), [offered]);
                assert_eq!(fixed.is_applied, [true]);
                let left = compile(&Source::new("fixed.cli", fixed.text.as_str())).diagnostics;
                let n_like_it =
                    |found: &[Diagnostic]| found.iter().filter(|other| other.code == diagnostic.code).count();
                let n_errors = |found: &[Diagnostic]| found.iter().filter(|other| other.is_error()).count();
                let is_mended = n_like_it(&left) < n_like_it(&found) && n_errors(&left) <= n_errors(&found);
                let (id, title) = (diagnostic.code.id, &offered.title);
                assert!(is_mended, "{}: {id}, {title} leads to\n{}", path.display(), fixed.text);
                n_fixes += 1;
            }
        }
    }
    assert!(n_fixes > 50, "{n_fixes} fixes");
}

#[test]
fn table_of_codes_and_folder_of_pages_agree() {
    let pages = fs::read_dir(root().join("src/diag/explain")).expect("the folder of pages");
    let pages: BTreeSet<_> =
        pages.map(|page| page.expect("a page").file_name().into_string().expect("a name")).collect();
    let codes: BTreeSet<_> = codes::ALL.iter().map(|code| format!("{}.md", code.id)).collect();
    assert_eq!(pages, codes);
}

#[test]
fn the_page_of_missing_arguments_shows_every_command() {
    let page: String = codes::MISSING_ARGUMENT.explanation.split_whitespace().collect::<Vec<_>>().join(" ");
    for command in clisc::syntax::spec::COMMANDS.iter().filter(|command| !command.numbers().is_empty()) {
        assert!(page.contains(&command.usage()), "{}", command.usage());
    }
}

#[test]
fn examples_of_the_command_table_are_scenes() {
    for command in &clisc::syntax::spec::COMMANDS {
        let source = Source::new("test.cli", command.example);
        let parse = parse(&source);
        assert_eq!(parse.diagnostics, []);
        assert_eq!(parse.file.counts()[command.kind as usize], 1);
    }
}

#[test]
fn invalid_scenes_raise_the_code_in_their_name() {
    let mut unseen: BTreeSet<_> = codes::ALL.iter().map(|code| code.id).collect();
    for path in scenes_below(&root().join("scenes/invalid")) {
        let name = path.file_stem().and_then(|stem| stem.to_str()).expect("a name");
        let id = name.split('-').next().expect("a code");
        let code = codes::find(id).unwrap_or_else(|| panic!("{name} begins with no code"));
        let expected: &[&str] = if explanation(code).needs_run { &[] } else { &[code.id] };
        assert_eq!(check(fs::read(&path).expect("a readable scene")), expected, "{name}");
        unseen.remove(code.id);
    }
    assert!(unseen.is_empty(), "no scene for {unseen:?}");
}

/// Returns the folder of the original scenes, where there is one.
fn originals() -> Option<PathBuf> {
    let folder = root().join("../shared/course");
    if !folder.is_dir() {
        let _ = writeln!(std::io::stderr(), "\nSKIPPED: the original scenes are not at {}", folder.display());
        return None;
    }
    Some(folder)
}

/// Returns the message of each finding of a scene.
fn messages(text: &str) -> Vec<String> {
    compile(&Source::new("test.cli", text)).diagnostics.into_iter().map(|found| found.message).collect()
}

#[test]
fn each_original_scene_is_recognised_as_of_its_year() {
    let Some(folder) = originals() else { return };
    for (year, n_scenes, editions) in [
        ("2014", 10, "2014 or 2017"),
        ("2017", 10, "2014 or 2017"),
        ("2018", 10, ""),
        ("2019", 10, "2019"),
        ("2020", 11, "2020"),
        ("2022", 11, "2022"),
    ] {
        let mut scenes = tree::files_below(&folder.join(year));
        scenes.retain(|path| path.extension().is_some_and(|ending| ending == "cli"));
        assert_eq!(scenes.len(), n_scenes, "{year}");
        for path in scenes {
            let text = fs::read_to_string(&path).expect("a readable scene");
            let expected = if editions.is_empty() {
                Vec::new()
            } else {
                vec![format!("this scene is of the edition {editions}; clisc reads that of 2018")]
            };
            assert_eq!(messages(&text), expected, "{}", path.display());
            assert!(compile(&Source::new("test.cli", text)).diagnostics.iter().all(|found| found.fixes.is_empty()));
        }
    }
}

/// What the lines of a scene that is of no other edition may be: ordinary ones of 2018, and one with a slip in it.
#[test]
fn one_wrong_line_does_not_make_a_scene_of_another_edition() {
    let light = "light 1 1 1  0 0 5\n";
    let surface = "surface 0 .2 0  .4 .1 .1  0 0 0  1 0\n";
    for (scene, expected) in [
        // One sphere with the radius first: the light, or another sphere, stands against 2017.
        (format!("{light}{surface}sphere 1 0 0 -4\n"), vec!["E0402"]),
        (format!("{surface}sphere 1 0 0 -4\nsphere 0 0 -4 1\n"), vec!["E0402"]),
        (format!("{surface}sphere 1 0 0 -4\nsphere -2 1 -4 1\n"), vec!["E0402"]),
        (format!("{surface}sphere 1 0 0 -4\ncylinder 1 0 -4 -1 1\n"), vec!["E0402"]),
        // One sphere with a sign too many, which in 2017 would not be in view.
        (format!("{surface}sphere 1 0 -5 -1\n"), vec!["E0402"]),
        (format!("{surface}sphere 1 2 -4 1\nsphere 2 -1 -5 -1\nsphere 3 0 -6 2\nsphere 1 2 -5 1\n"), vec!["E0402"]),
        // One command of another year.
        (format!("{light}{surface}eye 0 0 5\nsphere 0 0 -4 1\n"), vec!["E0201"]),
        (format!("{light}{surface}cone 0 0 -5 2 1\nsphere 0 0 -4 1\n"), vec!["E0201"]),
        (format!("{light}{surface}disk 0 0 -5 0 0 1 1\nsphere 0 0 -4 1\n"), vec!["E0201"]),
        (format!("{light}{surface}sphere 0 0 -4 1\nrender\n"), vec!["E0201"]),
        (
            format!("{light}{surface}begin\nvertex 0 0 -4\nvertex 1 0 -4\nvertex 0 1 -4\nend\nsphere 0 0 -4 1\n"),
            vec!["E0201"; 5],
        ),
        // One light with its place first.
        (format!("light 0 5 0  1 1 1\n{surface}sphere 0 0 -4 1\n"), vec!["W0307"]),
        (format!("light 0 5 0  1 1 1\n{surface}sphere 1 0 0 -4\nsphere 0 0 -4 1\n"), vec!["W0307", "E0402"]),
        // Slips that are none of another year.
        (format!("{light}{surface}sphere 0 0 -4\n"), vec!["E0203"]),
        (format!("{surface}sphere 0 0 -4 1 1\n"), vec!["E0204"]),
        (format!("{surface}sphere 0 0 -4 0\n"), vec!["E0402"]),
        (format!("{surface}shpere 1 0 0 -4\n"), vec!["E0201"]),
        ("sphere 0 0 -4 1\n".to_owned(), vec!["E0301"]),
    ] {
        let text = format!("fov 60\n{scene}write a.png\n");
        assert_eq!(check(text.clone()), expected, "{text}");
    }
}

#[test]
fn a_scene_of_another_edition_is_one_finding() {
    let surface = "surface .8 .2 .2  .1 0 0  0 0 0  1 0\n";
    let light = "light 0 4 5  1 1 1\n";
    let triangle = "begin\nvertex -1 -1 -4\nvertex 1 -1 -4\nvertex 0 1 -4\nend\n";
    let camera = "eye 0 0 5\nuvw 1 0 0  0 1 0  0 0 1\n";
    for (scene, editions) in [
        (format!("{light}{surface}sphere 1  0 0 -4\nwrite a.png\n"), "2014 or 2017"),
        (format!("{light}{surface}sphere 1  0 0 -4\n"), "2014 or 2017"),
        (format!("{surface}sphere 1  0 0 -4\nwrite a.png\n"), "2014 or 2017"),
        (format!("{surface}{triangle}write a.png\n"), "2014 or 2017"),
        (format!("{camera}{light}{surface}{triangle}render\n"), "2022"),
        (format!("{light}{surface}sphere 1  0 0 -4\nrender\n"), "2022"),
        (format!("{camera}{light}{surface}cone 0 0 -5 2 1\nwrite a.png\n"), "2019"),
        (format!("{camera}{light}{surface}sphere 1  0 0 -4\nwrite a.png\n"), "2019"),
        (format!("{camera}{light}{surface}write a.png\n"), "2019 or 2020"),
        (format!("{camera}{light}{surface}disk 0 0 -5 0 0 1 1\nwrite a.png\n"), "2020"),
        (format!("{light}{surface}ellipsoid 0 0 -5 1 2 1\nwrite a.png\n"), "2020"),
        // With mistakes, which are none of this year's.
        (format!("{light}{surface}sphere 1  0 0 -4\nsphere 1 2\nsurfcae 1 1 1\nwrite a.jpg\n"), "2014 or 2017"),
        (format!("{light}{surface}{}sphere 0  0 0 -4\nwrite a.png\n", "sphere 1  0 0 -4\n".repeat(20)), "2014 or 2017"),
        (format!("light 2 2 2  2 2 2\n{light}{surface}{triangle}{triangle}vertex 1\nwrite a.png\n"), "2014 or 2017"),
    ] {
        for text in [scene.clone(), scene.replace('\n', "\r\n"), format!("\u{FEFF}# {scene}fov 60\n{scene}")] {
            assert_eq!(
                messages(&text),
                [format!("this scene is of the edition {editions}; clisc reads that of 2018")],
                "{text}"
            );
            let compilation = compile(&Source::new("test.cli", text));
            assert_eq!((compilation.n_errors, compilation.n_warnings), (1, 0));
            assert!(compilation.is_of_other_edition() && compilation.diagnostics[0].fixes.is_empty());
        }
    }
    // What is wrong in any year is told too.
    let latin = [b"# \xFC\n".as_slice(), format!("{light}{surface}sphere 1  0 0 -4\n").as_bytes()].concat();
    assert_eq!(check(latin), ["E0101", "E0302"]);
    // A large scene is recognised by its beginning.
    let large = format!("{surface}{}", "sphere 1  0 0 -4\n".repeat(2 * MAX_LISTED));
    assert_eq!(check(large), ["E0302"]);
}

/// What random scenes are made of: a light and a sphere in view, each with its parts.
fn any_light(stream: &mut Stream) -> [String; 2] {
    let color =
        [["1 1 1", "0.8 0.2 0.2", "1 0 0"], ["0.5 0.5 0.5", "0 0.2 0", "1 1 0.9"]][stream.below(2)][stream.below(3)];
    let place = (0..3).map(|_| format!("{:.1}", stream.between(-9.0, 9.0))).collect::<Vec<_>>().join(" ");
    [color.to_owned(), place]
}

fn any_sphere(stream: &mut Stream) -> [String; 2] {
    let z = stream.between(-12.0, -2.0);
    let [x, y] = [0.5 * z, 0.5 * z].map(|side| [0.0, stream.between(side, -side)][stream.below(2)]);
    [format!("{x:.1} {y:.1} {z:.1}"), format!("{:.1}", stream.between(0.1, 1.5))]
}

/// A sphere alone may be in 2018 what it is elsewhere; with a light or another sphere that is right, one wrong line is one.
#[test]
fn random_scenes_with_a_slip_stay_of_2018() {
    let mut stream = Stream::new(2018);
    for _ in 0..3000 {
        let mut lines = vec!["fov 60".to_owned(), "surface .1 0 0  .8 .2 .2  0 0 0  1 0".to_owned()];
        for _ in 0..1 + stream.below(2) {
            let [color, place] = any_light(&mut stream);
            lines.push(format!("light {color}  {place}"));
        }
        for _ in 0..1 + stream.below(3) {
            let [center, radius] = any_sphere(&mut stream);
            lines.push(format!("sphere {center}  {radius}"));
        }
        let [center, radius] = any_sphere(&mut stream);
        let [color, place] = any_light(&mut stream);
        lines.push(match stream.below(8) {
            0 => format!("sphere {radius} {center}"),
            1 => format!("sphere {center} -{radius}"),
            2 => format!("light {place} {color}"),
            3 => format!("eye {place}"),
            4 => "render".to_owned(),
            5 => format!("cone {center} 2 {radius}"),
            6 => format!("sphere {center}"),
            _ => format!("triangle {center}"),
        });
        let text = lines.join("\n") + "\nwrite a.png\n";
        let found = check(text.clone());
        assert!(!found.contains(&"E0302") && !found.contains(&"W0308"), "{found:?}\n{text}");
    }
}

/// In view and lit, a scene of another order is recognised however short it is; with a few mistakes of its own as well.
#[test]
fn random_scenes_of_another_order_are_recognised() {
    let mut stream = Stream::new(2017);
    for _ in 0..3000 {
        let mut lines = vec!["fov 60".to_owned(), "surface .8 .2 .2  .1 0 0  0 0 0  1 0".to_owned()];
        for _ in 0..stream.below(3) {
            let [color, place] = any_light(&mut stream);
            lines.push(format!("light {place}  {color}"));
        }
        for _ in 0..1 + stream.below(4) {
            let [center, radius] = any_sphere(&mut stream);
            lines.push(format!("sphere {radius} {center}"));
        }
        for _ in 0..stream.below(3) {
            lines.push(
                ["sphere 1 2", "surfcae 1 1 1", "sphere -1 0 0 -5", "light 0 4 5 255 255 255", "foo"][stream.below(5)]
                    .to_owned(),
            );
        }
        let text = lines.join("\n") + "\nwrite a.png\n";
        assert_eq!(messages(&text), ["this scene is of the edition 2014 or 2017; clisc reads that of 2018"], "{text}");
    }
}

#[test]
fn a_scene_that_only_looks_like_another_edition_is_suspected() {
    let text =
        "fov 60\nlight 0 5 -2  1 1 1\nlight 3 -1 2  .5 .5 .5\nsurface .8 .2 .2  .1 0 0  0 0 0  1 0\nwrite a.png\n";
    assert_eq!(messages(text), ["this scene looks like one of the edition 2014 or 2017, not of 2018"]);
    let compilation = compile(&Source::new("test.cli", text));
    assert_eq!((compilation.n_errors, compilation.n_warnings), (0, 1));
    assert_eq!(compilation.diagnostics[0].fixes, []);
    assert_eq!(compilation.program.lights.len(), 2, "it can be rendered");
    assert_eq!(check(text.replace("write", "sphere 0 0 -4 1\nwrite")), ["W0307", "W0307"]);
}

#[test]
fn a_field_of_view_in_radians_is_suspected() {
    for (angle, degrees) in [
        ("1.0472", Some(60)),
        ("1.05", Some(60)),
        ("1.047", Some(60)),
        ("0.785398", Some(45)),
        ("0.79", Some(45)),
        (".5236", Some(30)),
        ("1.5707963267948966", Some(90)),
        ("2.0944", Some(120)),
        ("0.873", Some(50)),
        ("1", None),
        ("1.5", None),
        ("2.0", None),
        ("0.001", None),
        ("0.35", None),
        ("1.0", None),
        ("1.001", None),
        ("3.1", None),
        ("10.472", None),
        ("1.0472e-3", None),
    ] {
        let found = messages(&format!("fov {angle}\nwrite a.png\n"));
        let expected = degrees
            .map(|degrees| format!("a field of view of {angle} degrees looks like {degrees} degrees in radians"));
        assert_eq!(found, Vec::from_iter(expected));
    }
}

#[test]
fn words_of_other_languages_have_an_answer_of_their_own() {
    for (line, help) in [
        (
            "camera 0 0 5",
            "the eye is at the origin and looks along −z: move the objects and lights instead, and set the angle with `fov`",
        ),
        (
            "LookAt 0 0 5 0 0 0 0 1 0",
            "the eye is at the origin and looks along −z: move the objects and lights instead, and set the angle with `fov`",
        ),
        (
            "camera { location <0, 0, 5> }",
            "the eye is at the origin and looks along −z: move the objects and lights instead, and set the angle with `fov`",
        ),
        ("point_light 0 5 0 1 1 1", "write `light r g b x y z`: the colour comes before the place"),
        ("ball 0 0 -4 1", "write `sphere x y z radius`"),
        ("save b.png", "write `write name.png`, which renders the scene as it then stands"),
        ("translate 0 0 -4", "there are no transformations: write each place as it is to be"),
        ("triangle 0 0 0 1 0 0 0 1 0", "there are no triangles: the objects are spheres and upright cylinders"),
        ("foobar 1", "the commands are fov, background, light, surface, sphere, cylinder, write"),
        // A slip stays one.
        ("lihgt 1 1 1 0 0 5", "did you mean `light`?"),
        (
            "surf 1 1 1",
            "write `surface Car Cag Cab Cdr Cdg Cdb Csr Csg Csb P Krefl` before the objects: ambient, diffuse and \
          specular colour, exponent, reflection",
        ),
        ("cyl 1 0 0 0 1", "did you mean `cylinder`?"),
        ("spheres 0 0 -4 1", "did you mean `sphere`?"),
    ] {
        let found = compile(&Source::new("test.cli", around(line))).diagnostics;
        let told: Vec<_> = found.iter().map(|found| (found.code.id, found.help.as_deref())).collect();
        assert_eq!(told, [("E0201", Some(help))], "{line}");
    }
    let fixed = |line: &str| {
        let found = compile(&Source::new("test.cli", around(line))).diagnostics;
        found[0].fixes.first().map(|offered| fix::apply(&around(line), [offered]).text)
    };
    assert_eq!(fixed("ball 0 0 -4 1"), Some(around("sphere 0 0 -4 1")));
    assert_eq!(fixed("save b.png"), Some(around("write b.png")));
    assert_eq!(fixed("point_light 0 5 0 1 1 1"), None, "its order is not known");
    assert_eq!(fixed("ball 1 0 0"), None);
}

#[test]
fn line_ends_and_marks_do_not_matter() {
    let scene = around("# π");
    assert_eq!(check(scene.clone()), [""; 0]);
    assert_eq!(check(scene.replace('\n', "\r\n")), [""; 0]);
    assert_eq!(check(scene.replacen('\n', "\r\n", 2)), [""; 0]);
    assert_eq!(check(format!("\u{FEFF}{scene}")), [""; 0]);
    assert_eq!(check(scene.trim_end()), [""; 0]);
    assert_eq!(check(scene.replace(' ', "\t \t")), [""; 0]);
    let of = |text: String| compile(&Source::new("test.cli", text)).program;
    assert_eq!(of(format!("\u{FEFF}{}", scene.replace('\n', "\r\n"))), of(scene));
}

#[test]
fn files_without_commands_lack_a_write_and_nothing_else() {
    for text in ["", "\n", "\u{FEFF}", "# only a comment", "\r\n\r\n", "  \t ", "# π\n\n"] {
        assert_eq!(check(text), ["W0301"], "{text:?}");
    }
}

#[test]
fn foreign_text_is_reported_at_its_place() {
    // Bytes that are no UTF-8 count as one column each; the command beside the comment is read.
    assert_eq!(
        check_places(b"write a.png # f\xFCr\nfov 0\n".as_slice()),
        "1:1: W0302\n1:16: E0101\n2:1: W0305\n2:5: E0401"
    );
    assert_eq!(
        check_places([around("# \u{FC}").as_bytes(), b"# \xFC \xFC\n# \xFF"].concat()),
        "7:3: E0101\n8:3: E0101"
    );
    // In a command they spoil that command alone.
    assert_eq!(check_places([b"surf\xFCce 1\n".as_slice(), around("").as_bytes()].concat()), "1:5: E0101");
    assert_eq!(check_places(around("sphere 0 0\0 -4 1")), "4:11: E0102");
    assert_eq!(check_places(around("sp\0here 0 0 -4 1")), "4:3: E0102");
    assert_eq!(check_places(around("# \0 \u{1B} \u{A0}")), "");
    assert_eq!(check_places(around("sphere 0 0\u{A0}-4\u{A0}x")), "4:11: E0102\n4:15: E0205");
    assert_eq!(check_places(around("\u{A0}\u{3000}")), "4:1: E0102");
    assert_eq!(check_places(around("\u{1A}")), "4:1: E0102");
}

#[test]
fn carriage_returns_alone_are_one_mistake() {
    assert_eq!(check_places(around("# a").replace('\n', "\r")), "1:7: E0102");
    assert_eq!(check_places(around("# a\rb")), "4:4: E0102\n4:5: E0201");
    assert_eq!(check_places(around("fov 60").replace('\n', "\r\r\n")), "1:7: E0102");
}

#[test]
fn utf16_is_one_mistake() {
    let text = around("sphere 0 0 -4 1");
    let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    for bytes in [[b"\xFF\xFE".as_slice(), &little].concat(), [b"\xFE\xFF".as_slice(), &big].concat(), little, big] {
        assert_eq!(check(bytes), ["E0101"]);
    }
}

#[test]
fn one_mistake_is_not_reported_twice() {
    for (bad, codes) in [
        // A bad command counts as the one it was meant to be.
        ("fov 60 x\nsurfcae 0 .2 0 .4 .1 .1 0 0 0 1 0\nsphere 0 0 -4 1\nwrit a.png", vec!["E0204", "E0201", "E0201"]),
        ("fvo 60\nsurface 1 1\nsphere 0 0 -4 1\nwrite a.jpg", vec!["E0201", "E0203", "E0209"]),
        ("fov x\n0 .2 0 .4 .1 .1 0 0 0 1 0\nsphere 0 0 -4 1\nsave a.png", vec!["E0205", "E0202", "E0201"]),
        ("fov 0\nwrite a.png", vec!["E0401"]),
        ("fov 60\nsurface 0 .2 0 .4 .1 .1 0 0 0 -1 0\nsphere 0 0 -4 1\nwrite a.png", vec!["E0404"]),
        // Objects without a surface are mended by one surface.
        ("fov 60\nsphere 0 0 -4 1\nsphere 0 0 -4 1\nwrite a.png", vec!["E0301"]),
        // Two mistakes on one line are two.
        ("fov 60\nsurface 1 1 1 1 1 1 1 1 1 1 1\ncylinder -1 0 0 2 1\nwrite a.png", vec!["E0402", "E0403"]),
        ("fov 60\nsurface 1 1 1 1 1 1 1 1 1 1 1\nsphere x y 0 1\nwrite a.png", vec!["E0205", "E0205"]),
        ("fov 60\nsurface 1 1 1 1 1 1 1 1 1 1 1\nsphere x 0 0 1 1 1\nwrite a.png", vec!["E0205", "E0204"]),
        ("fov 60\nsurface 1 1 1 1 1 1 1 1 1 1 1\nsphere x 0 0\nwrite a.png", vec!["E0205"]),
        // So are a mistake in shape and one in value, on two lines.
        // A block of another language is one.
        ("fov 60\nsurface 1 1 1 1 1 1 1 1 1 1 1\nsphere { <0, 1, 2>, 2 pigment { Red } }\nwrite a.png", vec!["E0205"]),
        ("fov 60\nlight 9 9 9 0 0\nlight 9 9 9 0 0 1\nwrite a.png", vec!["E0203", "W0303"]),
    ] {
        assert_eq!(check(bad), codes, "{bad}");
    }
}

#[test]
fn long_lines_are_cut_and_quick() {
    let long = format!("{}sphere 0 0 -4 x{}", " ".repeat(5_000_000), " 1".repeat(2_500_000));
    let source = Source::new("long.cli", around(&long));
    let found = compile(&source).diagnostics;
    let mut drawing = Vec::new();
    render_human(&source, &found, Color::Never, &mut drawing).expect("written to memory");
    let drawing = String::from_utf8(drawing).expect("text");
    assert!(drawing.contains("4:5000015") && drawing.contains("`x` is not a number"), "{drawing}");
    assert!(drawing.lines().all(|line| line.chars().count() < 300), "a line of ten megabytes is drawn");
    for unit in ["x", "1 ", "#", "\"", "\u{A0}", "\0", "sphere "] {
        let text = around(&unit.repeat(10_000_000 / unit.len()));
        let source = Source::new("long.cli", text);
        let mut drawing = Vec::new();
        render_human(&source, &compile(&source).diagnostics, Color::Never, &mut drawing).expect("written to memory");
        assert!(drawing.len() < 10_000, "{unit:?}");
    }
}

#[test]
fn numbers_are_the_nearest_ones() {
    for text in ["0.1", "+.5", "1.", "1e-3", "123456789012345678901234567890", "4.9e-324", "1e-999", "-0"] {
        let source = Source::new("test.cli", around(&format!("sphere {text} 0 -4 1")));
        let program = compile(&source).program;
        let expected: f64 = text.parse().expect("a number");
        assert_eq!(program.spheres.as_slice()[0].center.x.to_bits(), expected.to_bits(), "{text}");
    }
}

#[test]
fn runs_of_one_kind_are_one_step() {
    let text = "fov 60\nlight 1 1 1 0 0 5\nlight 1 1 1 0 1 5\nsurface 1 1 1 1 1 1 1 1 1 1 1\nsphere 0 0 -4 1\n\
        surface 1 1 1 1 1 1 1 1 1 1 0\nsphere 1 0 -4 1\ncylinder 1 0 0 0 1\nsphere 2 0 -4 1\nwrite a.png\nwrite b.png\n";
    let source = Source::new("test.cli", text);
    let compilation = compile(&source);
    assert_eq!(compilation.diagnostics, []);
    let program = ir::validate(compilation.program).expect("a sound program");
    let mut listing = Vec::new();
    ir::dump_commands(&source, &program, &mut listing).expect("written to memory");
    insta::assert_snapshot!("runs_of_one_kind", String::from_utf8(listing).expect("text"));
    assert_eq!(program.origins.commands.len(), program.commands.len());
    assert_eq!(source.slice(*program.origins.commands.last().expect("an origin")), "b.png");
}

/// The scene of the snapshots: a little of everything.
const SCENE: &str = "\u{FEFF}# two balls and a pillar, π\r\nfov 60\nbackground .2 .3 .5\nlight 1 1 1  0 0 5   # key\n\
    light 0.1 0.1 0.1\t5 5 0\nsurface 0 0.2 0   0.4 0.1 0.1   0 0 0   1  0\nsphere 0 0 -4 1\n\
    surface 0 0 0  0.4 0.1 0.1  .5 .5 .5  1e1  0.2\nsphere 2 -0 -4 1\nsphere 0 0 -4 1\ncylinder 1 0 -7 -1 1\n\
    write \"out/b 1.png\"\nlight 0.1 0.1 0.1  -5 5 0\nwrite 7#b.png # again";

fn dumped(write: impl FnOnce(&mut dyn std::io::Write) -> std::io::Result<()>) -> String {
    let mut out = Vec::new();
    write(&mut out).expect("written to memory");
    String::from_utf8(out).expect("text")
}

#[test]
fn dumps_keep_their_shape() {
    let source = Source::new("scene.cli", SCENE);
    let compilation = compile(&source);
    assert_eq!(compilation.diagnostics, []);
    let program = ir::validate(compilation.program).expect("a sound program");
    let (tokens, file) = (lex(&source), parse(&source).file);
    insta::assert_snapshot!("tokens", dumped(|out| dump_tokens(&source, &tokens, out)));
    insta::assert_snapshot!("tokens_json", dumped(|out| dump_tokens_json(&source, &tokens[..6], out)));
    insta::assert_snapshot!("ast", dumped(|out| dump_ast(&source, &file, out)));
    insta::assert_snapshot!("ast_json", dumped(|out| dump_ast_json(&source, &file, out)));
    insta::assert_snapshot!("ir", dumped(|out| ir::dump_arenas(&source, &program, out)));
    insta::assert_snapshot!("ir_json", dumped(|out| ir::dump_arenas_json(&source, &program, out)));
    insta::assert_snapshot!("commands", dumped(|out| ir::dump_commands(&source, &program, out)));
    insta::assert_snapshot!("commands_json", dumped(|out| ir::dump_commands_json(&source, &program, out)));
}

/// Scenes with one mistake whose drawing is kept: a tab, a wide character, a byte-order mark, CRLF, two places, none.
const DRAWN: &[&str] = &[
    "\u{FEFF}fov\t0\r\nwrite a.png\r\n",
    "fov 60\n# 漢字 π\nsphere\t1 0 0 # 漢\nsurfac 1\nwrite a.png",
    "fov 60\nwrite a.png\n\n\nfov 70\nwrite ./a.png",
    "# \u{2028} and \u{0C} end no line\nfov 60 \u{A0}\n",
    "",
];

#[test]
fn drawings_keep_their_shape() {
    let drawings: Vec<_> = DRAWN
        .iter()
        .map(|text| {
            let source = Source::new("scene.cli", *text);
            let found = compile(&source).diagnostics;
            dumped(|out| render_human(&source, &found, Color::Never, out))
        })
        .collect();
    assert!(drawings.iter().all(|drawing| !drawing.contains('\u{1B}')));
    assert!(drawings.iter().flat_map(|drawing| drawing.lines()).all(|line| line == line.trim_end()));
    insta::assert_snapshot!("drawings", drawings.join("=====\n"));
    let source = Source::new("scene.cli", "fov 0\nwrite a.png");
    let found = compile(&source).diagnostics;
    insta::assert_snapshot!("short", dumped(|out| render_short(&source, &found, out)));
    insta::assert_snapshot!("json", dumped(|out| render_json(&source, &found, out)));
    let colored = dumped(|out| render_human(&source, &found, Color::Always, out));
    assert!(colored.starts_with("\u{1B}[31merror[E0401]\u{1B}[0m: "), "{colored:?}");
}

#[test]
fn a_help_does_not_lead_to_the_next_mistake() {
    for (line, help) in [
        ("fov inf", "write a usual number, as in `fov 60`"),
        ("fov 1e999", "write a usual number, as in `fov 60`"),
        ("write(b.png)", "write `write b.png`"),
        ("write=\"b.png\"", "write `write b.png`"),
        ("sphere 0 0 0 1; sphere 1 1 1 1", "write `sphere 0 0 0 1`, and begin a new line before `sphere`"),
    ] {
        let found = compile(&Source::new("test.cli", around(line))).diagnostics;
        let helps: Vec<_> = found.iter().filter_map(|diagnostic| diagnostic.help.as_deref()).collect();
        assert_eq!(helps, [help], "{line}: {found:#?}");
    }
}

#[test]
fn many_diagnostics_are_told_and_all_are_counted() {
    for n in [MAX_LISTED, MAX_LISTED + 5000] {
        let source = Source::new("scene.cli", "sphere 1\n".repeat(n));
        let compilation = compile(&source);
        assert_eq!((compilation.n_errors, compilation.n_warnings), (n, 1), "a `write` is missing too");
        assert_eq!(compilation.n_unlisted(Severity::Error), n - MAX_LISTED);
        let drawing = dumped(|out| render_human(&source, &compilation.diagnostics, Color::Never, out));
        assert_eq!(drawing.matches("error[E0203]").count(), MAX_LISTED);
        assert_eq!(drawing.matches("warning[W0301]").count(), 1);
    }
}

/// Lines of which some are scenes and some nearly so.
fn any_scene() -> impl Strategy<Value = String> {
    let word = prop::sample::select(vec![
        "fov",
        "background",
        "light",
        "surface",
        "sphere",
        "cylinder",
        "write",
        "sphre",
        "1",
        "-0.5",
        "1e999",
        "0,5",
        ".",
        "-",
        "a.png",
        "\"a b.png\"",
        "\"",
        "#",
        " ",
        "\t",
        "\r",
        "\n",
        "\r\n",
        "\u{A0}",
        "\0",
        "\u{FEFF}",
        "π",
        "(",
        ")",
        "1,2,3,4",
    ]);
    prop::collection::vec((word, prop::sample::select(vec!["", " ", " ", " ", "\n"])), 0..60)
        .prop_map(|pieces| pieces.into_iter().flat_map(|(word, blank)| [word, blank]).collect())
}

/// Scenes most of whose lines are commands with all their numbers, in every spelling, and here and there a slip.
fn any_plain_scene() -> impl Strategy<Value = String> {
    let number = prop_oneof![
        6 => "[+-]?[0-9]{1,9}(\\.[0-9]{0,9})?",
        2 => "[+-]?[0-9]{0,20}\\.[0-9]{1,20}([eE][+-]?[0-9]{1,3})?",
        1 => any::<f64>().prop_map(|number| number.to_string()),
    ];
    let blank = prop::sample::select(vec![" ", "  ", "\t"]);
    let end =
        prop::sample::select(vec!["\n", "\n", "\n", "\r\n", " # a#b\n", "#\n", "\t\n", "\n\n", "\r", " x\n", " 1\n"]);
    let command = prop::sample::select(COMMANDS.iter().collect::<Vec<_>>());
    let line = (blank.clone(), command, prop::collection::vec((blank, number), 11), end);
    let line = line.prop_map(|(indent, command, args, end)| {
        let n_args = command.numbers().len();
        let args: String = args.into_iter().take(n_args).map(|(blank, number)| format!("{blank}{number}")).collect();
        format!("{indent}{}{args}{end}", command.name)
    });
    prop::collection::vec(line, 0..20).prop_map(|lines| lines.concat())
}

/// Checks every law of the language wing.
fn assert_keeps_laws(bytes: &[u8]) {
    assert_tokens_tile(bytes);
    assert_parses_soundly(bytes);
    assert_ways_agree(bytes);
    assert_compiles_soundly(bytes);
    assert_draws_soundly(bytes);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_keep_the_laws(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        assert_keeps_laws(&bytes);
    }

    #[test]
    fn any_near_scene_keeps_the_laws(text in any_scene()) {
        assert_keeps_laws(text.as_bytes());
    }

    #[test]
    fn any_plain_scene_keeps_the_laws(text in any_plain_scene()) {
        assert_keeps_laws(text.as_bytes());
    }

    #[test]
    fn an_error_never_outlives_its_line(text in any_scene()) {
        let line = text.replace(['\n', '\r'], " ");
        let scene = around(&line);
        let source = Source::new("test.cli", scene);
        for found in compile(&source).diagnostics {
            let place = source.lines().line_of(found.primary.span.start);
            prop_assert!(place == 3 || !found.is_error(), "{found:#?}");
        }
    }
}
