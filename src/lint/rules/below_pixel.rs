//! Rule `below-pixel`.

use crate::diag::Diagnostic;
use crate::lint::context::{RuleContext, name_of};
use crate::lint::registry::declare_rule;
use crate::plan::{Inspected, Sight};

declare_rule! {
    /// Finds an object in view that is smaller than a pixel.
    ///
    /// ## Why
    ///
    /// The image has one sample a pixel unless asked for more: such an object is seen as one dot or, mostly, not at all.
    ///
    /// ## Example
    ///
    /// ```cli
    /// fov 60
    /// light 1 1 1  0 0 5
    /// surface 0.1 0 0  0.8 0.2 0.2  0 0 0  1  0
    /// sphere 0 0 -4  1
    /// sphere 1.5 1.5 -4  0.003
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
    /// sphere 1.5 1.5 -4  0.1
    /// write ball.png
    /// ```
    ///
    /// ## Fix safety
    ///
    /// There is no fix: whether it is too small or too far away is not known.
    ///
    /// ## Limits
    ///
    /// The pixels are those of the size that is judged by, 300×300 unless `clisc.toml` says otherwise. The outline is that of the
    /// whole object, whether or not another hides it.
    pub static BELOW_PIXEL = {
        id: "L0305", name: "below-pixel", title: "an object smaller than a pixel", fix: None,
    }
}

fn check(cx: &RuleContext<'_>, acc: &mut Vec<Diagnostic>) {
    let Some(sights) = cx.sights() else { return };
    let is_small = |seen: &&Inspected| {
        seen.sight == Sight::InView && seen.needless.is_none() && seen.pixels.iter().all(|side| *side < 1.0)
    };
    for seen in sights.objects.iter().filter(is_small) {
        let [width, height] = seen.pixels;
        let name = name_of(seen.object);
        acc.push(
            Diagnostic::new(
                &BELOW_PIXEL.code,
                cx.place(seen.object),
                format!("this `{name}` is smaller than a pixel: {width:.2} by {height:.2}"),
            )
            .label("hardly ever seen")
            .help("make it larger, or move it nearer")
            .note(format!(
                "in an image of {}×{} pixels",
                cx.options.size.width(),
                cx.options.size.height()
            )),
        );
    }
}
