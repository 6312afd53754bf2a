//! Arguments of `clisc ir`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::StdinArgs;
use super::image::ImageArgs;

/// Arguments of `clisc ir`.
#[derive(Args, Debug)]
#[command(after_help = IR_EXAMPLES)]
pub struct IrArgs {
    /// The scene; - is standard input.
    #[arg(value_name = "SCENE")]
    pub scene: PathBuf,
    /// What standard input is called.
    #[command(flatten)]
    pub stdin: StdinArgs,
    /// The stage to show.
    #[arg(long, value_enum, value_name = "STAGE", default_value_t)]
    pub emit: Emit,
    /// How to show it.
    #[arg(long, value_enum, default_value_t)]
    pub format: DumpFormat,
    /// The images that `--emit plan` is about.
    #[command(flatten, next_help_heading = "Options of --emit plan")]
    pub image: ImageArgs,
}

const IR_EXAMPLES: &str = "\
Examples:
  clisc ir i1.cli                             the command list, to be read like assembler
  clisc ir i1.cli --emit tokens
  clisc ir i1.cli --emit plan --size 640x480  what each image needs of the scene, and what is skipped
  clisc ir i1.cli --emit ir --format json | jq";

/// A stage of the compiler.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Emit {
    /// The tokens, comments and line ends among them.
    Tokens,
    /// The syntax tree.
    Ast,
    /// Lights, surfaces and primitives.
    Ir,
    /// The command list of the executor.
    #[default]
    Commands,
    /// What each image needs of the scene, and what is skipped.
    Plan,
}

/// How `clisc ir` shows a stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum DumpFormat {
    /// For people.
    #[default]
    Text,
    /// For other programs.
    Json,
}
