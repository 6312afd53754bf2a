//! Rejects cylinders: a line that misses the infinite wall misses the caps too.

use crate::plan::CylinderLanes;
use crate::trace::reject::{Offsets, PlainRay, ROUNDOFF, leads_away, line_misses};

/// Appends to `kept` those of the cylinders `among` that the ray may meet, in order.
pub fn keep_cylinders(ray: &PlainRay, cylinders: &CylinderLanes, among: &[u32], kept: &mut Vec<u32>) {
    let n_cylinders = cylinders.radius.len();
    let (xs, zs, radii) = (&cylinders.x[..n_cylinders], &cylinders.z[..n_cylinders], &cylinders.radius);
    let [ox, oy, oz] = ray.origin;
    let [dx, dy, dz] = ray.dir;
    let dir = dx.abs() + dz.abs();
    let dir_squared = dx * dx + dz * dz;
    let y_slack = if ray.origin_y_error == 0.0 { 0.0 } else { ray.origin_y_error + 4.0 * ROUNDOFF * oy.abs() };
    let (bottom, top) = (oy - y_slack, oy + y_slack);
    let (falls, rises) = (dy < -ray.dir_error, dy > ray.dir_error);
    for &idx in among {
        let i = idx as usize;
        // A ray that rises from the upper cap leaves it at once; only its start, which is no hit, has that height.
        if (falls && top <= cylinders.y_min[i]) || (rises && bottom >= cylinders.y_max[i]) {
            continue;
        }
        let (mx, mz) = (xs[i] - ox, zs[i] - oz);
        let offsets = Offsets::new(ray, mx.abs() + mz.abs(), dir);
        let cross = mz * dx - mx * dz;
        if line_misses(ray, &offsets, cross * cross, cross.abs(), dir_squared, dir, radii[i])
            || leads_away(ray, &offsets, mx * dx + mz * dz, mx * mx + mz * mz, radii[i])
        {
            continue;
        }
        kept.push(idx);
    }
}
