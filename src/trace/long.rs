//! The stages between double-double and the referee: as many bits as a pixel is expected to take, up to 512 where work is
//! limited, and up to 1024 where it is not.
//!
//! # Which width
//! A bounce magnifies errors, and so takes a number of bits from all that follows. How many, the arithmetic before has shown: it
//! followed a ray up to some level and not beyond. So many times as the last level is deeper, so many times as many bits it
//! takes, and somewhat more. Where that is more than there are, or a wider arithmetic gives up at the same level as the one
//! before, the doubt is not one of precision, and the pixel is left to the referee: it is a tie as a rule.
//!
//! # How much in all
//! A whole image of deep mirrors can need these stages in every pixel. Where work is limited, each row of pixels may take
//! [`ROW_WORK`], spent from the left; the pixels behind that are left to the referee. So what is settled here depends on the scene
//! and the settings alone, not on threads, time, or how an image is cut into bands.

use crate::math::{Long, Real};
use crate::plan::{Candidates, ExactWork, Plan};
use crate::trace::camera::Camera;
use crate::trace::integrator::Integrator;
use crate::trace::pixel::{self, Pixel};
use crate::trace::touch::Touches;
use crate::trace::{Counts, Tracer};

/// Limbs of the narrow stage, and its bits.
const N_NARROW: usize = 4;
const NARROW_BITS: u32 = 64 * N_NARROW as u32;

/// Limbs of the wide stage, and the most bits that it has.
const N_WIDE: usize = 16;
const WIDE_BITS: u32 = 64 * N_WIDE as u32;

/// The most bits where work is limited: with as many a pixel takes some fifteen times as long as in double-double.
const LIMITED_BITS: u32 = 512;

/// What a row of pixels may take where work is limited: a test of a ray against an object takes the square of its limbs.
/// At most a fifth of a second of one core or so: as much as a ball in a mirrored room takes at 300 columns and 20 levels.
const ROW_WORK: u64 = 1 << 21;

/// No band of rows that is traced at once, tile by tile, has more.
const MAX_ROWS: usize = Tracer::TILE_ROWS as usize;

/// The bits of double-double.
const FINE_BITS: u32 = 106;

/// Before so many bounces the level at which a ray is given up says little of what a bounce takes.
const FEW_BOUNCES: u32 = 4;

/// Eye rays in long numbers.
#[derive(Debug)]
pub struct LongCameras {
    narrow: Camera<Long<N_NARROW>>,
    wide: Camera<Long<N_WIDE>>,
}

impl LongCameras {
    /// Makes them as [`Camera::new`] does.
    pub fn new(fov_deg: f64, steps_per_half_height: u32) -> Self {
        Self { narrow: Camera::new(fov_deg, steps_per_half_height), wide: Camera::new(fov_deg, steps_per_half_height) }
    }
}

/// Settles pixels in long numbers.
#[derive(Debug)]
pub struct LongStages<'a, 'p> {
    narrow: Integrator<'a, 'p, Long<N_NARROW>>,
    wide: Integrator<'a, 'p, Long<N_WIDE>>,
    max_level: u32,
    max_bits: u32,
    row_work: RowWork,
    /// What was proved equal in the last pixel that was settled.
    pub touches: Touches,
}

impl<'a, 'p> LongStages<'a, 'p> {
    /// Makes stages that have counted nothing yet.
    pub fn new(plan: &'a Plan<'p>) -> Self {
        Self {
            narrow: Integrator::new(plan),
            wide: Integrator::new(plan),
            max_level: plan.settings.max_level,
            max_bits: match plan.settings.exact_work {
                ExactWork::Limited => LIMITED_BITS,
                ExactWork::Unlimited => WIDE_BITS,
            },
            row_work: RowWork::new(match plan.settings.exact_work {
                ExactWork::Limited => ROW_WORK,
                ExactWork::Unlimited => u64::MAX,
            }),
            touches: Touches::default(),
        }
    }

    /// Returns the bytes of a pixel that double-double has given up at a level, or at the rounding of its channels; `None` if
    /// these stages leave it open too, or its row has taken what it may. The pixels of a row come from the left.
    pub fn settle(
        &mut self,
        cameras: &LongCameras,
        row: u32,
        pixel: &Pixel,
        among: Candidates<'_>,
        given_up: Option<u32>,
    ) -> Option<[u8; 3]> {
        let mut tried = Tried { bits: FINE_BITS, given_up };
        let within_reach = |bits: u32| {
            // What is expected may be somewhat too much.
            (bits <= self.max_bits + self.max_bits / 4).then_some(bits.clamp(NARROW_BITS, self.max_bits))
        };
        let mut next = tried.first(self.max_level).and_then(within_reach);
        while let Some(bits) = next {
            if self.row_work.is_spent(row) {
                return None;
            }
            let n_tests = self.n_tests();
            let answer = if bits <= NARROW_BITS {
                attempt(&mut self.narrow, &cameras.narrow, pixel, among)
            } else {
                attempt(&mut self.wide, &cameras.wide.shortened(bits), pixel, among)
            };
            self.row_work.spend(row, (self.n_tests() - n_tests) * u64::from(bits.div_ceil(64)).pow(2));
            match answer {
                Ok((bytes, touches)) => {
                    self.touches = touches;
                    return Some(bytes);
                }
                Err(given_up) => {
                    let now = Tried { bits, given_up };
                    next = now.next(&tried, self.max_level).filter(|_| bits < self.max_bits).and_then(within_reach);
                    tried = now;
                }
            }
        }
        None
    }

    fn n_tests(&self) -> u64 {
        self.narrow.judge.counts.tests + self.wide.judge.counts.tests
    }

    /// Returns what has been done so far.
    pub fn counts(&self) -> Counts {
        let mut counts = self.narrow.judge.counts;
        counts += self.wide.judge.counts;
        counts
    }
}

/// Traces a pixel in one arithmetic; returns its bytes and what was proved equal, or the level at which it was given up.
fn attempt<R: Real>(
    integrator: &mut Integrator<'_, '_, R>,
    camera: &Camera<R>,
    pixel: &Pixel,
    among: Candidates<'_>,
) -> Result<([u8; 3], Touches), Option<u32>> {
    match pixel::settle(integrator, camera, pixel, among) {
        Ok(bytes) => Ok((bytes, integrator.judge.touches)),
        Err(_) => Err(integrator.given_up),
    }
}

/// What rows of pixels have taken, of as many as are traced at once.
#[derive(Debug)]
struct RowWork {
    max: u64,
    /// The last row of each remainder, and what it has taken.
    rows: [(u32, u64); MAX_ROWS],
}

impl RowWork {
    fn new(max: u64) -> Self {
        Self { max, rows: [(0, 0); MAX_ROWS] }
    }

    fn of(&mut self, row: u32) -> &mut u64 {
        let (last, work) = &mut self.rows[row as usize % MAX_ROWS];
        if *last != row {
            (*last, *work) = (row, 0);
        }
        work
    }

    fn is_spent(&mut self, row: u32) -> bool {
        let max = self.max;
        *self.of(row) >= max
    }

    fn spend(&mut self, row: u32, work: u64) {
        let spent = self.of(row);
        *spent = spent.saturating_add(work);
    }
}

/// How far an arithmetic came.
#[derive(Clone, Copy, Debug)]
struct Tried {
    bits: u32,
    /// The level at which a ray was given up; `None` if it was the rounding of a channel.
    given_up: Option<u32>,
}

impl Tried {
    /// Returns the bits that the pixel is expected to take, if every ray is reflected to the end.
    fn expected(self, max_level: u32) -> u32 {
        match self.given_up {
            None => 2 * self.bits,
            Some(level) => {
                let bits = u64::from(self.bits) * (u64::from(max_level) + 1) / (u64::from(level) + 1);
                u32::try_from(bits + bits / 8 + 16).unwrap_or(u32::MAX)
            }
        }
    }

    /// Returns the bits to try first.
    fn first(self, max_level: u32) -> Option<u32> {
        match self.given_up {
            Some(level) if level >= FEW_BOUNCES => Some(self.expected(max_level)),
            _ => Some(NARROW_BITS),
        }
    }

    /// Returns the bits to try next, if more may help.
    fn next(self, before: &Self, max_level: u32) -> Option<u32> {
        let is_stuck = self.given_up.is_some() && self.given_up <= before.given_up && before.given_up.is_some();
        (!is_stuck).then(|| self.expected(max_level).max(self.bits + NARROW_BITS / 2))
    }
}
