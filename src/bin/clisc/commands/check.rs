//! `clisc check`.

use std::collections::HashSet;
use std::path::Path;
use std::process::ExitCode;

use anyhow::Context;
use clisc::Compilation;
use clisc::diag::Severity;
use clisc::diag::words::counted;
use clisc::ir::{self, Command, Program};
use clisc::lint::safe_fixes;
use clisc::lint::{Options, find_unseen};
use clisc::plan::Settings;
use clisc::source::Source;

use crate::args::CheckArgs;
use crate::config::Configs;
use crate::outcome::Outcome;
use crate::problems::{self, Problems};
use crate::walk::Found;
use crate::{input, notes, print};

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
            Ok(Checked { source, compilation, notes }) => {
                tally.add(&compilation);
                let n_unlisted = [Severity::Error, Severity::Warning].map(|severity| compilation.n_unlisted(severity));
                report.add(&source, &compilation.diagnostics, n_unlisted).context(print::CANNOT_WRITE)?;
                print::unlisted_to_stderr(&source, &compilation);
                notes.iter().for_each(|note| print::to_stderr(note));
            }
            Err(error) => tally.problems.tell(&problems::error(Some(path), &error), Some(&mut report))?,
        }
        Ok(())
    })?;
    print::finish(report)?;
    print::to_stderr(&tally.summary());
    Ok(tally.outcome(args.deny_warnings).into())
}

/// A scene that has been checked.
struct Checked {
    source: Source,
    /// Its program is not kept.
    compilation: Compilation,
    /// On images that are proved to show less than the scene declares.
    notes: Vec<String>,
}

fn check(path: &Path, configs: &Configs) -> anyhow::Result<Checked> {
    let source = input::read(path)?;
    let options = configs.options_for(path)?;
    let mut compilation = clisc::lint::check(&source, &options);
    let program = std::mem::take(&mut compilation.program);
    let notes = if compilation.has_errors() { Vec::new() } else { notes(&source, program, &options) };
    Ok(Checked { source, compilation, notes })
}

/// Returns a note on each image that is proved to have one colour, and one on objects that are not seen.
fn notes(source: &Source, program: Program, options: &Options) -> Vec<String> {
    /// Each image is looked at by itself.
    const MAX_IMAGES: usize = 16;
    // The checks of the language leave nothing to find here.
    let Ok(program) = ir::validate(program) else { return Vec::new() };
    let settings = Settings { size: options.size, ..Settings::default() };
    let names = program.commands.iter().filter_map(|command| match command {
        Command::Write(name) => Some(&**name),
        _ => None,
    });
    let mut known = HashSet::new();
    let note = |(write_idx, name): (usize, &str)| {
        let unseen = find_unseen(source, options, &program, write_idx, &settings);
        let is_new = known.insert(unseen.objects.first().map(|found| found.primary.span));
        if is_new || unseen.one_color.is_some() { notes::on_image(source, name, None, &unseen) } else { None }
    };
    names.take(MAX_IMAGES).enumerate().filter_map(note).collect()
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
