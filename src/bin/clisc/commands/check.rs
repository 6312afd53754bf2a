//! `clisc check`.

use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use clisc::Compilation;
use clisc::diag::Severity;
use clisc::diag::render::{Color, JsonReport, render_human, render_short};
use clisc::diag::words::counted;
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
        match find_scenes(path) {
            Ok(scenes) => scenes.iter().try_for_each(|scene| check(scene, &mut printer, &mut tally))?,
            Err(error) => tally.miss(&error),
        }
    }
    printer.finish()?;
    print::to_stderr(&tally.summary());
    Ok(tally.outcome(args.deny_warnings).into())
}

/// Checks one scene.
fn check(path: &Path, printer: &mut Printer, tally: &mut Tally) -> anyhow::Result<()> {
    match input::read(path) {
        Ok(source) => {
            let compilation = clisc::compile(&source);
            tally.add(&compilation);
            printer.print(&source, &compilation)?;
            print::unlisted_to_stderr(&source, &compilation);
        }
        Err(error) => tally.miss(&error),
    }
    Ok(())
}

/// Returns the scenes that an argument means: itself, or every `.cli` file below the folder it names.
fn find_scenes(path: &Path) -> anyhow::Result<Vec<PathBuf>> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let mut scenes = Vec::new();
    walk(path, &mut scenes)?;
    anyhow::ensure!(!scenes.is_empty(), "there is no .cli file below `{}`", path.display());
    Ok(scenes)
}

/// Appends the scenes below a folder, sorted by name; links to folders are not followed.
fn walk(folder: &Path, scenes: &mut Vec<PathBuf>) -> anyhow::Result<()> {
    let context = || format!("cannot read the folder `{}`", folder.display());
    let entries = std::fs::read_dir(folder).with_context(context)?;
    let mut entries = entries.collect::<Result<Vec<_>, _>>().with_context(context)?;
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let path = entry.path();
        if entry.file_type().with_context(context)?.is_dir() {
            walk(&path, scenes)?;
        } else if path.extension() == Some(OsStr::new("cli")) {
            scenes.push(path);
        }
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

const CANNOT_WRITE: &str = "cannot write to standard output";

impl Printer {
    fn new(format: CheckFormat) -> anyhow::Result<Self> {
        Ok(match format {
            CheckFormat::Human if print::stdout_has_color() => Self::Human(Color::Always),
            CheckFormat::Human => Self::Human(Color::Never),
            CheckFormat::Short => Self::Short,
            CheckFormat::Json => {
                let out: Box<dyn Write> = Box::new(print::stdout());
                Self::Json(JsonReport::begin(out).context(CANNOT_WRITE)?)
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
        written.and_then(|()| out.flush()).context(CANNOT_WRITE)
    }

    fn finish(self) -> anyhow::Result<()> {
        if let Self::Json(report) = self {
            report.finish().and_then(|mut out| out.flush()).context(CANNOT_WRITE)?;
        }
        Ok(())
    }
}
