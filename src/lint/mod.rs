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

pub use config::{ConfigError, parse_config, parse_exclude};
pub use fixer::{FixedScene, fix_all};
pub use options::{Level, Options, UnknownRule, find_rule};
pub use registry::{RULES, Rule, all_codes, find, nearest};

use crate::compile::{Compilation, compile};
use crate::diag::Diagnostic;
use crate::exec::refused_names;
use crate::ir::{self, Program};
use crate::lint::context::RuleContext;
use crate::source::Source;
use crate::syntax::parse;

/// Compiles a scene and finds what the compiler finds, without what its comments and the options allow.
#[must_use]
pub fn check(source: &Source, options: &Options) -> Compilation {
    let mut compilation = compile(source);
    compilation.add(refused_names(&compilation.program));
    leave_out_allowed(source, options, &mut compilation);
    compilation
}

/// Leaves out of what the compiler has found what comments and options allow, and gives the rest its level.
pub fn leave_out_allowed(source: &Source, options: &Options, compilation: &mut Compilation) {
    let found = std::mem::take(&mut compilation.diagnostics);
    settle(compilation, found, |found| allow::sieve(source, options, found));
}

/// Compiles a scene and finds what the compiler and every rule find, without what its comments and the options allow. The
/// program is not given back.
#[must_use]
pub fn lint(source: &Source, options: &Options) -> Compilation {
    let mut compilation = compile(source);
    compilation.add(refused_names(&compilation.program));
    let mut found = std::mem::take(&mut compilation.diagnostics);
    let n_compiled = found.len();
    check_rules(source, options, std::mem::take(&mut compilation.program), &mut found);
    let has_errors = compilation.has_errors();
    compilation.n_warnings += found.len() - n_compiled;
    settle(&mut compilation, found, |found| allow::sieve_and_check(source, options, found, has_errors));
    compilation
}

/// Runs the rules over a scene, as far as it could be compiled.
fn check_rules(source: &Source, options: &Options, program: Program, acc: &mut Vec<Diagnostic>) {
    let parse = parse(source);
    let program = ir::validate(program).ok();
    let cx = RuleContext::new(source, options, &parse.file, program.as_ref());
    for rule in RULES.iter().filter(|rule| options.level(&rule.code) != Level::Off) {
        (rule.check)(&cx, acc);
    }
}

/// Puts what `sieve` leaves of `found` into a compilation and counts it. What is counted there and not listed stays counted.
fn settle(
    compilation: &mut Compilation,
    found: Vec<Diagnostic>,
    sieve: impl FnOnce(Vec<Diagnostic>) -> Vec<Diagnostic>,
) {
    let count = |found: &[Diagnostic]| {
        let n_errors = found.iter().filter(|diagnostic| diagnostic.is_error()).count();
        [n_errors, found.len() - n_errors]
    };
    let before = count(&found);
    let mut left = sieve(found);
    let after = count(&left);
    compilation.n_errors = compilation.n_errors + after[0] - before[0];
    compilation.n_warnings = compilation.n_warnings + after[1] - before[1];
    left.sort_by_key(|diagnostic| diagnostic.primary.span.start);
    compilation.diagnostics = left;
}
