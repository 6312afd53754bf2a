//! Numbers that know how wrong they are, and vectors of them.
//!
//! The tracer is written once, over [`Real`]. [`Ball64`] carries a binary64 value with a bound on its error and decides
//! almost everything; [`Ball106`] does the same in double-double for what is left, and [`Long`] in some hundred bits for what
//! that leaves. A comparison answers only when the
//! bounds allow it ([`Real::sign`]), so that no constant of the kind `1e-6` is needed anywhere.
//!
//! Never here: what is compared, and what a tie means (see `trace`).

mod ball106;
mod ball64;
mod double_double;
mod elementary;
mod expansion;
mod long;
mod real;
mod vector;

pub use ball64::Ball64;
pub use ball106::Ball106;
pub use double_double::DoubleDouble;
pub use elementary::tan_half_degrees;
pub use expansion::{Expansion, compare_sum_zero, side_of};
pub use long::Long;
pub use real::{Real, Sign};
pub use vector::Vector;

#[cfg(test)]
mod tests;
