//! Every code that a stage of the compiler raises, once. The rules of `lint` declare theirs.
//!
//! Codes are never reused. The first two digits are the family: E01 text, E02 command shape, E03 meaning, E04 validation,
//! E05 execution; a warning has the same families behind a W. Each code has a page `explain/<CODE>.md`; a test fails when
//! table and folder disagree.

use std::borrow::Cow;

/// How much a finding matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The scene can be rendered, though perhaps not as meant.
    Warning,
    /// The scene cannot be rendered.
    Error,
}

impl Severity {
    /// Returns the word that every format prints.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// A code with what `clisc explain` says of it.
#[derive(Debug, PartialEq, Eq)]
pub struct Code {
    /// The code as printed, `E0203`.
    pub id: &'static str,
    /// The name by which a scene or a configuration allows it, `no-fov`; errors cannot be allowed and have none.
    pub name: Option<&'static str>,
    /// How much a finding of it matters, unless a configuration says otherwise.
    pub severity: Severity,
    /// What it stands for, in a few words.
    pub title: &'static str,
    /// The long text, Markdown, with a failing scene and its repair; as it stands in the file, see [`Code::page`].
    pub explanation: &'static str,
}

impl Code {
    /// Returns the long text as it is printed. The one of a rule is the documentation of its file, of which each line
    /// begins with a blank and the title is left out.
    #[must_use]
    pub fn page(&self) -> Cow<'static, str> {
        if self.explanation.starts_with('#') {
            return self.explanation.into();
        }
        let lines = self.explanation.lines().map(|line| line.strip_prefix(' ').unwrap_or(line));
        let body: String = lines.flat_map(|line| [line, "\n"]).collect();
        format!("# {}: {}\n\n{body}", self.id, self.title).into()
    }

    /// Returns id and name, `W0302 no-fov`.
    #[must_use]
    pub fn label(&self) -> String {
        self.name.map_or_else(|| self.id.to_owned(), |name| format!("{} {name}", self.id))
    }
}

/// Returns the name of a rule, if there is one.
macro_rules! rule_name {
    () => {
        None
    };
    ($rule:literal) => {
        Some($rule)
    };
}

/// Declares each code as a static and [`ALL`] as the list of them.
macro_rules! codes {
    ($($name:ident = $severity:ident $id:literal $($rule:literal)? : $title:literal;)*) => {
        $(
            #[doc = concat!("`", $id, "`: ", $title, ".")]
            pub static $name: Code = Code {
                id: $id,
                name: rule_name!($($rule)?),
                severity: Severity::$severity,
                title: $title,
                explanation: include_str!(concat!("explain/", $id, ".md")),
            };
        )*

        /// Every code, in the order of this table.
        pub static ALL: &[&Code] = &[$(&$name),*];
    };
}

codes! {
    // E01: text.
    INVALID_TEXT = Error "E0101": "text that is not UTF-8";
    FOREIGN_CHARACTER = Error "E0102": "a character that cannot stand here";
    // E02: the shape of a command.
    UNKNOWN_COMMAND = Error "E0201": "unknown command";
    NO_COMMAND = Error "E0202": "a line that does not begin with a command";
    MISSING_ARGUMENT = Error "E0203": "missing argument";
    SURPLUS_ARGUMENT = Error "E0204": "surplus argument";
    MALFORMED_NUMBER = Error "E0205": "malformed number";
    NOT_FINITE = Error "E0206": "infinity or NaN in place of a number";
    NUMBER_OVERFLOW = Error "E0207": "number too large";
    MISSING_FILE_NAME = Error "E0208": "missing file name";
    NOT_A_PNG = Error "E0209": "file name that does not end in `.png`";
    UNTERMINATED_QUOTE = Error "E0210": "quote that is not closed";
    // E03: meaning.
    NO_SURFACE = Error "E0301": "object before any surface";
    OTHER_EDITION = Error "E0302": "a scene of another edition of the language";
    // E04: values.
    FOV_OUT_OF_RANGE = Error "E0401": "field of view out of range";
    RADIUS_NOT_POSITIVE = Error "E0402": "radius not above 0";
    HEIGHTS_NOT_RISING = Error "E0403": "`ymin` not below `ymax`";
    NEGATIVE_SHININESS = Error "E0404": "negative shininess";
    // E05: execution.
    ABSOLUTE_NAME = Error "E0501": "absolute file name";
    PARENT_FOLDER = Error "E0502": "file name that climbs with `..`";
    LINK_LEADS_OUT = Error "E0503": "link that leads out of the output folder";
    UNSEEN_CHARACTER = Error "E0504": "file name with a character that does not show";
    READ_ONLY = Error "E0505": "read-only image";
    // W03: meaning.
    NO_WRITE = Warning "W0301" "no-write": "no `write`";
    NO_FOV = Warning "W0302" "no-fov": "no `fov` before a `write`";
    OUTSIDE_UNIT_RANGE = Warning "W0303" "outside-unit-range": "colour or coefficient outside 0 to 1";
    MANY_LIGHTS = Warning "W0304" "many-lights": "more than ten lights";
    BEHIND_LAST_WRITE = Warning "W0305" "behind-last-write": "commands behind the last `write`";
    WRITTEN_TWICE = Warning "W0306" "written-twice": "two `write`s of one name";
    ARGUMENT_ORDER = Warning "W0307" "argument-order": "a light's place before its colour";
    PERHAPS_OTHER_EDITION = Warning "W0308" "other-edition": "a scene that looks like one of another edition";
    FOV_IN_RADIANS = Warning "W0309" "fov-in-radians": "a field of view that looks like radians";
}

/// Returns the code with this id, upper or lower case.
#[must_use]
pub fn find(id: &str) -> Option<&'static Code> {
    ALL.iter().copied().find(|code| code.id.eq_ignore_ascii_case(id))
}

/// Returns the code whose id is nearest to `id` in spelling, if one is near.
#[must_use]
pub fn nearest(id: &str) -> Option<&'static Code> {
    const MAX_LEN: usize = 10;
    const MAX_DISTANCE: usize = 2;
    let id = id.to_ascii_uppercase();
    if id.len() > MAX_LEN {
        return None;
    }
    let distance = |code: &&Code| strsim::osa_distance(&id, code.id);
    ALL.iter().copied().filter(|code| distance(code) <= MAX_DISTANCE).min_by_key(distance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_sorted_by_family_and_number() {
        let (errors, warnings): (Vec<&Code>, Vec<&Code>) =
            ALL.iter().copied().partition(|code| code.severity == Severity::Error);
        assert!(errors.iter().all(|code| code.id.starts_with('E')));
        assert!(warnings.iter().all(|code| code.id.starts_with('W')));
        assert!(ALL.is_sorted_by_key(|code| (code.severity == Severity::Warning, code.id)));
    }

    #[test]
    fn codes_are_found_by_name() {
        assert_eq!(find("e0203"), Some(&MISSING_ARGUMENT));
        assert_eq!(find("E9999"), None);
        assert_eq!(nearest("E0103").map(|code| code.id), Some("E0101"));
        assert_eq!(nearest("0203").map(|code| code.id), Some("E0203"));
        assert_eq!(nearest("banana"), None);
    }
}
