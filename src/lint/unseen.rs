//! Why an image shows less than its scene declares: the findings of the rules about what is seen, of one image.

use crate::diag::Diagnostic;
use crate::ir::{Command, Registers, SceneView, Valid};
use crate::lint::allow::Sieve;
use crate::lint::context::RuleContext;
use crate::lint::options::{Level, Options};
use crate::lint::registry::Rule;
use crate::lint::rules;
use crate::plan::{Inspected, Settings, Sight};
use crate::source::Source;
use crate::syntax::parse;

/// The most objects of a scene that are looked at.
const MAX_OBJECTS: usize = 256;

/// The rules by which an object is not seen.
static OF_OBJECTS: &[&Rule] = &[
    &rules::behind_eye::BEHIND_EYE,
    &rules::outside_view::OUTSIDE_VIEW,
    &rules::hidden_inside::HIDDEN_INSIDE,
    &rules::hidden_copy::HIDDEN_COPY,
];

/// The rules by which an object is perhaps all that is seen, or nothing of it.
static OF_VIEW: &[&Rule] =
    &[&rules::eye_inside::EYE_INSIDE, &rules::fills_view::FILLS_VIEW, &rules::below_pixel::BELOW_PIXEL];

/// The rules by which nothing is lit.
static OF_LIGHTS: &[&Rule] =
    &[&rules::no_light::NO_LIGHT, &rules::dark_light::DARK_LIGHT, &rules::light_inside::LIGHT_INSIDE];

/// Why an image shows less than its scene declares, as far as it is known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unseen {
    /// Why the image has one colour, where that is proved.
    pub one_color: Option<OneColor>,
    /// What is found of objects that are not seen.
    pub objects: Vec<Diagnostic>,
    /// What is found of objects that hide all others, or are too small to be seen.
    pub view: Vec<Diagnostic>,
    /// What is found of lights that light nothing.
    pub lights: Vec<Diagnostic>,
}

/// Why an image has one colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OneColor {
    /// There is no object before its `write`.
    NoObject {
        /// Whether there is one behind.
        is_early: bool,
    },
    /// No object is in its view.
    NothingInView,
    /// The background is black, and nothing makes a surface brighter.
    Black,
}

/// Finds out why an image shows less than its scene declares. Of a scene with a great many objects little is found.
///
/// `write_idx`: which `write` of the program, from 0; `settings`: those that it is made with.
#[must_use]
pub fn find_unseen(
    source: &Source,
    options: &Options,
    program: &Valid,
    write_idx: usize,
    settings: &Settings,
) -> Unseen {
    let Some(view) = view_of(program, write_idx) else { return Unseen::default() };
    let n_objects = view.spheres().len() + view.cylinders().len();
    if n_objects == 0 {
        let is_early = !program.spheres.is_empty() || !program.cylinders.is_empty();
        return Unseen { one_color: Some(OneColor::NoObject { is_early }), ..Unseen::default() };
    }
    if n_objects > MAX_OBJECTS {
        return Unseen::default();
    }
    let mut options = options.clone();
    options.size = settings.size;
    let parse = parse(source);
    let cx = RuleContext::new(source, &options, &parse.file, Some(program)).of_image(write_idx, view);
    let mut sieve = Sieve::new(source, &options);
    let mut found = |rules: &[&Rule]| {
        let mut found = Vec::new();
        let checked = rules.iter().filter(|rule| options.level(&rule.code) != Level::Off);
        checked.for_each(|rule| (rule.check)(&cx, &mut found));
        sieve.keep_all(found)
    };
    let [objects, view_rules, lights] = [OF_OBJECTS, OF_VIEW, OF_LIGHTS].map(&mut found);
    let is_hidden = |seen: &Inspected| seen.sight != Sight::InView;
    let one_color = match cx.sights() {
        Some(sights) if sights.objects.iter().all(is_hidden) => Some(OneColor::NothingInView),
        _ if is_black(&view) => Some(OneColor::Black),
        _ => None,
    };
    Unseen { one_color, objects, view: view_rules, lights }
}

/// Tells whether nothing in a scene is brighter than black: no background, no ambient colour, no light that anything answers.
fn is_black(view: &SceneView<'_>) -> bool {
    let is_zero = |color: &glam::DVec3| *color == glam::DVec3::ZERO;
    let is_dark = view.lights().iter().all(|light| is_zero(&light.color));
    let surfaces = view.spheres().iter().map(|sphere| sphere.surface);
    let mut surfaces = surfaces.chain(view.cylinders().iter().map(|cylinder| cylinder.surface));
    is_zero(&view.background())
        && surfaces.all(|surface| {
            let surface = &view.surfaces()[surface.index()];
            is_zero(&surface.ambient) && (is_dark || (is_zero(&surface.diffuse) && is_zero(&surface.specular)))
        })
}

/// Returns the scene that a `write` sees.
fn view_of(program: &Valid, write_idx: usize) -> Option<SceneView<'_>> {
    let mut registers = Registers::default();
    let mut n_writes = 0;
    for command in &program.commands {
        registers.step(command);
        if matches!(command, Command::Write(_)) {
            if n_writes == write_idx {
                return Some(SceneView::new(program, registers));
            }
            n_writes += 1;
        }
    }
    None
}
