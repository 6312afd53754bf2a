//! What an image is asked for: the options shared by the commands that plan or trace one.

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use clisc::plan::{self, BackendChoice, ExactWork, Pass, Passes, Settings, Size};

use super::number::whole;

/// What an image is asked for.
#[derive(Args, Debug)]
pub struct ImageArgs {
    /// Width and height of the images in pixels, each at most 65535.
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "300x300", value_parser = parse_size)]
    pub size: Size,
    /// The rules: a, spheres with diffuse light only; b, the whole language.
    #[arg(long, value_enum, value_name = "a|b", default_value_t, hide_possible_values = true, ignore_case = true)]
    pub part: Part,
    /// Samples a pixel, N by N, at most 256; smooths edges.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole::<u32>(1..=Settings::MAX_SAMPLES))]
    pub samples: u32,
    /// Where in its pixel a sample lies.
    #[arg(long, value_enum, value_name = "PLACE", default_value_t)]
    pub sample_at: SampleAt,
    /// The last level that is shaded: the eye ray has level 0, its reflection level 1, and so on; at most 65535.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = whole::<u32>(0..=Settings::MAX_LEVEL))]
    pub max_level: u32,
    /// The arithmetic. certified, the default: every pixel is proved, in arbitrary precision where need be, as long as that
    /// takes no more work than ties along some rows and columns of the image do. That depends on the scene and the options
    /// alone. Pixels beyond the limit have their best value, and a warning counts them; asked for by name, certified has no
    /// limit. f64: no arbitrary precision; what double-double leaves open has its best value and is counted. exact:
    /// all of it in arbitrary precision, by another renderer; slow. f32: a faster draft; of 270,000 channels of a 300x300
    /// scene measured, at most 69 were wrong, mostly by one level. --stats counts the pixels that were drafted; several
    /// samples, many objects or the eye inside an object make it f64.
    #[arg(long, value_enum, value_name = "ARITHMETIC", hide_possible_values = true, ignore_case = true)]
    pub precision: Option<Precision>,
    /// Do all the work that clisc can prove needless, or that of the passes named, separated by commas; for comparison,
    /// no pixel depends on it.
    #[arg(long, value_enum, value_name = "PASS", num_args = 0.., value_delimiter = ',', require_equals = true)]
    pub no_skip: Option<Vec<PassArg>>,
}

impl ImageArgs {
    /// Returns what every render is asked for, by the backend of this machine.
    pub fn settings(&self) -> Settings {
        Settings {
            backend: BackendChoice::Auto,
            size: self.size,
            part: self.part.into(),
            samples: self.samples,
            sample_at: self.sample_at.into(),
            max_level: self.max_level,
            precision: self.precision.unwrap_or_default().into(),
            exact_work: if self.precision.is_some() { ExactWork::Unlimited } else { ExactWork::Limited },
            passes: self.passes(),
        }
    }

    /// Returns the passes that are left on.
    fn passes(&self) -> Passes {
        match self.no_skip.as_deref() {
            None => Passes::all(),
            Some([]) => Passes::none(),
            Some(named) => named.iter().fold(Passes::all(), |passes, PassArg(pass)| passes.without(*pass)),
        }
    }
}

/// A pass of the plan by its name.
#[derive(Clone, Copy, Debug)]
pub struct PassArg(Pass);

impl ValueEnum for PassArg {
    fn value_variants<'a>() -> &'a [Self] {
        const ALL: [PassArg; Pass::ALL.len()] = {
            let mut all = [PassArg(Pass::ALL[0]); Pass::ALL.len()];
            let mut i = 0;
            while i < all.len() {
                all[i] = PassArg(Pass::ALL[i]);
                i += 1;
            }
            all
        };
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.0.name()).help(self.0.skips()))
    }
}

/// Which rules shade a hit.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum Part {
    /// Spheres with diffuse light only.
    A,
    /// The whole language.
    #[default]
    B,
}

impl From<Part> for plan::Part {
    fn from(part: Part) -> Self {
        match part {
            Part::A => Self::A,
            Part::B => Self::B,
        }
    }
}

/// Which arithmetic traces pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Precision {
    /// Binary32: a draft.
    F32,
    /// Binary64, and double-double where needed.
    F64,
    /// As f64, and arbitrary precision where needed: every pixel is proved.
    #[default]
    Certified,
    /// Arbitrary precision everywhere.
    Exact,
}

impl Precision {
    /// Returns its name on the command line.
    pub fn name(self) -> &'static str {
        plan::Precision::from(self).name()
    }

    /// Returns its place among all, from the coarsest.
    pub fn fineness(self) -> u32 {
        match self {
            Self::F32 => 0,
            Self::F64 => 1,
            Self::Certified => 2,
            Self::Exact => 3,
        }
    }
}

impl From<Precision> for plan::Precision {
    fn from(precision: Precision) -> Self {
        match precision {
            Precision::F32 => Self::F32,
            Precision::F64 => Self::F64,
            Precision::Certified => Self::Certified,
            Precision::Exact => Self::Exact,
        }
    }
}

/// Where in its pixel a sample lies.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum SampleAt {
    /// The upper left corner, as in the original images.
    #[default]
    Corner,
    /// The centre.
    #[value(alias = "center")]
    Centre,
}

impl From<SampleAt> for plan::SampleAt {
    fn from(at: SampleAt) -> Self {
        match at {
            SampleAt::Corner => Self::Corner,
            SampleAt::Centre => Self::Centre,
        }
    }
}

/// Parses `WxH`; a fault explains itself.
pub(super) fn parse_size(text: &str) -> Result<Size, String> {
    let (width, height) = text
        .split_once(['x', 'X', '×'])
        .ok_or_else(|| "a size is width x height without spaces, such as 300x200".to_owned())?;
    let (width, height) = (parse_side("width", width)?, parse_side("height", height)?);
    Size::new(width, height).ok_or_else(|| "a side is out of range".to_owned())
}

fn parse_side(name: &str, digits: &str) -> Result<u32, String> {
    if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
        return Err(format!("the {name} `{digits}` is not a whole number; a size is such as 300x200"));
    }
    match digits.parse::<u32>() {
        Ok(0) => Err(format!("the {name} is 0; an image has at least one pixel a side")),
        Ok(side) if side <= Size::MAX_SIDE => Ok(side),
        _ => Err(format!("the {name} {digits} is beyond the limit of {} pixels a side", Size::MAX_SIDE)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_parses_or_explains_itself() {
        assert_eq!(parse_size("300x200"), Ok(Size::new(300, 200).unwrap()));
        assert_eq!(parse_size("65535X1"), Ok(Size::new(65535, 1).unwrap()));
        for (text, words) in [
            ("300", "such as 300x200"),
            ("300x", "the height `` is not a whole number"),
            ("3.5x2", "the width `3.5` is not a whole number"),
            ("-3x2", "the width `-3` is not a whole number"),
            ("0x2", "the width is 0"),
            ("2x65536", "the height 65536 is beyond the limit of 65535"),
            ("99999999999999999999x2", "beyond the limit of 65535"),
            ("1x2x3", "the height `2x3` is not"),
        ] {
            let message = parse_size(text).unwrap_err();
            assert!(message.contains(words), "{text}: {message}");
        }
    }
}
