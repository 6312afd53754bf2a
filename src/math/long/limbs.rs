//! Digits: whole-number arithmetic on limbs of 64 bits, the most significant first.
//!
//! A slice `d` stands for the fraction Σ dᵢ·2^(−64(i + 1)), below 1.

/// Multiplies two fractions that begin with a 1 into as many limbs as `product` has, and tells whether anything was
/// left out: at most 2·n + 1 units in the last of its n places, always from above.
///
/// Products of two limbs whose upper half lies beyond the last place are not made, and the lower halves that lie there are
/// dropped. Of the first there are at most n in the place next to the last, each below a unit, and of the others together
/// less than one more; of the second at most n.
#[inline]
pub(super) fn multiply(a: &[u64], b: &[u64], product: &mut [u64]) -> bool {
    let n = product.len();
    product.fill(0);
    for (i, &a) in a.iter().enumerate().take(n).rev() {
        let room = n - i;
        let mut carry = 0;
        let within = if b.len() < room {
            b
        } else {
            // The lower half of this one lies beyond.
            carry = ((u128::from(a) * u128::from(b[room - 1])) >> 64) as u64;
            &b[..room - 1]
        };
        let target = &mut product[i + 1..=i + within.len()];
        for (place, &b) in target.iter_mut().zip(within).rev() {
            let sum = u128::from(a) * u128::from(b) + u128::from(*place) + u128::from(carry);
            *place = sum as u64;
            carry = (sum >> 64) as u64;
        }
        product[i] = carry;
    }
    a.len() + b.len() > n
}

/// Returns limb `i` of a fraction that is moved down by `limbs` limbs and `bits` bits, below 64.
#[inline]
fn moved(digits: &[u64], limbs: usize, bits: u32, i: usize) -> u64 {
    let at = |place: usize| digits.get(place).copied().unwrap_or(0);
    match i.checked_sub(limbs) {
        None => 0,
        Some(place) if bits == 0 => at(place),
        Some(0) => at(0) >> bits,
        Some(place) => at(place) >> bits | at(place - 1) << (64 - bits),
    }
}

/// Tells whether moving a fraction down by so much leaves something beyond `n` limbs.
#[inline]
pub(super) fn is_cut(digits: &[u64], limbs: usize, bits: u32, n: usize) -> bool {
    limbs + digits.len() + usize::from(bits > 0) > n
}

/// Adds a fraction, moved down, to `sum`, and tells whether 1 is carried out.
#[inline]
pub(super) fn add(sum: &mut [u64], digits: &[u64], limbs: usize, bits: u32) -> bool {
    let mut carry = false;
    let last = sum.len().min(limbs + digits.len() + 1);
    for i in (0..last).rev() {
        if i < limbs && !carry {
            break;
        }
        let (partial, first) = sum[i].overflowing_add(moved(digits, limbs, bits, i));
        let (whole, second) = partial.overflowing_add(u64::from(carry));
        sum[i] = whole;
        carry = first | second;
    }
    carry
}

/// Takes a fraction, moved down, from `rest`, and tells whether that is below 0: then 1 is added.
#[inline]
pub(super) fn subtract(rest: &mut [u64], digits: &[u64], limbs: usize, bits: u32) -> bool {
    let mut borrow = false;
    let last = rest.len().min(limbs + digits.len() + 1);
    for i in (0..last).rev() {
        if i < limbs && !borrow {
            break;
        }
        let (partial, first) = rest[i].overflowing_sub(moved(digits, limbs, bits, i));
        let (whole, second) = partial.overflowing_sub(u64::from(borrow));
        rest[i] = whole;
        borrow = first | second;
    }
    borrow
}

/// Takes a fraction from 1.
pub(super) fn complement(digits: &mut [u64]) {
    let mut carry = true;
    for limb in digits.iter_mut().rev() {
        let (sum, overflow) = (!*limb).overflowing_add(u64::from(carry));
        *limb = sum;
        carry = overflow;
    }
}

/// Moves digits up so that the first bit is 1; returns by how many bits, or `None` if all are 0.
#[inline]
pub(super) fn normalize(digits: &mut [u64]) -> Option<u32> {
    let n_zero_limbs = digits.iter().position(|limb| *limb != 0)?;
    let bits = digits[n_zero_limbs].leading_zeros();
    let n = digits.len();
    if bits == 0 {
        if n_zero_limbs > 0 {
            digits.copy_within(n_zero_limbs.., 0);
        }
    } else {
        for i in n_zero_limbs..n {
            let next = if i + 1 < n { digits[i + 1] >> (64 - bits) } else { 0 };
            digits[i - n_zero_limbs] = digits[i] << bits | next;
        }
    }
    digits[n - n_zero_limbs..].fill(0);
    Some(n_zero_limbs as u32 * 64 + bits)
}

/// Moves digits up by one bit.
#[inline]
pub(super) fn shift_up(digits: &mut [u64]) {
    let mut carried = 0;
    for limb in digits.iter_mut().rev() {
        let first = *limb >> 63;
        *limb = *limb << 1 | carried;
        carried = first;
    }
}

/// Moves digits down by one bit and puts a 1 on top; tells whether a 1 is lost.
#[inline]
pub(super) fn carry_in(digits: &mut [u64]) -> bool {
    let mut carried = 1;
    for limb in digits.iter_mut() {
        let last = *limb & 1;
        *limb = *limb >> 1 | carried << 63;
        carried = last;
    }
    carried == 1
}

/// Divides half of the fraction `a` by the fraction `b`, which both begin with a 1: long division. Gives as many limbs as
/// `quotient` has, rounded down, and tells whether that is exact.
///
/// `rest`: as long as `b`.
///
/// Half of a is below b, so that each digit fits in its limb. A digit is guessed from the first limb of b, which is at most 2
/// too much (Knuth, section 4.3.1).
#[inline]
pub(super) fn divide_half(a: &[u64], b: &[u64], quotient: &mut [u64], rest: &mut [u64]) -> bool {
    let half = |i: usize| moved(a, 0, 1, i);
    let m = b.len();
    for (i, limb) in rest.iter_mut().enumerate() {
        *limb = half(i);
    }
    let first = u128::from(b[0]);
    for (k, digit) in quotient.iter_mut().enumerate() {
        let mut top = rest[0];
        rest.copy_within(1.., 0);
        rest[m - 1] = half(m + k);
        let mut guess =
            if top >= b[0] { u64::MAX } else { ((u128::from(top) << 64 | u128::from(rest[0])) / first) as u64 };
        let mut carry = 0;
        for (limb, &b) in rest.iter_mut().zip(b).rev() {
            let taken = u128::from(guess) * u128::from(b) + u128::from(carry);
            let (left, borrow) = limb.overflowing_sub(taken as u64);
            *limb = left;
            carry = (taken >> 64) as u64 + u64::from(borrow);
        }
        let mut is_negative = top < carry;
        top = top.wrapping_sub(carry);
        while is_negative {
            guess -= 1;
            let carried = u64::from(add(rest, b, 0, 0));
            let (sum, overflow) = top.overflowing_add(carried);
            top = sum;
            is_negative = !overflow;
        }
        *digit = guess;
    }
    rest.iter().all(|limb| *limb == 0) && a.len() < m + quotient.len()
}
