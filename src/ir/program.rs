//! A lowered scene: arenas, command list, origins.

use std::sync::Arc;

use glam::DVec3;

use crate::ir::{Arena, Cylinder, Light, Sphere, Surface};
use crate::source::Span;

/// One step of the executor, which holds the [`Registers`](crate::ir::Registers) that the steps set.
///
/// The arenas are filled when the program is made; a step that adds only moves the length up to which a `write` sees
/// its arena. `surface` leaves no step: it is folded into the primitives that follow it.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Sets the vertical field of view, in degrees.
    Fov(f64),
    /// Sets the colour of a ray that meets nothing.
    Background(DVec3),
    /// Shows the lights below this index.
    Lights(u32),
    /// Shows the spheres below this index.
    Spheres(u32),
    /// Shows the cylinders below this index.
    Cylinders(u32),
    /// Renders the scene as it now stands and saves it under this name, as written in the source.
    Write(Arc<str>),
}

/// Where the parts of a program came from, index for index. Lies beside the scene so that equal scenes compare equal.
#[derive(Clone, Debug, Default)]
pub struct Origins {
    /// For each command its source command; for one that adds a run, the first of the run. Of a `write`, the file name.
    pub commands: Vec<Span>,
    /// For each light its command.
    pub lights: Vec<Span>,
    /// For each surface its command.
    pub surfaces: Vec<Span>,
    /// For each sphere its command.
    pub spheres: Vec<Span>,
    /// For each cylinder its command.
    pub cylinders: Vec<Span>,
}

impl Origins {
    /// Returns the place of a command; the start of the source for a program that was not made from text.
    #[must_use]
    pub fn command(&self, command_idx: usize) -> Span {
        self.commands.get(command_idx).copied().unwrap_or(Span::at(0))
    }
}

/// A lowered scene. Nothing edits it once it is made.
#[derive(Clone, Debug, Default)]
pub struct Program {
    /// Every light, in order.
    pub lights: Arena<Light>,
    /// Every surface, in order.
    pub surfaces: Arena<Surface>,
    /// Every sphere, in order.
    pub spheres: Arena<Sphere>,
    /// Every cylinder, in order.
    pub cylinders: Arena<Cylinder>,
    /// What to do, in order.
    pub commands: Vec<Command>,
    /// Where it all came from; empty for a program that was not lowered from text.
    pub origins: Origins,
}

impl PartialEq for Program {
    /// Compares the scenes and what is done with them, not where they came from.
    fn eq(&self, other: &Self) -> bool {
        self.lights == other.lights
            && self.surfaces == other.surfaces
            && self.spheres == other.spheres
            && self.cylinders == other.cylinders
            && self.commands == other.commands
    }
}
