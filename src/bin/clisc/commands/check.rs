//! `clisc check`.

use std::path::Path;
use std::process::ExitCode;

use anyhow::Context;
use clisc::Compilation;
use clisc::diag::Severity;
use clisc::diag::words::counted;
use clisc::ir::Program;
use clisc::lint::safe_fixes;
use clisc::source::Source;

use crate::args::CheckArgs;
use crate::config::Configs;
use crate::outcome::Outcome;
use crate::problems::{self, Problems};
use crate::walk::Found;
use crate::{input, print};

/// Checks scenes, on all cores and told of in the order given. What is wrong with them is the result and goes to standard
/// output; a scene that cannot be read does not keep the others from being checked.
pub fn run(args: &CheckArgs) -> anyhow::Result<ExitCode> {
    input::name_stdin(&args.stdin, &args.paths)?;
    let mut tally = Tally::default();
    let Found { scenes, problems } = input::find_all_scenes(&args.paths);
    let mut report = print::report(args.format)?;
    problems.iter().try_for_each(|problem| tally.problems.tell(problem, Some(&mut report)))?;
    let configs = Configs::default();
    let checked = |path: &Path| check(path, &configs);
    input::for_each_scene(&scenes, checked, |path, checked| {
        match checked {
            Ok((source, compilation)) => {
                tally.add(&compilation);
                let n_unlisted = [Severity::Error, Severity::Warning].map(|severity| compilation.n_unlisted(severity));
                report.add(&source, &compilation.diagnostics, n_unlisted).context(print::CANNOT_WRITE)?;
                print::unlisted_to_stderr(&source, &compilation);
            }
            Err(error) => tally.problems.tell(&problems::error(Some(path), &error), Some(&mut report))?,
        }
        Ok(())
    })?;
    print::finish(report)?;
    print::to_stderr(&tally.summary());
    Ok(tally.outcome(args.deny_warnings).into())
}

/// Checks one scene; its program is not kept.
fn check(path: &Path, configs: &Configs) -> anyhow::Result<(Source, Compilation)> {
    let source = input::read(path)?;
    let mut compilation = clisc::lint::check(&source, &configs.options_for(path)?);
    compilation.program = Program::default();
    Ok((source, compilation))
}

/// What has been found so far.
#[derive(Debug, Default)]
struct Tally {
    n_scenes: usize,
    n_errors: usize,
    n_warnings: usize,
    n_mendable: usize,
    problems: Problems,
}

impl Tally {
    fn add(&mut self, compilation: &Compilation) {
        self.n_scenes += 1;
        self.n_errors += compilation.n_errors;
        self.n_warnings += compilation.n_warnings;
        self.n_mendable += safe_fixes(&compilation.diagnostics).count();
    }

    fn summary(&self) -> String {
        let scenes = counted(self.n_scenes, "scene");
        let mended = match self.n_mendable {
            0 => String::new(),
            n => format!("; `clisc lint --fix` mends {n}"),
        };
        format!(
            "{scenes} checked: {}, {}{mended}\n",
            counted(self.n_errors, "error"),
            counted(self.n_warnings, "warning")
        )
    }

    fn outcome(&self, deny_warnings: bool) -> Outcome {
        let n_bad = self.n_errors + if deny_warnings { self.n_warnings } else { 0 };
        match (self.problems.has_error(), n_bad) {
            (true, _) => Outcome::Environment,
            (false, 0) => Outcome::Fine,
            (false, _) => Outcome::SceneErrors,
        }
    }
}
