//! Digits of indices, mirrored at the decimal point.
use crate::Real;
use crate::hash::combine;

/// Radical inverse: the digits of `index` in `base`, mirrored at the decimal point; in `[0, 1)`.
///
/// `sum_k d_k base^(-k-1)` for `index = sum_k d_k base^k`. Digits that weigh less than `2^-64` are left out.
///
/// # Panics
/// If `base` is 0; base 1 gives 0.
///
/// ```
/// use qmc_sampling::sequences::radical_inverse;
/// assert_eq!(radical_inverse(2, 6), 0.375); // 110 in base 2, so 0.011
/// assert_eq!(radical_inverse(3, 5), 7.0 / 9.0); // 12 in base 3, so 0.21
/// ```
#[inline]
#[must_use]
pub fn radical_inverse(base: u32, index: u64) -> f64 {
    if base == 2 {
        return crate::float::f64_from_bits(index.reverse_bits());
    }
    if base == 1 {
        return 0.0;
    }
    let base = u64::from(base);
    let limit = u64::MAX / base;
    let (mut rest, mut mirrored, mut scale) = (index, 0, 1);
    while rest > 0 && scale <= limit {
        mirrored = mirrored * base + rest % base;
        scale *= base;
        rest /= base;
    }
    fraction(mirrored, scale)
}

/// How the digits of a radical inverse are randomised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum DigitScramble {
    /// Not at all.
    #[default]
    None,
    /// A random permutation per dimension and position of the digit.
    Permuted(u64),
    /// A random permutation that also depends on all the digits before: Owen scrambling.
    Owen(u64),
}

impl DigitScramble {
    /// The radical inverse with randomised digits; `dimension` tells the random numbers of dimensions apart.
    ///
    /// # Panics
    /// If `base` is 0.
    #[inline]
    #[must_use]
    pub fn radical_inverse(self, base: u32, index: u64, dimension: u32) -> f64 {
        match self {
            Self::None => radical_inverse(base, index),
            Self::Permuted(_) | Self::Owen(_) => self.mirror(base, dimension, 53, digits_of(base, index)),
        }
    }

    /// The fraction with the given digits, from the first one on, randomised, to a precision of so many bits.
    pub(crate) fn mirror(self, base: u32, dimension: u32, bits: u32, mut digit: impl FnMut() -> u32) -> f64 {
        let (mut mirrored, mut scale) = (0, 1_u64);
        let (Self::None | Self::Permuted(_)) = self else {
            return self.mirror_owen(base, dimension, bits, digit);
        };
        let mut key = match self {
            Self::Permuted(seed) => combine(seed, u64::from(dimension)),
            _ => 0,
        };
        while scale < 1 << bits && scale <= u64::MAX / u64::from(base) {
            let d = digit();
            let d = if let Self::Permuted(_) = self { permute(d, base, (key >> 32) as u32) } else { d };
            key = combine(key, 0);
            mirrored = mirrored * u64::from(base) + u64::from(d);
            scale *= u64::from(base);
        }
        fraction(mirrored, scale)
    }

    fn mirror_owen(self, base: u32, dimension: u32, bits: u32, mut digit: impl FnMut() -> u32) -> f64 {
        let Self::Owen(seed) = self else { return 0.0 };
        let mut key = combine(seed, u64::from(dimension));
        let (mut mirrored, mut scale) = (0, 1_u64);
        while scale < 1 << bits && scale <= u64::MAX / u64::from(base) {
            let d = digit();
            mirrored = mirrored * u64::from(base) + u64::from(permute(d, base, (key >> 32) as u32));
            scale *= u64::from(base);
            // The permutation of the next digit depends on all the digits so far.
            key = combine(key, u64::from(d));
        }
        fraction(mirrored, scale)
    }
}

/// The digits of `index`, one by one from the lowest; zeros when there are no more.
#[inline]
fn digits_of(base: u32, index: u64) -> impl FnMut() -> u32 {
    let mut rest = index;
    move || {
        // Small numbers are divided faster.
        if let Ok(short) = u32::try_from(rest) {
            rest = u64::from(short / base);
            return short % base;
        }
        let digit = (rest % u64::from(base)) as u32;
        rest /= u64::from(base);
        digit
    }
}

/// `mirrored / scale`, below one.
#[inline]
fn fraction(mirrored: u64, scale: u64) -> f64 {
    (mirrored as f64 / scale as f64).clamp_unit()
}

/// Element `i` of a random permutation of `0..len`, number `seed` of 2^32: by a hash and cycle walking.
///
/// Source: Kensler, "Correlated multi-jittered sampling" (2013), listing 2.
pub(crate) fn permute(i: u32, len: u32, seed: u32) -> u32 {
    debug_assert!(i < len);
    let mask = (len.max(2) - 1) | 1;
    let mask = u32::MAX >> mask.leading_zeros();
    let mut i = i;
    loop {
        i ^= seed;
        i = i.wrapping_mul(0xe170_893d);
        i ^= seed >> 16;
        i ^= (i & mask) >> 4;
        i ^= seed >> 8;
        i = i.wrapping_mul(0x0929_eb3f);
        i ^= seed >> 23;
        i ^= (i & mask) >> 1;
        i = i.wrapping_mul(1 | (seed >> 27));
        i = i.wrapping_mul(0x6935_fa69);
        i ^= (i & mask) >> 11;
        i = i.wrapping_mul(0x74dc_b303);
        i ^= (i & mask) >> 2;
        i = i.wrapping_mul(0x9e50_1cc3);
        i ^= (i & mask) >> 2;
        i = i.wrapping_mul(0xc860_a3df);
        i &= mask;
        i ^= i >> 5;
        if i < len {
            break;
        }
    }
    ((u64::from(i) + u64::from(seed)) % u64::from(len)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;

    #[test]
    fn permutations_are_permutations() {
        for len in [1, 2, 3, 5, 16, 17, 1000] {
            for seed in [0, 1, 0xdead_beef, u32::MAX] {
                let mut hit = vec![false; len as usize];
                for i in 0..len {
                    hit[permute(i, len, seed) as usize] = true;
                }
                assert!(hit.into_iter().all(|h| h), "{len} {seed:x}");
            }
        }
    }

    #[test]
    fn huge_indices_stay_below_one() {
        for base in [1, 2, 3, 5, 7, 8161, u32::MAX] {
            for index in [u64::MAX, u64::MAX - 1, 1 << 63, 3_u64.pow(40) - 1] {
                for scramble in [DigitScramble::None, DigitScramble::Permuted(1), DigitScramble::Owen(1)] {
                    if base > 1 {
                        assert!((0.0..1.0).contains(&scramble.radical_inverse(base, index, 0)));
                    }
                }
                assert!((0.0..1.0).contains(&radical_inverse(base, index)));
            }
        }
    }

    /// The first `b^k` points occupy the `b^k` intervals once, however the digits are scrambled.
    #[test]
    fn scrambling_keeps_the_intervals() {
        for (base, points) in [(2, 64), (3, 81), (5, 125), (7, 49)] {
            for scramble in [DigitScramble::None, DigitScramble::Permuted(9), DigitScramble::Owen(9)] {
                let mut hit = vec![false; points];
                for i in 0..points {
                    let x = scramble.radical_inverse(base, i as u64, 4);
                    hit[(x * points as f64 + 1e-9) as usize] = true;
                }
                assert!(hit.into_iter().all(|h| h), "base {base} {scramble:?}");
            }
        }
    }
}
