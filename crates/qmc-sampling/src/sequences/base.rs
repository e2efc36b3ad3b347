//! Mirroring digits in a prime base, fast.
use super::PRIMES;
use super::primes::TABLE;
use crate::hash::mix64;

/// A prime base, with what dividing by it and mirroring in it needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Base {
    /// `floor(2^64 / prime)`
    reciprocal: u64,
    /// `prime^-digits`
    scale: f64,
    prime: u32,
    /// How many digits single precision can tell apart.
    digits: u32,
}

static BASES: [Base; PRIMES as usize] = {
    let mut bases = [Base { reciprocal: 0, scale: 0.0, prime: 0, digits: 0 }; PRIMES as usize];
    let mut i = 0;
    while i < bases.len() {
        let prime = TABLE[i] as u64;
        let (mut digits, mut power) = (0, 1);
        while power < 1 << 24 {
            power *= prime;
            digits += 1;
        }
        // For two, whose power 2^64 is, this is one less, which `divide` makes up for.
        bases[i] = Base { reciprocal: u64::MAX / prime, scale: 1.0 / power as f64, prime: prime as u32, digits };
        i += 1;
    }
    bases
};

impl Base {
    /// Prime number `dimension`, counted from zero.
    ///
    /// # Panics
    /// If `dimension` is 1024 or more.
    #[inline]
    pub(crate) fn of(dimension: u32) -> &'static Self {
        &BASES[dimension as usize]
    }

    /// Quotient and remainder.
    #[inline]
    fn divide(&self, n: u64) -> (u64, u64) {
        // With the reciprocal rounded down the quotient is right or one too small.
        let quotient = ((u128::from(n) * u128::from(self.reciprocal)) >> 64) as u64;
        let remainder = n - quotient * u64::from(self.prime);
        let short = remainder >= u64::from(self.prime);
        (quotient + u64::from(short), if short { remainder - u64::from(self.prime) } else { remainder })
    }

    /// The radical inverse of `index` with digits scrambled by nested affine permutations, in single precision.
    ///
    /// ```text
    /// y_k = a d_k + c mod b,   a in 1 .. b - 1 and c in 0 .. b - 1 hashed from key and d_1 .. d_(k-1)
    /// ```
    /// for the digits `d_1, d_2, ..` of the index from the lowest one. Two different digits go to two different ones, each
    /// such pair with the same probability, as under all permutations: so means and variances are those of Owen's nested
    /// uniform scrambling, for a fraction of its cost. Below `2^-24` the digits are random, one fraction for all of them.
    ///
    /// Source: Matoušek, "On the L2-discrepancy for anchored boxes" (1998), random linear scrambling, here nested.
    #[inline]
    pub(crate) fn scrambled_inverse(&self, index: u64, key: u64) -> f32 {
        let prime = u64::from(self.prime);
        // The digits so far, with a one before them that makes their number count.
        let (mut rest, mut path, mut mirrored) = (index, 1, 0);
        for _ in 0..self.digits {
            let (quotient, digit) = self.divide(rest);
            let hash = mix64(path ^ key);
            let factor = 1 + (((hash >> 32) * (prime - 1)) >> 32);
            let shift = ((hash & 0xffff_ffff) * prime) >> 32;
            mirrored = mirrored * prime + self.divide(factor * digit + shift).1;
            path = path * prime + digit;
            rest = quotient;
        }
        single(mirrored, mix64(path ^ key), self.scale)
    }
}

/// `(mirrored + fraction) * scale` rounded down to a multiple of `2^-24`, where the fraction has random digits.
#[inline]
fn single(mirrored: u64, random: u64, scale: f64) -> f32 {
    let fraction = (random >> 40) as f64 / 16_777_216.0;
    let steps = (mirrored as f64 + fraction) * scale * 16_777_216.0;
    // The product may have been rounded up to one.
    (steps as u32).min(0xff_ffff) as f32 / 16_777_216.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequences::prime;
    use std::vec;

    /// The same in the plainest way: integer division, and the digits kept.
    fn plain(dimension: u32, index: u64, key: u64) -> f32 {
        let prime = u64::from(prime(dimension));
        let (mut power, mut digits) = (1, vec![]);
        let mut rest = index;
        while power < 1 << 24 {
            digits.push(rest % prime);
            rest /= prime;
            power *= prime;
        }
        let hash = |k: usize| mix64(digits[..k].iter().fold(1, |path, digit| path * prime + digit) ^ key);
        let mirrored = digits.iter().enumerate().fold(0, |mirrored, (k, digit)| {
            let (a, c) = (1 + (((hash(k) >> 32) * (prime - 1)) >> 32), ((hash(k) % (1 << 32)) * prime) >> 32);
            mirrored * prime + (a * digit + c) % prime
        });
        single(mirrored, hash(digits.len()), 1.0 / power as f64)
    }

    #[test]
    fn fast_is_plain() {
        for dimension in (0..40).chain([100, 500, 1023]) {
            for i in 0..200_u64 {
                let index = i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (i % 64);
                let key = mix64(i ^ 77);
                let (fast, plain) = (Base::of(dimension).scrambled_inverse(index, key), plain(dimension, index, key));
                assert_eq!(fast, plain, "dimension {dimension}, index {index}");
                assert!((0.0..1.0).contains(&fast));
            }
        }
    }

    #[test]
    fn divides_any_number() {
        for dimension in 0..PRIMES {
            let prime = u64::from(prime(dimension));
            for n in [0, 1, prime - 1, prime, prime + 1, u64::MAX, u64::MAX - 1, u64::MAX / prime * prime, 1 << 63] {
                assert_eq!(Base::of(dimension).divide(n), (n / prime, n % prime), "{n} / {prime}");
            }
        }
    }

    /// The points of each aligned block of `b^k` indices occupy the `b^k` intervals once.
    #[test]
    fn scrambling_keeps_the_intervals() {
        for (dimension, points) in [(0, 64), (1, 81), (2, 125), (3, 343), (10, 31 * 31)] {
            for start in [0, 7 * points, (1 << 40) / points * points] {
                let mut hit = vec![false; points as usize];
                for i in start..start + points {
                    // In the middle of its step of 2^-24, clear of the ends of intervals.
                    let x = f64::from(Base::of(dimension).scrambled_inverse(i, 99)) + 0.5_f64.powi(25);
                    hit[(x * points as f64) as usize] = true;
                }
                assert!(hit.into_iter().all(|h| h), "dimension {dimension} from {start}");
            }
        }
    }

    /// Any two different digits go to any two different ones equally often: the pairs of digits 1 and 2 in base 5.
    #[test]
    fn pairs_of_digits_go_everywhere() {
        let mut counts = [[0_u32; 5]; 5];
        let trials = 20_000;
        for key in 0..trials {
            let [a, b] = [1, 2].map(|i| (Base::of(2).scrambled_inverse(i, mix64(key)) * 5.0) as usize);
            counts[a][b] += 1;
        }
        for (a, row) in counts.iter().enumerate() {
            for (b, &count) in row.iter().enumerate() {
                let expected = if a == b { 0.0 } else { trials as f64 / 20.0 };
                // six standard deviations
                assert!((f64::from(count) - expected).abs() <= 6.0 * expected.sqrt(), "{a} {b}: {count}");
            }
        }
    }
}
