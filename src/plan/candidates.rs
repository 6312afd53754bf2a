//! Lists of objects that a ray may meet.

use rayon::prelude::*;

use crate::plan::Scene;
use crate::plan::scene::retain_at;

/// An object by its index in [`Scene`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Object {
    /// A sphere.
    Sphere(u32),
    /// A cylinder.
    Cylinder(u32),
}

/// The objects that the rays of a bundle can meet, by their indices in [`Scene`]; what is not listed is
/// proved not to be met.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Candidates<'a> {
    /// Spheres, in an order that the owner of the list promises or not.
    pub spheres: &'a [u32],
    /// Cylinders, likewise.
    pub cylinders: &'a [u32],
}

impl Candidates<'_> {
    /// Returns how many objects are listed.
    #[must_use]
    pub fn len(&self) -> usize {
        self.spheres.len() + self.cylinders.len()
    }

    /// Tells whether no object is listed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.spheres.is_empty() && self.cylinders.is_empty()
    }
}

/// Many lists of objects, one behind the other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct ListTable {
    /// Objects below this, counted spheres first, are spheres.
    n_spheres: usize,
    /// The indices of spheres among spheres and of cylinders among cylinders.
    indices: Vec<u32>,
    /// Where each list starts, where its cylinders start, and where it ends.
    spans: Vec<[u32; 3]>,
}

impl ListTable {
    /// Makes no list.
    pub fn new(n_spheres: usize) -> Self {
        Self { n_spheres, ..Self::default() }
    }

    /// Appends a list of objects counted spheres first, and keeps their order among spheres and among cylinders.
    pub fn push(&mut self, objects: impl Iterator<Item = usize>) {
        let start = self.indices.len() as u32;
        let mut cylinders = Vec::new();
        for object in objects {
            match object.checked_sub(self.n_spheres) {
                None => self.indices.push(object as u32),
                Some(cylinder) => cylinders.push(cylinder as u32),
            }
        }
        let middle = self.indices.len() as u32;
        self.indices.extend(cylinders);
        self.spans.push([start, middle, self.indices.len() as u32]);
    }

    /// Returns a list.
    pub fn get(&self, list_idx: usize) -> Candidates<'_> {
        let [start, middle, end] = self.spans[list_idx].map(|at| at as usize);
        Candidates { spheres: &self.indices[start..middle], cylinders: &self.indices[middle..end] }
    }

    /// Returns the objects of a list, counted spheres first.
    pub fn objects(&self, list_idx: usize) -> impl Iterator<Item = usize> + '_ {
        let Candidates { spheres, cylinders } = self.get(list_idx);
        let cylinders = cylinders.iter().map(|&i| i as usize + self.n_spheres);
        spheres.iter().map(|&i| i as usize).chain(cylinders)
    }

    /// Returns the number of lists.
    pub fn len(&self) -> usize {
        self.spans.len()
    }

    /// Returns how many objects all lists have together.
    pub fn n_entries(&self) -> usize {
        self.indices.len()
    }

    /// Leaves out objects that are in no list, and renumbers the others; each object has as many lists of its own, in the
    /// order of the objects, which go with it.
    pub fn retain(&mut self, n_objects: usize, keep: impl Fn(usize) -> bool) {
        let per_object = self.spans.len() / n_objects.max(1);
        let mut old = std::mem::take(self);
        retain_at(&mut old.spans, |list| keep(list / per_object));
        let mut n_kept = 0;
        let place = |i: usize| {
            n_kept += usize::from(keep(i));
            n_kept.saturating_sub(1)
        };
        let places: Vec<_> = (0..n_objects).map(place).collect();
        *self = Self::new((0..old.n_spheres).filter(|&i| keep(i)).count());
        (0..old.spans.len()).for_each(|list| self.push(old.objects(list).map(|i| places[i])));
    }
}

/// Indices that a thread writes at a time.
const INDICES_PER_TASK: usize = 1 << 16;

/// Owned lists of objects.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ObjectLists {
    /// Spheres.
    pub spheres: Vec<u32>,
    /// Cylinders.
    pub cylinders: Vec<u32>,
}

impl ObjectLists {
    /// Lists all objects of a scene.
    pub(super) fn everything(scene: &Scene<'_>) -> Self {
        let all = |n: usize| (0..n as u32).into_par_iter().with_min_len(INDICES_PER_TASK).collect();
        Self { spheres: all(scene.sphere_primitives.len()), cylinders: all(scene.cylinder_primitives.len()) }
    }

    /// Lists the objects of a scene, counted spheres first, that `has` names.
    pub(super) fn of_all(scene: &Scene<'_>, has: impl Fn(usize) -> bool) -> Self {
        let n_spheres = scene.sphere_primitives.len();
        let n_cylinders = scene.cylinder_primitives.len();
        Self {
            spheres: (0..n_spheres as u32).filter(|&i| has(i as usize)).collect(),
            cylinders: (0..n_cylinders as u32).filter(|&i| has(n_spheres + i as usize)).collect(),
        }
    }

    /// Leaves out everything.
    pub fn clear(&mut self) {
        self.spheres.clear();
        self.cylinders.clear();
    }

    /// Adds an object.
    pub fn push(&mut self, object: Object) {
        match object {
            Object::Sphere(i) => self.spheres.push(i),
            Object::Cylinder(i) => self.cylinders.push(i),
        }
    }

    /// Returns the lists as candidates.
    #[must_use]
    pub fn as_candidates(&self) -> Candidates<'_> {
        Candidates { spheres: &self.spheres, cylinders: &self.cylinders }
    }
}
