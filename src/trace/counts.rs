//! What a render has done.

use std::ops::AddAssign;

/// What a render has done. Pixels settled twice count their rays twice.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Counts {
    /// Rays from the eye.
    pub eye_rays: u64,
    /// Rays from a hit along the mirror direction.
    pub reflected_rays: u64,
    /// Rays from a hit to a light.
    pub shadow_rays: u64,
    /// Tests of one ray against one primitive.
    pub tests: u64,
    /// Pixels that were traced in binary32, of which nothing is proved.
    pub draft_pixels: u64,
    /// Pixels that packets left to be settled one by one.
    pub settled_pixels: u64,
    /// Pixels that binary64 could not decide and double-double did.
    pub refined_pixels: u64,
    /// The largest bound on the error of a channel that was rounded to its byte, in levels, where bounds are kept.
    pub largest_bound: f64,
    /// Pixels that were made in arbitrary precision.
    pub exact_pixels: u64,
    /// Decisions that the finest arithmetic could not make either, made by the rule for ties.
    pub ties: u64,
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.eye_rays += other.eye_rays;
        self.reflected_rays += other.reflected_rays;
        self.shadow_rays += other.shadow_rays;
        self.tests += other.tests;
        self.draft_pixels += other.draft_pixels;
        self.settled_pixels += other.settled_pixels;
        self.refined_pixels += other.refined_pixels;
        self.largest_bound = self.largest_bound.max(other.largest_bound);
        self.exact_pixels += other.exact_pixels;
        self.ties += other.ties;
    }
}
