//! `clisc check`.

use std::process::ExitCode;

use anyhow::Context;
use clisc::source::Source;

use crate::args::CheckArgs;

/// Checks scenes.
pub fn run(args: &CheckArgs) -> anyhow::Result<ExitCode> {
    for path in &args.paths {
        let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
        let source = Source::from_bytes(path.display().to_string(), bytes)?;
        let compilation = clisc::compile(&source);
        let mut out = std::io::stdout().lock();
        clisc::diag::render::render_human(
            &source,
            &compilation.diagnostics,
            clisc::diag::render::Color::Never,
            &mut out,
        )?;
    }
    Ok(ExitCode::SUCCESS)
}
