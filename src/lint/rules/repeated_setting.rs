//! Rule `repeated-setting`.

use crate::diag::{Diagnostic, Edit, Fix, Safety};
use crate::lint::context::RuleContext;
use crate::lint::registry::declare_rule;
use crate::lint::rules::settings::{Fate, fates};

declare_rule! {
    /// Finds a `surface`, `background` or `fov` that sets what is set already.
    ///
    /// ## Why
    ///
    /// It has no effect; and who changes one of the two may think to have changed both.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 1 0 -4  0.5
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
    /// sphere 1 0 -4  0.5
    /// write ball.png
    /// ```
    ///
    /// ## Fix safety
    ///
    /// Safe: the second is removed, and what it sets stays set.
    ///
    /// ## Limits
    ///
    /// Numbers are compared, not their spelling: `1` repeats `1.0`. That no `fov` means 60 and no `background` black does not
    /// make `fov 60` or `background 0 0 0` a repetition.
    pub static REPEATED_SETTING = {
        id: "L0102", name: "repeated-setting", title: "a setting that is set already", fix: Some(Safety::Safe),
    }
}

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    for (kind, first, second) in fates(&cx.commands, Fate::Repeated) {
        let name = kind.name();
        let removed = vec![Edit::remove_command(cx.source, second)];
        acc.push(
            Diagnostic::new(&REPEATED_SETTING.code, second, format!("this `{name}` sets what is set already"))
                .label("changes nothing")
                .secondary(first, "set here, to the same")
                .help("remove it")
                .fix(Fix::safe("remove the repetition", removed)),
        );
    }
}
