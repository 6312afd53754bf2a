//! What a plan saves before any ray is cast, in numbers.

use crate::plan::Plan;

/// What the passes of one plan leave out, as far as it is known before any ray is cast.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Savings {
    /// Objects that no ray needs.
    pub objects_left_out: u64,
    /// Lights that are black.
    pub lights_left_out: u64,
    /// Diffuse, specular and reflected terms that were taken out of surfaces in use, because they add nothing.
    pub terms_not_computed: u64,
    /// Objects that need not be looked at on the way from an object to a light, over all objects and lights.
    pub occluders_left_out: u64,
    /// Tiles whose eye rays meet nothing: they are filled.
    pub tiles_not_visited: u64,
    /// Eye rays of those tiles.
    pub eye_rays_not_cast: u64,
    /// Tests of an eye ray against an object, over all eye rays.
    pub eye_tests_not_made: u64,
}

impl std::ops::AddAssign for Savings {
    fn add_assign(&mut self, other: Self) {
        self.objects_left_out += other.objects_left_out;
        self.lights_left_out += other.lights_left_out;
        self.terms_not_computed += other.terms_not_computed;
        self.occluders_left_out += other.occluders_left_out;
        self.tiles_not_visited += other.tiles_not_visited;
        self.eye_rays_not_cast += other.eye_rays_not_cast;
        self.eye_tests_not_made += other.eye_tests_not_made;
    }
}

impl Plan<'_> {
    /// Counts what the passes leave out.
    #[must_use]
    pub fn savings(&self) -> Savings {
        let report = &self.report;
        let mut savings = Savings {
            objects_left_out: report.left_out.len() as u64,
            lights_left_out: (report.n_lights - report.lights.len()) as u64,
            terms_not_computed: report.n_terms_left_out,
            occluders_left_out: self.n_occluders_left_out(),
            ..Savings::default()
        };
        self.add_tiles(&mut savings);
        savings
    }

    fn n_occluders_left_out(&self) -> u64 {
        let Some(table) = self.known.as_ref().and_then(|known| known.occluders.as_ref()) else { return 0 };
        (table.len() * self.scene.n_objects() - table.n_entries()) as u64
    }

    fn add_tiles(&self, savings: &mut Savings) {
        let size = self.settings.size;
        let n_objects = self.report.n_spheres + self.report.n_cylinders;
        let n_samples = u64::from(self.settings.samples).pow(2);
        let (tile_width, tile_height) = (self.tiles.width(), self.tiles.height());
        for row in (0..size.height()).step_by(tile_height as usize) {
            let n_rows = tile_height.min(size.height() - row);
            for column in (0..size.width()).step_by(tile_width as usize) {
                let n_columns = tile_width.min(size.width() - column);
                let n_rays = u64::from(n_rows) * u64::from(n_columns) * n_samples;
                let n_listed = self.tiles.candidates(column, row).len();
                savings.eye_tests_not_made += n_rays * n_objects.saturating_sub(n_listed) as u64;
                if n_listed == 0 {
                    savings.tiles_not_visited += 1;
                    savings.eye_rays_not_cast += n_rays;
                }
            }
        }
    }
}
