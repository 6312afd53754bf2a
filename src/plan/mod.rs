//! The plan of one image: a scene as one `write` sees it in, what its image needs out.
//!
//! [`plan`] runs its passes one after the other. Each may leave out whatever it can *prove* the image does not need: an
//! image made by the plan is the image made without it, in every pixel. What a pass cannot prove it leaves alone, so a
//! pass that is switched off ([`Passes`]) costs time and changes nothing.
//!
//! Never here: rays, pixels, threads of its own; guesses.

mod apex;
mod candidates;
mod passes;
mod scene;
mod settings;
mod tiles;

pub use candidates::{Candidates, Object, ObjectLists};
pub use passes::{Pass, Passes};
pub use scene::{CylinderLanes, Light, Primitive, Scene, SphereLanes};
pub use settings::{Part, SampleAt, Settings, Size};
pub use tiles::Tiles;

use crate::ir::SceneView;

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
    /// Everything in the scene.
    everything: ObjectLists,
}

/// Finds out what the image of a scene needs.
#[must_use]
pub fn plan<'p>(view: SceneView<'p>, settings: &Settings) -> Plan<'p> {
    let scene = Scene::new(view, settings.part);
    let everything = ObjectLists {
        spheres: (0..scene.sphere_primitives.len() as u32).collect(),
        cylinders: (0..scene.cylinder_primitives.len() as u32).collect(),
    };
    Plan {
        settings: settings.clone(),
        fov_deg: view.fov_deg(),
        tiles: Tiles::new(&scene, view.fov_deg(), settings),
        everything,
        scene,
    }
}

impl Plan<'_> {
    /// Returns what can lie between a surface of `receiver` and a light.
    ///
    /// `light_idx`: in [`Scene::lights`].
    #[must_use]
    pub fn occluders(&self, receiver: Object, light_idx: usize) -> Candidates<'_> {
        let _ = (receiver, light_idx);
        self.everything.as_candidates()
    }

    /// Returns what a reflected ray can meet.
    #[must_use]
    pub fn mirrored(&self) -> Candidates<'_> {
        self.everything.as_candidates()
    }
}
