//! What is said of a scene of another edition: one finding for the whole file.

use crate::diag::words::{listed, named};
use crate::diag::{Diagnostic, codes};
use crate::source::Span;
use crate::syntax::editions::reading::Reading;
use crate::syntax::editions::{Edition, Editions, Form, editions_with, forms_of};

/// A line that speaks for another edition.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Evidence {
    /// The line, from its name to its last argument.
    pub(super) span: Span,
    /// The form in which the other edition reads it.
    pub(super) form: &'static Form,
    /// The editions that have such a command.
    pub(super) with_it: Editions,
    /// How it reads in 2018.
    pub(super) reading: Reading,
}

/// What was found out about a scene that is not, or perhaps not, of 2018.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The editions that fit best, all equally well.
    pub editions: Editions,
    /// Whether the scene cannot be of 2018; otherwise it can, but looks as if it were not.
    pub is_certain: bool,
    /// The lines that speak for them.
    pub(super) evidence: Vec<Evidence>,
    /// The commands that the scene has, of whatever edition.
    pub(super) names: Vec<&'static str>,
}

impl Verdict {
    /// Tells whether the line of this place is one that speaks for the other edition.
    #[must_use]
    pub fn rests_on(&self, place: Span) -> bool {
        let next = self.evidence.partition_point(|evidence| evidence.span.end <= place.start);
        self.evidence.get(next).is_some_and(|evidence| evidence.span.start <= place.start)
    }

    /// Makes the one diagnostic of the file. It has no fix: an order of arguments is changed in the whole file or not at all.
    #[must_use]
    pub fn diagnostic(&self) -> Diagnostic {
        /// The most lines that are shown besides the first.
        const MAX_SHOWN: usize = 3;
        let strongest = self.evidence.iter().map(|evidence| evidence.reading).max();
        let first = self.evidence.iter().find(|evidence| Some(evidence.reading) == strongest).expect("some evidence");
        let years = self.editions.joined("or");
        let (code, message) = if self.is_certain {
            (&codes::OTHER_EDITION, format!("this scene is of the edition {years}; clisc reads that of {}", ours()))
        } else {
            (
                &codes::PERHAPS_OTHER_EDITION,
                format!("this scene looks like one of the edition {years}, not of {}", ours()),
            )
        };
        let diagnostic = Diagnostic::new(code, first.span, message).label(self.label(first));
        let mut shown = vec![first.form];
        let further = self.evidence.iter().filter(|evidence| {
            let is_new = !shown.contains(&evidence.form);
            shown.extend(is_new.then_some(evidence.form));
            is_new
        });
        let further: Vec<_> = further.take(MAX_SHOWN).collect();
        let diagnostic = further
            .into_iter()
            .fold(diagnostic, |diagnostic, evidence| diagnostic.secondary(evidence.span, self.label(evidence)));
        diagnostic.help(self.help()).note(
            "an edition holds for the whole file: mended line by line, the scene would give another picture, since \
             `surface` has its colours in another order too",
        )
    }

    /// Says what a line tells.
    fn label(&self, evidence: &Evidence) -> String {
        let name = evidence.form.name;
        match evidence.reading {
            _ if !evidence.with_it.has(Edition::OURS) => {
                format!("`{name}` is a command of {}", evidence.with_it.joined("and"))
            }
            Reading::Odd => format!("looks like `{}`", evidence.form.usage()),
            _ => format!("can only be `{}`", evidence.form.usage()),
        }
    }

    /// Says what to do: what 2018 lacks, or the order that it has.
    fn help(&self) -> String {
        let lacking: Vec<_> =
            self.names.iter().copied().filter(|name| !editions_with(name).has(Edition::OURS)).collect();
        if !lacking.is_empty() {
            return format!(
                "render it with a program for {}; {} has no {}",
                self.editions.joined("or"),
                ours(),
                named(lacking).replace(" and ", " or ")
            );
        }
        let orders: Vec<_> = self.names.iter().filter_map(|name| order_in_ours(name)).collect();
        let orders = listed(orders.iter().map(String::as_str));
        let orders = format!("in {} the order is {orders}", ours());
        if self.is_certain { orders } else { format!("if it is, reorder all of it: {orders}") }
    }
}

/// Returns the name of the edition that clisc reads.
const fn ours() -> &'static str {
    Edition::OURS.name()
}

/// Returns the order of arguments in 2018 of a command that has another one elsewhere, in a few words.
fn order_in_ours(name: &str) -> Option<String> {
    let ours = forms_of(name).find(|form| form.editions.has(Edition::OURS))?;
    forms_of(name).nth(1)?;
    Some(match name {
        // Eleven names would hide the two that matter.
        "surface" => "`surface` with the ambient colour before the diffuse one".to_owned(),
        _ => format!("`{}`", ours.usage()),
    })
}
