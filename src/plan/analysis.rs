//! Runs the passes that look at pairs of objects, and leaves out of the scene what they prove idle.

use crate::plan::bodies::Solid;
use crate::plan::bounces::{longest_chain, reflected_lists};
use crate::plan::candidates::ListTable;
use crate::plan::frustum::Frustum;
use crate::plan::objects::{Roles, find_copies};
use crate::plan::report::{Kept, LeftOut, Reason, Report};
use crate::plan::scene::retain_at;
use crate::plan::shadows::find_occluders;
use crate::plan::{Object, Part, Pass, Scene, Settings};

/// Pairs of objects and lights that are looked at however small the image is: they take some tenths of a millisecond.
const MIN_PAIRS: u64 = 1 << 14;

/// Pairs that are looked at however large the image is.
const MAX_PAIRS: u64 = 1 << 20;

/// Pairs for each pixel beyond [`MIN_PAIRS`], so that the passes take a small part of the time of the image.
const PAIRS_PER_PIXEL: u64 = 2;

/// Pixels for each pair for which a plane is looked for, which takes fifty times as long.
const PIXELS_PER_PLANE: u64 = 64;

/// Planes that are looked for however small the image is, and however large.
const N_PLANES: [u64; 2] = [1 << 12, 1 << 18];

/// The most objects, on the average, that a short list of what may lie between an object and a light has.
const MAX_SHORT: usize = 64;

/// What is known of few objects, index for index with the scene, spheres first.
#[derive(Debug)]
pub(super) struct Analysis {
    /// For each object its index in the scene as the `write` shows it.
    names: Vec<Object>,
    pub solids: Vec<Solid>,
    pub roles: Roles,
    /// For each object what its reflected rays can meet.
    pub reflected: Option<ListTable>,
    /// For each object the lights that may add to it.
    pub lights: Option<Vec<Vec<u32>>>,
    /// For each object and light what may lie between.
    pub occluders: Option<ListTable>,
}

/// Finds what no ray needs and leaves it out of the scene; returns what is known of the rest, unless it is too much.
pub(super) fn analyse(
    scene: &mut Scene<'_>,
    fov_deg: f64,
    settings: &Settings,
    report: &mut Report,
) -> Option<Analysis> {
    analyse_pairs(scene, fov_deg, settings, report, max_pairs(settings))
}

/// Does the work of [`analyse`] if there are at most so many pairs.
pub(super) fn analyse_pairs(
    scene: &mut Scene<'_>,
    fov_deg: f64,
    settings: &Settings,
    report: &mut Report,
    max_pairs: u64,
) -> Option<Analysis> {
    let finds_objects = settings.passes.contains(Pass::Objects);
    let copies = if finds_objects { find_copies(scene) } else { vec![false; scene.n_objects()] };
    let has_copies = copies.contains(&true);
    let n_left = copies.iter().filter(|is_copy| !**is_copy).count() as u64;
    let n_pairs = n_left.pow(2).saturating_mul(1 + scene.lights.len() as u64);
    let is_small = n_pairs <= max_pairs;
    if !is_small && !has_copies {
        return None;
    }
    let mut names: Vec<_> = scene.objects().collect();
    if has_copies {
        let copied = |i: &usize| copies[*i];
        report
            .left_out
            .extend((0..names.len()).filter(copied).map(|i| LeftOut { object: names[i], reason: Reason::Copy }));
        scene.retain(|i| !copies[i]);
        retain_at(&mut names, |i| !copies[i]);
    }
    is_small.then(|| Analysis::new(scene, names, fov_deg, settings, report))
}

/// Returns how many pairs are worth looking at for an image.
fn max_pairs(settings: &Settings) -> u64 {
    n_samples(settings).saturating_mul(PAIRS_PER_PIXEL).clamp(MIN_PAIRS, MAX_PAIRS)
}

/// Returns how many eye rays an image has.
fn n_samples(settings: &Settings) -> u64 {
    let n_pixels = u64::from(settings.size.width()) * u64::from(settings.size.height());
    n_pixels * u64::from(settings.samples).pow(2)
}

impl Analysis {
    fn new(scene: &mut Scene<'_>, names: Vec<Object>, fov_deg: f64, settings: &Settings, report: &mut Report) -> Self {
        let Settings { part, passes, .. } = *settings;
        let finds_objects = passes.contains(Pass::Objects);
        let solids: Vec<_> = scene.objects().map(|object| scene.solid(object)).collect();
        let roles = if finds_objects {
            Roles::new(scene, &solids, &Frustum::new(fov_deg, settings), part)
        } else {
            Roles::unknown(scene, part)
        };
        let mut known = Self { names, solids, roles, reflected: None, lights: None, occluders: None };
        known.leave_out_hidden(scene, report);
        if passes.contains(Pass::Bounces) {
            known.reflected = Some(reflected_lists(&known.solids, &known.roles, known.n_spheres()));
        }
        if passes.contains(Pass::Shadows) {
            let max_planes = (n_samples(settings) / PIXELS_PER_PLANE).clamp(N_PLANES[0], N_PLANES[1]);
            let shadows = find_occluders(scene, &known.solids, &known.roles, settings, max_planes);
            known.lights = Some(shadows.lights);
            known.occluders = Some(shadows.occluders);
        }
        if finds_objects {
            known.leave_out_unreached(scene, part, report);
        }
        known
    }

    /// Returns for each object its index in the scene as the `write` shows it.
    pub fn names(&self) -> &[Object] {
        &self.names
    }

    /// Returns how many of the objects are spheres.
    fn n_spheres(&self) -> usize {
        self.names.iter().filter(|name| matches!(name, Object::Sphere(_))).count()
    }

    fn leave_out_hidden(&mut self, scene: &mut Scene<'_>, report: &mut Report) {
        let hidden: Vec<_> = self.roles.hidden_in.iter().map(|outer| outer.map(|i| self.names[i])).collect();
        let reason = |i: usize| hidden[i].map(Reason::Inside);
        self.leave_out(scene, report, reason);
    }

    /// Leaves out what neither eye rays nor reflected rays meet, and what is on nobody's way to a light.
    fn leave_out_unreached(&mut self, scene: &mut Scene<'_>, part: Part, report: &mut Report) {
        let mut is_used: Vec<_> = (0..self.names.len()).map(|i| self.roles.is_met(i)).collect();
        match &self.occluders {
            Some(occluders) => {
                (0..occluders.len()).flat_map(|list| occluders.objects(list)).for_each(|i| is_used[i] = true)
            }
            None if part == Part::A => {}
            None => return,
        }
        self.leave_out(scene, report, |i| (!is_used[i]).then_some(Reason::OutOfReach));
    }

    fn leave_out(&mut self, scene: &mut Scene<'_>, report: &mut Report, reason: impl Fn(usize) -> Option<Reason>) {
        let reasons: Vec<_> = (0..self.names.len()).map(reason).collect();
        let found = self.names.iter().zip(&reasons);
        report.left_out.extend(found.filter_map(|(&object, reason)| reason.map(|reason| LeftOut { object, reason })));
        let keep = |i: usize| reasons[i].is_none();
        scene.retain(keep);
        for table in [&mut self.reflected, &mut self.occluders].into_iter().flatten() {
            table.retain(reasons.len(), keep);
        }
        if let Some(lights) = &mut self.lights {
            retain_at(lights, keep);
        }
        retain_at(&mut self.names, keep);
        retain_at(&mut self.solids, keep);
        self.roles.retain(keep);
    }

    /// Tells whether little is left, on the average, that may lie between an object and a light.
    pub fn lists_are_short(&self) -> bool {
        self.occluders.as_ref().is_some_and(|lists| lists.n_entries() <= MAX_SHORT * lists.len())
    }

    /// Returns the most reflections that an eye ray can have; `None` is unbounded.
    pub fn max_bounces(&self) -> Option<u32> {
        match &self.reflected {
            Some(lists) => longest_chain(lists, &self.roles),
            None => (!self.roles.is_mirror.contains(&true)).then_some(0),
        }
    }

    /// Returns what is known of the objects, by their names.
    pub fn describe(&self, n_lights: usize) -> Vec<Kept> {
        let named = |table: &ListTable, list: usize| table.objects(list).map(|i| self.names[i]).collect();
        let reflects = |i: usize| self.reflected.as_ref().map(|table| named(table, i));
        let lights = |i: usize| {
            let (Some(lights), Some(occluders)) = (&self.lights, &self.occluders) else { return Vec::new() };
            let between = |&light: &u32| (light, named(occluders, i * n_lights + light as usize));
            lights[i].iter().map(between).collect()
        };
        let describe = |i: usize| Kept {
            object: self.names[i],
            is_seen: self.roles.seen[i],
            is_sealed: self.roles.sealed[i],
            reflects: if self.roles.is_mirror[i] { reflects(i) } else { None },
            lights: lights(i),
        };
        (0..self.names.len()).map(describe).collect()
    }
}
