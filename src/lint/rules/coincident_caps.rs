//! Rule `coincident-caps`.

use crate::diag::Diagnostic;
use crate::ir::{Cylinder, SceneView, Sphere};
use crate::lint::context::RuleContext;
use crate::lint::registry::declare_rule;
use crate::lint::rules::cylinders::{Pairs, is_needed};
use crate::plan::Object;

declare_rule! {
    /// Finds two cylinders that end at the same height, on the same side, where they overlap.
    ///
    /// ## Why
    ///
    /// Of two faces in one plane the one declared first is seen: the order of the lines decides the picture, and in other
    /// programs chance does.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
    /// cylinder 0.5  2 -6  -1 1
    /// cylinder 0.5  2.4 -6  -0.5 1
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
    /// cylinder 0.5  2 -6  -1 1
    /// cylinder 0.5  2.4 -6  -0.5 0.9
    /// write ball.png
    /// ```
    ///
    /// ## Fix safety
    ///
    /// There is no fix: which of the two is to be shorter is not known.
    ///
    /// ## Limits
    ///
    /// Caps that cannot be seen are no such case: an upper one below a lower one, as where cylinders are stacked, and those
    /// that wholly lie on a base or inside of another object. Two cylinders that also share a wall are one of
    /// `overlapping-walls`.
    pub static COINCIDENT_CAPS = {
        id: "L0308", name: "coincident-caps", title: "caps of two cylinders in one place", fix: None,
    }
}

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    let Some(scene) = cx.scene else { return };
    let cylinders = scene.cylinders();
    let caps = &scene.equations().caps[..cylinders.len()];
    let walls = &scene.equations().walls;
    let mut pairs = Pairs::default();
    for side in [0, 1] {
        let ids = caps.iter().map(|caps| caps[side]);
        pairs.add_equal(ids, |a, b| {
            let smaller = if cylinders[a].radius < cylinders[b].radius { a } else { b };
            let is_seen = || !is_covered(&scene, smaller, side);
            walls[a] != walls[b] && overlap(&cylinders[a], &cylinders[b]) && is_seen()
        });
    }
    for [first, second] in pairs.sorted().into_iter().filter(|pair| is_needed(cx, pair)) {
        let which = match [0, 1].map(|side| caps[first][side] == caps[second][side]) {
            [true, true] => "both caps of this `cylinder` lie",
            [true, false] => "the lower cap of this `cylinder` lies",
            _ => "the upper cap of this `cylinder` lies",
        };
        acc.push(
            Diagnostic::new(
                &COINCIDENT_CAPS.code,
                cx.place(Object::Cylinder(second as u32)),
                format!("{which} in the place of another's"),
            )
            .label("not seen where the other is")
            .secondary(cx.place(Object::Cylinder(first as u32)), "declared first, so that it is seen")
            .help("let one of them end a little higher or lower"),
        );
    }
}

/// Tells whether a cap lies wholly on the opposite cap of another cylinder, as a column's on its base, or inside an object:
/// then nobody sees it.
fn is_covered(scene: &SceneView<'_>, cylinder: usize, side: usize) -> bool {
    let cylinders = scene.cylinders();
    let caps = &scene.equations().caps;
    let c = &cylinders[cylinder];
    let y = if side == 0 { c.y_min } else { c.y_max };
    let holds_disc = |x: f64, z: f64, radius: f64| (c.x - x).hypot(c.z - z) + c.radius <= radius;
    let is_in_sphere = |s: &Sphere| {
        let radius = (s.radius * s.radius - (y - s.center.y) * (y - s.center.y)).max(0.0).sqrt();
        holds_disc(s.center.x, s.center.z, radius)
    };
    let is_under = |(i, other): (usize, &Cylinder)| {
        let meets = caps[i][1 - side] == caps[cylinder][side] || (other.y_min < y && y < other.y_max);
        i != cylinder && meets && holds_disc(other.x, other.z, other.radius)
    };
    cylinders.iter().enumerate().any(is_under) || scene.spheres().iter().any(is_in_sphere)
}

/// Tells whether two cylinders overlap as seen from above.
fn overlap(a: &Cylinder, b: &Cylinder) -> bool {
    (a.x - b.x).hypot(a.z - b.z) < a.radius + b.radius
}
