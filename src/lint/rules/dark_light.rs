//! Rule `dark-light`.

use crate::diag::words::proposed;
use crate::diag::{Diagnostic, Edit, Fix, Safety};
use crate::lint::context::RuleContext;
use crate::lint::registry::declare_rule;
use crate::syntax::argument_spans;
use crate::syntax::editions::could_be_of_another;
use crate::syntax::spec::CommandKind;

declare_rule! {
    /// Finds a light of colour 0 0 0.
    ///
    /// ## Why
    ///
    /// It adds nothing to any image. Often it was switched off for a trial; a comment does that and says so.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// light 0 0 0  5 5 5
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
    /// Safe: the light is removed, and no image depends on it. Unsafe where its place could be a colour: `light 0 0 0  1 1 1` is
    /// a white light at the origin for whoever writes the place first.
    ///
    /// ## Limits
    ///
    /// A light that is not black and still reaches nothing is not found.
    pub static DARK_LIGHT = {
        id: "L0201", name: "dark-light", title: "a light of colour 0", fix: Some(Safety::Safe),
    }
}

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    let is_dark = |numbers: &[f64]| numbers.iter().take(3).all(|channel| *channel == 0.0);
    for light in cx.all_of(CommandKind::Light).filter(|light| is_dark(light.numbers)) {
        let removed = vec![Edit::remove_command(cx.source, light.span)];
        let diagnostic = Diagnostic::new(&DARK_LIGHT.code, light.span, "a light of colour 0 0 0 adds nothing");
        acc.push(if could_be_of_another(CommandKind::Light, light.numbers) {
            let texts: Vec<_> =
                argument_spans(cx.source, light.span).into_iter().map(|span| cx.source.slice(span)).collect();
            let swapped = format!("light {} {}", texts[3..].join(" "), texts[..3].join(" "));
            diagnostic
                .label("is black: the first three numbers are its colour")
                .help(format!("remove it, or, if its place came first, {}", proposed(&swapped)))
                .fix(Fix::guess("remove the light", removed))
                .fix(Fix::write(Safety::Unsafe, light.span, swapped))
        } else {
            diagnostic
                .label("is black")
                .help("remove it, or give it a colour")
                .fix(Fix::safe("remove the light", removed))
        });
    }
}
