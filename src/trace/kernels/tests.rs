//! Every backend gives the bits of the specification, operation by operation.

use super::*;
use crate::testing::Stream;

/// All operations on two packets and a mask; what comes out, bit by bit.
#[derive(Clone, Copy)]
struct EveryOperation<'a, E> {
    a: &'a [E; 16],
    b: &'a [E; 16],
    bits: u32,
}

/// A NaN has many bit patterns, and IEEE 754 says nothing of which.
fn bits_of(number: impl Into<f64>) -> u64 {
    let number = number.into();
    if number.is_nan() { u64::MAX } else { number.to_bits() }
}

impl<E: Copy + Default + Into<f64>> EveryOperation<'_, E> {
    #[inline(always)]
    fn all<L: Numbers<Element = E>>(self) -> Vec<u64> {
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
            L::splat(self.a[0].into()),
        ];
        let mut out = Vec::new();
        for result in results {
            let mut lanes = [E::default(); 16];
            result.store(&mut lanes);
            out.extend(lanes[..L::N].iter().map(|&lane| bits_of(lane)));
        }
        let masks = [a.lt(b), a.le(b), a.eq(b), a.gt(b), a.ge(b), mask, !mask, mask & a.lt(b), mask | a.eq(b)];
        for mask in masks {
            out.push(mask.bits().into());
            out.push(mask.any().into());
        }
        let mut packed = [E::default(); 16];
        a.store_packed(mask, &mut packed);
        let n_packed = mask.bits().count_ones() as usize;
        out.extend(packed[..n_packed].iter().map(|&lane| bits_of(lane)));
        let mut whole = [7; 16];
        (a.abs().min(L::splat(1e6)).max(L::splat(0.0))).floor().store_whole(mask, &mut whole);
        out.extend(whole.map(u64::from));
        out
    }
}

impl Job for EveryOperation<'_, f64> {
    type Output = Vec<u64>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Vec<u64> {
        self.all::<L>()
    }
}

impl SingleJob for EveryOperation<'_, f32> {
    type Output = Vec<u64>;

    #[inline(always)]
    fn run<L: SingleLanes>(self) -> Vec<u64> {
        let mut out = self.all::<L>();
        let mut lanes = [0.0; 16];
        L::same(self.a[1]).store(&mut lanes);
        out.extend(lanes.map(bits_of));
        out
    }
}

#[test]
fn every_backend_gives_the_same_bits() {
    let special =
        [0.0, -0.0, 1.0, -1.0, 0.5, -2.5, f64::MAX, f64::MIN_POSITIVE, 5e-324, 1e300, -1e-300, f64::INFINITY, f64::NAN];
    let special_singles =
        [0.0, -0.0, 1.0, -1.0, 0.5, -2.5, f32::MAX, f32::MIN_POSITIVE, 1e-45, 1e30, -1e-38, f32::INFINITY, f32::NAN];
    let mut stream = Stream::new(11);
    for _ in 0..20_000 {
        let mut any = || {
            let place = (stream.unit() * special.len() as f64) as usize;
            match stream.unit() {
                share if share < 0.4 => (special[place], special_singles[place]),
                share if share < 0.7 => [stream.between(-10.0, 10.0)].map(|number| (number, number as f32))[0],
                _ => {
                    let (exponent, factor) = (stream.between(-1.0, 1.0), stream.between(-1.0, 1.0));
                    let (wide, single) = (libm::exp2(500.0 * exponent), libm::exp2(60.0 * exponent));
                    (wide * factor, (single * factor) as f32)
                }
            }
        };
        let (a, b) = ([(); 16].map(|()| any()), [(); 16].map(|()| any()));
        let bits = (stream.unit() * 65536.0) as u32;
        let (wide_a, wide_b) = (a.map(|(wide, _)| wide), b.map(|(wide, _)| wide));
        let (single_a, single_b) = (a.map(|(_, single)| single), b.map(|(_, single)| single));
        let wide = EveryOperation { a: &wide_a, b: &wide_b, bits };
        let single = EveryOperation { a: &single_a, b: &single_b, bits };
        let (of_wide, of_single) = (Backend::Scalar.run(wide), Backend::Scalar.run_single(single));
        let of_pair = wide.all::<pair::Pair<scalar::Lanes8>>();
        for backend in Backend::ALL.into_iter().filter(|backend| backend.is_available()) {
            let name = backend.name();
            assert_eq!(backend.run(wide), of_wide, "{name}: {wide_a:?} {wide_b:?} {bits:b}");
            let of_twofold = if backend == Backend::Avx512 { &of_pair } else { &of_wide };
            assert_eq!(&backend.run_twofold(wide), of_twofold, "{name}: {wide_a:?} {wide_b:?} {bits:b}");
            assert_eq!(backend.run_single(single), of_single, "{name}: {single_a:?} {single_b:?} {bits:b}");
        }
    }
}

/// What differs from backend to backend, within what is said of it.
#[derive(Clone, Copy)]
struct EveryBoundedOperation<'a> {
    a: &'a [f64; 16],
    b: &'a [f64; 16],
    c: &'a [f64; 16],
}

impl Job for EveryBoundedOperation<'_> {
    type Output = [Vec<f64>; 3];

    #[inline(always)]
    fn run<L: Lanes>(self) -> [Vec<f64>; 3] {
        let (a, b, c) = (L::load(self.a), L::load(self.b), L::load(self.c));
        let places = (a.abs() * L::splat(1e6)).min(L::splat(15.0)).floor();
        [a.mul_add(b, c), c.abs().reciprocal_bound(), L::look_up(self.b, places)].map(|result| {
            let mut lanes = [0.0; 16];
            result.store(&mut lanes);
            lanes[..L::N].to_vec()
        })
    }
}

#[test]
fn every_backend_keeps_its_bounds() {
    let mut stream = Stream::new(13);
    for _ in 0..20_000 {
        let mut any = || libm::exp2(stream.between(-20.0, 20.0)) * stream.between(-1.0, 1.0);
        let [a, b, c] = [(); 3].map(|()| [(); 16].map(|()| any()));
        let job = EveryBoundedOperation { a: &a, b: &b, c: &c };
        for backend in Backend::ALL.into_iter().filter(|backend| backend.is_available()) {
            for [sums, reciprocals, found] in [backend.run(job), backend.run_twofold(job)] {
                for i in 0..sums.len() {
                    let name = backend.name();
                    let rounded = [a[i] * b[i] + c[i], libm::fma(a[i], b[i], c[i])];
                    assert!(rounded.contains(&sums[i]), "{name}: {} · {} + {} = {}", a[i], b[i], c[i], sums[i]);
                    let excess = libm::fma(reciprocals[i], c[i].abs(), -1.0);
                    assert!((0.0..1e-3).contains(&excess), "{name}: 1/{} ≤ {}", c[i].abs(), reciprocals[i]);
                    assert_eq!(found[i], b[(a[i].abs() * 1e6).min(15.0) as usize], "{name}");
                }
            }
        }
    }
}

#[test]
fn a_pair_is_its_lanes_side_by_side() {
    type Sixteen = pair::Pair<scalar::Lanes8>;
    let mut stream = Stream::new(12);
    for _ in 0..1000 {
        let [a, b] = [(); 2].map(|()| [(); 16].map(|()| (stream.unit() * 4.0).floor()));
        let bits = stream.below(1 << 16) as u32;
        let chosen = |k: &usize| bits >> k & 1 != 0;
        let mask = <Sixteen as Numbers>::Mask::from_bits(bits);
        let (mut sums, mut packed, mut whole) = ([0.0; 16], [0.0; 16], [9; 16]);
        (Sixteen::load(&a) + Sixteen::load(&b)).store(&mut sums);
        Sixteen::load(&a).store_packed(mask, &mut packed);
        Sixteen::load(&a).store_whole(mask, &mut whole);
        assert_eq!(sums, std::array::from_fn(|k| a[k] + b[k]));
        let kept: Vec<_> = (0..16).filter(chosen).map(|k| a[k]).collect();
        assert_eq!(packed[..kept.len()], kept);
        assert_eq!(whole, std::array::from_fn(|k| if chosen(&k) { a[k] as u32 } else { 9 }));
        let less = (0..16).filter(|&k| a[k] < b[k]).fold(0, |less, k| less | 1 << k);
        assert_eq!(Sixteen::load(&a).lt(Sixteen::load(&b)).bits(), less);
        assert_eq!((mask.bits(), mask.any(), (!mask).bits()), (bits, bits != 0, !bits & 0xffff));
    }
}

#[test]
fn the_best_backend_is_available() {
    assert!(Backend::best().is_available());
    assert!(Backend::Scalar.is_available());
}
