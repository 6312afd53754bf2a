//! What is certified is right: in every pixel what `exact` gives, or a tie that is listed.
//!
//! A certificate says that an error is below a bound. Bytes alone would show that badly: an error of a billionth changes
//! one byte in millions. So the channels themselves, before they are rounded, are held against `exact`, each with the bound
//! that was claimed for it; and then the packets are made wrong on purpose, to see what this finds and what it does not.

mod families;
mod support;

use std::fs;
use std::path::Path;

use clisc::exact::{Allowance, Pixel, Record, Renderer, Tie, TiePlace};
use clisc::exec::{CancellationToken, MemorySink, Options, Origin, WriteReport, exact_settings, execute};
use clisc::image::{RgbImage, decode_png};
use clisc::ir::{SceneView, Valid};
use clisc::plan::{ExactWork, Pass, Passes, Precision, Settings, Size, plan};
use clisc::trace::{Fault, Tracer};
use rayon::prelude::*;

use families::{FAMILIES, FINEST};
use support::views::{compile, last_view};

fn sized(width: u32, height: u32) -> Settings {
    let size = Size::new(width, height).expect("a size within the limits");
    Settings { size, precision: Precision::Certified, exact_work: ExactWork::Unlimited, ..Settings::default() }
}

/// Executes a program; returns its reports, and its images by their names.
fn run(program: &Valid, settings: &Settings) -> Vec<(WriteReport, RgbImage)> {
    let mut sink = MemorySink::default();
    let options = Options { settings, observer: &(), cancellation: &CancellationToken::new() };
    let reports = execute(program, options, &mut sink).expect("memory takes every image");
    let image = |name: &str| decode_png(&sink.files[name]).expect("a PNG file");
    reports.into_iter().map(|report| (report.clone(), image(&report.name))).collect()
}

/// Makes every pixel exactly, row by row.
fn exact_pixels(view: SceneView<'_>, settings: &Settings) -> Vec<Pixel> {
    let renderer = Renderer::new(view, &exact_settings(settings));
    let (width, height) = (settings.size.width(), settings.size.height());
    (0..width * height).into_par_iter().map(|i| renderer.pixel(i % width, i / width)).collect()
}

/// Checks one image and its proof against `exact`.
fn assert_is_certified(title: &str, text: &str, settings: &Settings) {
    let program = compile(text);
    let (report, image) = run(&program, settings).pop().expect("an image");
    let exact = exact_pixels(last_view(&program), settings);
    let wrong = (0..).zip(image.rgb().as_chunks().0).zip(&exact).filter(|((_, rgb), exact)| **rgb != exact.rgb);
    let wrong: Vec<_> = wrong.map(|((i, rgb), exact)| (i, *rgb, exact)).collect();
    assert!(wrong.is_empty(), "{title}: {} pixels are wrong\n{:?}\n{text}", wrong.len(), &wrong[..wrong.len().min(3)]);

    let proof = report.proof.expect("everything is proved");
    let n_pixels = proof.n_binary64 + proof.n_double_double + proof.n_long + proof.exact.n_pixels() + proof.n_shared;
    assert_eq!(n_pixels, exact.len() as u64, "{title}");
    assert!(proof.largest_bound < 0.5, "{title}: a bound of {} levels", proof.largest_bound);
    // Every tie of the image is a tie to `exact` too; the tracer may prove a pixel that `exact` leaves open, and touch a wall
    // beyond its caps, where `exact` need not look.
    let testing_all = Renderer::new(last_view(&program), &exact_settings(settings)).testing_all();
    let width = settings.size.width();
    for place in &proof.exact.ties {
        let pixel = &exact[(place.row * width + place.column) as usize];
        assert_eq!(pixel.open_ties, place.open, "{title} at ({}, {})", place.column, place.row);
        let all = testing_all.pixel(place.column, place.row);
        let is_tie = |tie: Tie| place.proved.of(tie) <= all.proved_ties.of(tie) + all.algebraic_ties.of(tie);
        assert!([Tie::Tangent, Tie::Rim].into_iter().all(is_tie), "{title}: {place:?}, and to exact {all:?}");
    }
}

#[test]
fn every_family_is_certified_the_finest_among_them() {
    for family in FAMILIES.iter().chain(FINEST) {
        for seed in [0, 7] {
            assert_is_certified(&format!("{} seed {seed}", family.name), &family.sketch(seed).text(), &sized(30, 23));
        }
    }
}

#[test]
fn every_scene_under_stress_is_certified() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/stress");
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "cli") {
            continue;
        }
        let text = fs::read_to_string(&path).expect("a scene in UTF-8");
        assert_is_certified(&path.display().to_string(), &text, &sized(20, 15));
    }
}

/// Mirrors so deep, and lights so bright, that double-double decides no pixel of some areas.
const BEYOND_DOUBLE_DOUBLE: [(&str, u32); 2] = [
    (
        "light 1 1 1 0 0 -1\nsurface .01 0 0 .001 .001 .001 0 0 0 1 1\nsphere 0 0 0 10\nsphere 0 0 -5 1\nwrite i.png\n",
        50,
    ),
    (
        "light 1e100 1e100 1e100 0 5 0\nlight -1e100 -1e100 -1e100 0 5 0\nsurface .1 .1 .1 1 1 1 0 0 0 0 0\n\
         sphere 0 0 -4 1\nwrite i.png\n",
        8,
    ),
];

#[test]
fn what_double_double_leaves_open_is_proved_without_arbitrary_precision() {
    for (text, max_level) in BEYOND_DOUBLE_DOUBLE {
        let settings = Settings { max_level, exact_work: ExactWork::Limited, ..sized(12, 12) };
        assert_is_certified("beyond double-double", text, &settings);
        let (report, _) = run(&compile(text), &settings).pop().expect("an image");
        let proof = report.proof.expect("everything is proved");
        assert!(proof.n_long > 12 && proof.exact.n_pixels() == 0 && proof.is_complete(), "{proof:?}");
    }
}

#[test]
fn a_row_of_deep_mirrors_takes_no_more_than_it_may() {
    let (text, max_level) = BEYOND_DOUBLE_DOUBLE[0];
    let settings = Settings { max_level, ..limited(800, 2) };
    let images = run_on_any_threads(&compile(text), &settings);
    let (report, _) = &images[0];
    let proof = report.proof.as_ref().expect("a proof");
    assert!(proof.n_long > 0 && n_beyond_limit(report) > 0, "{proof:?}");
}

#[test]
fn what_the_tracer_cannot_scale_is_left_to_exact() {
    // The speck is 10⁻³⁰⁰ of the ball behind it: scaled to its size it would be nothing.
    let text = format!("{SPECK}write i.png\n");
    assert_is_certified("speck before a giant", &text, &sized(16, 12));
    let (report, image) = run(&compile(&text), &sized(16, 12)).pop().expect("an image");
    assert_eq!(report.proof.map(|proof| proof.exact.n_pixels()), Some(16 * 12));
    assert_eq!(image.pixel(8, 6), [153; 3]);
}

/// With k² = 1/3 some eye rays touch this ball; no finite precision can tell, but algebra can.
const TOUCHED: &str = "fov 60\nlight 1 1 1 0 0 5\nsurface 0 .2 0 .4 .1 .1 0 0 0 1 0\nsphere 0 0 -4 1\n";

#[test]
fn ties_are_listed_in_the_proof() {
    let program = compile(&format!("{TOUCHED}write i.png\n"));
    let (report, image) = run(&program, &sized(300, 300)).pop().expect("an image");
    let proof = report.proof.expect("everything is proved");
    let places: Vec<_> = proof.exact.ties.iter().map(|place| (place.column, place.row)).collect();
    assert!(places.contains(&(138, 84)), "{places:?}");
    assert_eq!((image.pixel(138, 84), image.pixel(138, 83)), ([14, 54, 3], [0; 3]));
    assert_eq!(report.counts.ties, proof.exact.n_ties);
    assert!(proof.is_complete(), "all are proved to touch");
}

#[test]
fn eye_rays_that_touch_take_no_exact_work() {
    let ground = "fov 60\nlight 1 1 1 0 2 0\nsurface .1 .1 .1 .5 .5 .5 0 0 0 1 0\ncylinder 10 0 0 -2 -1\n";
    for (text, tie, n_places) in [(TOUCHED, Tie::Tangent, 16), (ground, Tie::Rim, 3)] {
        let (program, settings) = (compile(&format!("{text}write i.png\n")), sized(300, 300));
        let (report, _) = run(&program, &settings).pop().expect("an image");
        let record = report.proof.expect("everything is proved").exact;
        assert_eq!((record.n_pixels(), record.ties.len()), (0, n_places), "{text}{record:?}");
        let exact = Renderer::new(last_view(&program), &exact_settings(&settings));
        for place in &record.ties {
            assert_eq!(TiePlace::of(place.column, place.row, &exact.pixel(place.column, place.row)), Some(*place));
            assert_eq!(place.proved.of(tie), place.n_ties(), "{place:?}");
        }
    }
}

#[test]
fn the_proof_of_a_copy_is_that_of_its_original() {
    let program = compile(&format!("{TOUCHED}write a.png\nwrite b.png\nsphere 0 0 9 1\nwrite c.png\n"));
    for precision in [Precision::Certified, Precision::Exact] {
        let settings = Settings { precision, ..sized(60, 60) };
        let images = run(&program, &settings);
        // A sphere more that no ray meets is work, and no other proof.
        let proof_of = |report: &WriteReport| {
            let mut proof = report.proof.clone().expect("everything is proved");
            proof.exact.work = 0;
            (proof, report.crc32)
        };
        for (report, _) in &images {
            assert_eq!(proof_of(report), proof_of(&images[0].0), "{}", report.name);
        }
    }
}

#[test]
fn shared_pixels_are_counted_and_their_ties_are_listed() {
    let plain = "light 1 1 1 0 0 5\nsurface 0 .2 0 .4 .1 .1 0 0 0 1 0\nsphere -.77 .1 -4.3 .71\nwrite a.png\n\
                 sphere 1.1 0 -5 .3\nwrite b.png\n";
    let images = run(&compile(plain), &sized(200, 150));
    let proof = images[1].0.proof.as_ref().expect("everything is proved");
    assert!(proof.n_shared > 0, "{proof:?}");
    let all = proof.n_binary64 + proof.n_double_double + proof.n_long + proof.exact.n_pixels() + proof.n_shared;
    assert_eq!(all, 200 * 150);

    let tied = format!("{TOUCHED}write a.png\nsphere 1.6 0 -5 .1\nwrite b.png\n");
    let passes = Passes::all().without(Pass::Writes);
    let [shared, traced] = [sized(300, 300), Settings { passes, ..sized(300, 300) }].map(|settings| {
        let mut images = run(&compile(&tied), &settings);
        images.pop().and_then(|(report, _)| report.proof).expect("everything is proved")
    });
    assert!(shared.n_shared > 0 && traced.n_shared == 0 && shared.exact.n_tied_pixels > 0, "{shared:?}");
    assert_eq!(shared.exact.ties, traced.exact.ties);
    let sums = |record: &Record| (record.n_tied_pixels, record.n_open_pixels, record.n_ties);
    assert_eq!(sums(&shared.exact), sums(&traced.exact));
}

/// A scene that the tracer cannot scale: `exact` makes every pixel.
const SPECK: &str = "light 1 1 1 0 0 5e-150\nsurface .1 .1 .1 .5 .5 .5 0 0 0 1 0\nsphere 0 0 -4e-150 1e-150\n\
                     surface .1 0 0 .9 0 0 0 0 0 1 .5\nsphere 0 0 -4e150 3.9e150\n";

/// Executes a program in pools of several sizes, checks that no byte and no finding depends on that, and returns the reports
/// with their images.
fn run_on_any_threads(program: &Valid, settings: &Settings) -> Vec<(WriteReport, RgbImage)> {
    let [one, three] = [1, 3].map(|n_threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().expect("threads");
        pool.install(|| run(program, settings))
    });
    for ((report, image), (other, other_image)) in one.iter().zip(&three) {
        assert!(image == other_image, "{}", report.name);
        let findings = |report: &WriteReport| (report.proof.clone(), report.unproved.clone(), report.crc32);
        assert_eq!(findings(report), findings(other), "{}", report.name);
        let sums = |report: &WriteReport| {
            let counts = report.counts;
            (counts.exact_pixels, counts.unproved_pixels, counts.ties, counts.refined_pixels)
        };
        assert_eq!(sums(report), sums(other), "{}", report.name);
    }
    one
}

fn limited(width: u32, height: u32) -> Settings {
    Settings { exact_work: ExactWork::Limited, ..sized(width, height) }
}

fn in_f64(settings: &Settings) -> Settings {
    Settings { precision: Precision::F64, ..settings.clone() }
}

/// Checks that the pixels of a proof add up to the image, and returns how many are beyond the limit.
fn n_beyond_limit(report: &WriteReport) -> u64 {
    let proof = report.proof.as_ref().expect("every image has one");
    let all = [
        proof.n_binary64,
        proof.n_double_double,
        proof.n_long,
        proof.exact.n_pixels(),
        proof.n_beyond_limit,
        proof.n_shared,
    ];
    assert_eq!(all.into_iter().sum::<u64>(), report.n_pixels());
    assert_eq!(report.unproved.n_pixels, proof.n_beyond_limit);
    assert!(report.unproved.listed.is_sorted());
    proof.n_beyond_limit
}

#[test]
fn an_image_beyond_the_limit_keeps_what_is_proved() {
    let program = compile(&format!("{SPECK}write a.png\nwrite b.png\nsphere 0 0 9 1\nwrite c.png\n"));
    let images = run_on_any_threads(&program, &limited(200, 200));
    let renderer = Renderer::new(last_view(&program), &exact_settings(&limited(200, 200)));
    for (report, image) in &images {
        let (proof, n_beyond) = (report.proof.as_ref().expect("a proof"), n_beyond_limit(report));
        assert!(n_beyond > 0 && proof.exact.n_pixels() > 0 && !proof.is_complete(), "{report:?}");
        assert_eq!((report.n_unproved(), report.precision), (n_beyond, Precision::Certified));
        // The work is spent from the top.
        let first = report.unproved.listed[0];
        assert_eq!(u64::from(first.row) * 200 + u64::from(first.column), 40_000 - n_beyond);
        for place in report.unproved.listed.iter().step_by(499) {
            let exact = renderer.pixel(place.column, place.row).rgb;
            assert_eq!(image.pixel(place.column, place.row), exact, "{place:?} has its best value");
        }
    }
    // So little that everything is proved.
    let (report, _) = run(&compile(&format!("{SPECK}write a.png\n")), &limited(16, 12)).pop().expect("an image");
    assert!(n_beyond_limit(&report) == 0 && report.proof.is_some_and(|proof| proof.is_complete()));
}

/// A ball in a mirrored ball: bounds grow a thousandfold with each bounce, what is computed does not go wrong.
const MIRROR_DEPTH: &str = "fov 60\nlight 1 1 1 0 0 -1\nsurface .01 0 0 .001 .001 .001 0 0 0 1 1\n\
                            sphere 0 0 0 10\nsphere 0 0 -5 1\nwrite a.png\n";

#[test]
fn what_bounds_leave_open_has_the_sign_that_was_computed() {
    let program = compile(MIRROR_DEPTH);
    let settings = Settings { max_level: 50, ..sized(12, 12) };
    let exact: Vec<_> = exact_pixels(last_view(&program), &settings).iter().map(|pixel| pixel.rgb).collect();
    let (plain_report, plain) = run_on_any_threads(&program, &in_f64(&settings)).pop().expect("an image");
    assert!(plain.rgb().as_chunks().0 == exact, "not one is wrong");
    assert!(plain_report.n_unproved() > 100 && plain_report.proof.is_none(), "{plain_report:?}");
    let bare = Settings { passes: Passes::none(), ..in_f64(&settings) };
    assert!(run(&program, &bare)[0].1 == plain);
}

#[test]
fn lights_that_cancel_leave_what_is_dark() {
    let program = compile(
        "fov 60\nlight 1e100 1e100 1e100 0 5 0\nlight -1e100 -1e100 -1e100 0 5 0\n\
         surface .1 .1 .1 1 1 1 0 0 0 0 0\nsphere 0 0 -4 1\nwrite a.png\n",
    );
    for settings in [limited(100, 100), in_f64(&sized(100, 100))] {
        let (_, image) = run(&program, &settings).pop().expect("an image");
        assert_eq!(image.pixel(50, 40), [25; 3]);
    }
}

#[test]
fn no_pixel_in_f64_depends_on_passes_proved_or_not() {
    let mut n_unproved = 0;
    for family in FAMILIES.iter().chain(FINEST) {
        let program = compile(&family.sketch(2).text());
        let [skipped, bare] = [Passes::all(), Passes::none()]
            .map(|passes| run(&program, &Settings { passes, ..in_f64(&sized(40, 30)) }).pop().expect("an image"));
        assert!(skipped.1 == bare.1, "{}", family.name);
        n_unproved += skipped.0.n_unproved();
    }
    assert!(n_unproved > 0);
}

#[test]
fn images_share_no_pixels_that_are_not_proved() {
    let text = MIRROR_DEPTH.replace("write a.png\n", "write a.png\nsphere 0 30 0 .1\nwrite b.png\nwrite c.png\n");
    let settings = Settings { max_level: 50, ..in_f64(&sized(12, 12)) };
    let images = run(&compile(&text), &settings);
    let origins: Vec<_> = images.iter().map(|(report, _)| report.origin).collect();
    assert_eq!(origins, [Origin::Traced, Origin::Traced, Origin::CopiedFrom { write_idx: 1 }]);
    let unproved: Vec<_> = images.iter().map(|(report, _)| report.n_unproved()).collect();
    assert!(unproved[0] > 0 && unproved[1] == unproved[2], "{unproved:?}");
}

#[test]
fn the_limit_holds_within_a_pixel() {
    // The eye on a mirrored ball of such a size that every bit is tried in each pixel: 64x64 took half a minute.
    let program = compile(
        "fov 60\nlight 1 1 1 0 2 -5\nsurface 0 0 0 .5 .5 .5 0 0 0 1 .4\nsphere 0 0 -1e300 1e300\nwrite a.png\n",
    );
    let (report, _) = run_on_any_threads(&program, &limited(64, 64)).pop().expect("an image");
    let work = report.proof.as_ref().expect("a proof").exact.work;
    assert!(work <= 1 << 25, "{work}");
    n_beyond_limit(&report);
}

#[test]
fn a_path_may_be_as_long_as_is_asked_for() {
    // A hall of flat and round mirrors about the eye: expressions of algebra grew with each bounce, and so did the stack.
    let program = compile(
        "fov 60\nlight .5 .5 .5 0 0 -1\nsurface 0 0 0 .01 .01 .01 0 0 0 1 1\ncylinder 1e6 0 0 -1 1\nwrite a.png\n",
    );
    let settings = Settings { max_level: 2000, ..limited(6, 6) };
    let (report, _) = run_on_any_threads(&program, &settings).pop().expect("an image");
    n_beyond_limit(&report);
    let renderer = Renderer::for_open_pixels(last_view(&program), &exact_settings(&settings));
    let allowance = Allowance { max_work: 1 << 22, is_cancelled: &|| false };
    let _ = renderer.pixel_within(3, 2, allowance);
    assert_eq!(renderer.pixel_within(3, 2, Allowance { is_cancelled: &|| true, ..allowance }), None);
}

#[test]
fn a_certified_image_does_not_depend_on_passes() {
    let settings = sized(60, 45);
    for family in FAMILIES.iter().chain(FINEST).step_by(4) {
        let program = compile(&family.sketch(3).text());
        let usual = run(&program, &settings).pop().expect("an image").1;
        for passes in [Passes::none(), Passes::all().without(Pass::Tiles)] {
            let other = run(&program, &Settings { passes, ..settings.clone() }).pop().expect("an image").1;
            assert!(usual == other, "{}", family.name);
        }
    }
}

/// What an audit of the packets' claims finds.
#[derive(Debug, Default)]
struct Audit {
    n_channels: usize,
    /// Channels off by more than was claimed.
    n_beyond: usize,
    /// Bytes that are not those of `exact`.
    n_wrong_bytes: usize,
    /// The largest share of its bound that a channel is off.
    worst_share: f64,
}

/// Holds every channel that packets prove in scenes of many families against `exact`, with the packets made wrong.
fn audit(fault: Fault) -> Audit {
    let mut audit = Audit::default();
    let settings = sized(40, 30);
    for name in ["ordinary", "crowd", "balls on a ball of 1e6", "hall of mirrors", "stacked cylinders", "specks"] {
        let family = FAMILIES.iter().find(|family| family.name == name).expect("a family of this name");
        let made = family.sketch(5).make();
        let renderer = Renderer::new(made.view(), &exact_settings(&settings));
        let tracer = Tracer::new(plan(made.view(), &settings)).with_fault(fault);
        tracer.for_proved(|column, row, proved| {
            let exact = renderer.pixel(column, row);
            for (channel, truth) in proved.color.into_iter().zip(exact.channels) {
                let channel = channel.clamp(0.0, 1.0) * 255.0;
                // The truth is rounded to binary64, and so is what is compared with it: four roundings of 255.
                let off = (channel - truth).abs() - exact.error - 255.0 * 4.0 * f64::EPSILON;
                audit.n_channels += 1;
                audit.n_beyond += usize::from(off > proved.error * 255.0);
                audit.n_wrong_bytes +=
                    usize::from((channel + 1.0 / 1_048_576.0).floor() != (truth + 1.0 / 1_048_576.0).floor());
                if off > 0.0 {
                    audit.worst_share = audit.worst_share.max(off / (proved.error * 255.0));
                }
            }
        });
    }
    audit
}

#[test]
fn every_bound_of_the_packets_holds() {
    let sound = audit(Fault::NONE);
    assert!(sound.n_channels > 5_000, "{sound:?}");
    assert_eq!((sound.n_beyond, sound.n_wrong_bytes), (0, 0), "{sound:?}");
}

#[test]
fn faults_beyond_the_bounds_are_caught_by_channels_where_bytes_do_not_show_them() {
    let perturbed = audit(Fault { root_factor: 1.0 + 1e-9, ..Fault::NONE });
    assert!(perturbed.n_beyond > 1000, "{perturbed:?}");
    assert_eq!(perturbed.n_wrong_bytes, 0, "an audit of bytes would have missed it: {perturbed:?}");
    let flushed = audit(Fault { root_mask: !0xffff, ..Fault::NONE });
    assert!(flushed.n_beyond > 100, "{flushed:?}");
    // A bound can shrink by what it has to spare, and stays true; by more, and it does not.
    let spare = audit(Fault::NONE).worst_share;
    let shrunk = audit(Fault { bound_factor: 0.5 * spare, ..Fault::NONE });
    assert!(spare > 1e-4 && shrunk.n_beyond > 0, "{spare} {shrunk:?}");
}

#[test]
fn large_faults_are_caught_by_bytes_too() {
    let perturbed = audit(Fault { root_factor: 1.01, ..Fault::NONE });
    assert!(perturbed.n_wrong_bytes > 100, "{perturbed:?}");
}

#[test]
fn a_low_bit_stays_within_the_bounds() {
    // The last bit of a root is less than what the bounds allow for its rounding: nothing is beyond them, no byte changes.
    let flushed = audit(Fault { root_mask: !1, ..Fault::NONE });
    assert_eq!((flushed.n_beyond, flushed.n_wrong_bytes), (0, 0), "{flushed:?}");
}
