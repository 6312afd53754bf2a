//! `clisc check`.

use std::ffi::OsStr;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
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
        let (scenes, missed) = find_scenes(path);
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

/// Returns the scenes that an argument means: itself, or every `.cli` file below the folder it names, as far as that can
/// be read. Says what could not be.
fn find_scenes(path: &Path) -> (Vec<PathBuf>, Vec<anyhow::Error>) {
    if !path.is_dir() {
        return (vec![path.to_owned()], Vec::new());
    }
    let (mut scenes, mut missed) = (Vec::new(), Vec::new());
    walk(path, &mut scenes, &mut missed);
    if scenes.is_empty() && missed.is_empty() {
        missed.push(anyhow::anyhow!("there is no .cli file below `{}`", path.display()));
    }
    (scenes, missed)
}

/// Appends the scenes below a folder, sorted by name, and the folders that cannot be read; links to folders are not
/// followed.
fn walk(folder: &Path, scenes: &mut Vec<PathBuf>, missed: &mut Vec<anyhow::Error>) {
    match list(folder) {
        Ok(entries) => entries.into_iter().for_each(|(path, is_folder)| {
            if is_folder {
                walk(&path, scenes, missed);
            } else if path.extension() == Some(OsStr::new("cli")) {
                scenes.push(path);
            }
        }),
        Err(error) => {
            let message = format!("cannot read the folder `{}`", folder.display());
            missed.push(anyhow::Error::from(error).context(message));
        }
    }
}

/// Returns what is in a folder, sorted by name, and whether it is a folder itself.
fn list(folder: &Path) -> io::Result<Vec<(PathBuf, bool)>> {
    let entries =
        fs::read_dir(folder)?.map(|entry| entry.and_then(|entry| Ok((entry.path(), entry.file_type()?.is_dir()))));
    let mut entries = entries.collect::<Result<Vec<_>, _>>()?;
    entries.sort();
    Ok(entries)
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
