//! Arguments of `clisc man`.

use std::path::PathBuf;

use clap::Args;

/// Arguments of `clisc man`.
#[derive(Args, Debug)]
#[command(after_help = MAN_EXAMPLES)]
pub struct ManArgs {
    /// The command whose page is printed; without it the page of clisc itself.
    #[arg(value_name = "COMMAND", conflicts_with = "out_dir")]
    pub command: Option<String>,
    /// Save every page in this folder, which is made when missing, instead of printing one.
    #[arg(short, long, value_name = "DIR")]
    pub out_dir: Option<PathBuf>,
}

const MAN_EXAMPLES: &str = "\
Examples:
  clisc man run | man -l -                     read the page of `clisc run`
  clisc man --out-dir ~/.local/share/man/man1  install every page";
