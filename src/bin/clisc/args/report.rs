//! How findings are shown, of whichever command.

use clap::ValueEnum;

/// How findings are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ReportFormat {
    /// The lines of the scene with the places marked.
    #[default]
    Human,
    /// One line each.
    Short,
    /// One JSON document; docs/schemas has its schema.
    Json,
    /// One SARIF 2.1.0 document, for code hosts and editors.
    Sarif,
    /// Annotations of GitHub Actions.
    Github,
    /// A code quality report of GitLab.
    Gitlab,
}
