//! Where eye rays go, and which of them touch a surface exactly.
//!
//! # Algebra
//! In steps, of which half the height of the image has N = n·H, an eye ray goes through (X, Y) with whole X and Y along
//! (X·k, Y·k, −N), times 1/N. For a field of view of 60, 90 and 120 degrees k = tan(fov/2) is 1/√3, 1 and √3, and the ray
//! goes along (X√w, Y√w, −M) with w = 3, 1, 3 and M = 3N, N, N. Its discriminant with a sphere about c, from which the eye has
//! the power p = |c|² − r², is, up to a square factor,
//!
//! (√w·P − M·c_z)² − (w·(X² + Y²) + M²)·p   with   P = X·c_x + Y·c_y,
//!
//! and with a wall the same without y. All but √w is a sum of products of whole numbers and numbers of the scene, and can
//! be computed without rounding. For w = 1 so can the discriminant. For w = 3 it is α + β√3 with rational α and β, which is 0
//! only when both are, as √3 is irrational: when P·M·c_z = 0 and w·P² + M²·c_z² = (w·(X² + Y²) + M²)·p.

use crate::exact::Settings;
use crate::exact::ball::Ball;
use crate::exact::reach::Reach;

/// The grid of places that eye rays go through.
#[derive(Debug)]
pub struct Grid {
    /// k/N: how far from one step to the next, at z = −1.
    pub step: Ball,
    /// w and M, where k is the root of a rational number.
    root: Option<[f64; 2]>,
}

impl Grid {
    /// Makes the grid of an image at one precision.
    pub fn new(fov_deg: f64, settings: &Settings, bits: usize) -> Self {
        let n_steps = f64::from(settings.samples) * f64::from(settings.height);
        let root = match fov_deg {
            60.0 => Some([3.0, 3.0 * n_steps]),
            90.0 => Some([1.0, n_steps]),
            120.0 => Some([3.0, n_steps]),
            _ => None,
        };
        Self { step: &Ball::tan_half_degrees(fov_deg, bits) / &Ball::exact(n_steps, bits), root }
    }

    /// Proves, if it can, that the eye ray through a place touches a sphere or an infinite wall: that its discriminant is 0.
    pub fn touches(&self, [x, y]: [f64; 2], body: &Reach) -> bool {
        let Some([w, m]) = self.root else { return false };
        let Terms { across, power } = Terms::new([x, y], body);
        let axes = body.axes.iter().filter(|axis| **axis < 2);
        let squares = sum(axes.map(|&axis| Ball::unrounded([x, y][axis]).square()));
        let [m, w_exact] = [m, w].map(Ball::unrounded);
        let along = -&(&m * &Ball::unrounded(body.center[2]));
        let dir_squared = &(&w_exact * &squares) + &m.square();
        let rational = &(&(&w_exact * &across.square()) + &along.square()) - &(&dir_squared * &power);
        let mixed = (&across * &along).double();
        if w == 1.0 { (&rational + &mixed).is_zero() } else { rational.is_zero() && mixed.is_zero() }
    }
}

/// Proves, if it can, that the eye ray through a place has the same equation with two spheres, or with two infinite walls,
/// whatever k is: that P, c_z and p are the same. That holds for bodies that are each other's mirror image and rays in
/// the plane of the mirror.
pub fn has_same_quadratic(steps: [f64; 2], one: &Reach, other: &Reach) -> bool {
    if one.axes != other.axes || one.center[2] != other.center[2] {
        return false;
    }
    let [one, other] = [one, other].map(|body| Terms::new(steps, body));
    (&one.across - &other.across).is_zero() && (&one.power - &other.power).is_zero()
}

/// What of a ray and a body does not depend on k, without rounding.
struct Terms {
    /// P
    across: Ball,
    /// p
    power: Ball,
}

impl Terms {
    fn new(steps: [f64; 2], body: &Reach) -> Self {
        let center = body.center.map(Ball::unrounded);
        let across = body.axes.iter().filter(|axis| **axis < 2);
        let across = sum(across.map(|&axis| &Ball::unrounded(steps[axis]) * &center[axis]));
        let squared = sum(body.axes.iter().map(|&axis| center[axis].square()));
        Self { across, power: &squared - &Ball::unrounded(body.radius).square() }
    }
}

fn sum(terms: impl Iterator<Item = Ball>) -> Ball {
    terms.fold(Ball::unrounded(0.0), |sum, term| &sum + &term)
}
