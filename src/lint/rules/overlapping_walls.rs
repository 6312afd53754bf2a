//! Rule `overlapping-walls`.

use crate::diag::Diagnostic;
use crate::lint::context::RuleContext;
use crate::lint::registry::declare_rule;
use crate::lint::rules::cylinders::{Pairs, is_needed};
use crate::plan::Object;

declare_rule! {
    /// Finds two cylinders with one axis and one radius whose heights overlap.
    ///
    /// ## Why
    ///
    /// Where their walls lie in one place the one declared first is seen: the order of the lines decides the picture, and in other
    /// programs chance does.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
    /// cylinder 0.5  2 -6  -1 0.5
    /// cylinder 0.5  2 -6  0 1
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
    /// cylinder 0.5  2 -6  -1 0
    /// cylinder 0.5  2 -6  0 1
    /// write ball.png
    /// ```
    ///
    /// ## Fix safety
    ///
    /// There is no fix: which of the two is to be shorter is not known.
    ///
    /// ## Limits
    ///
    /// Two cylinders that are the same in all are one of `hidden-copy`.
    pub static OVERLAPPING_WALLS = {
        id: "L0309", name: "overlapping-walls", title: "walls of two cylinders in one place", fix: None,
    }
}

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    let Some(scene) = cx.scene else { return };
    let cylinders = scene.cylinders();
    let (walls, caps) = (&scene.equations().walls, &scene.equations().caps);
    let mut pairs = Pairs::default();
    pairs.add_equal(walls[..cylinders.len()].iter().copied(), |a, b| {
        let [a_high, b_high] = [cylinders[a].y_max, cylinders[b].y_max];
        caps[a] != caps[b] && cylinders[a].y_min.max(cylinders[b].y_min) < a_high.min(b_high)
    });
    for [first, second] in pairs.sorted().into_iter().filter(|pair| is_needed(cx, pair)) {
        acc.push(
            Diagnostic::new(
                &OVERLAPPING_WALLS.code,
                cx.place(Object::Cylinder(second as u32)),
                "the wall of this `cylinder` lies in the place of another's",
            )
            .label("not seen where the other is")
            .secondary(cx.place(Object::Cylinder(first as u32)), "declared first, so that it is seen")
            .help("let one of them end where the other begins, or give it another radius"),
        );
    }
}
