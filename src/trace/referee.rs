//! Who settles what double-double leaves open.

use std::fmt::Debug;
use std::ops::Range;

use crate::trace::Touches;

/// A pixel. The order is that of rows from the top, and in a row from the left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// From the top.
    pub row: u32,
    /// From the left.
    pub column: u32,
}

/// Settles single pixels beyond doubt, as far as it may, and hears of ties. The tracer does not know more; see `exec`.
pub trait Referee: Debug + Sync {
    /// Returns for each pixel that was left open in some rows its bytes, or `None` if it is not to be settled: it then gets
    /// its [best value](crate::trace::BestValues).
    ///
    /// `open`: in order. Every pixel of these rows that is left open is among them. `is_cancelled`: ends the work early; what is
    /// then returned is used for nothing.
    fn settle(
        &self,
        rows: &Range<u32>,
        open: &[Place],
        is_cancelled: &(dyn Fn() -> bool + Sync),
    ) -> Vec<Option<[u8; 3]>>;

    /// Hears of the ties of a pixel that was settled without it: they are proved.
    fn hear(&self, column: u32, row: u32, touches: Touches);
}
