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

#[test]
fn functions_hold_the_ends() {
    let mut stream = Stream::new(47);
    for _ in 0..500 {
        let bits = FEW[stream.below(FEW.len())];
        let a = any_ball(&mut stream, bits);
        let size = a.to_f64().abs();
        let context = Context::<HalfEven>::new(MANY);
        if a.to_f64() > 0.0 {
            let roots = ends(&a).map(|end| context.sqrt(end.repr()).expect("a root").value());
            // The bound on a root is that of the narrow: twice what a wide ball needs, at most.
            let middle = a.sqrt();
            for root in &roots {
                assert!(distance(root, &middle.mid.clone().with_precision(MANY).value()) <= mid(middle.radius()));
            }
            let ulp = libm::exp2(1.0 - bits as f64) * size.sqrt();
            assert!(middle.radius() <= a.radius() / size.sqrt() * SPARE + SPARE_ULPS * ulp, "{a:?}: {middle:?}");
        }
        let with_zero = a.or_zero();
        assert_fits("a share or none", &with_zero, &[ends(&a)[0].clone(), ends(&a)[1].clone(), mid(0.0)], 2.0 * size);
        let [one, zero] = [1.0, 0.0].map(mid);
        let clamp = |end: &Mid| {
            if *end < zero {
                mid(0.0)
            } else if *end > one {
                mid(1.0)
            } else {
                end.clone()
            }
        };
        let clamped = a.clamp01();
        for end in ends(&a) {
            let middle = clamped.mid.clone().with_precision(MANY).value();
            assert!(distance(&clamp(&end), &middle) <= mid(clamped.radius()), "{a:?} clamped: {clamped:?}");
        }
        assert!(clamped.radius() <= a.radius().min(1.0));
        let low = &ends(&a)[0];
        let high = &ends(&a)[1];
        match a.sign() {
            Some(Ordering::Less) => assert!(*high < zero),
            Some(Ordering::Greater) => assert!(*low > zero),
            Some(Ordering::Equal) => assert!(*low == zero && *high == zero),
            None => assert!(a.radius() >= 0.99 * size, "{a:?}"),
        }
    }
}
