//! How a command ended, as its exit code says it.

use std::process::ExitCode;

use crate::interrupt;

/// How a command ended. The order is that of gravity: of several scenes the worst counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// All went well.
    #[default]
    Fine,
    /// An image has pixels that are not proved, and was to be proved.
    Unproved,
    /// A scene has errors.
    SceneErrors,
    /// The command line or the world is at fault: a file that cannot be read, a full disk.
    Environment,
    /// Ended by Ctrl-C or SIGTERM.
    Interrupted,
}

impl From<Outcome> for ExitCode {
    fn from(outcome: Outcome) -> Self {
        Self::from(match outcome {
            Outcome::Fine => 0,
            Outcome::Unproved | Outcome::SceneErrors => 1,
            Outcome::Environment => 2,
            Outcome::Interrupted => interrupt::EXIT_CODE,
        })
    }
}
