//! What the passes can tell of every object of an image, for those who judge scenes and not for those who trace them.
//!
//! It is the analysis of a plan, whatever the size of the image, and one step more: an object is needed when the eye sees
//! it, when a chain of mirrors that begins with what the eye sees may show it, or when it may lie between a light and one
//! of these. What else is left is out of reach as well.

use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::ir::SceneView;
use crate::math::{Ball64, Real, tan_half_degrees};
use crate::plan::analysis::analyse_pairs;
use crate::plan::apex::Outline;
use crate::plan::bodies::Solid;
use crate::plan::frustum::Frustum;
use crate::plan::report::{Kept, LeftOut, Reason, Report};
use crate::plan::{Object, Scene, Settings};

/// Pairs of objects, one more for each light, that an inspection looks at: they take some tenths of a second.
const MAX_PAIRS: u64 = 1 << 20;

/// How an object lies to what the eye rays of an image can meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sight {
    /// An eye ray may meet it.
    InView,
    /// It lies beside what the eye rays can meet.
    Outside,
    /// It lies behind the eye.
    Behind,
}

/// What is known of one object. What is said is proved; what is not said may still be so.
#[derive(Clone, Debug, PartialEq)]
pub struct Inspected {
    /// By its index in the scene as the `write` shows it.
    pub object: Object,
    /// Whether the eye lies inside.
    pub holds_eye: bool,
    /// The lights inside that are not black, by their indices in the scene as the `write` shows it.
    pub lights_inside: Vec<u32>,
    /// How it lies to the view.
    pub sight: Sight,
    /// The sides of the rectangle of pixels that its outline fills, infinite where the eye is near or inside.
    pub pixels: [f64; 2],
    /// Why no ray of the image needs it; `None` when one may.
    pub needless: Option<Reason>,
}

impl Inspected {
    /// Tells whether an object declared before is in its place.
    #[must_use]
    pub fn is_copy(&self) -> bool {
        self.needless == Some(Reason::Copy)
    }
}

/// Inspects the scene that one `write` sees. Spheres come first, each kind in its order.
#[must_use]
pub fn inspect(view: SceneView<'_>, settings: &Settings) -> Vec<Inspected> {
    let mut scene = Scene::new(view, settings.part);
    let mut report = Report::new(&view, &scene);
    let frustum = Frustum::new(view.fov_deg(), settings);
    let pixels_per_slope = pixels_per_slope(view.fov_deg(), settings);
    let inspected = |object: Object| {
        let solid = scene.solid(object);
        let is_inside = |&light: &usize| solid.holds(scene.lights[light].position);
        Inspected {
            object,
            holds_eye: solid.holds(DVec3::ZERO),
            lights_inside: (0..scene.lights.len()).filter(is_inside).map(|light| report.lights[light]).collect(),
            sight: sight(&solid, &frustum),
            pixels: outline_of(&solid)
                .map_or([0.0; 2], |outline| outline.slopes.map(|[low, high]| (high - low) * pixels_per_slope)),
            needless: None,
        }
    };
    let mut all: Vec<_> = scene.objects().map(inspected).collect();
    let known = analyse_pairs(&mut scene, view.fov_deg(), settings, &mut report, MAX_PAIRS);
    let mut needless = report.left_out;
    if let Some(known) = known {
        needless.extend(unreached(&known.describe(scene.lights.len())));
    }
    let n_spheres = view.spheres().len();
    for left_out in needless {
        let place = match left_out.object {
            Object::Sphere(i) => i as usize,
            Object::Cylinder(i) => n_spheres + i as usize,
        };
        all[place].needless.get_or_insert(left_out.reason);
    }
    all
}

/// Returns how many pixels a slope of 1 is.
fn pixels_per_slope(fov_deg: f64, settings: &Settings) -> f64 {
    let (k, error) = tan_half_degrees(fov_deg);
    f64::from(settings.size.height()) / (2.0 * Ball64::rounded(k, error).value())
}

fn sight(solid: &Solid, frustum: &Frustum) -> Sight {
    let nearest = match *solid {
        Solid::Sphere { center, radius } => center.z - radius,
        Solid::Cylinder { z, radius, .. } => z - radius,
    };
    match frustum.misses(solid) {
        false => Sight::InView,
        true if nearest >= 0.0 => Sight::Behind,
        true => Sight::Outside,
    }
}

/// Returns the outline that the eye sees; none when nothing of the solid is ahead.
fn outline_of(solid: &Solid) -> Option<Outline> {
    match *solid {
        Solid::Sphere { center, radius } => Outline::of_sphere([center.x, center.y, -center.z], radius),
        Solid::Cylinder { x, z, radius, y_min, y_max } => Outline::of_upright_cylinder([x, -z], radius, [y_min, y_max]),
    }
}

/// Returns those of the objects that are left which no chain of rays reaches.
fn unreached(kept: &[Kept]) -> Vec<LeftOut> {
    let places: FxHashMap<Object, usize> = kept.iter().enumerate().map(|(i, kept)| (kept.object, i)).collect();
    let place = |object: &Object| places.get(object).copied();
    let mut is_met: Vec<bool> = kept.iter().map(|kept| kept.is_seen).collect();
    let mut next: Vec<usize> = (0..kept.len()).filter(|&i| is_met[i]).collect();
    while let Some(i) = next.pop() {
        for met in kept[i].reflects.iter().flatten().filter_map(place) {
            if !std::mem::replace(&mut is_met[met], true) {
                next.push(met);
            }
        }
    }
    let mut is_needed = is_met.clone();
    for (kept, _) in kept.iter().zip(&is_met).filter(|(_, is_met)| **is_met) {
        let occluders = kept.lights.iter().flat_map(|(_, between)| between);
        occluders.filter_map(place).for_each(|i| is_needed[i] = true);
    }
    let needless = kept.iter().zip(is_needed).filter(|(_, is_needed)| !is_needed);
    needless.map(|(kept, _)| LeftOut { object: kept.object, reason: Reason::OutOfReach }).collect()
}
