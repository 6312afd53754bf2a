//! `clisc run`.

mod certificate;
mod reporter;
mod stats;

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context, bail};
use clisc::diag::Diagnostic;
use clisc::diag::words::counted;
use clisc::exec::{CancellationToken, ExecError, Options, WriteReport, check_names, execute};
use clisc::ir::{self, Command, Valid};
use clisc::lint::{Options as LintOptions, leave_out_allowed};
use clisc::plan::{ExactWork, Settings};
use clisc::source::Source;
use clisc::trace::kernels::Backend;

use self::certificate::Certificate;
use self::reporter::Reporter;
use self::stats::{SceneStats, StatsReport};
use crate::args::{RunArgs, StatsFormat};
use crate::disk::{self, DiskSink};
use crate::interrupt::Interrupts;
use crate::outcome::Outcome;
use crate::{input, print, threads};

/// Renders scenes and saves their images. A fault in one scene does not keep the others from being rendered.
pub fn run(args: &RunArgs) -> anyhow::Result<ExitCode> {
    input::name_stdin(&args.stdin, &args.scenes)?;
    let mut settings = Settings { backend: args.backend.choice()?, ..args.image.settings() };
    if args.certificate.is_some() {
        settings.exact_work = ExactWork::Unlimited;
    }
    if args.certificate.is_some() && !settings.precision.is_proved() {
        bail!("--certificate needs --precision certified or exact: nothing else proves every pixel");
    }
    let threads = threads::start(args.threads, &args.scenes, &settings)?;
    let interrupts = Interrupts::listen()?;
    let mut session = Session {
        args,
        certificate: Certificate::new(&settings),
        settings,
        cancellation: interrupts.token(),
        interrupts,
        sink: DiskSink::new(&args.out_dir),
        writers: HashMap::new(),
    };
    let mut report = StatsReport::new(Backend::chosen(session.settings.backend));
    for (scene_idx, path) in args.scenes.iter().enumerate() {
        let stats = session.run_scene(scene_idx, path)?;
        if args.stats == Some(StatsFormat::Table) {
            print::to_stdout(&stats.table(report.backend))?;
        }
        let interrupted = stats.outcome == Outcome::Interrupted;
        report.scenes.push(stats);
        if interrupted {
            break;
        }
    }
    if args.stats == Some(StatsFormat::Json) {
        report.threads = threads.current_num_threads();
        print::to_stdout(&report.json()?)?;
    }
    if let Some(path) = args.certificate.as_ref().filter(|_| !args.dry_run) {
        disk::save(path, session.certificate.json()?.as_bytes())
            .with_context(|| format!("cannot save the certificate `{}`", path.display()))?;
    }
    Ok(report.outcome().into())
}

/// What the scenes of one call share.
struct Session<'a> {
    args: &'a RunArgs,
    settings: Settings,
    interrupts: Interrupts,
    cancellation: CancellationToken,
    sink: DiskSink,
    /// What stands behind the images saved so far.
    certificate: Certificate,
    /// For each file which scene writes it: its place among the arguments.
    writers: HashMap<PathBuf, usize>,
}

impl Session<'_> {
    /// Takes one scene all the way; what is wrong with it or with its files is printed and told by the outcome.
    ///
    /// # Errors
    /// When results cannot be printed.
    fn run_scene(&mut self, scene_idx: usize, path: &Path) -> anyhow::Result<SceneStats> {
        let mut stats = SceneStats::new(path);
        let source = match input::read(path) {
            Ok(source) => source,
            Err(error) => {
                print::to_stderr(&format!("error: {error:#}\n"));
                stats.outcome = Outcome::Environment;
                return Ok(stats);
            }
        };
        let Some(program) = self.compile(&source, &mut stats)? else { return Ok(stats) };
        self.warn_of_shared_files(scene_idx, &program);
        let reporter = Reporter::new(self.args);
        let ended = self.execute(&program, &reporter);
        let reports = reporter.finish()?;
        self.warn_of_unproved(&reports);
        stats.add_writes(&self.args.out_dir, &reports);
        self.certificate.add_writes(path, &self.args.out_dir, &reports);
        stats.outcome = match ended {
            Ok(()) => Outcome::Fine,
            Err(error) => self.tell(&source, error)?,
        };
        Ok(stats)
    }

    /// Compiles a scene and prints what was found; `None` when it has errors.
    fn compile(&self, source: &Source, stats: &mut SceneStats) -> anyhow::Result<Option<Valid>> {
        let epoch = Instant::now();
        let mut compilation = clisc::compile_timed(source, &|| epoch.elapsed());
        leave_out_allowed(source, &LintOptions::default(), &mut compilation);
        (stats.parse, stats.lower) = (compilation.times.parse, compilation.times.lower);
        self.print_diagnostics(source, &compilation.diagnostics)?;
        if compilation.has_errors() || !self.args.quiet {
            print::unlisted_to_stderr(source, &compilation);
        }
        if compilation.has_errors() {
            let errors = counted(compilation.n_errors, "error");
            print::to_stderr(&format!("`{}` has {errors} and is not rendered\n", source.name()));
            stats.outcome = Outcome::SceneErrors;
            return Ok(None);
        }
        let start = Instant::now();
        let valid = ir::validate(compilation.program);
        stats.lower += start.elapsed();
        // The checks of the language leave nothing to find here.
        valid.map(Some).map_err(|violations| anyhow::anyhow!("a bug in clisc let pass: {}", violations[0]))
    }

    fn execute(&mut self, program: &Valid, reporter: &Reporter<'_>) -> Result<(), ExecError> {
        if self.args.dry_run {
            return self.dry_run(program, reporter);
        }
        let options = Options { settings: &self.settings, observer: reporter, cancellation: &self.cancellation };
        self.interrupts.while_rendering(|| execute(program, options, &mut self.sink)).map(drop)
    }

    /// Looks at the names and says what would be written.
    fn dry_run(&mut self, program: &Valid, reporter: &Reporter<'_>) -> Result<(), ExecError> {
        let refused = check_names(program, &mut self.sink)?;
        if !refused.is_empty() {
            return Err(ExecError::Refused(refused));
        }
        for name in names(program) {
            let (path, size) = (disk::shown(&self.args.out_dir, name), self.settings.size);
            reporter.print(&format!("would write {} ({}x{})\n", path.display(), size.width(), size.height()));
        }
        Ok(())
    }

    /// Says why a scene was not rendered to its end.
    fn tell(&self, scene: &Source, error: ExecError) -> anyhow::Result<Outcome> {
        let error = match error {
            ExecError::Refused(diagnostics) => {
                self.print_diagnostics(scene, &diagnostics)?;
                return Ok(Outcome::SceneErrors);
            }
            ExecError::Cancelled => {
                print::to_stderr(&format!("interrupted while rendering `{}`\n", scene.name()));
                return Ok(Outcome::Interrupted);
            }
            ExecError::Write { name, source } => {
                let path = disk::shown(&self.args.out_dir, &name);
                anyhow::Error::from(source).context(format!("cannot write `{}`", path.display()))
            }
            error => error.into(),
        };
        print::to_stderr(&format!("error: {error:#}\n"));
        Ok(Outcome::Environment)
    }

    fn print_diagnostics(&self, source: &Source, diagnostics: &[Diagnostic]) -> anyhow::Result<()> {
        let shown: Vec<_> = diagnostics.iter().filter(|d| d.is_error() || !self.args.quiet).cloned().collect();
        Ok(print::diagnostics_to_stderr(source, &shown)?)
    }

    /// Warns of images that would have taken more exact work than is done unasked.
    fn warn_of_unproved(&self, reports: &[WriteReport]) {
        for report in reports.iter().filter(|report| report.precision != self.settings.precision && !self.args.quiet) {
            let path = disk::shown(&self.args.out_dir, &report.name);
            print::to_stderr(&format!(
                "warning: `{}` is made in f64: to prove its pixels takes long; --precision certified does, and \
                 --precision f64 does not try\n",
                path.display()
            ));
        }
    }

    /// Warns when another scene of this call writes a file that this one writes too.
    fn warn_of_shared_files(&mut self, scene_idx: usize, program: &Valid) {
        if self.args.scenes.len() == 1 {
            return;
        }
        for name in names(program) {
            let Ok(target) = self.sink.find(name) else { continue };
            let other = self.writers.insert(target, scene_idx).filter(|other| *other != scene_idx);
            if let Some(other) = other.filter(|_| !self.args.quiet) {
                let [first, second] = [other, scene_idx].map(|idx| self.args.scenes[idx].display());
                let path = disk::shown(&self.args.out_dir, name);
                print::to_stderr(&format!("warning: `{first}` and `{second}` both write `{}`\n", path.display()));
            }
        }
    }
}

/// Returns the file names of a program, in order.
fn names(program: &Valid) -> impl Iterator<Item = &str> {
    program.commands.iter().filter_map(|command| match command {
        Command::Write(name) => Some(&**name),
        _ => None,
    })
}
