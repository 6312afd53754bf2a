//! Lowering: `ast::File` in, `ir::Program` out.
//!
//! Scene commands are a small state machine (current surface, field of view, background). This module runs that machine
//! once, so nothing later needs to know it existed.
//!
//! Never here: reading files, tracing rays, judging style.

use crate::diag::Diagnostic;
use crate::ir::Program;
use crate::source::Source;
use crate::syntax::ast;

/// A program and what was found wrong on the way to it.
#[derive(Debug, Default)]
pub struct Lowered {
    /// The program; not to be rendered when a diagnostic is an error.
    pub program: Program,
    /// In the order of the text.
    pub diagnostics: Vec<Diagnostic>,
}

/// Lowers the tree of `source`.
#[must_use]
pub fn lower(source: &Source, file: &ast::File) -> Lowered {
    let _ = (source, file);
    Lowered::default()
}
