//! Arguments of `clisc explain`.

use clap::Args;

/// Arguments of `clisc explain`.
#[derive(Args, Debug)]
#[command(after_help = EXPLAIN_EXAMPLES)]
pub struct ExplainArgs {
    /// The code, such as E0203; without it every code is listed.
    #[arg(value_name = "CODE")]
    pub code: Option<String>,
}

const EXPLAIN_EXAMPLES: &str = "\
Examples:
  clisc explain        every code with its title
  clisc explain E0203  what it means, a scene that has it, and its repair";
