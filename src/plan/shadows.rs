//! Pass `shadows`: for each object and light what can lie between them at all.
//!
//! # Why it is safe
//! A shadow ray leads from a point p of the receiver to the light; it is cast only when p faces the light, n·L > 0 with n
//! on the side from which p was met. It lies in the convex hull of the points that can be p, and the light. What is
//! parted from that hull by a plane (`bodies`) is not on its way, nor what the light sees elsewhere (`cone`), which is
//! tried first: most pairs are far apart.
//!
//! Of a sealed receiver (see `objects`), which is met from outside alone, only some points face the light:
//! - of a sphere with the light outside those beyond the disc where the light's tangents touch; with the light inside
//!   none;
//! - of a cylinder the upper cap with the light above it, the lower cap with the light below, and the wall with the
//!   light outside of the infinite wall; and only faces that rays can meet.
//!
//! Such a ray leaves a convex solid outwards: the receiver does not lie on its own way to the light. A receiver that is
//! not sealed counts as a whole, and among its occluders.
//!
//! What holds the light and all of the receiver inside, as a room does, is convex: no ray from one to the other meets its
//! surface.
//!
//! What lies between a light and the part of an object that a tile shows is less, and known when the tile's hits are: that
//! part of the pass is the tracer's (`trace::wide::patch`).

use glam::DVec3;

use crate::math::Sign;
use crate::plan::bodies::{Body, FacingDisc, Solid, parts};
use crate::plan::candidates::ListTable;
use crate::plan::cone::Cone;
use crate::plan::objects::Roles;
use crate::plan::solid::Faces;
use crate::plan::terms::answers;
use crate::plan::{Part, Scene, Settings};

/// For so many objects between an object and a light a plane is looked for, however many objects there are.
const MIN_PLANES: usize = 4;

/// What may lie between objects and lights.
#[derive(Debug)]
pub(super) struct Shadows {
    /// For each object the lights that may add to it.
    pub lights: Vec<Vec<u32>>,
    /// For each object and light, the light's index counted fastest, what may lie between them.
    pub occluders: ListTable,
}

/// The part of a receiver that faces a light.
enum Facing {
    Nothing,
    Disc(FacingDisc),
    Solid(Solid),
}

/// Finds for each object that is met, and each light, what may lie between them; by the rules of part A nothing does.
///
/// `max_planes`: for about how many pairs a plane is looked for.
pub(super) fn find_occluders(
    scene: &Scene<'_>,
    solids: &[Solid],
    roles: &Roles,
    settings: &Settings,
    max_planes: u64,
) -> Shadows {
    let part = settings.part;
    let n_lists = (solids.len() * scene.lights.len()).max(1) as u64;
    let max_planes = (max_planes / n_lists) as usize + MIN_PLANES;
    let n_spheres = scene.sphere_primitives.len();
    let cones: Vec<Vec<_>> = scene
        .lights
        .iter()
        .map(|light| solids.iter().map(|solid| Cone::new(solid, light.position)).collect())
        .collect();
    let rooms = scene.lights.iter().map(|light| solids.iter().map(|solid| solid.holds(light.position)).collect());
    let rooms: Vec<Vec<bool>> = rooms.collect();
    let mut shadows = Shadows { lights: Vec::with_capacity(solids.len()), occluders: ListTable::new(n_spheres) };
    for (receiver, primitive) in scene.primitives().enumerate() {
        let mut lights = Vec::new();
        for (light_idx, light) in (0..).zip(&scene.lights) {
            let is_lit = roles.is_met(receiver) && answers(scene.surface(*primitive), light, settings);
            let facing = if is_lit { facing(solids, roles, receiver, light.position) } else { Facing::Nothing };
            let mut between = match &facing {
                Facing::Nothing => Vec::new(),
                _ if part == Part::A => Vec::new(),
                _ => beside(&cones[light_idx as usize], receiver)
                    .filter(|&i| i != receiver || !roles.sealed[i])
                    .filter(|&i| !(rooms[light_idx as usize][i] && solids[i].contains(&solids[receiver])))
                    .collect(),
            };
            match &facing {
                Facing::Nothing => {}
                Facing::Disc(disc) => {
                    leave_out_parted(&mut between, disc, light.position, solids, receiver, max_planes)
                }
                Facing::Solid(solid) => {
                    leave_out_parted(&mut between, solid, light.position, solids, receiver, max_planes)
                }
            }
            sort_by_size(&mut between, light.position, solids);
            shadows.occluders.push(between.into_iter());
            if !matches!(facing, Facing::Nothing) {
                lights.push(light_idx);
            }
        }
        shadows.lights.push(lights);
    }
    shadows
}

fn facing(solids: &[Solid], roles: &Roles, receiver: usize, light: DVec3) -> Facing {
    let solid = solids[receiver];
    if !roles.sealed[receiver] {
        return Facing::Solid(solid);
    }
    match solid {
        Solid::Sphere { center, radius } => match solid.power(light) {
            Sign::Negative | Sign::Zero => Facing::Nothing,
            Sign::Unknown => Facing::Solid(solid),
            Sign::Positive => FacingDisc::new(center, radius, light).map_or(Facing::Solid(solid), Facing::Disc),
        },
        Solid::Cylinder { x, z, radius, y_min, y_max } => {
            let cap = |y: f64| Facing::Solid(Solid::Cylinder { x, z, radius, y_min: y, y_max: y });
            match roles.faces[receiver].and(solid.faces_toward(light)) {
                Faces { wall: false, lower: false, upper: false } => Facing::Nothing,
                Faces { wall: false, lower: false, upper: true } => cap(y_max),
                Faces { wall: false, lower: true, upper: false } => cap(y_min),
                _ => Facing::Solid(solid),
            }
        }
    }
}

/// Returns what the light may see before or beside a receiver, and the receiver.
fn beside(cones: &[Cone], receiver: usize) -> impl Iterator<Item = usize> {
    let own = cones[receiver];
    (0..cones.len()).filter(move |&i| !own.parts(&cones[i]))
}

/// Leaves out what planes part, the first so many looked at.
fn leave_out_parted(
    between: &mut Vec<usize>,
    start: &impl Body,
    light: DVec3,
    solids: &[Solid],
    receiver: usize,
    max_planes: usize,
) {
    let mut n_planes = 0;
    between.retain(|&i| {
        n_planes += 1;
        i == receiver || n_planes > max_planes || !parts(start, light, &solids[i])
    });
}

/// Puts first what looks largest from the light, and so is likely to block.
fn sort_by_size(occluders: &mut [usize], light: DVec3, solids: &[Solid]) {
    let size = |i: usize| match solids[i] {
        Solid::Sphere { center, radius } => radius * radius / center.distance_squared(light),
        Solid::Cylinder { x, z, radius, y_min, y_max } => {
            let middle = DVec3::new(x, 0.5 * (y_min + y_max), z);
            radius * (y_max - y_min) / middle.distance_squared(light)
        }
    };
    occluders.sort_by(|&a, &b| size(b).total_cmp(&size(a)));
}
