//! Holds the bounds of the balls against arbitrary precision.

mod ends;

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;

use super::*;
use crate::testing::Stream;

type Big = FBig<HalfEven, 2>;

const PRECISION_BITS: usize = 400;

fn big(value: f64) -> Big {
    Big::try_from(value).expect("a finite number").with_precision(PRECISION_BITS).value()
}

fn big_double_double(value: DoubleDouble) -> Big {
    big(value.hi()) + big(value.lo())
}

/// A number in one of the arithmetics beside its exact value.
#[derive(Clone)]
struct Pair<R> {
    ball: R,
    exact: Big,
}

impl<R: Real> Pair<R> {
    /// Asserts that the ball holds the exact value. `tail` returns what `value()` leaves out.
    fn check(&self, what: &str, middle: impl Fn(R) -> Big) {
        if !self.ball.error().is_finite() {
            return;
        }
        let distance = self.exact.clone() - middle(self.ball);
        let distance = if distance < big(0.0) { -distance } else { distance };
        assert!(distance <= big(self.ball.error()), "{what}: off by {distance}, bound {}", self.ball.error());
    }
}

/// Runs random programs of all operations and asserts after each that the bound holds and that it is not absurdly wide.
fn bounds_hold<R: Real>(middle: impl Fn(R) -> Big + Copy, roundoff: f64) {
    let mut stream = Stream::new(7);
    for _ in 0..300 {
        let mut pool: Vec<Pair<R>> =
            (0..6).map(|_| stream.of_any_scale(40)).map(|x| Pair { ball: R::exact(x), exact: big(x) }).collect();
        for _ in 0..12 {
            let (a, b) = (stream.below(pool.len()), stream.below(pool.len()));
            let (a, b) = (pool[a].clone(), pool[b].clone());
            let (what, next) = match stream.below(6) {
                0 => ("sum", Pair { ball: a.ball + b.ball, exact: a.exact + b.exact }),
                1 => ("difference", Pair { ball: a.ball - b.ball, exact: a.exact - b.exact }),
                2 => ("product", Pair { ball: a.ball * b.ball, exact: a.exact * b.exact }),
                3 if b.ball.sign() != Sign::Unknown && b.ball.sign() != Sign::Zero => {
                    ("quotient", Pair { ball: a.ball / b.ball, exact: a.exact / b.exact })
                }
                4 if a.ball.sign() == Sign::Positive => ("root", Pair { ball: a.ball.sqrt(), exact: a.exact.sqrt() }),
                _ => {
                    let unit = a.ball.clamp_unit();
                    let exact = a.exact.clamp(big(0.0), big(1.0));
                    ("clamp", Pair { ball: unit, exact })
                }
            };
            next.check(what, middle);
            if next.ball.value().abs() < 1e100 {
                pool.push(next);
            }
        }
    }
    // Width: a sum of a thousand like terms is bounded by a thousand roundings, not more.
    let third = R::exact(1.0) / R::exact(3.0);
    let sum = (0..1000).fold(R::exact(0.0), |sum, _| sum + third);
    assert!(sum.error() < 1000.0 * 1000.0 * roundoff, "{}", sum.error());
}

#[test]
fn binary64_bounds_hold() {
    bounds_hold::<Ball64>(|ball| big(ball.value()), f64::EPSILON);
}

#[test]
fn double_double_bounds_hold() {
    bounds_hold::<Ball106>(|ball| big_double_double(ball.middle()), DoubleDouble::ROUNDOFF);
}

#[test]
fn bounds_of_long_numbers_hold() {
    bounds_hold::<Long<4>>(|ball| long::big_middle(&ball), libm::exp2(-250.0));
}

#[test]
fn powers_lie_within_their_bounds() {
    let mut stream = Stream::new(11);
    let exponents = [0.0, 0.5, 1.0, 1.5, 2.0, 20.0, 33.25, 1000.0, 1e6, 1e6 + 0.5];
    for exponent in exponents {
        for _ in 0..40 {
            let x = stream.unit();
            let x = if exponent > 100.0 { 1.0 - x * 1e-4 } else { x };
            let exact = match exponent {
                0.0 => big(1.0),
                1.0 => big(x),
                _ => (big(x).ln() * big(exponent)).exp(),
            };
            Pair { ball: Ball64::exact(x).pow(exponent), exact: exact.clone() }.check("pow", |b| big(b.value()));
            let fine = Ball106::exact(x).pow(exponent);
            assert!(fine.error() <= 1e-18 * fine.value() + 1e-250, "{x}^{exponent}: ± {}", fine.error());
            Pair { ball: fine, exact }.check("pow", |b: Ball106| big_double_double(b.middle()));
        }
    }
}

#[test]
fn wide_balls_keep_their_powers() {
    for (value, error, exponent) in [(0.5, 0.4, 3.5), (0.01, 0.02, 0.5), (0.9, 1e-3, 5000.0), (1e-9, 1.0, 7.0)] {
        let power = Ball64::new(value, error).pow(exponent);
        let fine = Ball106::rounded(DoubleDouble::from(value), error / value).pow(exponent);
        for end in [(value - error).max(0.0), value, value + error] {
            let exact = if end == 0.0 { big(0.0) } else { (big(end).ln() * big(exponent)).exp() };
            Pair { ball: power, exact: exact.clone() }.check("wide pow", |b| big(b.value()));
            Pair { ball: fine, exact }.check("wide pow", |b| big_double_double(b.middle()));
        }
    }
}

#[test]
fn tangents_lie_within_their_bounds() {
    let pi = big_pi();
    for degrees in [1e-300, 2e-4, 1.0, 33.3, 60.0, 90.0, 90.00000001, 120.0, 175.0, 179.999_999, 180.0 - 1e-13] {
        let (tan, relative_error) = tan_half_degrees(degrees);
        let angle = big(degrees) * pi.clone() / big(360.0);
        let (sin, cos) = big_sin_cos(&angle);
        let exact = sin / cos;
        let off = (big_double_double(tan) - exact.clone()) / exact;
        let off = if off < big(0.0) { -off } else { off };
        assert!(off <= big(relative_error), "{degrees}: off by {off}");
        assert!(relative_error < if degrees < 1e-200 { 1e-14 } else { 1e-27 }, "{degrees}: off by {relative_error}?");
    }
}

/// π by Machin's formula.
fn big_pi() -> Big {
    let arctan_of_inverse = |n: f64| {
        let (mut sum, mut power) = (big(0.0), big(1.0) / big(n));
        for k in 0..300 {
            let term = power.clone() / big(f64::from(2 * k + 1));
            sum = if k % 2 == 0 { sum + term } else { sum - term };
            power /= big(n * n);
        }
        sum
    };
    (arctan_of_inverse(5.0) * big(4.0) - arctan_of_inverse(239.0)) * big(4.0)
}

/// Sine and cosine by their series, which converges for every angle here.
fn big_sin_cos(angle: &Big) -> (Big, Big) {
    let (mut sin, mut cos, mut term) = (big(0.0), big(0.0), big(1.0));
    for n in 0..120u32 {
        match n % 4 {
            0 => cos += term.clone(),
            1 => sin += term.clone(),
            2 => cos -= term.clone(),
            _ => sin -= term.clone(),
        }
        term = term * angle.clone() / big(f64::from(n + 1));
    }
    (sin, cos)
}

#[test]
fn the_power_of_a_point_survives_a_large_sphere() {
    let radius = 1e8;
    let height = 1e-7;
    let origin = [0.25, -1.0 + height, -3.0];
    let center = [0.0, -1.0 - radius, -3.0];
    let power = Ball64::power_of_point(origin.map(Ball64::exact), center, radius);
    let exact = origin.into_iter().zip(center).fold(-(big(radius) * big(radius)), |sum, (o, c)| {
        let distance = big(o) - big(c);
        sum + distance.clone() * distance
    });
    assert_eq!(power.sign(), Sign::Positive);
    assert!(power.error() < 1e-13 * power.value());
    Pair { ball: power, exact }.check("power", |b| big(b.value()));
}

fn zeros_stay_exact<R: Real>() {
    let zero = R::exact(0.0);
    let third = R::exact(1.0) / R::exact(3.0);
    for nothing in [zero * third, third * zero, zero / third, (zero * third + zero / third).sqrt()] {
        assert_eq!(nothing.sign(), Sign::Zero);
    }
    let another_third = third;
    let nothing = third - another_third;
    for nothing in [nothing, third * nothing, nothing / third] {
        assert_eq!(nothing.sign(), Sign::Unknown);
    }
}

#[test]
fn exact_zeros_stay_exact() {
    zeros_stay_exact::<Ball64>();
    zeros_stay_exact::<Ball106>();
    zeros_stay_exact::<Long<4>>();
}

#[test]
fn floors_are_given_only_when_certain() {
    assert_eq!(Ball64::new(67.3, 0.2).floor(), Some(67.0));
    assert_eq!(Ball64::new(67.1, 0.2).floor(), None);
    assert_eq!(Ball64::new(67.9, 0.2).floor(), None);
    let nearly = DoubleDouble::sum(67.0, -1e-25);
    assert_eq!(Ball106::rounded(nearly, 0.0).floor(), Some(66.0));
    assert_eq!(Ball106::rounded(nearly, 1e-26).floor(), None);
    let below_half = DoubleDouble::sum(67.5, -7e-15);
    assert_eq!(Ball106::rounded(below_half, 0.5 / 67.5).floor(), None, "it reaches below 67");
}
