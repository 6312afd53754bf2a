//! What is counted.

use std::hint::black_box;

use clisc::image::encode_png;
use clisc::ir;
use clisc::plan;
use clisc::source::Source;
use clisc::trace::Tracer;
use clisc::trace::kernels::Backend;

use crate::input;

/// The name of the function whose instructions count, as callgrind sees it.
pub const MEASURED: &str = "gate::cases::measured";

/// One hot path with one input.
pub struct Case {
    /// Stage, subject, input.
    pub name: &'static str,
    /// Prepares the input, and calls [`measured`] once.
    run: fn(),
}

/// Every case. Each runs for some ten million instructions, a second or two under callgrind.
pub const CASES: &[Case] = &[
    Case { name: "language/lex/1000", run: lex },
    Case { name: "language/parse/1000", run: parse },
    Case { name: "language/lower/1000", run: lower },
    Case { name: "plan/small/still-life", run: || plan(&input::example("still-life")) },
    Case { name: "plan/cloud/1000", run: || plan(&input::cloud(1000)) },
    Case { name: "trace/still-life/avx2", run: || trace(Some(Backend::Avx2)) },
    Case { name: "trace/still-life/scalar", run: || trace(Some(Backend::Scalar)) },
    Case { name: "trace/still-life/pixelwise", run: || trace(None) },
    Case { name: "encode/png/render", run: encode },
    Case { name: "image/small/candles", run: || image("candles") },
    Case { name: "image/small/still-life", run: || image("still-life") },
    Case { name: "image/small/sunflower", run: || image("sunflower") },
    Case { name: "image/cloud/1000", run: cloud },
];

/// Runs one case, on this thread alone.
///
/// # Errors
/// When there is no such case.
pub fn run(name: &str) -> Result<(), String> {
    let case = CASES.iter().find(|case| case.name == name).ok_or_else(|| format!("there is no case `{name}`"))?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
    pool.map_err(|error| error.to_string())?;
    (case.run)();
    Ok(())
}

/// Does what is counted.
#[inline(never)]
fn measured<R>(work: impl FnOnce() -> R) {
    black_box(work());
}

fn lex() {
    let source = input::cloud(1000);
    measured(|| clisc::syntax::lex(&source));
}

fn parse() {
    let source = input::cloud(1000);
    measured(|| clisc::syntax::parse(&source));
}

fn lower() {
    let source = input::cloud(1000);
    let file = clisc::syntax::parse(&source).file;
    measured(|| ir::validate(clisc::lower::lower(&source, &file).program));
}

fn plan(source: &Source) {
    let program = input::program(source);
    let view = input::view(&program);
    measured(|| plan::plan(view, &input::square(300)));
}

fn trace(backend: Option<Backend>) {
    let program = input::program(&input::example("still-life"));
    let tracer = Tracer::with_backend(plan::plan(input::view(&program), &input::square(64)), backend);
    let mut rgb = vec![0; 64 * 64 * 3];
    measured(|| tracer.render_band(0..64, &mut rgb, &|| false));
}

fn encode() {
    let image = input::pixels("still-life", 200);
    measured(|| encode_png(&image));
}

fn image(name: &str) {
    let program = input::program(&input::example(name));
    measured(|| input::render(&program, &input::square(100)));
}

fn cloud() {
    let program = input::program(&input::cloud(1000));
    measured(|| input::render(&program, &input::square(32)));
}
