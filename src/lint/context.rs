//! What the rules know of a scene.

use std::cell::OnceCell;

use crate::ir::{Command as Step, Registers, SceneView, Surface, Valid};
use crate::lint::options::Options;
use crate::lint::sight::{Sights, find_filling};
use crate::plan::{Object, Part, Settings};
use crate::source::{Source, Span};
use crate::syntax::ast::{self, Command, Shape};
use crate::syntax::spec::CommandKind;

/// A scene as the rules see it. What stands behind the last `write` is no part of it: one finding says that it is idle.
pub(super) struct RuleContext<'a> {
    pub source: &'a Source,
    pub options: &'a Options,
    /// The commands up to the last `write`; all if there is none.
    pub commands: Vec<Command<'a>>,
    /// What follows the last `write`.
    pub behind: Vec<Command<'a>>,
    /// The program, without the commands that are wrong; `None` when more images may have been meant than it makes.
    pub program: Option<&'a Valid>,
    /// The scene as the last `write` sees it, or as it stands at the end if there is none.
    pub scene: Option<SceneView<'a>>,
    /// The scenes of all images that differ in more than their background; at least that of the end.
    images: Vec<SceneView<'a>>,
    sights: OnceCell<Option<Sights>>,
    filling: OnceCell<Option<Object>>,
}

impl<'a> RuleContext<'a> {
    pub fn new(source: &'a Source, options: &'a Options, file: &'a ast::File, program: Option<&'a Valid>) -> Self {
        let mut commands: Vec<_> = file.commands().collect();
        let is_write = |command: &Command<'_>| kind_of(command) == Some(CommandKind::Write);
        let n_judged = commands.iter().rposition(is_write).map_or(commands.len(), |last| last + 1);
        let behind = commands.split_off(n_judged);
        // What a `write` that cannot be read would show is not known, nor what stands on a line of which nothing is known.
        let may_show_more =
            |command: &Command<'_>| matches!(command.shape, Shape::Bad(None | Some(CommandKind::Write)));
        let program = program.filter(|_| !commands.iter().any(may_show_more));
        let images = program.map_or_else(Vec::new, views);
        Self {
            source,
            options,
            commands,
            behind,
            program,
            scene: images.last().copied(),
            images,
            sights: OnceCell::new(),
            filling: OnceCell::new(),
        }
    }

    /// Returns what the rules know of one image: that of a `write`, counted from 0, which shows `view`.
    pub fn of_image(mut self, write_idx: usize, view: SceneView<'a>) -> Self {
        let is_write = |(_, command): &(usize, &Command<'_>)| command.shape == Shape::Whole(CommandKind::Write);
        let place = self.commands.iter().enumerate().filter(is_write).nth(write_idx).map(|(place, _)| place);
        self.commands.truncate(place.map_or(self.commands.len(), |place| place + 1));
        self.scene = Some(view);
        self.images = vec![view];
        self
    }

    /// Tells whether a line that was meant to be such a command could not be read.
    pub fn has_bad(&self, kind: CommandKind) -> bool {
        self.commands.iter().any(|command| command.shape == Shape::Bad(Some(kind)))
    }

    /// Returns the whole commands of a kind, in order.
    pub fn all_of(&self, kind: CommandKind) -> impl Iterator<Item = &Command<'a>> {
        self.commands.iter().filter(move |command| command.shape == Shape::Whole(kind))
    }

    /// Returns the settings of the image by which the rules judge.
    pub fn settings(&self) -> Settings {
        Settings { size: self.options.size, part: Part::B, ..Settings::default() }
    }

    /// Returns what is known of the objects over all images; `None` when there is no program, too many images, or a field
    /// of view that could not be read.
    pub fn sights(&self) -> Option<&Sights> {
        /// Each image is inspected by itself.
        const MAX_IMAGES: usize = 16;
        let find = || {
            let is_known = self.images.len() <= MAX_IMAGES && !self.has_bad(CommandKind::Fov);
            is_known.then(|| Sights::of_images(&self.images, &self.settings())).flatten()
        };
        self.sights.get_or_init(find).as_ref()
    }

    /// Returns the object that fills the whole view, if there is one: whatever is wrong with others is its fault.
    pub fn filling(&self) -> Option<Object> {
        let find = || find_filling(self.sights()?, self.scene.as_ref()?, &self.settings());
        *self.filling.get_or_init(find)
    }

    /// Returns the place of an object.
    pub fn place(&self, object: Object) -> Span {
        let origins = self.program.map(|program| &program.origins);
        let found = origins.and_then(|origins| match object {
            Object::Sphere(i) => origins.spheres.get(i as usize),
            Object::Cylinder(i) => origins.cylinders.get(i as usize),
        });
        found.copied().unwrap_or(Span::at(0))
    }

    /// Returns the place of a light.
    pub fn place_of_light(&self, light: u32) -> Span {
        let origin = self.program.and_then(|program| program.origins.lights.get(light as usize));
        origin.copied().unwrap_or(Span::at(0))
    }

    /// Returns the surfaces that objects have, each with the place of its command, in order.
    pub fn used_surfaces(&self) -> Vec<(Span, &'a Surface)> {
        let (Some(program), Some(scene)) = (self.program, self.scene) else { return Vec::new() };
        let spheres = scene.spheres().iter().map(|sphere| sphere.surface);
        let mut used: Vec<_> = spheres.chain(scene.cylinders().iter().map(|cylinder| cylinder.surface)).collect();
        used.sort_by_key(|surface| surface.index());
        used.dedup();
        let place = |i: usize| program.origins.surfaces.get(i).copied().unwrap_or(Span::at(0));
        used.into_iter().map(|surface| (place(surface.index()), &scene.surfaces()[surface.index()])).collect()
    }
}

/// Returns what a command is or was meant to be.
pub(super) fn kind_of(command: &Command<'_>) -> Option<CommandKind> {
    match command.shape {
        Shape::Whole(kind) => Some(kind),
        Shape::Bad(kind) => kind,
    }
}

/// Returns the name of an object's command.
pub(super) fn name_of(object: Object) -> &'static str {
    match object {
        Object::Sphere(_) => CommandKind::Sphere.name(),
        Object::Cylinder(_) => CommandKind::Cylinder.name(),
    }
}

/// Returns the scenes that the images of a program show, of like ones the last; that of the end if there is no image.
pub(super) fn views(program: &Valid) -> Vec<SceneView<'_>> {
    let mut registers = Registers::default();
    let mut shown: Vec<Registers> = Vec::new();
    for command in &program.commands {
        registers.step(command);
        if matches!(command, Step::Write(_)) {
            shown.retain(|earlier| Registers { background: registers.background, ..*earlier } != registers);
            shown.push(registers);
        }
    }
    if shown.is_empty() {
        shown.push(registers);
    }
    shown.into_iter().map(|registers| SceneView::new(program, registers)).collect()
}
