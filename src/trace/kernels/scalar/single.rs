//! Binary32 lanes of plain numbers: the specification of the other backends.

use crate::trace::kernels::SingleLanes;
use crate::trace::kernels::scalar::scalar_lanes;

#[cfg(debug_assertions)]
scalar_lanes!(inline(never), Lanes16: [f32; 16], Mask16: u16);
#[cfg(not(debug_assertions))]
scalar_lanes!(inline, Lanes16: [f32; 16], Mask16: u16);

impl SingleLanes for Lanes16 {
    #[inline]
    fn same(number: f32) -> Self {
        Self([number; 16])
    }
}
