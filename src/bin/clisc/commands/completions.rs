//! `clisc completions`.

use std::process::ExitCode;

use clap::CommandFactory;

use crate::args::{Cli, CompletionsArgs};
use crate::outcome::Outcome;
use crate::print;

/// Prints the script by which a shell completes commands and options.
pub fn run(args: &CompletionsArgs) -> anyhow::Result<ExitCode> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "clisc", &mut script);
    print::to_stdout(&String::from_utf8(script)?)?;
    Ok(Outcome::Fine.into())
}
