//! clisc compiles scenes of the `.cli` language and renders them, each pixel as exact arithmetic gives it.
//!
//! The modules below stand in the order in which a scene passes them. [`source`] holds its text, [`syntax`] makes a tree
//! of it, [`lower`] a program, the arenas and command list of [`ir`]; [`compile()`] is these steps in one call, and [`diag`]
//! holds what they found. Behind [`ir::validate`] nothing can fail for the scene's sake: [`exec`] walks the command list,
//! [`plan`] finds out what the image of a `write` needs, [`trace`] renders that with the numbers of [`math`], and [`image`]
//! streams the rows into a PNG. Beside them, [`mod@format`] brings the text of a scene into its canonical form, and [`ide`] answers what
//! an editor asks.
//!
//! The library neither prints nor reads files nor looks at the clock; where images go and who watches are parameters.
//!
//! ```
//! use clisc::exec::{CancellationToken, MemorySink, Options, execute};
//! use clisc::{compile, image::decode_png, ir, plan::Settings, source::Source};
//!
//! let text = "fov 60\nlight 1 1 1  0 0 5\nsurface 0 0 0  1 0 0  0 0 0  1 0\nsphere 0 0 -4 1\nwrite ball.png\n";
//! let compilation = compile(&Source::new("ball.cli", text));
//! assert!(compilation.diagnostics.is_empty());
//!
//! let program = ir::validate(compilation.program).expect("lowering reports what would be refused here");
//! let mut images = MemorySink::default();
//! let options =
//!     Options { settings: &Settings::default(), observer: &(), cancellation: &CancellationToken::default() };
//! execute(&program, options, &mut images)?;
//!
//! let ball = decode_png(&images.files["ball.png"])?;
//! assert_eq!(ball.pixel(0, 0), [0, 0, 0]);
//! assert_eq!(ball.pixel(150, 150), [255, 0, 0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod source;

pub mod diag;

pub mod syntax;

pub mod lower;

mod compile;

pub mod ir;

pub mod math;

pub mod image;

pub mod plan;

pub mod trace;

pub mod exact;

pub mod exec;

pub mod format;

pub mod lint;

pub mod ide;

#[cfg(feature = "testing")]
pub mod testing;

pub use compile::{Compilation, Keep, MAX_LISTED, Times, compile, compile_in_chunks, compile_keeping, compile_timed};
