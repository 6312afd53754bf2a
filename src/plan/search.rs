//! How rays find what they may meet.

use crate::plan::apex::Cube;
use crate::plan::tree::{Forest, MeetBoxes, SearchRay};
use crate::plan::{Object, Part, Pass, Scene, Settings};

/// How rays other than those from the eye find what they may meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// There are few objects, or few candidates for each: a packet of rays goes through a list of candidates.
    Lists,
    /// There are many: a shadow ray looks into the grids around its light, a reflected ray walks a tree.
    Structures,
}

/// From so many objects on, looking up pays if nothing is known of pairs of them.
const MANY: usize = 128;

impl Search {
    /// Chooses for a scene.
    ///
    /// `lists_are_short`: whether pairs were looked at, and little was left that may lie between objects and lights.
    pub(super) fn new(scene: &Scene<'_>, lists_are_short: bool) -> Self {
        if lists_are_short || scene.n_objects() < MANY { Self::Lists } else { Self::Structures }
    }
}

/// What can lie between each light and anything else; nothing is known when it is empty.
#[derive(Debug, Default)]
pub(super) struct AroundLights(Vec<Cube>);

impl AroundLights {
    /// Makes the grids around each light, if shadow rays look there.
    pub fn new(scene: &Scene<'_>, search: Search, settings: &Settings) -> Self {
        let is_used =
            search == Search::Structures && settings.part == Part::B && settings.passes.contains(Pass::Shadows);
        let cubes = scene.lights.iter().filter(|_| is_used).map(|light| Cube::new(scene, light.position.to_array()));
        Self(cubes.collect())
    }

    /// See [`Plan::visit_between`](crate::plan::Plan::visit_between).
    pub fn visit_between(
        &self,
        light_idx: usize,
        from_light: [f64; 3],
        error: f64,
        visit: impl FnMut(Object) -> bool,
    ) -> Option<bool> {
        self.0.get(light_idx)?.visit(from_light, error, visit)
    }

    /// Returns what surrounds a light, if it is known.
    pub fn get(&self, light_idx: usize) -> Option<&Cube> {
        self.0.get(light_idx)
    }

    /// Tells whether shadow rays look there.
    pub fn are_known(&self) -> bool {
        !self.0.is_empty()
    }
}

/// What reflected rays can meet.
#[derive(Debug)]
pub(super) struct AlongRays(Option<Forest>);

impl AlongRays {
    /// Makes the trees, if there are reflected rays and they look there.
    pub fn new(scene: &Scene<'_>, search: Search, settings: &Settings) -> Self {
        let has_mirrors = || {
            let mut primitives = scene.sphere_primitives.iter().chain(&scene.cylinder_primitives);
            primitives.any(|primitive| scene.surface(*primitive).reflectance > 0.0)
        };
        let is_used = search == Search::Structures
            && settings.part == Part::B
            && settings.passes.contains(Pass::Objects)
            && has_mirrors();
        Self(is_used.then(|| Forest::new(scene)))
    }

    /// Tells whether reflected rays look there.
    pub fn are_known(&self) -> bool {
        self.0.is_some()
    }

    /// See [`Plan::visit_along`](crate::plan::Plan::visit_along).
    #[inline(always)]
    pub fn visit_along<M: MeetBoxes>(&self, ray: &SearchRay, visit: impl FnMut(Object) -> f64) -> Option<()> {
        self.0.as_ref()?.visit::<M>(ray, visit)
    }
}
