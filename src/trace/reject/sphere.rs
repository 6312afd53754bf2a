//! Rejects spheres.

use crate::plan::SphereLanes;
use crate::trace::reject::{Offsets, PlainRay, leads_away, line_misses};

/// Appends to `kept` those of the spheres `among` that the ray may meet, in order.
pub fn keep_spheres(ray: &PlainRay, spheres: &SphereLanes, among: &[u32], kept: &mut Vec<u32>) {
    let n_spheres = spheres.radius.len();
    let (xs, ys, zs, radii) =
        (&spheres.x[..n_spheres], &spheres.y[..n_spheres], &spheres.z[..n_spheres], &spheres.radius);
    let [ox, oy, oz] = ray.origin;
    let [dx, dy, dz] = ray.dir;
    let dir = dx.abs() + dy.abs() + dz.abs();
    let dir_squared = dx * dx + dy * dy + dz * dz;
    for &idx in among {
        let i = idx as usize;
        let (mx, my, mz) = (xs[i] - ox, ys[i] - oy, zs[i] - oz);
        let offsets = Offsets::new(ray, mx.abs() + my.abs() + mz.abs(), dir);
        let (cx, cy, cz) = (my * dz - mz * dy, mz * dx - mx * dz, mx * dy - my * dx);
        let cross_sum = cx.abs() + cy.abs() + cz.abs();
        let cross_squared = cx * cx + cy * cy + cz * cz;
        if line_misses(ray, &offsets, cross_squared, cross_sum, dir_squared, dir, radii[i])
            || leads_away(ray, &offsets, mx * dx + my * dy + mz * dz, mx * mx + my * my + mz * mz, radii[i])
        {
            continue;
        }
        kept.push(idx);
    }
}
