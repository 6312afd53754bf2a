//! Diagnostics: what is wrong with a scene, where, and what to do.
//!
//! A stage that finds a fault appends a [`Diagnostic`]; the renderers turn a list of them into text or JSON. Every code
//! stands once, in [`codes`], with the long text that `clisc explain` prints.
//!
//! Never here: finding faults, printing, exit codes.

pub mod codes;
mod diagnostic;
pub mod fix;
pub mod render;
pub mod words;

pub use codes::{Code, Severity};
pub use diagnostic::{Diagnostic, Label};
pub use fix::{Edit, Fix, Safety};
