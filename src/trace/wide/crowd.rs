//! Scenes of many objects: what a packet needs is looked up and worked out when it is needed.
//!
//! Tables for each object and light, as for few objects, would take longer to make than the image, and most of memory. So
//! a tile works out the constants of its own candidates, a packet of reflected rays those of what the plan's trees find
//! along its lanes, and a packet of hits those of what the plan's grids find between its lanes and each light. Objects have
//! then numbers in these small tables; what is done with them is the same as for few.

use crate::plan::{Candidates, Look, Object, ObjectLists, Part, Plan, Scene, SearchRay};
use crate::trace::kernels::{Lanes, Mask, prefetch};
use crate::trace::look_up::{self, SideBySide};
use crate::trace::reject::PlainRay;
use crate::trace::wide::bounds::{Bounds, Face, Side, U, WideLight, cylinder_from, is_around_eye, sphere_from};
use crate::trace::wide::eye::MAX_LANES;
use crate::trace::wide::queue::Rays;
use crate::trace::wide::shade::Points;
use crate::trace::wide::shadow::{LightOccluders, is_behind_cap};

/// The tables of one tile or packet, and the numbers of all objects in it.
#[derive(Debug)]
pub(super) struct Few {
    pub bounds: Bounds,
    numbers: Vec<u32>,
}

impl Few {
    /// Works out the tables of these objects; `None` when one is left to finer arithmetic.
    pub fn new(all: &Bounds, plan: &Plan<'_>, some: Candidates<'_>) -> Option<Self> {
        some.spheres.iter().for_each(|&i| expect_sphere(&plan.scene, i));
        let longest = some.spheres.len().max(some.cylinders.len());
        Some(Self { bounds: all.of_some(plan, some)?, numbers: (0..longest as u32).collect() })
    }

    /// Returns all objects by their numbers.
    pub fn candidates(&self) -> Candidates<'_> {
        let Bounds { spheres, cylinders, .. } = &self.bounds;
        Candidates { spheres: &self.numbers[..spheres.len()], cylinders: &self.numbers[..cylinders.len()] }
    }
}

/// What may hide the lights from a packet of points.
#[derive(Debug, Default)]
pub(super) struct Around {
    pub lights: Vec<WideLight>,
    pub occluders: LightOccluders,
    /// Of each light what was found, and where.
    found: Vec<ObjectLists>,
    looks: Vec<(usize, Look)>,
}

impl Around {
    /// Looks up what may lie between points of a face and each light that they face; `false` when that is not to be had.
    #[inline(always)]
    pub fn look_up<L: Lanes>(&mut self, all: &Bounds, plan: &Plan<'_>, face: &Face, at: &Points<L>) -> bool {
        let mut numbers = [[0.0; MAX_LANES]; 7];
        let lanes = [at.point[0], at.point[1], at.point[2], at.normal[0], at.normal[1], at.normal[2], at.point_error];
        for k in 0..lanes.len() {
            lanes[k].store(&mut numbers[k]);
        }
        self.look_up_lanes(all, plan, face, &numbers, at.active.bits())
    }

    /// Does the work of [`Around::look_up`]. `numbers`: of each lane its point, normal and the error of the point.
    fn look_up_lanes(
        &mut self,
        all: &Bounds,
        plan: &Plan<'_>,
        face: &Face,
        numbers: &[[f64; MAX_LANES]; 7],
        active: u32,
    ) -> bool {
        self.lights.resize_with(all.lights.len(), || WideLight {
            position: [0.0; 3],
            spheres: Vec::new(),
            cylinders: Vec::new(),
        });
        self.found.resize_with(all.lights.len(), ObjectLists::default);
        self.found.iter_mut().for_each(ObjectLists::clear);
        self.looks.clear();
        // All lights are looked at first, so that memory is waited for once.
        for light_idx in (0..all.lights.len()).filter(|_| plan.settings.part == Part::B) {
            let points = facing(all.lights[light_idx].position, numbers, active);
            if plan.looks_from(light_idx, points, |look| self.looks.push((light_idx, look))).is_none() {
                return false;
            }
        }
        plan.expect_looks::<SideBySide<()>>(&self.looks);
        for (light_idx, look) in &self.looks {
            let ObjectLists { spheres, cylinders } = &mut self.found[*light_idx];
            plan.visit_look(*light_idx, look, |object| match object {
                Object::Sphere(i) if !spheres.contains(&i) => {
                    expect_sphere(&plan.scene, i);
                    spheres.push(i);
                }
                Object::Cylinder(i) if !cylinders.contains(&i) => cylinders.push(i),
                _ => {}
            });
        }
        for light_idx in 0..all.lights.len() {
            self.tabulate(plan, face, light_idx, all.lights[light_idx].position);
        }
        true
    }

    /// Works out what those found are to a light; what cannot hide it is left out, as in [`LightOccluders::new`].
    fn tabulate(&mut self, plan: &Plan<'_>, face: &Face, light_idx: usize, position: [f64; 3]) {
        let WideLight { position: its_position, spheres, cylinders } = &mut self.lights[light_idx];
        *its_position = position;
        let (scene, found) = (&plan.scene, &self.found[light_idx]);
        let is_left = |i: &u32| scene.sphere_equations[*i as usize].number() == face.equation && face.per_radius > 0.0;
        spheres.clear();
        let others = found.spheres.iter().filter(|i| !is_left(i));
        spheres.extend(others.map(|&i| sphere_from(scene, position, i as usize)));
        let is_hidden = spheres.iter().any(|sphere| sphere.side == Side::Closed);
        spheres.retain(|sphere| sphere.side != Side::Open);
        let is_left = |i: &u32| {
            face.object == Object::Cylinder(*i) || scene.wall_equations[*i as usize].number() == face.equation
        };
        cylinders.clear();
        let others = found.cylinders.iter().filter(|i| !is_left(i));
        cylinders.extend(others.map(|&i| cylinder_from(scene, position, i as usize)));
        cylinders.retain(|cylinder| !is_behind_cap(cylinder, position[1], face));
        self.occluders.number(light_idx, &self.lights[light_idx], is_hidden);
    }
}

/// Asks for what is known of a sphere.
fn expect_sphere(scene: &Scene<'_>, i: u32) {
    let (spheres, i) = (&scene.spheres, i as usize);
    for lane in [&spheres.x, &spheres.y, &spheres.z, &spheres.radius] {
        prefetch(lane, i);
    }
    prefetch(&scene.sphere_equations, i);
    prefetch(&scene.sphere_primitives, i);
}

/// Returns the way from a light to each of the active points that face it, and how far it is off. Lanes that may or may
/// not face the light are not shaded.
fn facing(light: [f64; 3], numbers: &[[f64; MAX_LANES]; 7], active: u32) -> impl Iterator<Item = ([f64; 3], f64)> {
    (0..MAX_LANES).filter(move |k| active >> k & 1 != 0).filter_map(move |k| {
        let [x, y, z, nx, ny, nz, error] = numbers;
        let w = [x[k] - light[0], y[k] - light[1], z[k] - light[2]];
        let off = error[k] + 2.0 * U * w[0].abs().max(w[1].abs()).max(w[2].abs());
        (nx[k] * w[0] + ny[k] * w[1] + nz[k] * w[2] < 0.0).then_some((w, off))
    })
}

/// Finds what a packet of reflected rays may meet; `false` when that is not to be had.
#[inline(always)]
pub(super) fn find_along<L: Lanes>(plan: &Plan<'_>, rays: &Rays<L>, active: L::Mask, found: &mut ObjectLists) -> bool {
    let mut numbers = [[0.0; MAX_LANES]; 9];
    let lanes = [
        rays.origin[0],
        rays.origin[1],
        rays.origin[2],
        rays.dir[0],
        rays.dir[1],
        rays.dir[2],
        rays.origin_error,
        rays.dir_error,
        rays.leaving,
    ];
    for k in 0..lanes.len() {
        lanes[k].store(&mut numbers[k]);
    }
    found.clear();
    let mut rest = active.bits();
    while rest != 0 {
        let k = rest.trailing_zeros() as usize;
        rest &= rest - 1;
        let [ox, oy, oz, dx, dy, dz, origin_error, dir_error, leaving] = numbers.map(|lanes| lanes[k]);
        let (origin, dir) = ([ox, oy, oz], [dx, dy, dz]);
        let ray = SearchRay { origin, dir, origin_error, dir_error };
        if !find_along_one::<L>(plan, &ray, leaving, found) {
            return false;
        }
    }
    true
}

/// Adds what one ray may meet.
#[inline(always)]
fn find_along_one<L: Lanes>(plan: &Plan<'_>, ray: &SearchRay, leaving: f64, found: &mut ObjectLists) -> bool {
    let SearchRay { origin, dir, origin_error, dir_error } = *ray;
    let plain = PlainRay { origin, dir, origin_error, origin_y_error: origin_error, dir_error };
    let scene = &plan.scene;
    let mut matters = f64::INFINITY;
    let seen = plan.visit_along::<SideBySide<L::Single>>(ray, |object| {
        let (list, i) = match object {
            Object::Sphere(i) => (&mut found.spheres, i),
            Object::Cylinder(i) => (&mut found.cylinders, i),
        };
        let is_sphere = matches!(object, Object::Sphere(_));
        let is_left = is_sphere && f64::from(scene.sphere_equations[i as usize].number()) == leaving;
        // A sphere that is left outward is not met again.
        if is_left && !is_around_eye(scene, i as usize) {
            return matters;
        }
        if !list.contains(&i) {
            list.push(i);
        }
        if is_sphere && !is_left {
            matters = matters.min(look_up::met_before(&plain, scene, i as usize));
        }
        matters
    });
    seen.is_some()
}
