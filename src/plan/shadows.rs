//! Pass `shadows`: for each object and light what can lie between them at all.
//!
//! # Why it is safe
//! A shadow ray leads from a point p of the receiver to the light; it is cast only when p faces the light, n·L > 0 with n
//! on the side from which p was met. It lies in the convex hull of the points that can be p, and the light. What is
//! parted from that hull by a plane (`bodies`) is not on its way.
//!
//! Of a sealed receiver (see `objects`), which is met from outside alone, only some points face the light:
//! - of a sphere with the light outside those beyond the disc where the light's tangents touch; with the light inside
//!   none;
//! - of a cylinder the upper cap with the light above it, the lower cap with the light below, and the wall with the
//!   light outside of the infinite wall; and only faces that rays can meet.
//!
//! Such a ray leaves a convex solid outwards: the receiver does not lie on its own way to the light. A receiver that is
//! not sealed counts as a whole, and among its occluders.

use glam::DVec3;

use crate::math::Sign;
use crate::plan::bodies::{Body, FacingDisc, Region, Solid, parts};
use crate::plan::candidates::ListTable;
use crate::plan::objects::Roles;
use crate::plan::solid::Faces;
use crate::plan::terms::answers;
use crate::plan::{Part, Scene};

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
pub(super) fn find_occluders(scene: &Scene<'_>, solids: &[Solid], roles: &Roles, part: Part) -> Shadows {
    let n_spheres = scene.sphere_primitives.len();
    let mut shadows = Shadows { lights: Vec::with_capacity(solids.len()), occluders: ListTable::new(n_spheres) };
    for (receiver, primitive) in scene.primitives().enumerate() {
        let mut lights = Vec::new();
        for (light_idx, light) in (0..).zip(&scene.lights) {
            let is_lit = roles.is_met(receiver) && answers(scene.surface(*primitive), light, part);
            let facing = if is_lit { facing(solids, roles, receiver, light.position) } else { Facing::Nothing };
            let mut between = match &facing {
                Facing::Nothing => Vec::new(),
                _ if part == Part::A => Vec::new(),
                Facing::Disc(disc) => between(disc, light.position, solids, roles, receiver),
                Facing::Solid(solid) => between(solid, light.position, solids, roles, receiver),
            };
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

fn between(start: &impl Body, light: DVec3, solids: &[Solid], roles: &Roles, receiver: usize) -> Vec<usize> {
    let may_block = |&i: &usize| {
        let is_itself = i == receiver;
        if is_itself { !roles.sealed[i] } else { !parts(start, light, &solids[i]) }
    };
    (0..solids.len()).filter(may_block).collect()
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

/// Tells whether `solid` may lie between a point of `region` and the light.
pub(super) fn may_lie_between(region: &Region, light: DVec3, solid: &Solid) -> bool {
    !parts(region, light, solid)
}
