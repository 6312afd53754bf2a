//! Pass `bounces`, its part that is known before a ray is cast: what a reflected ray can meet, given what it leaves.
//!
//! # Why it is safe
//! - A ray that leaves a sealed object (see `objects`) leaves a convex solid outwards and does not come back to it.
//! - A ray from a mirror of which only the upper cap is met leaves it upwards, since it came from above: it is never as
//!   low as the cap again, and meets nothing that lies no higher. Likewise from a lower cap.
//! - The longest chain of mirrors each of which can meet the next bounds the levels, when no mirror comes twice in it.
//!
//! The rest of the pass, weights too small for a pixel, is known to the tracer alone.

use crate::math::compare_sum_zero;
use crate::plan::bodies::Solid;
use crate::plan::candidates::ListTable;
use crate::plan::objects::Roles;
use crate::plan::solid::Faces;

/// Lists for each object what rays that it reflects can meet.
pub(super) fn reflected_lists(solids: &[Solid], roles: &Roles, n_spheres: usize) -> ListTable {
    let mut lists = ListTable::new(n_spheres);
    for from in 0..solids.len() {
        let is_mirror = roles.is_mirror[from];
        let may_meet = |&to: &usize| is_mirror && roles.mirrored[to] && can_meet(solids, roles, from, to);
        lists.push((0..solids.len()).filter(may_meet));
    }
    lists
}

fn can_meet(solids: &[Solid], roles: &Roles, from: usize, to: usize) -> bool {
    if !roles.sealed[from] {
        return true;
    }
    if from == to {
        return false;
    }
    let Solid::Cylinder { y_min, y_max, .. } = solids[from] else { return true };
    let [[bottom, above_bottom], [top, above_top]] = solids[to].heights();
    match roles.faces[from] {
        Faces { wall: false, lower: false, upper: true } => compare_sum_zero([top, above_top, -y_max]).is_gt(),
        Faces { wall: false, lower: true, upper: false } => compare_sum_zero([y_min, -bottom, -above_bottom]).is_gt(),
        faces => !faces.is_empty(),
    }
}

/// Returns the most reflections that an eye ray can have; `None` when mirrors may send it on and on.
pub(super) fn longest_chain(lists: &ListTable, roles: &Roles) -> Option<u32> {
    let n = roles.seen.len();
    let mut lengths = vec![Length::Unknown; n];
    let mut longest = 0;
    for mirror in (0..n).filter(|&i| roles.is_mirror[i] && roles.seen[i]) {
        longest = longest.max(chain_from(mirror, lists, roles, &mut lengths)?);
    }
    Some(longest)
}

/// What is known of the chains of mirrors that start at one.
#[derive(Clone, Copy)]
enum Length {
    Unknown,
    /// It is part of the chain at hand.
    OnTheWay,
    Known(u32),
}

/// Returns how many mirrors the longest chain from `mirror` has; `None` when one comes twice.
fn chain_from(mirror: usize, lists: &ListTable, roles: &Roles, lengths: &mut [Length]) -> Option<u32> {
    match lengths[mirror] {
        Length::Known(length) => return Some(length),
        Length::OnTheWay => return None,
        Length::Unknown => {}
    }
    lengths[mirror] = Length::OnTheWay;
    let mut longest = 0;
    for next in lists.objects(mirror).filter(|&next| roles.is_mirror[next]) {
        longest = longest.max(chain_from(next, lists, roles, lengths)?);
    }
    lengths[mirror] = Length::Known(longest + 1);
    Some(longest + 1)
}
