//! From plan to pixels: what each backend makes of it, on one thread.

use clisc::ir::Valid;
use clisc::plan;
use clisc::trace::Tracer;
use clisc::trace::kernels::Backend;
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};

use crate::input;

/// Pixels along a side.
const SIDE: u32 = 300;

/// How many pixels does each backend trace in a second, one pixel at a time where there is none?
#[divan::bench(args = input::GALLERY, types = [Pixelwise, Scalar, Avx2, Avx512])]
fn small<B: Choice>(bencher: Bencher<'_, '_>, name: &str) {
    time_trace::<B>(bencher, &input::program(&input::example(name)));
}

/// The same for a scene whose rays look up what they may meet.
#[divan::bench(args = [1_000, 100_000], types = [Pixelwise, Scalar, Avx2, Avx512], sample_count = 10)]
fn cloud<B: Choice>(bencher: Bencher<'_, '_>, n_spheres: usize) {
    time_trace::<B>(bencher, &input::program(&input::cloud(n_spheres)));
}

fn time_trace<B: Choice>(bencher: Bencher<'_, '_>, program: &Valid) {
    let backend = B::BACKEND;
    if backend.is_some_and(|backend| !backend.is_available()) {
        return;
    }
    let tracer = |backend| Tracer::with_backend(plan::plan(input::view(program), &input::square(SIDE)), backend);
    let timed = tracer(backend);
    assert!(pixels(&timed) == pixels(&tracer(None)), "{backend:?} makes another image");
    bencher.counter(ItemsCount::new(SIDE * SIDE)).bench_local(|| pixels(black_box(&timed)));
}

fn pixels(tracer: &Tracer<'_>) -> Vec<u8> {
    let mut rgb = vec![0; (SIDE * SIDE * 3) as usize];
    for first_row in (0..SIDE).step_by(Tracer::TILE_ROWS as usize) {
        let rows = first_row..SIDE.min(first_row + Tracer::TILE_ROWS);
        let bytes = (rows.start * SIDE * 3) as usize..(rows.end * SIDE * 3) as usize;
        tracer.render_band(rows, &mut rgb[bytes], &|| false);
    }
    rgb
}

/// A backend, as a type: benches name their types.
trait Choice {
    /// `None` traces one pixel at a time.
    const BACKEND: Option<Backend>;
}

struct Pixelwise;
struct Scalar;
struct Avx2;
struct Avx512;

impl Choice for Pixelwise {
    const BACKEND: Option<Backend> = None;
}

impl Choice for Scalar {
    const BACKEND: Option<Backend> = Some(Backend::Scalar);
}

impl Choice for Avx2 {
    const BACKEND: Option<Backend> = Some(Backend::Avx2);
}

impl Choice for Avx512 {
    const BACKEND: Option<Backend> = Some(Backend::Avx512);
}
