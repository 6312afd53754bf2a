//! What is measured: examples from `scenes/`, and clouds of spheres from a fixed seed.
#![allow(dead_code, reason = "each bench uses a part")]

use std::fmt::Write;
use std::path::Path;

use clisc::exec::{CancellationToken, MemorySink, Options, execute};
use clisc::image::{RgbImage, decode_png};
use clisc::ir::{self, Registers, SceneView, Valid};
use clisc::plan::{Settings, Size};
use clisc::source::Source;
use clisc::testing::Stream;

/// The seed of every cloud; `compare.py` draws the same spheres.
const SEED: u64 = 1;

/// Spheres that share one surface in a cloud.
const SPHERES_A_SURFACE: usize = 100;

/// Scenes of some tens of objects, with shadows, highlights and mirrors. Each makes the image of its own name.
pub const GALLERY: [&str; 3] = ["candles", "still-life", "sunflower"];

/// Reads an example below `scenes/gallery`.
pub fn example(name: &str) -> Source {
    let file = format!("scenes/gallery/{name}.cli");
    let bytes = std::fs::read(root().join(&file)).expect("an example of the project");
    Source::from_bytes(&file, bytes).expect("a source below 4 GiB")
}

/// Makes a scene of `n_spheres` that fill the view, with three lights; a fifth of the surfaces are mirrors.
///
/// Depths are spread evenly over 10…60, and radii follow `n_spheres` so that the spheres cover half of the view whatever
/// their number: the work of a ray is then a question of the number alone.
pub fn cloud(n_spheres: usize) -> Source {
    let mut stream = Stream::new(SEED);
    let mut text = String::from("fov 60\nbackground 0.2 0.3 0.5\n");
    text += "light 0.6 0.6 0.6 30 40 10\nlight 0.3 0.25 0.2 -40 10 0\nlight 0.2 0.2 0.3 0 5 5\n";
    let radius = mean_radius(n_spheres);
    for sphere_idx in 0..n_spheres {
        if sphere_idx.is_multiple_of(SPHERES_A_SURFACE) {
            write_surface(&mut text, &mut stream, sphere_idx / SPHERES_A_SURFACE);
        }
        let depth = stream.between(10.0, 60.0);
        let half_width = depth / 3f64.sqrt();
        let [x, y] = [(); 2].map(|()| half_width * stream.between(-1.0, 1.0));
        let radius = radius * stream.between(0.5, 1.5);
        writeln!(text, "sphere {x:.6} {y:.6} {:.6} {radius:.6}", -depth).expect("written to memory");
    }
    text += "write cloud.png\n";
    Source::new("cloud.cli", text)
}

/// Returns the mean radius with which `n_spheres` cover half of the view.
///
/// Randomly placed discs of a summed area `s` times the view leave e^-s of it free. Here s = n·π·E\[r²\]·E\[1/z²\]/(4k²) with
/// k = tan 30°, E\[1/z²\] = 1/600 over the depths, and E\[r²\] = 13/12 of the squared mean.
fn mean_radius(n_spheres: usize) -> f64 {
    (std::f64::consts::LN_2 * 600.0 * (4.0 / 3.0) / (std::f64::consts::PI * n_spheres as f64 * (13.0 / 12.0))).sqrt()
}

fn write_surface(text: &mut String, stream: &mut Stream, surface_idx: usize) {
    let [r, g, b] = [(); 3].map(|()| stream.between(0.2, 1.0));
    let reflectance = if surface_idx.is_multiple_of(5) { 0.3 } else { 0.0 };
    let ambient = [r, g, b].map(|channel| 0.2 * channel);
    let [ar, ag, ab] = ambient;
    writeln!(text, "surface {ar:.4} {ag:.4} {ab:.4}  {r:.4} {g:.4} {b:.4}  0.3 0.3 0.3  20  {reflectance}")
        .expect("written to memory");
}

/// Compiles a sound scene.
///
/// # Panics
/// When it has errors.
pub fn program(source: &Source) -> Valid {
    let compilation = clisc::compile(source);
    assert!(!compilation.has_errors(), "{}: {:?}", source.name(), compilation.diagnostics);
    ir::validate(compilation.program).expect("lowering reports what would be refused here")
}

/// Returns the scene as the last `write` of a program sees it.
pub fn view(program: &Valid) -> SceneView<'_> {
    let mut registers = Registers::default();
    program.commands.iter().for_each(|command| registers.step(command));
    SceneView::new(program, registers)
}

/// Renders the last image of a program, through the executor into memory: the bytes of its PNG file.
pub fn render(program: &Valid, settings: &Settings) -> Vec<u8> {
    let mut sink = MemorySink::default();
    let options = Options { settings, observer: &(), cancellation: &CancellationToken::default() };
    execute(program, options, &mut sink).expect("memory takes every image");
    sink.files.pop_last().expect("an image").1
}

/// Returns the settings of a square image.
pub fn square(side: u32) -> Settings {
    Settings { size: Size::new(side, side).expect("a size within the limits"), ..Settings::default() }
}

/// Checks that an example renders to its reference image; a fast wrong image is no result.
///
/// # Panics
/// When it does not.
pub fn assert_is_right(name: &str) {
    let reference = std::fs::read(root().join(format!("reference/gallery/{name}.png"))).expect("a reference image");
    let reference = decode_png(&reference).expect("a PNG file");
    let size = Size::new(reference.width(), reference.height()).expect("a size within the limits");
    let made = render(&program(&example(name)), &Settings { size, ..Settings::default() });
    assert!(decode_png(&made).expect("a PNG file") == reference, "{name} is not its reference image");
}

/// Renders an example as pixels.
pub fn pixels(name: &str, side: u32) -> RgbImage {
    decode_png(&render(&program(&example(name)), &square(side))).expect("a PNG file")
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}
