//! Lists of objects that a ray may meet.

/// An object by its index in [`Scene`](crate::plan::Scene).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Object {
    /// A sphere.
    Sphere(u32),
    /// A cylinder.
    Cylinder(u32),
}

/// The objects that the rays of a bundle can meet, by their indices in [`Scene`](crate::plan::Scene); what is not listed is
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

/// Owned lists of objects.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ObjectLists {
    /// Spheres.
    pub spheres: Vec<u32>,
    /// Cylinders.
    pub cylinders: Vec<u32>,
}

impl ObjectLists {
    /// Returns the lists as candidates.
    #[must_use]
    pub fn as_candidates(&self) -> Candidates<'_> {
        Candidates { spheres: &self.spheres, cylinders: &self.cylinders }
    }
}
