//! Vectors of any [`Real`].

use std::ops::{Add, Sub};

use crate::math::Real;

/// A vector in world space or a colour, as the context says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<R> {
    /// First coordinate, or red.
    pub x: R,
    /// Second coordinate, or green.
    pub y: R,
    /// Third coordinate, or blue.
    pub z: R,
}

impl<R: Real> Vector<R> {
    /// Makes a vector.
    #[inline]
    pub fn new(x: R, y: R, z: R) -> Self {
        Self { x, y, z }
    }

    /// Makes a vector that is known exactly.
    #[inline]
    pub fn exact(v: glam::DVec3) -> Self {
        Self::new(R::exact(v.x), R::exact(v.y), R::exact(v.z))
    }

    /// Applies `f` to each coordinate.
    #[inline]
    pub fn map<S: Real>(self, mut f: impl FnMut(R) -> S) -> Vector<S> {
        Vector::new(f(self.x), f(self.y), f(self.z))
    }

    /// Returns the coordinates.
    #[inline]
    pub fn to_array(self) -> [R; 3] {
        [self.x, self.y, self.z]
    }

    /// Returns the product with a number.
    #[inline]
    pub fn scale(self, factor: R) -> Self {
        self.map(|coordinate| coordinate * factor)
    }

    /// Returns the product coordinate by coordinate.
    #[inline]
    pub fn times(self, other: Self) -> Self {
        Self::new(self.x * other.x, self.y * other.y, self.z * other.z)
    }

    /// Returns the scalar product.
    #[inline]
    pub fn dot(self, other: Self) -> R {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Returns the vector product.
    #[inline]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    /// Returns the squared length.
    #[inline]
    pub fn length_squared(self) -> R {
        self.x.square() + self.y.square() + self.z.square()
    }
}

impl<R: Real> Add for Vector<R> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<R: Real> Sub for Vector<R> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}
