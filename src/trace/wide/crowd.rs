//! Scenes of many spheres: what a packet needs is looked up and worked out when it is needed.
//!
//! Tables for each object and light, as for few objects, would take longer to make than the image, and most of memory. So
//! a tile works out the constants of its own candidates, a packet of reflected rays those of what the plan's trees find
//! along its lanes, and a packet of hits those of what the plan's grids find between its lanes and each light. Objects have
//! then numbers in these small tables; what is done with them is the same as for few.

use crate::plan::{Candidates, Object, Part, Plan, SearchRay};
use crate::trace::kernels::{Lanes, Mask};
use crate::trace::look_up;
use crate::trace::reject::PlainRay;
use crate::trace::wide::bounds::{Bounds, Face, U, WideLight, sphere_from};
use crate::trace::wide::eye::MAX_LANES;
use crate::trace::wide::queue::Rays;
use crate::trace::wide::shade::Points;
use crate::trace::wide::shadow::LightOccluders;

/// The tables of one tile or packet, and the numbers of all objects in it.
#[derive(Debug)]
pub(super) struct Few {
    pub bounds: Bounds,
    numbers: Vec<u32>,
}

impl Few {
    /// Works out the tables of these spheres; `None` when one is left to finer arithmetic.
    pub fn new(all: &Bounds, plan: &Plan<'_>, spheres: &[u32]) -> Option<Self> {
        Some(Self { bounds: all.of_spheres(plan, spheres)?, numbers: (0..spheres.len() as u32).collect() })
    }

    /// Returns all objects by their numbers.
    pub fn candidates(&self) -> Candidates<'_> {
        Candidates { spheres: &self.numbers, cylinders: &[] }
    }
}

/// What may hide the lights from a packet of points.
#[derive(Debug, Default)]
pub(super) struct Around {
    pub lights: Vec<WideLight>,
    pub occluders: LightOccluders,
    found: Vec<u32>,
}

impl Around {
    /// Looks up what may lie between points of a face and each light that they face; `false` when that is not to be had.
    #[inline(always)]
    pub fn look_up<L: Lanes>(&mut self, all: &Bounds, plan: &Plan<'_>, face: &Face, at: &Points<L>) -> bool {
        let [mut x, mut y, mut z] = [[0.0; MAX_LANES]; 3];
        let [mut nx, mut ny, mut nz] = [[0.0; MAX_LANES]; 3];
        let mut error = [0.0; MAX_LANES];
        at.point[0].store(&mut x);
        at.point[1].store(&mut y);
        at.point[2].store(&mut z);
        at.normal[0].store(&mut nx);
        at.normal[1].store(&mut ny);
        at.normal[2].store(&mut nz);
        at.point_error.store(&mut error);
        self.lights.resize_with(all.lights.len(), || WideLight {
            position: [0.0; 3],
            spheres: Vec::new(),
            cylinders: Vec::new(),
        });
        for light_idx in 0..all.lights.len() {
            let [lx, ly, lz] = all.lights[light_idx].position;
            self.found.clear();
            let mut rest = if plan.settings.part == Part::A { 0 } else { at.active.bits() };
            while rest != 0 {
                let k = rest.trailing_zeros() as usize;
                rest &= rest - 1;
                let w = [x[k] - lx, y[k] - ly, z[k] - lz];
                // Lanes that may or may not face the light are not shaded.
                if -(nx[k] * w[0] + ny[k] * w[1] + nz[k] * w[2]) <= 0.0 {
                    continue;
                }
                let off = error[k] + 2.0 * U * w[0].abs().max(w[1].abs()).max(w[2].abs());
                if !self.look_between(plan, face, light_idx, w, off) {
                    return false;
                }
            }
            self.tabulate(plan, light_idx, [lx, ly, lz]);
        }
        true
    }

    /// Adds what may lie between a light and a point to what is found.
    fn look_between(&mut self, plan: &Plan<'_>, face: &Face, light_idx: usize, w: [f64; 3], off: f64) -> bool {
        let found = &mut self.found;
        let seen = plan.visit_between(light_idx, w, off, |object| {
            if let Object::Sphere(i) = object
                && plan.scene.sphere_equations[i as usize].number() != face.equation
                && !found.contains(&i)
            {
                found.push(i);
            }
            false
        });
        seen.is_some()
    }

    /// Works out what those found are to a light.
    fn tabulate(&mut self, plan: &Plan<'_>, light_idx: usize, position: [f64; 3]) {
        let light = &mut self.lights[light_idx];
        light.position = position;
        light.spheres.clear();
        light.spheres.extend(self.found.iter().map(|&i| sphere_from(&plan.scene, position, i as usize)));
        self.occluders.number(light_idx, light.spheres.len() as u32);
    }
}

/// Finds which spheres a packet of reflected rays may meet; `false` when that is not to be had.
#[inline(always)]
pub(super) fn find_along<L: Lanes>(plan: &Plan<'_>, rays: &Rays<L>, active: L::Mask, found: &mut Vec<u32>) -> bool {
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
        if !find_along_one(plan, &ray, leaving, found) {
            return false;
        }
    }
    true
}

/// Adds what one ray may meet.
fn find_along_one(plan: &Plan<'_>, ray: &SearchRay, leaving: f64, found: &mut Vec<u32>) -> bool {
    let SearchRay { origin, dir, origin_error, dir_error } = *ray;
    let plain = PlainRay { origin, dir, origin_error, origin_y_error: origin_error, dir_error };
    let mut matters = f64::INFINITY;
    let seen = plan.visit_along(ray, |object| {
        let Object::Sphere(i) = object else { return matters };
        if f64::from(plan.scene.sphere_equations[i as usize].number()) != leaving {
            if !found.contains(&i) {
                found.push(i);
            }
            matters = matters.min(look_up::met_before(&plain, &plan.scene, i as usize));
        }
        matters
    });
    seen.is_some()
}
