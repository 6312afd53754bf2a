//! The ends of the balls: what is known up to a bound may lie at it, and the bounds of results must hold for that too.
//!
//! Random programs, which start from exact numbers, come nowhere near the ends of their balls. Here operands are balls of
//! all widths, each operation is carried out exactly on every combination of their ends, and two laws are asserted: the
//! results lie within the bound, and the bound is not much wider than they need. The first fails when a bound loses a term
//! or the room for its own rounding, the second when it gains what it should not.

use super::*;

/// What a bound may exceed the ends by, as a share: 1.06 is in the bound of powers, 0.54 for 0.5 in that of roots.
const SPARE: f64 = 1.15;

/// The same in roundings of the largest number at hand.
const SPARE_ROUNDINGS: f64 = 40.0;

/// An arithmetic whose balls can be made with any bound.
trait Ball: Real {
    /// The relative error of its roundings.
    const ROUNDOFF: f64;

    /// Makes a ball of all that is off from `middle` by up to a share of about `relative`; `tail`, in −1…1, is taken for the
    /// digits of the middle that binary64 does not have.
    fn wide(middle: f64, relative: f64, tail: f64) -> Self;

    /// Returns the middle.
    fn big_middle(self) -> Big;

    /// Returns the least and the largest number of the ball.
    fn ends(self) -> [Big; 2] {
        [self.big_middle() - big(self.error()), self.big_middle() + big(self.error())]
    }
}

impl Ball for Ball64 {
    const ROUNDOFF: f64 = f64::EPSILON / 2.0;

    fn wide(middle: f64, relative: f64, _: f64) -> Self {
        Self::new(middle, middle.abs() * relative)
    }

    fn big_middle(self) -> Big {
        big(self.value())
    }
}

impl Ball for Ball106 {
    const ROUNDOFF: f64 = DoubleDouble::ROUNDOFF;

    fn wide(middle: f64, relative: f64, tail: f64) -> Self {
        Self::rounded(DoubleDouble::sum(middle, middle * tail * f64::EPSILON), relative)
    }

    fn big_middle(self) -> Big {
        big_double_double(self.middle())
    }
}

impl Ball for Long<4> {
    /// Some bits of the 256 are lost to limbs that are cut, and more in series.
    const ROUNDOFF: f64 = 1.0 / (1_u128 << 120) as f64 / (1_u128 << 120) as f64;

    fn wide(middle: f64, relative: f64, tail: f64) -> Self {
        Self::rounded(DoubleDouble::sum(middle, middle * tail * f64::EPSILON), relative)
    }

    fn big_middle(self) -> Big {
        crate::math::long::big_middle(&self).with_precision(PRECISION_BITS).value()
    }
}

fn magnitude(x: &Big) -> Big {
    if *x < big(0.0) { -x.clone() } else { x.clone() }
}

/// Asserts both laws of a result, given what the operation makes of the ends of its operands.
///
/// `scale`: the size of the numbers at hand, of which a rounding is a share.
fn assert_fits<B: Ball>(what: &str, ball: B, exact: &[Big], scale: f64) {
    assert_fits_with(SPARE, what, ball, exact, scale);
}

/// The same with another share to spare.
fn assert_fits_with<B: Ball>(spare: f64, what: &str, ball: B, exact: &[Big], scale: f64) {
    assert!(ball.error().is_finite(), "{what}: nothing is known");
    let distances = exact.iter().map(|exact| magnitude(&(exact.clone() - ball.big_middle())));
    let farthest = distances.reduce(|a, b| if a < b { b } else { a }).expect("some ends");
    let bound = big(ball.error());
    assert!(farthest <= bound, "{what}: an end is off by {farthest}, bound {bound}");
    let most = farthest * big(spare) + big(scale * B::ROUNDOFF * SPARE_ROUNDINGS) + big(1e-250);
    assert!(bound <= most, "{what}: a bound of {bound} where {most} is enough");
}

/// Returns a number between 2⁻²⁰ and 2²⁰, or a short one, which is likely to cancel.
fn any_middle(stream: &mut Stream) -> f64 {
    if stream.below(3) == 0 { [-5.0, -1.0, 0.5, 3.0, 5.0][stream.below(5)] } else { stream.of_any_scale(20) }
}

/// Returns a relative error: none, one of roundings, or up to all of the number.
fn any_relative(stream: &mut Stream) -> f64 {
    if stream.below(5) == 0 { 0.0 } else { libm::exp2(stream.between(-110.0, 0.0)) }
}

/// Returns a ball about 0 or 1, or beside it.
fn about_a_limit<B: Ball>(stream: &mut Stream) -> B {
    let aside = stream.between(-1.0, 1.0) * libm::exp2(stream.between(-52.0, 0.0));
    let relative = libm::exp2(stream.between(-60.0, 3.0));
    match stream.below(2) {
        0 => B::wide(aside, relative, stream.unit()),
        _ => B::wide(1.0 + aside, relative * aside.abs(), stream.between(-1.0, 1.0)),
    }
}

fn any_ball<B: Ball>(stream: &mut Stream) -> B {
    B::wide(any_middle(stream), any_relative(stream), stream.between(-1.0, 1.0))
}

/// Combines the ends of two balls.
fn combine<B: Ball>(a: B, b: B, operation: impl Fn(Big, Big) -> Big) -> Vec<Big> {
    let [a, b] = [a, b].map(|ball| ball.ends().to_vec());
    a.iter().flat_map(|a| b.iter().map(|b| operation(a.clone(), b.clone()))).collect()
}

fn operations_fit<B: Ball>() {
    let mut stream = Stream::new(23);
    for _ in 0..2000 {
        let [a, b] = match stream.below(8) {
            // Of these the last digits alone are left.
            0 => [5.0, -5.0].map(|middle| B::wide(middle, 0.0, stream.between(-0.3, 0.3))),
            1 | 2 => [any_ball(&mut stream), about_a_limit(&mut stream)],
            _ => [(); 2].map(|()| any_ball::<B>(&mut stream)),
        };
        let (size_a, size_b) = (a.value().abs(), b.value().abs());
        assert_fits("sum", a + b, &combine(a, b, |a, b| a + b), size_a + size_b);
        assert_fits("difference", a - b, &combine(a, b, |a, b| a - b), size_a + size_b);
        assert_fits("product", a * b, &combine(a, b, |a, b| a * b), size_a * size_b);
        if b.error() < 0.999 * size_b {
            assert!((a / b).error().is_finite(), "a divisor of {size_b} ± {}", b.error());
            assert_fits("quotient", a / b, &combine(a, b, |a, b| a / b), size_a / (size_b - b.error()));
        } else if b.error() > size_b {
            assert!(!(a / b).error().is_finite(), "divided by {} ± {}, which may be 0", b.value(), b.error());
        }
    }
}

#[test]
fn operations_on_binary64_hold_the_ends() {
    operations_fit::<Ball64>();
}

#[test]
fn operations_on_double_double_hold_the_ends() {
    operations_fit::<Ball106>();
}

#[test]
fn operations_of_long_numbers_hold_the_ends() {
    operations_fit::<Long<4>>();
}

fn functions_fit<B: Ball>() {
    let mut stream = Stream::new(29);
    for _ in 0..500 {
        // From a quarter on the bound of a root is up to twice what it takes.
        let relative = if stream.below(8) == 0 { 1.0 + stream.unit() } else { any_relative(&mut stream) };
        let x = B::wide(any_middle(&mut stream).abs(), relative, stream.between(-1.0, 1.0));
        let spare = if relative < 0.2 { SPARE } else { 2.0 };
        assert_fits_with(spare, "root", x.sqrt(), &x.ends().map(|end| end.max(big(0.0)).sqrt()), x.value().sqrt());

        let number: B = if stream.below(2) == 0 { any_ball(&mut stream) } else { about_a_limit(&mut stream) };
        let clamped = number.ends().map(|end| end.clamp(big(0.0), big(1.0)));
        let unit = number.clamp_unit();
        let holds = clamped.iter().all(|end| magnitude(&(end.clone() - unit.big_middle())) <= big(unit.error()));
        assert!(holds, "{} ± {} clamped", number.value(), number.error());
        assert!(unit.error() <= number.error() && (0.0..=1.0).contains(&unit.value()));

        let signs = number.ends().map(|end| end.partial_cmp(&big(0.0)).expect("a number"));
        let sign = match signs {
            [a, b] if a != b || (a.is_eq() && number.error() > 0.0) => Sign::Unknown,
            [a, _] if a.is_lt() => Sign::Negative,
            [a, _] if a.is_gt() => Sign::Positive,
            _ => Sign::Zero,
        };
        assert_eq!(number.sign(), sign, "{} ± {}", number.value(), number.error());
    }
}

#[test]
fn functions_of_binary64_hold_the_ends() {
    functions_fit::<Ball64>();
}

#[test]
fn functions_of_double_double_hold_the_ends() {
    functions_fit::<Ball106>();
}

#[test]
fn functions_of_long_numbers_hold_the_ends() {
    functions_fit::<Long<4>>();
}

/// Raises to a power; what lies below 0 counts as 0.
fn big_power(x: Big, exponent: f64) -> Big {
    match exponent {
        _ if x <= big(0.0) => big(0.0),
        1.0 => x,
        _ => (x.ln() * big(exponent)).exp(),
    }
}

/// Powers of balls so wide that they are bounded by those of their ends, some of which lie below 0.
fn powers_of_the_wide_fit<B: Ball>() {
    let mut stream = Stream::new(59);
    for _ in 0..100 {
        for exponent in [0.25, 1.5, 7.5, 20.5] {
            let middle = if stream.below(4) == 0 { -stream.unit() } else { stream.unit() };
            let x = B::wide(middle, stream.between(0.02, 1.5), stream.unit());
            let exact = x.ends().map(|end| big_power(end, exponent));
            assert_fits_with(1.4, "power of a wide ball", x.pow(exponent), &exact, libm::pow(2.5, exponent));
        }
    }
}

#[test]
fn powers_of_wide_balls_hold_the_ends() {
    powers_of_the_wide_fit::<Ball64>();
    powers_of_the_wide_fit::<Ball106>();
    powers_of_the_wide_fit::<Long<4>>();
}

fn powers_fit<B: Ball>() {
    let mut stream = Stream::new(31);
    for _ in 0..60 {
        for exponent in [0.25, 1.0, 1.5, 2.0, 7.5, 20.0, 300.0] {
            let share = if stream.below(2) == 0 { 0.07 } else { libm::exp2(stream.between(-70.0, -4.0)) };
            let relative = share / exponent;
            let x = B::wide(stream.between(0.01, 1.0), relative, stream.unit());
            let exact = x.ends().map(|end| big_power(end, exponent));
            let power = x.pow(exponent);
            let bound = big(power.error());
            for end in &exact {
                let distance = magnitude(&(end.clone() - power.big_middle()));
                assert!(distance <= bound, "{}^{exponent}: an end is off by {distance}, bound {bound}", x.value());
            }
            let roundings = B::ROUNDOFF * 1e6 * (1.0 + exponent);
            let most = power.value() * (1.6 * exponent * relative + roundings) + 1e-250;
            assert!(power.error() <= most, "{}^{exponent}: {} where {most} is enough", x.value(), power.error());
        }
    }
}

#[test]
fn powers_of_binary64_hold_the_ends() {
    powers_fit::<Ball64>();
}

#[test]
fn powers_of_double_double_hold_the_ends() {
    powers_fit::<Ball106>();
}

#[test]
fn powers_of_long_numbers_hold_the_ends() {
    powers_fit::<Long<4>>();
}

/// Floors of balls about whole numbers and between them.
fn floors_fit<B: Ball>() {
    let mut stream = Stream::new(37);
    for _ in 0..1000 {
        let whole = stream.between(1.0, 255.0).floor();
        let from_whole = [1e-17, 1e-12, 1e-3, 0.3, 0.5, 0.8][stream.below(6)] * [-1.0, 1.0][stream.below(2)];
        let x = B::wide(whole + from_whole, any_relative(&mut stream) / whole, 0.0);
        let [low, high] = x.ends().map(|end| end.floor());
        match x.floor() {
            Some(floor) => assert!(low == big(floor) && high == big(floor), "{} ± {}", x.value(), x.error()),
            None => {
                // It may leave open what lies within some roundings of a whole number, or is wider than a quarter.
                let rest = (x.value() - x.value().round()).abs();
                assert!(low != high || x.error() >= 0.25 || rest - x.error() <= 8.0 * f64::EPSILON * whole);
            }
        }
    }
}

#[test]
fn floors_hold_for_the_ends() {
    floors_fit::<Ball64>();
    floors_fit::<Ball106>();
    floors_fit::<Long<4>>();
}

/// Numbers that are rounded to the type.
fn rounded_fit<B: Ball>() {
    let mut stream = Stream::new(61);
    for _ in 0..300 {
        let number = DoubleDouble::sum(any_middle(&mut stream), libm::exp2(stream.between(-90.0, -30.0)));
        let relative = any_relative(&mut stream);
        let exact = [-relative, relative].map(|share| big_double_double(number) * (big(1.0) + big(share)));
        assert_fits("number", B::rounded(number, relative), &exact, number.hi().abs());
    }
}

#[test]
fn what_is_rounded_holds_the_ends() {
    rounded_fit::<Ball64>();
    rounded_fit::<Ball106>();
    rounded_fit::<Long<4>>();
}

fn powers_of_points_fit<B: Ball>(widest: f64) {
    let mut stream = Stream::new(41);
    for _ in 0..300 {
        let point =
            [(); 3].map(|()| B::wide(stream.between(-4.0, 4.0), libm::exp2(stream.between(-80.0, widest)), 0.5));
        let center = [(); 3].map(|()| stream.between(-4.0, 4.0));
        // On the sphere, or nearly, the power is what rounding leaves of it.
        let is_on = stream.below(2) == 0;
        let point = if is_on { point.map(|coordinate| B::exact(coordinate.value())) } else { point };
        let square = |axis: usize| (point[axis].value() - center[axis]) * (point[axis].value() - center[axis]);
        let distance = (square(0) + square(1) + square(2)).sqrt();
        let radius = if is_on { distance } else { stream.between(0.5, 6.0) };
        let power = B::power_of_point(point, center, radius);
        let mut exact = Vec::new();
        for corner in 0..8 {
            let squares = (0..3).map(|axis| {
                let offset = point[axis].ends()[corner >> axis & 1].clone() - big(center[axis]);
                offset.clone() * offset
            });
            exact.push(squares.fold(-(big(radius) * big(radius)), |sum, square| sum + square));
        }
        assert_fits("power of a point", power, &exact, 100.0);
    }
}

#[test]
fn powers_of_points_hold_the_ends() {
    powers_of_points_fit::<Ball64>(-12.0);
    powers_of_points_fit::<Ball106>(-12.0);
    powers_of_points_fit::<Long<4>>(-12.0);
}

/// Products and quotients too small for binary64: 0 or subnormal, but the bound is not.
#[test]
fn what_underflows_is_within_the_bound() {
    fn check<B: Ball>(middle: impl Fn(B) -> Big) {
        let numbers = [1e-154, 1e-170, 3e-200, 1e-290];
        for (a, b) in numbers.into_iter().flat_map(|a| numbers.map(|b| (a, b))) {
            let product = B::exact(a) * B::exact(-b);
            Pair { ball: product, exact: big(a) * big(-b) }.check("product", &middle);
            assert_ne!(product.sign(), Sign::Zero, "{a:e} · {b:e}");
            let quotient = B::exact(a) / B::exact(1.0 / b);
            Pair { ball: quotient, exact: big(a) / big(1.0 / b) }.check("quotient", &middle);
            let root = (B::exact(a) * B::exact(b)).sqrt();
            Pair { ball: root, exact: (big(a) * big(b)).sqrt() }.check("root", &middle);
            let power = B::exact(a).pow(100.5);
            Pair { ball: power, exact: (big(a).ln() * big(100.5)).exp() }.check("power", &middle);
            assert!(
                product.error() < 1e-250
                    && power.error() < 1e-250
                    && quotient.error() < 1e-120
                    && root.error() < 1e-120
            );
        }
    }
    check::<Ball64>(Ball::big_middle);
    check::<Ball106>(Ball::big_middle);
    check::<Long<4>>(Ball::big_middle);
}
