//! Pairs of cylinders that share a surface.

use rustc_hash::FxHashMap;

use crate::ir::EquationId;
use crate::lint::context::RuleContext;
use crate::plan::{Object, Reason};

/// Pairs of cylinders by their indices, the one declared first before the other, each once.
#[derive(Debug, Default)]
pub(super) struct Pairs(Vec<[usize; 2]>);

impl Pairs {
    /// Adds each cylinder with the last one before it whose surface has the same equation and for which `is_one` holds. So
    /// of many in one place each is paired once.
    pub fn add_equal(&mut self, ids: impl Iterator<Item = EquationId>, is_one: impl Fn(usize, usize) -> bool) {
        /// Of those with the same equation so many are looked at.
        const MAX_EARLIER: usize = 256;
        let mut earlier: FxHashMap<EquationId, Vec<usize>> = FxHashMap::default();
        for (i, id) in ids.enumerate() {
            let others = earlier.entry(id).or_default();
            if let Some(&other) = others.iter().rev().take(MAX_EARLIER).find(|other| is_one(**other, i)) {
                self.0.push([other, i]);
            }
            others.push(i);
        }
    }

    /// Returns the pairs in the order of the later cylinder; of a pair with one cylinder the first is kept.
    pub fn sorted(mut self) -> Vec<[usize; 2]> {
        self.0.sort_by_key(|pair| pair[1]);
        self.0.dedup_by_key(|pair| pair[1]);
        self.0
    }
}

/// Tells whether neither of a pair is hidden or a copy, which is reported by itself.
pub(super) fn is_needed(cx: &RuleContext<'_>, pair: &[usize; 2]) -> bool {
    let Some(sights) = cx.sights() else { return true };
    let is_hidden = |i: usize| {
        let object = Object::Cylinder(i as u32);
        let seen = sights.objects.iter().find(|seen| seen.object == object);
        seen.is_some_and(|seen| matches!(seen.needless, Some(Reason::Copy | Reason::Inside(_))))
    };
    !pair.iter().any(|&i| is_hidden(i))
}
