//! The numbers that algebra computes with: polynomials in κ, and what square roots add to them.

use std::cmp::Ordering;

use crate::exact::algebra::Kappa;
use crate::exact::ball::Ball;

/// Word products, or thereabouts, that one question may cost: about a millisecond.
const MAX_WORK: usize = 1 << 18;

/// What one product of numbers costs besides that of its words.
const WORK_A_PRODUCT: usize = 16;

/// A number without division: everything in it is computed without rounding.
#[derive(Clone, Debug)]
pub enum Element {
    /// A polynomial in κ: coefficients of rising powers, of which the last is not 0.
    Polynomial(Vec<Ball>),
    /// u + v √r with the root of this number in its field; u and v have roots of lower numbers alone, and v is no empty
    /// polynomial.
    Surd { root_idx: usize, parts: Box<[Element; 2]> },
}

impl Element {
    /// Makes a number of a scene.
    pub fn number(value: f64) -> Self {
        Self::Polynomial(vec![Ball::unrounded(value)]).trimmed()
    }

    /// Makes u + v √r.
    fn surd(root_idx: usize, u: Self, v: Self) -> Self {
        if v.is_void() { u } else { Self::Surd { root_idx, parts: Box::new([u, v]) } }
    }

    /// Tells whether this is written as 0. What is not may be 0 all the same: see [`Field::sign`].
    pub fn is_void(&self) -> bool {
        matches!(self, Self::Polynomial(coefficients) if coefficients.is_empty())
    }

    fn trimmed(mut self) -> Self {
        if let Self::Polynomial(coefficients) = &mut self {
            while coefficients.pop_if(|last| last.is_zero()).is_some() {}
        }
        self
    }

    /// Returns one more than the number of its highest root; 0 without roots.
    fn level(&self) -> usize {
        match self {
            Self::Polynomial(_) => 0,
            Self::Surd { root_idx, .. } => root_idx + 1,
        }
    }

    pub fn plus(&self, other: &Self) -> Self {
        match (self, other) {
            (Self::Polynomial(one), Self::Polynomial(two)) => {
                let (long, short) = if one.len() >= two.len() { (one, two) } else { (two, one) };
                let mut sum = long.clone();
                sum.iter_mut().zip(short).for_each(|(sum, term)| *sum = &*sum + term);
                Self::Polynomial(sum).trimmed()
            }
            (Self::Surd { root_idx, parts: one }, Self::Surd { parts: two, .. }) if self.level() == other.level() => {
                Self::surd(*root_idx, one[0].plus(&two[0]), one[1].plus(&two[1]))
            }
            (Self::Surd { root_idx, parts }, _) if self.level() > other.level() => {
                Self::surd(*root_idx, parts[0].plus(other), parts[1].clone())
            }
            _ => other.plus(self),
        }
    }

    pub fn negated(&self) -> Self {
        match self {
            Self::Polynomial(coefficients) => Self::Polynomial(coefficients.iter().map(|c| -c).collect()),
            Self::Surd { root_idx, parts } => Self::surd(*root_idx, parts[0].negated(), parts[1].negated()),
        }
    }

    /// Tells whether two are written alike.
    pub fn is_same(&self, other: &Self) -> bool {
        self.plus(&other.negated()).is_void()
    }
}

/// The roots that were taken so far, and the work done for the question at hand.
#[derive(Debug)]
pub struct Field {
    kappa: Kappa,
    /// What the roots are taken of, all above 0. Each has roots of lower numbers alone.
    radicands: Vec<Element>,
    work: usize,
}

impl Field {
    pub fn new(kappa: Kappa) -> Self {
        Self { kappa, radicands: Vec::new(), work: 0 }
    }

    /// Begins another question.
    pub fn rest(&mut self) {
        self.work = 0;
    }

    /// Returns the work that the question has cost so far, in word products.
    pub fn work(&self) -> usize {
        self.work
    }

    /// Returns κ.
    pub fn kappa(&self) -> Element {
        match self.kappa {
            Kappa::One => Element::number(1.0),
            Kappa::RootOf3 | Kappa::Unknown(_) => Element::Polynomial([0.0, 1.0].map(Ball::unrounded).into()),
        }
    }

    /// Multiplies; `None` when the work is too much.
    pub fn product(&mut self, one: &Element, two: &Element) -> Option<Element> {
        match (one, two) {
            (Element::Polynomial(one), Element::Polynomial(two)) => self.product_of_polynomials(one, two),
            (Element::Surd { root_idx, parts: one_parts }, Element::Surd { parts: two_parts, .. })
                if one.level() == two.level() =>
            {
                let ([u, v], [x, y]) = (&**one_parts, &**two_parts);
                let radicand = self.radicands[*root_idx].clone();
                let with_radicand = self.product(v, y).and_then(|vy| self.product(&vy, &radicand))?;
                let rational = self.product(u, x)?.plus(&with_radicand);
                let mixed = self.product(u, y)?.plus(&self.product(v, x)?);
                Some(Element::surd(*root_idx, rational, mixed))
            }
            (Element::Surd { root_idx, parts }, _) if one.level() > two.level() => {
                let [u, v] = &**parts;
                Some(Element::surd(*root_idx, self.product(u, two)?, self.product(v, two)?))
            }
            _ => self.product(two, one),
        }
    }

    fn product_of_polynomials(&mut self, one: &[Ball], two: &[Ball]) -> Option<Element> {
        if one.is_empty() || two.is_empty() {
            return Some(Element::number(0.0));
        }
        let n_words = |p: &[Ball]| p.iter().map(Ball::n_words).sum::<usize>();
        self.work += n_words(one) * n_words(two) + one.len() * two.len() * WORK_A_PRODUCT;
        if self.work > MAX_WORK {
            return None;
        }
        let mut product = vec![Ball::unrounded(0.0); one.len() + two.len() - 1];
        for (i, a) in one.iter().enumerate() {
            for (k, b) in two.iter().enumerate() {
                product[i + k] = &product[i + k] + &(a * b);
            }
        }
        if let Kappa::RootOf3 = self.kappa {
            // κ² = 3, from the highest power down.
            while product.len() > 2
                && let Some(last) = product.pop()
            {
                let below = product.len() - 2;
                product[below] = &product[below] + &(&last * &Ball::unrounded(3.0));
            }
        }
        Some(Element::Polynomial(product).trimmed())
    }

    /// Returns the square root of a number that is above 0.
    pub fn root(&mut self, radicand: Element) -> Element {
        let root_idx = self.radicands.iter().position(|known| known.is_same(&radicand)).unwrap_or_else(|| {
            self.radicands.push(radicand);
            self.radicands.len() - 1
        });
        Element::surd(root_idx, Element::number(0.0), Element::number(1.0))
    }

    /// Returns the sign of a number; `None` when the work is too much, or κ is not known well enough.
    pub fn sign(&mut self, element: &Element) -> Option<Ordering> {
        match element {
            Element::Polynomial(coefficients) => match (&**coefficients, &self.kappa) {
                ([], _) => Some(Ordering::Equal),
                ([number], _) => number.sign(),
                ([u, v], Kappa::RootOf3) => {
                    let compared = || (&u.square() - &(&v.square() * &Ball::unrounded(3.0))).sign();
                    sign_of_sum(u.sign()?, v.sign()?, compared)
                }
                (coefficients, Kappa::Unknown(kappa)) => {
                    let zero = kappa.like(0.0);
                    let rounded = coefficients.iter().rev().map(|c| c.at_precision(kappa.bits()));
                    rounded.fold(zero, |sum, c| &(&sum * kappa) + &c).sign()
                }
                (_, Kappa::One | Kappa::RootOf3) => unreachable!("higher powers of κ are reduced"),
            },
            Element::Surd { root_idx, parts } => {
                let [u, v] = &**parts;
                let (sign_u, sign_v) = (self.sign(u)?, self.sign(v)?);
                sign_of_sum(sign_u, sign_v, || {
                    let radicand = self.radicands[*root_idx].clone();
                    let square = self.product(u, u)?;
                    let with_radicand = self.product(v, v).and_then(|vv| self.product(&vv, &radicand))?;
                    self.sign(&square.plus(&with_radicand.negated()))
                })
            }
        }
    }
}

/// Returns the sign of u + v √r with r > 0 from those of u, of v and, where these are opposite, of u² − v² r.
fn sign_of_sum(u: Ordering, v: Ordering, compared: impl FnOnce() -> Option<Ordering>) -> Option<Ordering> {
    match (u, v) {
        (_, Ordering::Equal) => Some(u),
        (Ordering::Equal, _) => Some(v),
        _ if u == v => Some(u),
        (Ordering::Greater, _) => compared(),
        (Ordering::Less, _) => compared().map(Ordering::reverse),
    }
}
