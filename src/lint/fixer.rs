//! Carrying out what is safe, until nothing is left to do.

use crate::diag::fix::apply;
use crate::diag::{Fix, Safety};
use crate::lint::lint;
use crate::lint::options::Options;
use crate::source::Source;

/// More rounds than any scene needs: a fix may lay bare another, as when of three equal surfaces one is removed, but each
/// makes the scene shorter or removes a finding.
const MAX_ROUNDS: usize = 100;

/// A scene with its safe fixes carried out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FixedScene {
    /// Its text.
    pub text: String,
    /// How many fixes were carried out.
    pub n_fixes: usize,
}

/// Carries out the safe fixes of what [`lint`] finds, of each finding the first, all that do not touch each other at a time,
/// until none is left. A scene with an error stays as it is, and no fix is kept that would make one.
#[must_use]
pub fn fix_all(source: &Source, options: &Options) -> FixedScene {
    let mut fixed = FixedScene { text: source.text().to_owned(), n_fixes: 0 };
    for _ in 0..MAX_ROUNDS {
        let Some((text, n_fixes)) = fix_once(&fixed.text, source, options) else { break };
        fixed = FixedScene { text, n_fixes: fixed.n_fixes + n_fixes };
    }
    fixed
}

/// Carries out the safe fixes that do not touch each other; `None` when there is none, or an error in the scene before or
/// after.
fn fix_once(text: &str, source: &Source, options: &Options) -> Option<(String, usize)> {
    let has_error = |compilation: &crate::Compilation| {
        compilation.diagnostics.iter().any(|diagnostic| diagnostic.code.name.is_none())
    };
    let found = lint(&Source::new(source.name(), text), options);
    if has_error(&found) || !source.invalid_utf8().is_empty() {
        return None;
    }
    let is_safe = |fix: &&Fix| fix.safety == Safety::Safe;
    let fixes: Vec<_> = found.diagnostics.iter().filter_map(|found| found.fixes.first().filter(is_safe)).collect();
    let fixed = apply(text, fixes);
    let n_applied = fixed.is_applied.iter().filter(|is_applied| **is_applied).count();
    let is_sound = || !has_error(&lint(&Source::new(source.name(), fixed.text.as_str()), options));
    (n_applied > 0 && fixed.text != text && is_sound()).then_some((fixed.text.clone(), n_applied))
}
