//! `clisc check`.

use std::process::ExitCode;

use crate::args::CheckArgs;

/// Checks scenes.
pub fn run(_args: &CheckArgs) -> anyhow::Result<ExitCode> {
    anyhow::bail!("`clisc check` is being built")
}
