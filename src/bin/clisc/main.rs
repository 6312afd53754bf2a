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
mod outcome;
mod print;
mod problems;
mod progress;
mod threads;
mod topics;
mod version;
mod walk;

use std::process::ExitCode;

use clap::Parser;

use crate::args::{Cli, Command};
use crate::outcome::Outcome;

fn main() -> ExitCode {
    let cli = Cli::parse();
    print::decide_color(cli.color);
    let code = run(&cli).unwrap_or_else(|error| {
        print::to_stderr(&format!("error: {error:#}\n"));
        Outcome::Environment.into()
    });
    let is_quiet = matches!(&cli.command, Command::Run(args) if args.quiet);
    if !is_quiet {
        print::explained_to_stderr();
    }
    code
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
