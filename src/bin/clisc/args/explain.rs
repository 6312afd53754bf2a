//! Arguments of `clisc explain`.

use clap::Args;

/// Arguments of `clisc explain`.
#[derive(Args, Debug)]
#[command(after_help = EXPLAIN_EXAMPLES)]
pub struct ExplainArgs {
    /// The code or the name of the rule, such as E0203 or unused-surface; without it all are listed.
    #[arg(value_name = "CODE")]
    pub code: Option<String>,
}

const EXPLAIN_EXAMPLES: &str = "\
Examples:
  clisc explain          every code with its title
  clisc explain E0203    what it means, a scene that has it, and its repair
  clisc explain no-fov   the same, by the name of a rule";
