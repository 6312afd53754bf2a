//! Algebra says of a number what is known of it by other means: from how it was made, or from far more bits.

use std::cmp::Ordering;

use super::*;
use crate::exact::real::{Arithmetic, Real};
use crate::testing::Stream;

/// Balls of so few bits leave every case below open.
const FEW: Arithmetic = Arithmetic { bits: 60, has_algebra: true };
const MANY: Arithmetic = Arithmetic { bits: 3000, has_algebra: false };

/// Fields of view: κ = √3, 1, √3, and a number of which nothing is known.
const FIELDS_OF_VIEW: [f64; 4] = [60.0, 90.0, 120.0, 47.5];

/// A number that is 0, made in a roundabout way from k and two numbers above 0.
type Zero = fn(k: &Real, a: &Real, b: &Real) -> Real;

/// Rays and quadratics as the renderer has them are among these.
const ZEROS: [(&str, Zero); 8] = [
    ("quotients", |_, a, b| {
        let both = &(&a.square() + &b.square()) / &(a * b);
        &(&(a / b) + &(b / a)) - &both
    }),
    ("a product of roots", |_, a, b| &(&a.sqrt() * &b.sqrt()) - &(a * b).sqrt()),
    ("a conjugate", |k, a, b| {
        let (a, b) = (&(&(a + b) + k), b);
        let quotient = &a.like(1.0) / &(&a.sqrt() - &b.sqrt());
        &quotient - &(&(&a.sqrt() + &b.sqrt()) / &(a - b))
    }),
    ("roots in a root", |_, a, b| {
        let under = &(a + b) + &(a * b).sqrt().double();
        &(&a.sqrt() + &b.sqrt()) - &under.sqrt()
    }),
    ("a square of k", |k, a, _| {
        let square = &(&k.square() + &(k * a).double()) + &a.square();
        &square.sqrt() - &(k + a)
    }),
    ("the point of a quadratic", |k, a, b| {
        // Of a t² + 2 b t − k.
        let discriminant = &b.square() + &(a * k);
        let t = &(&discriminant.sqrt() - b) / a;
        &(&(a * &t.square()) + &(b * &t).double()) - k
    }),
    ("a hit on a sphere", |k, a, b| {
        // The ray (k, a, −1) t from the origin, and the sphere about (b, 0, −(a + b) − 1) of radius b.
        let one = a.like(1.0);
        let (dir, center) = ([k.clone(), a.clone(), -&one], [b.clone(), a.like(0.0), &-&(a + b) - &one]);
        let dot = |v: &[Real; 3], w: &[Real; 3]| &(&(&v[0] * &w[0]) + &(&v[1] * &w[1])) + &(&v[2] * &w[2]);
        let (dir_squared, along) = (dot(&dir, &dir), dot(&dir, &center));
        let discriminant = &along.square() - &(&dir_squared * &(&dot(&center, &center) - &b.square()));
        // Where the ray misses, another that does not.
        let discriminant = if discriminant.to_f64() > 0.0 { discriminant } else { along.square() };
        let t = &(&along - &discriminant.sqrt()) / &dir_squared;
        &(&dir_squared * &t) - &(&along - &discriminant.sqrt())
    }),
    ("two points on a line", |k, a, b| {
        let on_line = |t: &Real| &(k * t) + b;
        let (one, two) = (a.sqrt(), (a + b).sqrt());
        let slope = &(&on_line(&one) - &on_line(&two)) / &(&one - &two);
        &slope - k
    }),
];

/// Returns κ and k of a field of view, and two numbers between 1 and 2 of full length.
fn inputs(arithmetic: Arithmetic, fov_deg: f64, seed: u64) -> (Kappa, [Real; 3]) {
    let mut stream = Stream::new(seed);
    let (k, kappa) = arithmetic.half_width(fov_deg);
    let [a, b] = [0, 1].map(|_| arithmetic.number(stream.between(1.0, 2.0)));
    (kappa, [k, a, b])
}

/// Asks algebra alone.
fn sign(kappa: Kappa, value: &Real) -> Option<Ordering> {
    Algebra::new(kappa).sign(value.expression().expect("a number that algebra can follow"))
}

#[test]
fn what_is_0_is_known_to_be() {
    for fov_deg in FIELDS_OF_VIEW {
        for seed in 0..5 {
            for (name, zero) in ZEROS {
                let (kappa, [k, a, b]) = inputs(FEW, fov_deg, seed);
                assert_eq!(sign(kappa, &zero(&k, &a, &b)), Some(Ordering::Equal), "{name}, {fov_deg} degrees");
            }
        }
    }
}

#[test]
fn what_is_nearly_0_is_not_taken_for_it() {
    for fov_deg in FIELDS_OF_VIEW {
        for (seed, exponent) in (0..).zip([-70, -200, -500, -1070]) {
            for (name, zero) in ZEROS {
                for (off, expected) in [(1.0, Ordering::Greater), (-1.0, Ordering::Less)] {
                    let off = off * libm::exp2(f64::from(exponent));
                    let (kappa, [k, a, b]) = inputs(FEW, fov_deg, seed);
                    let value = &zero(&k, &a, &b) + &a.like(off);
                    assert_eq!(value.sign(), None, "{name}: balls leave it open");
                    // Of an unknown κ the sign comes from its ball, and none is enough: no answer is no wrong answer.
                    let found = sign(kappa.clone(), &value);
                    let may_be_open = matches!(kappa, Kappa::Unknown(_));
                    assert!(found == Some(expected) || may_be_open && found.is_none(), "{name}: {off:e}, {found:?}");
                }
            }
        }
    }
}

#[test]
fn algebra_and_many_bits_agree() {
    let mut stream = Stream::new(11);
    let mut n_answers = 0;
    for round in 0..60 {
        let fov_deg = FIELDS_OF_VIEW[round % FIELDS_OF_VIEW.len()];
        // Numbers of the scene a last bit apart: the differences are small, and no tie.
        let (a, b) = (stream.between(1.0, 2.0), stream.between(1.0, 2.0));
        let nudged = [a.next_up(), a.next_down(), a][stream.below(3)];
        let difference = |arithmetic: Arithmetic, zero: Zero| {
            let (k, kappa) = arithmetic.half_width(fov_deg);
            let [a, nudged, b] = [a, nudged, b].map(|value| arithmetic.number(value));
            // What is 0 of the one is 0 of the other; their parts are not.
            let root = |a: &Real| (&(a + &k).square() + &b).sqrt();
            (kappa, &(&root(&a) - &root(&nudged)) + &zero(&k, &a, &b))
        };
        for (name, zero) in ZEROS {
            let (kappa, few) = difference(FEW, zero);
            let (_, many) = difference(MANY, zero);
            match (sign(kappa, &few), many.sign()) {
                (Some(found), Some(truth)) => assert_eq!(found, truth, "{name}, {fov_deg} degrees, {a} {b}"),
                (Some(found), None) => assert_eq!(found, Ordering::Equal, "{name}: what 3000 bits cannot tell from 0"),
                (None, _) => continue,
            }
            n_answers += 1;
        }
    }
    assert!(n_answers > 400, "{n_answers} answers");
}

#[test]
fn too_much_work_ends_without_an_answer() {
    let (kappa, [k, a, b]) = inputs(FEW, 60.0, 1);
    // Numbers that double in length with each step.
    let huge = (0..40).fold(&k + &a, |x, _| &(&x * &x) + &b);
    assert_eq!(sign(kappa, &(&huge - &huge)), None);
    // Roots in roots in roots are not followed.
    let deep = (0..9).fold(k, |x, _| (&x + &b).sqrt());
    assert!(deep.expression().is_none());
}

#[test]
fn long_expressions_need_no_stack() {
    let ask = || {
        let [mut number, part] = [0.0, 0.1].map(|value| Arithmetic { bits: 60, has_algebra: true }.number(value));
        let mut n_steps = 0;
        while number.expression().is_some() {
            number = &(&number + &part) - &part;
            n_steps += 2;
        }
        let [mut known, part] = [0.0, 0.1].map(|value| Arithmetic { bits: 60, has_algebra: true }.number(value));
        (0..n_steps / 2 - 2).for_each(|_| known = &(&known + &part) - &part);
        let expression = known.expression().expect("not too long");
        (n_steps, Algebra::new(Kappa::One).sign(expression))
    };
    let thread = std::thread::Builder::new().stack_size(96 << 10).spawn(ask).expect("a thread");
    let (n_steps, sign) = thread.join().expect("it fits the stack");
    assert!(n_steps > 4000 && sign == Some(Ordering::Equal), "{n_steps} {sign:?}");
}
