//! Rule `behind-eye`.

use crate::diag::{Diagnostic, Edit, Fix, Safety};
use crate::lint::context::{RuleContext, name_of};
use crate::lint::registry::declare_rule;
use crate::plan::{Inspected, Reason, Sight};

declare_rule! {
    /// Finds an object behind the eye, that no mirror shows and that throws no shadow.
    ///
    /// ## Why
    ///
    /// It has no effect. The eye is at the origin and looks along −z: what is to be seen has a negative z.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
    /// sphere 0 3 4  1
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
    /// sphere 0 1 -4  1
    /// write ball.png
    /// ```
    ///
    /// ## Fix safety
    ///
    /// Unsafe: removing the object changes no image, but it was probably meant to be seen.
    ///
    /// ## Limits
    ///
    /// As for `outside-view`.
    pub static BEHIND_EYE = {
        id: "L0302", name: "behind-eye", title: "an object behind the eye", fix: Some(Safety::Unsafe),
    }
}

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    let Some(sights) = cx.sights() else { return };
    let is_found = |seen: &&Inspected| seen.sight == Sight::Behind && seen.needless == Some(Reason::OutOfReach);
    for seen in sights.objects.iter().filter(is_found) {
        let (place, name) = (cx.place(seen.object), name_of(seen.object));
        let removed = vec![Edit::remove_command(cx.source, place)];
        acc.push(
            Diagnostic::new(&BEHIND_EYE.code, place, format!("this `{name}` lies behind the eye"))
                .label("no image shows it, its shadow or its reflection")
                .help("give it a negative z: the eye looks along −z")
                .fix(Fix::guess(format!("remove the {name}"), removed)),
        );
    }
}
