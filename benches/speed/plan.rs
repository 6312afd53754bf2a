//! From program to plan: what an image needs, and the tables by which rays find it.

use clisc::ir::Valid;
use clisc::plan;
use divan::{Bencher, black_box};

use crate::input;

/// How long does it take to find out what a small scene needs, at its usual size?
#[divan::bench(args = input::GALLERY)]
fn small(bencher: Bencher<'_, '_>, name: &str) {
    time_plan(bencher, &input::program(&input::example(name)));
}

/// How long does it take to make the tables of many objects?
#[divan::bench(args = [1_000, 100_000], sample_count = 20)]
fn cloud(bencher: Bencher<'_, '_>, n_spheres: usize) {
    time_plan(bencher, &input::program(&input::cloud(n_spheres)));
}

fn time_plan(bencher: Bencher<'_, '_>, program: &Valid) {
    let view = input::view(program);
    let settings = input::square(300);
    bencher.bench_local(|| drop(black_box(plan::plan(view, &settings))));
}
