//! `clisc man`.

use std::path::Path;
use std::process::ExitCode;

use anyhow::Context;
use clap::{Command, CommandFactory};
use clap_mangen::Man;

use crate::args::{Cli, ManArgs};
use crate::outcome::Outcome;
use crate::{disk, print};

/// Prints a manual page, or saves them all.
pub fn run(args: &ManArgs) -> anyhow::Result<ExitCode> {
    let clisc = whole();
    match (&args.command, &args.out_dir) {
        (Some(name), _) => print::to_stdout(&page(find(&clisc, name)?)?)?,
        (None, None) => print::to_stdout(&page(&clisc)?)?,
        (None, Some(folder)) => save(&clisc, folder)?,
    }
    Ok(Outcome::Fine.into())
}

/// Returns the definition of the command line with the long names of its commands (`clisc-run`), as pages are called.
fn whole() -> Command {
    let mut clisc = Cli::command().disable_help_subcommand(true);
    clisc.build();
    clisc
}

fn find<'a>(clisc: &'a Command, name: &str) -> anyhow::Result<&'a Command> {
    clisc.find_subcommand(name).with_context(|| {
        let names: Vec<&str> = clisc.get_subcommands().map(Command::get_name).collect();
        format!("there is no command `{name}`; the commands are {}", names.join(", "))
    })
}

/// Saves every page; each is there as a whole or not at all.
fn save(clisc: &Command, folder: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make the folder `{}`", folder.display()))?;
    for command in std::iter::once(clisc).chain(clisc.get_subcommands()) {
        let path = folder.join(format!("{}.1", page_name(command)));
        disk::save(&path, page(command)?.as_bytes()).with_context(|| format!("cannot save `{}`", path.display()))?;
    }
    Ok(())
}

fn page(command: &Command) -> anyhow::Result<String> {
    let mut roff = Vec::new();
    Man::new(command.clone()).render(&mut roff)?;
    Ok(String::from_utf8(roff)?)
}

fn page_name(command: &Command) -> String {
    command.get_display_name().unwrap_or_else(|| command.get_name()).to_owned()
}
