//! The making of one pixel at one precision: the semantics page from eye ray to bytes.

use std::cell::Cell;
use std::cmp::Ordering;

use clisc::plan::{Part, SampleAt, Settings};

use super::Pixel;
use super::ball::Ball;
use super::intersect::{Hit, Ray};
use super::scene::{Equation, Scene, Surface};
use super::tie::{Tie, Ties};
use super::vec3::{Vec3, add, divide, dot, negate, scale, sub};

/// Added to 255 c before it is rounded down, so that 0.6 = 153/255 gives 153.
const QUANTISE_BIAS: f64 = 1.0 / 1_048_576.0;

/// A hit with what its shading needs: its point, and the normal turned against the ray.
struct Meeting<'r> {
    ray: &'r Ray,
    equation: Equation,
    p: Vec3,
    n: Vec3,
    level: u32,
}

/// A comparison could not be decided at this precision.
pub struct Undecided;

/// An answer, unless it takes more bits.
pub type Decided<T> = Result<T, Undecided>;

/// The making of one pixel at one precision.
pub struct Run<'s> {
    pub scene: &'s Scene,
    pub settings: &'s Settings,
    /// What cannot be decided at the last precision is a tie.
    is_last: bool,
    /// Whether the filter in binary64 is off.
    pub tests_all: bool,
    proved: Cell<Ties>,
    open: Cell<Ties>,
}

impl<'s> Run<'s> {
    /// Begins a pixel.
    pub fn new(scene: &'s Scene, settings: &'s Settings, is_last: bool, tests_all: bool) -> Self {
        Self { scene, settings, is_last, tests_all, proved: Cell::default(), open: Cell::default() }
    }

    /// Decides the sign of a number.
    pub fn sign(&self, value: &Ball, tie: Tie) -> Decided<Ordering> {
        self.decide(value.sign(), tie)
    }

    /// Takes a sign, or the lack of one, for a decision.
    pub fn decide(&self, sign: Option<Ordering>, tie: Tie) -> Decided<Ordering> {
        let ties = match sign {
            Some(Ordering::Equal) => &self.proved,
            Some(sign) => return Ok(sign),
            None if self.is_last => &self.open,
            None => return Err(Undecided),
        };
        let mut counts = ties.get();
        counts.count(tie);
        ties.set(counts);
        Ok(Ordering::Equal)
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
        let average = divide(&sum, &self.ball(f64::from(n) * f64::from(n)));
        let mut pixel = Pixel {
            rgb: [0; 3],
            channels: [0.0; 3],
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
        let [width, height] = [self.settings.size.width(), self.settings.size.height()].map(f64::from);
        // Twice the offset in pixels: 2 ((s + 1/2) / n − 1/2), and 1 more for the centre.
        let twice_offset = |sample: u32| {
            let offset = &self.ball(2.0 * f64::from(sample) + 1.0 - n) / &self.ball(n);
            match self.settings.sample_at {
                SampleAt::Corner => offset,
                SampleAt::Centre => &offset + &self.ball(1.0),
            }
        };
        let x = &self.ball(2.0 * f64::from(column) - width) + &twice_offset(sample_column);
        let y = &self.ball(height - 2.0 * f64::from(row)) - &twice_offset(sample_row);
        let k_over_h = &self.scene.k / &self.ball(height);
        let dir = [&x * &k_over_h, &y * &k_over_h, self.ball(-1.0)];
        Ray::new([0.0; 3].map(|zero| self.ball(zero)), dir, None)
    }

    /// Returns the colour of a ray, clamped.
    fn radiance(&self, ray: &Ray, level: u32) -> Decided<Vec3> {
        let color = match self.intersect(ray)? {
            None => self.scene.background.clone(),
            Some(_) if level > self.settings.max_level => [0.0; 3].map(|zero| self.ball(zero)),
            Some(hit) => self.shade(ray, &hit, level)?,
        };
        Ok(color.map(|channel| channel.clamp01()))
    }

    fn shade(&self, ray: &Ray, hit: &Hit, level: u32) -> Decided<Vec3> {
        let surface = &self.scene.surfaces[hit.primitive.surface];
        let quadric = &hit.primitive.quadric;
        let mut p = ray.at(&hit.t);
        let mut n = match hit.cap {
            Some(cap) => {
                p[1] = cap.y.clone();
                [0.0, cap.normal, 0.0].map(|component| self.ball(component))
            }
            None => divide(&quadric.offset(&p), &quadric.radius),
        };
        if self.sign(&dot(&n, &ray.dir), Tie::Facing)? == Ordering::Greater {
            n = negate(&n);
        }
        match self.settings.part {
            Part::A => self.shade_part_a(surface, &p, &n),
            Part::B => self.shade_part_b(surface, &Meeting { ray, equation: hit.equation, p, n, level }),
        }
    }

    /// Part A: c = Σ Cl · Cd · max(0, n·L).
    fn shade_part_a(&self, surface: &Surface, p: &Vec3, n: &Vec3) -> Decided<Vec3> {
        let mut color = [0.0; 3].map(|zero| self.ball(zero));
        for light in &self.scene.lights {
            let to_light = sub(&light.position, p);
            let square = dot(&to_light, &to_light);
            if self.sign(&square, Tie::AtLight)? == Ordering::Equal {
                continue;
            }
            let n_dot_l = (&dot(n, &to_light) / &square.sqrt()).max0();
            color = std::array::from_fn(|axis| {
                let term = &(&light.color[axis] * &surface.diffuse[axis]) * &n_dot_l;
                &color[axis] + &term
            });
        }
        Ok(color)
    }

    /// Part B: c = Ca + Σ Cl · (Cd · (n·L) + Cs · (n·H)^P) + Krefl · colour(reflected ray).
    fn shade_part_b(&self, surface: &Surface, meeting: &Meeting<'_>) -> Decided<Vec3> {
        let Meeting { ray, equation, p, n, level } = meeting;
        let v = divide(&negate(&ray.dir), &dot(&ray.dir, &ray.dir).sqrt());
        let mut color = surface.ambient.clone();
        for (light_idx, light) in self.scene.lights.iter().enumerate() {
            let to_light = sub(&light.position, p);
            let square = dot(&to_light, &to_light);
            if self.sign(&square, Tie::AtLight)? == Ordering::Equal {
                continue;
            }
            let n_dot_to_light = dot(n, &to_light);
            if self.sign(&n_dot_to_light, Tie::Lit)? != Ordering::Greater {
                continue;
            }
            if self.is_occluded(&Ray::new(p.clone(), to_light.clone(), Some(*equation)), light_idx)? {
                continue;
            }
            let distance = square.sqrt();
            let n_dot_l = &n_dot_to_light / &distance;
            let l_plus_v = add(&divide(&to_light, &distance), &v);
            let n_dot_h = &dot(n, &l_plus_v) / &dot(&l_plus_v, &l_plus_v).sqrt();
            let highlight = n_dot_h.pow(surface.shininess);
            color = std::array::from_fn(|axis| {
                let diffuse = &surface.diffuse[axis] * &n_dot_l;
                let specular = &surface.specular[axis] * &highlight;
                &color[axis] + &(&light.color[axis] * &(&diffuse + &specular))
            });
        }
        if surface.reflectance.sign() == Some(Ordering::Greater) {
            let turned = scale(&dot(n, &ray.dir).double(), n);
            let reflected = Ray::new(p.clone(), sub(&ray.dir, &turned), Some(*equation));
            let radiance = self.radiance(&reflected, level + 1)?;
            color = add(&color, &scale(&surface.reflectance, &radiance));
        }
        Ok(color)
    }
}
