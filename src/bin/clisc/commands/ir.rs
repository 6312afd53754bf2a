//! `clisc ir`.

use std::process::ExitCode;

use crate::args::IrArgs;

/// Shows a stage of the compiler.
pub fn run(_args: &IrArgs) -> anyhow::Result<ExitCode> {
    anyhow::bail!("`clisc ir` is being built")
}
