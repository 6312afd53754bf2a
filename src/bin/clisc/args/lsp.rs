//! Arguments of `clisc lsp`.

use clap::Args;

/// Arguments of `clisc lsp`.
#[derive(Args, Debug)]
#[command(after_help = LSP_NOTES)]
pub struct LspArgs {
    /// Talk over standard input and output; the only way there is, so that saying it changes nothing.
    #[arg(long)]
    pub stdio: bool,
}

const LSP_NOTES: &str = "\
An editor starts this command and talks to it in the Language Server Protocol; docs/editors.md says how to set one up.

The server ends when the editor says so, closes standard input, or has died.

Exit codes: 0 when the editor has said goodbye, 1 when it went without.";
