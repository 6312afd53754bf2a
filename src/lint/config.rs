//! `clisc.toml`: the text of one in, options out.
//!
//! ```toml
//! exclude = ["drafts/"]     # what is left out where a folder is named, as .gitignore has it
//!
//! [lint]
//! size = "1920x1080"        # of the image by which rules judge what is seen
//!
//! [lint.rules]
//! unused-surface = "error"  # or "warning", or "off"
//! ```

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, Error as _, MapAccess, Visitor};
use toml::Spanned;

use crate::diag::Code;
use crate::lint::options::{Level, Options, find_rule};
use crate::plan::Size;
use crate::source::{LineIndex, Position};

/// A configuration that cannot be taken, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfigError {
    /// Its place in the text, if it has one.
    pub position: Option<Position>,
    /// What is wrong.
    pub message: String,
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.position {
            Some(Position { line, column }) => write!(f, "line {line}, column {column}: {}", self.message),
            None => f.write_str(&self.message),
        }
    }
}

impl std::error::Error for ConfigError {}

/// Reads a configuration.
///
/// # Errors
/// When it is no TOML, or has a key, a rule, a level or a size that is none.
pub fn parse_config(text: &str) -> Result<Options, ConfigError> {
    let file = read(text)?;
    let mut options = Options::default();
    options.size = file.lint.size.0;
    file.lint.rules.0.iter().for_each(|entry| options.set_level(entry.rule.as_ref().0, entry.level));
    Ok(options)
}

/// Reads which files below its folder a configuration leaves out: patterns as those of a .gitignore file.
///
/// # Errors
/// As [`parse_config`].
pub fn parse_exclude(text: &str) -> Result<Vec<String>, ConfigError> {
    read(text).map(|file| file.exclude)
}

fn read(text: &str) -> Result<File, ConfigError> {
    let position = |offset: usize| LineIndex::new(text).position(text, offset as u32);
    let file: File = toml::from_str(text).map_err(|error| {
        let position = error.span().map(|span| position(span.start));
        ConfigError { position, message: error.message().trim_end().replace('\n', "; ") }
    })?;
    if let Some([first, second]) = file.lint.rules.twice() {
        let [first_name, second_name] = [first, second].map(|entry| text[entry.rule.span()].trim_matches(['"', '\'']));
        let message = format!(
            "`{second_name}` is \"{}\", and `{first_name}` in line {} is \"{}\": they are one rule; keep one of the two",
            second.level.word(),
            position(first.rule.span().start).line,
            first.level.word()
        );
        return Err(ConfigError { position: Some(position(second.rule.span().start)), message });
    }
    Ok(file)
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct File {
    exclude: Vec<String>,
    lint: Lint,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct Lint {
    size: ImageSize,
    rules: Rules,
}

/// The size of an image, `WIDTHxHEIGHT`.
#[derive(Default)]
struct ImageSize(Size);

impl<'de> Deserialize<'de> for ImageSize {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let sides = text.split_once('x').and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
        let size = sides.and_then(|(width, height)| Size::new(width, height));
        let limit = Size::MAX_SIDE;
        size.map(Self)
            .ok_or_else(|| D::Error::custom(format!("`{text}` is no size such as 640x480, of at most {limit}")))
    }
}

/// The levels of rules, by their names.
#[derive(Default)]
struct Rules(Vec<Entry>);

/// The level of a rule, with the place of its name.
struct Entry {
    rule: Spanned<RuleName>,
    level: Level,
}

/// The name of a rule.
struct RuleName(&'static Code);

impl Rules {
    /// Returns the first two entries of one rule, by name and by code, say.
    fn twice(&self) -> Option<[&Entry; 2]> {
        let are_one = |a: &Entry, b: &Entry| a.rule.as_ref().0.id == b.rule.as_ref().0.id;
        self.0.iter().enumerate().find_map(|(i, second)| {
            self.0[..i].iter().find(|first| are_one(first, second)).map(|first| [first, second])
        })
    }
}

impl<'de> Deserialize<'de> for RuleName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        find_rule(&name).map(Self).map_err(D::Error::custom)
    }
}

impl<'de> Deserialize<'de> for Rules {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct RulesVisitor;
        impl<'de> Visitor<'de> for RulesVisitor {
            type Value = Rules;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table of rules and their levels")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Rules, A::Error> {
                let mut rules = Vec::new();
                while let Some((rule, level)) = map.next_entry()? {
                    rules.push(Entry { rule, level });
                }
                // A table comes in the order of its keys.
                rules.sort_by_key(|entry| entry.rule.span().start);
                Ok(Rules(rules))
            }
        }
        deserializer.deserialize_map(RulesVisitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::codes;

    #[test]
    fn levels_and_sizes_are_read() {
        let options = parse_config("[lint]\nsize = \"64x48\"\n[lint.rules]\nno-fov = \"off\"\nL0101 = \"error\"\n");
        let options = options.expect("a sound configuration");
        assert_eq!(options.size, Size::new(64, 48).expect("a size"));
        assert_eq!(options.level(&codes::NO_FOV), Level::Off);
        assert_eq!(options.level(&codes::NO_WRITE), Level::Warning);
        assert_eq!(parse_config(""), Ok(Options::default()));
        assert_eq!(
            parse_exclude("exclude = [\"drafts/\", \"*-old.cli\"]\n"),
            Ok(vec!["drafts/".into(), "*-old.cli".into()])
        );
        assert_eq!(parse_exclude("[lint]\n"), Ok(Vec::new()));
    }

    #[test]
    fn what_is_unknown_is_told_with_its_place() {
        for (text, place, words) in [
            ("[lnt]\n", (1, 2), "unknown field `lnt`"),
            ("[lint]\n  sise = \"1x1\"\n", (2, 3), "unknown field `sise`"),
            ("[lint]\nsize = \"1 by 1\"\n", (2, 8), "`1 by 1` is no size"),
            ("[lint.rules]\nno-fog = \"off\"\n", (2, 1), "there is no rule `no-fog`; did you mean `no-fov`?"),
            ("[lint.rules]\nE0203 = \"off\"\n", (2, 1), "E0203 is an error"),
            ("[lint.rules]\nno-fov = \"quiet\"\n", (2, 10), "unknown variant `quiet`"),
            (
                "[lint.rules]\nno-fov = \"off\"\n\nW0302 = \"error\"\n",
                (4, 1),
                "`W0302` is \"error\", and `no-fov` in line 2 is",
            ),
            (
                "[lint.rules]\nno-fov = \"off\"\n\"No-Fov\" = \"warning\"\n",
                (3, 1),
                "`No-Fov` is \"warning\", and `no-fov`",
            ),
            (
                "[lint.rules]\nL0101 = \"off\"\nunused-surface = \"off\"\n",
                (3, 1),
                "`unused-surface` is \"off\", and `L0101`",
            ),
            ("[lint.rules]\nno-fov = \"off\"\nno-fov = \"off\"\n", (3, 1), "duplicate key"),
            ("[lint\n", (1, 6), ""),
        ] {
            let error = parse_config(text).expect_err(text);
            let position = error.position.map(|position| (position.line, position.column));
            assert_eq!(position, Some(place), "{text}: {error}");
            assert!(error.message.contains(words), "{text}: {error}");
        }
    }
}
