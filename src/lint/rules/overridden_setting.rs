//! Rule `overridden-setting`.

use crate::diag::{Diagnostic, Edit, Fix, Safety};
use crate::lint::context::RuleContext;
use crate::lint::registry::declare_rule;
use crate::lint::rules::settings::{Fate, fates};

declare_rule! {
    /// Finds a `surface`, `background` or `fov` that another replaces before anything uses it.
    ///
    /// ## Why
    ///
    /// A `surface` is used by the objects that follow it, a `background` and a `fov` by the next `write`. What is replaced
    /// before has no effect; often the two were meant for two things.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// background 0.2 0.3 0.5
    /// background 0.5 0.3 0.2
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
    /// write ball.png
    /// ```
    ///
    /// ## Instead
    ///
    /// ```cli
    /// fov 60
    /// background 0.5 0.3 0.2
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
    /// write ball.png
    /// ```
    ///
    /// ## Fix safety
    ///
    /// Safe: the first is removed, and no image depends on it.
    ///
    /// ## Limits
    ///
    /// A second one that sets the same is one of `repeated-setting`.
    pub static OVERRIDDEN_SETTING = {
        id: "L0103", name: "overridden-setting", title: "a setting that is replaced before it is used", fix: Some(Safety::Safe),
    }
}

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    for (kind, first, second) in fates(&cx.commands, Fate::Overridden) {
        let name = kind.name();
        let removed = vec![Edit::remove_command(cx.source, first)];
        acc.push(
            Diagnostic::new(&OVERRIDDEN_SETTING.code, first, format!("this `{name}` is replaced before it is used"))
                .label("has no effect")
                .secondary(second, "replaced here")
                .help("remove it, or use it before it is replaced")
                .fix(Fix::safe("remove what is replaced", removed)),
        );
    }
}
