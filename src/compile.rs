//! The language wing in one step: text in, program and diagnostics out.
//!
//! A scene passes through in runs of lines: while one is lowered the next is parsed, and only these two have a tree. Of a
//! scene with a great many mistakes the first ones are kept and the rest counted, so that memory stays bounded.

use std::time::Duration;

use crate::diag::{Diagnostic, Severity, codes};
use crate::ir::Program;
use crate::lower::{Lowered, Lowering};
use crate::source::Source;
use crate::syntax::{Runs, editions};

/// A scene as far as it could be understood.
#[derive(Debug)]
pub struct Compilation {
    /// The program; not to be rendered when the scene [has errors](Compilation::has_errors).
    pub program: Program,
    /// What was found, in the order of the text: of errors and of warnings the first [`MAX_LISTED`] each.
    pub diagnostics: Vec<Diagnostic>,
    /// How many errors were found, those that are not listed included.
    pub n_errors: usize,
    /// How many warnings were found, those that are not listed included.
    pub n_warnings: usize,
    /// What the stages took.
    pub times: Times,
}

/// The most errors of one scene that are listed, and the most warnings: more than anyone reads, and some megabytes.
pub const MAX_LISTED: usize = 10_000;

/// What the stages of a compilation took. They overlap, so that their sum can be more than the time that passed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Times {
    /// Text to tree.
    pub parse: Duration,
    /// Tree to program.
    pub lower: Duration,
}

impl Compilation {
    /// Tells whether the scene cannot be rendered.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.n_errors > 0
    }

    /// Tells whether the scene is written in another edition of the language: then its lines mean something else, and
    /// nothing is known of it.
    #[must_use]
    pub fn is_of_other_edition(&self) -> bool {
        self.diagnostics.iter().any(|diagnostic| diagnostic.code == &codes::OTHER_EDITION)
    }

    /// Adds what a later stage found.
    pub fn add(&mut self, found: Vec<Diagnostic>) {
        found.iter().for_each(|diagnostic| *n_of(diagnostic, &mut self.n_errors, &mut self.n_warnings) += 1);
        self.diagnostics.extend(found);
        self.diagnostics.sort_by_key(|diagnostic| diagnostic.primary.span.start);
        let (mut n_errors, mut n_warnings) = (0, 0);
        self.diagnostics.retain(|diagnostic| count(diagnostic, &mut n_errors, &mut n_warnings));
    }

    /// Returns how many findings of a severity are not listed.
    #[must_use]
    pub fn n_unlisted(&self, severity: Severity) -> usize {
        let n = match severity {
            Severity::Error => self.n_errors,
            Severity::Warning => self.n_warnings,
        };
        n - self.diagnostics.iter().filter(|listed| listed.severity() == severity).count()
    }
}

/// Parses and lowers a scene.
#[must_use]
pub fn compile(source: &Source) -> Compilation {
    compile_runs(source, Runs::new(source), &|| Duration::ZERO, &mut Some)
}

/// Does the work of [`compile`]; of what is found, what `keep` makes of it is listed and counted.
#[must_use]
pub fn compile_keeping(source: &Source, keep: &mut Keep<'_>) -> Compilation {
    compile_runs(source, Runs::new(source), &|| Duration::ZERO, keep)
}

/// Decides what becomes of a finding; `None` leaves it out.
pub type Keep<'k> = dyn FnMut(Diagnostic) -> Option<Diagnostic> + 'k;

/// Does the work of [`compile`] and tells what the stages took. `now` is the time since a fixed moment; the library has
/// no clock of its own.
#[must_use]
pub fn compile_timed(source: &Source, now: &(dyn Fn() -> Duration + Sync)) -> Compilation {
    compile_runs(source, Runs::new(source), now, &mut Some)
}

/// Does the work of [`compile`] in chunks of about `chunk_bytes`; the result is the same for any size.
#[must_use]
pub fn compile_in_chunks(source: &Source, chunk_bytes: usize) -> Compilation {
    compile_runs(source, Runs::in_chunks(source, chunk_bytes), &|| Duration::ZERO, &mut Some)
}

fn compile_runs(
    source: &Source,
    mut runs: Runs<'_>,
    now: &(dyn Fn() -> Duration + Sync),
    keep: &mut Keep<'_>,
) -> Compilation {
    let mut lowering = Lowering::new(source);
    let mut found = Found::default();
    let mut times = Times::default();
    let mut next = timed(now, &mut times.parse, || runs.next());
    while let Some(run) = next {
        let is_last = runs.is_at_end();
        let mut lower = || timed(now, &mut times.lower, || lowering.add(&run.file));
        next = if is_last {
            // A small scene is a single run: it wakes no other thread.
            lower();
            None
        } else {
            rayon::join(lower, || timed(now, &mut times.parse, || runs.next())).1
        };
        found.add(run.diagnostics, lowering.take_diagnostics(), keep);
    }
    let Lowered { program, diagnostics } = lowering.finish();
    found.add(runs.finish(), diagnostics, keep);
    let (n_errors, n_warnings) = (found.n_errors, found.n_warnings);
    let compiled = Compilation { program, diagnostics: found.into_diagnostics(), n_errors, n_warnings, times };
    with_edition(source, compiled, keep)
}

/// Asks, where something speaks against the edition 2018, which one a scene is written in. Where it is another, that one
/// finding stands in place of all that was said of its lines, which have another meaning then; only what no edition reads
/// is told besides. A good scene is not asked.
pub(crate) fn with_edition(source: &Source, mut compiled: Compilation, keep: &mut Keep<'_>) -> Compilation {
    let is_doubtful = |found: &Diagnostic| {
        found.is_error() || [&codes::ARGUMENT_ORDER, &codes::OUTSIDE_UNIT_RANGE].contains(&found.code)
    };
    if !compiled.diagnostics.iter().any(is_doubtful) {
        return compiled;
    }
    let Some(verdict) = editions::judge(source) else { return compiled };
    let found = std::mem::take(&mut compiled.diagnostics);
    let n_listed = found.len();
    if verdict.is_certain {
        let is_about_text = |found: &Diagnostic| found.code.id.starts_with("E01");
        compiled.diagnostics.extend(found.into_iter().filter(is_about_text));
        (compiled.n_errors, compiled.n_warnings) = (compiled.diagnostics.len(), 0);
        compiled.program = Program::default();
    } else {
        let rests_on = |found: &Diagnostic| verdict.rests_on(found.primary.span);
        compiled.diagnostics.extend(found.into_iter().filter(|found| found.is_error() || !rests_on(found)));
        compiled.diagnostics.iter_mut().filter(|found| rests_on(found)).for_each(|found| found.fixes.clear());
        compiled.n_warnings -= n_listed - compiled.diagnostics.len();
    }
    compiled.add(keep(verdict.diagnostic()).into_iter().collect());
    compiled
}

/// Runs `f` and adds the time it takes to `total`.
fn timed<T>(now: &dyn Fn() -> Duration, total: &mut Duration, f: impl FnOnce() -> T) -> T {
    let start = now();
    let result = f();
    *total += now().saturating_sub(start);
    result
}

/// What has been found so far.
#[derive(Default)]
struct Found {
    /// With the stage that found it: of one place the parser speaks first.
    listed: Vec<(Stage, Diagnostic)>,
    n_errors: usize,
    n_warnings: usize,
}

/// A stage that finds mistakes.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Stage {
    Parse,
    Lower,
}

impl Found {
    /// Takes what the two stages found in a run, as far as `keep` does.
    fn add(&mut self, parsed: Vec<Diagnostic>, lowered: Vec<Diagnostic>, keep: &mut Keep<'_>) {
        let of_stage = |stage| move |diagnostic| (stage, diagnostic);
        let parsed = parsed.into_iter().map(of_stage(Stage::Parse));
        let mut found: Vec<_> = parsed.chain(lowered.into_iter().map(of_stage(Stage::Lower))).collect();
        sort(&mut found);
        for (stage, diagnostic) in found {
            let Some(diagnostic) = keep(diagnostic) else { continue };
            if count(&diagnostic, &mut self.n_errors, &mut self.n_warnings) {
                self.listed.push((stage, diagnostic));
            }
        }
    }

    /// Returns what is listed, in the order of the text.
    fn into_diagnostics(mut self) -> Vec<Diagnostic> {
        sort(&mut self.listed);
        self.listed.into_iter().map(|(_, diagnostic)| diagnostic).collect()
    }
}

/// Sorts by place, then by stage; a stage has its own order.
fn sort(found: &mut [(Stage, Diagnostic)]) {
    found.sort_by_key(|(stage, diagnostic)| (diagnostic.primary.span.start, *stage));
}

/// Counts a finding and tells whether it is one of those that are listed.
fn count(diagnostic: &Diagnostic, n_errors: &mut usize, n_warnings: &mut usize) -> bool {
    let n = n_of(diagnostic, n_errors, n_warnings);
    *n += 1;
    *n <= MAX_LISTED
}

/// Returns the one of the two numbers that counts a finding.
fn n_of<'n>(diagnostic: &Diagnostic, n_errors: &'n mut usize, n_warnings: &'n mut usize) -> &'n mut usize {
    match diagnostic.severity() {
        Severity::Error => n_errors,
        Severity::Warning => n_warnings,
    }
}
