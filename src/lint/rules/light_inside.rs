//! Rule `light-inside`.

use crate::diag::Diagnostic;
use crate::lint::context::{RuleContext, name_of};
use crate::lint::registry::declare_rule;

declare_rule! {
    /// Finds a light inside an object in which the eye is not.
    ///
    /// ## Why
    ///
    /// The object keeps all of its light in: nothing that the eye sees is lit by it.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// light 0.2 0.2 0.2  0.3 0 -4
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
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
    /// There is no fix: whether the light or the object is to move is not known.
    ///
    /// ## Limits
    ///
    /// Light may get out where another object cuts a hole into the first, for of coincident surfaces only one is met; that is
    /// not looked for. A black light is one of `dark-light`.
    pub static LIGHT_INSIDE = {
        id: "L0203", name: "light-inside", title: "a light inside an object", fix: None,
    }
}

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    let Some(sights) = cx.sights() else { return };
    let mut known = Vec::new();
    for seen in sights.objects.iter().filter(|seen| !seen.holds_eye && cx.filling() != Some(seen.object)) {
        for &light in &seen.lights_inside {
            if known.contains(&light) {
                continue;
            }
            known.push(light);
            let name = name_of(seen.object);
            acc.push(
                Diagnostic::new(
                    &LIGHT_INSIDE.code,
                    cx.place_of_light(light),
                    format!("this light stands inside a `{name}`"),
                )
                .label("shines on nothing that is seen")
                .secondary(cx.place(seen.object), "keeps its light in")
                .help("move the light out, or the object away"),
            );
        }
    }
}
