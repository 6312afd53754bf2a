//! Pass `writes`: which pixels of an image are those of an image that the program has rendered before.
//!
//! # Why it is safe
//! Commands only add: with the same field of view and background, a later scene S₂ is an earlier one S₁ with more objects
//! and lights. An object of S₂ is *touched* when it is new, when a new light may add to it, when a new object may lie
//! between it and a light, or when a touched object may be met by its reflected rays. Take an eye ray that, in S₂, can meet
//! untouched objects alone. What it meets is old, so it meets the same in S₁, where less is in its way. The same lights
//! add there: new ones do not, and what blocks the others is old and stands in S₁ too. Its reflected ray again meets
//! untouched objects alone. So its colour is the same, and a tile all of whose candidates are untouched is unchanged.
//! What the plan of S₂ leaves out is needed by no ray of S₂, new or old, and touches nothing; a term that it takes out of a
//! surface adds nothing under fewer lights either.
//!
//! Commands behind the last `write` are never looked at: [`crate::exec::execute`] plans a scene when it comes to a
//! `write`, and nothing it does in between but to note their numbers.

use crate::ir::Registers;
use crate::plan::{Candidates, Object, Part, Pass, Plan, Size};

/// How an image differs from an earlier one of the same program and settings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Changes {
    /// In no pixel.
    Nothing,
    /// In these tiles at most.
    Tiles(TileMask),
    /// Perhaps everywhere.
    Everything,
}

/// A set of tiles of an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TileMask {
    tile_width: u32,
    tile_height: u32,
    n_columns: usize,
    has: Vec<bool>,
}

impl TileMask {
    /// Tells whether the tile of a pixel is in the set.
    #[must_use]
    pub fn contains(&self, column: u32, row: u32) -> bool {
        self.has[(row / self.tile_height) as usize * self.n_columns + (column / self.tile_width) as usize]
    }

    /// Returns how many pixels of an image lie in tiles of the set.
    #[must_use]
    pub fn n_pixels(&self, size: Size) -> u64 {
        let side = |tile: usize, tile_side: u32, side: u32| tile_side.min(side - tile as u32 * tile_side);
        let pixels_of = |tile_idx: usize| {
            let columns = side(tile_idx % self.n_columns, self.tile_width, size.width());
            let rows = side(tile_idx / self.n_columns, self.tile_height, size.height());
            u64::from(columns) * u64::from(rows)
        };
        (0..self.has.len()).filter(|&tile_idx| self.has[tile_idx]).map(pixels_of).sum()
    }

    /// Returns how many tiles the image has.
    #[must_use]
    pub fn n_all_tiles(&self) -> usize {
        self.has.len()
    }

    /// Returns how many tiles are in the set.
    #[must_use]
    pub fn n_tiles(&self) -> usize {
        self.has.iter().filter(|has| **has).count()
    }
}

impl Plan<'_> {
    /// Finds out in which pixels the image differs from that of the same program and settings with `earlier` registers,
    /// those of a `write` before.
    #[must_use]
    pub fn changes_since(&self, earlier: &Registers) -> Changes {
        let now = self.view.registers();
        let is_same_view = now.fov_deg == earlier.fov_deg && now.background == earlier.background;
        if !is_same_view || !self.settings.passes.contains(Pass::Writes) {
            return Changes::Everything;
        }
        let is_new_light: Vec<_> = self.report.lights.iter().map(|&light| light >= earlier.n_lights).collect();
        let only_grows = now.n_lights >= earlier.n_lights
            && now.n_spheres >= earlier.n_spheres
            && now.n_cylinders >= earlier.n_cylinders;
        if !only_grows {
            return Changes::Everything;
        }
        let draws_cylinders = self.settings.part == Part::B;
        let n_new_cylinders = if draws_cylinders { now.n_cylinders - earlier.n_cylinders } else { 0 };
        let n_new = now.n_spheres - earlier.n_spheres + n_new_cylinders;
        let n_new_left_out = self.report.left_out.iter().filter(|left_out| is_new(left_out.object, earlier)).count();
        if n_new as usize == n_new_left_out && !is_new_light.contains(&true) {
            return Changes::Nothing;
        }
        let Some(is_touched) = self.find_touched(earlier, &is_new_light) else { return Changes::Everything };
        let mask = self.tiles_that_see(&is_touched);
        if mask.n_tiles() == 0 { Changes::Nothing } else { Changes::Tiles(mask) }
    }

    /// Returns for each object, spheres first, whether it is touched; `None` when that is not known.
    fn find_touched(&self, earlier: &Registers, is_new_light: &[bool]) -> Option<Vec<bool>> {
        let known = self.known.as_ref()?;
        let (reflected, lights, occluders) =
            (known.reflected.as_ref()?, known.lights.as_ref()?, known.occluders.as_ref()?);
        let is_new: Vec<_> = known.names().iter().map(|name| is_new(*name, earlier)).collect();
        let n_lights = is_new_light.len();
        let is_lit_anew = |i: usize| {
            let adds = |&light: &u32| {
                let mut between = occluders.objects(i * n_lights + light as usize);
                is_new_light[light as usize] || between.any(|occluder| is_new[occluder])
            };
            lights[i].iter().any(adds)
        };
        let mut is_touched: Vec<_> = (0..is_new.len()).map(|i| is_new[i] || is_lit_anew(i)).collect();
        // Each round adds a mirror or ends.
        loop {
            let shows = |i: usize| !is_touched[i] && reflected.objects(i).any(|met| is_touched[met]);
            let found: Vec<_> = (0..is_touched.len()).filter(|&i| shows(i)).collect();
            if found.is_empty() {
                return Some(is_touched);
            }
            found.into_iter().for_each(|i| is_touched[i] = true);
        }
    }

    /// Returns the tiles whose eye rays may meet an object that `is_touched`, counted spheres first.
    fn tiles_that_see(&self, is_touched: &[bool]) -> TileMask {
        let (tile_width, tile_height) = (self.tiles.width(), self.tiles.height());
        let [columns, rows] = [self.settings.size.width(), self.settings.size.height()];
        let (spheres, cylinders) = is_touched.split_at(self.scene.sphere_primitives.len());
        let sees = |candidates: Candidates<'_>| {
            let has = |list: &[u32], is_touched: &[bool]| list.iter().any(|&i| is_touched[i as usize]);
            has(candidates.spheres, spheres) || has(candidates.cylinders, cylinders)
        };
        let has = (0..rows)
            .step_by(tile_height as usize)
            .flat_map(|row| (0..columns).step_by(tile_width as usize).map(move |column| (column, row)));
        TileMask {
            tile_width,
            tile_height,
            n_columns: columns.div_ceil(tile_width) as usize,
            has: has.map(|(column, row)| sees(self.tiles.candidates(column, row))).collect(),
        }
    }
}

/// Tells whether an object, by its index in a later scene, is not in the earlier.
fn is_new(object: Object, earlier: &Registers) -> bool {
    match object {
        Object::Sphere(i) => i >= earlier.n_spheres,
        Object::Cylinder(i) => i >= earlier.n_cylinders,
    }
}
