//! Which surfaces are the same set of points.
//!
//! Hardly any two surfaces of a scene coincide, and a table of all equations is larger than the scene. So a first pass
//! sieves: it marks a bit for each equation by its hash, and only those equations whose bit was marked twice are looked
//! at. The sieve may let pass too many, never too few.

use std::hash::{Hash, Hasher};

use rayon::prelude::*;
use rustc_hash::{FxBuildHasher, FxHashMap, FxHasher};

use crate::ir::{Cylinder, Program, Sphere};

/// The identity of a surface equation: two surfaces are the same set of points exactly when their ids are equal.
///
/// A sphere is its centre and radius, a cylinder's wall its axis and radius whatever its height, a cap the plane y = const
/// whatever its axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EquationId(u32);

impl EquationId {
    /// Returns the number that dumps show; equal numbers mean equal equations.
    #[must_use]
    pub const fn number(self) -> u32 {
        self.0
    }
}

/// The identity of every surface equation of a program, numbered in the order in which they first appear here.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Equations {
    /// For each sphere.
    pub spheres: Vec<EquationId>,
    /// For each cylinder its wall.
    pub walls: Vec<EquationId>,
    /// For each cylinder its caps: the planes y = y_min and y = y_max.
    pub caps: Vec<[EquationId; 2]>,
}

/// Gives equal surface equations of a program one identity.
pub(super) fn identify_equations(program: &Program) -> Equations {
    let mut n_ids = 0;
    let cylinders = program.cylinders.as_slice();
    Equations {
        spheres: identify(program.spheres.as_slice(), &mut n_ids, sphere_key),
        walls: identify(cylinders, &mut n_ids, wall_key),
        caps: identify_caps(cylinders, &mut n_ids),
    }
}

fn identify_caps(cylinders: &[Cylinder], n_ids: &mut u32) -> Vec<[EquationId; 2]> {
    let heights: Vec<f64> = cylinders.iter().flat_map(|c| [c.y_min, c.y_max]).collect();
    let ids = identify(&heights, n_ids, |&y| EquationKey::new([y]));
    ids.as_chunks().0.to_vec()
}

/// The coefficients of an equation by their bits, with −0 as 0.
#[derive(PartialEq, Eq, Hash)]
struct EquationKey<const N: usize>([u64; N]);

impl<const N: usize> EquationKey<N> {
    fn new(coefficients: [f64; N]) -> Self {
        Self(coefficients.map(|c| (c + 0.0).to_bits()))
    }
}

fn sphere_key(sphere: &Sphere) -> EquationKey<4> {
    EquationKey::new([sphere.center.x, sphere.center.y, sphere.center.z, sphere.radius])
}

fn wall_key(cylinder: &Cylinder) -> EquationKey<3> {
    EquationKey::new([cylinder.x, cylinder.z, cylinder.radius])
}

/// Gives the items of one kind their ids, from `n_ids` on; items of one key get the id of the first of them.
fn identify<T, K>(items: &[T], n_ids: &mut u32, key: impl Fn(&T) -> K + Sync) -> Vec<EquationId>
where
    T: Sync,
    K: Eq + Hash,
{
    let copies = find_copies(items, &key);
    let first_id = *n_ids;
    *n_ids += (items.len() - copies.len()) as u32;
    if copies.is_empty() {
        return number_all(items.len(), first_id);
    }
    let mut ids: Vec<EquationId> = Vec::with_capacity(items.len());
    let mut copies = copies.into_iter().peekable();
    let mut next_id = first_id;
    for i in 0..items.len() as u32 {
        ids.push(match copies.next_if(|copy| copy.item == i) {
            Some(copy) => ids[copy.of as usize],
            None => {
                next_id += 1;
                EquationId(next_id - 1)
            }
        });
    }
    ids
}

/// Numbers `n` items of which no two are the same.
fn number_all(n: usize, first_id: u32) -> Vec<EquationId> {
    let ids = first_id..first_id + n as u32;
    if n < MANY { ids.map(EquationId).collect() } else { ids.into_par_iter().map(EquationId).collect() }
}

/// An item whose key an earlier item has.
struct Copy {
    item: u32,
    /// The first item with its key.
    of: u32,
}

/// Finds the items whose key an earlier one has, in order.
fn find_copies<T: Sync, K: Eq + Hash>(items: &[T], key: &(impl Fn(&T) -> K + Sync)) -> Vec<Copy> {
    let suspects = find_suspects(items, |item| hash(&key(item)));
    let mut first = FxHashMap::with_capacity_and_hasher(suspects.len(), FxBuildHasher);
    let copy_of_earlier = |item: u32| {
        let of = *first.entry(key(&items[item as usize])).or_insert(item);
        (of != item).then_some(Copy { item, of })
    };
    suspects.into_iter().filter_map(copy_of_earlier).collect()
}

fn hash(key: &impl Hash) -> u64 {
    let mut hasher = FxHasher::default();
    key.hash(&mut hasher);
    hasher.finish()
}

/// From so many items on it pays to sieve them, and to do it on all cores.
const MANY: usize = 1 << 12;

/// Returns the items that may have the same key as another, in order: all whose hash marks a bit that another marks.
///
/// The set of bits is larger than any cache. So the items are sorted by parts of it first, and the bits of one part after
/// the other are marked and looked at where they are at hand.
fn find_suspects<T: Sync>(items: &[T], hash: impl Fn(&T) -> u64 + Sync) -> Vec<u32> {
    if items.len() < MANY {
        return (0..items.len() as u32).collect();
    }
    let sieve = Sieve::of(items.len());
    let sorted: Vec<_> = (items.par_chunks(ITEMS_PER_TASK).enumerate())
        .map(|(i, items)| sieve.sort(items.iter().map(&hash), (i * ITEMS_PER_TASK) as u32))
        .collect();
    let parts = (0..sieve.n_parts()).into_par_iter();
    let found =
        parts.map_init(|| sieve.part(), |part, i| part.find_marked_twice(sorted.iter().map(|marks| marks.of(i))));
    let mut suspects = found.collect::<Vec<_>>().concat();
    suspects.par_sort_unstable();
    suspects
}

/// Items that a thread sorts at a time.
const ITEMS_PER_TASK: usize = 1 << 15;

/// A set of bits, cut into parts.
#[derive(Clone, Copy)]
struct Sieve {
    /// The number of bits is 2 to this.
    bits_log: u32,
    /// The number of bits of a part is 2 to this.
    part_log: u32,
}

/// An item that marks a bit of a part.
#[derive(Clone, Copy, Default)]
struct Mark {
    bit_idx: u32,
    item: u32,
}

impl Sieve {
    /// Bits for each item: hardly more than one item in a hundred meets another by chance.
    const BITS_PER_ITEM: usize = 64;

    /// A part takes 256 KiB, a share of the cache of a core.
    const MAX_PART_LOG: u32 = 20;

    fn of(n_items: usize) -> Self {
        let bits_log = (n_items * Self::BITS_PER_ITEM).next_power_of_two().ilog2().min(u32::BITS);
        Self { bits_log, part_log: bits_log.min(Self::MAX_PART_LOG) }
    }

    fn n_parts(self) -> usize {
        1 << (self.bits_log - self.part_log)
    }

    /// Returns a part without marks.
    fn part(self) -> Part {
        Part { words: vec![[0; 2]; (1 << self.part_log) / 64] }
    }

    /// Sorts items, the `first` and those behind it, by the parts in which they mark a bit.
    fn sort(self, hashes: impl Iterator<Item = u64> + Clone, first: u32) -> Marks {
        let part_and_bit = |hash: u64| {
            let bit_idx = hash >> (u64::BITS - self.bits_log);
            ((bit_idx >> self.part_log) as usize, (bit_idx & ((1 << self.part_log) - 1)) as u32)
        };
        let mut ends = vec![0; self.n_parts() + 1];
        hashes.clone().for_each(|hash| ends[part_and_bit(hash).0 + 1] += 1);
        (1..ends.len()).for_each(|i| ends[i] += ends[i - 1]);
        let mut marks = vec![Mark::default(); ends[self.n_parts()] as usize];
        for (hash, item) in hashes.zip(first..) {
            let (part, bit_idx) = part_and_bit(hash);
            marks[ends[part] as usize] = Mark { bit_idx, item };
            ends[part] += 1;
        }
        // Each start has come to the end of its part.
        ends.pop();
        Marks { ends, marks }
    }
}

/// Marks, sorted by the parts that they are in.
struct Marks {
    ends: Vec<u32>,
    marks: Vec<Mark>,
}

impl Marks {
    /// Returns the marks in a part.
    fn of(&self, part: usize) -> &[Mark] {
        let start = part.checked_sub(1).map_or(0, |before| self.ends[before] as usize);
        &self.marks[start..self.ends[part] as usize]
    }
}

/// A part of the set: its bits marked at least once, and those marked at least twice.
struct Part {
    words: Vec<[u64; 2]>,
}

impl Part {
    /// Marks bits, and returns the items whose bit is marked twice.
    fn find_marked_twice<'m>(&mut self, marks: impl Iterator<Item = &'m [Mark]> + Clone) -> Vec<u32> {
        self.words.fill([0; 2]);
        for mark in marks.clone().flatten() {
            let (word_idx, bit) = place(mark.bit_idx);
            let [once, twice] = &mut self.words[word_idx];
            *twice |= *once & bit;
            *once |= bit;
        }
        let is_twice = |mark: &&Mark| {
            let (word_idx, bit) = place(mark.bit_idx);
            self.words[word_idx][1] & bit != 0
        };
        marks.flatten().filter(is_twice).map(|mark| mark.item).collect()
    }
}

/// Returns the word of a bit and the bit in it.
fn place(bit_idx: u32) -> (usize, u64) {
    (bit_idx as usize / 64, 1 << (bit_idx % 64))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ids as one table of all keys gives them.
    fn expected(keys: &[u64]) -> Vec<u32> {
        let mut ids = FxHashMap::default();
        keys.iter()
            .map(|key| {
                let next = ids.len() as u32;
                *ids.entry(*key).or_insert(next)
            })
            .collect()
    }

    #[test]
    fn sieved_ids_are_those_of_one_table() {
        // Few copies and many, of near items and far, on both sides of the sieve, and for several threads.
        for n in [0, 1, 100, MANY - 1, MANY, 9 * MANY + 3] {
            for n_keys in [1, 2, n / 7 + 1, n + 1, 50 * n + 1] {
                let mix = |i: u64| i.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 11;
                let keys: Vec<u64> = (0..n as u64).map(|i| mix(mix(i) % n_keys as u64)).collect();
                let mut n_ids = 10;
                let ids = identify(&keys, &mut n_ids, |&key| key);
                let ids: Vec<u32> = ids.into_iter().map(|id| id.number() - 10).collect();
                assert_eq!(ids, expected(&keys), "{n} items, {n_keys} keys");
                assert_eq!(n_ids - 10, ids.iter().max().map_or(0, |max| max + 1));
            }
        }
    }

    #[test]
    fn zero_has_one_sign() {
        assert!(EquationKey::new([0.0, 1.0]) == EquationKey::new([-0.0, 1.0]));
        assert!(EquationKey::new([0.0, 1.0]) != EquationKey::new([1.0, 0.0]));
    }
}
