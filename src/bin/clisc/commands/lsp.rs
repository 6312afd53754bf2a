//! `clisc lsp`.

use std::process::ExitCode;

use crate::args::LspArgs;
use crate::lsp;
use crate::outcome::Outcome;

/// Serves an editor until it leaves; there is but one way to talk to it.
pub fn run(_: &LspArgs) -> anyhow::Result<ExitCode> {
    let said_goodbye = lsp::serve()?;
    Ok(if said_goodbye { Outcome::Fine } else { Outcome::SceneErrors }.into())
}
