//! `light`.

use glam::DVec3;

use crate::diag::{Diagnostic, codes};
use crate::ir::{Command, Light};
use crate::lower::Lowering;
use crate::source::Span;
use crate::syntax::ast;

/// As many lights as every reader of the language takes.
const MANY_LIGHTS: usize = 10;

/// The lights so far.
#[derive(Debug, Default)]
pub(super) struct Lights {
    n: usize,
    /// The first one that is more than [`MANY_LIGHTS`].
    first_surplus: Option<Span>,
}

pub(super) fn lower_light(lowering: &mut Lowering<'_>, command: &ast::Command<'_>, is_sound: bool) {
    lowering.lights.n += 1;
    if lowering.lights.n == MANY_LIGHTS + 1 {
        lowering.lights.first_surplus = Some(command.span);
    }
    let (true, &[r, g, b, x, y, z]) = (is_sound, command.numbers) else { return };
    lowering.program.lights.push(Light { color: DVec3::new(r, g, b), position: DVec3::new(x, y, z) });
    lowering.program.origins.lights.push(command.span);
    let n_lights = lowering.program.lights.len();
    match lowering.program.commands.last_mut() {
        Some(Command::Lights(shown)) => *shown = n_lights,
        _ => lowering.emit(Command::Lights(n_lights), command.span),
    }
}

/// Reports a scene with many lights, once.
pub(super) fn check(lights: &Lights, acc: &mut Vec<Diagnostic>) {
    let Some(span) = lights.first_surplus else { return };
    let message = format!("{} lights, more than ten", lights.n);
    acc.push(
        Diagnostic::new(&codes::MANY_LIGHTS, span, message)
            .label("the eleventh light")
            .help("remove the lights that add little")
            .note("every hit sends a ray to every light; other programs may stop at ten"),
    );
}
