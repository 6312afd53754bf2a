//! `clisc run`.

mod certificate;
mod clashes;
mod reporter;
mod stats;

use std::collections::HashSet;
use std::io::{self, IsTerminal};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context, bail};
use clisc::diag::render::{Notification, Report};
use clisc::diag::words::counted;
use clisc::diag::{Diagnostic, Severity, codes};
use clisc::exec::{CancellationToken, ExecError, Options, WriteReport, check_names, execute};
use clisc::ir::{self, Valid};
use clisc::lint::{find_unseen, leave_out_allowed};
use clisc::plan::{ExactWork, Precision, Settings};
use clisc::source::Source;
use clisc::trace::kernels::Backend;

use self::certificate::Certificate;
use self::clashes::Preview;
use self::reporter::Reporter;
use self::stats::{SceneStats, StatsReport};
use crate::args::{RunArgs, StatsFormat};
use crate::config::Configs;
use crate::disk::{self, Destination, ImageSink, Place};
use crate::interrupt::Interrupts;
use crate::outcome::Outcome;
use crate::problems::{self, Problems};
use crate::walk::Found;
use crate::{input, notes, print, threads};

/// Renders scenes and saves their images. A fault in one scene does not keep the others from being rendered.
pub fn run(args: &RunArgs) -> anyhow::Result<ExitCode> {
    input::name_stdin(&args.stdin, &args.scenes)?;
    let destination = destination(args)?;
    let mut settings = Settings { backend: args.backend.choice()?, ..args.image.settings() };
    if args.certificate.is_some() {
        settings.exact_work = ExactWork::Unlimited;
    }
    if args.certificate.is_some() && !settings.precision.is_proved() {
        bail!("--certificate needs --precision certified or exact: nothing else proves every pixel");
    }
    let Found { scenes, problems } = input::find_all_scenes(&args.scenes);
    let threads = threads::start(args.threads, &scenes, &settings)?;
    let interrupts = Interrupts::listen()?;
    let mut session = Session {
        args,
        certificate: Certificate::new(&settings),
        settings,
        cancellation: interrupts.token(),
        interrupts,
        destination,
        configs: Configs::default(),
        problems: Problems::default(),
    };
    problems.iter().try_for_each(|problem| session.tell_problem(problem))?;
    let mut report = StatsReport::new(Backend::chosen(session.settings.backend));
    let mut previews = session.preview(&scenes)?.into_iter();
    for path in &scenes {
        let stats = session.run_scene(path, previews.next().and_then(|preview| preview.stdin), scenes.len() == 1)?;
        if args.stats == Some(StatsFormat::Table) {
            session.print(&stats.table(report.backend))?;
        }
        let interrupted = stats.outcome == Outcome::Interrupted;
        report.scenes.push(stats);
        if interrupted {
            break;
        }
    }
    if args.stats == Some(StatsFormat::Json) {
        report.threads = threads.current_num_threads();
        session.print(&report.json()?)?;
    }
    if let Some(path) = args.certificate.as_ref().filter(|_| !args.dry_run) {
        disk::save(path, session.certificate.json()?.as_bytes())
            .with_context(|| format!("cannot save the certificate `{}`", path.display()))?;
    }
    let missed = if session.problems.has_error() { Outcome::Environment } else { Outcome::Fine };
    Ok(report.outcome().max(missed).into())
}

/// Returns where the images go.
fn destination(args: &RunArgs) -> anyhow::Result<Destination> {
    let destination = Destination::parse(&args.out_dir)?;
    if destination.is_stdout() && !args.dry_run && io::stdout().is_terminal() {
        bail!(
            "an image is nothing for a terminal: send standard output elsewhere (`> image.png`), or name a file: -o image.png"
        );
    }
    Ok(destination)
}

/// What the scenes of one call share.
struct Session<'a> {
    args: &'a RunArgs,
    settings: Settings,
    interrupts: Interrupts,
    cancellation: CancellationToken,
    destination: Destination,
    /// What stands behind the images saved so far.
    certificate: Certificate,
    configs: Configs,
    problems: Problems,
}

impl Session<'_> {
    /// Prints results: to standard output, unless an image goes there.
    fn print(&self, text: &str) -> anyhow::Result<()> {
        if self.destination.is_stdout() {
            print::to_stderr(text);
            return Ok(());
        }
        print::to_stdout(text)
    }

    fn tell_problem(&mut self, problem: &Notification) -> anyhow::Result<()> {
        if self.args.quiet && problem.severity != Severity::Error {
            return Ok(());
        }
        self.problems.tell(problem, None::<&mut Report<io::Sink>>)
    }

    /// Looks at the names of several scenes before one is rendered; a scene alone is looked at when it is compiled.
    ///
    /// # Errors
    /// When two images would have one place.
    fn preview(&self, scenes: &[PathBuf]) -> anyhow::Result<Vec<Preview>> {
        if scenes.len() < 2 {
            return Ok(Vec::new());
        }
        let previews = clashes::preview(scenes);
        clashes::refuse_clashes(&self.destination, scenes, &previews)?;
        Ok(previews)
    }

    /// Takes one scene all the way; what is wrong with it or with its files is printed and told by the outcome.
    ///
    /// `stdin`: standard input, if it has been read; `is_only`: whether there is no other scene.
    ///
    /// # Errors
    /// When results cannot be printed, or when images of a scene that is the only one would have one place.
    fn run_scene(&mut self, path: &PathBuf, stdin: Option<Source>, is_only: bool) -> anyhow::Result<SceneStats> {
        let mut stats = SceneStats::new(path);
        let read = stdin.map_or_else(|| input::read(path), Ok);
        let source = match read {
            Ok(source) => source,
            Err(error) => return self.miss(path, &error, stats),
        };
        let program = match self.compile(path, &source, &mut stats) {
            Ok(Some(program)) => program,
            Ok(None) => return Ok(stats),
            Err(error) => return self.miss(path, &error, stats),
        };
        if is_only {
            clashes::refuse_clashes_within(&self.destination, path, &program)?;
        }
        let place = self.destination.place_for(path);
        let reporter = Reporter::new(self.args, &place);
        let ended = self.execute(&program, &place, &reporter);
        let reports = reporter.finish()?;
        self.warn_of_unproved(&place, &reports);
        if !self.args.quiet {
            self.note_unseen(path, &source, &program, &place, &reports)?;
        }
        stats.add_writes(&place, &reports);
        self.certificate.add_writes(path, &place, &reports);
        stats.outcome = match ended {
            Ok(()) if self.args.require_proof && reports.iter().any(|report| report.n_unproved() > 0) => {
                Outcome::Unproved
            }
            Ok(()) => Outcome::Fine,
            Err(error) => self.tell(&source, &place, error)?,
        };
        Ok(stats)
    }

    /// Says why nothing can be done with a scene.
    fn miss(&mut self, path: &Path, error: &anyhow::Error, mut stats: SceneStats) -> anyhow::Result<SceneStats> {
        self.tell_problem(&problems::error(Some(path), error))?;
        stats.outcome = Outcome::Environment;
        Ok(stats)
    }

    /// Compiles a scene and prints what was found; `None` when it has errors.
    fn compile(&self, path: &Path, source: &Source, stats: &mut SceneStats) -> anyhow::Result<Option<Valid>> {
        let options = self.configs.options_for(path)?;
        let epoch = Instant::now();
        let mut compilation = clisc::compile_timed(source, &|| epoch.elapsed());
        leave_out_allowed(source, &options, &mut compilation);
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

    fn execute(&self, program: &Valid, place: &Place, reporter: &Reporter<'_>) -> Result<(), ExecError> {
        let mut sink = ImageSink::new(place.clone());
        if self.args.dry_run {
            return self.dry_run(program, &mut sink, place, reporter);
        }
        let options = Options { settings: &self.settings, observer: reporter, cancellation: &self.cancellation };
        self.interrupts.while_rendering(|| execute(program, options, &mut sink)).map(drop)
    }

    /// Looks at the names and says what would be written.
    fn dry_run(
        &self,
        program: &Valid,
        sink: &mut ImageSink,
        place: &Place,
        reporter: &Reporter<'_>,
    ) -> Result<(), ExecError> {
        let refused = check_names(program, sink)?;
        if !refused.is_empty() {
            return Err(ExecError::Refused(refused));
        }
        for name in clashes::names(program) {
            let (path, size) = (place.shown(name), self.settings.size);
            reporter.print(&format!("would write {} ({}x{})\n", path.display(), size.width(), size.height()));
        }
        Ok(())
    }

    /// Says why a scene was not rendered to its end.
    fn tell(&self, scene: &Source, place: &Place, error: ExecError) -> anyhow::Result<Outcome> {
        let error = match error {
            ExecError::Refused(diagnostics) => {
                self.print_diagnostics(scene, &diagnostics)?;
                // A protected file is a fault of the environment, not of the scene.
                let is_protected = diagnostics.iter().any(|found| found.code == &codes::READ_ONLY);
                return Ok(if is_protected { Outcome::Environment } else { Outcome::SceneErrors });
            }
            ExecError::Cancelled => {
                print::to_stderr(&format!("interrupted while rendering `{}`\n", scene.name()));
                return Ok(Outcome::Interrupted);
            }
            ExecError::Write { name, source } => {
                let path = place.shown(&name);
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

    /// Notes of each image that shows less than its scene declares why; of objects once a scene.
    fn note_unseen(
        &self,
        path: &Path,
        source: &Source,
        program: &Valid,
        place: &Place,
        reports: &[WriteReport],
    ) -> anyhow::Result<()> {
        let options = self.configs.options_for(path)?;
        let mut known = HashSet::new();
        for report in reports.iter().filter(|report| report.color.is_some() || report.savings.objects_left_out > 0) {
            let unseen = find_unseen(source, &options, program, report.write_idx, &self.settings);
            let is_new = known.insert(unseen.objects.first().map(|found| found.primary.span));
            if report.color.is_some() || is_new {
                let image = place.shown(&report.name).display().to_string();
                let note = notes::on_image(source, &image, report.color, &unseen);
                note.iter().for_each(|note| print::to_stderr(note));
            }
        }
        Ok(())
    }

    /// Warns of images with pixels that are not proved, whether or not other warnings are asked for. A draft proves nothing, so
    /// it gets the warning only where a proof is required.
    fn warn_of_unproved(&self, place: &Place, reports: &[WriteReport]) {
        let is_draft = self.settings.precision == Precision::F32 && !self.args.require_proof;
        for report in reports.iter().filter(|report| report.n_unproved() > 0 && !is_draft) {
            let path = place.shown(&report.name);
            let (n, all) = (report.n_unproved(), report.n_pixels());
            let are = if n == 1 { "is" } else { "are" };
            let why = self.why_unproved(report);
            print::to_stderr(&format!("warning: `{}`: {n} of {all} pixels {are} not proved{why}\n", path.display()));
        }
    }

    /// Says why pixels of an image are not proved, and what to do about it.
    fn why_unproved(&self, report: &WriteReport) -> &'static str {
        let is_limited = self.settings.exact_work == ExactWork::Limited;
        match self.settings.precision {
            Precision::F32 => ": f32 makes drafts",
            Precision::F64 => " and have their best value; --precision certified proves more",
            _ if report.unproved.n_pixels == 0 => {
                ": numbers in them are equal, or nearly so; they are drawn as equal, and --certificate lists them"
            }
            _ if is_limited => {
                " and have their best value: their proof takes long; --precision certified takes the time, and \
                 --precision f64 does not try"
            }
            _ => " and have their best value",
        }
    }
}
