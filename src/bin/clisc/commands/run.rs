//! `clisc run`.

use std::process::ExitCode;

use crate::args::RunArgs;

/// Renders scenes.
pub fn run(_args: &RunArgs) -> anyhow::Result<ExitCode> {
    anyhow::bail!("`clisc run` is being built")
}
