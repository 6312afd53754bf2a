//! Rule `no-light`.

use glam::DVec3;

use crate::diag::{Diagnostic, Edit, Fix, Safety};
use crate::ir::Surface;
use crate::lint::context::{RuleContext, kind_of};
use crate::lint::registry::declare_rule;
use crate::syntax::spec::CommandKind;

declare_rule! {
    /// Finds a scene without any `light` in which a surface has a diffuse or specular colour.
    ///
    /// ## Why
    ///
    /// Without a light only the ambient colours are seen: objects come out flat, or black.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
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
    /// Unsafe: a white light is added above and behind the eye, which is seen in every image.
    ///
    /// ## Limits
    ///
    /// A scene whose lights are all black is one of `dark-light`.
    pub static NO_LIGHT = {
        id: "L0202", name: "no-light", title: "no light, though a surface would answer one", fix: Some(Safety::Unsafe),
    }
}

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    let may_shine = |kind: Option<CommandKind>| matches!(kind, None | Some(CommandKind::Light));
    if cx.commands.iter().any(|command| may_shine(kind_of(command))) {
        return;
    }
    let answers = |surface: &Surface| surface.diffuse != DVec3::ZERO || surface.specular != DVec3::ZERO;
    let Some((place, _)) = cx.used_surfaces().into_iter().find(|(_, surface)| answers(surface)) else { return };
    let light = vec![Edit::insert_line_before(cx.source, place.start, "light 1 1 1   5 5 5")];
    acc.push(
        Diagnostic::new(&NO_LIGHT.code, place, "no `light`, though this `surface` has a diffuse or specular colour")
            .label("only its ambient colour is seen")
            .help("add a light, such as `light 1 1 1   5 5 5`")
            .fix(Fix::guess("add a white light", light)),
    );
}
