//! Lint: a scene in, what is probably not meant out, with ways to mend it.
//!
//! The warnings of the compiler and the rules in `rules/`, a file each, are one list of rules: all have a name by which a
//! comment (`# clisc: allow(no-fov)`) or `clisc.toml` allows them, and all are found by [`find`]. [`check`] finds what the
//! compiler finds, [`lint`] all. Rules know the scene and not only its text: what they say of objects is proved by the
//! passes of `plan`.
//!
//! Never here: files, images that anyone sees, errors of its own.

mod allow;
mod config;
mod context;
mod fixer;
mod options;
mod registry;
mod rules;
mod sight;
mod unseen;

pub use config::{ConfigError, parse_config, parse_exclude};
pub use fixer::{FixedScene, fix_all, safe_fixes};
pub use options::{Level, Options, UnknownRule, find_rule};
pub use registry::{RULES, Rule, all_codes, find, nearest};
pub use unseen::{OneColor, Unseen, find_unseen};

use crate::compile::{Compilation, compile_keeping};
use crate::diag::{Diagnostic, Safety, codes};
use crate::exec::refused_names;
use crate::ir::{self, Program};
use crate::lint::allow::Sieve;
use crate::lint::context::RuleContext;
use crate::source::Source;
use crate::syntax::parse;

/// Compiles a scene and finds what the compiler finds, and what a rule finds that the options call an error; without what
/// its comments and the options allow.
#[must_use]
pub fn check(source: &Source, options: &Options) -> Compilation {
    let mut sieve = Sieve::new(source, options);
    let mut compilation = check_with(&mut sieve);
    check_errors(&mut sieve, options, &mut compilation);
    compilation
}

fn check_with(sieve: &mut Sieve<'_>) -> Compilation {
    let mut compilation = compile_keeping(sieve.source, &mut |found| sieve.keep(found));
    compilation.add(sieve.keep_all(refused_names(&compilation.program)));
    leave_to_people(&mut compilation);
    compilation
}

/// Runs the rules that the options call errors: a scene that has one is not accepted, whoever asks.
fn check_errors(sieve: &mut Sieve<'_>, options: &Options, compilation: &mut Compilation) {
    let is_error = |level| level == Level::Error;
    if RULES.iter().any(|rule| is_error(options.level(&rule.code))) && !compilation.is_of_other_edition() {
        let mut found = Vec::new();
        check_rules(sieve.source, options, compilation.program.clone(), is_error, &mut found);
        compilation.add(sieve.keep_all(found));
        leave_to_people(compilation);
    }
}

/// Makes of what the compiler has found what [`check`] would: without what comments and options allow, and with the rules
/// that are errors.
pub fn leave_out_allowed(source: &Source, options: &Options, compilation: &mut Compilation) {
    let mut sieve = Sieve::new(source, options);
    if compilation.diagnostics.len() < compilation.n_errors + compilation.n_warnings {
        // What is not listed counts as well.
        let again = check_with(&mut sieve);
        (compilation.n_errors, compilation.n_warnings) = (again.n_errors, again.n_warnings);
        compilation.diagnostics = again.diagnostics;
    } else {
        let found = std::mem::take(&mut compilation.diagnostics);
        (compilation.n_errors, compilation.n_warnings) = (0, 0);
        compilation.add(sieve.keep_all(found));
    }
    check_errors(&mut sieve, options, compilation);
}

/// Compiles a scene and finds what the compiler and every rule find, without what its comments and the options allow. The
/// program is not given back.
#[must_use]
pub fn lint(source: &Source, options: &Options) -> Compilation {
    let mut sieve = Sieve::new(source, options);
    let mut compilation = check_with(&mut sieve);
    if compilation.is_of_other_edition() {
        // Its lines mean something else than the rules would take them for.
        return compilation;
    }
    let mut found = Vec::new();
    let is_on = |level| level != Level::Off;
    check_rules(source, options, std::mem::take(&mut compilation.program), is_on, &mut found);
    found = sieve.keep_all(found);
    found.extend(sieve.finish());
    compilation.add(found);
    leave_to_people(&mut compilation);
    compilation
}

/// Makes the fixes of rules a matter for people where nobody knows what the scene will be: in one with an error, of which the
/// repair may need what a rule finds needless, and in one that looks like one of another edition.
fn leave_to_people(compilation: &mut Compilation) {
    let is_error = |found: &Diagnostic| found.code.name.is_none();
    let is_doubtful = |found: &Diagnostic| is_error(found) || found.code == &codes::PERHAPS_OTHER_EDITION;
    if compilation.diagnostics.iter().any(is_doubtful) {
        let of_rules = compilation.diagnostics.iter_mut().filter(|found| !is_error(found));
        of_rules.flat_map(|found| &mut found.fixes).for_each(|fix| fix.safety = Safety::Unsafe);
    }
}

/// Runs the rules of some levels over a scene, as far as it could be compiled.
fn check_rules(
    source: &Source,
    options: &Options,
    program: Program,
    is_wanted: impl Fn(Level) -> bool,
    acc: &mut Vec<Diagnostic>,
) {
    let parse = parse(source);
    let program = ir::validate(program).ok();
    let cx = RuleContext::new(source, options, &parse.file, program.as_ref());
    for rule in RULES.iter().filter(|rule| is_wanted(options.level(&rule.code))) {
        (rule.check)(&cx, acc);
    }
}
