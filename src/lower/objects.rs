//! `sphere` and `cylinder`.

use glam::DVec3;

use crate::diag::words::counted;
use crate::diag::{Diagnostic, Edit, Fix, codes};
use crate::ir::{Command, Cylinder, Handle, Sphere, Surface};
use crate::lower::Lowering;
use crate::source::{Source, Span};
use crate::syntax::ast::{self, Shape};

/// A surface for objects that have none: grey and dull.
const USUAL_SURFACE: &str = "surface 0.1 0.1 0.1  0.7 0.7 0.7  0 0 0  1  0";

/// The surface that the next object gets.
#[derive(Clone, Copy, Debug, Default)]
pub(super) enum CurrentSurface {
    /// None has been set.
    #[default]
    Unset,
    /// One has been set that is not sound; that has been reported.
    Bad,
    /// This one.
    Known(Handle<Surface>),
}

/// What the objects so far leave behind for those that follow.
#[derive(Debug, Default)]
pub(super) struct Objects {
    surface: CurrentSurface,
    /// The place of the first `surface`.
    first_surface: Option<Span>,
    /// The first object before any surface.
    first_bare: Option<Span>,
    n_bare: usize,
}

impl Objects {
    /// Sets the surface of the objects that follow.
    pub(super) fn set_surface(&mut self, surface: CurrentSurface, span: Span) {
        self.surface = surface;
        self.first_surface.get_or_insert(span);
    }

    /// Returns the surface of an object, if there is one to give it. A bad object has been reported and needs none.
    fn surface_for(&mut self, object: &ast::Command<'_>) -> Option<Handle<Surface>> {
        match (self.surface, object.shape) {
            (CurrentSurface::Known(surface), _) => Some(surface),
            (CurrentSurface::Bad, _) | (CurrentSurface::Unset, Shape::Bad(_)) => None,
            (CurrentSurface::Unset, Shape::Whole(_)) => {
                self.first_bare.get_or_insert(object.span);
                self.n_bare += 1;
                None
            }
        }
    }
}

pub(super) fn lower_sphere(lowering: &mut Lowering<'_>, command: &ast::Command<'_>, is_sound: bool) {
    let surface = lowering.objects.surface_for(command);
    let (true, Some(surface), &[x, y, z, radius]) = (is_sound, surface, command.numbers) else { return };
    let order = next_order(lowering);
    lowering.program.spheres.push(Sphere { center: DVec3::new(x, y, z), radius, surface, order });
    lowering.program.origins.spheres.push(command.span);
    let n_spheres = lowering.program.spheres.len();
    match lowering.program.commands.last_mut() {
        Some(Command::Spheres(shown)) => *shown = n_spheres,
        _ => lowering.emit(Command::Spheres(n_spheres), command.span),
    }
}

pub(super) fn lower_cylinder(lowering: &mut Lowering<'_>, command: &ast::Command<'_>, is_sound: bool) {
    let surface = lowering.objects.surface_for(command);
    let (true, Some(surface), &[radius, x, z, y_min, y_max]) = (is_sound, surface, command.numbers) else { return };
    let order = next_order(lowering);
    lowering.program.cylinders.push(Cylinder { radius, x, z, y_min, y_max, surface, order });
    lowering.program.origins.cylinders.push(command.span);
    let n_cylinders = lowering.program.cylinders.len();
    match lowering.program.commands.last_mut() {
        Some(Command::Cylinders(shown)) => *shown = n_cylinders,
        _ => lowering.emit(Command::Cylinders(n_cylinders), command.span),
    }
}

fn next_order(lowering: &Lowering<'_>) -> u32 {
    lowering.program.spheres.len() + lowering.program.cylinders.len()
}

/// Reports the objects before any surface, once: a `surface` before the first of them mends them all.
pub(super) fn check(source: &Source, objects: &Objects, acc: &mut Vec<Diagnostic>) {
    let Some(span) = objects.first_bare else { return };
    let message = match objects.n_bare {
        1 => "an object before any `surface`".to_owned(),
        n => format!("{} before any `surface`", counted(n, "object")),
    };
    let diagnostic = Diagnostic::new(&codes::NO_SURFACE, span, message)
        .label(if objects.n_bare == 1 { "has no surface" } else { "the first without a surface" })
        .note("an object gets the surface that was set last before it");
    acc.push(match objects.first_surface {
        Some(first) => {
            diagnostic.secondary(first, "the first surface comes too late").help("move a `surface` before it")
        }
        None => {
            let edit = Edit::insert_line_before(source, span.start, USUAL_SURFACE);
            diagnostic
                .help(format!("add a `surface` before it, such as `{USUAL_SURFACE}`"))
                .fix(Fix::guess("add a grey surface before it", vec![edit]))
        }
    });
}
