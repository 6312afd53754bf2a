//! What other programs read: each format is valid, stable and says what was found.

#[path = "support/schema.rs"]
mod schema;
#[path = "support/tree.rs"]
mod tree;

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use clisc::diag::fix::apply;
use clisc::diag::render::{Color, Format, Notification, Report, Screen, render_human};
use clisc::diag::{Diagnostic, Edit, Fix, codes};
use clisc::source::{LineIndex, Source, Span};
use clisc::{Compilation, compile};
use serde_json::Value;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn schema_at(path: &str) -> Value {
    let text = fs::read_to_string(root().join(path)).expect("a schema");
    serde_json::from_str(&text).expect("JSON")
}

/// Every fixture, every invalid scene, and an empty one: whatever can be found is found in one of them.
fn scenes() -> Vec<(Source, Compilation)> {
    let folders = ["tests/fixtures", "scenes/invalid"];
    let paths = folders.iter().flat_map(|folder| tree::files_below(&root().join(folder)));
    let read = |path: std::path::PathBuf| {
        let name = path.strip_prefix(root()).expect("a path of the project").display().to_string();
        Source::from_bytes(name, fs::read(&path).expect("a scene")).expect("a small scene")
    };
    let odd = [Source::new("empty.cli", ""), Source::new("a b#%.cli", "\u{FEFF}sphere\u{A0}1 \"π\r\nfov 0\r\n")];
    let sources = paths.map(read).chain(odd);
    sources.map(|source| (compile(&source), source)).map(|(found, source)| (source, found)).collect()
}

fn report(format: Format, scenes: &[(Source, Compilation)]) -> String {
    let mut report = Report::begin(format, Vec::new()).expect("written to memory");
    for (source, compilation) in scenes {
        report.add(source, &compilation.diagnostics, [0, 0]).expect("written to memory");
    }
    String::from_utf8(report.finish().expect("written to memory")).expect("text")
}

fn parsed(format: Format, scenes: &[(Source, Compilation)]) -> Value {
    serde_json::from_str(&report(format, scenes)).expect("one JSON document")
}

#[test]
fn json_is_as_its_schema_says() {
    let schema = schema_at("docs/schemas/diagnostics-v1.schema.json");
    let scenes = scenes();
    let document = parsed(Format::Json, &scenes);
    assert_eq!(schema::violations(&schema, &document), [""; 0]);
    let n_found: usize = scenes.iter().map(|(_, found)| found.diagnostics.len()).sum();
    assert_eq!(document["diagnostics"].as_array().map(Vec::len), Some(n_found));
    assert_eq!(schema::violations(&schema, &parsed(Format::Json, &[])), [""; 0]);
    // And the schema is worth something: it refuses a document with a field too few.
    let mut less = document;
    less["diagnostics"][0]["primary"]["start"].as_object_mut().expect("a place").remove("line");
    assert_eq!(schema::violations(&schema, &less).len(), 1);
}

#[test]
fn sarif_is_as_its_schema_says_and_its_places_are_those_of_the_text() {
    let schema = schema_at("tests/schemas/sarif.schema.json");
    let scenes = scenes();
    let document = parsed(Format::Sarif, &scenes);
    assert_eq!(schema::violations(&schema, &document), [""; 0]);
    assert_eq!(schema::violations(&schema, &parsed(Format::Sarif, &[])), [""; 0]);

    let run = &document["runs"][0];
    let mut results = run["results"].as_array().expect("results").iter();
    for (source, compilation) in &scenes {
        for diagnostic in &compilation.diagnostics {
            let result = results.next().expect("a result for each diagnostic");
            assert_eq!(
                run["tool"]["driver"]["rules"][result["ruleIndex"].as_u64().expect("an index") as usize]["id"],
                result["ruleId"]
            );
            assert_eq!(result["ruleId"], diagnostic.code.id);
            for (i, fix) in diagnostic.fixes.iter().enumerate() {
                let replacements = &result["fixes"][i]["artifactChanges"][0]["replacements"];
                assert_eq!(applied(source, replacements), apply(source.text(), [fix]).text);
            }
        }
    }
    assert!(results.next().is_none());
}

#[test]
fn what_no_scene_is_to_blame_for_is_in_every_format() {
    let document = |format| -> Value {
        let mut report = Report::begin(format, Vec::new()).expect("written to memory");
        for notification in [
            Notification::error(Some(Path::new("a b.cli")), "cannot read `a b.cli`"),
            Notification::warning(None, "something else"),
        ] {
            report.notify(&notification).expect("written to memory");
        }
        serde_json::from_slice(&report.finish().expect("written to memory")).expect("one JSON document")
    };
    let (json, sarif, gitlab) = (document(Format::Json), document(Format::Sarif), document(Format::Gitlab));
    assert_eq!(schema::violations(&schema_at("docs/schemas/diagnostics-v1.schema.json"), &json), [""; 0]);
    assert_eq!(schema::violations(&schema_at("tests/schemas/sarif.schema.json"), &sarif), [""; 0]);
    assert_eq!(json["notifications"].as_array().map(Vec::len), Some(2));
    let told = &sarif["runs"][0]["invocations"][0]["toolExecutionNotifications"];
    assert_eq!((&told[0]["level"], &told[1]["level"]), (&"error".into(), &"warning".into()));
    assert_eq!((&gitlab[0]["severity"], &gitlab[1]["severity"]), (&"major".into(), &"minor".into()));
    assert_ne!(gitlab[0]["fingerprint"], gitlab[1]["fingerprint"]);
}

/// GitHub refuses a run of more.
#[test]
fn sarif_holds_25000_results_and_says_how_many_more_there_were() {
    let source = Source::new("a.cli", "fov 0\n");
    let found = vec![Diagnostic::new(&codes::FOV_OUT_OF_RANGE, Span::new(4, 5), "x").label("x"); 9_000];
    let mut report = Report::begin(Format::Sarif, Vec::new()).expect("written to memory");
    for n_unlisted in [0, 7, 0] {
        report.add(&source, &found, [n_unlisted, 0]).expect("written to memory");
    }
    let document: Value =
        serde_json::from_slice(&report.finish().expect("written to memory")).expect("one JSON document");
    let run = &document["runs"][0];
    assert_eq!(run["results"].as_array().map(Vec::len), Some(25_000));
    assert_eq!(run["properties"]["unlisted"], 2_007);
    let invocation = &run["invocations"][0];
    assert_eq!(invocation["executionSuccessful"], true);
    let told = invocation["toolExecutionNotifications"][0]["message"]["text"].as_str().expect("a text");
    assert!(told.starts_with("2007 findings left out: a run holds 25000 results"), "{told}");
}

/// Draws what is wrong with a scene on a screen of so many columns.
fn drawn(text: &str, width: Option<usize>) -> String {
    let source = Source::new("a.cli", text);
    let mut found = compile(&source).diagnostics;
    found.retain(Diagnostic::is_error);
    let mut out = Vec::new();
    render_human(&source, &found, Screen { color: Color::Never, width }, &mut out).expect("written to memory");
    String::from_utf8(out).expect("text")
}

#[test]
fn a_long_line_is_cut_around_its_places() {
    let line = format!("sphere 0 0 -4{}x{} # a ball\n", " ".repeat(100), " ".repeat(100));
    let expected = "\
error[E0205]: `x` is not a number
   ╭─[ a.cli:1:114 ]
   │
 1 │ …                           x                           …
   │                             ┬
   │                             ╰── the `radius` of `sphere`
   │
   │ Help: write a number for `radius`, such as `1`, `-0.25` or `1e-3`
───╯

";
    assert_eq!(drawn(&line, Some(62)), expected);
    // Places far apart each have a piece.
    let far = format!("sphere{}0 0 -5 1{}2 # ball\n", " ".repeat(200), " ".repeat(200));
    let row = drawn(&far, Some(80)).lines().nth(3).expect("a row").trim_end().to_owned();
    assert!(row.starts_with(" 1 │ sphere  ") && row.contains("  …  ") && row.ends_with(" 2 # ball"), "{row}");
    assert!(drawn(&far, Some(80)).contains("╭─[ a.cli:1:415 ]"), "{}", drawn(&far, Some(80)));
    // A line that fits is whole, also with tabs, and so is what a wide screen shows.
    assert!(drawn("\tsphere\t0 0 -4 x  # a line of fifty columns\n", Some(62)).contains("fifty columns\n"));
    assert!(drawn(&line, Some(400)).contains("# a ball"));
    assert_eq!(drawn(&line, None), drawn(&line, Some(140)));
}

#[test]
fn cut_lines_keep_their_marks_below_the_right_columns() {
    for before in ["世界".repeat(300), "\t".repeat(300), "\u{1}é".repeat(300), " ".repeat(300)] {
        let lines = format!("{before} sphere 0 0 -4 x\n").repeat(2).replacen("sphere", "sphere 1 y", 1);
        let text = format!("\u{FEFF}{lines}");
        let drawing = drawn(&text, Some(70));
        for (row, below) in drawing.lines().zip(drawing.lines().skip(1)).filter(|(row, _)| row.starts_with(" 2 │")) {
            let wide = |text: &str| text.chars().map(|c| if matches!(c, '世' | '界') { 2 } else { 1 }).sum::<usize>();
            assert!(wide(row) <= 70, "{drawing}");
            if let Some((before_mark, _)) = below.split_once('┬').filter(|_| row.contains(" x")) {
                let at = row.split_once(" x").map(|(before, _)| wide(before) + 1);
                assert_eq!(at, Some(before_mark.chars().count()), "{drawing}");
            }
        }
    }
    // Not even a word of a megabyte is printed.
    let drawing = drawn(&format!("sphere 0 0 -4 1{}\n", "z".repeat(1_000_000)), Some(100));
    assert!(drawing.lines().all(|row| row.chars().count() <= 160), "{drawing}");
    assert!(drawing.contains("a.cli:1:15"), "{drawing}");
}

/// Carries out replacements as a reader of SARIF would, by lines and columns.
fn applied(source: &Source, replacements: &Value) -> String {
    let offset = |line: &Value, column: &Value| {
        let text = source.text();
        let line = LineIndex::new(text).line_span(text, line.as_u64().expect("a line") as usize - 1);
        let has_bom = line.start == 0 && text.starts_with('\u{FEFF}');
        let n_before = column.as_u64().expect("a column") as usize - 1 + usize::from(has_bom);
        let rest = &text[line.start as usize..];
        line.start + rest.char_indices().nth(n_before).map_or(rest.len(), |(at, _)| at) as u32
    };
    let edits = replacements.as_array().expect("replacements").iter().map(|replacement| {
        let region = &replacement["deletedRegion"];
        let start = offset(&region["startLine"], &region["startColumn"]);
        let end = offset(&region["endLine"], &region["endColumn"]);
        let text = replacement["insertedContent"]["text"].as_str().unwrap_or_default();
        Edit::replace(Span::new(start, end), text)
    });
    apply(source.text(), [&Fix::safe("as read", edits.collect())]).text
}

#[test]
fn gitlab_knows_each_finding_by_a_fingerprint_of_its_own() {
    let scenes = scenes();
    let document = parsed(Format::Gitlab, &scenes);
    let issues = document.as_array().expect("an array");
    let all: Vec<&Diagnostic> = scenes.iter().flat_map(|(_, found)| &found.diagnostics).collect();
    assert_eq!(issues.len(), all.len());
    let fingerprints: BTreeSet<_> = issues.iter().map(|issue| issue["fingerprint"].as_str().expect("text")).collect();
    assert_eq!(fingerprints.len(), issues.len());
    for (issue, diagnostic) in issues.iter().zip(all) {
        assert_eq!(issue["description"], diagnostic.message);
        assert_eq!(issue["severity"], if diagnostic.is_error() { "major" } else { "minor" });
        assert!(issue["location"]["lines"]["begin"].as_u64() >= Some(1));
    }
    assert_eq!(parsed(Format::Gitlab, &[]), serde_json::json!([]));
}

#[test]
fn github_gets_a_line_for_each_finding() {
    let scenes = scenes();
    let lines = report(Format::Github, &scenes);
    let n_found: usize = scenes.iter().map(|(_, found)| found.diagnostics.len()).sum();
    assert_eq!(lines.lines().count(), n_found);
    assert!(lines.lines().all(|line| line.starts_with("::error file=") || line.starts_with("::warning file=")));
}
