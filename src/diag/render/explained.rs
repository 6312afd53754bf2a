//! The last words of a run: which command says more.

use std::collections::BTreeSet;
use std::fmt;

use crate::diag::Diagnostic;

/// The codes that a run has shown.
///
/// Shown itself it is two lines at most, and nothing when there were no codes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Explained(BTreeSet<&'static str>);

impl Explained {
    /// Makes it without a code.
    #[must_use]
    pub const fn new() -> Self {
        Self(BTreeSet::new())
    }

    /// Adds the codes of what was found.
    pub fn add(&mut self, diagnostics: &[Diagnostic]) {
        self.0.extend(diagnostics.iter().map(|diagnostic| diagnostic.code.id));
    }
}

impl fmt::Display for Explained {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const MAX_NAMED: usize = 6;
        let mut ids = self.0.iter();
        let Some(first) = ids.next() else { return Ok(()) };
        if self.0.len() == 1 {
            return writeln!(f, "For more information try `clisc explain {first}`.");
        }
        write!(f, "These codes have explanations: {first}")?;
        ids.take(MAX_NAMED - 1).try_for_each(|id| write!(f, ", {id}"))?;
        match self.0.len().saturating_sub(MAX_NAMED) {
            0 => writeln!(f, ".")?,
            n => writeln!(f, " and {n} more.")?,
        }
        writeln!(f, "For more information on one try `clisc explain {first}`.")
    }
}
