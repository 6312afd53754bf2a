//! What an image is asked for.

use crate::plan::Passes;

/// The size of an image in pixels, each side 1 to 65535.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    width: u32,
    height: u32,
}

impl Size {
    /// The longest side.
    pub const MAX_SIDE: u32 = 65535;

    /// Makes a size; `None` when a side is 0 or above [`Size::MAX_SIDE`].
    #[must_use]
    pub fn new(width: u32, height: u32) -> Option<Self> {
        let sides = 1..=Self::MAX_SIDE;
        (sides.contains(&width) && sides.contains(&height)).then_some(Self { width, height })
    }

    /// Returns the number of columns.
    #[must_use]
    pub fn width(self) -> u32 {
        self.width
    }

    /// Returns the number of rows.
    #[must_use]
    pub fn height(self) -> u32 {
        self.height
    }
}

impl Default for Size {
    fn default() -> Self {
        Self { width: 300, height: 300 }
    }
}

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

/// Which arithmetic traces pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Binary64, and double-double where that does not decide a pixel. What that cannot decide either has its best value, and
    /// is counted; few scenes need more.
    F64,
    /// A draft in binary32, about twice as fast: some channels are a level off, and some pixels at edges are wrong. Images
    /// that binary32 cannot start from, such as those with the eye inside an object, are traced as by
    /// [`Precision::F64`].
    F32,
    /// As [`Precision::F64`], and arbitrary precision where double-double does not decide a pixel: every pixel but proved
    /// and listed ties is proved to be that of exact arithmetic.
    #[default]
    Certified,
    /// Arbitrary precision for every pixel, by a renderer that shares nothing with the tracer; slow.
    Exact,
}

impl Precision {
    /// Returns its name on the command line and in documents.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
            Self::Certified => "certified",
            Self::Exact => "exact",
        }
    }

    /// Tells whether every pixel is proved, but for ties, which are counted and listed.
    #[must_use]
    pub const fn is_proved(self) -> bool {
        match self {
            Self::F64 | Self::F32 => false,
            Self::Certified | Self::Exact => true,
        }
    }
}

/// Which backend traces packets: what instructions of the machine are used. No pixel depends on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BackendChoice {
    /// The fastest that the machine has.
    #[default]
    Auto,
    /// AVX-512.
    Avx512,
    /// AVX2.
    Avx2,
    /// No special instructions.
    Scalar,
}

/// How much work in arbitrary precision an image of [`Precision::Certified`] may take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ExactWork {
    /// So much as ties along some rows and columns take. Pixels that take more are not proved: they have their best values,
    /// and the report counts them. Which they are depends on the scene and the settings alone.
    #[default]
    Limited,
    /// As much as it takes.
    Unlimited,
}

/// What a render is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Pixels of the image.
    pub size: Size,
    /// Which rules shade a hit.
    pub part: Part,
    /// N of the N×N samples a pixel, 1 to [`Settings::MAX_SAMPLES`].
    pub samples: u32,
    /// The point about which the samples of a pixel lie.
    pub sample_at: SampleAt,
    /// The last level that is shaded, at most [`Settings::MAX_LEVEL`]; the eye ray has level 0.
    pub max_level: u32,
    /// Which arithmetic traces pixels.
    pub precision: Precision,
    /// How much a certified image may take.
    pub exact_work: ExactWork,
    /// What traces packets; a tracer can be made only if the machine has it.
    pub backend: BackendChoice,
    /// What may be skipped; no pixel depends on it but those of a draft.
    pub passes: Passes,
}

impl Settings {
    /// The most samples along a side of a pixel.
    pub const MAX_SAMPLES: u32 = 256;

    /// The largest `max_level`; between parallel mirrors each level costs its time and memory.
    pub const MAX_LEVEL: u32 = 65535;
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            size: Size::default(),
            part: Part::B,
            samples: 1,
            sample_at: SampleAt::Corner,
            max_level: 8,
            precision: Precision::default(),
            exact_work: ExactWork::default(),
            backend: BackendChoice::default(),
            passes: Passes::all(),
        }
    }
}
