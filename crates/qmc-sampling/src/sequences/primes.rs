//! The bases of the Halton sequence.

/// The number of primes at hand.
pub const PRIMES: u32 = 1024;

/// The first primes, by trial division.
pub(super) static TABLE: [u16; PRIMES as usize] = {
    let mut table = [2; PRIMES as usize];
    let (mut count, mut candidate) = (1, 3_u16);
    while count < table.len() {
        let mut k = 0;
        while table[k] * table[k] <= candidate && !candidate.is_multiple_of(table[k]) {
            k += 1;
        }
        if table[k] * table[k] > candidate {
            table[count] = candidate;
            count += 1;
        }
        candidate += 2;
    }
    table
};

/// Prime number `i`, counted from `prime(0) = 2`.
///
/// # Panics
/// If `i` is 1024 or more.
///
/// ```
/// assert_eq!(qmc_sampling::sequences::prime(1023), 8161);
/// ```
#[inline]
#[must_use]
pub fn prime(i: u32) -> u32 {
    u32::from(TABLE[i as usize])
}

/// The first prime that is at least `n`, if it is at hand.
pub(crate) fn prime_from(n: u32) -> Option<u32> {
    TABLE.iter().map(|&p| u32::from(p)).find(|&p| p >= n)
}
