//! The language wing in one step: text in, program and diagnostics out.

use crate::diag::Diagnostic;
use crate::ir::Program;
use crate::lower::{Lowered, lower};
use crate::source::Source;
use crate::syntax::parse;

/// A scene as far as it could be understood.
#[derive(Debug)]
pub struct Compilation {
    /// The program; not to be rendered when the scene [has errors](Compilation::has_errors).
    pub program: Program,
    /// All that was found, in the order of the text.
    pub diagnostics: Vec<Diagnostic>,
}

impl Compilation {
    /// Puts together what the stages gave; for callers that run them one by one, say to time them.
    #[must_use]
    pub fn of_stages(parsed: Vec<Diagnostic>, lowered: Lowered) -> Self {
        let mut diagnostics = parsed;
        diagnostics.extend(lowered.diagnostics);
        diagnostics.sort_by_key(|diagnostic| diagnostic.primary.span.start);
        Self { program: lowered.program, diagnostics }
    }

    /// Tells whether the scene cannot be rendered.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(Diagnostic::is_error)
    }
}

/// Parses and lowers a scene.
#[must_use]
pub fn compile(source: &Source) -> Compilation {
    let parse = parse(source);
    let lowered = lower(source, &parse.file);
    Compilation::of_stages(parse.diagnostics, lowered)
}
