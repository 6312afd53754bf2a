//! One pixel at one precision: the semantics from the eye ray to the bytes.

use std::cell::{Cell, RefCell};
use std::cmp::Ordering;

use crate::exact::algebra::Algebra;
use crate::exact::intersect::Ray;
use crate::exact::real::Real;
use crate::exact::scene::{Body, Equation, Scene};
use crate::exact::tie::{Tie, Ties};
use crate::exact::vec3::{Vec3, add, divide};
use crate::exact::{LADDER, Pixel, Renderer, SampleAt, Settings};
use crate::ir;

/// Added to 255 c before it is rounded down, so that 0.6 = 153/255 gives 153. The semantics fix it at 2⁻²⁰.
const QUANTISE_BIAS: f64 = 1.0 / 1_048_576.0;

/// What the parts of a pixel cost at 96 bits, in units of [`Pixel::work`]: measured, and rounded.
const WORK_OF_RAY: u64 = 256;
pub const WORK_OF_TEST: u64 = 128;
pub const WORK_OF_LIGHT: u64 = 512;

/// A comparison could not be decided at this precision.
#[derive(Clone, Copy, Debug)]
pub struct Undecided;

/// How much work a pixel may take.
#[derive(Clone, Copy)]
pub struct Allowance<'a> {
    /// The most work, in units of [`Pixel::work`].
    pub max_work: u64,
    /// Ends the work early: asked now and then, within a pixel too.
    pub is_cancelled: &'a (dyn Fn() -> bool + Sync),
}

impl std::fmt::Debug for Allowance<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Allowance").field("max_work", &self.max_work).finish_non_exhaustive()
    }
}

impl Allowance<'_> {
    /// No limit.
    pub const UNLIMITED: Allowance<'static> = Allowance { max_work: u64::MAX, is_cancelled: &|| false };
}

/// The work between two looks at whether it is cancelled: some milliseconds.
const WORK_A_LOOK: u64 = 1 << 16;

/// An answer, unless it takes more bits, or the work is not allowed.
pub type Decided<T> = Result<T, Undecided>;

/// The making of one pixel at one precision.
#[derive(Debug)]
pub struct Attempt<'a> {
    pub scene: &'a Scene,
    pub bodies: &'a [Body<'a>],
    /// The surfaces that the eye lies on: eye rays leave them.
    pub eye_on: &'a [Equation],
    pub surfaces: &'a [ir::Surface],
    pub settings: &'a Settings,
    /// What cannot be decided at the last precision is a tie.
    pub is_last: bool,
    /// Whether the filter in binary64 is off.
    pub tests_all: bool,
    /// Who is asked what balls leave open, unless the scene is without algebra.
    algebra: RefCell<Algebra>,
    found: Cell<Found>,
    work: Cell<u64>,
    /// What this attempt may take.
    allowance: Allowance<'a>,
    /// The work at which to look next whether it is cancelled.
    next_look: Cell<u64>,
    is_stopped: Cell<bool>,
}

/// The ties that were found so far.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    exact: Ties,
    algebraic: Ties,
    open: Ties,
}

impl<'a> Attempt<'a> {
    /// Prepares the making of one pixel of `renderer`, in the arithmetic of `scene`.
    pub fn new<'p: 'a>(renderer: &'a Renderer<'p>, scene: &'a Scene, is_last: bool, allowance: Allowance<'a>) -> Self {
        Self {
            scene,
            bodies: renderer.bodies(),
            eye_on: renderer.eye_on(),
            surfaces: renderer.view.surfaces(),
            settings: &renderer.settings,
            is_last,
            tests_all: renderer.tests_all,
            algebra: RefCell::new(Algebra::new(scene.kappa.clone())),
            found: Cell::default(),
            work: Cell::default(),
            allowance,
            next_look: Cell::new(WORK_A_LOOK),
            is_stopped: Cell::new(false),
        }
    }

    /// Counts work that grows with the precision.
    pub fn spend(&self, work: u64) {
        self.spend_once(work * self.scene.arithmetic.bits as u64 / LADDER[0] as u64);
    }

    /// Counts work that does not.
    pub fn spend_once(&self, work: u64) {
        self.work.set(self.work.get() + work);
    }

    /// Returns the work so far: see [`Pixel::work`].
    pub fn work(&self) -> u64 {
        self.work.get() + self.algebra.borrow().work()
    }

    /// Tells whether the work was too much, or is cancelled: then nothing is decided any more.
    pub fn is_stopped(&self) -> bool {
        self.is_stopped.get()
    }

    /// Stops the attempt when the work is too much, or is cancelled.
    pub fn check_work(&self) -> Decided<()> {
        let work = self.work();
        if work > self.allowance.max_work {
            self.is_stopped.set(true);
        } else if work >= self.next_look.get() {
            self.next_look.set(work + WORK_A_LOOK);
            self.is_stopped.set(self.is_stopped() || (self.allowance.is_cancelled)());
        }
        if self.is_stopped() { Err(Undecided) } else { Ok(()) }
    }

    /// Decides the sign of a number.
    ///
    /// What stays open at the last precision is equal in all likelihood if its bound is narrow. If it is not, the path has lost
    /// its precision among mirrors, and the number has the sign that was computed. Either is counted as open.
    pub fn sign(&self, value: &Real, tie: Tie) -> Decided<Ordering> {
        self.check_work()?;
        if let Some(sign) = value.sign() {
            return Ok(self.noted(sign, tie, |found| &mut found.exact));
        }
        let expression = value.expression();
        if let Some(sign) = expression.and_then(|expression| self.algebra.borrow_mut().sign(expression)) {
            return Ok(self.noted(sign, tie, |found| &mut found.algebraic));
        }
        if !self.is_last {
            return Err(Undecided);
        }
        let mut found = self.found.get();
        found.open.count(tie);
        self.found.set(found);
        let is_vague = value.radius() > self.scene.vague;
        Ok(if is_vague { value.to_f64().partial_cmp(&0.0).unwrap_or(Ordering::Less) } else { Ordering::Equal })
    }

    /// Counts a tie if there is one.
    fn noted(&self, sign: Ordering, tie: Tie, ties: impl Fn(&mut Found) -> &mut Ties) -> Ordering {
        if sign == Ordering::Equal {
            let mut found = self.found.get();
            ties(&mut found).count(tie);
            self.found.set(found);
        }
        sign
    }

    /// Returns a number of the scene in the arithmetic of the pixel.
    pub fn number(&self, value: f64) -> Real {
        self.scene.arithmetic.number(value)
    }

    /// Returns the vector of three such numbers.
    pub fn vec3(&self, values: [f64; 3]) -> Vec3 {
        self.scene.arithmetic.vec3(values)
    }

    /// Makes the pixel.
    pub fn pixel(&self, column: u32, row: u32) -> Decided<Pixel> {
        let n = self.settings.samples;
        let mut sum = self.vec3([0.0; 3]);
        for sample_row in 0..n {
            for sample_column in 0..n {
                let ray = self.eye_ray(column, row, sample_column, sample_row);
                sum = add(&sum, &self.radiance(ray)?);
            }
        }
        let average = if n == 1 { sum } else { divide(&sum, &self.number(f64::from(n) * f64::from(n))) };
        let mut pixel = Pixel {
            rgb: [0; 3],
            channels: [0.0; 3],
            error: 0.0,
            slack: f64::INFINITY,
            proved_ties: Ties::default(),
            algebraic_ties: Ties::default(),
            open_ties: Ties::default(),
            bits: self.scene.arithmetic.bits,
            work: 0,
        };
        for (axis, channel) in average.iter().enumerate() {
            let value = channel * &self.number(255.0);
            let (byte, slack) = self.quantise(&value)?;
            pixel.rgb[axis] = byte;
            pixel.channels[axis] = value.to_f64();
            pixel.error = pixel.error.max(value.radius());
            pixel.slack = pixel.slack.min(slack);
        }
        let Found { exact, algebraic, open } = self.found.get();
        Ok(Pixel { proved_ties: exact, algebraic_ties: algebraic, open_ties: open, ..pixel })
    }

    /// Returns ⌊`value` + 2⁻²⁰⌋ and the distance of `value` + 2⁻²⁰ to the nearest whole number.
    fn quantise(&self, value: &Real) -> Decided<(u8, f64)> {
        let biased = value + &self.number(QUANTISE_BIAS);
        let mut floor = biased.to_f64().floor().clamp(0.0, 255.0);
        if self.sign(&(&biased - &self.number(floor + 1.0)), Tie::Quantise)? != Ordering::Less {
            floor += 1.0;
        } else if self.sign(&(&biased - &self.number(floor)), Tie::Quantise)? == Ordering::Less {
            floor -= 1.0;
        }
        let [below, above] = [floor, floor + 1.0].map(|whole| (&biased - &self.number(whole)).to_f64().abs());
        Ok((floor as u8, below.min(above)))
    }

    /// Returns the ray of one sample: d = ((2i − W) k/H, (H − 2j) k/H, −1) with i and j moved by the sample's offset.
    fn eye_ray(&self, column: u32, row: u32, sample_column: u32, sample_row: u32) -> Ray {
        self.spend(WORK_OF_RAY);
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
        let dir = [&self.number(x) * &self.scene.step, &self.number(y) * &self.scene.step, self.number(-1.0)];
        Ray::new(self.vec3([0.0; 3]), dir, self.eye_on.to_vec())
    }
}
