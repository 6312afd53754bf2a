//! Arguments of `clisc completions`.

use clap::Args;
use clap_complete::Shell;

/// Arguments of `clisc completions`.
#[derive(Args, Debug)]
#[command(after_help = COMPLETIONS_EXAMPLES)]
pub struct CompletionsArgs {
    /// The shell that is to complete commands and options.
    #[arg(value_name = "SHELL", value_enum)]
    pub shell: Shell,
}

const COMPLETIONS_EXAMPLES: &str = "\
Examples:
  clisc completions bash > ~/.local/share/bash-completion/completions/clisc
  clisc completions zsh > ~/.zfunc/_clisc         with ~/.zfunc in fpath
  clisc completions fish > ~/.config/fish/completions/clisc.fish";
