//! What the passes of one plan have found, for the dump and for statistics.

use std::borrow::Cow;

use crate::ir::{SceneView, Surface};
use crate::plan::analysis::Analysis;
use crate::plan::scene::shines;
use crate::plan::terms::{AllLights, drawn, n_terms};
use crate::plan::{Object, Scene, Settings, Terms};

/// Of programs with more surfaces it is not reported what each needs.
const MAX_REPORTED: usize = 4096;

/// Why no ray of an image needs an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// It equals one declared before.
    Copy,
    /// It lies inside this one, into which no ray comes.
    Inside(Object),
    /// No eye ray, reflected ray or shadow ray comes near.
    OutOfReach,
}

/// An object that is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// By its index in the scene as the `write` shows it.
    pub object: Object,
    /// Why.
    pub reason: Reason,
}

/// What is known of an object that is kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kept {
    /// By its index in the scene as the `write` shows it.
    pub object: Object,
    /// Whether eye rays may meet it.
    pub is_seen: bool,
    /// Whether eye and reflected rays are proved to come from outside alone.
    pub is_sealed: bool,
    /// What rays that it reflects may meet; `None` when it reflects none.
    pub reflects: Option<Vec<Object>>,
    /// For each light that may add to it, by its index in [`Scene::lights`](crate::plan::Scene), what may lie between.
    pub lights: Vec<(u32, Vec<Object>)>,
}

/// What the passes have found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Spheres that the `write` shows and part of which the image is.
    pub n_spheres: usize,
    /// Cylinders likewise.
    pub n_cylinders: usize,
    /// Lights that the `write` shows.
    pub n_lights: usize,
    /// For each light that shines its index among those.
    pub lights: Vec<u32>,
    /// What is left out.
    pub left_out: Vec<LeftOut>,
    /// What is known of the rest; `None` when there are too many pairs of objects for the size of the image.
    pub kept: Option<Vec<Kept>>,
    /// For each surface that is used by what is kept, by its index in the program, what it needs; none when the program
    /// has very many.
    pub surfaces: Vec<(u32, Terms)>,
    /// How many terms were taken out of the surfaces that are used by what is kept.
    pub n_terms_left_out: u64,
    /// The most reflections an eye ray can have, as far as mirrors tell; `None` is unbounded.
    pub max_bounces: Option<u32>,
}

impl Report {
    /// Knows what stands there before any pass.
    pub(super) fn new(view: &SceneView<'_>, scene: &Scene<'_>) -> Self {
        Self {
            n_spheres: scene.sphere_primitives.len(),
            n_cylinders: scene.cylinder_primitives.len(),
            n_lights: view.lights().len(),
            lights: (0..).zip(view.lights()).filter(|(_, light)| shines(light)).map(|(i, _)| i).collect(),
            ..Self::default()
        }
    }

    /// Adds what is known at the end.
    pub(super) fn add(
        &mut self,
        view: &SceneView<'_>,
        scene: &Scene<'_>,
        known: Option<&Analysis>,
        settings: &Settings,
    ) {
        self.kept = known.map(|known| known.describe(scene.lights.len()));
        self.max_bounces = known.and_then(Analysis::max_bounces);
        let mut is_used = vec![false; scene.surfaces.len()];
        scene.primitives().for_each(|primitive| is_used[primitive.surface.index()] = true);
        let used = || (0..).zip(view.surfaces()).filter(|(i, _)| is_used[*i as usize]);
        let declared = |surface: &Surface| drawn(surface, settings.part);
        if scene.surfaces.len() <= MAX_REPORTED {
            let lights = AllLights::new(&scene.lights);
            let terms = |surface: &Surface| Terms::new(&declared(surface), &lights, settings);
            self.surfaces = used().map(|(i, surface)| (i, terms(surface))).collect();
        }
        if matches!(scene.surfaces, Cow::Owned(_)) {
            let left_out =
                |i: u32, surface: &Surface| n_terms(&declared(surface)) - n_terms(&scene.surfaces[i as usize]);
            self.n_terms_left_out = used().map(|(i, surface)| left_out(i, surface)).sum();
        }
    }
}
