//! The sign of a number by algebra, where no precision would tell: whether it is 0.
//!
//! A comparison of equal quantities stays open in any precision. But up to the rounding of a channel everything that the
//! semantics compare is made from the numbers of the scene and from k = tan(fov/2) by sums, products, quotients and square
//! roots, and of such a number the sign can be computed.
//!
//! # Method
//! An [`Expression`] says how a number was made. It is evaluated to a fraction, of which the denominator is a product of
//! known factors above 0, and the numerator an [`Element`] of a tower of extensions
//!
//! - at the bottom, polynomials in κ whose coefficients are binary fractions of any length. For a field of view of 60, 90
//!   and 120 degrees k is 1/√3, 1 and √3: κ is √3, 1 and √3, and κ² is replaced by what it is. For others κ is k, of which
//!   nothing is used but that the polynomial is 0 if its coefficients are, and else has the sign that [balls](Ball) prove.
//! - above, u + v √r for each root that was taken, with u, v and r > 0 from below. Its sign is that of both if u and v agree,
//!   else that of u² − v² r turned by that of u. This asks for signs from below, and ends at the bottom. It holds whether √r
//!   is new or could be written with what stands below: nothing is asked of the tower but real numbers.
//!
//! Nothing is rounded on the way, so an answer is proved. It may be none: numbers grow by each root, and the work for one
//! question is limited, by operations and not by the clock.
//!
//! # Source
//! Yap, "Towards exact geometric computation" (1997), for the paradigm; the sign of u + v √r is school algebra. Bounds on how
//! near to 0 such a number can be (Burnikel and others, "A separation bound for real algebraic expressions", 2001) would do
//! without the tower, but take thousands of bits for a decimal such as 0.1.

mod element;
mod expression;
#[cfg(test)]
mod tests;

pub use expression::{Expression, Made};

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::rc::Rc;

use crate::exact::algebra::element::{Element, Field};
use crate::exact::ball::Ball;

/// After so many questions without an answer a pixel asks no more.
const MAX_FAILURES: u32 = 8;

/// Word products, or thereabouts, that take as long as a unit of work.
const WORD_PRODUCTS_A_UNIT: u64 = 8;

/// The one number of a scene that need not be a binary fraction: k = tan(fov/2) is this, or a third of it for 60 degrees.
#[derive(Clone, Debug)]
pub enum Kappa {
    /// 1
    One,
    /// √3
    RootOf3,
    /// A number of which only this ball is known.
    Unknown(Ball),
}

/// n / Π fᵉ
#[derive(Clone, Debug)]
struct Fraction {
    numerator: Element,
    /// The exponent of each factor, by its number; none is 0.
    denominator: BTreeMap<usize, u32>,
}

/// Answers questions about the numbers of one pixel.
#[derive(Debug)]
pub struct Algebra {
    field: Field,
    /// What denominators are made of, all above 0.
    factors: Vec<Element>,
    /// What was evaluated so far, by its identity, which is kept alive.
    known: BTreeMap<usize, (Expression, Rc<Fraction>)>,
    n_failures: u32,
    work: usize,
}

impl Algebra {
    /// Begins with what is known of κ.
    pub fn new(kappa: Kappa) -> Self {
        Self { field: Field::new(kappa), factors: Vec::new(), known: BTreeMap::new(), n_failures: 0, work: 0 }
    }

    /// Returns the sign of a number, proved; `None` when that is too much work.
    pub fn sign(&mut self, expression: &Expression) -> Option<Ordering> {
        if self.n_failures >= MAX_FAILURES {
            return None;
        }
        self.field.rest();
        let sign = self.evaluate(expression).and_then(|fraction| self.field.sign(&fraction.numerator));
        self.n_failures += u32::from(sign.is_none());
        self.work += self.field.work();
        sign
    }

    /// Returns the work so far, in units of [`Pixel::work`](crate::exact::Pixel::work).
    pub fn work(&self) -> u64 {
        self.work as u64 / WORD_PRODUCTS_A_UNIT
    }

    /// Evaluates an expression; `None` when that is too much work, or it divides by 0 or takes the root of less.
    ///
    /// An expression is as deep as a path through mirrors is long, so what waits for its parts waits on a list of our own and
    /// not on the stack of the thread.
    fn evaluate(&mut self, expression: &Expression) -> Option<Rc<Fraction>> {
        let mut waiting = vec![expression.clone()];
        while let Some(next) = waiting.last() {
            let next = next.clone();
            if let Some(part) = next.parts().into_iter().flatten().find(|part| !self.is_known(part)) {
                waiting.push(part.clone());
                continue;
            }
            waiting.pop();
            if !self.is_known(&next) {
                let fraction = Rc::new(self.combine(next.made())?);
                self.known.insert(next.identity(), (next, fraction));
            }
        }
        self.look_up(expression)
    }

    /// Tells whether an expression need not be evaluated any more.
    fn is_known(&self, expression: &Expression) -> bool {
        match expression.made() {
            Made::Number(_) | Made::Kappa => true,
            _ => self.known.contains_key(&expression.identity()),
        }
    }

    /// Returns what was evaluated before, or needs no evaluation.
    fn look_up(&self, expression: &Expression) -> Option<Rc<Fraction>> {
        match expression.made() {
            Made::Number(value) => Some(Rc::new(Fraction::whole(Element::number(*value)))),
            Made::Kappa => Some(Rc::new(Fraction::whole(self.field.kappa()))),
            _ => self.known.get(&expression.identity()).map(|(_, fraction)| Rc::clone(fraction)),
        }
    }

    /// Does the last step of a computation, of which the parts are known.
    fn combine(&mut self, made: &Made) -> Option<Fraction> {
        let both = |a, b| Some([self.look_up(a)?, self.look_up(b)?]);
        match made {
            Made::Number(_) | Made::Kappa => unreachable!("leaves are known"),
            Made::Sum(a, b) => both(a, b).and_then(|[a, b]| self.sum(&a, &b, false)),
            Made::Difference(a, b) => both(a, b).and_then(|[a, b]| self.sum(&a, &b, true)),
            Made::Product(a, b) => {
                let [a, b] = both(a, b)?;
                let numerator = self.field.product(&a.numerator, &b.numerator)?;
                Some(Fraction { numerator, denominator: product_of_powers(a.denominator.clone(), &b.denominator) })
            }
            Made::Quotient(a, b) => both(a, b).and_then(|[a, b]| self.quotient(&a, &b)),
            Made::Root(a) => self.look_up(a).and_then(|a| self.root(&a)),
        }
    }

    fn sum(&mut self, a: &Fraction, b: &Fraction, is_difference: bool) -> Option<Fraction> {
        let mut denominator = a.denominator.clone();
        for (&factor, &exponent) in &b.denominator {
            let common = denominator.entry(factor).or_default();
            *common = exponent.max(*common);
        }
        let [a, b] = [self.numerator_over(a, &denominator)?, self.numerator_over(b, &denominator)?];
        let numerator = if is_difference { a.plus(&b.negated()) } else { a.plus(&b) };
        Some(Fraction { numerator, denominator })
    }

    /// Returns the numerator of a fraction once it is extended to a denominator.
    fn numerator_over(&mut self, fraction: &Fraction, denominator: &BTreeMap<usize, u32>) -> Option<Element> {
        let mut numerator = fraction.numerator.clone();
        for (factor, exponent) in denominator {
            let present = fraction.denominator.get(factor).copied().unwrap_or(0);
            for _ in present..*exponent {
                numerator = self.field.product(&numerator, &self.factors[*factor])?;
            }
        }
        Some(numerator)
    }

    /// (n/d) / (m/e) = n·e / (d·m), where factors that d and e share fall out.
    fn quotient(&mut self, a: &Fraction, b: &Fraction) -> Option<Fraction> {
        let mut numerator = a.numerator.clone();
        let mut denominator = a.denominator.clone();
        for (factor, &exponent) in &b.denominator {
            let shared = denominator.get(factor).map_or(0, |present| exponent.min(*present));
            for _ in shared..exponent {
                numerator = self.field.product(&numerator, &self.factors[*factor])?;
            }
            if let Some(present) = denominator.get_mut(factor) {
                *present -= shared;
            }
        }
        denominator.retain(|_, exponent| *exponent > 0);
        match self.field.sign(&b.numerator)? {
            Ordering::Equal => None,
            Ordering::Less => {
                *denominator.entry(self.factor(b.numerator.negated())).or_default() += 1;
                Some(Fraction { numerator: numerator.negated(), denominator })
            }
            Ordering::Greater => {
                *denominator.entry(self.factor(b.numerator.clone())).or_default() += 1;
                Some(Fraction { numerator, denominator })
            }
        }
    }

    /// √(n / Π fᵉ) = √(n·Π f) / Π f^⌈e/2⌉, with the product on the right over the factors of odd exponent.
    fn root(&mut self, a: &Fraction) -> Option<Fraction> {
        let Fraction { numerator: mut radicand, mut denominator } = a.clone();
        match self.field.sign(&radicand)? {
            Ordering::Less => return None,
            Ordering::Equal => return Some(Fraction::whole(Element::number(0.0))),
            Ordering::Greater => {}
        }
        for (factor, exponent) in &mut denominator {
            if *exponent % 2 == 1 {
                radicand = self.field.product(&radicand, &self.factors[*factor])?;
            }
            *exponent = exponent.div_ceil(2);
        }
        Some(Fraction { numerator: self.field.root(radicand), denominator })
    }

    /// Returns the number of a factor.
    fn factor(&mut self, element: Element) -> usize {
        self.factors.iter().position(|known| known.is_same(&element)).unwrap_or_else(|| {
            self.factors.push(element);
            self.factors.len() - 1
        })
    }
}

impl Fraction {
    fn whole(numerator: Element) -> Self {
        Self { numerator, denominator: BTreeMap::new() }
    }
}

fn product_of_powers(mut powers: BTreeMap<usize, u32>, others: &BTreeMap<usize, u32>) -> BTreeMap<usize, u32> {
    for (factor, exponent) in others {
        *powers.entry(*factor).or_default() += exponent;
    }
    powers
}
