//! Clusters: spheres of about one size, none of which reaches into another, and mirrors among them.
//!
//! # Which sphere is met first
//! Where two balls are apart, so are the parts of a ray inside of each, and the one whose middle, at b = m·d, comes first is
//! met first: no root is needed to compare them. Balls that touch may overlap by a rounding. Then their common part lies
//! within a circle of radius ρ, at most g·r/4, so that a ray has at most 2ρ in both.
//!
//! Let the computed middle of W come first among all balls that the ray may meet, and W be a sure hit: the ray has at least
//! 2g·r in it. Another ball that the ray meets does not hold all of W's part, which is too long. If W's part holds all of
//! its part, W is met first. Otherwise the middles are at least g·r − 2ρ ≥ g·r/2 apart, and in the order in which the parts
//! begin; computed ones are in the same order if each is off by less than a quarter of that. So nothing needs to be known
//! of the other balls but which of them the ray surely misses.
//!
//! A ray leaves a ball of the cluster at a cosine above g, so that this ball's own middle is g·r behind the origin: it is
//! among those that are surely missed.
//!
//! # Errors
//! No origin of a reflected ray is farther than S from the centre of a sphere that it may meet, so that |m| ≤ S in the bounds
//! of `mirror`.

use crate::plan::{Plan, Primitive, Scene};
use crate::trace::kernels::Precision;
use crate::trace::wide::bounds::{Face, MirroredSphere};

/// More objects are not compared pair by pair.
const MAX_OBJECTS: usize = 64;

/// S is at most this many times the smallest radius: with larger ones it would be a poor bound.
const MAX_SPAN: f64 = 32.0;

/// What is known of a cluster.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cluster {
    /// S.
    pub span: f64,
    /// 16u times the square of the largest radius.
    pub radius_rounding: f64,
    /// D of a sure hit is larger: g²r² of the largest.
    pub least: f64,
    /// A quarter of how far the middles of a sure hit and of what follows are apart.
    pub gap: f64,
    /// 8u·(|P|₁ + t) is at most this where a ray meets one of the spheres.
    pub hit_rounding: f64,
    /// What the spheres are, if all have one surface and few numbers are needed to name them.
    pub table: Option<Table>,
}

/// What spheres of one surface are, by the numbers of their faces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Table {
    pub center: [[f64; N_PLACES]; 3],
    pub radius: [f64; N_PLACES],
    pub per_radius: [f64; N_PLACES],
    pub equation: [f64; N_PLACES],
    /// The number of one of the faces.
    pub face: usize,
}

/// How many faces a table has room for.
const N_PLACES: usize = 16;

impl Table {
    /// Makes the table of some spheres, given all faces; `None` if they differ in their surfaces, or there is no room.
    fn new(faces: &[Face], spheres: &[u32]) -> Option<Self> {
        let face = *spheres.first()? as usize;
        let group = faces[face].group?;
        let zeros = [0.0; N_PLACES];
        let mut table = Self { center: [zeros; 3], radius: zeros, per_radius: zeros, equation: zeros, face };
        for place in spheres.iter().map(|&i| i as usize) {
            let face = &faces[place];
            if place >= N_PLACES || face.group != Some(group) {
                return None;
            }
            for k in 0..3 {
                table.center[k][place] = face.center[k];
            }
            table.radius[place] = face.radius;
            table.per_radius[place] = face.per_radius;
            table.equation[place] = f64::from(face.equation);
        }
        Some(table)
    }
}

impl Cluster {
    /// Tells whether what mirrors of a plan show is a cluster; cylinders may lie between.
    pub fn new(plan: &Plan<'_>, precision: Precision, faces: &[Face], spheres: &[MirroredSphere]) -> Option<Self> {
        let scene = &plan.scene;
        if scene.n_objects() > MAX_OBJECTS {
            return None;
        }
        let shown: Vec<_> = plan.mirrored().spheres.iter().map(|&i| &spheres[i as usize]).collect();
        let radius = |sphere: &MirroredSphere| sphere.radius_squared.sqrt();
        let min_radius = shown.iter().map(|sphere| radius(sphere)).fold(f64::INFINITY, f64::min);
        let max_radius = shown.iter().map(|sphere| radius(sphere)).fold(0.0, f64::max);
        let overlap = 0.25 * precision.min_cosine * min_radius;
        let are_apart =
            (1..shown.len()).all(|i| shown[..i].iter().all(|other| overlap_radius(shown[i], other) <= overlap));
        if !are_apart || shown.iter().any(|sphere| sphere.is_shell) {
            return None;
        }
        let centers = || shown.iter().map(|sphere| sphere.center);
        let span = 1.01 * centers().map(|center| farthest_mirror(scene, center)).fold(0.0, f64::max) + max_radius;
        let farthest_center = centers().map(|[x, y, z]| x.abs() + y.abs() + z.abs()).fold(0.0, f64::max);
        let cluster = Self {
            span,
            radius_rounding: 16.0 * precision.u * max_radius * max_radius,
            least: shown.iter().map(|sphere| sphere.least).fold(0.0, f64::max),
            gap: 0.125 * precision.min_cosine * min_radius,
            hit_rounding: 8.0 * precision.u * 1.01 * (farthest_center + 2.0 * max_radius + span),
            table: Table::new(faces, plan.mirrored().spheres).filter(|_| plan.mirrored().cylinders.is_empty()),
        };
        (span <= MAX_SPAN * min_radius).then_some(cluster)
    }
}

/// Returns the radius of the circle in which two spheres cut each other, infinite when one may hold the other's centre.
fn overlap_radius(a: &MirroredSphere, b: &MirroredSphere) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|k| a.center[k] - b.center[k]);
    let squared = x * x + y * y + z * z;
    if squared <= 1.01 * a.radius_squared.max(b.radius_squared) {
        return f64::INFINITY;
    }
    // Along the line of centres, from that of `a`.
    let along = (squared + a.radius_squared - b.radius_squared) / (2.0 * squared.sqrt());
    // A share of the radius covers the roundings.
    (a.radius_squared - along * along).max(0.0).sqrt() + 1e-6 * a.radius_squared.sqrt()
}

/// Returns the largest distance of a point from any mirror's surface.
fn farthest_mirror(scene: &Scene<'_>, [x, y, z]: [f64; 3]) -> f64 {
    let (s, c) = (&scene.spheres, &scene.cylinders);
    let is_mirror = |primitive: Primitive| scene.surface(primitive).reflectance > 0.0;
    let length = |[x, y, z]: [f64; 3]| (x * x + y * y + z * z).sqrt();
    let spheres = (0..s.radius.len())
        .filter(|&i| is_mirror(scene.sphere_primitives[i]))
        .map(|i| length([x - s.x[i], y - s.y[i], z - s.z[i]]) + s.radius[i]);
    let cylinders = (0..c.radius.len()).filter(|&i| is_mirror(scene.cylinder_primitives[i])).map(|i| {
        let across = length([x - c.x[i], 0.0, z - c.z[i]]) + c.radius[i];
        length([across, (y - c.y_min[i]).abs().max((y - c.y_max[i]).abs()), 0.0])
    });
    spheres.chain(cylinders).fold(0.0, f64::max)
}
