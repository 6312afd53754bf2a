//! Golden images: every scene below `scenes/` renders to the images in `reference/`.
//!
//! `reference/manifest.json` says for each image which scene and options make it, who made it, and how far a render may
//! differ. A failing image leaves its actual and difference images below the target folder. `CLISC_BLESS=1` makes them by
//! `--precision exact`, which shares nothing with the tracer that the test renders with: it adds the images of new scenes,
//! replaces those that differ, and drops those whose scene is gone.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clisc::exec::{CancellationToken, MemorySink, Options, execute};
use clisc::image::{RgbImage, compare, compare_rows, decode_png, difference_image, encode_png};
use clisc::ir::{self, Command};
use clisc::plan::{BackendChoice, Part, Precision, SampleAt, Settings, Size};
use clisc::source::Source;
use clisc::trace::kernels::Backend;
use serde::{Deserialize, Serialize};

/// The size of a new golden image.
const GOLDEN_SIZE: &str = "64x48";

/// Images of which plain f64 gets pixels wrong, as docs/accuracy.md says.
const BEYOND_F64: [&str; 1] = ["stress/near-rims.png"];

/// What this program signs with.
const PRODUCER: &str = concat!("clisc ", env!("CARGO_PKG_VERSION"), " --precision exact");

/// The only metric so far: pixels of which some channel differs.
const METRIC: &str = "differing-pixels";

/// The most pixels, row 0 left out, in which `i1` to `i10` may differ from their original images. An exact evaluation of
/// the rules differs in as many: those pixels are roundings of the original program.
const ORIGINAL_LIMITS: [u64; 10] = [0, 2, 0, 0, 5, 2, 4, 0, 15, 13];

/// `reference/manifest.json`.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Manifest {
    images: Vec<Reference>,
}

/// One golden image.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Reference {
    /// The file, below `reference/`.
    image: String,
    /// The scene, below `scenes/`.
    scene: String,
    /// The name in the `write` that makes it.
    write: String,
    /// `WxH`.
    size: String,
    #[serde(default, skip_serializing_if = "RenderOptions::is_default")]
    options: RenderOptions,
    /// The program that made it.
    producer: String,
    /// CRC-32 of its pixels, 3 bytes each, row by row.
    crc32: String,
    metric: String,
    tolerance: u64,
}

/// Options of a render that are not the usual ones.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct RenderOptions {
    #[serde(skip_serializing_if = "Option::is_none")]
    part: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    samples: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sample_at: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max_level: Option<u32>,
}

impl RenderOptions {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// # Panics
    /// When the manifest says something that is no option.
    fn settings(&self, size: &str) -> Settings {
        let (width, height) = size.split_once('x').expect("a size WxH");
        let size = Size::new(width.parse().expect("a width"), height.parse().expect("a height")).expect("a size");
        let part = match self.part.as_deref() {
            Some("a") => Part::A,
            Some("b") | None => Part::B,
            Some(other) => panic!("no part `{other}`"),
        };
        let sample_at = match self.sample_at.as_deref() {
            Some("centre") => SampleAt::Centre,
            Some("corner") | None => SampleAt::Corner,
            Some(other) => panic!("no place `{other}`"),
        };
        let usual = Settings::default();
        let (samples, max_level) = (self.samples.unwrap_or(usual.samples), self.max_level.unwrap_or(usual.max_level));
        Settings { size, part, samples, sample_at, max_level, ..Settings::default() }
    }
}

fn usual(precision: Precision) -> Settings {
    Settings { precision, ..Settings::default() }
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn blesses() -> bool {
    std::env::var_os("CLISC_BLESS").is_some_and(|value| value == "1")
}

/// Returns the files below a folder whose names end so, relative to it, sorted; none when there is no folder.
fn files_below(folder: &Path, ending: &str) -> BTreeSet<String> {
    let mut files = BTreeSet::new();
    let mut ahead = vec![folder.to_owned()];
    while let Some(next) = ahead.pop() {
        let Ok(entries) = fs::read_dir(&next) else { continue };
        for entry in entries {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                ahead.push(path);
            } else if let Some(name) = path.strip_prefix(folder).expect("a path below").to_str() {
                files.extend(name.ends_with(ending).then(|| name.to_owned()));
            }
        }
    }
    files
}

/// Returns the scenes that have images: all but those made to be wrong.
fn scenes() -> BTreeSet<String> {
    files_below(&root().join("scenes"), ".cli").into_iter().filter(|scene| !scene.starts_with("invalid/")).collect()
}

fn compile(path: &Path) -> ir::Valid {
    let bytes = fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let source = Source::from_bytes(path.display().to_string(), bytes).expect("a scene below 4 GiB");
    let compilation = clisc::compile(&source);
    assert!(!compilation.has_errors(), "{}: {:#?}", path.display(), compilation.diagnostics);
    ir::validate(compilation.program).expect("a sound program")
}

/// Renders every image of a scene; the keys are the names in the scene.
fn render(path: &Path, settings: &Settings) -> BTreeMap<String, RgbImage> {
    let mut sink = MemorySink::default();
    let options = Options { settings, observer: &(), cancellation: &CancellationToken::new() };
    execute(&compile(path), options, &mut sink).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    sink.files.into_iter().map(|(name, file)| (name, decode_png(&file).expect("a PNG file"))).collect()
}

fn crc32(image: &RgbImage) -> String {
    format!("{:08x}", crc32fast::hash(image.rgb()))
}

fn read_manifest() -> Manifest {
    match fs::read_to_string(root().join("reference/manifest.json")) {
        Ok(text) => serde_json::from_str(&text).expect("a sound manifest"),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Manifest::default(),
        Err(error) => panic!("reference/manifest.json: {error}"),
    }
}

/// Returns a manifest entry for each image that the manifest lacks.
fn missing_references(manifest: &Manifest) -> Vec<Reference> {
    let listed: BTreeSet<_> = manifest.images.iter().map(|r| (r.scene.as_str(), r.write.as_str())).collect();
    let mut missing = Vec::new();
    for scene in scenes() {
        let program = compile(&root().join("scenes").join(&scene));
        let writes = program.commands.iter().filter_map(|command| match command {
            Command::Write(name) => Some(&**name),
            _ => None,
        });
        let writes: BTreeSet<_> = writes.collect();
        for write in &writes {
            if !listed.contains(&(scene.as_str(), *write)) {
                missing.push(new_reference(&scene, write, writes.len() == 1));
            }
        }
    }
    missing
}

/// Names an image after its scene, and after its `write` too where the scene has several.
fn new_reference(scene: &str, write: &str, is_only: bool) -> Reference {
    let scene_stem = scene.trim_end_matches(".cli");
    let write_stem = write.trim_end_matches(".png").replace(['/', '\\', ' '], "-");
    Reference {
        image: if is_only { format!("{scene_stem}.png") } else { format!("{scene_stem}-{write_stem}.png") },
        scene: scene.to_owned(),
        write: write.to_owned(),
        size: GOLDEN_SIZE.to_owned(),
        options: RenderOptions::default(),
        producer: PRODUCER.to_owned(),
        crc32: String::new(),
        metric: METRIC.to_owned(),
        tolerance: 0,
    }
}

/// Renders the image of each entry; entries of one scene and the same options share a render. `usual` has what no entry says.
fn render_all(references: &[Reference], usual: &Settings) -> Vec<RgbImage> {
    let mut renders = BTreeMap::new();
    let mut images = Vec::new();
    for Reference { scene, write, size, options, .. } in references {
        let images_of_scene = renders.entry((scene, size, options)).or_insert_with(|| {
            let (precision, backend) = (usual.precision, usual.backend);
            render(&root().join("scenes").join(scene), &Settings { precision, backend, ..options.settings(size) })
        });
        let image = images_of_scene.get(write).unwrap_or_else(|| panic!("{scene} does not write `{write}`"));
        images.push(image.clone());
    }
    images
}

/// Compares a render with its golden image; says what is wrong.
fn check(reference: &Reference, actual: &RgbImage) -> Result<(), String> {
    assert_eq!(reference.metric, METRIC, "an unknown metric");
    let path = root().join("reference").join(&reference.image);
    let bytes = fs::read(&path).map_err(|error| error.to_string())?;
    let expected = decode_png(&bytes).map_err(|error| error.to_string())?;
    if crc32(&expected) != reference.crc32 {
        return Err("the file is not the one that the manifest knows".to_owned());
    }
    let difference = compare(actual, &expected).map_err(|error| error.to_string())?;
    if difference.n_differing <= reference.tolerance {
        return Ok(());
    }
    Err(format!("{difference}\n  see {}", keep_evidence(&reference.image, actual, &expected).display()))
}

/// Saves the actual and the difference image below the target folder; returns where.
fn keep_evidence(name: &str, actual: &RgbImage, expected: &RgbImage) -> PathBuf {
    let stem = Path::new(env!("CARGO_TARGET_TMPDIR")).join("images").join(name.trim_end_matches(".png"));
    let difference = difference_image(actual, expected).expect("images of one size");
    for (what, image) in [("actual", actual), ("difference", &difference)] {
        save(&stem.with_extension(format!("{what}.png")), image);
    }
    stem.with_extension("{actual,difference}.png")
}

fn save(path: &Path, image: &RgbImage) {
    fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    fs::write(path, encode_png(image).expect("an image")).expect("a written image");
}

/// Brings images and manifest up to date; images that still hold are left as they are.
fn bless(mut manifest: Manifest) {
    let scenes = scenes();
    manifest.images.retain(|reference| scenes.contains(&reference.scene));
    manifest.images.extend(missing_references(&manifest));
    let renders = render_all(&manifest.images, &usual(Precision::Exact));
    for (reference, actual) in manifest.images.iter_mut().zip(&renders) {
        PRODUCER.clone_into(&mut reference.producer);
        if check(reference, actual).is_err() {
            reference.crc32 = crc32(actual);
            save(&root().join("reference").join(&reference.image), actual);
        }
    }
    manifest.images.sort_by(|a, b| a.image.cmp(&b.image));
    for stray in files_below(&root().join("reference"), ".png") {
        if !manifest.images.iter().any(|reference| reference.image == stray) {
            fs::remove_file(root().join("reference").join(stray)).expect("a removable file");
        }
    }
    let text = serde_json::to_string_pretty(&manifest).expect("a manifest") + "\n";
    fs::create_dir_all(root().join("reference")).expect("a folder");
    fs::write(root().join("reference/manifest.json"), text).expect("a written manifest");
}

#[test]
fn every_scene_renders_to_its_golden_images() {
    let manifest = read_manifest();
    if blesses() {
        return bless(manifest);
    }
    let missing = missing_references(&manifest);
    let mut faults: Vec<_> =
        missing.iter().map(|r| format!("{}: `{}` has no golden image", r.scene, r.write)).collect();
    for precision in [Settings::default().precision, Precision::F64] {
        for (reference, actual) in manifest.images.iter().zip(render_all(&manifest.images, &usual(precision))) {
            let fault = check(reference, &actual).err();
            if precision == Precision::F64 && BEYOND_F64.contains(&&*reference.image) {
                faults.extend(fault.is_none().then(|| format!("{}: f64 is right now", reference.image)));
            } else {
                faults.extend(fault.map(|fault| format!("{} in {}: {fault}", reference.image, precision.name())));
            }
        }
    }
    assert!(faults.is_empty(), "{}\nCLISC_BLESS=1 accepts what is rendered now", faults.join("\n"));
}

/// Every backend that this machine has gives the same bytes, proved or drafted.
#[test]
fn every_backend_gives_the_same_images() {
    let choices = [BackendChoice::Scalar, BackendChoice::Avx2, BackendChoice::Avx512];
    let available: Vec<_> = choices.into_iter().filter(|choice| Backend::chosen(*choice).is_available()).collect();
    if available.len() < choices.len() {
        let _ = writeln!(io::stderr(), "\nSKIPPED: this machine has only {available:?}");
    }
    let references = read_manifest().images;
    for precision in [Precision::F64, Precision::F32] {
        let images = available.iter().map(|backend| {
            let usual = Settings { precision, backend: *backend, ..Settings::default() };
            render_all(&references, &usual)
        });
        let images: Vec<_> = images.collect();
        for (backend, by_backend) in available.iter().zip(&images) {
            for ((reference, image), by_scalar) in references.iter().zip(by_backend).zip(&images[0]) {
                assert_eq!(image.rgb(), by_scalar.rgb(), "{} by {backend:?} in {}", reference.image, precision.name());
            }
        }
    }
}

#[test]
fn every_golden_image_is_listed_once() {
    if blesses() {
        return;
    }
    let manifest = read_manifest();
    assert!(manifest.images.iter().all(|reference| reference.producer == PRODUCER), "not all are made by `exact`");
    let listed: BTreeSet<_> = manifest.images.iter().map(|reference| reference.image.clone()).collect();
    assert_eq!(listed.len(), manifest.images.len(), "an image is listed twice");
    assert_eq!(files_below(&root().join("reference"), ".png"), listed);
}

#[test]
fn original_scenes_render_to_their_original_images() {
    let folder = root().join("../shared/course/2018");
    if !folder.is_dir() {
        let _ = writeln!(io::stderr(), "\nSKIPPED: the original scenes are not at {}", folder.display());
        return;
    }
    let mut faults = Vec::new();
    for (n, limit) in (1..).zip(ORIGINAL_LIMITS) {
        let name = format!("i{n}.png");
        let images = render(&folder.join(format!("i{n}.cli")), &Settings::default());
        let expected = decode_png(&fs::read(folder.join(&name)).expect("an original image")).expect("a PNG file");
        // The original program never filled row 0.
        let difference = compare_rows(&images[&name], &expected, 1..300).expect("images of one size");
        if difference.n_differing > limit {
            let evidence = keep_evidence(&format!("original/{name}"), &images[&name], &expected);
            faults.push(format!("{name}: {difference}, {limit} may\n  see {}", evidence.display()));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
