//! What a report says besides the findings.

use std::path::Path;

use serde::Serialize;

use crate::diag::Severity;

/// Something that no scene is to blame for: a file that cannot be read, a link that leads nowhere.
///
/// An error means that the report is not whole.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Notification {
    /// How much it matters.
    pub severity: Severity,
    /// The file or folder it is about, as it was named.
    pub path: Option<String>,
    /// What is wrong; complete without the path.
    pub message: String,
}

impl Notification {
    /// Makes a notification of something that keeps a report from being whole.
    #[must_use]
    pub fn error(path: Option<&Path>, message: impl Into<String>) -> Self {
        Self::new(Severity::Error, path, message.into())
    }

    /// Makes a notification of something that is worth a word.
    #[must_use]
    pub fn warning(path: Option<&Path>, message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, path, message.into())
    }

    fn new(severity: Severity, path: Option<&Path>, message: String) -> Self {
        Self { severity, path: path.map(|path| path.display().to_string()), message }
    }
}
