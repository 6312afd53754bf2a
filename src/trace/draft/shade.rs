//! The colour that a packet of hits has by itself, and its bytes.

use crate::trace::draft::meet::{dot, minus, plus_times, same, times};
use crate::trace::draft::scene::{Power, Surface};
use crate::trace::draft::shadow::FaceLights;
use crate::trace::kernels::{Mask, SingleLanes};

/// Added before rounding down. The semantics fix 2⁻²⁰, which binary32 would lose; eight roundings of numbers up to 255 are
/// just covered by this.
const QUANTISATION_BIAS: f32 = 1.0 / 16384.0;

/// 1 + L·V is at least this, so that nothing is divided by 0 where the light is straight ahead of a grazing ray.
const MIN_HALF: f32 = 1.0 / 1_048_576.0;

/// A packet of hits on one face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Points<L: SingleLanes> {
    pub point: [L; 3],
    /// The unit normal.
    pub normal: [L; 3],
    /// The unit vector to where the ray comes from.
    pub view: [L; 3],
}

/// How many shadow rays a packet took, and how many tests.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ShadowRays {
    pub n_rays: u32,
    pub n_tests: u32,
}

/// Shades a packet of hits without their reflections; returns the colour, not clamped, and what shadow rays it took.
#[inline(always)]
pub(super) fn shade<L: SingleLanes>(
    lights: &FaceLights,
    surface: &Surface,
    at: &Points<L>,
    active: L::Mask,
) -> ([L; 3], ShadowRays) {
    let (zero, half, one) = (L::same(0.0), L::same(0.5), L::same(1.0));
    let mut color = same::<L>(surface.ambient);
    let mut counted = ShadowRays::default();
    for light in &lights.lights {
        let w = minus(at.point, light.position);
        let toward = -dot(at.normal, w);
        let facing = active & toward.gt(zero);
        if !facing.any() {
            continue;
        }
        let a = dot(w, w);
        let (lit, n_tested) = light.reaches(w, a, at.point, facing);
        let n_rays = if n_tested > 0 { facing.bits().count_ones() } else { 0 };
        counted.n_rays += n_rays;
        counted.n_tests += n_rays * n_tested;
        if !lit.any() {
            continue;
        }
        let per_distance = one / a.sqrt();
        let n_dot_l = toward * per_distance;
        let mut sum = times(same(light.diffuse), n_dot_l);
        if surface.has_specular {
            let n_dot_v = dot(at.normal, at.view);
            let s = (one - dot(w, at.view) * per_distance).max(L::same(MIN_HALF));
            let doubled = n_dot_l + n_dot_v;
            let squared = (doubled * doubled * half / s).min(one).max(L::same(surface.min_squared));
            let power = raise(squared, surface.power, lit);
            sum = plus_times(sum, same(light.specular), power);
        }
        color = [
            color[0] + L::select(lit, sum[0], zero),
            color[1] + L::select(lit, sum[1], zero),
            color[2] + L::select(lit, sum[2], zero),
        ];
    }
    (color, counted)
}

/// Returns x^P, given x².
#[inline(always)]
fn raise<L: SingleLanes>(squared: L, power: Power, lanes: L::Mask) -> L {
    match power {
        Power::Whole { half, is_odd } => {
            let mut result = if is_odd { squared.sqrt() } else { L::same(1.0) };
            let (mut factor, mut rest) = (squared, half);
            while rest > 0 {
                if rest & 1 != 0 {
                    result = result * factor;
                }
                rest >>= 1;
                if rest > 0 {
                    factor = factor * factor;
                }
            }
            result
        }
        Power::Other(half) => {
            let mut numbers = [0.0; 16];
            squared.store(&mut numbers);
            raise_each(&mut numbers[..L::N], half, lanes.bits());
            L::load(&numbers)
        }
    }
}

/// Raises those of the numbers that the bits name to a power.
fn raise_each(numbers: &mut [f32], exponent: f32, bits: u32) {
    for (i, number) in numbers.iter_mut().enumerate() {
        *number = if bits >> i & 1 != 0 { libm::powf(*number, exponent) } else { 0.0 };
    }
}

/// Returns the bytes of channels, clamped, as whole numbers.
#[inline(always)]
pub(super) fn bytes<L: SingleLanes>(color: [L; 3]) -> [L; 3] {
    [byte(color[0]), byte(color[1]), byte(color[2])]
}

/// Returns the byte of a channel, clamped, as a whole number.
#[inline(always)]
pub(super) fn byte<L: SingleLanes>(channel: L) -> L {
    (channel.min(L::same(1.0)).max(L::same(0.0)) * L::same(255.0) + L::same(QUANTISATION_BIAS)).floor()
}

/// Returns bytes as red + 2⁸·green + 2¹⁶·blue.
#[inline(always)]
pub(super) fn pack<L: SingleLanes>(bytes: [L; 3]) -> L {
    bytes[0] + bytes[1] * L::same(256.0) + bytes[2] * L::same(65536.0)
}
