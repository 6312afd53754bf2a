//! What keeps a command from its work besides the scenes: a file that cannot be read or saved, a link that leads nowhere.

use std::collections::HashSet;
use std::io::Write;
use std::path::Path;

use anyhow::Context;
use clisc::diag::Severity;
use clisc::diag::render::{Notification, Report};

use crate::{input, print};

/// Makes a notification of an error at a path, as arguments have it.
pub fn error(path: Option<&Path>, error: &anyhow::Error) -> Notification {
    Notification::error(path.and_then(input::file_of), format!("{error:#}"))
}

/// The problems of a run so far.
#[derive(Debug, Default)]
pub struct Problems {
    has_error: bool,
    /// What standard error has been told: what is wrong with one configuration is wrong for each of its scenes.
    told: HashSet<String>,
}

impl Problems {
    /// Tells standard error and, if there is one, the report.
    ///
    /// # Errors
    /// When the report cannot be written.
    pub fn tell(&mut self, problem: &Notification, report: Option<&mut Report<impl Write>>) -> anyhow::Result<()> {
        self.has_error |= problem.severity == Severity::Error;
        let message = format!("{}: {}\n", problem.severity.word(), problem.message);
        if self.told.insert(message.clone()) {
            print::to_stderr(&message);
        }
        report.map_or(Ok(()), |report| report.notify(problem)).context(print::CANNOT_WRITE)
    }

    /// Tells whether one of them kept the command from some of its work.
    pub fn has_error(&self) -> bool {
        self.has_error
    }
}
