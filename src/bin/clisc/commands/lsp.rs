//! `clisc lsp`.

use std::process::ExitCode;

use crate::lsp;
use crate::outcome::Outcome;

/// Serves an editor until it leaves.
pub fn run() -> anyhow::Result<ExitCode> {
    let said_goodbye = lsp::serve()?;
    Ok(if said_goodbye { Outcome::Fine } else { Outcome::SceneErrors }.into())
}
