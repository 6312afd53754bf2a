//! Scenes of many objects: what a packet needs is looked up and worked out when it is needed.
//!
//! A packet of reflected rays meets what the plan's trees find along its lanes, and a packet of hits is shaded among what the
//! plan's grids find between its lanes and each light.
//!
//! Of some thousands of objects all constants are in tables, as for few. Tables of more would take longer to make than the
//! image, and most of memory. So a tile works out the constants of its own candidates, and a packet those of what is found
//! for it. Objects have then numbers in these small tables; what is done with them is the same.

use crate::plan::{Candidates, CubeFace, Look, Object, ObjectLists, Part, Plan, Scene, SearchRay, Slopes};
use crate::trace::kernels::{Lanes, Mask, prefetch};
use crate::trace::look_up::{self, SideBySide};
use crate::trace::reject::PlainRay;
use crate::trace::wide::bounds::{Bounds, Face, Side, WideLight, cylinder_from, is_around_eye, sphere_from};
use crate::trace::wide::eye::MAX_LANES;
use crate::trace::wide::queue::Rays;
use crate::trace::wide::shade::{Points, dot};
use crate::trace::wide::shadow::{LightOccluders, is_behind_cap};

/// Fewer lanes are looked up one by one.
const MIN_TOGETHER: u32 = 3;

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
    /// Unless they are known of all objects.
    lights: Vec<WideLight>,
    pub occluders: LightOccluders,
    /// Of each light what was found, and where.
    found: Vec<ObjectLists>,
    looks: Vec<(usize, Look)>,
}

impl Around {
    /// Looks up what may lie between points of a face and each light that they face; `false` when that is not to be had.
    #[inline(always)]
    pub fn look_up<L: Lanes>(&mut self, all: &Bounds, plan: &Plan<'_>, face: &Face, at: &Points<L>) -> bool {
        self.looks.clear();
        // All lights are looked at first, so that memory is waited for once.
        let surface = &plan.scene.surfaces[face.surface];
        let needs_look = |light_idx: &usize| plan.settings.part == Part::B && plan.adds(surface, *light_idx);
        for light_idx in (0..all.lights.len()).filter(needs_look) {
            let light = all.lights[light_idx].position;
            let w =
                [at.point[0] - L::splat(light[0]), at.point[1] - L::splat(light[1]), at.point[2] - L::splat(light[2])];
            // Lanes that may or may not face the light are not shaded.
            let facing = at.active & dot(at.normal, w).lt(L::splat(0.0));
            if !facing.any() {
                continue;
            }
            let off = at.point_error + w[0].abs().max(w[1].abs()).max(w[2].abs()) * L::splat(2.0 * L::U);
            let together = (facing.bits().count_ones() >= MIN_TOGETHER)
                .then(|| look_at_once(plan, light_idx, &w, off, facing))
                .flatten();
            match together {
                Some(look) => self.looks.push((light_idx, look)),
                None => {
                    let mut numbers = [[0.0; MAX_LANES]; 4];
                    for (lanes, numbers) in [w[0], w[1], w[2], off].into_iter().zip(&mut numbers) {
                        lanes.store(numbers);
                    }
                    if !self.look_one_by_one(plan, light_idx, &numbers, facing.bits()) {
                        return false;
                    }
                }
            }
        }
        self.find(all, plan, face);
        true
    }

    /// Looks from a light to each of some points. `numbers`: of each lane the way there, and how far it is off.
    fn look_one_by_one(
        &mut self,
        plan: &Plan<'_>,
        light_idx: usize,
        numbers: &[[f64; MAX_LANES]; 4],
        lanes: u32,
    ) -> bool {
        let [x, y, z, off] = numbers;
        let points = (0..MAX_LANES).filter(|k| lanes >> k & 1 != 0).map(|k| ([x[k], y[k], z[k]], off[k]));
        plan.looks_from(light_idx, points, |look| self.looks.push((light_idx, look))).is_some()
    }

    /// Finds what may lie where was looked.
    fn find(&mut self, all: &Bounds, plan: &Plan<'_>, face: &Face) {
        self.lights.resize_with(all.lights.len(), || WideLight {
            position: [0.0; 3],
            spheres: Vec::new(),
            cylinders: Vec::new(),
        });
        self.found.resize_with(all.lights.len(), ObjectLists::default);
        self.found.iter_mut().for_each(ObjectLists::clear);
        plan.expect_looks::<SideBySide<()>>(&self.looks);
        for (light_idx, look) in &self.looks {
            let ObjectLists { spheres, cylinders } = &mut self.found[*light_idx];
            plan.visit_look(*light_idx, look, |object| match object {
                Object::Sphere(i) if !spheres.contains(&i) => {
                    if !all.has_objects {
                        expect_sphere(&plan.scene, i);
                    }
                    spheres.push(i);
                }
                Object::Cylinder(i) if !cylinders.contains(&i) => cylinders.push(i),
                _ => {}
            });
        }
        for (light_idx, light) in all.lights.iter().enumerate() {
            if all.has_objects {
                self.pick(plan, face, light_idx, light);
            } else {
                self.tabulate(plan, face, light_idx, light.position);
            }
        }
    }

    /// Lists those found that can hide a light, given what all objects are to it, as in [`LightOccluders::new`].
    fn pick(&mut self, plan: &Plan<'_>, face: &Face, light_idx: usize, light: &WideLight) {
        let (scene, found) = (&plan.scene, &self.found[light_idx]);
        let is_left =
            |i: &u32| light.spheres[*i as usize].equation == f64::from(face.equation) && face.per_radius > 0.0;
        let others = || found.spheres.iter().copied().filter(|i| !is_left(i));
        let is_idle = !plan.adds(&scene.surfaces[face.surface], light_idx);
        let is_hidden = is_idle || others().any(|i| light.spheres[i as usize].side == Side::Closed);
        let spheres = others().filter(|&i| light.spheres[i as usize].side != Side::Open);
        let cylinders = found.cylinders.iter().copied().filter(|&i| {
            !is_left_wall(scene, face, i) && !is_behind_cap(&light.cylinders[i as usize], light.position[1], face)
        });
        self.occluders.list(light_idx, is_hidden, spheres, cylinders);
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
        let is_idle = !plan.adds(&scene.surfaces[face.surface], light_idx);
        let is_hidden = is_idle || spheres.iter().any(|sphere| sphere.side == Side::Closed);
        spheres.retain(|sphere| sphere.side != Side::Open);
        cylinders.clear();
        let others = found.cylinders.iter().filter(|i| !is_left_wall(scene, face, **i));
        cylinders.extend(others.map(|&i| cylinder_from(scene, position, i as usize)));
        cylinders.retain(|cylinder| !is_behind_cap(cylinder, position[1], face));
        let WideLight { spheres, cylinders, .. } = &self.lights[light_idx];
        self.occluders.list(light_idx, is_hidden, 0..spheres.len() as u32, 0..cylinders.len() as u32);
    }

    /// Returns the lights with what the lists name.
    #[inline(always)]
    pub fn lights<'a>(&'a self, all: &'a Bounds) -> &'a [WideLight] {
        if all.has_objects { &all.lights } else { &self.lights }
    }
}

/// Tells whether a face belongs to a cylinder, or to a wall with its equation.
fn is_left_wall(scene: &Scene<'_>, face: &Face, i: u32) -> bool {
    face.object == Object::Cylinder(i) || scene.wall_equations[i as usize].number() == face.equation
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

/// Returns where to look for what lies between a light and the lanes of the mask, of which there is one, if the light sees all of
/// them in about one direction.
///
/// `w`: from the light to each, and `off`: how far it is off.
#[inline(always)]
fn look_at_once<L: Lanes>(plan: &Plan<'_>, light_idx: usize, w: &[L; 3], off: L, lanes: L::Mask) -> Option<Look> {
    let mut numbers = [[0.0; MAX_LANES]; 5];
    for k in 0..3 {
        w[k].store(&mut numbers[k]);
    }
    let first = lanes.bits().trailing_zeros() as usize % MAX_LANES;
    let face = CubeFace::toward([numbers[0][first], numbers[1][first], numbers[2][first]]);
    let [u, v, ahead] = face.look(*w);
    let is_sound = ahead.ge(u.abs())
        & ahead.ge(v.abs())
        & ahead.ge(off * L::splat(Look::MIN_PRECISION))
        & ahead.ge(L::splat(Look::SHORTEST))
        & ahead.lt(L::splat(f64::INFINITY));
    if (lanes & !is_sound).any() {
        return None;
    }
    let seen = Slopes::new([u, v, ahead], off, L::U, L::splat);
    let all = [-seen.low[0], -seen.low[1], seen.high[0], seen.high[1], seen.far];
    let mut most = [f64::NEG_INFINITY; 5];
    for k in 0..5 {
        L::select(lanes, all[k], L::splat(f64::NEG_INFINITY)).store(&mut numbers[k]);
        for lane in 0..L::N {
            most[k] = if numbers[k][lane] > most[k] { numbers[k][lane] } else { most[k] };
        }
    }
    let [low_u, low_v, high_u, high_v, far] = most;
    plan.look_at_once(light_idx, face, Slopes { low: [-low_u, -low_v], high: [high_u, high_v], far })
}

/// Finds what a packet of reflected rays may meet; `false` when that is not to be had, or too much.
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

/// Adds what one ray may meet, as [`find_along`].
#[inline(always)]
fn find_along_one<L: Lanes>(plan: &Plan<'_>, ray: &SearchRay, leaving: f64, found: &mut ObjectLists) -> bool {
    let SearchRay { origin, dir, origin_error, dir_error } = *ray;
    let plain = PlainRay { origin, dir, origin_error, origin_y_error: origin_error, dir_error };
    let scene = &plan.scene;
    let mut matters = f64::INFINITY;
    let mut is_too_much = false;
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
            if list.len() == look_up::MANY {
                is_too_much = true;
                return f64::NEG_INFINITY;
            }
            list.push(i);
        }
        if is_sphere && !is_left {
            matters = matters.min(look_up::met_before(&plain, scene, i as usize));
        }
        matters
    });
    seen.is_some() && !is_too_much
}
