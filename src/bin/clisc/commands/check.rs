//! `clisc check`.

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use anyhow::Context;
use clisc::Compilation;
use clisc::diag::Severity;
use clisc::diag::render::{Color, JsonReport, render_human, render_short};
use clisc::diag::words::counted;
use clisc::exec::refused_names;
use clisc::source::Source;

use crate::args::{CheckArgs, CheckFormat};
use crate::outcome::Outcome;
use crate::{input, print};

/// Checks scenes. What is wrong with them is the result and goes to standard output; a scene that cannot be read does
/// not keep the others from being checked.
pub fn run(args: &CheckArgs) -> anyhow::Result<ExitCode> {
    let mut printer = Printer::new(args.format)?;
    let mut tally = Tally::default();
    for path in &args.paths {
        let (scenes, missed) = input::find_scenes(path);
        missed.iter().for_each(|error| tally.miss(error));
        scenes.iter().try_for_each(|scene| check(scene, &mut printer, &mut tally))?;
    }
    printer.finish()?;
    print::to_stderr(&tally.summary());
    Ok(tally.outcome(args.deny_warnings).into())
}

/// Checks one scene.
fn check(path: &Path, printer: &mut Printer, tally: &mut Tally) -> anyhow::Result<()> {
    match input::read(path) {
        Ok(source) => {
            let mut compilation = clisc::compile(&source);
            compilation.add(refused_names(&compilation.program));
            tally.add(&compilation);
            printer.print(&source, &compilation)?;
            print::unlisted_to_stderr(&source, &compilation);
        }
        Err(error) => tally.miss(&error),
    }
    Ok(())
}

/// What has been found so far.
#[derive(Debug, Default)]
struct Tally {
    n_scenes: usize,
    n_errors: usize,
    n_warnings: usize,
    has_missed: bool,
}

impl Tally {
    fn add(&mut self, compilation: &Compilation) {
        self.n_scenes += 1;
        self.n_errors += compilation.n_errors;
        self.n_warnings += compilation.n_warnings;
    }

    /// Tells of a scene that could not be read.
    fn miss(&mut self, error: &anyhow::Error) {
        self.has_missed = true;
        print::to_stderr(&format!("error: {error:#}\n"));
    }

    fn summary(&self) -> String {
        let scenes = counted(self.n_scenes, "scene");
        format!("{scenes} checked: {}, {}\n", counted(self.n_errors, "error"), counted(self.n_warnings, "warning"))
    }

    fn outcome(&self, deny_warnings: bool) -> Outcome {
        let n_bad = self.n_errors + if deny_warnings { self.n_warnings } else { 0 };
        match (self.has_missed, n_bad) {
            (true, _) => Outcome::Environment,
            (false, 0) => Outcome::Fine,
            (false, _) => Outcome::SceneErrors,
        }
    }
}

/// Prints diagnostics as the command line asks.
enum Printer {
    Human(Color),
    Short,
    Json(JsonReport<Box<dyn Write>>),
}

impl Printer {
    fn new(format: CheckFormat) -> anyhow::Result<Self> {
        Ok(match format {
            CheckFormat::Human if print::stdout_has_color() => Self::Human(Color::Always),
            CheckFormat::Human => Self::Human(Color::Never),
            CheckFormat::Short => Self::Short,
            CheckFormat::Json => {
                let out: Box<dyn Write> = Box::new(print::stdout());
                Self::Json(JsonReport::begin(out).context(print::CANNOT_WRITE)?)
            }
        })
    }

    fn print(&mut self, source: &Source, compilation: &Compilation) -> anyhow::Result<()> {
        let diagnostics = &compilation.diagnostics;
        let mut out = print::stdout();
        let written = match self {
            Self::Human(color) => render_human(source, diagnostics, *color, &mut out),
            Self::Short => render_short(source, diagnostics, &mut out),
            Self::Json(report) => {
                for severity in [Severity::Error, Severity::Warning] {
                    report.count(severity, compilation.n_unlisted(severity));
                }
                report.add(source, diagnostics)
            }
        };
        written.and_then(|()| out.flush()).context(print::CANNOT_WRITE)
    }

    fn finish(self) -> anyhow::Result<()> {
        if let Self::Json(report) = self {
            report.finish().and_then(|mut out| out.flush()).context(print::CANNOT_WRITE)?;
        }
        Ok(())
    }
}
