//! The hot loops: which primitives a ray may meet at all.
//!
//! A kernel works in plain binary64 and may only *reject*: a primitive that it rejects is not met, by a bound on its own
//! rounding and on what the ray is off. What it keeps is tested again with bounds by `intersect`. Later backends answer
//! with the same bits as [`scalar`].

pub mod scalar;

/// Half an ulp of 1.
const ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// More than underflow can take away: 2⁻⁹⁶⁰.
const UNDERFLOW: f64 = f64::from_bits((1023 - 960) << 52);

/// A ray in plain binary64, and how far it is off.
#[derive(Clone, Copy, Debug)]
pub struct KernelRay {
    /// Where it starts.
    pub origin: [f64; 3],
    /// Where it goes; need not be of unit length.
    pub dir: [f64; 3],
    /// A bound on the error of each coordinate of the origin.
    pub origin_error: f64,
    /// A bound on the error of the height of the origin, which is exact on a cap.
    pub origin_y_error: f64,
    /// A bound on the error of each coordinate of the direction.
    pub dir_error: f64,
}
