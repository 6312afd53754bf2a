//! What is wrong with a scene, and how much of that an editor shows.

use crate::diag::{Diagnostic, Severity};
use crate::source::Span;

/// The most findings of one scene that an editor shows: more than anyone reads, and thousands make editors slow.
pub const MAX_SHOWN: usize = 300;

/// What is wrong with a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Found {
    /// The findings that are kept, in the order of the text.
    pub listed: Vec<Diagnostic>,
    /// How many errors there are, those that are not listed included.
    pub n_errors: usize,
    /// How many warnings there are, those that are not listed included.
    pub n_warnings: usize,
}

/// The findings that an editor does not show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rest {
    /// Where the first of them is.
    pub at: Span,
    /// The severity of the first of them.
    pub severity: Severity,
    /// How many errors are among them.
    pub n_errors: usize,
    /// How many warnings are among them.
    pub n_warnings: usize,
}

impl Found {
    /// Returns the findings that an editor shows, errors first, at most [`MAX_SHOWN`], and what is left out.
    #[must_use]
    pub fn shown(&self) -> (Vec<&Diagnostic>, Option<Rest>) {
        let mut shown: Vec<_> = self.listed.iter().collect();
        shown.sort_by_key(|found| !found.is_error());
        let rest = shown.get(MAX_SHOWN).map(|first| {
            let n_errors = shown[..MAX_SHOWN].iter().filter(|found| found.is_error()).count();
            Rest {
                at: first.primary.span,
                severity: first.severity(),
                n_errors: self.n_errors - n_errors,
                n_warnings: self.n_warnings - (MAX_SHOWN - n_errors),
            }
        });
        shown.truncate(MAX_SHOWN);
        (shown, rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ide::diagnostics_of;
    use crate::lint::Options;
    use crate::source::Source;

    #[test]
    fn errors_come_first_and_the_rest_is_counted() {
        let scene = |n_warnings: usize, n_errors: usize| {
            let text = "surface 0 0 0 0 0 0 0 0 0 1 0\n".repeat(n_warnings) + &"sphere 0\n".repeat(n_errors);
            diagnostics_of(&Source::new("a.cli", &text), &Options::default())
        };
        let few = scene(10, 10);
        assert_eq!((few.shown().0.len(), few.shown().1), (few.listed.len(), None));
        assert!(few.shown().0[..10].iter().all(|found| found.is_error()));

        let many = scene(MAX_SHOWN, MAX_SHOWN - 1);
        let (shown, rest) = many.shown();
        let rest = rest.expect("more than is shown");
        assert_eq!((shown.len(), rest.severity, rest.n_errors), (MAX_SHOWN, Severity::Warning, 0));
        assert_eq!(rest.n_warnings, many.n_warnings - 1);

        let far_more = scene(0, 20_000);
        let (shown, rest) = far_more.shown();
        let rest = rest.expect("more than is shown");
        assert_eq!((shown.len(), rest.severity, rest.n_errors), (MAX_SHOWN, Severity::Error, 20_000 - MAX_SHOWN));
        assert_eq!(rest.at.start as usize, MAX_SHOWN * "sphere 0\n".len());
    }
}
