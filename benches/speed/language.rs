//! From text to program.

use clisc::ir::{self, Valid};
use clisc::source::Source;
use divan::counter::BytesCount;
use divan::{Bencher, black_box};

use crate::input;

/// Spheres in a small and in a large scene.
const SIZES: [usize; 2] = [1_000, 100_000];

/// How much text becomes tokens in a second, on one thread?
#[divan::bench(args = SIZES)]
fn lex(bencher: Bencher<'_, '_>, n_spheres: usize) {
    let source = input::cloud(n_spheres);
    bencher.counter(bytes(&source)).bench_local(|| clisc::syntax::lex(black_box(&source)));
}

/// How much sound text becomes a tree in a second?
#[divan::bench(args = SIZES)]
fn parse(bencher: Bencher<'_, '_>, n_spheres: usize) {
    let source = input::cloud(n_spheres);
    assert_eq!(clisc::syntax::parse(&source).diagnostics.len(), 0);
    bencher.counter(bytes(&source)).bench_local(|| clisc::syntax::parse(black_box(&source)));
}

/// How much text with a mistake in every line becomes a tree in a second? Each line is then read twice.
#[divan::bench(args = [1_000])]
fn parse_mistakes(bencher: Bencher<'_, '_>, n_lines: usize) {
    let source = Source::new("mistakes.cli", "sphere 1.5 0 -7\n".repeat(n_lines));
    assert_eq!(clisc::syntax::parse(&source).diagnostics.len(), n_lines);
    bencher.counter(bytes(&source)).bench_local(|| clisc::syntax::parse(black_box(&source)));
}

/// How long does it take to make a program of a tree?
#[divan::bench(args = SIZES)]
fn lower(bencher: Bencher<'_, '_>, n_spheres: usize) {
    let source = input::cloud(n_spheres);
    let file = clisc::syntax::parse(&source).file;
    bencher.counter(n_spheres).bench_local(|| clisc::lower::lower(&source, black_box(&file)));
}

/// How long does the door take?
#[divan::bench(args = SIZES)]
fn validate(bencher: Bencher<'_, '_>, n_spheres: usize) {
    let source = input::cloud(n_spheres);
    let program = || clisc::compile(&source).program;
    bencher.counter(n_spheres).with_inputs(program).bench_local_values(ir::validate);
}

/// How much text becomes a valid program in a second, in all?
#[divan::bench(args = SIZES)]
fn compile(bencher: Bencher<'_, '_>, n_spheres: usize) {
    let source = input::cloud(n_spheres);
    bencher.counter(bytes(&source)).bench_local(|| -> Valid { input::program(black_box(&source)) });
}

fn bytes(source: &Source) -> BytesCount {
    BytesCount::of_str(source.text())
}
