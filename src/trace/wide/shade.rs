//! The colour that a packet of hits has by itself.
//!
//! # Errors
//! The point is off by e, the normal by η, the direction of the ray by ε, all as lengths of vectors. With w from the light
//! to the point, L = −w/|w| is off by λ = 2e/|w| + 8u, so that
//! - −n·w is off by η|w| + e + 4u|w|, with |w| ≤ (1 + |w|²)/2. A margin of 1024·e more makes sure that |w| > 1024·e where
//!   a light is lit, so that what is neglected in second order is below a thousandth;
//! - n·L is off by η + λ;
//! - with s = 1 + L·V, n·H = (n·L + n·V)/√(2s) is off by (2η + λ + ε + 8u)·(½ + 0.8/s), since 1/√(2s) ≤ ½ + ¼/s, a
//!   relative error of s is halved, and n·H ≤ 1;
//! - (n·H)^P is off by P times that for P ≥ 1, by the mean value theorem on 0…1, and by at most 64 times that for P < 1
//!   where n·H > 2⁻⁶.
//!
//! # Full channels
//! Where no term is negative, a channel that is above 1 by more than its error stays above whatever other lights add, and is
//! clamped. So when all channels of a packet are full, the lights that are left are not looked at (pass `saturation`).

use crate::trace::kernels::{Lanes, Mask, Precision};
use crate::trace::wide::bounds::{Power, Terms, WideLight};
use crate::trace::wide::shadow::{LightOccluders, shadow};

/// Added before rounding down; the semantics fix it.
const QUANTISATION_BIAS: f64 = 1.0 / 1_048_576.0;

/// What the channels of a colour that is exact lose on their way to a byte, in units of u: four roundings of numbers up to 255,
/// widened.
const BYTE_ROUNDING: f64 = 2048.0;

/// The largest error of a channel that can be rounded to a byte.
pub(super) const HALF_LEVEL: f64 = 0.5 / 255.5;

/// For P < 1, n·H squared must be above this.
const MIN_N_DOT_H_SQUARED: f64 = 1.0 / 4096.0;

/// s must be above this.
const MIN_HALF: f64 = 1.0 / 65536.0;

/// A packet of hits on one face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Points<L: Lanes> {
    pub point: [L; 3],
    /// The unit normal.
    pub normal: [L; 3],
    /// The unit vector to where the ray comes from; used for specular light alone.
    pub view: [L; 3],
    /// Normal times view; used for specular light and mirrors alone.
    pub cosine: L,
    pub point_error: L,
    pub normal_error: L,
    /// How far the computed normal is from unit length.
    pub length_error: L,
    pub dir_error: L,
    /// The number of the equation of what is met.
    pub equation: L,
    /// The lanes that there are.
    pub active: L::Mask,
}

/// A packet of colours.
#[derive(Clone, Copy, Debug)]
pub(super) struct Colors<L: Lanes> {
    /// Not clamped.
    pub color: [L; 3],
    /// A bound on the error of each channel.
    pub error: L,
    /// The lanes in which a light may be lit or not.
    pub doubt: L::Mask,
    /// How many shadow rays it took, and tests of these.
    pub shadow_rays: u32,
    pub shadow_tests: u32,
}

/// Returns a·b.
#[inline(always)]
pub(super) fn dot<L: Lanes>(a: [L; 3], b: [L; 3]) -> L {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// Makes every lane the same vector or colour.
#[inline(always)]
pub(super) fn splat_each<L: Lanes>([x, y, z]: [f64; 3]) -> [L; 3] {
    [L::splat(x), L::splat(y), L::splat(z)]
}

/// Shades a packet of hits without their reflections.
///
/// `GREY`: whether the terms are grey, which makes one channel stand for all.
#[inline(always)]
#[allow(clippy::needless_range_loop, reason = "an adapter is not always inlined into a packet")]
pub(super) fn shade<L: Lanes, const GREY: bool>(
    lights: &[WideLight],
    terms: &Terms,
    occluders: &LightOccluders,
    at: &Points<L>,
) -> Colors<L> {
    let none = L::Mask::from_bits(0);
    let zero = L::splat(0.0);
    let mut colors =
        Colors { color: splat_each(terms.ambient), error: zero, doubt: none, shadow_rays: 0, shadow_tests: 0 };
    if !terms.answers() {
        return colors;
    }
    let mut any_lit = none;
    let (half, one) = (L::splat(0.5), L::splat(1.0));
    let normal_slack = at.normal_error + L::splat(8.0 * L::U);
    let point_slack = at.point_error * L::splat(1026.0);
    for light_idx in 0..lights.len().min(terms.lights.len()) {
        if occluders.is_hidden(light_idx) {
            continue;
        }
        let (light, light_terms) = (&lights[light_idx], &terms.lights[light_idx]);
        if light_terms.may_be_idle && !(at.active & !(colors.doubt | are_full(&colors))).any() {
            break;
        }
        let w: [L; 3] = [
            at.point[0] - L::splat(light.position[0]),
            at.point[1] - L::splat(light.position[1]),
            at.point[2] - L::splat(light.position[2]),
        ];
        let a = dot(w, w);
        let toward = -dot(at.normal, w);
        let margin = normal_slack.mul_add(a.mul_add(half, half), point_slack);
        let faces = at.active & toward.gt(-margin);
        if !faces.any() {
            continue;
        }
        let sure = toward.gt(margin);
        colors.doubt = colors.doubt | (faces & !sure);
        let facing = faces & sure;
        let distance = a.sqrt();
        let mut lit = facing;
        if !occluders.is_open(light_idx) {
            let (blocked, doubt, n_tested) = shadow(light, occluders, light_idx, &w, a, distance, at, facing);
            let n_rays = facing.bits().count_ones();
            colors.shadow_rays += n_rays;
            colors.shadow_tests += n_rays * n_tested;
            colors.doubt = colors.doubt | doubt;
            lit = facing & !blocked;
        }
        if !lit.any() {
            continue;
        }
        any_lit = any_lit | lit;
        let per_distance = one / distance;
        let n_dot_l = toward * per_distance;
        let light_slack = at.point_error.mul_add(per_distance + per_distance, L::splat(8.0 * L::U));
        let diffuse_error = at.normal_error + light_slack + L::splat(16.0 * L::U);
        let mut error = diffuse_error.mul_add(L::splat(light_terms.max_diffuse), colors.error);
        let mut color = add_term::<L, GREY>(n_dot_l, light_terms.diffuse, colors.color);
        if terms.has_specular {
            let l_dot_v = -(dot(w, at.view) * per_distance);
            let s = one + l_dot_v;
            let doubled = n_dot_l + at.cosine;
            let per_s = one / s;
            let squared = (doubled * doubled * half * per_s).min(one);
            let mut vague = lit & !s.gt(L::splat(MIN_HALF));
            let slack = at.normal_error * L::splat(2.0) + light_slack + at.dir_error + L::splat(8.0 * L::U);
            let off = slack * (half + L::splat(0.8) * per_s) + L::splat(8.0 * L::U);
            let (power, gain) = match terms.power {
                Power::One => (one, 0.0),
                Power::Whole { half, is_odd } => (raise(squared, half, is_odd), terms.steepness),
                Power::Other(exponent) => {
                    if exponent < 1.0 {
                        vague = vague | (lit & !squared.gt(L::splat(MIN_N_DOT_H_SQUARED)));
                    }
                    (raise_each(squared, exponent, lit), terms.steepness * 64.0)
                }
            };
            colors.doubt = colors.doubt | vague;
            let specular_error = off * L::splat(gain) + L::splat((2.0 * terms.steepness.min(1e9) + 16.0) * L::U);
            error = specular_error.mul_add(L::splat(light_terms.max_specular), error);
            color = add_term::<L, GREY>(power, light_terms.specular, color);
        }
        colors.error = L::select(lit, error, colors.error);
        for k in 0..3 {
            colors.color[k] = L::select(lit, color[k], colors.color[k]);
        }
    }
    // Where no light adds anything the colour is exact.
    colors.error = L::select(any_lit, colors.error + L::splat(terms.rounding), colors.error);
    colors
}

/// Tells in which lanes all channels are surely beyond 1.
#[inline(always)]
fn are_full<L: Lanes>(colors: &Colors<L>) -> L::Mask {
    let full = colors.error + L::splat(1.0);
    colors.color[0].gt(full) & colors.color[1].gt(full) & colors.color[2].gt(full)
}

/// Adds a share of a term to a colour.
#[inline(always)]
fn add_term<L: Lanes, const GREY: bool>(share: L, term: [f64; 3], color: [L; 3]) -> [L; 3] {
    let red = share.mul_add(L::splat(term[0]), color[0]);
    if GREY {
        return [red; 3];
    }
    [red, share.mul_add(L::splat(term[1]), color[1]), share.mul_add(L::splat(term[2]), color[2])]
}

/// Returns x^P, given x² and P as twice `half`, or one more.
#[inline(always)]
fn raise<L: Lanes>(squared: L, half: u32, is_odd: bool) -> L {
    let mut result = if is_odd { squared.sqrt() } else { L::splat(1.0) };
    let (mut factor, mut rest) = (squared, half);
    while rest > 0 {
        if rest & 1 != 0 {
            result = result * factor;
        }
        rest >>= 1;
        factor = factor * factor;
    }
    result
}

/// Returns x^P, given x², lane by lane.
#[inline(always)]
fn raise_each<L: Lanes>(squared: L, exponent: f64, lanes: L::Mask) -> L {
    let mut numbers = [0.0; 16];
    squared.store(&mut numbers);
    raise_slice(&mut numbers[..L::N], exponent, lanes.bits());
    L::load(&numbers)
}

/// Raises those of the squares that the bits name to the power.
fn raise_slice(squares: &mut [f64], exponent: f64, bits: u32) {
    for (i, number) in squares.iter_mut().enumerate() {
        *number = if bits >> i & 1 != 0 { libm::pow(number.sqrt(), exponent) } else { 0.0 };
    }
}

/// Returns the bytes of a packet of colours, as red + 2⁸·green + 2¹⁶·blue, and the lanes in which all three are proved.
///
/// `error`: of each channel.
#[inline(always)]
pub(super) fn quantise<L: Lanes>(color: [L; 3], error: L) -> (L, L::Mask) {
    let room = L::splat(0.5) - (error * L::splat(255.5) + L::splat(BYTE_ROUNDING * L::U));
    let (red, red_is_sure) = quantise_channel(color[0], error, room);
    let (green, green_is_sure) = quantise_channel(color[1], error, room);
    let (blue, blue_is_sure) = quantise_channel(color[2], error, room);
    let packed = red + green * L::splat(256.0) + blue * L::splat(65536.0);
    (packed, red_is_sure & green_is_sure & blue_is_sure)
}

/// Returns the bound that [`quantise`] takes for the error of 255 c.
pub(super) fn bound_in_levels(error: f64) -> f64 {
    if error > 0.0 { error * 255.5 + BYTE_ROUNDING * Precision::BINARY64.u } else { 0.0 }
}

/// Returns the byte of a channel, and the lanes in which it is proved.
///
/// `room`: how far from one half the fraction may be.
#[inline(always)]
fn quantise_channel<L: Lanes>(channel: L, error: L, room: L) -> (L, L::Mask) {
    let (zero, half, one) = (L::splat(0.0), L::splat(0.5), L::splat(1.0));
    let scaled = channel.min(one).max(zero) * L::splat(255.0) + L::splat(QUANTISATION_BIAS);
    let floor = scaled.floor();
    let is_inside = (scaled - floor - half).abs().lt(room);
    // What is clamped for sure is a whole number however large the error.
    let is_clamped = (channel - error).gt(one) | (channel + error).lt(zero);
    (floor, is_inside | is_clamped)
}
