//! Who settles what double-double leaves open.

use std::fmt::Debug;

/// Settles single pixels beyond doubt, however long it takes. The tracer does not know how; see `exec`.
pub trait Referee: Debug + Sync {
    /// Returns the bytes of a pixel, and the number of its ties: the comparisons that were made by the rule for equality.
    fn settle(&self, column: u32, row: u32) -> ([u8; 3], u32);
}
