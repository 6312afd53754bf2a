//! The command line: reads arguments and files, calls the library, prints.
//!
//! Everything that touches the world is here: files, the clock, signals, the terminal. What a scene means is not.

mod args;
mod commands;
mod config;
mod diff;
mod disk;
mod input;
mod interrupt;
mod lsp;
mod magic;
mod notes;
mod outcome;
mod print;
mod problems;
mod progress;
mod threads;
mod topics;
mod version;
mod walk;

use std::process::ExitCode;

use crate::args::{Cli, Command};
use crate::outcome::Outcome;

fn main() -> ExitCode {
    let ended = Cli::of_process().map(|cli| match cli {
        Ok(cli) => {
            print::decide_color(cli.color);
            let code = run(&cli).unwrap_or_else(tell);
            let is_quiet = matches!(&cli.command, Command::Run(args) if args.quiet);
            if !is_quiet {
                print::explained_to_stderr();
            }
            code
        }
        Err(outcome) => outcome.into(),
    });
    let code = ended.unwrap_or_else(tell);
    // Nobody has been told what is wrong.
    let is_lost =
        print::has_lost_messages() && [Outcome::Fine, Outcome::SceneErrors].map(ExitCode::from).contains(&code);
    if is_lost { Outcome::Environment.into() } else { code }
}

/// Says why a command could not do its work.
fn tell(error: anyhow::Error) -> ExitCode {
    print::to_stderr(&format!("error: {error:#}\n"));
    Outcome::Environment.into()
}

fn run(cli: &Cli) -> anyhow::Result<ExitCode> {
    match &cli.command {
        Command::Check(args) => commands::check::run(args),
        Command::Lint(args) => commands::lint::run(args),
        Command::Run(args) => commands::run::run(args),
        Command::Ir(args) => commands::ir::run(args),
        Command::Fmt(args) => commands::fmt::run(args),
        Command::Lsp(args) => commands::lsp::run(args),
        Command::Bench(args) => commands::bench::run(args),
        Command::Explain(args) => commands::explain::run(args),
        Command::Completions(args) => commands::completions::run(args),
        Command::Man(args) => commands::man::run(args),
    }
}
