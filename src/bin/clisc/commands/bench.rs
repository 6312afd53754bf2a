//! `clisc bench`: run time against error.

mod error;
mod measure;
mod plot;
mod report;

use std::fs;
use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context, bail};
use clisc::exec::CancellationToken;
use clisc::ir::{self, Command, Registers, SceneView, Valid};
use clisc::plan::BackendChoice;
use clisc::trace::kernels::Backend;

use self::measure::Bench;
use self::report::{Report, SceneReport};
use crate::args::BenchArgs;
use crate::config::Configs;
use crate::interrupt::Interrupts;
use crate::outcome::Outcome;
use crate::{disk, input, print};

/// Measures scenes one after the other. A scene with errors does not keep the others from being measured; a file that
/// cannot be read or saved ends it.
pub fn run(args: &BenchArgs) -> anyhow::Result<ExitCode> {
    input::name_stdin(&args.stdin, &args.scenes)?;
    rayon::ThreadPoolBuilder::new()
        .num_threads(args.threads.into())
        .use_current_thread()
        .build_global()
        .with_context(|| format!("cannot start {} threads", args.threads))?;
    let backend = args.backend.choice()?;
    let interrupts = Interrupts::listen()?;
    if let Some(folder) = &args.svg {
        fs::create_dir_all(folder).with_context(|| format!("cannot make the folder `{}`", folder.display()))?;
    }
    let mut report = Report::new(rayon::current_num_threads(), Backend::chosen(backend).name(), args.repeat);
    let mut outcome = Outcome::Fine;
    let configs = Configs::default();
    for path in &args.scenes {
        let Some(program) = compile(path, &configs)? else {
            outcome = outcome.max(Outcome::SceneErrors);
            continue;
        };
        let measured = interrupts.while_rendering(|| measure(args, backend, path, &program, &interrupts.token()))?;
        let Some(scene) = measured else {
            outcome = Outcome::Interrupted;
            break;
        };
        print::to_stdout(&scene.table())?;
        if let Some(folder) = &args.svg {
            save_plots(folder, path, &scene)?;
        }
        report.scenes.push(scene);
    }
    // What was measured before an interruption is worth keeping.
    if let Some(file) = &args.json {
        disk::save(file, report.json()?.as_bytes()).with_context(|| format!("cannot save `{}`", file.display()))?;
    }
    Ok(outcome.into())
}

/// Compiles a scene and prints what was found; `None` when it has errors.
fn compile(path: &Path, configs: &Configs) -> anyhow::Result<Option<Valid>> {
    let source = input::read(path)?;
    let compilation = clisc::lint::check(&source, &configs.options_for(path)?);
    // There is no place left to say that this failed.
    let _ = print::diagnostics_to_stderr(&source, &compilation.diagnostics);
    print::unlisted_to_stderr(&source, &compilation);
    if compilation.has_errors() {
        return Ok(None);
    }
    // The checks of the language leave nothing to find here.
    ir::validate(compilation.program)
        .map(Some)
        .map_err(|violations| anyhow::anyhow!("a bug in clisc let pass: {}", violations[0]))
}

/// Measures the last image of a scene; `None` when that was cancelled.
fn measure(
    args: &BenchArgs,
    backend: BackendChoice,
    path: &Path,
    program: &Valid,
    cancellation: &CancellationToken,
) -> anyhow::Result<Option<SceneReport>> {
    let Some(view) = last_view(program) else {
        bail!("`{}` has no `write`: there is no image to measure", input::name_of(path));
    };
    let is_cancelled = &|| cancellation.is_cancelled();
    let bench = Bench { view, size: args.size, backend, repeat: args.repeat, is_cancelled };
    let modes = args.modes.clone().unwrap_or_else(measure::every_mode);
    Ok(bench.run(path, &modes, &args.samples))
}

/// Returns what the last `write` of a program shows.
fn last_view(program: &Valid) -> Option<SceneView<'_>> {
    let mut registers = Registers::default();
    let mut last = None;
    for command in &program.commands {
        registers.step(command);
        if matches!(command, Command::Write(_)) {
            last = Some(registers);
        }
    }
    last.map(|registers| SceneView::new(program, registers))
}

/// Saves a plot for each comparison of a scene.
fn save_plots(folder: &Path, scene: &Path, report: &SceneReport) -> anyhow::Result<()> {
    let stem = input::file_of(scene).and_then(Path::file_stem).map_or("stdin".into(), |stem| stem.to_string_lossy());
    for (what, plot) in report.plots()? {
        let file = folder.join(format!("{stem}-{what}.svg"));
        disk::save(&file, plot.as_bytes()).with_context(|| format!("cannot save `{}`", file.display()))?;
    }
    Ok(())
}
