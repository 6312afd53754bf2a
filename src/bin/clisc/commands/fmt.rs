//! `clisc fmt`.

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use anyhow::Context;
use clisc::diag::Diagnostic;
use clisc::diag::words::counted;
use clisc::format::{changes, findings, format};
use clisc::source::Source;

use crate::args::FmtArgs;
use crate::config::Configs;
use crate::diff::Diff;
use crate::outcome::Outcome;
use crate::problems::{self, Problems};
use crate::walk::Found;
use crate::{disk, input, print};

/// Formats scenes, on all cores and told of in the order given. A scene that cannot be read or saved does not keep the
/// others from being formatted.
pub fn run(args: &FmtArgs) -> anyhow::Result<ExitCode> {
    input::name_stdin(&args.stdin, &args.paths)?;
    let mut tally = Tally::default();
    let Found { scenes, problems } = input::find_all_scenes(&args.paths);
    let mut report = args.format.map(print::report).transpose()?;
    problems.iter().try_for_each(|problem| tally.problems.tell(problem, report.as_mut()))?;
    let configs = Configs::default();
    let formatted = |path: &Path| format_scene(path, args, &configs);
    input::for_each_scene(&scenes, formatted, |path, result| {
        match result {
            Ok(scene) => {
                match &mut report {
                    Some(report) => report.add(&scene.source, &scene.findings, [0; 2]).context(print::CANNOT_WRITE)?,
                    None => scene.show(path, args)?,
                }
                tally.add(&scene);
            }
            Err(error) => tally.problems.tell(&problems::error(Some(path), &error), report.as_mut())?,
        }
        Ok(())
    })?;
    if let Some(report) = report {
        print::finish(report)?;
    }
    if scenes.iter().any(|path| !input::is_stdin(path)) {
        print::to_stderr(&tally.summary(args));
    }
    Ok(tally.outcome(args).into())
}

/// A scene that has been formatted.
struct Scene {
    source: Source,
    /// Its canonical form, where that is another or is asked for.
    formatted: Vec<u8>,
    has_changed: bool,
    /// What would change, where it is to be reported.
    findings: Vec<Diagnostic>,
}

/// Formats a scene, and saves it unless it is only to be looked at.
fn format_scene(path: &Path, args: &FmtArgs, configs: &Configs) -> anyhow::Result<Scene> {
    let source = input::read(path)?;
    // It changes no format, but one that is wrong is told by every command.
    configs.options_for(path)?;
    let formatted = format(&source);
    let has_changed = *formatted != *source.original_bytes();
    let is_saved = has_changed && !args.check && !args.diff && !input::is_stdin(path);
    if is_saved {
        let save = || disk::replace(path, &source.original_bytes(), &formatted);
        save().with_context(|| format!("cannot save `{}`", path.display()))?;
    }
    let findings = if args.format.is_some() && has_changed { findings(&source) } else { Vec::new() };
    Ok(Scene { source, formatted, has_changed, findings })
}

impl Scene {
    /// Prints what is asked for: the name of a scene that would change, the changes, the text of standard input.
    fn show(&self, path: &Path, args: &FmtArgs) -> anyhow::Result<()> {
        if input::is_stdin(path) && !args.check && !args.diff {
            let mut out = print::stdout();
            return out.write_all(&self.formatted).and_then(|()| out.flush()).context(print::CANNOT_WRITE);
        }
        if args.diff && self.has_changed {
            let mut out = print::stdout();
            let old = self.source.original_bytes();
            let diff = Diff::of_changes(&self.source, &changes(&self.source), &old, &self.formatted);
            return diff
                .write(input::file_name(&self.source, path), &mut out)
                .and_then(|()| out.flush())
                .context(print::CANNOT_WRITE);
        }
        if args.check && self.has_changed {
            return print::to_stdout(&format!("{}\n", self.source.name()));
        }
        Ok(())
    }
}

/// What has been done so far.
#[derive(Debug, Default)]
struct Tally {
    n_scenes: usize,
    n_changed: usize,
    problems: Problems,
}

impl Tally {
    fn add(&mut self, scene: &Scene) {
        self.n_scenes += 1;
        self.n_changed += usize::from(scene.has_changed);
    }

    fn summary(&self, args: &FmtArgs) -> String {
        let verb = if args.check || args.diff { "to be formatted" } else { "formatted" };
        let rest = self.n_scenes - self.n_changed;
        format!("{} {verb}, {rest} unchanged\n", counted(self.n_changed, "scene"))
    }

    fn outcome(&self, args: &FmtArgs) -> Outcome {
        match (self.problems.has_error(), (args.check || args.diff) && self.n_changed > 0) {
            (true, _) => Outcome::Environment,
            (false, true) => Outcome::SceneErrors,
            (false, false) => Outcome::Fine,
        }
    }
}
