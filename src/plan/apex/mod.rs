//! What is seen from one point: outlines of objects on a plane before it, and bins of that plane.
//!
//! All eye rays start in the eye and all shadow rays towards one light end in it. About such an apex an object is an
//! outline, two numbers wide, and a ray is a point: instead of walking a tree it looks into the one bin that it falls in.
//!
//! Never here: which points the apexes are, and which rays look (see [`tiles`](crate::plan::Tiles)).

mod bins;
mod cube;
mod grid;
mod outline;
mod seen;

pub(super) use bins::{Bins, Cells};
pub(super) use cube::Cube;
pub use cube::{CubeFace, Expect, Look, Slopes};
pub(super) use outline::{BLOCK, Outline, Outlines};
pub(super) use seen::rounded_down;

/// Half an ulp of 1.
const ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// More than underflow can take away from the products of lengths: 2⁻⁹⁶⁰.
const UNDERFLOW: f64 = f64::from_bits((1023 - 960) << 52);
