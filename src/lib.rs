//! clisc: compiler and ray tracer for `.cli` scenes.

mod compile;
pub mod diag;
pub mod exec;
pub mod image;
pub mod ir;
pub mod lower;
pub mod math;
pub mod source;
pub mod syntax;
#[cfg(feature = "testing")]
pub mod testing;
pub mod trace;

pub use compile::{Compilation, compile};
