//! Rule `eye-inside`.

use crate::diag::Diagnostic;
use crate::lint::context::{RuleContext, name_of};
use crate::lint::registry::declare_rule;

declare_rule! {
    /// Finds an object in which the eye is.
    ///
    /// ## Why
    ///
    /// The image shows its inside and what is in there with the eye, and nothing beyond. If it is to be a room, say so with
    /// `# clisc: allow(eye-inside)`.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
    /// sphere 0 0 1  6
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
    /// sphere 1 0 -5  1
    /// write ball.png
    /// ```
    ///
    /// ## Fix safety
    ///
    /// There is no fix: whether it is to be smaller or elsewhere is not known.
    ///
    /// ## Limits
    ///
    /// An object on whose surface the eye lies is not reported.
    pub static EYE_INSIDE = {
        id: "L0307", name: "eye-inside", title: "an object with the eye inside", fix: None,
    }
}

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    let Some(sights) = cx.sights() else { return };
    for seen in sights.objects.iter().filter(|seen| seen.holds_eye && !seen.is_copy()) {
        let name = name_of(seen.object);
        acc.push(
            Diagnostic::new(&EYE_INSIDE.code, cx.place(seen.object), format!("the eye is inside this `{name}`"))
                .label("holds the origin, where the eye is")
                .help("move it away from the origin, or make it smaller"),
        );
    }
}
