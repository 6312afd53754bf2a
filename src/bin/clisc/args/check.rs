//! Arguments of `clisc check`.

use std::path::PathBuf;

use clap::Args;

use crate::args::{ReportFormat, StdinArgs};

/// Arguments of `clisc check`.
#[derive(Args, Debug)]
#[command(after_help = CHECK_EXAMPLES)]
pub struct CheckArgs {
    /// Scenes; a folder means every .cli file below it, - is standard input.
    ///
    /// Below a folder names that begin with a dot, what .gitignore names and what `exclude` in clisc.toml names are left
    /// out. A path that is named here is always read.
    #[arg(value_name = "PATH", required = true)]
    pub paths: Vec<PathBuf>,
    /// What standard input is called.
    #[command(flatten)]
    pub stdin: StdinArgs,
    /// How to show what was found.
    #[arg(long, value_enum, default_value_t)]
    pub format: ReportFormat,
    /// Take warnings for errors.
    #[arg(long)]
    pub deny_warnings: bool,
}

const CHECK_EXAMPLES: &str = "\
Examples:
  clisc check two.cli                  every mistake with its place and its repair
  clisc check scenes --format short    one line each: path:line:column
  clisc check - --format json < a.cli  for other programs
  clisc check scenes --deny-warnings   exit code 1 when there is anything to say";
