//! Rule `unused-allow`.

use crate::diag::{Diagnostic, Safety};
use crate::lint::context::RuleContext;
use crate::lint::registry::declare_rule;

declare_rule! {
    /// Finds a comment that allows what is not found, or that says nothing clisc knows.
    ///
    /// ## Why
    ///
    /// It is left over from a finding that is gone, or has a slip in it, and hides the next one.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1  # clisc: allow(hidden-copy)
    /// write ball.png
    /// ```
    ///
    /// ## Instead
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
    /// write ball.png
    /// ```
    ///
    /// ## Fix safety
    ///
    /// Safe: what allows nothing is removed from the comment; with nothing left, the comment is.
    ///
    /// ## Limits
    ///
    /// Nothing is said of rules that are switched off, nor of a scene with errors, of which not all is known. A name that is none is
    /// always reported.
    pub static UNUSED_ALLOW = {
        id: "L0901", name: "unused-allow", title: "a comment that allows nothing", fix: Some(Safety::Safe),
    }
}

/// Nothing to do with the others: it is known only when all of them have been checked (see `lint::allow`).
fn check(_: &RuleContext<'_>, _: &mut Vec<Diagnostic>) {}
