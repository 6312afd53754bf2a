//! The exact sign of a sum.
//!
//! # Source
//! Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", Discrete &
//! Computational Geometry 18 (1997), section 2.4: a sum of binary64 numbers is kept as an expansion, numbers that do not
//! overlap in order of magnitude, to which one more is added exactly.

use std::cmp::Ordering;

use crate::math::DoubleDouble;

/// A number that is the exact sum of its terms.
///
/// Exact as long as nothing overflows; products must not underflow, see [`Expansion::add_product`].
#[derive(Clone, Debug, Default)]
pub struct Expansion {
    /// Do not overlap; magnitudes rise, zeros between them.
    terms: Vec<f64>,
}

impl Expansion {
    /// Makes 0.
    #[must_use]
    pub const fn new() -> Self {
        Self { terms: Vec::new() }
    }

    /// Adds a number.
    pub fn add(&mut self, number: f64) {
        let mut carried = number;
        for term in &mut self.terms {
            let sum = DoubleDouble::sum(carried, *term);
            *term = sum.lo();
            carried = sum.hi();
        }
        self.terms.push(carried);
    }

    /// Adds a·b, whose magnitude is 0 or at least 2⁻⁹⁰⁰.
    pub fn add_product(&mut self, a: f64, b: f64) {
        let product = DoubleDouble::product(a, b);
        self.add(product.lo());
        self.add(product.hi());
    }

    /// Compares with 0.
    #[must_use]
    pub fn compare_zero(&self) -> Ordering {
        // The largest term that is not 0 outweighs all smaller ones together.
        let leading = self.terms.iter().rev().find(|term| **term != 0.0);
        leading.map_or(Ordering::Equal, |term| term.total_cmp(&0.0))
    }
}

/// Compares the exact sum of `numbers` with 0.
#[must_use]
pub fn compare_sum_zero<const N: usize>(numbers: [f64; N]) -> Ordering {
    // Each of the N − 1 additions is off by at most 2⁻⁵³ of a partial sum; mostly that decides.
    let rounded: f64 = numbers.iter().sum();
    let magnitude: f64 = numbers.iter().map(|number| number.abs()).sum();
    if rounded.abs() > magnitude * (N as f64 * f64::EPSILON) {
        return rounded.total_cmp(&0.0);
    }
    let mut sum = Expansion::new();
    numbers.into_iter().for_each(|number| sum.add(number));
    sum.compare_zero()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_that_rounding_hides_has_its_sign() {
        assert_eq!(compare_sum_zero([1.0, 1e-300, -1.0]), Ordering::Greater);
        assert_eq!(compare_sum_zero([1e16, 1.0, -1e16, -1.0]), Ordering::Equal);
        assert_eq!(compare_sum_zero([0.3, -0.1, -0.2]), Ordering::Less, "0.3 is below 0.1 + 0.2 in binary64");
        assert_eq!(compare_sum_zero([-0.0, 0.0]), Ordering::Equal);
    }

    #[test]
    fn products_are_exact() {
        let mut sum = Expansion::new();
        let (a, b) = (1.0 + f64::EPSILON, 1.0 - f64::EPSILON);
        sum.add_product(a, b);
        sum.add(-1.0);
        assert_eq!(sum.compare_zero(), Ordering::Less, "(1 + e)(1 - e) is 1 - e²");
        sum.add_product(f64::EPSILON, f64::EPSILON);
        assert_eq!(sum.compare_zero(), Ordering::Equal);
    }
}
