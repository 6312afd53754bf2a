//! Arguments of `clisc lint`.

use std::path::PathBuf;

use clap::Args;

use crate::args::{ReportFormat, StdinArgs};

/// Arguments of `clisc lint`.
#[derive(Args, Debug)]
#[command(after_help = LINT_EXAMPLES)]
pub struct LintArgs {
    /// Scenes; a folder means every .cli file below it, - is standard input.
    ///
    /// Below a folder names that begin with a dot, what .gitignore names and what `exclude` in clisc.toml names are left
    /// out. A path that is named here is always read.
    #[arg(value_name = "PATH", required = true)]
    pub paths: Vec<PathBuf>,
    /// What standard input is called.
    #[command(flatten)]
    pub stdin: StdinArgs,
    /// Carry out the safe fixes, of errors first, and save the scenes; of standard input, print it.
    #[arg(long)]
    pub fix: bool,
    /// Save nothing; show what --fix would change, as patch -p1 reads it, and exit with 1 when that is anything.
    #[arg(long)]
    pub diff: bool,
    /// Check these rules alone, by name or code.
    #[arg(long, value_name = "RULE", value_delimiter = ',')]
    pub select: Vec<String>,
    /// Do not check these rules.
    #[arg(long, value_name = "RULE", value_delimiter = ',')]
    pub ignore: Vec<String>,
    /// How to show what was found.
    #[arg(long, value_enum, default_value_t)]
    pub format: ReportFormat,
}

const LINT_EXAMPLES: &str = "\
Examples:
  clisc lint two.cli                           what is probably not meant, with ways to mend it
  clisc lint scenes --fix                      carry out what is safe: every image stays as it is
  clisc lint two.cli --diff                    what --fix would change
  clisc lint scenes --ignore below-pixel,L0501
  clisc explain unused-surface                 why a rule is one

Exit codes: 0 nothing found, 1 something was (with --diff: or would change), 2 wrong usage or a fault outside the scene.

`# clisc: allow(RULE)` behind a command, or on a line above it, allows a finding there. `clisc.toml`, in the folder of the \
scene or one above, sets levels: docs/lint.md has every rule and the whole of the file.";
