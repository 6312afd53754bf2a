//! Arguments of `clisc explain`.

use clap::Args;

/// Arguments of `clisc explain`.
#[derive(Args, Debug)]
#[command(after_help = EXPLAIN_EXAMPLES)]
pub struct ExplainArgs {
    /// A code, a rule, a command of the language or a topic; without it all are listed.
    #[arg(value_name = "NAME")]
    pub name: Option<String>,
}

const EXPLAIN_EXAMPLES: &str = "\
Examples:
  clisc explain           every code, rule, command and topic
  clisc explain E0203     what a code means, a scene that has it, and its repair
  clisc explain no-fov    the same of a rule, by its name
  clisc explain sphere    what a command of the language does
  clisc explain shading   how a hit is shaded; also camera, levels, ties…

The commands and topics are the sections of grammar/semantics.md.";
