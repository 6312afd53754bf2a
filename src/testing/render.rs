//! Laws of the renderer, for any text whatever.
//!
//! What is tested is a scene only after its bad lines are left out, so that random text comes to the tracer at all.

use std::collections::{BTreeMap, BTreeSet};

use crate::compile;
use crate::exec::{CancellationToken, ExecError, MemorySink, Options, execute};
use crate::image::decode_png;
use crate::ir::{Command, Registers, SceneView, Valid, validate};
use crate::plan::{ExactWork, Part, Precision, SampleAt, Settings, Size, plan};
use crate::source::Source;
use crate::trace::Tracer;

/// Lines that are read; more would make a run slow.
const MAX_LINES: usize = 48;

const WIDTH: u32 = 8;
const HEIGHT: u32 = 6;

/// Checks that tiny images of the scene, by the rules of both parts, are the same whether rendered whole, row by row or by
/// the executor, and that what is certified is what arbitrary precision gives. Lines with errors are left out, and the image
/// is saved once more at the end.
///
/// # Panics
/// When they are not, or when anything on the way panics.
pub fn assert_renders_soundly(bytes: &[u8]) {
    let program = sound_program(bytes);
    let size = Size::new(WIDTH, HEIGHT).expect("a size within the limits");
    let usual = Settings { size, precision: Precision::F64, exact_work: ExactWork::Unlimited, ..Settings::default() };
    assert_certified_is_exact(&program, &usual);
    assert_cuts_agree(&program, &Settings { part: Part::A, ..usual.clone() });
    assert_cuts_agree(&program, &Settings { samples: 2, sample_at: SampleAt::Centre, max_level: 3, ..usual.clone() });
    assert_cuts_agree(&program, &usual);
}

/// Checks that the certified images of a program are those of arbitrary precision.
fn assert_certified_is_exact(program: &Valid, settings: &Settings) {
    let files = |precision| {
        let settings = Settings { precision, ..settings.clone() };
        let mut sink = MemorySink::default();
        let options = Options { settings: &settings, observer: &(), cancellation: &CancellationToken::new() };
        match execute(program, options, &mut sink) {
            Ok(_) | Err(ExecError::Refused(_)) => sink.files,
            Err(error) => panic!("memory takes every image: {error}"),
        }
    };
    assert!(files(Precision::Certified) == files(Precision::Exact), "what is certified is not right");
}

/// Compiles the first lines of a scene without those that have errors, and a `write` behind them.
fn sound_program(bytes: &[u8]) -> Valid {
    let text = String::from_utf8_lossy(bytes);
    let mut lines: Vec<&str> = text.split(['\n', '\r']).take(MAX_LINES).collect();
    lines.push("write last.png");
    loop {
        let source = Source::new("test.cli", lines.join("\n"));
        let compilation = compile(&source);
        let errors = compilation.diagnostics.iter().filter(|diagnostic| diagnostic.is_error());
        let bad: BTreeSet<_> = errors.map(|error| source.lines().line_of(error.primary.span.start)).collect();
        if bad.is_empty() {
            return validate(compilation.program).expect("the door lets pass what the language lets pass");
        }
        let mut line_idx = 0..;
        lines.retain(|_| line_idx.next().is_none_or(|idx| !bad.contains(&idx)));
    }
}

/// Checks that the images of a program do not depend on how they are cut, and that the executor saves these images.
fn assert_cuts_agree(program: &Valid, settings: &Settings) {
    let mut expected = BTreeMap::new();
    let mut registers = Registers::default();
    for command in &program.commands {
        registers.step(command);
        if let Command::Write(name) = command {
            let tracer = Tracer::new(plan(SceneView::new(program, registers), settings));
            let mut image = vec![0; (WIDTH * HEIGHT * 3) as usize];
            tracer.render_rows(0..HEIGHT, &mut image);
            let mut by_row = vec![0; image.len()];
            for (row, rgb) in (0..).zip(by_row.chunks_exact_mut((WIDTH * 3) as usize)) {
                tracer.render_rows(row..row + 1, rgb);
            }
            assert_eq!(image, by_row, "`{name}` row by row, {settings:?}");
            expected.insert(name.to_string(), image);
        }
    }
    let mut sink = MemorySink::default();
    let options = Options { settings, observer: &(), cancellation: &CancellationToken::new() };
    match execute(program, options, &mut sink) {
        // A name that leads out of the folder; then nothing may have been rendered.
        Err(ExecError::Refused(_)) => assert!(sink.files.is_empty()),
        result => {
            result.expect("memory takes every image");
            let images = sink.files.into_iter().map(|(name, file)| (name, decode_png(&file).expect("a PNG file")));
            let images: BTreeMap<_, _> = images.map(|(name, image)| (name, image.rgb().to_vec())).collect();
            assert_eq!(images, expected, "the executor's images, {settings:?}");
        }
    }
}
