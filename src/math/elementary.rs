//! Elementary functions in double-double.
//!
//! Series after a reduction of the argument, as in Muller, "Elementary Functions" (2016), chapters 5 and 11. The stated
//! bounds are generous: the operations add up to some hundred roundings of 2⁻¹⁰⁴; `tests` hold them against an arbitrary
//! precision library.

use crate::math::DoubleDouble;

/// π = PI.hi + PI.lo with an error below 2⁻¹⁰⁸.
const PI: DoubleDouble = DoubleDouble::from_parts(std::f64::consts::PI, 1.224_646_799_147_353_2e-16);

/// ln 2 with an error below 2⁻¹¹⁰.
const LN_2: DoubleDouble = DoubleDouble::from_parts(std::f64::consts::LN_2, 2.319_046_813_846_299_6e-17);

/// A bound on the relative error of [`tan_half_degrees`].
const TAN_ERROR: f64 = DoubleDouble::ROUNDOFF * 256.0;

/// Angles below this, 2⁻⁶⁰⁰ degrees, are known to binary64 only.
const SMALLEST_DEGREES: f64 = f64::from_bits((1023 - 600) << 52);

/// A bound on the relative error of `exp`, and of the absolute error of `ln` relative to max(1, |ln x|).
const EXP_LN_ERROR: f64 = DoubleDouble::ROUNDOFF * 4096.0;

/// Returns tan(degrees·π/360), the tangent of half an angle that is given in degrees and lies in 0…180, and a bound on
/// its relative error.
///
/// Above 90 degrees it is the cotangent of the complement, which is exact in double-double, so that nothing is lost near
/// the pole.
#[must_use]
pub fn tan_half_degrees(degrees: f64) -> (DoubleDouble, f64) {
    let turned = degrees > 90.0;
    let angle = if turned { DoubleDouble::sum(180.0, -degrees) } else { DoubleDouble::from(degrees) };
    let (sin, cos) = sin_cos(angle * PI / DoubleDouble::from(360.0));
    // The trailing part of a tiny angle underflows.
    let relative_error = if degrees < SMALLEST_DEGREES { 4.0 * f64::EPSILON } else { TAN_ERROR };
    (if turned { cos / sin } else { sin / cos }, relative_error)
}

/// Returns sine and cosine of an angle in 0…π/4 by their Taylor series.
fn sin_cos(angle: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
    const N_TERMS: u32 = 30; // (π/4)^30 / 30! is below 2^-117
    let (mut sin, mut cos) = (DoubleDouble::ZERO, DoubleDouble::ZERO);
    let mut term = DoubleDouble::ONE;
    for n in 0..N_TERMS {
        match n % 4 {
            0 => cos = cos + term,
            1 => sin = sin + term,
            2 => cos = cos - term,
            _ => sin = sin - term,
        }
        term = term * angle / DoubleDouble::from(f64::from(n + 1));
    }
    (sin, cos)
}

/// Returns x^p for x > 0 and p > 0, and a bound on its relative error (which assumes that x is exact).
pub(super) fn pow(x: DoubleDouble, exponent: f64) -> (DoubleDouble, f64) {
    let log = ln(x);
    let product = log * exponent;
    let error = EXP_LN_ERROR * (1.0 + exponent * log.hi().abs().max(1.0));
    (exp(product), error * 2.0)
}

/// Returns e^x for x ≤ 709: ln 2 is taken off as often as it goes, the rest halved nine times.
fn exp(x: DoubleDouble) -> DoubleDouble {
    const N_HALVINGS: i32 = 9;
    const N_TERMS: u32 = 12; // (ln 2 / 1024)^12 / 12! is below 2^-155
    if x.hi() < -740.0 {
        return DoubleDouble::ZERO;
    }
    let n_doublings = (x.hi() / LN_2.hi()).round();
    let rest = (x - LN_2 * n_doublings).scale(exp2(-N_HALVINGS));
    // e^rest − 1, by the series; then e^2y − 1 = (e^y − 1)² + 2·(e^y − 1) for each halving.
    let mut less_one = DoubleDouble::ZERO;
    let mut term = DoubleDouble::ONE;
    for n in 1..N_TERMS {
        term = term * rest / DoubleDouble::from(f64::from(n));
        less_one = less_one + term;
    }
    for _ in 0..N_HALVINGS {
        less_one = less_one.square() + less_one.scale(2.0);
    }
    let n_doublings = n_doublings as i32;
    // In two steps, because 2^-1074 has no reciprocal.
    (less_one + DoubleDouble::ONE).scale(exp2(n_doublings / 2)).scale(exp2(n_doublings - n_doublings / 2))
}

/// Returns the natural logarithm of x > 0: one step of Newton's method, of third order, from the binary64 logarithm.
fn ln(x: DoubleDouble) -> DoubleDouble {
    let guess = DoubleDouble::from(libm::log(x.hi()));
    // x = e^guess·(1 + r) and ln(1 + r) = r − r²/2 + …, with r of the order of 2^-50.
    let r = x * exp(-guess) - DoubleDouble::ONE;
    guess + r - r.square().scale(0.5)
}

/// Returns 2^n for n in −1022…1023.
fn exp2(n: i32) -> f64 {
    f64::from_bits(((1023 + n) as u64) << 52)
}
