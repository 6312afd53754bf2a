//! `grammar/semantics.md` says enough: a tracer written from that page alone paints the images of clisc.
//!
//! The tracer is `semantics/tracer.rs`. It is held against every image in `reference/`; the pixels in which it differs are
//! counted in the page (`CLISC_BLESS=1` writes the numbers there). The numbers of the page's worked pixels are computed anew.

mod support;
#[path = "semantics/tracer.rs"]
mod tracer;

use std::fs;
use std::path::Path;

use clisc::image::decode_png;
use glam::DVec3;
use rayon::prelude::*;
use serde_json::Value;

use tracer::{Request, Scene, reflect};

const PAGE: &str = "grammar/semantics.md";

/// The lines of the page that stand before and behind what is counted.
const COUNTED: [&str; 2] = ["<!-- counted by tests/semantics.rs -->\n", "<!-- end of what is counted -->\n"];

fn read(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// An image of `reference/`, as its manifest describes it.
struct Case {
    image: String,
    scene: Scene,
    request: Request,
}

fn cases() -> Vec<Case> {
    let manifest: Value = serde_json::from_str(&read("reference/manifest.json")).expect("a JSON document");
    let images = manifest["images"].as_array().expect("a list");
    let word = |entry: &Value, key: &str| entry[key].as_str().unwrap_or_else(|| panic!("{key}: {entry}")).to_owned();
    let case = |entry: &Value| {
        let size = word(entry, "size");
        let (width, height) = size.split_once('x').expect("a size WxH");
        let options = &entry["options"];
        let number = |key: &str, usual: u32| options[key].as_u64().map_or(usual, |n| u32::try_from(n).expect("small"));
        let text = read(&format!("scenes/{}", word(entry, "scene")));
        Case {
            image: word(entry, "image"),
            scene: Scene::read(&text, &word(entry, "write")),
            request: Request {
                width: width.parse().expect("a width"),
                height: height.parse().expect("a height"),
                is_part_a: options["part"] == "a",
                samples: number("samples", 1),
                is_centred: options["sample_at"] == "centre",
                max_level: number("max_level", 8),
            },
        }
    };
    images.iter().map(case).collect()
}

impl Case {
    fn is_stress(&self) -> bool {
        self.image.starts_with("stress/")
    }

    /// Returns the pixels of the tracer that are not those of the image, and the number of all.
    fn count_different(self) -> (Vec<String>, usize) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference").join(&self.image);
        let expected = decode_png(&fs::read(path).expect("an image")).expect("a PNG file");
        let expected: &[[u8; 3]] = expected.rgb().as_chunks().0;
        let (image, width) = (self.image, self.request.width as usize);
        let pixels = self.scene.image(&self.request);
        assert_eq!(pixels.len(), expected.len(), "{image}");
        let pairs = pixels.iter().zip(expected).enumerate().filter(|(_, (ours, theirs))| ours != theirs);
        let tell = |(at, (ours, theirs))| format!("{image} ({}, {}): {ours:?}, not {theirs:?}", at % width, at / width);
        (pairs.map(tell).collect(), expected.len())
    }
}

fn blesses() -> bool {
    std::env::var_os("CLISC_BLESS").is_some_and(|value| value == "1")
}

/// Returns 12345 as 12,345.
fn grouped(n: usize) -> String {
    let (more, last) = (n / 1000, n % 1000);
    if more == 0 { last.to_string() } else { format!("{},{last:03}", grouped(more)) }
}

#[test]
fn a_tracer_made_from_the_page_paints_the_images_of_clisc() {
    let (stress, ordinary): (Vec<Case>, Vec<Case>) = cases().into_iter().partition(Case::is_stress);
    let count = |cases: Vec<Case>| {
        let n_images = cases.len();
        let counts: Vec<_> = cases.into_par_iter().map(Case::count_different).collect();
        let n_pixels: usize = counts.iter().map(|(_, n)| n).sum();
        (n_images, counts.into_iter().flat_map(|(different, _)| different).collect::<Vec<_>>(), n_pixels)
    };
    let (n_images, different, n_pixels) = count(ordinary);
    assert!(different.is_empty(), "{}", different.join("\n"));
    let (n_stress_images, different, n_stress_pixels) = count(stress);
    let counted = format!(
        "It differs from `clisc` in 0 of {} pixels of the {n_images} images in `reference/`\n\
         that are made of ordinary scenes, and in {} of {} pixels of the {n_stress_images}\n\
         images of `scenes/stress`, which are made to break such tracers.\n",
        grouped(n_pixels),
        grouped(different.len()),
        grouped(n_stress_pixels),
    );
    let page = read(PAGE);
    let (before, rest) = page.split_once(COUNTED[0]).expect("a place for what is counted");
    let (told, behind) = rest.split_once(COUNTED[1]).expect("an end of what is counted");
    if blesses() {
        let text = [before, COUNTED[0], &counted, COUNTED[1], behind].concat();
        fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join(PAGE), text).expect("a written page");
    } else {
        assert_eq!(told, counted);
    }
}

/// Returns the section of the page below a heading.
fn section<'p>(page: &'p str, heading: &str) -> &'p str {
    let (_, behind) = page.split_once(&format!("\n## {heading}\n")).expect("the heading");
    behind.split("\n## ").next().expect("the section")
}

/// A number of the page and the digits that it shows behind the point.
fn number(text: &str) -> (f64, usize) {
    let text = text.trim().replace('−', "-");
    let digits = text.split_once('.').map_or(0, |(_, digits)| digits.len());
    (text.parse().unwrap_or_else(|_| panic!("no number: {text}")), digits)
}

/// The scene of the worked pixels, and what is asked of its image.
fn worked() -> (Scene, Request) {
    let scene = Scene::read(&read("scenes/first-steps/first.cli"), "first.png");
    let request = Request { width: 300, height: 300, is_part_a: false, samples: 1, is_centred: false, max_level: 8 };
    (scene, request)
}

/// The values of the first worked pixel, in the order of the page.
fn ball_in_the_light(scene: &Scene, request: &Request) -> Vec<(&'static str, Vec<f64>)> {
    let ray = scene.eye_ray(request, 135.0, 120.0);
    let d = ray.dir;
    let m = DVec3::new(0.0, 0.0, 4.0);
    let (a, b, e) = (d.dot(d), m.dot(d), m.dot(m) - 1.0);
    let hit = scene.nearest(ray).expect("the ball");
    let (p, n, light) = (hit.point, hit.normal, scene.lights[0]);
    let to_light = light.position - p;
    let (l, v) = (to_light.normalize(), -d.normalize());
    let h = (l + v).normalize();
    let reflected = reflect(ray, &hit);
    assert!(scene.nearest(reflected).is_none(), "the reflected ray meets nothing");
    let surface = hit.surface;
    let mirrored = surface.reflectance * scene.background;
    let sum = surface.ambient + scene.light(ray, &hit) + mirrored;
    let clamped = sum.clamp(DVec3::ZERO, DVec3::ONE);
    let list = |vector: DVec3| vector.to_array().to_vec();
    vec![
        ("k", vec![libm::tan(std::f64::consts::FRAC_PI_6)]),
        ("d", list(d)),
        ("a", vec![a]),
        ("b", vec![b]),
        ("e", vec![e]),
        ("b² − a·e", vec![b * b - a * e]),
        ("t", vec![hit.t]),
        ("p", list(p)),
        ("n", list(n)),
        ("n·d", vec![n.dot(d)]),
        ("position − p", list(to_light)),
        ("|position − p|", vec![to_light.length()]),
        ("L", list(l)),
        ("|d|", vec![d.length()]),
        ("V", list(v)),
        ("L + V", list(l + v)),
        ("|L + V|", vec![(l + v).length()]),
        ("H", list(h)),
        ("n·L", vec![n.dot(l)]),
        ("n·H", vec![n.dot(h)]),
        ("(n·H)^20", vec![libm::pow(n.dot(h), 20.0)]),
        ("Cl·(Cd·(n·L) + Cs·(n·H)^20)", list(scene.light(ray, &hit))),
        ("r", list(reflected.dir)),
        ("Krefl·background", list(mirrored)),
        ("Ca + lights + reflection", list(sum)),
        ("clamped", list(clamped)),
        ("255·c", list(255.0 * clamped)),
    ]
}

/// The values of the second worked pixel, in the order of the page.
fn table_in_the_shadow(scene: &Scene, request: &Request) -> Vec<(&'static str, Vec<f64>)> {
    let ray = scene.eye_ray(request, 210.0, 200.0);
    let hit = scene.nearest(ray).expect("the table");
    assert_eq!(hit.normal, DVec3::Y, "the cap of the table");
    assert!(scene.is_hidden(&hit, &scene.lights[0]), "the ball hides the light");
    let p = hit.point;
    let (q, m) = (scene.lights[0].position - p, p - DVec3::new(0.0, 0.0, -4.0));
    let (a, b, e) = (q.dot(q), m.dot(q), m.dot(m) - 1.0);
    let list = |vector: DVec3| vector.to_array().to_vec();
    vec![
        ("d", list(ray.dir)),
        ("t", vec![hit.t]),
        ("p", list(p)),
        ("distance to the axis", vec![p.x.hypot(p.z + 6.0)]),
        ("q", list(q)),
        ("p − c", list(m)),
        ("a", vec![a]),
        ("b", vec![b]),
        ("e", vec![e]),
        ("b² − a·e", vec![b * b - a * e]),
        ("t", vec![(-b - (b * b - a * e).sqrt()) / a]),
        ("255·c", list(255.0 * hit.surface.ambient)),
    ]
}

#[test]
fn the_worked_pixels_are_worked_out_right() {
    let (scene, request) = worked();
    let pixels = scene.clone().image(&request);
    let saved = |column: usize, row: usize| {
        let rgb = pixels[row * request.width as usize + column];
        ("saved", rgb.map(f64::from).to_vec())
    };
    let mut expected = ball_in_the_light(&scene, &request);
    expected.push(saved(135, 120));
    expected.extend(table_in_the_shadow(&scene, &request));
    expected.push(saved(210, 200));

    let page = read(PAGE);
    let lines = section(&page, "Example").lines().filter_map(|line| line.strip_prefix("    "));
    let told: Vec<&str> = lines.collect();
    assert_eq!(told.len(), expected.len(), "{told:#?}");
    for (line, (name, values)) in told.into_iter().zip(expected) {
        let (told_name, _) = line.split_once(" = ").expect("a name and a value");
        assert_eq!(told_name, name, "{line}");
        let (_, result) = line.rsplit_once(" = ").expect("a value");
        let numbers: Vec<_> = result.trim_matches(['(', ')']).split(',').map(number).collect();
        assert_eq!(numbers.len(), values.len(), "{line}");
        for ((number, digits), value) in numbers.into_iter().zip(values) {
            // Zeros at the end are not written, so at least six digits are meant, or four of a channel.
            let shown = if name == "255·c" || value.abs() >= 100.0 { 4 } else { 6 };
            let half_a_digit = 0.5 * libm::exp10(-(digits.max(shown) as f64));
            assert!((number - value).abs() <= half_a_digit * 1.000_001, "{line}: {value}");
        }
    }
}

#[test]
fn the_worked_pixels_are_those_that_clisc_renders() {
    let (scene, request) = worked();
    let text = read("scenes/first-steps/first.cli");
    let program = support::views::compile(&text);
    let settings = clisc::exact::Settings::default();
    assert_eq!((settings.width, settings.height), (request.width, request.height));
    let renderer = clisc::exact::Renderer::new(support::views::last_view(&program), &settings);
    let pixels = scene.image(&request);
    for (column, row) in [(135, 120), (210, 200)] {
        let pixel = pixels[(row * request.width + column) as usize];
        assert_eq!(renderer.pixel(column, row).rgb, pixel, "column {column}, row {row}");
    }
}

/// The page says what plain binary64 cannot: eight eye rays touch a sphere, and rounding makes them miss it.
#[test]
fn ties_are_what_the_tracer_gets_wrong() {
    let folder = support::Folder::new();
    folder.put("fov.cli", read("scenes/commands/fov.cli"));
    let call = folder.clisc(&["run", "fov.cli"]);
    assert_eq!(call.code, Some(0), "{}", call.stderr);
    let image = folder.image("fov.png");
    let (_, request) = worked();
    let scene = Scene::read(&read("scenes/commands/fov.cli"), "fov.png");
    let background = scene.background.to_array().map(|channel| (255.0 * channel) as u8);
    let pixels = scene.image(&request);
    let (expected, _) = image.rgb().as_chunks();
    let different: Vec<_> = pixels.iter().zip(expected).filter(|(ours, theirs)| ours != theirs).collect();
    assert_eq!(different.len(), 8);
    assert!(different.iter().all(|(ours, _)| **ours == background), "{different:?}");
}

#[test]
fn the_page_shows_the_scene_as_it_is() {
    let text = read("scenes/first-steps/first.cli");
    let commands: Vec<_> = text.lines().filter(|line| !line.is_empty() && !line.starts_with('#')).collect();
    let block = format!("```cli\n{}\n```\n", commands.join("\n"));
    assert!(read(PAGE).contains(&block), "{block}");
}

/// `clisc explain` prints sections in a terminal.
#[test]
fn the_page_fits_a_terminal() {
    let page = read(PAGE);
    let long: Vec<_> = page.lines().filter(|line| line.chars().count() > 80).collect();
    assert!(long.is_empty(), "{long:#?}");
}
