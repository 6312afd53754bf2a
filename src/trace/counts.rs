//! What a render has done, and what it left out as it went.

use std::ops::AddAssign;

/// What a render has done. Pixels settled twice count their rays twice.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Counts {
    /// Rays from the eye.
    pub eye_rays: u64,
    /// Rays from a hit along the mirror direction.
    pub reflected_rays: u64,
    /// Reflected rays that were not followed, because whatever they find the pixel is the same.
    pub settled_rays: u64,
    /// Pairs of a hit whose surface answers light, and a light that shines.
    pub lightings: u64,
    /// Rays from a hit to a light: to those of these pairs for which they are needed.
    pub shadow_rays: u64,
    /// Tests of one ray against one primitive.
    pub tests: u64,
    /// Those of reflected rays.
    pub reflected_tests: u64,
    /// Those of shadow rays.
    pub shadow_tests: u64,
    /// Pixels that were traced in binary32, of which nothing is proved.
    pub draft_pixels: u64,
    /// Pixels that packets left to be settled one by one.
    pub settled_pixels: u64,
    /// Pixels that binary64 could not decide and double-double did.
    pub refined_pixels: u64,
    /// Pixels that double-double could not decide either and long numbers did.
    pub long_pixels: u64,
    /// The largest bound on the error of a channel that was rounded to its byte, in levels, where bounds are kept.
    pub largest_bound: f64,
    /// Pixels that were made in arbitrary precision.
    pub exact_pixels: u64,
    /// Pixels that nothing decided, or that took more exact work than there may be: they have their best values.
    pub unproved_pixels: u64,
    /// Decisions that were made by the rule for ties: proved, or open even to the finest arithmetic.
    pub ties: u64,
}

/// What a render left out that is known only while tracing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Spared {
    /// Reflected rays, because whatever they find the pixel is the same.
    pub reflected_rays_not_cast: u64,
    /// Tests of reflected rays against objects, over all that were cast.
    pub reflected_tests_not_made: u64,
    /// Rays from a hit to a light, because the hit faces away, nothing can lie between, or something does for sure.
    pub shadow_rays_not_cast: u64,
    /// Tests of rays to lights against objects, cast or not.
    pub shadow_tests_not_made: u64,
}

impl Counts {
    /// Returns what was left out of the image of a scene of so many objects.
    #[must_use]
    pub fn spared(&self, n_objects: u64) -> Spared {
        let all_tests = |n_rays: u64| n_rays.saturating_mul(n_objects);
        Spared {
            reflected_rays_not_cast: self.settled_rays,
            reflected_tests_not_made: all_tests(self.reflected_rays).saturating_sub(self.reflected_tests),
            shadow_rays_not_cast: self.lightings.saturating_sub(self.shadow_rays),
            shadow_tests_not_made: all_tests(self.lightings).saturating_sub(self.shadow_tests),
        }
    }

    /// Counts some shadow rays, and the tests of all of them together.
    #[inline(always)]
    pub(super) fn add_shadow_rays(&mut self, n_rays: u32, n_tests: u32) {
        self.shadow_rays += u64::from(n_rays);
        self.shadow_tests += u64::from(n_tests);
        self.tests += u64::from(n_tests);
    }

    /// Counts tests of some reflected rays, each against as many objects.
    #[inline(always)]
    pub(super) fn add_reflected_tests(&mut self, n_rays: u32, n_objects: usize) {
        let n_tests = u64::from(n_rays) * n_objects as u64;
        self.reflected_tests += n_tests;
        self.tests += n_tests;
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.eye_rays += other.eye_rays;
        self.reflected_rays += other.reflected_rays;
        self.settled_rays += other.settled_rays;
        self.lightings += other.lightings;
        self.shadow_rays += other.shadow_rays;
        self.tests += other.tests;
        self.reflected_tests += other.reflected_tests;
        self.shadow_tests += other.shadow_tests;
        self.draft_pixels += other.draft_pixels;
        self.settled_pixels += other.settled_pixels;
        self.refined_pixels += other.refined_pixels;
        self.long_pixels += other.long_pixels;
        self.largest_bound = self.largest_bound.max(other.largest_bound);
        self.exact_pixels += other.exact_pixels;
        self.unproved_pixels += other.unproved_pixels;
        self.ties += other.ties;
    }
}

impl AddAssign for Spared {
    fn add_assign(&mut self, other: Self) {
        self.reflected_rays_not_cast += other.reflected_rays_not_cast;
        self.reflected_tests_not_made += other.reflected_tests_not_made;
        self.shadow_rays_not_cast += other.shadow_rays_not_cast;
        self.shadow_tests_not_made += other.shadow_tests_not_made;
    }
}
