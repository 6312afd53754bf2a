//! Holds long numbers against arbitrary precision: random programs, the ends of wide balls, exponents beyond binary64.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;

use super::radius::{Radius, parts};
use super::*;
use crate::math::{DoubleDouble, Sign};
use crate::testing::Stream;

type Big = FBig<HalfEven, 2>;

/// Far more than 16 limbs have.
const PRECISION_BITS: usize = 2600;

fn big(value: f64) -> Big {
    Big::try_from(value).expect("a finite number").with_precision(PRECISION_BITS).value()
}

/// Multiplies by 2^`by`.
fn shifted(x: Big, by: i64) -> Big {
    x << isize::try_from(by).expect("an exponent")
}

/// Returns a middle, exactly.
pub(in crate::math) fn big_middle<const N: usize>(number: &Long<N>) -> Big {
    let halves = number.digits().iter().flat_map(|limb| [limb >> 32, limb & 0xffff_ffff]);
    let whole = halves.fold(big(0.0), |whole, half| shifted(whole, 32) + big(half as f64));
    let middle = shifted(whole, number.exponent - 64 * i64::from(number.len));
    if number.is_negative { -middle } else { middle }
}

fn big_size(size: Radius) -> Big {
    let (mantissa, exponent) = size.parts();
    shifted(big(mantissa as f64), exponent)
}

fn magnitude(x: Big) -> Big {
    if x < big(0.0) { -x } else { x }
}

/// Asserts that a ball holds a number, and that the number of its limbs is sound.
fn assert_holds<const N: usize>(what: &str, ball: &Long<N>, exact: &Big) {
    assert!(ball.len as usize <= N && (ball.len == 0 || ball.limbs[0] >> 63 == 1), "{what}: {ball:?}");
    if ball.radius.is_infinite() {
        return;
    }
    let off = magnitude(exact.clone() - big_middle(ball));
    // The other library is off by a rounding or two, also where the number is exact.
    let slack = shifted(magnitude(exact.clone()), 100 - PRECISION_BITS as i64);
    assert!(off <= big_size(ball.radius) + slack, "{what}: off by {:e}: {ball:?}", off.to_f64().value());
}

/// Returns a number of `bits` bits and an exponent up to ±`reach`, exactly.
fn any_number<const N: usize>(stream: &mut Stream, reach: f64) -> Long<N> {
    let n = 1 + stream.below(N);
    let mut number = Long::power_of_two(stream.between(-reach, reach) as i64);
    for limb in &mut number.limbs[..n] {
        *limb = match stream.below(6) {
            0 => 0,
            1 => u64::MAX,
            2 => 1,
            _ => ((stream.unit() * 4_294_967_296.0) as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15),
        };
    }
    number.limbs[0] |= 1 << 63;
    number.limbs[n - 1] |= 1;
    Long { len: n as u32, is_negative: stream.below(2) == 0, ..number }
}

/// Gives a number a bound: none, one of its roundings, or up to twice its size.
fn widened<const N: usize>(stream: &mut Stream, number: Long<N>) -> Long<N> {
    if stream.below(4) == 0 {
        return number;
    }
    let mantissa = 1 + (stream.unit() * 1e9) as u64;
    let bits = stream.between(-2.0, 64.0 * N as f64) as i64;
    let radius = Radius::new(mantissa, number.exponent - bits - 30);
    Long { radius, ..number }.with_fitting_limbs()
}

impl<const N: usize> Long<N> {
    /// Drops the limbs that the bound makes needless, into the bound.
    fn with_fitting_limbs(self) -> Self {
        let n = Self::n_limbs(self.exponent, self.radius);
        if (self.len as usize) <= n { self } else { Self { len: n as u32, ..self }.finished(1, self.exponent, n) }
    }

    fn big_ends(&self) -> [Big; 2] {
        let (middle, radius) = (big_middle(self), big_size(self.radius));
        [middle.clone() - radius.clone(), middle + radius]
    }
}

/// Asserts that a result holds what the ends of its operands give, and is not much wider than it has to be: a thousandth and
/// `units` of the last place of N limbs for a result of size `scale`.
fn assert_fits<const N: usize>(what: &str, ball: &Long<N>, exact: &[Big], spare: f64, scale: &Big, units: f64) {
    assert!(!ball.radius.is_infinite(), "{what}: nothing is known");
    exact.iter().for_each(|exact| assert_holds(what, ball, exact));
    let offs = exact.iter().map(|exact| magnitude(exact.clone() - big_middle(ball)));
    let farthest = offs.reduce(|a, b| if a < b { b } else { a }).expect("some ends");
    let most = farthest * big(spare) + shifted(scale.clone() * big(units), -64 * N as i64);
    assert!(big_size(ball.radius) <= most, "{what}: wider than {most}: {ball:?}");
}

fn operations_hold<const N: usize>(reach: f64) {
    let mut stream = Stream::new(71 + N as u64);
    for _ in 0..3000 {
        let [a, mut b] = [(); 2].map(|()| any_number::<N>(&mut stream, reach));
        match stream.below(5) {
            // What is left of a difference are the last digits.
            0 => b = Long { exponent: a.exponent, ..a },
            1 => b.exponent = a.exponent + stream.below(3) as i64 - 1,
            _ => {}
        }
        let [a, b] = [a, b].map(|number| widened(&mut stream, number));
        let [ends_a, ends_b] = [a.big_ends(), b.big_ends()];
        let combine = |operation: fn(Big, Big) -> Big| -> Vec<Big> {
            ends_a.iter().flat_map(|a| ends_b.iter().map(|b| operation(a.clone(), b.clone()))).collect()
        };
        let [size_a, size_b] = [&a, &b].map(|ball| magnitude(big_middle(ball)));
        let units = 8.0 * N as f64 + 40.0;
        let sizes = size_a.clone() + size_b.clone();
        assert_fits("sum", &(a + b), &combine(|a, b| a + b), 1.01, &sizes, units);
        assert_fits("difference", &(a - b), &combine(|a, b| a - b), 1.01, &sizes, units);
        assert_fits("product", &(a * b), &combine(|a, b| a * b), 1.01, &(size_a.clone() * size_b.clone()), units);
        let nearest = size_b - big_size(b.radius);
        if nearest > size_a.clone() * big(0.0) + shifted(big(1.0), b.exponent - 20) {
            let scale = size_a / nearest;
            assert_fits("quotient", &(a / b), &combine(|a, b| a / b), 1.01, &scale, units);
        }
        let root_of = |x: Big| if x < big(0.0) { big(0.0) } else { x.sqrt() };
        let positive = Long { is_negative: false, ..a };
        let roots = positive.big_ends().map(root_of);
        let is_narrow = positive.radius.shifted(8).is_below(positive.lower());
        let spare = if is_narrow { 1.1 } else { 2.2 };
        assert_fits("root", &positive.sqrt(), &roots, spare, &roots[1], 2.0 * units);
    }
}

#[test]
fn operations_hold_the_ends() {
    operations_hold::<1>(20.0);
    operations_hold::<2>(100.0);
    operations_hold::<3>(100.0);
    operations_hold::<4>(300.0);
    operations_hold::<16>(1000.0);
}

#[test]
fn exponents_beyond_binary64_are_ordinary() {
    operations_hold::<4>(5000.0);
}

#[test]
fn what_fits_is_exact() {
    let number = Long::<4>::exact;
    let exactly = |a: Long<4>, b: Long<4>| assert_eq!((a - b).sign(), Sign::Zero, "{a:?} {b:?}");
    let (huge, tiny) = (number(f64::MAX), number(5e-324));
    exactly(huge * huge / huge, huge);
    exactly((huge.square().square() * huge).sqrt() * number(0.0), number(0.0));
    exactly(tiny.square().square() / tiny.square(), tiny.square());
    assert_eq!((huge.square() - huge.square()).sign(), Sign::Zero);
    assert_eq!(((huge * tiny) - (tiny * huge)).sign(), Sign::Zero);
    assert_eq!((huge.square() + tiny - huge.square()).sign(), Sign::Unknown, "4,000 bits apart");
    assert_eq!((huge.square() + tiny).sign(), Sign::Positive);
    exactly(number(1e16) + number(1.0) - number(1e16), number(1.0));
    exactly(number(0.1) + number(1.0 / 1024.0) - number(0.1), number(1.0 / 1024.0));
    exactly(number(6.25) / number(2.5), number(2.5));
    assert_eq!((number(1.0) / number(3.0) * number(3.0) - number(1.0)).sign(), Sign::Unknown);
    // Zeros stay exact, whatever they are multiplied by.
    let third = number(1.0) / number(3.0);
    for nothing in
        [number(0.0) * third, third * number(-0.0), number(0.0) / third, number(0.0).sqrt(), number(0.0).pow(2.5)]
    {
        assert_eq!(nothing.sign(), Sign::Zero);
    }
    assert_eq!((third - third).sign(), Sign::Unknown);
}

#[test]
fn nothing_is_known_where_nothing_can_be() {
    let number = Long::<4>::exact;
    let third = number(1.0) / number(3.0);
    let in_doubt = third + third + third - number(1.0);
    for unknown in [number(1.0) / number(0.0), third / in_doubt, number(f64::INFINITY), number(f64::NAN)] {
        assert_eq!((unknown.sign(), unknown.error()), (Sign::Unknown, f64::INFINITY));
        for still in
            [unknown + third, third - unknown, unknown * third, unknown / third, third / unknown, unknown.sqrt()]
        {
            assert_eq!((still.sign(), still.error()), (Sign::Unknown, f64::INFINITY), "{still:?}");
        }
        assert_eq!((unknown.clamp_unit().value(), unknown.clamp_unit().error()), (0.5, 0.5));
        assert_eq!(unknown.floor(), None);
    }
    // Powers of powers leave the range of the exponents; what is then known is still true.
    let mut huge = number(f64::MAX);
    (0..60).for_each(|_| huge = huge.square());
    assert_eq!(huge.error(), f64::INFINITY);
    let mut tiny = number(5e-324);
    (0..60).for_each(|_| tiny = tiny.square());
    assert!(tiny.value() == 0.0 && tiny.error() > 0.0 && tiny.error() < 1e-280 && tiny.sign() == Sign::Unknown);
}

#[test]
fn shortened_numbers_hold_the_number_and_cost_less() {
    let third = Long::<16>::exact(1.0) / Long::exact(3.0);
    let exact = big(1.0) / big(3.0);
    for bits in [60, 106, 256, 300, 1000] {
        let short = third.shortened(bits);
        assert_holds("shortened", &short, &exact);
        assert!(short.known_bits() >= i64::from(bits) - 2 && short.len <= bits / 64 + 2, "{bits}: {short:?}");
        let product = short * short;
        assert!(product.len <= short.len && product.known_bits() >= i64::from(bits) - 4);
    }
}

#[test]
fn values_and_bounds_in_binary64_hold_the_number() {
    let mut stream = Stream::new(73);
    for _ in 0..2000 {
        let exact = any_number::<4>(&mut stream, 1100.0);
        let number = widened(&mut stream, exact);
        let (value, error) = (number.value(), number.error());
        if !value.is_finite() || !error.is_finite() {
            assert!(number.exponent > 1000 || !value.is_nan());
            continue;
        }
        let off = magnitude(big(value) - big_middle(&number)) + big_size(number.radius);
        let rounding = big(value.abs()) * big(f64::EPSILON);
        assert!(off <= big(error) + rounding, "{number:?}: {value} ± {error}");
    }
    for value in [0.0, 1.0, -1.5, 0.1, f64::MAX, f64::MIN_POSITIVE, 1e-310, 5e-324, -123.456e-100] {
        let number = Long::<4>::exact(value);
        assert_eq!((number.value(), number.radius), (value, Radius::ZERO));
        assert!(number.error() == 0.0 || value.abs() < 1e-280);
    }
    let (mantissa, exponent) = parts(0.75);
    assert_eq!(mantissa as f64 * libm::exp2(exponent as f64), 0.75);
}

/// Powers by another library; what lies below 0 counts as 0.
fn big_power(x: &Big, exponent: f64) -> Big {
    match exponent {
        _ if *x <= big(0.0) => big(0.0),
        1.0 => x.clone(),
        _ => (x.ln() * big(exponent)).exp(),
    }
}

fn powers_hold<const N: usize>(n_cases: usize) {
    let mut stream = Stream::new(79);
    for exponent in [0.5, 1.0, 2.0, 2.5, 7.5, 20.0, 33.25, 1000.0, 1e6, 1e6 + 0.5] {
        for _ in 0..n_cases {
            let x = if exponent > 100.0 { 1.0 - stream.unit() * 1e-4 } else { stream.unit() };
            let power = Long::<N>::exact(x).pow(exponent);
            assert_holds("power", &power, &big_power(&big(x), exponent));
            let least_bits = 64 * N as i64 - 60;
            assert!(power.known_bits() >= least_bits, "{x}^{exponent}: {} bits: {power:?}", power.known_bits());
        }
    }
}

#[test]
fn powers_are_known_to_the_full_width() {
    powers_hold::<4>(4);
    powers_hold::<16>(1);
}

#[test]
fn powers_of_the_tiny_and_to_the_huge_hold() {
    let tiny = Long::<4>::exact(1e-300).square();
    for exponent in [0.25, 2.5, 100.5, 3.0] {
        let exact = big_power(&(big(1e-300) * big(1e-300)), exponent);
        assert_holds("power", &tiny.pow(exponent), &exact);
        assert!(tiny.pow(exponent).known_bits() > 180);
    }
    let below_1 = Long::<4>::exact(0.999);
    for exponent in [1e15 + 0.5, 1e300] {
        let power = below_1.pow(exponent);
        assert!(power.value() < 1e-280 && power.error() < 1e-280, "{power:?}");
    }
    assert_eq!(Long::<4>::exact(1.001).pow(1e300).error(), f64::INFINITY);
}

#[test]
fn tangents_are_known_to_the_full_width() {
    for degrees in [1e-300, 2e-4, 1.0, 33.3, 60.0, 90.0, 90.000_000_01, 120.0, 175.0, 179.999_999, 180.0 - 1e-13] {
        let tangent = Long::<16>::tan_half_degrees(degrees);
        let angle = big(degrees) * big_pi() / big(360.0);
        let (sin, cos) = big_sin_cos(&angle);
        assert_holds("tangent", &tangent, &(sin / cos));
        assert!(tangent.known_bits() > 16 * 64 - 60, "{degrees}: {} bits", tangent.known_bits());
    }
}

/// π by the arithmetic and geometric mean (Brent, Salamin).
fn big_pi() -> Big {
    let (mut a, mut b) = (big(1.0), (big(1.0) / big(2.0)).sqrt());
    let (mut t, mut p) = (big(0.25), big(1.0));
    for _ in 0..12 {
        let next = (a.clone() + b.clone()) / big(2.0);
        b = (a.clone() * b).sqrt();
        let off = a - next.clone();
        t -= p.clone() * off.clone() * off;
        p *= big(2.0);
        a = next;
    }
    (a.clone() + b.clone()) * (a + b) / (big(4.0) * t)
}

/// Sine and cosine by their series, which converges for every angle here.
fn big_sin_cos(angle: &Big) -> (Big, Big) {
    let (mut sin, mut cos, mut term) = (big(0.0), big(0.0), big(1.0));
    for n in 0..400u32 {
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
fn sizes_round_to_their_sides() {
    let mut stream = Stream::new(83);
    for _ in 0..20_000 {
        let [a, b] = [(); 2].map(|()| {
            let mantissa = 1 + (stream.unit() * libm::exp2(stream.between(1.0, 52.0))) as u64;
            Radius::new(mantissa, stream.between(-40.0, 40.0) as i64)
        });
        let [exact_a, exact_b] = [a, b].map(|size| big_size(size).with_precision(300).value());
        let upper = |what: &str, bound: Radius, exact: Big| {
            let bound = big_size(bound);
            assert!(exact <= bound, "{what}: {a:?} {b:?}");
            assert!(bound <= exact * big(1.0 + libm::exp2(-29.0)), "{what} is far off: {a:?} {b:?}");
        };
        upper("sum", a.plus(b), exact_a.clone() + exact_b.clone());
        upper("product", a.times(b), exact_a.clone() * exact_b.clone());
        upper("quotient", a.over(b), exact_a.clone() / exact_b.clone());
        upper("root", a.square_root(), exact_a.sqrt());
        let difference = a.minus_down(b);
        assert!(big_size(difference) <= exact_a.clone() - exact_b.clone() || difference.is_zero());
        if exact_a > exact_b.clone() * big(1.001) {
            assert!(big_size(difference) * big(1.001) >= exact_a.clone() - exact_b.clone(), "{a:?} {b:?}");
        }
        assert_eq!(a.is_below(b), exact_a < exact_b);
        assert!(big(a.to_f64_up()) >= exact_a && a.to_f64_up() == a.shifted(3).shifted(-3).to_f64_up());
        let growing = big_size(a.by_1_859_down());
        assert!(growing <= exact_a.clone() * big(1.859_375) && growing >= exact_a * big(1.859));
    }
    for size in [Radius::INFINITE, Radius::INFINITE.shifted(-9), Radius::ZERO.plus(Radius::INFINITE)] {
        assert!(size.is_infinite() && size.to_f64_up() == f64::INFINITY);
    }
    assert!(Radius::of_f64(f64::NAN).is_infinite() && Radius::of_f64(0.0).is_zero());
    assert_eq!(Radius::power_of_two(-5000).to_f64_up(), f64::MIN_POSITIVE);
    assert_eq!(Radius::power_of_two(5000).to_f64_up(), f64::INFINITY);
}

#[test]
fn a_double_double_keeps_its_digits_and_its_bound() {
    let number = DoubleDouble::sum(1.0, 1e-25);
    let long = Long::<4>::rounded(number, 1e-30);
    let sign_beside = |offset: f64| (long - Long::exact(1.0) - Long::exact(offset)).sign();
    assert_eq!(sign_beside(0.99e-25), Sign::Positive);
    assert_eq!(sign_beside(1.01e-25), Sign::Negative);
    assert_eq!(sign_beside(1.000_001e-25), Sign::Unknown);
}
