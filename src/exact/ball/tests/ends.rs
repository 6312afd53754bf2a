//! The ends of the balls: what a ball holds may lie at its rim, and so may what becomes of it.
//!
//! Each operation is carried out on every combination of the ends of its operands. The results must lie in the ball that the
//! operation gives (or a bound has lost a term, or the room for its own rounding), and the ball must not be much wider than
//! they need.

use super::*;

/// What a radius may exceed the ends by, as a share.
const SPARE: f64 = 1.02;

/// The same in units of the last place of the result: one that is added, and what leading words hide.
const SPARE_ULPS: f64 = 5.0;

fn mid(number: f64) -> Mid {
    Mid::try_from(number).expect("a finite number").with_precision(MANY).value()
}

fn distance(a: &Mid, b: &Mid) -> Mid {
    let difference = a.clone() - b.clone();
    if difference < Mid::ZERO { -difference } else { difference }
}

/// Returns the ends, in many bits.
fn ends(ball: &Ball) -> [Mid; 2] {
    let middle = ball.mid.clone().with_precision(MANY).value();
    let radius = mid(ball.radius());
    [middle.clone() - radius.clone(), middle + radius]
}

/// Asserts that `ball` holds all of `exact`, and that it is not much wider than that takes.
///
/// `size`: the largest number at hand, an ulp of which is what a rounding costs.
fn assert_fits(what: &str, ball: &Ball, exact: &[Mid], size: f64) {
    let middle = ball.mid.clone().with_precision(MANY).value();
    let distances = exact.iter().map(|exact| distance(exact, &middle));
    let farthest = distances.reduce(|a, b| if a < b { b } else { a }).expect("some ends");
    let radius = mid(ball.radius());
    assert!(farthest <= radius, "{what}: an end is off by {farthest}, radius {radius}");
    let ulp = libm::exp2(1.0 - ball.mid.precision() as f64);
    let most = farthest * mid(SPARE) + mid(size * ulp * SPARE_ULPS);
    assert!(radius <= most, "{what}: a radius of {radius} where {most} is enough");
}

/// Makes a ball of some width about some number of either sign, which is a third and so has digits to the last.
fn any_ball(stream: &mut Stream, bits: usize) -> Ball {
    let number = [1.0, -1.0][stream.below(2)] * libm::exp2(stream.between(-20.0, 20.0));
    let third = &Ball::exact(number, bits) / &Ball::exact(3.0, bits);
    let relative = libm::exp2(stream.between(-(bits as f64) - 20.0, -0.5));
    let radius = if stream.below(5) == 0 { Mag::ZERO } else { Mag::new(third.to_f64().abs() * relative, 0) };
    Ball { radius, ..third }
}

/// Makes a ball about 0 or 1, or beside it.
fn about_a_limit(stream: &mut Stream, bits: usize) -> Ball {
    let aside = [1.0, -1.0][stream.below(2)] * libm::exp2(stream.between(-50.0, 0.0));
    let middle = Ball::exact([0.0, 1.0][stream.below(2)] + aside, bits);
    Ball { radius: Mag::new(aside.abs() * libm::exp2(stream.between(-9.0, 3.0)), 0), ..middle }
}

#[test]
fn operations_hold_the_ends() {
    let mut stream = Stream::new(43);
    for _ in 0..1500 {
        let bits = FEW[stream.below(FEW.len())];
        let (a, b) = (any_ball(&mut stream, bits), any_ball(&mut stream, bits));
        let combine = |operation: fn(Mid, Mid) -> Mid| -> Vec<Mid> {
            let (ends_a, ends_b) = (ends(&a), ends(&b));
            ends_a.iter().flat_map(|a| ends_b.iter().map(|b| operation(a.clone(), b.clone()))).collect()
        };
        let (size_a, size_b) = (a.to_f64().abs(), b.to_f64().abs());
        assert_fits("sum", &(&a + &b), &combine(|a, b| a + b), size_a + size_b);
        assert_fits("difference", &(&a - &b), &combine(|a, b| a - b), size_a + size_b);
        assert_fits("product", &(&a * &b), &combine(|a, b| a * b), size_a * size_b);
        assert_fits("negative", &-&a, &ends(&a).map(|end| -end), 0.0);
        let least = size_b - b.radius();
        if least > 0.05 * size_b {
            assert_fits("quotient", &(&a / &b), &combine(|a, b| a / b), (size_a + a.radius()) / least);
        }
    }
}

/// Calls `check` with many balls, their ends and the size of their middles.
fn for_many(seed: u64, check: impl Fn(&Ball, [Mid; 2], f64)) {
    let mut stream = Stream::new(seed);
    for _ in 0..500 {
        let bits = FEW[stream.below(FEW.len())];
        let ball = if stream.below(2) == 0 { any_ball(&mut stream, bits) } else { about_a_limit(&mut stream, bits) };
        check(&ball, ends(&ball), ball.to_f64().abs());
    }
}

#[test]
fn roots_hold_the_ends() {
    let context = Context::<HalfEven>::new(MANY);
    for_many(47, |ball, [low, high], size| {
        if high <= Mid::ZERO {
            return;
        }
        let root = ball.sqrt();
        let middle = root.mid.clone().with_precision(MANY).value();
        for end in [&low, &high] {
            let exact = if *end > Mid::ZERO { context.sqrt(end.repr()).expect("a root").value() } else { mid(0.0) };
            assert!(distance(&exact, &middle) <= mid(root.radius()), "{ball:?}: {root:?}");
        }
        let ulp = libm::exp2(1.0 - ball.mid.precision() as f64) * size.sqrt();
        let most = if low > Mid::ZERO { ball.radius() / size.sqrt() } else { (size + ball.radius()).sqrt() };
        assert!(root.radius() <= most * SPARE + SPARE_ULPS * ulp, "{ball:?}: {root:?}");
    });
}

#[test]
fn clamps_hold_the_ends() {
    let [zero, one] = [0.0, 1.0].map(mid);
    for_many(48, |ball, [low, high], size| {
        let exact = [low.clone(), high.clone(), zero.clone()];
        assert_fits("a share or none", &ball.or_zero(), &exact, 2.0 * size);
        let clamped = ball.clamp01();
        let middle = clamped.mid.clone().with_precision(MANY).value();
        for end in [&low, &high] {
            let exact = end.clone().clamp(zero.clone(), one.clone());
            assert!(distance(&exact, &middle) <= mid(clamped.radius()), "{ball:?} clamped: {clamped:?}");
        }
        assert!(clamped.radius() <= ball.radius().min(1.0));
        assert!(clamped.radius() == 0.0 || (low <= one && high >= zero), "{ball:?} clamped: {clamped:?}");
    });
}

#[test]
fn what_is_said_of_a_ball_is_true_of_its_ends() {
    for_many(49, |ball, [low, high], size| {
        let zero = Mid::ZERO;
        assert_eq!(ball.is_zero(), low == zero && high == zero);
        match ball.sign() {
            Some(Ordering::Less) => assert!(high < zero),
            Some(Ordering::Greater) => assert!(low > zero),
            Some(Ordering::Equal) => assert!(low == zero && high == zero),
            None => assert!(ball.radius() >= 0.99 * size, "{ball:?}"),
        }
        for sharp_bits in [1, 40, 90] {
            let share = ball.radius() * libm::exp2(sharp_bits as f64) / size;
            let is_close = (0.99..=1.01).contains(&share);
            assert!(
                is_close || ball.is_sharp_beside(ball, sharp_bits) == (share < 1.0),
                "{ball:?} to {sharp_bits} bits"
            );
        }
    });
}
