//! What lies between a packet of points and a light.
//!
//! The segment is followed from the light, whose place is exact, to the point: w, with s from 0 at the light to 1 at
//! the point. Every point lies outside of all objects, or on them, because the eye does and a ray ends at the first
//! surface it meets; or else inside of a shell (see `bounds`), which hides nothing that is inside too and everything
//! that is not. So a sphere that the light is outside of is met with 0 < s < 1 exactly when D ≥ 0 and 0 < b < a, with
//! a, b, D as in `bounds`: no root is taken. A cylinder is met if, within the part of the segment that lies inside of
//! its infinite wall, some height is its own.

use crate::plan::{Object, Part, Plan};
use crate::trace::kernels::{Lanes, Mask};
use crate::trace::wide::bounds::{Bounds, Face, FaceKind, Occluder, Side, WideLight};
use crate::trace::wide::shade::{Points, dot, splat_each};

/// D must be more than this share of a·r² for the roots of a wall to be taken.
const MIN_WALL_DISCRIMINANT: f64 = 1.0 / 262_144.0;

/// What can hide each light from one face.
#[derive(Clone, Debug, Default)]
pub(super) struct LightOccluders {
    /// For each light the spheres and the cylinders.
    lists: Vec<[Vec<u32>; 2]>,
    /// For each light whether it adds nothing to the face, or is hidden from all of it.
    hidden: Vec<bool>,
    /// Whether spheres may be among their own occluders, which is then seen lane by lane.
    is_shared: bool,
}

impl LightOccluders {
    /// Lists what may hide a light, or says that it is hidden.
    pub fn list(
        &mut self,
        light_idx: usize,
        is_hidden: bool,
        spheres: impl Iterator<Item = u32>,
        cylinders: impl Iterator<Item = u32>,
    ) {
        if self.lists.len() <= light_idx {
            self.lists.resize_with(light_idx + 1, Default::default);
            self.hidden.resize(light_idx + 1, false);
        }
        self.hidden[light_idx] = is_hidden;
        let lists = &mut self.lists[light_idx];
        lists.iter_mut().for_each(Vec::clear);
        lists[0].extend(spheres);
        lists[1].extend(cylinders);
    }

    /// Collects what the plan has left, without what shares the face's equation: a ray that leaves a face outward meets
    /// neither that face again nor, from a wall, anything inside of it. A cap that is level with the face is not met
    /// either; its cylinder lies wholly on the other side of the light, or stands on the face and has other faces.
    pub fn new(bounds: &Bounds, plan: &Plan<'_>, face: &Face) -> Self {
        if plan.settings.part == Part::A {
            let n_lights = bounds.lights.len();
            return Self { lists: vec![Default::default(); n_lights], hidden: vec![false; n_lights], is_shared: false };
        }
        let surface = &plan.scene.surfaces[face.surface];
        let side = |light_idx: usize, i: u32| bounds.lights[light_idx].spheres[i as usize].side;
        let hidden = (0..bounds.lights.len())
            .map(|light_idx| {
                let among = plan.occluders(face.object, light_idx);
                !plan.adds(surface, light_idx) || among.spheres.iter().any(|&i| side(light_idx, i) == Side::Closed)
            })
            .collect();
        let lists = (0..bounds.lights.len())
            .map(|light_idx| {
                let light = &bounds.lights[light_idx];
                let among = plan.occluders(face.object, light_idx);
                let spheres = (among.spheres.iter().copied())
                    .filter(|&i| bounds.sphere_equations[i as usize] != face.equation || face.per_radius < 0.0)
                    .filter(|&i| side(light_idx, i) != Side::Open)
                    .collect();
                let cylinders = (among.cylinders.iter().copied())
                    .filter(|&i| face.object != Object::Cylinder(i))
                    .filter(|&i| bounds.wall_equations[i as usize] != face.equation)
                    .filter(|&i| !is_behind_cap(&light.cylinders[i as usize], light.position[1], face))
                    .collect();
                [spheres, cylinders]
            })
            .collect();
        Self { lists, hidden, is_shared: false }
    }
}

impl LightOccluders {
    /// Collects what can hide each light from one of several spheres.
    pub fn of_group(bounds: &Bounds, plan: &Plan<'_>, faces: &[u32]) -> Self {
        let members: Vec<_> = faces.iter().map(|&face| Self::new(bounds, plan, &bounds.faces[face as usize])).collect();
        let union = |light_idx: usize, kind: usize| {
            let mut all: Vec<_> = members.iter().flat_map(|member| member.lists[light_idx][kind].clone()).collect();
            all.sort_unstable();
            all.dedup();
            all
        };
        let n_lights = bounds.lights.len();
        let hidden = (0..n_lights).map(|i| members.iter().all(|member| member.hidden[i])).collect();
        let lists = (0..n_lights).map(|i| [union(i, 0), union(i, 1)]).collect();
        Self { lists, hidden, is_shared: true }
    }
}

impl LightOccluders {
    /// Tells whether a light adds nothing to the face, or is hidden from all of it.
    pub fn is_hidden(&self, light_idx: usize) -> bool {
        self.hidden[light_idx]
    }

    /// Tells whether nothing can hide any light, and each may be seen.
    pub fn are_none(&self) -> bool {
        (0..self.lists.len()).all(|light_idx| self.is_open(light_idx))
    }

    /// Tells whether nothing can hide a light.
    #[inline(always)]
    pub fn is_open(&self, light_idx: usize) -> bool {
        let [spheres, cylinders] = &self.lists[light_idx];
        spheres.is_empty() && cylinders.is_empty()
    }

    /// Returns the spheres and the cylinders that can hide a light.
    pub fn of_light(&self, light_idx: usize) -> &[Vec<u32>; 2] {
        &self.lists[light_idx]
    }
}

/// Tells whether a cap is level with or beyond the top of a cylinder, and the light too; or the bottom.
pub(super) fn is_behind_cap(cylinder: &Occluder, light_height: f64, face: &Face) -> bool {
    let height = face.center[1];
    match face.kind {
        FaceKind::UpperCap => height >= cylinder.y_max && light_height >= cylinder.y_max,
        FaceKind::LowerCap => height <= cylinder.y_min && light_height <= cylinder.y_min,
        FaceKind::Sphere | FaceKind::Wall => false,
    }
}

/// Tells from which of the points a light is surely hidden, and of which that is in doubt; and how many objects were tested.
///
/// `w`, `a`, `distance`: from the light to the points, their squared lengths and their lengths. `facing`: the lanes that
/// are asked for.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "what the caller has in registers")]
pub(super) fn shadow<L: Lanes>(
    light: &WideLight,
    occluders: &LightOccluders,
    light_idx: usize,
    w: &[L; 3],
    a: L,
    distance: L,
    at: &Points<L>,
    facing: L::Mask,
) -> (L::Mask, L::Mask, u32) {
    let mut open = facing;
    let mut vague = L::Mask::from_bits(0);
    let [spheres, cylinders] = &occluders.lists[light_idx];
    let segment = Segment {
        w: *w,
        a,
        distance,
        error: distance.mul_add(L::splat(4.0 * L::U), at.point_error),
        height: at.point[1],
        light_height: light.position[1],
    };
    let tau = distance * segment.error;
    let mut n_tested = 0;
    for &i in spheres {
        n_tested += 1;
        let sphere = &light.spheres[i as usize];
        let b = dot(*w, splat_each(sphere.m));
        let discriminant = b.mul_add(b, -(a * L::splat(sphere.power)));
        let slack = tau * L::splat(sphere.slack);
        let mut near = open & discriminant.ge(-slack);
        if occluders.is_shared {
            near = near & !at.equation.eq(L::splat(sphere.equation));
        }
        if near.any() {
            let (blocked, doubt) = behind_sphere(sphere, &segment, b, discriminant, slack);
            vague = vague | (near & doubt);
            open = open & !(near & blocked);
            if !open.any() {
                return (facing, vague & open, n_tested);
            }
        }
    }
    for &i in cylinders {
        n_tested += 1;
        let cylinder = &light.cylinders[i as usize];
        let (blocked, doubt) = behind_cylinder(cylinder, &segment, tau, open);
        vague = vague | doubt;
        open = open & !blocked;
        if !open.any() {
            break;
        }
    }
    // A doubt about one object does not matter where another surely hides the light.
    (facing & !open, vague & open, n_tested)
}

/// A packet of segments from a light.
struct Segment<L> {
    w: [L; 3],
    a: L,
    distance: L,
    /// Of the end, with roundings.
    error: L,
    /// Of the end.
    height: L,
    light_height: f64,
}

/// Tells which segments whose line may meet a sphere surely do, and which may or may not.
#[inline(always)]
fn behind_sphere<L: Lanes>(
    sphere: &Occluder,
    segment: &Segment<L>,
    b: L,
    discriminant: L,
    slack: L,
) -> (L::Mask, L::Mask) {
    let none = L::Mask::from_bits(0);
    match sphere.side {
        Side::Outside => {}
        Side::Within => {
            // The power of the end, a − 2b + p, is off by at most as much as D and twice a.
            let power = segment.a - b - b + L::splat(sphere.power);
            let sure = segment.error * (L::splat(sphere.m_length) + segment.distance) * L::splat(4.0);
            let blocked = power.gt(sure + L::splat(8.0 * L::U * sphere.power.abs()));
            return (blocked, !blocked);
        }
        Side::InLine | Side::Open | Side::Closed | Side::Unknown => return (none, !none),
    }
    let b_slack = segment.error * segment.distance.mul_add(L::splat(2.0), L::splat(sphere.m_length));
    let beyond = b - segment.a;
    let free = b.lt(-b_slack) | beyond.gt(b_slack);
    let blocked = discriminant.gt(slack) & b.gt(b_slack) & beyond.lt(-b_slack);
    (blocked, !(free | blocked))
}

/// Tells which of the open segments surely meet a cylinder, and which may or may not.
#[inline(always)]
fn behind_cylinder<L: Lanes>(cylinder: &Occluder, segment: &Segment<L>, tau: L, open: L::Mask) -> (L::Mask, L::Mask) {
    let none = L::Mask::from_bits(0);
    if !matches!(cylinder.side, Side::Outside | Side::InLine) {
        return (none, open);
    }
    let (y_min, y_max) = (L::splat(cylinder.y_min), L::splat(cylinder.y_max));
    let light_height = L::splat(segment.light_height);
    // Both ends beyond the same cap.
    let mut passes = none;
    if segment.light_height >= cylinder.y_max {
        passes = segment.height.gt(y_max + segment.error);
    } else if segment.light_height <= cylinder.y_min {
        passes = segment.height.lt(y_min - segment.error);
    }
    let [wx, wy, wz] = segment.w;
    let b = wx * L::splat(cylinder.m[0]) + wz * L::splat(cylinder.m[2]);
    let a = wx * wx + wz * wz;
    let slack = tau * L::splat(cylinder.slack);
    let b_slack = segment.error * (L::splat(cylinder.m_length) + segment.distance * L::splat(2.0));
    let discriminant = b * b - a * L::splat(cylinder.power);
    if cylinder.side == Side::Outside {
        passes = passes | discriminant.lt(-slack) | b.lt(-b_slack);
    }
    let near = open & !passes;
    if !near.any() {
        return (none, none);
    }
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    // The part of the segment inside of the infinite wall: from `enter` to `leave`, each off by at most `slip`.
    let is_proper = discriminant.gt(a * L::splat(MIN_WALL_DISCRIMINANT * cylinder.radius_squared))
        & discriminant.gt(slack * L::splat(16.0));
    let root = discriminant.max(zero).sqrt();
    let per_a = one / a;
    let leave = (b + root) * per_a;
    let slip = per_a * (b_slack + slack / root + leave.abs() * tau * L::splat(4.0)) * L::splat(1.5);
    let enter = if cylinder.side == Side::Outside { (b - root) * per_a } else { zero };
    let first = light_height + enter * wy;
    let last = light_height + leave.min(one) * wy;
    let height_slip =
        slip * wy.abs() + (segment.error + L::splat(8.0 * L::U * segment.light_height.abs())) * L::splat(2.0);
    let (floor, ceiling) = (y_min + height_slip, y_max - height_slip);
    let (below, above) = (y_min - height_slip, y_max + height_slip);
    let goes_in_before = enter.lt(one - slip);
    let goes_in_behind = enter.gt(one + slip);
    let meets = if cylinder.side == Side::Outside {
        (first.gt(floor) & first.lt(ceiling))
            | (first.gt(above) & last.lt(ceiling))
            | (first.lt(below) & last.gt(floor))
    } else if segment.light_height > cylinder.y_max {
        last.lt(ceiling)
    } else {
        last.gt(floor)
    };
    let misses = if cylinder.side == Side::Outside {
        goes_in_behind | (first.gt(above) & last.gt(above)) | (first.lt(below) & last.lt(below))
    } else if segment.light_height > cylinder.y_max {
        last.gt(above)
    } else {
        last.lt(below)
    };
    let blocked = near & is_proper & goes_in_before & meets;
    let free = near & is_proper & misses;
    (blocked, near & !(blocked | free))
}
