//! What is known before the first ray: for each face, object, surface and pair of light and object the constants that
//! the packets work with, and how far each may be off.
//!
//! # Errors of eye rays
//! What is said here holds for any [`Precision`]: u is 2⁻⁵³ for binary64. The direction of an eye ray is
//! d = (X·k, Y·k, −1) with whole X, Y; its coordinates are off by at most a share e of themselves, which the camera
//! knows. With κ = e + 8u every product of a coordinate of d with an exact number is within κ of the exact product,
//! relative to it, and so is a sum of two of them relative to the product of lengths.
//!
//! *Sphere* with centre c and radius r: b = c·d is off by κ|c||d|, a = |d|² by 2κ·a, and the power p = |c|² − r² is
//! computed in double-double and rounded. D = b² − a·p is therefore off by at most a·σ, σ = 8κ(|c|² + r²), so that
//! b² < a·(p − 2σ) proves a miss. A hit is taken only if b² > a·(p + g²r²), which says that the cosine between normal and
//! ray is above g; g²r² is at least 4σ. Then |d| times the error of t = p/(b + √D) is at most
//! κ|c| + 0.75·σ/(g·r) + 3u|P|, because t/(b + √D) ≤ 1/a, and the point P is off by at most A/g with
//! A = κ(3(|c| + r) + 6(|c|² + r²)/r). Where the sphere is far, D = a·r² − |c × d|² is off by κ(5r|c| + 6r²) only, and
//! A = 8κ(|c| + r). The normal (P − c)/r is off by A/(g·r) + 4u.
//!
//! A sphere around the eye is a shell: everything that happens, happens inside of it. The ray meets it at
//! t = (b + √D)/a, with the same bounds, and its normal is turned round. All other objects are met from outside.
//!
//! *Wall*: the same in x and z; a length along the ray is at most F = |d|/|(dx, dz)| times as long as its shadow.
//!
//! *Cap* at height Y: the point is (X/Y'·Y, Y, −Y/(Y'·k)), with relative errors below 3κ, and within
//! |c| + r + |Y| of the eye; the normal is exact.
//!
//! # Errors of lengths from a light
//! For an object at m from a light and a segment w from the light to a point that is off by e, with
//! τ = |w|·(e + 4u|w|): b = m·w is off by |m|τ/|w|, a = |w|² by 2τ, and D = b² − a·p by (2|m|² + 2|p|)·τ; twice that is
//! used.

use rayon::prelude::*;

use crate::ir::Surface;
use crate::math::DoubleDouble;
use crate::plan::{Candidates, Light, Object, Part, Pass, Plan, Scene};
use crate::trace::kernels::Precision;
use crate::trace::wide::cluster::Cluster;

/// The smallest cosine between ray and normal at which a hit on a cap is taken: on caps nothing is lost but length, while the
/// silhouettes of curved faces are left to finer arithmetic from g on.
pub(super) const MIN_CAP_COSINE: f64 = 1.0 / 16384.0;

/// The largest error of a normal at which an eye ray's hit is taken, in roundings: 2⁻²⁴ of binary64.
const MAX_NORMAL_ERROR: f64 = (1_u64 << 29) as f64;

/// What is neglected in second order stays below a hundredth of the bounds as long as the error of a normal is below this
/// share of the smallest cosine.
const MAX_NORMAL_SHARE: f64 = 1.0 / 64.0;

/// Lengths, colours and exponents beyond these are left to finer arithmetic: products of four lengths neither overflow
/// nor lose anything to underflow that the bounds would notice.
const MAX_LENGTH: f64 = (1_u64 << 60) as f64;
const MIN_RADIUS: f64 = 1.0 / MAX_LENGTH;
const MAX_COEFFICIENT: f64 = (1_u64 << 20) as f64;

/// How far from a surface, as a share of the lengths squared, a point must be to have a side.
const MIN_POWER: f64 = 1e-9;

/// A face and how an eye ray meets it.
#[derive(Clone, Debug)]
pub(super) struct Face {
    pub kind: FaceKind,
    pub object: Object,
    /// Its place in the order of declaration.
    pub order: u32,
    /// The number of its equation.
    pub equation: u32,
    pub surface: usize,
    /// The centre, that of the axis at height 0, or that of the cap.
    pub center: [f64; 3],
    pub radius: f64,
    /// What a vector from the centre is multiplied with to be the normal: below 0 where the face is met from inside.
    pub per_radius: f64,
    /// Whether the error at a hit is to be taken as it is there, not as it may be at the silhouette.
    pub is_vague: bool,
    /// The number of the group that it belongs to, if any.
    pub group: Option<u32>,
    /// How far off a point is where an eye ray meets it, and the normal there.
    pub eye_point_error: f64,
    pub eye_normal_error: f64,
    /// A: the error of such a point times the cosine between normal and ray.
    pub eye_error_at_right_angles: f64,
}

/// A sphere as reflected rays see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct MirroredSphere {
    pub center: [f64; 3],
    pub radius_squared: f64,
    /// g²r²: D of a sure hit is larger.
    pub least: f64,
    /// Whether the eye is inside.
    pub is_shell: bool,
    /// The numbers of its equation and of its face.
    pub equation: f64,
    pub face: u32,
    /// `face`, among lanes.
    pub face_number: f64,
}

/// What a face is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::trace) enum FaceKind {
    Sphere,
    Wall,
    LowerCap,
    UpperCap,
}

/// A sphere as eye rays see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct EyeSphere {
    pub center: [f64; 3],
    pub radius_squared: f64,
    /// p.
    pub power: f64,
    /// p − 2σ and p + g²r².
    pub power_low: f64,
    pub power_high: f64,
    /// Whether D is taken from the cross product.
    pub is_far: bool,
    /// Whether the eye is inside.
    pub is_shell: bool,
    /// How far two t must be apart to have an order, half of it.
    pub margin: f64,
    pub face: u32,
}

/// A cylinder as eye rays see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct EyeCylinder {
    pub x: f64,
    pub z: f64,
    /// The wall, unless the eye is inside of its infinite continuation.
    pub wall: Option<EyeWall>,
    /// The cap that faces the eye.
    pub cap: Option<EyeCap>,
}

/// A wall as eye rays see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct EyeWall {
    pub radius_squared: f64,
    /// Whether D is taken from the cross product.
    pub is_far: bool,
    pub power: f64,
    pub power_low: f64,
    pub power_high: f64,
    /// Heights surely below, surely above the lower end, and surely below, surely above the upper end.
    pub below: f64,
    pub floor: f64,
    pub ceiling: f64,
    pub above: f64,
    pub margin: f64,
    pub face: u32,
}

/// A cap as eye rays see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct EyeCap {
    pub height: f64,
    /// Squared distances from the axis that are surely within and surely beyond the radius.
    pub within: f64,
    pub beyond: f64,
    pub margin: f64,
    pub face: u32,
}

/// How an object lies to a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// The light is outside of the sphere or infinite wall.
    Outside,
    /// The light is inside of the infinite wall, and above or below the cylinder.
    InLine,
    /// The light is inside of the sphere, the points are not.
    Within,
    /// The points are inside of the sphere, and so is the light: it hides nothing.
    Open,
    /// The points are inside of the sphere, and the light is not: it is hidden from all of them.
    Closed,
    /// Nothing is proved about what it hides.
    Unknown,
}

/// An object as a light sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Occluder {
    /// From the light to the centre or axis.
    pub m: [f64; 3],
    pub m_length: f64,
    pub power: f64,
    /// What τ is multiplied with to bound the error of D.
    pub slack: f64,
    pub radius_squared: f64,
    pub y_min: f64,
    pub y_max: f64,
    pub side: Side,
    /// The number of its equation, of spheres alone.
    pub equation: f64,
}

/// A light, and what each object is to it.
#[derive(Clone, Debug)]
pub(super) struct WideLight {
    pub position: [f64; 3],
    pub spheres: Vec<Occluder>,
    pub cylinders: Vec<Occluder>,
}

/// How (n·H)^P is computed from (n·H)².
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Power {
    /// P = 0.
    One,
    /// Whole P: that many squares, and the number itself if P is odd.
    Whole { half: u32, is_odd: bool },
    /// Another P, by `libm`.
    Other(f64),
}

/// What a surface makes of each light.
#[derive(Clone, Debug)]
pub(super) struct Terms {
    pub ambient: [f64; 3],
    pub lights: Vec<LightTerms>,
    pub has_diffuse: bool,
    pub has_specular: bool,
    pub power: Power,
    /// P, at least 1: what an error of n·H is multiplied with.
    pub steepness: f64,
    /// 0 when nothing is reflected.
    pub reflectance: f64,
    /// Lights that a hit may be lit by: none where no light is answered, or shadows do not matter.
    pub n_lightings: u32,
    /// Whether no term is negative.
    pub is_nonnegative: bool,
    /// A bound on what the sums of all terms lose to rounding.
    pub rounding: f64,
}

impl Terms {
    /// Tells whether lights add to a hit.
    pub fn answers(&self) -> bool {
        self.has_diffuse || self.has_specular
    }

    /// Tells whether a hit's own colour is the same in all channels.
    pub fn is_grey(&self) -> bool {
        let is_grey = |[red, green, blue]: [f64; 3]| red == green && green == blue;
        is_grey(self.ambient) && self.lights.iter().all(|light| is_grey(light.diffuse) && is_grey(light.specular))
    }
}

/// What a surface makes of one light.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightTerms {
    /// Cl·Cd and Cl·Cs.
    pub diffuse: [f64; 3],
    pub specular: [f64; 3],
    /// Their largest magnitudes.
    pub max_diffuse: f64,
    pub max_specular: f64,
    /// Whether all channels may be full when the lights before it have been added, and no term can make them smaller.
    pub may_be_idle: bool,
}

/// The constants of one image.
#[derive(Clone, Debug)]
pub(super) struct Bounds {
    pub eye: Eye,
    /// All faces: those of spheres, then three for each cylinder, the wall, the lower and the upper cap.
    pub faces: Vec<Face>,
    pub spheres: Vec<EyeSphere>,
    pub mirrored: Vec<MirroredSphere>,
    pub cluster: Option<Cluster>,
    pub cylinders: Vec<EyeCylinder>,
    pub lights: Vec<WideLight>,
    pub terms: Vec<Terms>,
    /// Whether all of this is known of all objects; of a crowd it may be worked out when it is needed.
    pub has_objects: bool,
    /// Spheres that are met from outside and have equal surfaces, by the numbers of their faces: a packet that meets
    /// several of them is shaded as one.
    pub groups: Vec<Vec<u32>>,
    /// A usual radius.
    pub size: f64,
    pub wall_equations: Vec<u32>,
    pub sphere_equations: Vec<u32>,
    /// For each equation the object that alone has it, as far as they are known.
    owners: Vec<Option<Object>>,
}

impl Bounds {
    /// Works out the constants of an image.
    ///
    /// Returns `None` for scenes that are left to finer arithmetic altogether.
    pub fn new(plan: &Plan<'_>, eye: Eye) -> Option<Self> {
        let (scene, precision) = (&plan.scene, eye.precision);
        if !is_moderate(scene) {
            return None;
        }
        let n_spheres = scene.spheres.radius.len();
        let mut faces = Vec::new();
        let spheres = (0..n_spheres).map(|i| eye_sphere(scene, eye, i, &mut faces)).collect::<Option<Vec<_>>>()?;
        let n_cylinders = scene.cylinders.radius.len();
        let cylinders =
            (0..n_cylinders).map(|i| eye_cylinder(scene, eye, i, &mut faces)).collect::<Option<Vec<_>>>()?;
        let groups = group_spheres(scene, &mut faces);
        let mirrored: Vec<_> =
            (0..).zip(&faces[..n_spheres]).map(|(i, face)| MirroredSphere::new(precision, i, face)).collect();
        Some(Self {
            groups,
            has_objects: true,
            owners: owners(&faces),
            cluster: Cluster::new(plan, precision, &faces, &mirrored),
            mirrored,
            eye,
            faces,
            spheres,
            cylinders,
            lights: scene.lights.iter().map(|light| seen_from(scene, light)).collect(),
            terms: all_terms(plan, eye.precision),
            size: usual_radius(scene),
            sphere_equations: scene.sphere_equations[..n_spheres].iter().map(|id| id.number()).collect(),
            wall_equations: scene.wall_equations[..n_cylinders].iter().map(|id| id.number()).collect(),
        })
    }
}

/// The constants of more objects are worked out when they are needed: each is needed seldom.
const MAX_TABULATED: usize = 1 << 14;

/// More equations are not told apart by a table.
const MAX_OWNERS: u32 = 1 << 16;

/// Finds for each equation the object that alone has it.
fn owners(faces: &[Face]) -> Vec<Option<Object>> {
    let n_equations = faces.iter().map(|face| face.equation + 1).max().unwrap_or(0);
    if n_equations > MAX_OWNERS {
        return Vec::new();
    }
    let mut owners = vec![None; n_equations as usize];
    let mut is_shared = vec![false; n_equations as usize];
    for face in faces {
        let i = face.equation as usize;
        is_shared[i] |= owners[i].is_some();
        owners[i] = if is_shared[i] { None } else { Some(face.object) };
    }
    owners
}

impl MirroredSphere {
    /// Takes what there is to know from a face, given its number among the faces.
    fn new(precision: Precision, number: u32, face: &Face) -> Self {
        let radius_squared = face.radius * face.radius;
        Self {
            center: face.center,
            radius_squared,
            least: radius_squared * precision.min_cosine * precision.min_cosine,
            is_shell: face.per_radius < 0.0,
            equation: f64::from(face.equation),
            face: number,
            face_number: f64::from(number),
        }
    }
}

/// Finds the spheres with equal surfaces.
fn group_spheres(scene: &Scene<'_>, faces: &mut [Face]) -> Vec<Vec<u32>> {
    let mut groups: Vec<(&Surface, Vec<u32>)> = Vec::new();
    for (i, face) in (0..).zip(faces).filter(|(_, face)| face.kind == FaceKind::Sphere && face.per_radius > 0.0) {
        let surface = &scene.surfaces[face.surface];
        let group = groups.iter().position(|(other, _)| *other == surface).unwrap_or(groups.len());
        if group == groups.len() {
            groups.push((surface, Vec::new()));
        }
        groups[group].1.push(i);
        face.group = Some(group as u32);
    }
    groups.into_iter().map(|(_, members)| members).collect()
}

impl Bounds {
    /// Works out the constants of a scene of many objects, without those of any object.
    ///
    /// Returns `None` when the eye is neither surely outside nor surely inside of a sphere, and for scenes that are left to
    /// finer arithmetic altogether.
    pub fn of_crowd(plan: &Plan<'_>, eye: Eye) -> Option<Self> {
        let (scene, s) = (&plan.scene, &plan.scene.spheres);
        let has_side = |i: usize| {
            let (squared, radius_squared) =
                (s.x[i] * s.x[i] + s.y[i] * s.y[i] + s.z[i] * s.z[i], s.radius[i] * s.radius[i]);
            (squared - radius_squared).abs() > MIN_POWER * (squared + radius_squared)
        };
        let sides = (0..s.radius.len()).into_par_iter().with_min_len(OBJECTS_PER_TASK);
        if !is_moderate(scene) || !sides.all(has_side) {
            return None;
        }
        let light = |light: &Light| WideLight {
            position: light.position.to_array(),
            spheres: Vec::new(),
            cylinders: Vec::new(),
        };
        Some(Self {
            lights: scene.lights.iter().map(light).collect(),
            terms: all_terms(plan, eye.precision),
            ..Self::of_nothing(eye, usual_radius(scene))
        })
    }

    /// Adds the constants of all objects of a crowd, unless they are too many or one of them is left to finer arithmetic.
    pub fn with_objects(self, plan: &Plan<'_>) -> Self {
        let scene = &plan.scene;
        if scene.n_objects() > MAX_TABULATED {
            return self;
        }
        let [spheres, cylinders] = [&scene.spheres.radius, &scene.cylinders.radius].map(|radii| 0..radii.len() as u32);
        let (spheres, cylinders): (Vec<_>, Vec<_>) = (spheres.collect(), cylinders.collect());
        let Some(objects) = self.of_some(plan, Candidates { spheres: &spheres, cylinders: &cylinders }) else {
            return self;
        };
        let Self { faces, spheres, mirrored, cylinders, .. } = objects;
        let lights = scene.lights.iter().map(|light| seen_from(scene, light)).collect();
        Self { faces, spheres, mirrored, cylinders, lights, has_objects: true, ..self }
    }

    /// Works out the constants of some objects of a crowd, without lights and surfaces.
    pub fn of_some(&self, plan: &Plan<'_>, some: Candidates<'_>) -> Option<Self> {
        let mut faces = Vec::with_capacity(some.spheres.len() + 3 * some.cylinders.len());
        let seen = some.spheres.iter().map(|&i| eye_sphere(&plan.scene, self.eye, i as usize, &mut faces));
        let spheres = seen.collect::<Option<Vec<_>>>()?;
        let mirrored = (0..).zip(&faces).map(|(i, face)| MirroredSphere::new(self.eye.precision, i, face)).collect();
        let seen = some.cylinders.iter().map(|&i| eye_cylinder(&plan.scene, self.eye, i as usize, &mut faces));
        let cylinders = seen.collect::<Option<Vec<_>>>()?;
        Some(Self { faces, spheres, mirrored, cylinders, ..Self::of_nothing(self.eye, self.size) })
    }

    /// Returns the object that alone has an equation, if that is known.
    #[inline(always)]
    pub fn owner(&self, equation: f64) -> Option<Object> {
        self.owners.get(equation as usize).copied().flatten()
    }

    fn of_nothing(eye: Eye, size: f64) -> Self {
        Self {
            eye,
            has_objects: false,
            groups: Vec::new(),
            faces: Vec::new(),
            spheres: Vec::new(),
            mirrored: Vec::new(),
            cluster: None,
            cylinders: Vec::new(),
            lights: Vec::new(),
            terms: Vec::new(),
            size,
            wall_equations: Vec::new(),
            sphere_equations: Vec::new(),
            owners: Vec::new(),
        }
    }
}

/// Objects that a thread looks at at a time.
const OBJECTS_PER_TASK: usize = 1 << 14;

/// Tells whether all numbers of a scene lie where the bounds hold.
fn is_moderate(scene: &Scene<'_>) -> bool {
    let (s, c) = (&scene.spheres, &scene.cylinders);
    let lengths = [&s.x, &s.y, &s.z, &s.radius, &c.x, &c.z, &c.radius, &c.y_min, &c.y_max];
    let lights = scene.lights.iter().flat_map(|light| light.position.to_array());
    let colors = scene.lights.iter().flat_map(|light| light.color.to_array());
    let surfaces = scene.surfaces.iter().flat_map(|s| [s.ambient, s.diffuse, s.specular].map(|c| c.to_array()));
    let are_all = |lengths: &[f64], is_fine: fn(f64) -> bool| {
        lengths.par_iter().with_min_len(OBJECTS_PER_TASK).all(|length| is_fine(*length))
    };
    lengths.into_iter().all(|lengths| are_all(lengths, |length| length.abs() <= MAX_LENGTH))
        && [&s.radius, &c.radius].into_iter().all(|radii| are_all(radii, |radius| radius >= MIN_RADIUS))
        && lights.into_iter().all(|length| length.abs() <= MAX_LENGTH)
        && colors.chain(surfaces.flatten()).chain(scene.background.to_array()).all(|c| c.abs() <= MAX_COEFFICIENT)
        && scene.surfaces.iter().all(|s| s.reflectance <= MAX_COEFFICIENT)
}

/// Returns the median radius, or 1 when there is none.
fn usual_radius(scene: &Scene<'_>) -> f64 {
    let n_objects = scene.spheres.radius.len() + scene.cylinders.radius.len();
    let radii = scene.spheres.radius.iter().chain(&scene.cylinders.radius).copied();
    let mut radii: Vec<_> = radii.step_by(n_objects / 1024 + 1).collect();
    radii.sort_unstable_by(f64::total_cmp);
    radii.get(radii.len() / 2).copied().unwrap_or(1.0)
}

/// The power of the origin with regard to a circle or sphere at `m`, and |m|² + r².
fn power<const N: usize>(m: [DoubleDouble; N], radius: f64) -> (f64, f64) {
    let radius_squared = DoubleDouble::product(radius, radius);
    let distance_squared = m.into_iter().fold(DoubleDouble::ZERO, |sum, coordinate| sum + coordinate.square());
    ((distance_squared - radius_squared).hi(), (distance_squared + radius_squared).hi())
}

/// What bounds of eye rays depend on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eye {
    /// κ.
    pub roundoff: f64,
    /// F.
    stretch: f64,
    /// How precise the lanes are.
    pub precision: Precision,
}

impl Eye {
    /// Takes note of eye rays whose coordinates are off by `dir_error`, relative to them, and at most `max_slope` steep.
    pub fn new(precision: Precision, dir_error: f64, max_slope: f64) -> Self {
        Self { roundoff: dir_error + 8.0 * precision.u, stretch: (1.0 + max_slope * max_slope).sqrt(), precision }
    }

    /// Returns the largest error of a normal at which a hit is taken.
    fn max_normal_error(self) -> f64 {
        (MAX_NORMAL_ERROR * self.precision.u).min(MAX_NORMAL_SHARE * self.precision.min_cosine)
    }
}

/// What the eye sees of a sphere or infinite wall from outside.
struct Silhouette {
    power: f64,
    power_low: f64,
    power_high: f64,
    /// A.
    error: f64,
    /// g.
    cosine: f64,
    is_far: bool,
    is_inside: bool,
}

/// Returns `None` when the eye is neither surely outside nor surely inside.
fn silhouette<const N: usize>(eye: Eye, center: [f64; N], radius: f64) -> Option<Silhouette> {
    let (power, squares) = power(center.map(DoubleDouble::from), radius);
    let sigma = 8.0 * eye.roundoff * squares;
    if power.abs() <= 4.0 * sigma {
        return None;
    }
    let distance = (power + radius * radius).max(0.0).sqrt();
    let is_far = distance > 16.0 * radius;
    let kappa = 1.1 * eye.roundoff * if N == 2 { eye.stretch } else { 1.0 };
    let error = if is_far {
        8.0 * kappa * (distance + radius)
    } else {
        kappa * (3.0 * (distance + radius) + 6.0 * squares / radius)
    };
    let for_normal = error / (radius * eye.max_normal_error());
    let cosine_squared = (eye.precision.min_cosine * eye.precision.min_cosine)
        .max(4.0 * sigma / (radius * radius))
        .max(for_normal * for_normal);
    // Seen so badly that no hit is sure.
    let power_high =
        if cosine_squared > 0.25 { f64::INFINITY } else { power + cosine_squared * radius * radius * 1.001 };
    let cosine = cosine_squared.sqrt();
    Some(Silhouette {
        power,
        power_low: power - 2.0 * sigma,
        power_high,
        error,
        cosine,
        is_far,
        is_inside: power < 0.0,
    })
}

fn eye_sphere(scene: &Scene<'_>, eye: Eye, i: usize, faces: &mut Vec<Face>) -> Option<EyeSphere> {
    let s = &scene.spheres;
    let (center, radius) = ([s.x[i], s.y[i], s.z[i]], s.radius[i]);
    let seen = silhouette(eye, center, radius)?;
    let point_error = seen.error / seen.cosine;
    let primitive = scene.sphere_primitives[i];
    faces.push(Face {
        kind: FaceKind::Sphere,
        object: Object::Sphere(i as u32),
        order: primitive.order,
        equation: scene.sphere_equations[i].number(),
        surface: primitive.surface.index(),
        center,
        radius,
        per_radius: if seen.is_inside { -1.0 / radius } else { 1.0 / radius },
        group: None,
        is_vague: is_vague(eye.precision, point_error, radius, seen.power),
        eye_point_error: point_error,
        eye_normal_error: point_error / radius + 4.0 * eye.precision.u,
        eye_error_at_right_angles: seen.error,
    });
    Some(EyeSphere {
        center,
        radius_squared: radius * radius,
        power: seen.power,
        power_low: seen.power_low,
        power_high: seen.power_high,
        is_far: seen.is_far,
        is_shell: seen.is_inside,
        margin: 2.0 * point_error,
        face: faces.len() as u32 - 1,
    })
}

/// Tells whether an error is large beside the radius or the shortest way from the eye.
///
/// `power`: of the eye; at most 2·radius times that way plus its square.
fn is_vague(precision: Precision, error: f64, radius: f64, power: f64) -> bool {
    /// In roundings: 2⁻³³ of binary64.
    const LARGE: f64 = (1_u64 << 20) as f64;
    error > LARGE * precision.u * radius.min(power.abs() / radius)
}

/// Returns `None` when the eye is not surely outside.
fn eye_cylinder(scene: &Scene<'_>, eye: Eye, i: usize, faces: &mut Vec<Face>) -> Option<EyeCylinder> {
    let c = &scene.cylinders;
    let (x, z, radius, y_min, y_max) = (c.x[i], c.z[i], c.radius[i], c.y_min[i], c.y_max[i]);
    let seen = silhouette(eye, [x, z], radius).filter(|seen| !seen.is_inside);
    let (power, squares) = power([x, z].map(DoubleDouble::from), radius);
    let is_inside_wall = power < -32.0 * eye.roundoff * squares;
    let (is_over, is_under) = (y_max < 0.0, y_min > 0.0);
    if seen.is_none() && !(is_inside_wall && (is_over || is_under)) {
        return None;
    }
    let first_face = faces.len() as u32;
    let primitive = scene.cylinder_primitives[i];
    let axis_distance = x.abs() + z.abs();
    let kinds = [(FaceKind::Wall, 0.0), (FaceKind::LowerCap, y_min), (FaceKind::UpperCap, y_max)];
    let [lower, upper] = scene.cap_equations[i];
    for ((kind, height), equation) in kinds.into_iter().zip([scene.wall_equations[i], lower, upper]) {
        let (point_error, error) = match (&seen, kind) {
            (Some(seen), FaceKind::Wall) => (seen.error / seen.cosine, seen.error),
            (None, FaceKind::Wall) => (f64::INFINITY, f64::INFINITY),
            _ => {
                let error = 5.0 * eye.roundoff * (axis_distance + radius + height.abs());
                (error, error)
            }
        };
        faces.push(Face {
            kind,
            object: Object::Cylinder(i as u32),
            order: primitive.order,
            equation: equation.number(),
            surface: primitive.surface.index(),
            center: [x, height, z],
            radius,
            per_radius: 1.0 / radius,
            group: None,
            is_vague: kind == FaceKind::Wall && is_vague(eye.precision, point_error, radius, power),
            eye_point_error: point_error,
            eye_normal_error: if kind == FaceKind::Wall { point_error / radius + 4.0 * eye.precision.u } else { 0.0 },
            eye_error_at_right_angles: error,
        });
    }
    let wall = seen.map(|seen| {
        let slack = 2.0 * seen.error / seen.cosine + 4.0 * eye.precision.u * y_min.abs().max(y_max.abs());
        EyeWall {
            radius_squared: radius * radius,
            is_far: seen.is_far,
            power: seen.power,
            power_low: seen.power_low,
            power_high: seen.power_high,
            below: y_min - slack,
            floor: y_min + slack,
            ceiling: y_max - slack,
            above: y_max + slack,
            margin: slack,
            face: first_face,
        }
    });
    let cap = (is_over || is_under).then(|| {
        let height = if is_over { y_max } else { y_min };
        let reach = axis_distance + radius + height.abs();
        let (squared, slack) = (radius * radius, 16.0 * eye.roundoff * radius * reach);
        EyeCap {
            height,
            within: squared - slack,
            beyond: squared + slack,
            margin: 10.0 * eye.roundoff * reach,
            face: first_face + if is_over { 2 } else { 1 },
        }
    });
    Some(EyeCylinder { x, z, wall, cap })
}

/// Works out what every object is to a light.
fn seen_from(scene: &Scene<'_>, light: &Light) -> WideLight {
    let position = light.position.to_array();
    WideLight {
        position,
        spheres: (0..scene.spheres.radius.len()).map(|i| sphere_from(scene, position, i)).collect(),
        cylinders: (0..scene.cylinders.radius.len()).map(|i| cylinder_from(scene, position, i)).collect(),
    }
}

/// Works out what a cylinder is to a light.
pub(super) fn cylinder_from(scene: &Scene<'_>, [x, y, z]: [f64; 3], i: usize) -> Occluder {
    let c = &scene.cylinders;
    let m = [DoubleDouble::sum(c.x[i], -x), DoubleDouble::ZERO, DoubleDouble::sum(c.z[i], -z)];
    let (power, squares) = power(m, c.radius[i]);
    let is_in_line = power < -MIN_POWER * squares && (y > c.y_max[i] || y < c.y_min[i]);
    let side = match () {
        () if power > MIN_POWER * squares => Side::Outside,
        () if is_in_line => Side::InLine,
        () => Side::Unknown,
    };
    occluder(m, power, c.radius[i], [c.y_min[i], c.y_max[i]], side)
}

/// Works out what a sphere is to a light.
pub(super) fn sphere_from(scene: &Scene<'_>, [x, y, z]: [f64; 3], i: usize) -> Occluder {
    let s = &scene.spheres;
    let m = [DoubleDouble::sum(s.x[i], -x), DoubleDouble::sum(s.y[i], -y), DoubleDouble::sum(s.z[i], -z)];
    let (power, squares) = power(m, s.radius[i]);
    let is_shell = is_around_eye(scene, i);
    let side = match (power > MIN_POWER * squares, power < -MIN_POWER * squares, is_shell) {
        (true, _, false) => Side::Outside,
        (true, _, true) => Side::Closed,
        (_, true, false) => Side::Within,
        (_, true, true) => Side::Open,
        (false, false, _) => Side::Unknown,
    };
    Occluder {
        equation: f64::from(scene.sphere_equations[i].number()),
        ..occluder(m, power, s.radius[i], [0.0; 2], side)
    }
}

/// Tells whether the eye is inside of a sphere, off whose surface it is.
pub(super) fn is_around_eye(scene: &Scene<'_>, i: usize) -> bool {
    let s = &scene.spheres;
    s.x[i] * s.x[i] + s.y[i] * s.y[i] + s.z[i] * s.z[i] < s.radius[i] * s.radius[i]
}

fn occluder(m: [DoubleDouble; 3], power: f64, radius: f64, [y_min, y_max]: [f64; 2], side: Side) -> Occluder {
    let m = m.map(DoubleDouble::hi);
    let m_squared = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
    let radius_squared = radius * radius;
    Occluder {
        m,
        m_length: 1.001 * m_squared.sqrt(),
        power,
        slack: 4.01 * (m_squared + power.abs()),
        radius_squared,
        y_min,
        y_max,
        side,
        equation: f64::NAN,
    }
}

/// Multiplies out what each surface makes of each light.
fn all_terms(plan: &Plan<'_>, precision: Precision) -> Vec<Terms> {
    let Plan { scene, settings, .. } = plan;
    let all = scene.surfaces.iter().map(|surface| terms_of(surface, &scene.lights, settings.part, precision));
    let mut all: Vec<_> = all.collect();
    if settings.passes.contains(Pass::Saturation) {
        all.iter_mut().for_each(find_idle);
    }
    all
}

/// Finds the lights before which all channels may be full, where no term is negative.
fn find_idle(terms: &mut Terms) {
    if !terms.is_nonnegative {
        return;
    }
    let mut sum = terms.ambient;
    for light in &mut terms.lights {
        light.may_be_idle = sum.iter().all(|channel| *channel > 1.0);
        for k in 0..3 {
            sum[k] += light.diffuse[k] + light.specular[k];
        }
    }
}

fn terms_of(surface: &Surface, lights: &[Light], part: Part, precision: Precision) -> Terms {
    let is_b = part == Part::B;
    let zero = glam::DVec3::ZERO;
    let (ambient, specular) = if is_b { (surface.ambient, surface.specular) } else { (zero, zero) };
    let largest = |color: glam::DVec3| color.abs().max_element();
    let lights: Vec<_> = (lights.iter())
        .map(|light| {
            let (diffuse, specular) = (light.color * surface.diffuse, light.color * specular);
            LightTerms {
                diffuse: diffuse.to_array(),
                specular: specular.to_array(),
                max_diffuse: largest(diffuse),
                max_specular: largest(specular),
                may_be_idle: false,
            }
        })
        .collect();
    let total = lights.iter().fold(largest(ambient), |sum, terms| sum + terms.max_diffuse + terms.max_specular);
    let shininess = surface.shininess;
    let power = match shininess {
        0.0 => Power::One,
        p if p.fract() == 0.0 && p <= 1e6 => Power::Whole { half: (p / 2.0) as u32, is_odd: p % 2.0 == 1.0 },
        p => Power::Other(p),
    };
    let (has_diffuse, has_specular) = (surface.diffuse != zero, specular != zero);
    let terms = |terms: &LightTerms| terms.diffuse.into_iter().chain(terms.specular).all(|term| term >= 0.0);
    Terms {
        ambient: ambient.to_array(),
        has_diffuse,
        has_specular,
        n_lightings: if is_b && (has_diffuse || has_specular) { lights.len() as u32 } else { 0 },
        power,
        steepness: shininess.max(1.0),
        reflectance: if is_b { surface.reflectance.max(0.0) } else { 0.0 },
        is_nonnegative: ambient.min_element() >= 0.0 && lights.iter().all(terms),
        rounding: 8.0 * precision.u * (lights.len() + 4) as f64 * total,
        lights,
    }
}
