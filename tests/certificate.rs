//! `clisc run --certificate`: the document, its published shape, and when there is none.

mod support;

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::support::{Folder, scene};

/// Checks a value against a schema, as far as our schema goes; says where it fails.
fn check(value: &Value, schema: &Value, place: &str) {
    let known =
        ["$schema", "title", "description", "type", "required", "properties", "items", "enum", "const", "minimum"];
    let schema = schema.as_object().expect("a schema is an object");
    assert!(schema.keys().all(|key| known.contains(&key.as_str())), "{place}: a keyword that this test does not know");
    if let Some(kind) = schema.get("type") {
        let is_kind = match kind.as_str().expect("a type") {
            "object" => value.is_object(),
            "array" => value.is_array(),
            "string" => value.is_string(),
            "boolean" => value.is_boolean(),
            "number" => value.is_number(),
            "integer" => value.is_u64(),
            other => panic!("no type {other}"),
        };
        assert!(is_kind, "{place}: {value} is no {kind}");
    }
    assert!(schema.get("const").is_none_or(|only| only == value), "{place}: {value}");
    assert!(schema.get("enum").is_none_or(|all| all.as_array().expect("a list").contains(value)), "{place}: {value}");
    if let (Some(minimum), Some(number)) = (schema.get("minimum").and_then(Value::as_f64), value.as_f64()) {
        assert!(number >= minimum, "{place}: {number}");
    }
    for name in schema.get("required").and_then(Value::as_array).into_iter().flatten() {
        assert!(value.get(name.as_str().expect("a name")).is_some(), "{place} lacks {name}");
    }
    if let Some(properties) = schema.get("properties") {
        for (name, value) in value.as_object().expect("an object") {
            let schema = properties.get(name).unwrap_or_else(|| panic!("{place}: `{name}` is not in the schema"));
            check(value, schema, &format!("{place}.{name}"));
        }
    }
    if let Some(schema) = schema.get("items") {
        value.as_array().expect("an array").iter().for_each(|value| check(value, schema, &format!("{place}[]")));
    }
}

fn certificate(folder: &Folder, name: &str) -> Value {
    let schema = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/schemas/certificate-v1.schema.json");
    let schema = serde_json::from_str(&fs::read_to_string(schema).expect("the schema")).expect("a schema in JSON");
    let document = serde_json::from_slice(&folder.bytes(name)).expect("a certificate in JSON");
    check(&document, &schema, "certificate");
    document
}

#[test]
fn a_certificate_says_how_every_pixel_was_settled() {
    for precision in ["certified", "exact"] {
        let folder = Folder::with_scene(&scene("a.png"));
        let args = ["run", "a.cli", "--precision", precision, "--certificate", "proof.json", "--size", "60x60"];
        let call = folder.clisc(&args);
        assert_eq!((call.code, &*call.stderr), (Some(0), ""));
        assert_eq!(folder.listing(), ["a.cli", "a.png", "proof.json"]);
        let document = certificate(&folder, "proof.json");
        assert_eq!(document["settings"]["precision"], precision);
        let image = &document["images"][0];
        assert_eq!((&image["scene"], &image["write"]), (&"a.cli".into(), &"a.png".into()));
        assert_eq!(image["crc32"], format!("{:08x}", crc32fast::hash(&folder.bytes("a.png"))));
        assert_eq!(image["bytes"], folder.bytes("a.png").len());
        let pixels = &image["pixels"];
        let count = |value: &Value| value.as_u64().expect("a number");
        let exact: u64 = pixels["exact"].as_array().expect("a list").iter().map(|one| count(&one["pixels"])).sum();
        let sum = count(&pixels["binary64"])
            + count(&pixels["double_double"])
            + count(&pixels["long"])
            + count(&pixels["shared"])
            + exact;
        assert_eq!((sum, count(&pixels["beyond_limit"])), (3600, 0));
        assert_eq!(image["unproved"], serde_json::json!({ "pixels": 0, "beyond_limit": [] }));
        assert_eq!(precision == "exact", exact == 3600);
    }
}

#[test]
fn ties_are_in_the_certificate_with_their_places() {
    let folder = Folder::with_scene(&scene("a.png"));
    folder.clisc(&["run", "a.cli", "--certificate", "proof.json"]);
    let document = certificate(&folder, "proof.json");
    let image = &document["images"][0];
    assert_eq!(image["proved"], true);
    let listed = image["ties"]["listed"].as_array().expect("a list");
    assert_eq!(image["ties"]["pixels"], listed.len());
    let tie = listed.iter().find(|tie| tie["column"] == 138 && tie["row"] == 84).expect("a ray that touches");
    assert_eq!((&tie["proved"], &tie["open"]), (&serde_json::json!({ "tangent": 1 }), &serde_json::json!({})));

    // Two balls that are each other's mirror image, seen after some bounces on the mirror about them.
    let balls = "fov 50\nlight 1 1 1 0 .5 -2\nsurface .1 .1 .1 0 0 0 0 0 0 1 .9\nsphere 0 .2 1 10\n\
                 surface .2 .2 .2 .5 .5 .5 0 0 0 1 0\nsphere -.3 .1 5 1\nsphere .3 .1 5 1\n";
    folder.put("b.cli", format!("{balls}write b.png\n"));
    folder.clisc(&["run", "b.cli", "--precision", "certified", "--certificate", "open.json", "--size", "40x30"]);
    let document = certificate(&folder, "open.json");
    let image = &document["images"][0];
    assert_eq!(image["proved"], false);
    assert_eq!(image["unproved"]["pixels"], image["ties"]["open_pixels"]);
    let listed = image["ties"]["listed"].as_array().expect("a list");
    let open: Vec<_> = listed.iter().filter(|tie| tie["open"]["order"].is_u64()).collect();
    assert!(!open.is_empty() && open.iter().all(|tie| tie["column"] == 20), "{open:?}");
}

#[test]
fn what_is_not_proved_gets_no_certificate() {
    for precision in ["f32", "f64"] {
        let folder = Folder::with_scene(&scene("a.png"));
        let call = folder.clisc(&["run", "a.cli", "--precision", precision, "--certificate", "proof.json"]);
        assert_eq!(call.code, Some(2));
        assert!(call.stderr.contains("--precision certified or exact"), "{}", call.stderr);
        assert_eq!(folder.listing(), ["a.cli"]);
    }
}

#[test]
fn a_certificate_covers_the_images_that_were_saved() {
    let folder = Folder::with_scene(&scene("a.png"));
    folder.put("bad.cli", "sphere 1\n");
    let args = ["run", "a.cli", "bad.cli", "--precision", "certified", "--certificate", "proof.json", "--size", "9x9"];
    assert_eq!(folder.clisc(&args).code, Some(1));
    let document = certificate(&folder, "proof.json");
    assert_eq!(document["images"].as_array().map(Vec::len), Some(1));
}

#[test]
fn a_certificate_is_replaced_whole_or_stays() {
    let folder = Folder::with_scene(&scene("a.png"));
    folder.put("proof.json", "old");
    let args = ["run", "a.cli", "--precision", "certified", "--size", "9x9", "--certificate"];
    assert_eq!(folder.clisc(&[&args[..], &["proof.json"]].concat()).code, Some(0));
    certificate(&folder, "proof.json");
    let before = folder.listing();
    let call = folder.clisc(&[&args[..], &["missing/proof.json"]].concat());
    assert_eq!(call.code, Some(2));
    assert!(call.stderr.contains("cannot save the certificate `missing/proof.json`"), "{}", call.stderr);
    assert_eq!(folder.listing(), before);
    folder.clisc(&[&args[..], &["dry.json", "--dry-run"]].concat());
    assert_eq!(folder.listing(), before);
}
