//! What a rule counts for, and by which image it judges.

use std::collections::BTreeMap;

use crate::diag::{Code, Diagnostic, Severity};
use crate::lint::registry;
use crate::plan::Size;

/// What a finding of a rule counts for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// Nothing: it is not reported.
    Off,
    /// The scene can be rendered, though perhaps not as meant.
    Warning,
    /// The scene is not accepted.
    Error,
}

impl Level {
    /// Returns the word for it in a configuration.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// What the rules are asked for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// The name of the scene's file without its ending, as far as it has one.
    pub file_stem: Option<String>,
    /// The size of the image by which rules judge what is seen.
    pub size: Size,
    /// The rules whose level is not the one of their code, by id.
    levels: BTreeMap<&'static str, Level>,
}

/// A name that is none of a rule.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum UnknownRule {
    /// No rule or code is called so; perhaps this one was meant.
    NotFound(String, Option<&'static str>),
    /// It is the code of an error, which is always one.
    IsError(&'static str),
}

impl std::fmt::Display for UnknownRule {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotFound(name, Some(nearest)) => write!(f, "there is no rule `{name}`; did you mean `{nearest}`?"),
            Self::NotFound(name, None) => write!(f, "there is no rule `{name}`"),
            Self::IsError(id) => write!(f, "{id} is an error: a scene that has it cannot be rendered"),
        }
    }
}

impl std::error::Error for UnknownRule {}

/// Returns the rule with this name or id; an error is none.
///
/// # Errors
/// When there is no such rule.
pub fn find_rule(name: &str) -> Result<&'static Code, UnknownRule> {
    match registry::find(name) {
        Some(code) if code.name.is_some() => Ok(code),
        Some(code) => Err(UnknownRule::IsError(code.id)),
        None => Err(UnknownRule::NotFound(name.to_owned(), registry::nearest(name).and_then(|code| code.name))),
    }
}

impl Options {
    /// Returns the options for a scene whose file is called so, without its ending.
    #[must_use]
    pub fn for_file(self, file_stem: Option<String>) -> Self {
        Self { file_stem, ..self }
    }

    /// Sets the level of a rule.
    pub fn set_level(&mut self, rule: &'static Code, level: Level) {
        self.levels.insert(rule.id, level);
    }

    /// Returns the level of a rule.
    #[must_use]
    pub fn level(&self, rule: &Code) -> Level {
        let of_code = match rule.severity {
            Severity::Warning => Level::Warning,
            Severity::Error => Level::Error,
        };
        self.levels.get(rule.id).copied().unwrap_or(of_code)
    }

    /// Switches off every rule but those that `names` name.
    ///
    /// # Errors
    /// When one of them is no rule.
    pub fn select(&mut self, names: &[String]) -> Result<(), UnknownRule> {
        let selected = names.iter().map(|name| find_rule(name)).collect::<Result<Vec<_>, _>>()?;
        for code in registry::all_codes().filter(|code| code.name.is_some()) {
            if !selected.contains(&code) {
                self.set_level(code, Level::Off);
            }
        }
        Ok(())
    }

    /// Switches off the rules that `names` name.
    ///
    /// # Errors
    /// When one of them is no rule.
    pub fn ignore(&mut self, names: &[String]) -> Result<(), UnknownRule> {
        for name in names {
            self.set_level(find_rule(name)?, Level::Off);
        }
        Ok(())
    }

    /// Gives a finding its level; `None` when it is not to be reported. Errors stay what they are.
    pub(super) fn leveled(&self, diagnostic: Diagnostic) -> Option<Diagnostic> {
        if diagnostic.code.name.is_none() {
            return Some(diagnostic);
        }
        let severity = match self.level(diagnostic.code) {
            Level::Off => return None,
            Level::Warning => Severity::Warning,
            Level::Error => Severity::Error,
        };
        Some(Diagnostic { severity, ..diagnostic })
    }
}
