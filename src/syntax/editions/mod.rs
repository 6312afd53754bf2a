//! The editions of the language: every year the course changed its commands or the order of their arguments.
//!
//! clisc reads the edition 2018. [`FORMS`] is the one table of what each edition has; [`judge()`] reads a scene under the
//! forms of all editions and finds out which of them it is written in, where 2018 does not fit. An order of arguments is
//! a property of a whole file: no line is mended towards 2018 when the file is of another edition.
//!
//! Never here: reading good scenes (the parser asks for none of this), what a command of another edition means.

mod forms;
mod judge;
mod reading;
mod verdict;

use crate::syntax::spec::CommandKind;

pub use forms::{FORMS, Form, Law};
pub use judge::judge;
pub use reading::is_place_before_color;
pub use verdict::Verdict;

/// An edition of the language, named after its year.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Edition {
    /// Triangles; reads like 2017.
    Y2014,
    /// Triangles.
    Y2017,
    /// Cylinders; the edition that clisc reads.
    Y2018,
    /// Cones and a camera.
    Y2019,
    /// Disks, ellipsoids and a camera.
    Y2020,
    /// Triangles, a camera, and `render` in place of `write`.
    Y2022,
}

impl Edition {
    /// The edition that clisc reads.
    pub const OURS: Self = Self::Y2018;

    /// All editions, in the order in which one is taken when several fit equally well.
    pub const BY_PREFERENCE: [Self; 6] = [Self::Y2018, Self::Y2017, Self::Y2022, Self::Y2019, Self::Y2020, Self::Y2014];

    /// Returns the year.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Y2014 => "2014",
            Self::Y2017 => "2017",
            Self::Y2018 => "2018",
            Self::Y2019 => "2019",
            Self::Y2020 => "2020",
            Self::Y2022 => "2022",
        }
    }
}

/// Some of the editions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Editions(u8);

impl Editions {
    /// Makes the set of these editions.
    #[must_use]
    pub const fn of(editions: &[Edition]) -> Self {
        let (mut bits, mut i) = (0, 0);
        while i < editions.len() {
            bits |= 1 << editions[i] as u8;
            i += 1;
        }
        Self(bits)
    }

    /// Tells whether an edition is one of them.
    #[must_use]
    pub const fn has(self, edition: Edition) -> bool {
        self.0 & (1 << edition as u8) != 0
    }

    /// Returns those that are in one of the two sets.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Returns the editions, by year.
    pub fn iter(self) -> impl Iterator<Item = Edition> {
        let mut all = Edition::BY_PREFERENCE;
        all.sort_unstable();
        all.into_iter().filter(move |edition| self.has(*edition))
    }

    /// Returns the years with a word before the last: "2014 or 2017", "2014, 2017 and 2022".
    #[must_use]
    pub fn joined(self, word: &str) -> String {
        let years: Vec<_> = self.iter().map(Edition::name).collect();
        match years.split_last() {
            Some((last, rest @ [_, ..])) => format!("{} {word} {last}", rest.join(", ")),
            Some((only, [])) => (*only).to_owned(),
            None => String::new(),
        }
    }
}

/// Returns the editions that have a command of this name.
#[must_use]
pub fn editions_with(name: &str) -> Editions {
    forms_of(name).fold(Editions::default(), |all, form| all.and(form.editions))
}

/// Returns the forms of a command, one for each order of arguments that some edition has.
pub(super) fn forms_of(name: &str) -> impl Iterator<Item = &'static Form> {
    FORMS.iter().filter(move |form| form.name == name)
}

/// Tells whether the numbers of a command of 2018 could also be meant in the order that another edition has, and make
/// sense there: then nobody can say from the line alone what was meant.
///
/// ```
/// # use clisc::syntax::{editions::could_be_of_another, spec::CommandKind};
/// let light = CommandKind::Light;
/// assert!(could_be_of_another(light, &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]), "a white light at the origin");
/// assert!(!could_be_of_another(light, &[0.0, 0.0, 0.0, 5.0, 5.0, 5.0]));
/// ```
#[must_use]
pub fn could_be_of_another(kind: CommandKind, numbers: &[f64]) -> bool {
    let arguments = &kind.spec().arguments;
    let others = forms_of(kind.name()).filter(|form| form.arguments != *arguments);
    others.into_iter().any(|form| reading::is_plausible(form, numbers))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::spec::COMMANDS;

    #[test]
    fn the_forms_of_2018_are_the_commands() {
        let of_2018: Vec<_> = FORMS.iter().filter(|form| form.editions.has(Edition::OURS)).collect();
        assert_eq!(of_2018.len(), COMMANDS.len());
        for command in &COMMANDS {
            let form = of_2018.iter().find(|form| form.name == command.name).expect("a form");
            assert_eq!(form.arguments, command.arguments);
        }
    }

    #[test]
    fn an_edition_has_one_form_of_a_command() {
        for edition in Edition::BY_PREFERENCE {
            let mut names: Vec<_> =
                FORMS.iter().filter(|form| form.editions.has(edition)).map(|form| form.name).collect();
            names.sort_unstable();
            let n = names.len();
            names.dedup();
            assert_eq!(names.len(), n, "{}", edition.name());
        }
    }

    #[test]
    fn years_are_listed_with_a_word() {
        use Edition::{Y2014, Y2017, Y2022};
        assert_eq!(Editions::of(&[Y2017, Y2014]).joined("or"), "2014 or 2017");
        assert_eq!(editions_with("begin").joined("and"), "2014, 2017 and 2022");
        assert_eq!(Editions::of(&[Y2022]).joined("or"), "2022");
    }
}
