//! How fast is each stage? One module a stage, in the order in which a scene passes them.
//!
//! `cargo bench --bench speed` runs all; `cargo bench --bench speed -- language` one stage. Names run stage, subject,
//! input. For whole processes, and for a comparison with other programs, see `benches/compare.py`.

mod encode;
mod image;
#[path = "../support/input.rs"]
mod input;
mod language;
mod plan;
mod trace;

fn main() {
    divan::main();
}
