//! Which lines have an error, as every stage of the compiler sees it.
//!
//! A compilation lists a bounded number of errors; a formatter must know them all, but only their places.

use crate::exec::refused_names;
use crate::lower::Lowering;
use crate::source::{Source, Span};
use crate::syntax::ast::Shape;
use crate::syntax::spec::CommandKind;
use crate::syntax::{Runs, editions};

/// What the compiler knows of a scene.
#[derive(Debug, Default)]
pub(super) struct Known {
    /// The commands that are whole, in the order of the text, each from its name to its last argument.
    pub(super) commands: Vec<(Span, CommandKind)>,
    /// A byte of each line with an error, in order.
    pub(super) errors: Vec<u32>,
    /// Whether no line can be read, because the file is not UTF-8 at all, or of another edition of the language.
    pub(super) is_unreadable: bool,
}

/// Compiles a scene and keeps what formatting has to know.
pub(super) fn know(source: &Source) -> Known {
    let mut known = Known::default();
    let mut lowering = Lowering::new(source);
    let mut runs = Runs::new(source);
    for run in &mut runs {
        lowering.add(&run.file);
        let found = run.diagnostics.into_iter().chain(lowering.take_diagnostics());
        known.errors.extend(found.filter(|found| found.is_error()).map(|error| error.primary.span.start));
        for command in run.file.commands() {
            match command.shape {
                Shape::Whole(kind) => known.commands.push((command.span, kind)),
                Shape::Bad(_) => {
                    known.errors.push(command.span.start);
                    known.is_unreadable |= source.slice(command.span).contains('\n');
                }
            }
        }
    }
    let lowered = lowering.finish();
    let late = runs.finish().into_iter().chain(lowered.diagnostics).chain(refused_names(&lowered.program));
    known.errors.extend(late.filter(|found| found.is_error()).map(|error| error.primary.span.start));
    known.errors.sort_unstable();
    let is_other = || editions::judge(source).is_some_and(|verdict| verdict.is_certain);
    known.is_unreadable |= !known.errors.is_empty() && is_other();
    known
}
