//! Who settles what double-double leaves open.

use std::fmt::Debug;

use crate::trace::Touches;

/// Settles single pixels beyond doubt, however long it takes, and hears of ties. The tracer does not know more; see `exec`.
pub trait Referee: Debug + Sync {
    /// Returns the bytes of a pixel, and the number of its ties: the comparisons that were made by the rule for equality.
    fn settle(&self, column: u32, row: u32) -> ([u8; 3], u32);

    /// Hears of the ties of a pixel that was settled without it: they are proved.
    fn hear(&self, column: u32, row: u32, touches: Touches);
}
