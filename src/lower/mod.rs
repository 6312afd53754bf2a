//! Lowering: `ast::File` in, `ir::Program` out.
//!
//! Scene commands are a small state machine (current surface, field of view, background). This module runs that machine
//! once, so nothing later needs to know it existed. A bad command has been reported by the parser: here it counts as the
//! command that it was meant to be, so that one mistake is not reported twice.
//!
//! Never here: reading files, tracing rays, judging style.

mod lights;
mod objects;
mod settings;
mod values;
mod writes;

use crate::diag::Diagnostic;
use crate::ir::{Command, Program};
use crate::lower::lights::Lights;
use crate::lower::objects::Objects;
use crate::lower::writes::Writes;
use crate::source::{Source, Span};
use crate::syntax::ast::{self, Shape};
use crate::syntax::spec::CommandKind;

/// A program and what was found wrong on the way to it.
#[derive(Debug, Default)]
pub struct Lowered {
    /// The program; not to be rendered when a diagnostic is an error.
    pub program: Program,
    /// In the order of the text.
    pub diagnostics: Vec<Diagnostic>,
}

/// Lowers the tree of `source`.
#[must_use]
pub fn lower(source: &Source, file: &ast::File) -> Lowered {
    let mut lowering = Lowering::new(source);
    lowering.add(file);
    lowering.finish()
}

/// Lowers a scene a run of commands at a time; the state of the machine between two commands.
#[derive(Debug)]
pub struct Lowering<'s> {
    source: &'s Source,
    program: Program,
    diagnostics: Vec<Diagnostic>,
    lights: Lights,
    objects: Objects,
    writes: Writes<'s>,
}

impl<'s> Lowering<'s> {
    /// Begins before the first command.
    #[must_use]
    pub fn new(source: &'s Source) -> Self {
        Self {
            source,
            program: Program::default(),
            diagnostics: Vec::new(),
            lights: Lights::default(),
            objects: Objects::default(),
            writes: Writes::default(),
        }
    }

    /// Lowers the commands that follow, the next run of the source or all of it.
    pub fn add(&mut self, run: &ast::File) {
        for command in run.commands() {
            self.step(&command);
        }
    }

    /// Returns what has been found wrong since the last call, in the order of the text.
    pub fn take_diagnostics(&mut self) -> Vec<Diagnostic> {
        std::mem::take(&mut self.diagnostics)
    }

    /// Ends behind the last command and reports what only the whole scene shows.
    #[must_use]
    pub fn finish(mut self) -> Lowered {
        lights::check(&self.lights, &mut self.diagnostics);
        objects::check(self.source, &self.objects, &mut self.diagnostics);
        writes::check(self.source, &self.writes, &mut self.diagnostics);
        self.diagnostics.sort_by_key(|diagnostic| diagnostic.primary.span.start);
        Lowered { program: self.program, diagnostics: self.diagnostics }
    }

    /// Carries out one command.
    fn step(&mut self, command: &ast::Command<'_>) {
        let (kind, is_whole) = match command.shape {
            Shape::Whole(kind) => (Some(kind), true),
            Shape::Bad(kind) => (kind, false),
        };
        self.writes.see(kind, command.span);
        let is_sound =
            is_whole && kind.is_some_and(|kind| values::check(self.source, kind, command, &mut self.diagnostics));
        match kind {
            Some(CommandKind::Fov) => settings::lower_fov(self, command, is_sound),
            Some(CommandKind::Background) => settings::lower_background(self, command, is_sound),
            Some(CommandKind::Light) => lights::lower_light(self, command, is_sound),
            Some(CommandKind::Surface) => settings::lower_surface(self, command, is_sound),
            Some(CommandKind::Sphere) => objects::lower_sphere(self, command, is_sound),
            Some(CommandKind::Cylinder) => objects::lower_cylinder(self, command, is_sound),
            Some(CommandKind::Write) => writes::lower_write(self, command, is_sound),
            None => {}
        }
    }

    /// Adds a step of the executor.
    fn emit(&mut self, command: Command, origin: Span) {
        self.program.commands.push(command);
        self.program.origins.commands.push(origin);
    }
}
