//! Rule `fills-view`.

use crate::diag::Diagnostic;
use crate::lint::context::{RuleContext, name_of};
use crate::lint::registry::declare_rule;

declare_rule! {
    /// Finds an object that fills the whole view, with nothing in front of it.
    ///
    /// ## Why
    ///
    /// The image shows a patch of this one object and nothing else. Mostly its radius is too large, or it is too near.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -12  1
    /// sphere 0 0 -4.5  3
    /// write ball.png
    /// ```
    ///
    /// ## Instead
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -12  1
    /// sphere 0 5 -16  3
    /// write ball.png
    /// ```
    ///
    /// ## Fix safety
    ///
    /// There is no fix: whether it is to be smaller or farther away is not known.
    ///
    /// ## Limits
    ///
    /// What lies before it is looked for along rays, some hundred an object; what fits between them is not found. With the eye
    /// inside of the object it is one of `eye-inside`.
    pub static FILLS_VIEW = {
        id: "L0306", name: "fills-view", title: "an object so large that nothing else is seen", fix: None,
    }
}

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    let Some(object) = cx.filling() else { return };
    let name = name_of(object);
    acc.push(
        Diagnostic::new(
            &FILLS_VIEW.code,
            cx.place(object),
            format!("this `{name}` fills the whole view: nothing else is seen"),
        )
        .label("too large, or too near")
        .help("make it smaller, or move it away"),
    );
}
