//! Balls hold the truth: what the same formula gives in far more bits, and what others say.

mod ends;

use super::*;
use crate::testing::Stream;

/// The precisions under test, and that of what they are held against.
const FEW: [usize; 4] = [53, 96, 192, 400];
const MANY: usize = 1500;

/// Tells whether two balls may hold the same number.
fn meet(a: &Ball, b: &Ball) -> bool {
    let context = Context::<HalfEven>::new(UNLIMITED);
    let gap = context.sub(a.mid.repr(), b.mid.repr()).expect("finite terms").value();
    !a.radius.plus(b.radius).is_below(magnitude(&gap).0)
}

/// Holds a formula of two numbers in few bits against itself in many; returns the largest radius of the latter.
fn assert_contains(name: &str, [x, y]: [f64; 2], formula: impl Fn(&Ball, &Ball) -> Ball) {
    let at = |bits| formula(&Ball::exact(x, bits), &Ball::exact(y, bits));
    let truth = at(MANY);
    for bits in FEW {
        let ball = at(bits);
        assert!(meet(&ball, &truth), "{name}({x:e}, {y:e}) in {bits} bits: {ball:?}, but {truth:?}");
    }
}

/// Returns a number of full length and of any size within a thousand bits.
fn any_number(stream: &mut Stream) -> f64 {
    let size = stream.between(-500.0, 500.0).floor();
    stream.between(-2.0, 2.0) * libm::exp2(size)
}

/// Returns a number that is likely to cancel against others of its kind.
fn near_one(stream: &mut Stream) -> f64 {
    1.0 + stream.between(-1.0, 1.0) * libm::exp2(stream.between(-52.0, 0.0))
}

#[test]
fn every_operation_contains_the_truth() {
    type Operation = (&'static str, fn(&Ball, &Ball) -> Ball);
    // The operands are thirds, so that their radius is not 0.
    fn third(x: &Ball) -> Ball {
        x / &x.like(3.0)
    }
    let operations: [Operation; 9] = [
        ("sum", |x, y| &third(x) + &third(y)),
        ("difference", |x, y| &third(x) - &third(y)),
        ("product", |x, y| &third(x) * &third(y)),
        ("quotient", |x, y| &third(x) / &third(y)),
        ("quotient by a difference", |x, y| x / &(&third(x) - &third(y))),
        ("root", |x, y| &(&third(x) * &third(x)).sqrt().max0().double() + &third(y)),
        ("root of a difference", |x, y| (&third(x) - &third(y)).sqrt()),
        ("clamp", |x, y| (&third(x) - &third(y)).clamp01()),
        ("negative", |x, y| -&(&third(x) - y)),
    ];
    let mut stream = Stream::new(3);
    for _ in 0..400 {
        let pairs = [
            [any_number(&mut stream), any_number(&mut stream)],
            [near_one(&mut stream), near_one(&mut stream)],
            [near_one(&mut stream), any_number(&mut stream)],
        ];
        for pair in pairs {
            for (name, operation) in operations {
                // The root of what lies below 0 is 0 within its ball, which far more bits would not tell.
                let is_root_of_negative = name == "root of a difference" && pair[0] < pair[1];
                if pair[1] != 0.0 && !is_root_of_negative {
                    assert_contains(name, pair, operation);
                }
            }
        }
    }
}

#[test]
fn every_function_contains_the_truth() {
    let mut stream = Stream::new(5);
    for _ in 0..60 {
        let (unit, exponent) = (stream.unit(), libm::exp2(stream.between(-12.0, 24.0)));
        let close = 1.0 - libm::exp2(stream.between(-50.0, -1.0));
        for base in [unit, close, libm::exp2(stream.between(-900.0, 0.0))] {
            for exponent in [exponent, exponent.floor(), (4.0 * exponent).floor() / 4.0] {
                assert_contains("power", [base, exponent], |x, _| x.pow(exponent));
            }
            assert_contains("logarithm", [base.max(1e-300), 0.0], |x, _| x.ln());
        }
        let argument = stream.between(-2000.0, 700.0);
        assert_contains("exponential", [argument, 0.0], |x, _| (x / &x.like(3.0)).exp());
        let degrees = stream.between(0.0, 180.0);
        for degrees in [degrees, 180.0 * libm::exp2(-exponent.min(1000.0)), 180.0 - degrees * 1e-9] {
            if degrees > 0.0 && degrees < 180.0 {
                let truth = Ball::tan_half_degrees(degrees, MANY);
                for bits in FEW {
                    assert!(meet(&Ball::tan_half_degrees(degrees, bits), &truth), "{degrees} in {bits} bits");
                }
            }
        }
    }
}

/// Some formula with every operation.
fn tangle(x: f64, y: f64, bits: usize) -> Ball {
    let [x, y] = [x, y].map(|number| Ball::exact(number, bits));
    let third = &x / &Ball::exact(3.0, bits);
    let root = (&(&third * &third) + &(&y * &y)).sqrt();
    let ratio = &(&root - &third) / &(&root + &y);
    &ratio.pow(2.7) + &(&ratio.pow(1.25) - &ratio.pow(11.0).clamp01())
}

#[test]
fn balls_of_all_precisions_meet_and_shrink() {
    for i in 1..200 {
        let [x, y] = [f64::from(i) * 0.37, 1.0 / f64::from(i)];
        let [few, many] = [60, 400].map(|bits| tangle(x, y, bits));
        assert!(meet(&few, &many), "{few:?} {many:?}");
        assert!(many.radius.is_below(Mag::power_of_two(-300)), "{many:?}");
    }
}

#[test]
fn a_radius_is_no_wider_than_it_must() {
    let third = &Ball::exact(1.0, 256) / &Ball::exact(3.0, 256);
    let nothing = &(&third * &Ball::exact(3.0, 256)) - &Ball::exact(1.0, 256);
    assert_eq!(nothing.sign(), None);
    assert!(nothing.radius.is_below(Mag::power_of_two(-252)));
    let little = &nothing + &Ball::exact(f64::from_bits((1023 - 250) << 52), 256);
    assert_eq!(little.sign(), Some(Ordering::Greater));
}

#[test]
fn exact_operations_stay_exact() {
    let [three, four, five] = [3.0, 4.0, 5.0].map(|number| Ball::exact(number * 1e10, 256));
    let difference = &(&(&three * &three) + &(&four * &four)) - &(&five * &five);
    assert!(difference.is_zero());
    assert!((&(&four * &four).sqrt() - &four).is_zero());
    assert!((&Ball::exact(0.0, 256) * &(&three / &Ball::exact(7.0, 256))).is_zero());
    let [huge, tiny] = [1e300, 1e-300].map(Ball::unrounded);
    let square = &(&huge + &tiny) * &(&huge - &tiny);
    assert!((&square - &(&(&huge * &huge) - &(&tiny * &tiny))).is_zero());
}

#[test]
fn pi_and_the_tangent_are_those_of_dashu() {
    let bits = 300;
    let context = Context::<HalfEven>::new(bits);
    let theirs = Ball { mid: context.pi(None).value(), radius: Mag::power_of_two(3 - bits as i64) };
    assert!(meet(&Ball::pi(bits), &theirs));
    for angle in [1e-300, 0.0002, 1.0, 45.0, 60.0, 75.5, 120.0, 175.0, 179.999_999] {
        let ours = Ball::tan_half_degrees(angle, bits);
        let half = &(&Ball::exact(angle, 400) * &Ball::pi(400)) / &Ball::exact(360.0, 400);
        let tan = Context::<HalfEven>::new(400).tan(half.mid.repr(), None).expect("a tangent").value();
        let radius = magnitude(&tan).1.shifted(-350);
        assert!(meet(&ours, &Ball { mid: tan, radius }), "{angle}");
        assert!(ours.is_sharp_beside(&ours, 250), "{angle}");
    }
}

#[test]
fn logarithm_and_exponential_are_those_of_dashu() {
    let context = Context::<HalfEven>::new(300);
    for number in [1e-300, 1e-9, 0.1, 0.5, 0.999_999, 1.0 - f64::EPSILON, 1.0, 3.0] {
        let x = Ball::exact(number, 256);
        let theirs = [context.ln(x.mid.repr(), None), context.exp(x.mid.repr(), None)];
        for (ours, theirs) in [x.ln(), x.exp()].into_iter().zip(theirs) {
            let mid = theirs.expect("a finite number").value();
            let radius = magnitude(&mid).1.shifted(-290);
            assert!(meet(&ours, &Ball { mid, radius }), "{number}: {ours:?}");
            assert!(ours.is_zero() || ours.is_sharp_beside(&ours, 150), "{number}: {ours:?}");
        }
    }
}

#[test]
fn a_power_is_the_same_by_roots_by_products_and_by_logarithms() {
    for base in [0.999, 0.5, 1e-3, 0.123_456_789] {
        let base = Ball::exact(base, 256);
        for exponent in [1.0, 2.5, 20.0, 33.75] {
            let by_logarithm = (&base.ln() * &base.like(exponent)).exp();
            assert!(meet(&base.pow(exponent), &by_logarithm));
        }
        // Neither whole nor made so by the doublings that are tried; 1 less it is exact.
        let share = 5_033_165.0 / 16_777_216.0;
        assert!(meet(&(&base.pow(share) * &base.pow(1.0 - share)), &base));
    }
    assert!((&Ball::exact(0.0, 256).pow(0.0) - &Ball::exact(1.0, 256)).is_zero());
    assert!(Ball::exact(0.0, 256).pow(0.3).is_zero());
    assert!((&Ball::exact(1.0, 256).pow(1e300) - &Ball::exact(1.0, 256)).is_zero());
}

#[test]
fn powers_of_what_may_be_nothing_stay_small() {
    let nothing = &(&Ball::exact(1.0, 96) / &Ball::exact(3.0, 96)) - &(&Ball::exact(2.0, 96) / &Ball::exact(6.0, 96));
    assert_eq!(nothing.sign(), None);
    for (exponent, bits) in [(0.3, -20), (0.7, -40), (1.7, -80), (1e300, -80)] {
        let power = nothing.pow(exponent);
        assert!(power.radius.is_below(Mag::power_of_two(bits)), "{exponent}: {power:?}");
    }
}
