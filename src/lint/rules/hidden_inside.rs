//! Rule `hidden-inside`.

use crate::diag::{Diagnostic, Edit, Fix, Safety};
use crate::lint::context::{RuleContext, name_of};
use crate::lint::registry::declare_rule;
use crate::plan::Reason;

declare_rule! {
    /// Finds an object that lies inside another, where nothing sees it.
    ///
    /// ## Why
    ///
    /// It has no effect. Objects are solid for the eye: what is inside is seen only with the eye inside, too.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
    /// sphere 0 0 -4  0.5
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
    /// sphere 0 0 -2.5  0.5
    /// write ball.png
    /// ```
    ///
    /// ## Fix safety
    ///
    /// Safe: the object is removed, and no image depends on it.
    ///
    /// ## Limits
    ///
    /// What is said is proved: an object that touches the other, or one behind a mirror that cuts it open, is not reported. A
    /// light inside keeps it from being reported as well.
    pub static HIDDEN_INSIDE = {
        id: "L0303", name: "hidden-inside", title: "an object inside another", fix: Some(Safety::Safe),
    }
}

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    let Some(sights) = cx.sights() else { return };
    for seen in &sights.objects {
        let Some(Reason::Inside(outer)) = seen.needless else { continue };
        if cx.filling() == Some(outer) {
            continue;
        }
        let (place, name, outer_name) = (cx.place(seen.object), name_of(seen.object), name_of(outer));
        let removed = vec![Edit::remove_command(cx.source, place)];
        acc.push(
            Diagnostic::new(&HIDDEN_INSIDE.code, place, format!("this `{name}` lies inside a `{outer_name}`"))
                .label("nothing sees it")
                .secondary(cx.place(outer), "hides it")
                .help("remove it, or move it out")
                .fix(Fix::safe(format!("remove the {name}"), removed)),
        );
    }
}
