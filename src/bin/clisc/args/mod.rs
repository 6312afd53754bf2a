//! What the command line says: a file for each command, `image` for what several of them ask of an image.

pub mod backend;
mod bench;
mod check;
mod completions;
mod explain;
mod fmt;
mod image;
mod ir;
mod lint;
mod lsp;
mod man;
mod number;
mod report;
mod run;
mod stdin;
mod usage;

use clap::error::ErrorKind;
use clap::{ArgMatches, Args, FromArgMatches, Parser, Subcommand, ValueEnum};

pub use bench::BenchArgs;
pub use check::CheckArgs;
pub use completions::CompletionsArgs;
pub use explain::ExplainArgs;
pub use fmt::FmtArgs;
pub use image::Precision;
pub use ir::{DumpFormat, Emit, IrArgs};
pub use lint::LintArgs;
pub use lsp::LspArgs;
pub use man::ManArgs;
pub use report::ReportFormat;
pub use run::{RunArgs, StatsFormat};
pub use stdin::StdinArgs;

use crate::version;

/// Compiles and renders `.cli` scenes.
#[derive(Debug, Parser)]
#[command(version, long_version = version::long(), arg_required_else_help = true, after_help = CLI_EXAMPLES)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// When to colour what is printed.
    #[arg(long, global = true, value_enum, value_name = "WHEN", default_value_t)]
    pub color: ColorWhen,
}

/// When what is printed is coloured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ColorWhen {
    /// On a terminal, unless NO_COLOR is set.
    #[default]
    Auto,
    /// Into files and pipes too.
    Always,
    /// Nowhere.
    Never,
}

const CLI_EXAMPLES: &str = "\
Examples:
  clisc check scenes               say what is wrong with the scenes below a folder
  clisc lint scenes                what is valid and probably not meant
  clisc run i1.cli                 render i1.cli and save its images here
  clisc fmt scenes                 bring the scenes below a folder into their canonical form
  clisc ir i1.cli --emit commands  show what i1.cli was compiled to
  clisc bench i1.cli               measure time and error of every arithmetic
  clisc explain E0203              explain a code that a message showed
  clisc explain shading            what the language says on a topic or command

Exit codes: 0 fine, 1 a scene has errors, 2 wrong usage or a fault outside the scene, 130 interrupted.";

/// Defines what clisc can do: an enum, and how clap makes one of its variants from a command line.
///
/// Clap's own derive describes the options of every command on each call, which takes a tenth of a millisecond. Here only those
/// of the command that is called are described.
macro_rules! commands {
    ($($(#[doc = $about:literal])+ $name:literal => $command:ident($args:ty),)+) => {
        /// What to do.
        #[derive(Debug)]
        pub enum Command {
            $($(#[doc = $about])+ $command($args),)+
        }

        impl Subcommand for Command {
            fn augment_subcommands(clisc: clap::Command) -> clap::Command {
                $(
                    let clisc = clisc.subcommand(
                        clap::Command::new($name)
                            .about(about(concat!($($about),+)))
                            .defer(|command| <$args>::augment_args(command).about(about(concat!($($about),+)))),
                    );
                )+
                clisc
            }

            fn augment_subcommands_for_update(clisc: clap::Command) -> clap::Command {
                Self::augment_subcommands(clisc)
            }

            fn has_subcommand(name: &str) -> bool {
                [$($name),+].contains(&name)
            }
        }

        impl FromArgMatches for Command {
            fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
                match matches.subcommand() {
                    $(Some(($name, matches)) => <$args>::from_arg_matches(matches).map(Self::$command),)+
                    _ => Err(clap::Error::new(ErrorKind::MissingSubcommand)),
                }
            }

            fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
                Self::from_arg_matches(matches).map(|command| *self = command)
            }
        }
    };
}

commands! {
    /// Checks scenes and says what is wrong with them.
    "check" => Check(CheckArgs),
    /// Finds what is valid in scenes and probably not meant, and mends what is safe to mend.
    "lint" => Lint(LintArgs),
    /// Renders scenes and saves their images.
    "run" => Run(RunArgs),
    /// Shows what a scene becomes at a stage of the compiler.
    "ir" => Ir(IrArgs),
    /// Brings scenes into their canonical form.
    "fmt" => Fmt(FmtArgs),
    /// Serves an editor: the language server.
    "lsp" => Lsp(LspArgs),
    /// Measures run time against error.
    "bench" => Bench(BenchArgs),
    /// Explains a code, a rule, a command of the language or a topic.
    "explain" => Explain(ExplainArgs),
    /// Prints the script by which a shell completes commands and options.
    "completions" => Completions(CompletionsArgs),
    /// Prints or saves manual pages.
    "man" => Man(ManArgs),
}

/// Returns the text of a doc comment as help shows it.
fn about(doc: &'static str) -> &'static str {
    doc.trim().trim_end_matches('.')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_definition_is_sound() {
        <Cli as clap::CommandFactory>::command().debug_assert();
    }
}
