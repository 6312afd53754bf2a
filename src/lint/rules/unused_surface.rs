//! Rule `unused-surface`.

use crate::diag::{Diagnostic, Edit, Fix, Safety};
use crate::lint::context::{RuleContext, kind_of};
use crate::lint::registry::declare_rule;
use crate::lint::rules::settings::last_set;
use crate::syntax::ast::Shape;
use crate::syntax::spec::CommandKind;

declare_rule! {
    /// Finds a `surface` that no object gets, because none follows it.
    ///
    /// ## Why
    ///
    /// It has no effect, and is often left behind where objects were moved or removed.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
    /// surface 0 0 0.1  0.2 0.2 0.8  0 0 0  1  0
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
    /// Safe: the `surface` is removed, and no image depends on it.
    ///
    /// ## Limits
    ///
    /// A `surface` that another replaces before any object gets it is one of `overridden-setting`.
    pub static UNUSED_SURFACE = {
        id: "L0101", name: "unused-surface", title: "a `surface` that no object gets", fix: Some(Safety::Safe),
    }
}

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    let is_object =
        |kind: Option<CommandKind>| matches!(kind, None | Some(CommandKind::Sphere | CommandKind::Cylinder));
    let matters = |kind: Option<CommandKind>| is_object(kind) || kind == Some(CommandKind::Surface);
    let mut mattering = cx.commands.iter().map(kind_of).filter(|kind| matters(*kind));
    // An object before any surface is an error, and this surface comes too late for it; one behind the last `write` is
    // idle, and would have got this surface.
    let comes_too_late = mattering.next().is_some_and(is_object);
    if comes_too_late || cx.behind.iter().map(kind_of).find(|kind| matters(*kind)).is_some_and(is_object) {
        return;
    }
    let Some(i) = cx.commands.iter().rposition(|command| matters(kind_of(command))) else { return };
    let last = cx.commands[i];
    let is_repeated = || last_set(&cx.commands[..i], CommandKind::Surface) == Some(last.numbers);
    if last.shape != Shape::Whole(CommandKind::Surface) || is_repeated() {
        return;
    }
    let removed = vec![Edit::remove_command(cx.source, last.span)];
    acc.push(
        Diagnostic::new(&UNUSED_SURFACE.code, last.span, "no object gets this `surface`")
            .label("no object follows it")
            .help("remove it, or add the objects that were to get it")
            .fix(Fix::safe("remove the surface", removed)),
    );
}
