//! From program to the bytes of a PNG file: planned, traced, encoded, on all cores.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};

use crate::input;

/// How long does a small scene take at its usual size?
#[divan::bench(args = input::GALLERY)]
fn small(bencher: Bencher<'_, '_>, name: &str) {
    gallery(bencher, name, 300);
}

/// How many pixels of a small scene are made in a second, once what is done once an image no longer counts?
#[divan::bench(args = input::GALLERY, sample_count = 5)]
fn large(bencher: Bencher<'_, '_>, name: &str) {
    gallery(bencher, name, 1000);
}

/// How long does an image take by the number of its objects, text excepted?
#[divan::bench(args = [100, 1_000], sample_count = 5)]
fn cloud(bencher: Bencher<'_, '_>, n_spheres: usize) {
    let program = input::program(&input::cloud(n_spheres));
    let settings = input::square(300);
    bencher.counter(pixels(300)).bench_local(|| input::render(black_box(&program), &settings));
}

fn gallery(bencher: Bencher<'_, '_>, name: &str, side: u32) {
    input::assert_is_right(name);
    let program = input::program(&input::example(name));
    let settings = input::square(side);
    bencher.counter(pixels(side)).bench_local(|| input::render(black_box(&program), &settings));
}

fn pixels(side: u32) -> ItemsCount {
    ItemsCount::new(side * side)
}
