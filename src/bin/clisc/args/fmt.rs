//! Arguments of `clisc fmt`.

use std::path::PathBuf;

use clap::Args;

use crate::args::{ReportFormat, StdinArgs};

/// Arguments of `clisc fmt`.
#[derive(Args, Debug)]
#[command(after_help = FMT_EXAMPLES)]
pub struct FmtArgs {
    /// Scenes; a folder means every .cli file below it, - formats standard input to standard output.
    ///
    /// Below a folder names that begin with a dot, what .gitignore names and what `exclude` in clisc.toml names are left
    /// out. A path that is named here is always read.
    #[arg(value_name = "PATH", required = true)]
    pub paths: Vec<PathBuf>,
    /// What standard input is called.
    #[command(flatten)]
    pub stdin: StdinArgs,
    /// Save nothing; list the scenes that would change, and exit with 1 when there are any.
    #[arg(long)]
    pub check: bool,
    /// How --check shows what would change; without it the scenes are listed, one a line.
    #[arg(long, value_enum, requires = "check")]
    pub format: Option<ReportFormat>,
    /// Save nothing; show what would change, as patch -p1 reads it, and exit with 1 when that is anything.
    #[arg(long)]
    pub diff: bool,
}

const FMT_EXAMPLES: &str = "\
Examples:
  clisc fmt two.cli           bring a scene into its canonical form
  clisc fmt scenes            every scene below a folder
  clisc fmt scenes --check    exit code 1 when there is a scene to format
  clisc fmt scenes --check --format sarif
                              the same for other programs: also human, short, json, github, gitlab
  clisc fmt two.cli --diff    what would change
  clisc fmt - < a.cli         for editors: standard input to standard output

The program stays the same to the bit, every comment stays in order, and a line with an error is left exactly as it is. \
Numbers keep the digits that were written; .5 and 1. alone get their zeros. Between the comments `# clisc: off` and \
`# clisc: on`, each alone on its line, all stays as it is. docs/formatting.md has the whole form.";
