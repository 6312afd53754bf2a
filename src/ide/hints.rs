//! Names that an editor shows between the numbers.

use crate::ide::document::kind_of;
use crate::ide::{Document, MAX_ANSWERS};
use crate::source::Span;
use crate::syntax::argument_spans;

/// A name to show before a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hint {
    /// Where the number starts.
    pub at: u32,
    /// What it is called, such as `Cd`.
    pub label: &'static str,
    /// What it is, in words.
    pub doc: &'static str,
}

/// Returns a name for each group of numbers of the whole commands that start in `span`, in order; none in a scene of another
/// edition.
#[must_use]
pub fn hints(document: &Document, span: Span) -> Vec<Hint> {
    let mut hints = Vec::new();
    if document.is_of_other_edition() {
        return hints;
    }
    for command in document.commands_in(span) {
        let Some(kind) = kind_of(&command).filter(|_| !command.numbers.is_empty()) else { continue };
        let spans = argument_spans(document.source(), command.span);
        let groups = kind.spec().grouped();
        hints.extend(groups.map(|(numbers, group)| Hint {
            at: spans[numbers.start].start,
            label: group.symbol,
            doc: group.name,
        }));
        if hints.len() >= MAX_ANSWERS {
            break;
        }
    }
    hints
}
