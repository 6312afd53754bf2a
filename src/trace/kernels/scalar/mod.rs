//! Lanes of plain numbers: the specification of the other backends.

pub(super) mod single;

/// Declares lanes of numbers, and their truths, a bit each. The rest of this file reads like the formulas.
///
/// An operation is a loop that the compiler turns into a few instructions. It must do so before the operation becomes part
/// of a kernel (so `inline`, not `inline(always)`): thousands of loops in one function would take it minutes. With
/// `inline(never)` it stays out of kernels, which then compile three times as soon.
macro_rules! scalar_lanes {
    ($inline:meta, $lanes:ident: [$number:ident; $n:literal], $mask:ident: $bits:ident) => {
        use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

        use crate::trace::kernels::{Mask, Numbers};

        #[doc = concat!("Lanes of `", stringify!($number), "`.")]
        #[derive(Clone, Copy, Debug)]
        pub(in crate::trace::kernels) struct $lanes([$number; $n]);

        #[doc = concat!("Truths of [`", stringify!($lanes), "`], a bit each.")]
        #[derive(Clone, Copy, Debug)]
        pub(in crate::trace::kernels) struct $mask($bits);

        impl $lanes {
            #[$inline]
            fn map(mut self, f: impl Fn($number) -> $number) -> Self {
                for lane in &mut self.0 {
                    *lane = f(*lane);
                }
                self
            }

            #[$inline]
            fn zip(mut self, other: Self, f: impl Fn($number, $number) -> $number) -> Self {
                for (lane, other) in self.0.iter_mut().zip(other.0) {
                    *lane = f(*lane, other);
                }
                self
            }

            #[$inline]
            fn compare(self, other: Self, f: impl Fn($number, $number) -> bool) -> $mask {
                let mut bits = 0;
                for i in 0..$n {
                    bits |= <$bits>::from(f(self.0[i], other.0[i])) << i;
                }
                $mask(bits)
            }
        }

        impl Add for $lanes {
            type Output = Self;

            #[$inline]
            fn add(self, other: Self) -> Self {
                self.zip(other, |a, b| a + b)
            }
        }

        impl Sub for $lanes {
            type Output = Self;

            #[$inline]
            fn sub(self, other: Self) -> Self {
                self.zip(other, |a, b| a - b)
            }
        }

        impl Mul for $lanes {
            type Output = Self;

            #[$inline]
            fn mul(self, other: Self) -> Self {
                self.zip(other, |a, b| a * b)
            }
        }

        impl Div for $lanes {
            type Output = Self;

            #[$inline]
            fn div(self, other: Self) -> Self {
                self.zip(other, |a, b| a / b)
            }
        }

        impl Neg for $lanes {
            type Output = Self;

            #[$inline]
            fn neg(self) -> Self {
                self.map(|a| -a)
            }
        }

        impl Numbers for $lanes {
            const N: usize = $n;

            type Mask = $mask;

            type Element = $number;

            #[$inline]
            fn splat(number: f64) -> Self {
                Self([number as $number; $n])
            }

            #[$inline]
            fn load(from: &[$number]) -> Self {
                Self(std::array::from_fn(|i| from[..$n][i]))
            }

            #[$inline]
            fn store(self, to: &mut [$number]) {
                to[..$n].copy_from_slice(&self.0);
            }

            #[$inline]
            fn store_packed(self, mask: $mask, to: &mut [$number]) {
                let to = &mut to[..$n];
                let mut n = 0;
                for (i, lane) in self.0.into_iter().enumerate() {
                    if mask.0 >> i & 1 != 0 {
                        to[n] = lane;
                        n += 1;
                    }
                }
            }

            #[$inline]
            fn store_whole(self, mask: $mask, to: &mut [u32]) {
                let to = &mut to[..$n];
                for (i, lane) in self.0.into_iter().enumerate() {
                    if mask.0 >> i & 1 != 0 {
                        to[i] = lane as u32;
                    }
                }
            }

            #[$inline]
            fn sqrt(self) -> Self {
                self.map(<$number>::sqrt)
            }

            #[$inline]
            fn floor(self) -> Self {
                self.map(<$number>::floor)
            }

            #[$inline]
            fn abs(self) -> Self {
                self.map(<$number>::abs)
            }

            #[$inline]
            fn min(self, other: Self) -> Self {
                self.zip(other, |a, b| if a < b { a } else { b })
            }

            #[$inline]
            fn max(self, other: Self) -> Self {
                self.zip(other, |a, b| if a > b { a } else { b })
            }

            #[$inline]
            fn lt(self, other: Self) -> $mask {
                self.compare(other, |a, b| a < b)
            }

            #[$inline]
            fn le(self, other: Self) -> $mask {
                self.compare(other, |a, b| a <= b)
            }

            #[$inline]
            fn eq(self, other: Self) -> $mask {
                self.compare(other, |a, b| a == b)
            }

            #[$inline]
            fn select(mask: $mask, yes: Self, no: Self) -> Self {
                Self(std::array::from_fn(|i| if mask.0 >> i & 1 != 0 { yes.0[i] } else { no.0[i] }))
            }
        }

        impl Mask for $mask {
            #[$inline]
            fn from_bits(bits: u32) -> Self {
                Self(bits as $bits)
            }

            #[$inline]
            fn bits(self) -> u32 {
                self.0.into()
            }
        }

        impl BitAnd for $mask {
            type Output = Self;

            #[$inline]
            fn bitand(self, other: Self) -> Self {
                Self(self.0 & other.0)
            }
        }

        impl BitOr for $mask {
            type Output = Self;

            #[$inline]
            fn bitor(self, other: Self) -> Self {
                Self(self.0 | other.0)
            }
        }

        impl Not for $mask {
            type Output = Self;

            #[$inline]
            fn not(self) -> Self {
                Self(!self.0)
            }
        }
    };
}

pub(super) use scalar_lanes;

#[cfg(debug_assertions)]
scalar_lanes!(inline(never), Lanes8: [f64; 8], Mask8: u8);
#[cfg(not(debug_assertions))]
scalar_lanes!(inline, Lanes8: [f64; 8], Mask8: u8);

impl crate::trace::kernels::Lanes for Lanes8 {
    type Single = single::Lanes16;

    #[inline]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }

    #[inline]
    fn reciprocal_bound(self) -> Self {
        Self([1.0 + f64::EPSILON; 8]) / self
    }

    #[inline]
    fn look_up(table: &[f64; 16], places: Self) -> Self {
        places.map(|place| table[place as usize % 16])
    }
}
