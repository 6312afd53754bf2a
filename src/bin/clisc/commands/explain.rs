//! `clisc explain`.

use std::process::ExitCode;

use crate::args::ExplainArgs;

/// Explains a code.
pub fn run(_args: &ExplainArgs) -> anyhow::Result<ExitCode> {
    anyhow::bail!("`clisc explain` is being built")
}
