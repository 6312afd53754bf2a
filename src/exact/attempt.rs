//! One pixel at one precision: the semantics from the eye ray to the bytes.

use std::cell::Cell;
use std::cmp::Ordering;

use crate::exact::ball::Ball;
use crate::exact::intersect::Ray;
use crate::exact::scene::{Body, Scene};
use crate::exact::tie::{Tie, Ties};
use crate::exact::vec3::{add, divide};
use crate::exact::{Pixel, SampleAt, Settings};
use crate::ir;

/// Added to 255 c before it is rounded down, so that 0.6 = 153/255 gives 153. The semantics fix it at 2⁻²⁰.
const QUANTISE_BIAS: f64 = 1.0 / 1_048_576.0;

/// A comparison could not be decided at this precision.
#[derive(Clone, Copy, Debug)]
pub struct Undecided;

/// An answer, unless it takes more bits.
pub type Decided<T> = Result<T, Undecided>;

/// The making of one pixel at one precision.
#[derive(Debug)]
pub struct Attempt<'a> {
    pub scene: &'a Scene,
    pub bodies: &'a [Body<'a>],
    pub surfaces: &'a [ir::Surface],
    pub settings: &'a Settings,
    /// What cannot be decided at the last precision is a tie.
    pub is_last: bool,
    /// Whether the filter in binary64 is off.
    pub tests_all: bool,
    pub proved: Cell<Ties>,
    pub open: Cell<Ties>,
}

impl Attempt<'_> {
    /// Decides the sign of a number.
    pub fn sign(&self, value: &Ball, tie: Tie) -> Decided<Ordering> {
        match value.sign() {
            Some(Ordering::Equal) => Ok(self.equal(tie)),
            Some(sign) => Ok(sign),
            None if self.is_last => {
                count(&self.open, tie);
                Ok(Ordering::Equal)
            }
            None => Err(Undecided),
        }
    }

    /// Counts a tie that is proved.
    pub fn equal(&self, tie: Tie) -> Ordering {
        count(&self.proved, tie);
        Ordering::Equal
    }

    /// Returns an exact number at the precision of the pixel.
    pub fn ball(&self, value: f64) -> Ball {
        Ball::exact(value, self.scene.bits)
    }

    /// Makes the pixel.
    pub fn pixel(&self, column: u32, row: u32) -> Decided<Pixel> {
        let n = self.settings.samples;
        let mut sum = [0.0; 3].map(|zero| self.ball(zero));
        for sample_row in 0..n {
            for sample_column in 0..n {
                let ray = self.eye_ray(column, row, sample_column, sample_row);
                sum = add(&sum, &self.radiance(&ray, 0)?);
            }
        }
        let average = if n == 1 { sum } else { divide(&sum, &self.ball(f64::from(n) * f64::from(n))) };
        let mut pixel = Pixel {
            rgb: [0; 3],
            channels: [0.0; 3],
            error: 0.0,
            slack: f64::INFINITY,
            proved_ties: Ties::default(),
            open_ties: Ties::default(),
            bits: self.scene.bits,
        };
        for (axis, channel) in average.iter().enumerate() {
            let value = channel * &self.ball(255.0);
            let (byte, slack) = self.quantise(&value)?;
            pixel.rgb[axis] = byte;
            pixel.channels[axis] = value.to_f64();
            pixel.error = pixel.error.max(value.radius());
            pixel.slack = pixel.slack.min(slack);
        }
        pixel.proved_ties = self.proved.get();
        pixel.open_ties = self.open.get();
        Ok(pixel)
    }

    /// Returns ⌊`value` + 2⁻²⁰⌋ and the distance of `value` + 2⁻²⁰ to the nearest whole number.
    fn quantise(&self, value: &Ball) -> Decided<(u8, f64)> {
        let biased = value + &self.ball(QUANTISE_BIAS);
        let mut floor = biased.to_f64().floor().clamp(0.0, 255.0);
        if self.sign(&(&biased - &self.ball(floor + 1.0)), Tie::Quantise)? != Ordering::Less {
            floor += 1.0;
        } else if self.sign(&(&biased - &self.ball(floor)), Tie::Quantise)? == Ordering::Less {
            floor -= 1.0;
        }
        let [below, above] = [floor, floor + 1.0].map(|whole| (&biased - &self.ball(whole)).to_f64().abs());
        Ok((floor as u8, below.min(above)))
    }

    /// Returns the ray of one sample: d = ((2i − W) k/H, (H − 2j) k/H, −1) with i and j moved by the sample's offset.
    fn eye_ray(&self, column: u32, row: u32, sample_column: u32, sample_row: u32) -> Ray {
        let n = f64::from(self.settings.samples);
        let [width, height] = [self.settings.width, self.settings.height].map(f64::from);
        // In steps of which half a pixel has n: 2n ((s + 1/2) / n − 1/2), and n more for the centre.
        let offset = |sample: u32| {
            let offset = 2.0 * f64::from(sample) + 1.0 - n;
            match self.settings.sample_at {
                SampleAt::Corner => offset,
                SampleAt::Centre => offset + n,
            }
        };
        let x = n * (2.0 * f64::from(column) - width) + offset(sample_column);
        let y = n * (height - 2.0 * f64::from(row)) - offset(sample_row);
        let dir = [&self.ball(x) * &self.scene.grid.step, &self.ball(y) * &self.scene.grid.step, self.ball(-1.0)];
        Ray::from_eye([0.0; 3].map(|zero| self.ball(zero)), dir, [x, y])
    }
}

fn count(ties: &Cell<Ties>, tie: Tie) {
    let mut counts = ties.get();
    counts.count(tie);
    ties.set(counts);
}
