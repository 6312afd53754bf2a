//! Points and directions of the renderer's numbers.

use crate::exact::real::Real;

/// A point or a direction.
pub type Vec3 = [Real; 3];

pub fn sub(a: &Vec3, b: &Vec3) -> Vec3 {
    [&a[0] - &b[0], &a[1] - &b[1], &a[2] - &b[2]]
}

pub fn add(a: &Vec3, b: &Vec3) -> Vec3 {
    [&a[0] + &b[0], &a[1] + &b[1], &a[2] + &b[2]]
}

pub fn scale(s: &Real, a: &Vec3) -> Vec3 {
    [s * &a[0], s * &a[1], s * &a[2]]
}

pub fn divide(a: &Vec3, s: &Real) -> Vec3 {
    [&a[0] / s, &a[1] / s, &a[2] / s]
}

pub fn dot(a: &Vec3, b: &Vec3) -> Real {
    &(&(&a[0] * &b[0]) + &(&a[1] * &b[1])) + &(&a[2] * &b[2])
}

pub fn negate(a: &Vec3) -> Vec3 {
    [-&a[0], -&a[1], -&a[2]]
}

/// Returns the vector without how its components were made.
pub fn forget(a: &Vec3) -> Vec3 {
    [a[0].forget(), a[1].forget(), a[2].forget()]
}
