//! Carrying out what is safe, until nothing is left to do.

use std::collections::HashSet;

use crate::compile::Compilation;
use crate::diag::fix::apply;
use crate::diag::{Diagnostic, Fix, Safety, codes};
use crate::lint::lint;
use crate::lint::options::Options;
use crate::source::Source;
use crate::syntax::ast::{Command, Shape};
use crate::syntax::spec::CommandKind;
use crate::syntax::{argument_spans, parse};

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
/// until none is left. While a scene has errors only they are mended, and no fix is kept that would make one.
#[must_use]
pub fn fix_all(source: &Source, options: &Options) -> FixedScene {
    let mut fixed = FixedScene { text: source.text().to_owned(), n_fixes: 0 };
    for _ in 0..MAX_ROUNDS {
        let Some((text, n_fixes)) = fix_once(&fixed.text, source, options) else { break };
        fixed = FixedScene { text, n_fixes: fixed.n_fixes + n_fixes };
    }
    fixed
}

/// Carries out the safe fixes that do not touch each other; `None` when there is none, or one would make an error.
fn fix_once(text: &str, source: &Source, options: &Options) -> Option<(String, usize)> {
    let lint = |text: &str| lint(&Source::new(source.name(), text), options);
    if !source.invalid_utf8().is_empty() {
        return None;
    }
    let found = lint(text);
    let n_errors = n_errors(&found);
    let fixed = apply(text, fixes(text, &found.diagnostics));
    let n_applied = fixed.is_applied.iter().filter(|is_applied| **is_applied).count();
    let is_sound = || self::n_errors(&lint(&fixed.text)) <= n_errors;
    (n_applied > 0 && fixed.text != text && is_sound()).then_some((fixed.text.clone(), n_applied))
}

/// Returns the fixes that are carried out, of what was found in a text.
fn fixes<'f>(text: &str, found: &'f [Diagnostic]) -> Vec<&'f Fix> {
    let is_about_name = |found: &Diagnostic| found.code == &codes::NOT_A_PNG;
    let mut names = if found.iter().any(is_about_name) { image_names(text) } else { HashSet::new() };
    // Two images of one name would be one image.
    let mut is_free = |found: &Diagnostic, fix: &Fix| {
        !is_about_name(found) || fix.edits.iter().all(|edit| names.insert(edit.replacement.clone()))
    };
    safe_fixes(found).filter(|(found, fix)| is_free(found, fix)).map(|(_, fix)| fix).collect()
}

/// Returns what can be mended safely, each with its fix: errors, or where there is none, what rules have found. In a scene
/// of another edition that is nothing: its lines mean something else.
pub fn safe_fixes(found: &[Diagnostic]) -> impl Iterator<Item = (&Diagnostic, &Fix)> {
    let is_error = |found: &Diagnostic| found.code.name.is_none();
    let has_error = found.iter().any(is_error);
    let is_about_edition =
        |found: &Diagnostic| [&codes::OTHER_EDITION, &codes::PERHAPS_OTHER_EDITION].contains(&found.code);
    let is_of_another = found.iter().any(is_about_edition);
    let found = found.iter().filter(move |found| !is_of_another && is_error(found) == has_error);
    found.filter_map(|found| Some((found, found.fixes.first().filter(|fix| fix.safety == Safety::Safe)?)))
}

/// Returns the names of the images that a scene writes, as they stand there.
fn image_names(text: &str) -> HashSet<String> {
    let source = Source::new("", text);
    let parse = parse(&source);
    let writes = parse.file.commands().filter(|command| command.shape == Shape::Whole(CommandKind::Write));
    let place = |command: &Command<'_>| argument_spans(&source, command.span).first().copied();
    writes.filter_map(|command| place(&command)).map(|span| source.slice(span).to_owned()).collect()
}

/// Counts the errors that no configuration makes.
fn n_errors(found: &Compilation) -> usize {
    found.n_errors - found.diagnostics.iter().filter(|found| found.is_error() && found.code.name.is_some()).count()
}
