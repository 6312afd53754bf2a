//! What an exact render is asked for.

/// Which rules shade a hit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Part {
    /// Spheres only, diffuse light only, no shadows.
    A,
    /// The whole language.
    #[default]
    B,
}

/// Where in its pixel a sample lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SampleAt {
    /// The upper left corner, as in the original images.
    #[default]
    Corner,
    /// The centre.
    Centre,
}

/// What an exact render is asked for. This repeats `plan::Settings` on purpose: nothing is shared with the tracer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Columns of the image, at least 1.
    pub width: u32,
    /// Rows of the image, at least 1.
    pub height: u32,
    /// Which rules shade a hit.
    pub part: Part,
    /// N of the N×N samples a pixel, at least 1.
    pub samples: u32,
    /// The point about which the samples of a pixel lie.
    pub sample_at: SampleAt,
    /// The last level that is shaded; the eye ray has level 0.
    pub max_level: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self { width: 300, height: 300, part: Part::B, samples: 1, sample_at: SampleAt::Corner, max_level: 8 }
    }
}
