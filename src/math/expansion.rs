//! The exact sign of a sum.
//!
//! # Source
//! Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", Discrete &
//! Computational Geometry 18 (1997), section 2.4: a sum of binary64 numbers is kept as an expansion, numbers that do not
//! overlap in order of magnitude, to which one more is added exactly.

use std::cmp::Ordering;

use crate::math::{DoubleDouble, Real};

/// The least magnitude of a length whose square [`Expansion::add_square`] takes without a loss to underflow: 2⁻⁴⁰⁰.
const MIN_LENGTH: f64 = f64::from_bits((1023 - 400) << 52);

/// The least magnitude of a product of two numbers that [`Expansion::add_product`] takes without a loss to underflow: 2⁻⁹⁰⁰.
const MIN_PRODUCT: f64 = f64::from_bits((1023 - 900) << 52);

/// A number that is the exact sum of its terms.
///
/// Exact as long as nothing overflows; products must not underflow, see [`Expansion::add_product`]. After an overflow it is
/// not 0.
#[derive(Clone, Debug, Default)]
pub struct Expansion {
    /// Do not overlap; magnitudes rise, and none is 0.
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
        if number == 0.0 {
            return;
        }
        let mut carried = number;
        self.terms.retain_mut(|term| {
            let sum = DoubleDouble::sum(carried, *term);
            *term = sum.lo();
            carried = sum.hi();
            *term != 0.0
        });
        if carried != 0.0 {
            self.terms.push(carried);
        }
    }

    /// Makes the sum of some products; `None` when one of them is so small that it may underflow.
    #[must_use]
    pub fn of_products<const N: usize>(products: [[f64; 2]; N]) -> Option<Self> {
        let mut sum = Self::new();
        for [a, b] in products {
            let is_sound = a == 0.0 || b == 0.0 || (a * b).abs() >= MIN_PRODUCT;
            is_sound.then(|| sum.add_product(a, b))?;
        }
        Some(sum)
    }

    /// Adds a·b, whose magnitude is 0 or at least 2⁻⁹⁰⁰.
    pub fn add_product(&mut self, a: f64, b: f64) {
        let product = DoubleDouble::product(a, b);
        self.add(product.lo());
        self.add(product.hi());
    }

    /// Adds (a + b)², or takes it away for a `sign` of −1, and tells whether that is exact: whether no length is so small that
    /// a product may underflow.
    ///
    /// The sum is exactly that of two numbers, and its square that of three products.
    #[must_use]
    pub fn add_square(&mut self, a: f64, b: f64, sign: f64) -> bool {
        let exact = DoubleDouble::sum(a, b);
        let is_sound = |number: f64| number == 0.0 || number.abs() >= MIN_LENGTH;
        self.add_product(exact.hi(), sign * exact.hi());
        if exact.lo() != 0.0 {
            self.add_product(2.0 * exact.hi(), sign * exact.lo());
            self.add_product(exact.lo(), sign * exact.lo());
        }
        is_sound(exact.hi()) && is_sound(exact.lo())
    }

    /// Returns the power of a point with regard to a circle or sphere, |p − c|² − r²: below 0 inside, 0 on it. `None` when a
    /// length is so small that a product may underflow.
    #[must_use]
    pub fn power_of_point<const N: usize>(point: [f64; N], center: [f64; N], radius: f64) -> Option<Self> {
        let mut power = Self::new();
        let mut is_exact = power.add_square(radius, 0.0, -1.0);
        for (coordinate, center) in point.into_iter().zip(center) {
            is_exact &= power.add_square(coordinate, -center, 1.0);
        }
        is_exact.then_some(power)
    }

    /// Returns the sum of two numbers.
    #[must_use]
    pub fn plus(mut self, other: &Self) -> Self {
        other.terms.iter().for_each(|term| self.add(*term));
        self
    }

    /// Returns the product of two numbers; `None` when that of two terms is so small that it may underflow.
    #[must_use]
    pub fn times(&self, other: &Self) -> Option<Self> {
        let mut product = Self::new();
        for term in &other.terms {
            product = product.plus(&self.scaled(*term)?);
        }
        Some(product)
    }

    /// Returns the product with a binary64 number; `None` when that of a term is so small that it may underflow.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Option<Self> {
        let mut product = Self::new();
        for term in &self.terms {
            product = product.plus(&Self::of_products([[*term, factor]])?);
        }
        Some(product)
    }

    /// Tells whether the number is 0.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// Returns the number with a bound on what is lost to rounding; 0 is exact.
    #[must_use]
    pub fn rounded<R: Real>(&self) -> R {
        // From the smallest on: the bound is some roundings of the largest term.
        self.terms.iter().fold(R::exact(0.0), |sum, term| sum + R::exact(*term))
    }

    /// Compares with 0.
    #[must_use]
    pub fn compare_zero(&self) -> Ordering {
        // The largest term outweighs all smaller ones together.
        self.terms.last().map_or(Ordering::Equal, |term| term.total_cmp(&0.0))
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

/// Returns on which side of a circle or sphere a point lies, exactly: the sign of |p − c|² − r², `Less` inside. `None` when a
/// length is so small that this cannot be told.
#[must_use]
pub fn side_of<const N: usize>(point: [f64; N], center: [f64; N], radius: f64) -> Option<Ordering> {
    let lengths = point.into_iter().zip(center).map(|(coordinate, center)| coordinate - center);
    let distance_squared: f64 = lengths.map(|length| length * length).sum();
    let radius_squared = radius * radius;
    let power = distance_squared - radius_squared;
    // A square is off by 3 roundings of itself, each of the N − 1 additions and the difference by one; mostly that decides.
    let slack = (distance_squared + radius_squared) * ((N + 4) as f64 * f64::EPSILON) + f64::MIN_POSITIVE;
    if power.abs() > slack {
        return Some(power.total_cmp(&0.0));
    }
    Expansion::power_of_point(point, center, radius).map(|power| power.compare_zero())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Ball64, Ball106, Sign};
    use crate::testing::Stream;

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

    #[test]
    fn the_square_of_a_sum_that_no_binary64_holds_is_exact() {
        let small = libm::ldexp(1.0, -60);
        let mut sum = Expansion::new();
        assert!(sum.add_square(3.0, small, 1.0));
        sum.add(-9.0);
        sum.add(-6.0 * small);
        assert_eq!(sum.compare_zero(), Ordering::Greater, "(3 + e)² is above 9 + 6e");
        sum.add(-small * small);
        assert_eq!(sum.compare_zero(), Ordering::Equal);
    }

    #[test]
    fn a_rounded_sum_holds_it() {
        fn check<R: Real + std::fmt::Debug>() {
            let mut sum = Expansion::new();
            [3.0, libm::ldexp(-1.0, -60), libm::ldexp(1.0, -130)].into_iter().for_each(|term| sum.add(term));
            let rounded: R = sum.rounded();
            assert_eq!((rounded - R::exact(2.5)).sign(), Sign::Positive);
            assert_eq!((rounded - R::exact(3.5)).sign(), Sign::Negative);
            assert!(rounded.error() > 0.0 && rounded.error() < 1e-15, "{rounded:?}");
            assert_eq!(Expansion::new().rounded::<R>().sign(), Sign::Zero);
        }
        check::<Ball64>();
        check::<Ball106>();
    }

    /// A point of whole numbers and its distance from 0, whole too, by Lebesgue's identity; of `bits` + 4 bits at most.
    fn whole_quadruple(stream: &mut Stream, bits: i32) -> ([f64; 3], f64) {
        let [m, n, p, q] = [0; 4].map(|_| stream.below(1 << (bits / 2)) as f64);
        let point = [m * m + n * n - p * p - q * q, 2.0 * (m * q + n * p), 2.0 * (n * q - m * p)];
        (point, m * m + n * n + p * p + q * q)
    }

    #[test]
    fn the_side_of_a_point_on_a_sphere_is_known_to_the_last_bit() {
        let mut stream = Stream::new(11);
        for _ in 0..5_000 {
            let (offset, radius) = whole_quadruple(&mut stream, 49);
            if radius == 0.0 {
                continue;
            }
            let scale = libm::ldexp(1.0, stream.below(400) as i32 - 200);
            // Whole numbers below 2⁵²: their sum has no more than 53 bits.
            let center = offset.map(|_| (stream.below(1 << 51) as f64 - (1u64 << 50) as f64) * scale);
            let point = std::array::from_fn(|axis| center[axis] + offset[axis] * scale);
            let radius = radius * scale;
            let radii = [radius, radius.next_down(), radius.next_up()];
            let sides = [Ordering::Equal, Ordering::Greater, Ordering::Less];
            let signs = [Sign::Zero, Sign::Positive, Sign::Negative];
            for ((radius, side), sign) in radii.into_iter().zip(sides).zip(signs) {
                assert_eq!(side_of(point, center, radius), Some(side), "{point:?} {center:?} {radius}");
                assert_eq!(Ball64::power_of_point(point.map(Ball64::exact), center, radius).sign(), sign);
                assert_eq!(Ball106::power_of_point(point.map(Ball106::exact), center, radius).sign(), sign);
            }
        }
    }

    #[test]
    fn lengths_whose_squares_underflow_have_no_side_unless_it_is_clear() {
        assert_eq!(side_of([3e-200, 4e-200], [0.0; 2], 5e-200), None);
        assert_eq!(side_of([3e-200, 4e-200], [0.0; 2], 1.0), Some(Ordering::Less));
        assert_eq!(side_of([0.0; 3], [0.0; 3], 5e-324), None);
    }
}
