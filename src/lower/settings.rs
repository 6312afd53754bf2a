//! `fov`, `background`, `surface`: each replaces what was set before.

use glam::DVec3;

use crate::ir::{Command, Surface};
use crate::lower::Lowering;
use crate::lower::objects::CurrentSurface;
use crate::syntax::ast;

pub(super) fn lower_fov(lowering: &mut Lowering<'_>, command: &ast::Command<'_>, is_sound: bool) {
    lowering.writes.see_fov();
    if let (true, &[fov_deg]) = (is_sound, command.numbers) {
        lowering.emit(Command::Fov(fov_deg), command.span);
    }
}

pub(super) fn lower_background(lowering: &mut Lowering<'_>, command: &ast::Command<'_>, is_sound: bool) {
    if let (true, &[r, g, b]) = (is_sound, command.numbers) {
        lowering.emit(Command::Background(DVec3::new(r, g, b)), command.span);
    }
}

/// Makes the surface the current one. It leaves no step: the objects that follow point to it.
pub(super) fn lower_surface(lowering: &mut Lowering<'_>, command: &ast::Command<'_>, is_sound: bool) {
    let current = match (is_sound, command.numbers) {
        (true, &[car, cag, cab, cdr, cdg, cdb, csr, csg, csb, shininess, reflectance]) => {
            let surface = Surface {
                ambient: DVec3::new(car, cag, cab),
                diffuse: DVec3::new(cdr, cdg, cdb),
                specular: DVec3::new(csr, csg, csb),
                shininess,
                reflectance,
            };
            lowering.program.origins.surfaces.push(command.span);
            CurrentSurface::Known(lowering.program.surfaces.push(surface))
        }
        _ => CurrentSurface::Bad,
    };
    lowering.objects.set_surface(current, command.span);
}
