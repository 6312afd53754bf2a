//! `clisc lint`.

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use anyhow::Context;
use clisc::Compilation;
use clisc::diag::Severity;
use clisc::diag::words::counted;
use clisc::lint::{Options, UnknownRule, fix_all, lint, safe_fixes};
use clisc::source::Source;

use crate::args::LintArgs;
use crate::config::Configs;
use crate::diff::Diff;
use crate::outcome::Outcome;
use crate::problems::{self, Problems};
use crate::walk::Found;
use crate::{disk, input, print};

/// Lints scenes, on all cores and told of in the order given. A scene that cannot be read or saved does not keep the others
/// from being linted.
pub fn run(args: &LintArgs) -> anyhow::Result<ExitCode> {
    input::name_stdin(&args.stdin, &args.paths)?;
    let configs = Configs::default();
    // A name that is no rule is told before anything is read.
    choose(args, &mut Options::default())?;
    let mut tally = Tally::default();
    let Found { scenes, problems } = input::find_all_scenes(&args.paths);
    let shows_text = args.diff || (args.fix && scenes.iter().any(|path| input::is_stdin(path)));
    let mut report = if shows_text { None } else { Some(print::report(args.format)?) };
    problems.iter().try_for_each(|problem| tally.problems.tell(problem, report.as_mut()))?;
    let linted = |path: &Path| lint_scene(path, args, &configs);
    input::for_each_scene(&scenes, linted, |path, result| {
        match result {
            Ok(scene) => {
                scene.show(path, args)?;
                tally.add(&scene);
                let Scene { source, found, .. } = &scene;
                if let Some(report) = &mut report {
                    let n_unlisted = [Severity::Error, Severity::Warning].map(|severity| found.n_unlisted(severity));
                    report.add(source, &found.diagnostics, n_unlisted).context(print::CANNOT_WRITE)?;
                    print::unlisted_to_stderr(source, found);
                }
            }
            Err(error) => tally.problems.tell(&problems::error(Some(path), &error), report.as_mut())?,
        }
        Ok(())
    })?;
    if let Some(report) = report {
        print::finish(report)?;
    }
    print::to_stderr(&tally.summary(args));
    Ok(tally.outcome(args).into())
}

/// A scene that has been linted.
struct Scene {
    /// With its fixes, if they were asked for.
    source: Source,
    found: Compilation,
    /// The bytes before they were fixed, where that has changed them.
    original: Option<Vec<u8>>,
    n_fixes: usize,
}

/// Lints a scene, and saves it with its fixes if that is asked for.
fn lint_scene(path: &Path, args: &LintArgs, configs: &Configs) -> anyhow::Result<Scene> {
    let source = input::read(path)?;
    let mut options = configs.options_for(path)?;
    choose(args, &mut options)?;
    if !args.fix && !args.diff {
        let found = lint(&source, &options);
        return Ok(Scene { source, found, original: None, n_fixes: 0 });
    }
    let fixed = fix_all(&source, &options);
    if fixed.n_fixes == 0 {
        let found = lint(&source, &options);
        return Ok(Scene { source, found, original: None, n_fixes: 0 });
    }
    let original = source.original_bytes().into_owned();
    if !args.diff && !input::is_stdin(path) {
        let save = || disk::replace(path, &original, fixed.text.as_bytes());
        save().with_context(|| format!("cannot save `{}`", path.display()))?;
    }
    let source = Source::new(source.name(), fixed.text);
    let found = lint(&source, &options);
    Ok(Scene { source, found, original: Some(original), n_fixes: fixed.n_fixes })
}

/// Takes over which rules the command line asks for.
fn choose(args: &LintArgs, options: &mut Options) -> Result<(), UnknownRule> {
    if !args.select.is_empty() {
        options.select(&args.select)?;
    }
    options.ignore(&args.ignore)
}

impl Scene {
    /// Prints the changes, or the text of standard input, if that is asked for.
    fn show(&self, path: &Path, args: &LintArgs) -> anyhow::Result<()> {
        let mut out = print::stdout();
        if args.diff {
            let Some(original) = &self.original else { return Ok(()) };
            let diff = Diff::of_texts(original, self.source.text().as_bytes());
            return diff
                .write(input::file_name(&self.source, path), &mut out)
                .and_then(|()| out.flush())
                .context(print::CANNOT_WRITE);
        }
        if args.fix && input::is_stdin(path) {
            let text = self.source.original_bytes();
            return out.write_all(&text).and_then(|()| out.flush()).context(print::CANNOT_WRITE);
        }
        Ok(())
    }
}

/// What has been found so far.
#[derive(Debug, Default)]
struct Tally {
    n_scenes: usize,
    n_errors: usize,
    n_warnings: usize,
    n_fixed: usize,
    n_changed: usize,
    n_fixable: usize,
    problems: Problems,
}

impl Tally {
    fn add(&mut self, scene: &Scene) {
        self.n_scenes += 1;
        self.n_errors += scene.found.n_errors;
        self.n_warnings += scene.found.n_warnings;
        self.n_fixed += scene.n_fixes;
        self.n_changed += usize::from(scene.original.is_some());
        self.n_fixable += safe_fixes(&scene.found.diagnostics).count();
    }

    fn summary(&self, args: &LintArgs) -> String {
        let found = format!("{}, {}", counted(self.n_errors, "error"), counted(self.n_warnings, "warning"));
        let verb = if args.diff { "to be carried out" } else { "carried out" };
        let fixed = match self.n_fixed {
            0 => String::new(),
            1 => format!(", 1 fix {verb}"),
            n => format!(", {n} fixes {verb}"),
        };
        let fixable = match self.n_fixable {
            0 => String::new(),
            n => format!(", {n} that --fix mends"),
        };
        format!("{} linted: {found}{fixed}{fixable}\n", counted(self.n_scenes, "scene"))
    }

    fn outcome(&self, args: &LintArgs) -> Outcome {
        let n_differences = if args.diff { self.n_changed } else { 0 };
        match (self.problems.has_error(), self.n_errors + self.n_warnings + n_differences) {
            (true, _) => Outcome::Environment,
            (false, 0) => Outcome::Fine,
            (false, _) => Outcome::SceneErrors,
        }
    }
}
