//! Answers to arguments that clap refuses.

use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Error, Parser};

use super::Cli;
use crate::outcome::Outcome;
use crate::print;

impl Cli {
    /// Reads the arguments of the process. Help that is asked for is printed, and so is what is wrong with them: then only
    /// an outcome is left.
    ///
    /// # Errors
    /// When help cannot be printed.
    pub fn of_process() -> anyhow::Result<Result<Self, Outcome>> {
        let error = match Self::try_parse() {
            Ok(cli) => return Ok(Ok(cli)),
            Err(error) => error,
        };
        if !error.use_stderr() {
            print::help_to_stdout(&error.render())?;
            return Ok(Err(Outcome::Fine));
        }
        match forgotten_command(&error) {
            Some(message) => print::to_stderr(&message),
            None => print::usage_to_stderr(&error.render()),
        }
        Ok(Err(Outcome::Environment))
    }
}

/// Says what was probably meant by a scene or a folder where a command should stand.
fn forgotten_command(error: &Error) -> Option<String> {
    if error.kind() != ErrorKind::InvalidSubcommand {
        return None;
    }
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else { return None };
    let path = Path::new(word);
    let is_scene = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("cli"));
    let what = if is_scene {
        "a scene"
    } else if path.is_dir() {
        "a folder"
    } else if path.exists() || word == "-" {
        "no command"
    } else {
        return None;
    };
    Some(format!(
        "error: `{word}` is {what}; say what to do with it, such as\n  \
         clisc run {word}    render and save its images\n  \
         clisc check {word}  say what is wrong with it\n\
         For more, see `clisc --help`\n"
    ))
}
