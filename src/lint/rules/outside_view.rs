//! Rule `outside-view`.

use crate::diag::{Diagnostic, Edit, Fix, Safety};
use crate::lint::context::{RuleContext, name_of};
use crate::lint::registry::declare_rule;
use crate::plan::{Inspected, Reason, Sight};

declare_rule! {
    /// Finds an object beside what the images show, that no mirror shows and that throws no shadow there.
    ///
    /// ## Why
    ///
    /// It has no effect. Mostly a coordinate has a wrong sign or a wrong size, or the field of view is too narrow.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
    /// sphere 40 0 -4  1
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
    /// sphere 1.5 0 -4  0.5
    /// write ball.png
    /// ```
    ///
    /// ## Fix safety
    ///
    /// Unsafe: removing the object changes no image of the size that is judged by, 300×300 unless `clisc.toml` says otherwise,
    /// but a wider image may show it.
    ///
    /// ## Limits
    ///
    /// What is said is proved; an object of which it cannot be proved that no mirror shows it is not reported. With more than
    /// some hundred objects pairs of them are not looked at, and nothing is reported.
    pub static OUTSIDE_VIEW = {
        id: "L0301", name: "outside-view", title: "an object outside the view", fix: Some(Safety::Unsafe),
    }
}

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    let Some(sights) = cx.sights() else { return };
    let is_found = |seen: &&Inspected| seen.sight == Sight::Outside && seen.needless == Some(Reason::OutOfReach);
    for seen in sights.objects.iter().filter(is_found) {
        let (place, name) = (cx.place(seen.object), name_of(seen.object));
        let removed = vec![Edit::remove_command(cx.source, place)];
        acc.push(
            Diagnostic::new(&OUTSIDE_VIEW.code, place, format!("this `{name}` lies outside the view"))
                .label("no image shows it, its shadow or its reflection")
                .help("move it into view: the eye looks along −z, and a wider `fov` shows more")
                .fix(Fix::guess(format!("remove the {name}"), removed)),
        );
    }
}
