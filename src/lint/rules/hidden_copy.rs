//! Rule `hidden-copy`.

use crate::diag::{Diagnostic, Edit, Fix, Safety};
use crate::lint::context::{RuleContext, name_of};
use crate::lint::registry::declare_rule;
use crate::plan::Object;

declare_rule! {
    /// Finds an object that is in the same place as one before it.
    ///
    /// ## Why
    ///
    /// Of two objects in one place the first is seen, whatever the surface of the second.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
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
    /// sphere 1 0 -4  1
    /// write ball.png
    /// ```
    ///
    /// ## Fix safety
    ///
    /// Safe: the copy is removed, and no image depends on it.
    ///
    /// ## Limits
    ///
    /// Cylinders are copies when axis, radius and both heights are the same; one that shares only a part of the wall is one of
    /// `overlapping-walls`.
    pub static HIDDEN_COPY = {
        id: "L0304", name: "hidden-copy", title: "an object in the place of another", fix: Some(Safety::Safe),
    }
}

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    let Some(scene) = cx.scene else { return };
    let equations = scene.equations();
    let spheres = first_of_each(equations.spheres[..scene.spheres().len()].iter());
    let cylinders = equations.walls.iter().zip(&equations.caps).take(scene.cylinders().len());
    let copies = spheres.into_iter().map(|pair| pair.map(Object::Sphere));
    for [first, copy] in copies.chain(first_of_each(cylinders).into_iter().map(|pair| pair.map(Object::Cylinder))) {
        let (place, name) = (cx.place(copy), name_of(copy));
        let removed = vec![Edit::remove_command(cx.source, place)];
        acc.push(
            Diagnostic::new(&HIDDEN_COPY.code, place, format!("this `{name}` is in the place of another"))
                .label("never seen")
                .secondary(cx.place(first), "seen in its place")
                .help("remove it, or move it")
                .fix(Fix::safe("remove the copy", removed)),
        );
    }
}

/// Returns for each item that equals an earlier one the index of the first such and its own.
fn first_of_each<T: std::hash::Hash + Eq>(items: impl Iterator<Item = T>) -> Vec<[u32; 2]> {
    let mut known = rustc_hash::FxHashMap::default();
    let pairs = (0..).zip(items).map(|(i, item)| [*known.entry(item).or_insert(i), i]);
    pairs.filter(|[first, i]| first != i).collect()
}
