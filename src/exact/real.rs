//! Numbers of the renderer: a ball, and where algebra may be asked, how it was made.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::exact::algebra::{Expression, Kappa, Made};
use crate::exact::ball::Ball;

/// With how many bits numbers are computed, and whether they remember how.
#[derive(Clone, Copy, Debug)]
pub struct Arithmetic {
    pub bits: usize,
    /// Whether algebra is asked what balls leave open.
    pub has_algebra: bool,
}

impl Arithmetic {
    /// Makes a number of the scene.
    pub fn number(self, value: f64) -> Real {
        let ball = Ball::exact(value, self.bits);
        let expression = if self.has_algebra { Expression::new(Made::Number(value)) } else { None };
        Real { ball, expression }
    }

    /// Returns the same without memory: for what nothing is decided by.
    pub fn forgetful(self) -> Self {
        Self { has_algebra: false, ..self }
    }

    /// Makes the vector of three numbers.
    pub fn vec3(self, values: [f64; 3]) -> [Real; 3] {
        values.map(|value| self.number(value))
    }

    /// Returns k = tan(fov/2), and what algebra knows of it.
    pub fn half_width(self, fov_deg: f64) -> (Real, Kappa) {
        let ball = Ball::tan_half_degrees(fov_deg, self.bits);
        let kappa = match fov_deg {
            90.0 => Kappa::One,
            60.0 | 120.0 => Kappa::RootOf3,
            _ => Kappa::Unknown(ball.clone()),
        };
        let unit = if self.has_algebra { Expression::new(Made::Kappa) } else { None };
        let third = |unit| Expression::new(Made::Quotient(unit, Expression::new(Made::Number(3.0))?));
        let expression = if fov_deg == 60.0 { unit.and_then(third) } else { unit };
        (Real { ball, expression }, kappa)
    }
}

/// A number of the renderer.
#[derive(Clone, Debug)]
pub struct Real {
    ball: Ball,
    /// How it was made, if algebra can follow. The true number that the ball holds is this one.
    expression: Option<Expression>,
}

impl Real {
    /// Makes a number of which nothing is known but the ball.
    fn unexplained(ball: Ball) -> Self {
        Self { ball, expression: None }
    }

    /// Returns the number without how it was made.
    pub fn forget(&self) -> Self {
        Self::unexplained(self.ball.clone())
    }

    pub fn expression(&self) -> Option<&Expression> {
        self.expression.as_ref()
    }

    /// Returns an exact number, to be computed with as with `self`.
    pub fn like(&self, value: f64) -> Self {
        let expression = self.expression.as_ref().and_then(|_| Expression::new(Made::Number(value)));
        Self { ball: self.ball.like(value), expression }
    }

    /// Returns the sign, if the ball tells it. `Equal` means exactly 0.
    pub fn sign(&self) -> Option<Ordering> {
        self.ball.sign()
    }

    /// Tells whether this is exactly 0 without any algebra.
    pub fn is_zero(&self) -> bool {
        self.ball.is_zero()
    }

    pub fn to_f64(&self) -> f64 {
        self.ball.to_f64()
    }

    /// Returns an upper bound of the distance to the truth.
    pub fn radius(&self) -> f64 {
        self.ball.radius()
    }

    /// See [`Ball::is_sharp_beside`].
    pub fn is_sharp_beside(&self, largest: &Self, bits: i64) -> bool {
        self.ball.is_sharp_beside(&largest.ball, bits)
    }

    pub fn sqrt(&self) -> Self {
        let expression = self.expression.clone().and_then(|a| Expression::new(Made::Root(a)));
        Self { ball: self.ball.sqrt(), expression }
    }

    pub fn square(&self) -> Self {
        self * self
    }

    pub fn double(&self) -> Self {
        self + self
    }

    /// Returns a number of which nothing is known but that it lies between this one and 0.
    pub fn or_zero(&self) -> Self {
        Self::unexplained(self.ball.or_zero())
    }

    pub fn clamp01(&self) -> Self {
        Self::unexplained(self.ball.clamp01())
    }

    pub fn max0(&self) -> Self {
        Self::unexplained(self.ball.max0())
    }

    pub fn pow(&self, exponent: f64) -> Self {
        Self::unexplained(self.ball.pow(exponent))
    }
}

/// Combines how two numbers were made.
fn combined(made: fn(Expression, Expression) -> Made, a: &Real, b: &Real) -> Option<Expression> {
    Expression::new(made(a.expression.clone()?, b.expression.clone()?))
}

impl Add for &Real {
    type Output = Real;

    fn add(self, other: &Real) -> Real {
        Real { ball: &self.ball + &other.ball, expression: combined(Made::Sum, self, other) }
    }
}

impl Sub for &Real {
    type Output = Real;

    fn sub(self, other: &Real) -> Real {
        Real { ball: &self.ball - &other.ball, expression: combined(Made::Difference, self, other) }
    }
}

impl Mul for &Real {
    type Output = Real;

    fn mul(self, other: &Real) -> Real {
        Real { ball: &self.ball * &other.ball, expression: combined(Made::Product, self, other) }
    }
}

impl Div for &Real {
    type Output = Real;

    fn div(self, other: &Real) -> Real {
        Real { ball: &self.ball / &other.ball, expression: combined(Made::Quotient, self, other) }
    }
}

impl Neg for &Real {
    type Output = Real;

    fn neg(self) -> Real {
        let expression = self
            .expression
            .clone()
            .and_then(|a| Expression::new(Made::Difference(Expression::new(Made::Number(0.0))?, a)));
        Real { ball: -&self.ball, expression }
    }
}
