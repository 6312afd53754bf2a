//! Spending the exact work of an image in the order of its pixels, while threads make them in any order.
//!
//! # Method
//! The work is spent row by row from the top, and in a row from the left, by every pixel that the tracer leaves open. The first
//! one that is too much for what is left, and all behind it, are not settled. What a pixel takes does not depend on others, so
//! which one is the first does not depend on who makes what when.
//!
//! A thread does not know what rows above its own will take, that others are still at. It knows what some have taken, so it
//! makes its pixels as long as they could be paid if the others took nothing, and hands them over as *attempts*. When rows
//! are written, which is done in order, everything above is known: [`Budget::close`] pays the attempts of these rows, and
//! names those that it cannot pay. They are taken back. That happens once an image at most, and what was made in vain is less
//! than the limit for each thread.

use std::ops::Range;

use crate::exact::Pixel;
use crate::exec::limit::Limit;
use crate::trace::Place;

/// A pixel that was made, or that more than a pixel may take was spent on.
#[derive(Debug)]
pub(super) struct Attempt {
    pub place: Place,
    /// What it takes from the budget.
    pub charge: u64,
    pub pixel: Option<Pixel>,
}

/// What is made of some rows, and not paid yet.
#[derive(Debug)]
struct Pending {
    first_row: u32,
    charge: u64,
    /// In order.
    attempts: Vec<Attempt>,
}

/// The exact work of one image.
#[derive(Debug)]
pub(super) struct Budget {
    limit: Limit,
    /// What is spent in the rows that are closed.
    spent: u64,
    /// Rows that are not closed, in no order.
    pending: Vec<Pending>,
}

/// What becomes of the attempts of some rows.
#[derive(Debug, Default)]
pub(super) struct Closed {
    /// Those that are paid.
    pub paid: Vec<(Place, Pixel)>,
    /// The places of pixels that were made and cannot be paid.
    pub taken_back: Vec<Place>,
}

impl Budget {
    /// Begins an image.
    pub fn new(limit: Limit) -> Self {
        Self { limit, spent: 0, pending: Vec::new() }
    }

    /// Returns the most that can be left for rows from `first_row` on, by what is known now.
    pub fn most_left(&self, first_row: u32) -> u64 {
        let above = self.pending.iter().filter(|pending| pending.first_row < first_row);
        above.fold(self.limit.max.saturating_sub(self.spent), |left, pending| left.saturating_sub(pending.charge))
    }

    /// Takes the attempts of some rows, which no others have a share in.
    pub fn hand_over(&mut self, rows: &Range<u32>, attempts: Vec<Attempt>) {
        if !attempts.is_empty() {
            let charge = attempts.iter().fold(0, |sum: u64, attempt| sum.saturating_add(attempt.charge));
            self.pending.push(Pending { first_row: rows.start, charge, attempts });
        }
    }

    /// Tells whether there are attempts in some rows.
    pub fn has_pending(&self, rows: &Range<u32>) -> bool {
        self.pending.iter().any(|pending| rows.contains(&pending.first_row))
    }

    /// Pays the attempts of some rows, above which all are closed.
    pub fn close(&mut self, rows: &Range<u32>) -> Closed {
        let mut those: Vec<_> = self.pending.extract_if(.., |pending| rows.contains(&pending.first_row)).collect();
        those.sort_unstable_by_key(|pending| pending.first_row);
        let mut closed = Closed::default();
        for attempt in those.into_iter().flat_map(|pending| pending.attempts) {
            self.spent = self.spent.saturating_add(attempt.charge);
            match attempt.pixel {
                Some(pixel) if self.spent <= self.limit.max => closed.paid.push((attempt.place, pixel)),
                Some(_) => closed.taken_back.push(attempt.place),
                None => {}
            }
        }
        closed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::Ties;

    fn attempt(row: u32, column: u32, charge: u64, is_made: bool) -> Attempt {
        let pixel = Pixel {
            rgb: [0; 3],
            channels: [0.0; 3],
            error: 0.0,
            slack: 0.0,
            proved_ties: Ties::default(),
            algebraic_ties: Ties::default(),
            open_ties: Ties::default(),
            bits: 96,
            work: charge,
        };
        Attempt { place: Place { row, column }, charge, pixel: is_made.then_some(pixel) }
    }

    /// The places that are paid, and those that are taken back, when rows are handed over in an order.
    fn spent(order: &[u32]) -> [Vec<(u32, u32)>; 2] {
        let mut budget = Budget::new(Limit::of(100));
        for &row in order {
            let attempts = match row {
                0 => vec![attempt(0, 3, 20, true), attempt(0, 7, 25, false)],
                1 => vec![attempt(1, 0, 30, true)],
                2 => vec![attempt(2, 5, 25, true), attempt(2, 6, 1, true)],
                _ => vec![attempt(row, 1, 1, true)],
            };
            budget.hand_over(&(row..row + 1), attempts);
        }
        let mut all = [Vec::new(), Vec::new()];
        for rows in [0..1, 1..3, 3..4] {
            let closed = budget.close(&rows);
            all[0].extend(closed.paid.iter().map(|(place, _)| (place.row, place.column)));
            all[1].extend(closed.taken_back.iter().map(|place| (place.row, place.column)));
        }
        all
    }

    #[test]
    fn what_is_paid_does_not_depend_on_who_is_first() {
        let paid = vec![(0, 3), (1, 0), (2, 5)];
        for order in [[0, 1, 2, 3], [3, 2, 1, 0], [2, 0, 3, 1]] {
            assert_eq!(spent(&order), [paid.clone(), vec![(2, 6), (3, 1)]], "{order:?}");
        }
    }

    #[test]
    fn what_is_left_is_less_than_what_is_known_to_be_spent_above() {
        let mut budget = Budget::new(Limit::of(100));
        assert_eq!(budget.most_left(0), 100);
        budget.hand_over(&(4..8), vec![attempt(5, 0, 30, true)]);
        assert_eq!([0, 4, 8].map(|row| budget.most_left(row)), [100, 100, 70]);
        assert!(budget.has_pending(&(0..8)) && !budget.has_pending(&(0..4)));
        budget.close(&(0..8));
        assert_eq!([0, 8].map(|row| budget.most_left(row)), [70, 70]);
        budget.hand_over(&(8..9), vec![attempt(8, 0, u64::MAX, false), attempt(8, 1, 5, false)]);
        assert_eq!(budget.most_left(9), 0);
    }
}
