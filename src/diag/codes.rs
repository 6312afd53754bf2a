//! Every code, once.
//!
//! Codes are never reused. The first two digits are the family: E01 text, E02 command shape, E03 meaning, E04 validation,
//! E05 execution; a warning has the same families behind a W.

/// How much a finding matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The scene can be rendered, though perhaps not as meant.
    Warning,
    /// The scene cannot be rendered.
    Error,
}

/// A code with what `clisc explain` says of it.
#[derive(Debug, PartialEq, Eq)]
pub struct Code {
    /// The code as printed, `E0203`.
    pub id: &'static str,
    /// How much a finding of it matters.
    pub severity: Severity,
    /// What it stands for, in a few words.
    pub title: &'static str,
    /// The long text, Markdown, with a failing scene and its repair.
    pub explanation: &'static str,
}
