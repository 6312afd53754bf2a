//! What the eye rays of an image can meet at all.

use glam::DVec3;

use crate::math::{Ball64, Real, Sign, tan_half_degrees};
use crate::plan::bodies::{Body, Solid};
use crate::plan::{SampleAt, Settings};

/// The four planes through the eye between which all eye rays of an image lie, as normals that point inwards.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frustum {
    normals: [DVec3; 4],
}

impl Frustum {
    /// Makes the planes, rounded outwards.
    ///
    /// In steps of which a pixel is 2N wide, as in `src/trace/pixel.rs`, the samples reach from 1 − N to N − 1 about the
    /// first and the last anchor; a step is k/(N·H) at z = −1, with k the tangent of half the field of view.
    pub fn new(fov_deg: f64, settings: &Settings) -> Self {
        let n = i64::from(settings.samples);
        let [width, height] = [settings.size.width(), settings.size.height()].map(i64::from);
        let anchor = match settings.sample_at {
            SampleAt::Corner => 0,
            SampleAt::Centre => n,
        };
        let (k, relative_error) = tan_half_degrees(fov_deg);
        let step = Ball64::rounded(k, relative_error) / Ball64::exact((n * height) as f64);
        let low = |steps: i64| {
            let slope = Ball64::exact(steps as f64) * step;
            (slope.value() - slope.error()).next_down()
        };
        let high = |steps: i64| -low(-steps);
        let first = anchor + 1 - n;
        let last = anchor + n - 1;
        let (left, right) = (low(first - width * n), high((width - 2) * n + last));
        let (bottom, top) = (low((2 - height) * n - last), high(height * n - first));
        // A point of an eye ray has z < 0 and left ≤ x / −z ≤ right, likewise y.
        Self {
            normals: [
                DVec3::new(1.0, 0.0, left),
                DVec3::new(-1.0, 0.0, -right),
                DVec3::new(0.0, 1.0, bottom),
                DVec3::new(0.0, -1.0, -top),
            ],
        }
    }

    /// Proves, if it can, that no eye ray meets a solid: it lies behind the eye, or beyond one of the planes.
    pub fn misses(&self, solid: &Solid) -> bool {
        let is_beyond = |normal: DVec3| solid.min_along(-normal).sign() == Sign::Positive;
        is_behind(solid) || self.normals.into_iter().any(is_beyond)
    }
}

/// Tells whether a solid lies behind the eye: z ≥ 0 everywhere, exactly; an eye ray has z < 0.
fn is_behind(solid: &Solid) -> bool {
    match *solid {
        Solid::Sphere { center, radius } => center.z >= radius,
        Solid::Cylinder { z, radius, .. } => z >= radius,
    }
}
