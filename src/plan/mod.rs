//! The plan of one image: a scene as one `write` sees it in, what its image needs out.
//!
//! [`plan`] runs its passes one after the other. Each may leave out whatever it can *prove* the image does not need: an
//! image made by the plan is the image made without it, in every pixel. What a pass cannot prove it leaves alone, so a
//! pass that is switched off ([`Passes`]) costs time and changes nothing.
//!
//! Never here: rays, pixels, threads of its own; guesses.

mod analysis;
mod apex;
mod bodies;
mod bounces;
mod candidates;
mod cone;
mod curve;
mod dump;
mod frustum;
mod inspect;
mod objects;
mod passes;
mod report;
mod savings;
mod scene;
mod search;
mod settings;
mod shadows;
mod solid;
mod terms;
mod tiles;
mod tree;
mod writes;

pub use apex::{CubeFace, Expect, Look, Slopes};
pub use candidates::{Candidates, Object, ObjectLists};
pub use dump::{dump_plans, dump_plans_json};
pub use inspect::{Inspected, Sight, inspect};
pub use passes::{Pass, Passes};
pub use report::{Kept, LeftOut, Reason, Report};
pub use savings::Savings;
pub use scene::{CylinderLanes, Light, Primitive, Scene, SphereLanes, is_within_range};
pub use search::Search;
pub use settings::{BackendChoice, ExactWork, Part, Precision, SampleAt, Settings, Size};
pub use solid::Faces;
pub use terms::Terms;
pub use tiles::Tiles;
pub use tree::{Beam, Boxes, MeetBoxes, OneByOne, SearchRay};
pub use writes::{Changes, TileMask};

use crate::ir::{SceneView, Surface};
use crate::plan::analysis::{Analysis, analyse};
use crate::plan::search::{AlongRays, AroundLights};

/// What one image needs.
#[derive(Debug)]
pub struct Plan<'p> {
    /// What the image is asked for.
    pub settings: Settings,
    /// Vertical field of view, in degrees.
    pub fov_deg: f64,
    /// The scene, without what no ray of the image can meet.
    pub scene: Scene<'p>,
    /// For each tile of the image what its eye rays can meet.
    pub tiles: Tiles,
    /// What the passes have found.
    pub report: Report,
    /// The scene as it was declared.
    pub view: SceneView<'p>,
    /// What is known of the objects, unless they are too many.
    known: Option<Analysis>,
    /// How rays other than those from the eye find what they may meet.
    pub search: Search,
    around_lights: AroundLights,
    along_rays: AlongRays,
    /// Everything in the scene.
    everything: ObjectLists,
    /// What reflected rays can meet, unless it is everything.
    mirrored: Option<ObjectLists>,
    /// The indices of all lights.
    all_lights: Vec<u32>,
}

/// Finds out what the image of a scene needs.
#[must_use]
pub fn plan<'p>(view: SceneView<'p>, settings: &Settings) -> Plan<'p> {
    let mut scene = Scene::new(view, settings.part);
    scene.surfaces = terms::reduce(view.surfaces(), &scene.lights, settings);
    let mut report = Report::new(&view, &scene);
    let known = analyse(&mut scene, view.fov_deg(), settings, &mut report);
    let lists_are_short = known.as_ref().is_some_and(Analysis::lists_are_short);
    let search = Search::new(&scene, lists_are_short);
    if search == Search::Structures && known.is_none() {
        scene.sort_by_place();
    }
    report.add(&view, &scene, known.as_ref(), settings);

    let everything = ObjectLists::everything(&scene);
    let mirrored = known.as_ref().map(|known| ObjectLists::of_all(&scene, |i| known.roles.mirrored[i]));
    Plan {
        search,
        around_lights: AroundLights::new(&scene, search, settings),
        along_rays: AlongRays::new(&scene, search, settings),
        settings: settings.clone(),
        fov_deg: view.fov_deg(),
        tiles: Tiles::new(&scene, view.fov_deg(), settings),
        report,
        view,
        known,
        mirrored,
        all_lights: (0..scene.lights.len() as u32).collect(),
        everything,
        scene,
    }
}

/// Takes a scene as it is declared, in its own units, and finds out nothing: every ray is to be tested against everything.
#[must_use]
pub fn bare_plan<'p>(view: SceneView<'p>, settings: &Settings) -> Plan<'p> {
    let settings = Settings { passes: Passes::none(), ..settings.clone() };
    let scene = Scene::unscaled(view, settings.part);
    let search = Search::Lists;
    Plan {
        search,
        around_lights: AroundLights::new(&scene, search, &settings),
        along_rays: AlongRays::new(&scene, search, &settings),
        fov_deg: view.fov_deg(),
        tiles: Tiles::new(&scene, view.fov_deg(), &settings),
        report: Report::new(&view, &scene),
        settings,
        view,
        known: None,
        mirrored: None,
        all_lights: (0..scene.lights.len() as u32).collect(),
        everything: ObjectLists::everything(&scene),
        scene,
    }
}

impl Plan<'_> {
    /// Tells whether a light, by its index in [`Scene::lights`], may add to hits on a surface.
    #[must_use]
    pub fn adds(&self, surface: &Surface, light_idx: usize) -> bool {
        terms::answers(surface, &self.scene.lights[light_idx], &self.settings)
    }

    /// Returns the lights that may add to a hit on an object, by their indices in [`Scene::lights`], in order.
    #[must_use]
    pub fn lights(&self, object: Object) -> &[u32] {
        let lights = self.known.as_ref().and_then(|known| known.lights.as_ref());
        lights.map_or(&self.all_lights, |lights| &lights[self.place(object)])
    }

    /// Returns what can lie between a surface of `receiver` and a light; what is likely to lie there comes first.
    ///
    /// `light_idx`: in [`Scene::lights`]. The receiver itself is among them only if it may lie on its own way.
    #[must_use]
    pub fn occluders(&self, receiver: Object, light_idx: usize) -> Candidates<'_> {
        match self.known.as_ref().and_then(|known| known.occluders.as_ref()) {
            Some(table) => table.get(self.place(receiver) * self.scene.lights.len() + light_idx),
            None => self.everything.as_candidates(),
        }
    }

    /// Calls `visit` with each object that may have a point strictly between a light and another point, until it answers
    /// `true`, and tells whether it did; `None` when they are not looked up: then [`Plan::occluders`] are to be tested. An
    /// object may come several times.
    ///
    /// `light_idx`: in [`Scene::lights`]. `from_light`: from the light to the point. `error`: how far each of its coordinates
    /// may be off.
    #[inline]
    pub fn visit_between(
        &self,
        light_idx: usize,
        from_light: [f64; 3],
        error: f64,
        visit: impl FnMut(Object) -> bool,
    ) -> Option<bool> {
        self.around_lights.visit_between(light_idx, from_light, error, visit)
    }

    /// Calls `add` with where to look for what lies between a light and some points; `None` as for
    /// [`Plan::visit_between`]. Points that see the light in about the same direction are looked up as one.
    ///
    /// `from_light`: from the light to each point, and how far each of its coordinates may be off.
    #[inline]
    pub fn looks_from(
        &self,
        light_idx: usize,
        from_light: impl Iterator<Item = ([f64; 3], f64)>,
        add: impl FnMut(Look),
    ) -> Option<()> {
        self.around_lights.get(light_idx)?.looks(from_light, add)
    }

    /// Returns where to look for what lies between a light and some points, given what the light sees of all of them through
    /// one face of a cube around it; `None` when they are too far apart for that, or nothing is looked up.
    #[inline]
    #[must_use]
    pub fn look_at_once(&self, light_idx: usize, face: CubeFace, seen: Slopes<f64>) -> Option<Look> {
        self.around_lights.get(light_idx)?.look_at_once(face, seen)
    }

    /// Asks for the memory that some looks, each with its light, will need, one after the other.
    #[inline]
    pub fn expect_looks<E: Expect>(&self, looks: &[(usize, Look)]) {
        let cubes = || looks.iter().filter_map(|(light_idx, look)| Some((self.around_lights.get(*light_idx)?, look)));
        cubes().for_each(|(cube, look)| cube.expect_cells::<E>(look));
        cubes().for_each(|(cube, look)| cube.expect_records::<E>(look));
    }

    /// Calls `visit` with each object that may have a point strictly between a light and one of the points of a look from
    /// there, and with some that lie beside. An object may come several times.
    #[inline]
    pub fn visit_look(&self, light_idx: usize, look: &Look, visit: impl FnMut(Object)) {
        if let Some(cube) = self.around_lights.get(light_idx) {
            cube.visit_look(look, visit);
        }
    }

    /// Tells whether what may lie between a light and a point is looked up, if the point is known well enough.
    #[must_use]
    pub fn looks_between(&self) -> bool {
        self.around_lights.are_known()
    }

    /// Tells whether what a reflected ray may meet is looked up, if the ray is known well enough.
    #[must_use]
    pub fn looks_along(&self) -> bool {
        self.along_rays.are_known()
    }

    /// Calls `visit` with each object that a reflected ray may meet, roughly from near to far, and is told by it up to which
    /// t meetings still matter, below 0 for none; `None` when they are not looked up: then [`Plan::mirrored`] is to be
    /// tested.
    #[inline(always)]
    pub fn visit_along<M: MeetBoxes>(&self, ray: &SearchRay, visit: impl FnMut(Object) -> f64) -> Option<()> {
        self.along_rays.visit_along::<M>(ray, visit)
    }

    /// Returns what a reflected ray can meet.
    #[must_use]
    pub fn mirrored(&self) -> Candidates<'_> {
        self.mirrored.as_ref().unwrap_or(&self.everything).as_candidates()
    }

    /// Returns what a ray that is reflected by `mirror` can meet.
    #[inline]
    #[must_use]
    pub fn mirrored_by(&self, mirror: Object) -> Candidates<'_> {
        match self.known.as_ref().and_then(|known| known.reflected.as_ref()) {
            Some(table) => table.get(self.place(mirror)),
            None => self.mirrored(),
        }
    }

    /// Tells whether eye rays and reflected rays are proved to come to an object from outside alone.
    #[must_use]
    pub fn is_met_from_outside_alone(&self, object: Object) -> bool {
        self.known.as_ref().is_some_and(|known| known.roles.sealed[self.place(object)])
    }

    /// Returns the faces of an object that eye rays and reflected rays can meet.
    #[must_use]
    pub fn faces(&self, object: Object) -> Faces {
        self.known.as_ref().map_or(Faces::ALL, |known| known.roles.faces[self.place(object)])
    }

    /// Returns the last level that rays can have: that of the settings or less, when mirrors do not send rays on and on.
    #[must_use]
    pub fn last_level(&self) -> u32 {
        let beyond = self.settings.max_level + 1;
        self.report.max_bounces.map_or(beyond, |bounces| bounces.min(beyond))
    }

    /// Returns the place of an object among all, spheres first.
    #[inline]
    fn place(&self, object: Object) -> usize {
        match object {
            Object::Sphere(i) => i as usize,
            Object::Cylinder(i) => self.scene.sphere_primitives.len() + i as usize,
        }
    }
}
