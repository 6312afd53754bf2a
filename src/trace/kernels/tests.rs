//! Every backend gives the bits of the specification, operation by operation.

use super::*;
use crate::testing::Stream;

/// All operations on three packets; what comes out, bit by bit.
struct EveryOperation<'a> {
    a: &'a [f64; 8],
    b: &'a [f64; 8],
    bits: u32,
}

impl Job for EveryOperation<'_> {
    type Output = Vec<u64>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Vec<u64> {
        let (a, b) = (L::load(self.a), L::load(self.b));
        let mask = L::Mask::from_bits(self.bits);
        let results = [
            a + b,
            a - b,
            a * b,
            a / b,
            -a,
            a.sqrt(),
            a.floor(),
            a.abs(),
            a.min(b),
            a.max(b),
            L::select(mask, a, b),
            L::splat(self.a[0]),
        ];
        let mut out = Vec::new();
        for result in results {
            let mut lanes = [0.0; 8];
            result.store(&mut lanes);
            // A NaN has many bit patterns, and IEEE 754 says nothing of which.
            out.extend(lanes.map(|lane| if lane.is_nan() { u64::MAX } else { lane.to_bits() }));
        }
        let masks = [a.lt(b), a.le(b), a.eq(b), a.gt(b), a.ge(b), mask, !mask, mask & a.lt(b), mask | a.eq(b)];
        for mask in masks {
            out.push(mask.bits().into());
            out.push(mask.any().into());
        }
        let mut packed = [0.0; 8];
        a.store_packed(mask, &mut packed);
        let n_packed = mask.bits().count_ones() as usize;
        out.extend(packed[..n_packed].iter().map(|lane| if lane.is_nan() { u64::MAX } else { lane.to_bits() }));
        let mut whole = [7; 8];
        (a.abs().min(L::splat(1e6)).max(L::splat(0.0))).floor().store_whole(mask, &mut whole);
        out.extend(whole.map(u64::from));
        out
    }
}

fn assert_agrees(a: &[f64; 8], b: &[f64; 8], bits: u32) {
    let expected = Backend::Scalar.run(EveryOperation { a, b, bits });
    for backend in Backend::ALL.into_iter().filter(|backend| backend.is_available()) {
        assert_eq!(backend.run(EveryOperation { a, b, bits }), expected, "{}: {a:?} {b:?} {bits:b}", backend.name());
    }
}

#[test]
fn every_backend_gives_the_same_bits() {
    let special =
        [0.0, -0.0, 1.0, -1.0, 0.5, -2.5, f64::MAX, f64::MIN_POSITIVE, 5e-324, 1e300, -1e-300, f64::INFINITY, f64::NAN];
    let mut stream = Stream::new(11);
    for _ in 0..20_000 {
        let mut any = || match stream.unit() {
            share if share < 0.4 => special[(stream.unit() * special.len() as f64) as usize],
            share if share < 0.7 => stream.between(-10.0, 10.0),
            _ => libm::exp2(stream.between(-500.0, 500.0)) * stream.between(-1.0, 1.0),
        };
        let (a, b) = ([(); 8].map(|()| any()), [(); 8].map(|()| any()));
        assert_agrees(&a, &b, (stream.unit() * 256.0) as u32);
    }
}

#[test]
fn the_best_backend_is_available() {
    assert!(Backend::best().is_available());
    assert!(Backend::Scalar.is_available());
}
