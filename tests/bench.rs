//! `clisc bench` as one calls it: tables, documents, plots, faults.

#[path = "support/schema.rs"]
mod schema;
mod support;

use std::path::Path;

use serde_json::Value;

use crate::support::{Call, Folder, scene};

/// The options of a run that is over soon.
const QUICK: [&str; 4] = ["--size", "24x18", "--repeat", "2"];

fn bench(folder: &Folder, args: &[&str]) -> Call {
    folder.clisc(&[&["bench"], args, &QUICK[..]].concat())
}

#[track_caller]
fn assert_code(call: &Call, code: i32) {
    assert_eq!(call.code, Some(code), "stdout:\n{}stderr:\n{}", call.stdout, call.stderr);
}

/// Benches a scene and returns its document.
fn measured(text: &str, args: &[&str]) -> Value {
    let folder = Folder::with_scene(text);
    assert_code(&bench(&folder, &[&["a.cli", "--json", "bench.json"], args].concat()), 0);
    serde_json::from_slice(&folder.bytes("bench.json")).expect("JSON")
}

fn find<'a>(list: &'a Value, name: &str) -> &'a Value {
    let all = list.as_array().expect("a list");
    all.iter().find(|one| one["name"] == name).unwrap_or_else(|| panic!("{name} is not in {list}"))
}

#[test]
fn the_document_is_as_its_schema_says() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/schemas/bench-v1.schema.json");
    let schema = serde_json::from_slice(&std::fs::read(path).expect("a schema")).expect("JSON");
    let mut document = measured(&scene("a.png"), &["--samples", "1,3"]);
    assert_eq!(schema::violations(&schema, &document), [""; 0]);
    // And the schema is worth something: it refuses a document with a field too few.
    document["scenes"][0]["modes"][0].as_object_mut().expect("an object").remove("runs");
    assert_eq!(schema::violations(&schema, &document).len(), 1);
}

#[test]
fn a_draft_is_off_by_what_binary32_is_and_f64_by_what_binary64_is() {
    let document = measured(&scene("a.png"), &["--modes", "f32,f64"]);
    let modes = &document["scenes"][0]["modes"];
    assert_eq!(modes.as_array().map(Vec::len), Some(2));
    let error = |name: &str| find(modes, name)["largest_unrounded"].as_f64().expect("a number");
    assert!((1e-7..1e-1).contains(&error("f32")), "{document}");
    assert!((1e-18..1e-9).contains(&error("f64")), "{document}");
    let f64_mode = find(modes, "f64");
    assert_eq!((f64_mode["wrong_channels"].as_u64(), f64_mode["draft_pixels"].as_u64()), (Some(0), Some(0)));
    assert_eq!(find(modes, "f32")["draft_pixels"], 24 * 18);
    assert_eq!(f64_mode["runs"], 2);
}

#[test]
fn more_samples_are_nearer_to_the_reference() {
    let document = measured(&scene("a.png"), &["--modes", "f64", "--samples", "1,4,32"]);
    let samples = &document["scenes"][0]["samples"];
    let error = |name: &str| find(samples, name)["mean_levels"].as_f64().expect("a number");
    assert!(error("1x1") > error("4x4") && error("4x4") > 0.0, "{document}");
    assert_eq!(error("32x32"), 0.0);
    assert_eq!(find(samples, "4x4")["largest_unrounded"], Value::Null);
}

#[test]
fn a_table_tells_it_to_people() {
    let folder = Folder::with_scene(&scene("a.png"));
    let call = bench(&folder, &["a.cli", "--samples", "2"]);
    assert_code(&call, 0);
    for words in ["a.cli  24x18", "mode", "f32", "f64", "2x2", "errors in levels against", "against 32x32 samples"] {
        assert!(call.stdout.contains(words), "`{words}` is not in:\n{}", call.stdout);
    }
    assert_eq!((call.stderr.as_str(), folder.listing()), ("", vec!["a.cli".to_owned()]));
}

#[test]
fn plots_are_saved_for_each_scene() {
    let folder = Folder::with_scene(&scene("a.png"));
    folder.put("b.cli", scene("b.png"));
    assert_code(&bench(&folder, &["a.cli", "b.cli", "--samples", "1,2", "--svg", "deep/plots"]), 0);
    let names = ["a-modes.svg", "a-samples.svg", "b-modes.svg", "b-samples.svg"];
    for name in names {
        let plot = String::from_utf8(folder.bytes(&format!("deep/plots/{name}"))).expect("text");
        assert!(plot.starts_with("<svg") && plot.trim_end().ends_with("</svg>"), "{name}");
        assert!(plot.contains("time, ms") && plot.contains("levels"), "{name}");
    }
    assert!(String::from_utf8(folder.bytes("deep/plots/a-modes.svg")).expect("text").contains("f64"));
}

#[test]
fn the_last_write_is_measured() {
    // Of the first image nothing is drafted, of the second all: the eye leaves the ball, and enters it.
    let last = "fov 60\nlight 1 1 1 0 0 5\nsurface .1 .1 .1 .5 .5 .5 0 0 0 1 0\nsphere 0 0 -4 1\nwrite a.png\nsphere 0 0 0 9\n";
    let document = measured(&format!("{last}write b.png\n"), &["--modes", "f32"]);
    assert_eq!(find(&document["scenes"][0]["modes"], "f32")["draft_pixels"], 0);
    let document = measured(last, &["--modes", "f32"]);
    assert_eq!(find(&document["scenes"][0]["modes"], "f32")["draft_pixels"], 24 * 18);
}

#[test]
fn what_cannot_be_measured_is_told() {
    let folder = Folder::with_scene(&scene("a.png"));
    folder.put("bad.cli", "sphere 1 2\nwrite bad.png\n");
    folder.put("none.cli", "fov 60\n");
    let call = bench(&folder, &["bad.cli", "a.cli"]);
    assert_code(&call, 1);
    assert!(call.stderr.contains("error[E0203]") && call.stdout.contains("a.cli"), "{call:?}");
    for (args, words) in [
        (&["none.cli"][..], "`none.cli` has no `write`"),
        (&["gone.cli"], "cannot read `gone.cli`"),
        (&["a.cli", "--modes", "f16"], "invalid value 'f16'"),
        (&["a.cli", "--samples", "0"], "a whole number from 1 to 256 is meant"),
        (&["a.cli", "--json", "no/where.json"], "cannot save `no/where.json`"),
        (&["a.cli", "--svg", "a.cli/x"], "cannot make the folder `a.cli/x`"),
    ] {
        let call = bench(&folder, args);
        assert_code(&call, 2);
        assert!(call.stderr.contains(words), "{args:?}: {}", call.stderr);
    }
}
