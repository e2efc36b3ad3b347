//! Padded, hashed Owen-scrambled Sobol points.
use super::groups::{DrawGroup, Groups};
use super::{Sampler, SamplerFamily, Split, seeds};
use crate::float::f32_from_bits;
use crate::hash::{combine, mix64};
use crate::scramble::laine_karras;
use crate::sobol::reversed_4d;

/// Owen-scrambled Sobol points, padded four dimensions at a time.
///
/// `x = scramble(C_d . shuffle(i))`: dimension `4 g + d` of path `i` is coordinate `d` of the first four Sobol dimensions,
/// at an index shuffled and with digits scrambled by hashes of (seed, stream, group `g`).
///
/// - Each group of four dimensions of one stream is a scrambled (t,4)-sequence over the index: use powers of two for the
///   number of paths. Different groups and different streams are independent of each other.
/// - Any single mean is unbiased over the seed; its variance is never much above that of [`Independent`](crate::Independent), and falls as
///   about `n^-3` for smooth integrands of at most four dimensions.
/// - [`next_2d`](Sampler::next_2d) takes an aligned pair of a group, leaving out one dimension where it has to.
/// - Indices of 2^32 and more start a sequence of their own.
///
/// Cost: per four numbers one index hash, eight table lookups of 16 bytes, four digit hashes.
/// Source: Burley, "Practical hash-based Owen scrambling" (JCGT 2020), with the hash of Vegdahl (2021).
///
/// ```
/// use qmc_sampling::{OwenSobol, Sampler, SamplerFamily};
/// let family = OwenSobol::new(0);
/// // 16 points of a pixel: one in each cell of a 4 x 4 grid, and in each column of a 16 x 1 one
/// let mut cells = [0; 16];
/// for index in 0..16 {
///     let [x, y] = family.sampler(123, index).next_2d();
///     cells[(4.0 * x) as usize + 4 * (4.0 * y) as usize] += 1;
/// }
/// assert_eq!(cells, [1; 16]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OwenSobol {
    seed: u64,
}

impl OwenSobol {
    /// The family of a seed: one randomisation.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self { seed }
    }
}

impl SamplerFamily for OwenSobol {
    type Sampler = OwenSobolSampler;

    #[inline]
    fn sampler(&self, stream: u64, index: u64) -> OwenSobolSampler {
        OwenSobolSampler::at(combine(combine(0, self.seed), stream), index)
    }
}

/// The sampler of [`OwenSobol`], 32 bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct OwenSobolSampler(Groups<Point, [f32; 4]>);

/// One point of one pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Point {
    /// Hash of the seed, the stream and the forks, in halves: then there is no padding behind the index.
    pattern: [u32; 2],
    index_reversed: u32,
}

impl Point {
    #[inline]
    const fn new(pattern: u64, index_reversed: u32) -> Self {
        Self { pattern: [pattern as u32, (pattern >> 32) as u32], index_reversed }
    }

    #[inline]
    const fn pattern(&self) -> u64 {
        self.pattern[0] as u64 | ((self.pattern[1] as u64) << 32)
    }

    /// The four numbers of a group. Inlined always: then what does not depend on the index moves out of loops.
    #[inline(always)]
    fn group(&self, group: u32) -> [f32; 4] {
        // Derive five seeds: one for the index, one per dimension.
        let key = mix64(self.pattern().wrapping_add(u64::from(group).wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        let digit_seeds = seeds(key);
        // Shuffle the index, so that groups are not correlated by their common index.
        let index_reversed = laine_karras(self.index_reversed, key as u32);
        // Take the Sobol point and scramble its digits.
        let point = reversed_4d(index_reversed);
        let mut scrambled = [0; 4];
        for ((s, p), seed) in scrambled.iter_mut().zip(point).zip(digit_seeds) {
            *s = laine_karras(p, seed).reverse_bits();
        }
        scrambled.map(f32_from_bits)
    }
}

impl DrawGroup<[f32; 4]> for Point {
    /// Not inlined: its callers are, many times.
    #[inline(never)]
    fn draw(&self, group: u32, numbers: &mut [f32; 4]) {
        *numbers = self.group(group);
    }
}

impl OwenSobolSampler {
    #[inline]
    const fn new(pattern: u64, index_reversed: u32) -> Self {
        Self(Groups::new(Point::new(pattern, index_reversed)))
    }

    /// Point `index` of a pattern; its high bits go into the pattern.
    #[inline]
    const fn at(pattern: u64, index: u64) -> Self {
        let high = index >> 32;
        Self::new(if high == 0 { pattern } else { combine(pattern, high) }, (index as u32).reverse_bits())
    }

    /// The next four numbers, stratified together. Leaves out what remains of a group begun.
    ///
    /// ```
    /// use qmc_sampling::{OwenSobol, SamplerFamily};
    /// let [x, y, u, v] = OwenSobol::new(0).sampler(1, 2).next_4d();
    /// assert!(x < 1.0 && y < 1.0 && u < 1.0 && v < 1.0);
    /// ```
    #[inline]
    pub fn next_4d(&mut self) -> [f32; 4] {
        let group = self.0.skip_group();
        self.0.stream.group(group)
    }
}

impl Sampler for OwenSobolSampler {
    #[inline]
    fn next_1d(&mut self) -> f32 {
        self.0.next_1d()
    }

    #[inline]
    fn next_2d(&mut self) -> [f32; 2] {
        self.0.next_2d()
    }

    #[inline]
    fn fork(&self, domain: u32) -> Self {
        let Point { index_reversed, .. } = self.0.stream;
        Self::new(combine(self.0.stream.pattern(), u64::from(domain)), index_reversed)
    }
}

impl Split for OwenSobolSampler {
    #[inline]
    fn split(&self, domain: u32, children: u32, child: u32) -> Self {
        let point = &self.0.stream;
        let index = u64::from(point.index_reversed.reverse_bits()) * u64::from(children) + u64::from(child);
        Self::at(combine(combine(point.pattern(), u64::from(domain)), u64::from(children)), index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;

    #[test]
    fn is_small() {
        assert!(size_of::<OwenSobolSampler>() <= 32);
    }

    /// All elementary intervals of the first pair of every group: t = 0 whatever the scrambling.
    #[test]
    fn first_pair_of_every_group_is_a_net() {
        for (seed, stream) in [(0, 0), (1, 77), (u64::MAX, 1 << 40)] {
            for m in 0..=10_u32 {
                for group in 0..3 {
                    let points: std::vec::Vec<_> = (0..1_u64 << m)
                        .map(|i| {
                            let mut sampler = OwenSobol::new(seed).sampler(stream, i);
                            for _ in 0..group {
                                sampler.next_4d();
                            }
                            sampler.next_2d()
                        })
                        .collect();
                    for k in 0..=m {
                        let (columns, rows) = (1 << k, 1 << (m - k));
                        let mut hit = vec![false; 1 << m];
                        for [x, y] in &points {
                            hit[(x * columns as f32) as usize + columns * (y * rows as f32) as usize] = true;
                        }
                        assert!(hit.iter().all(|&h| h), "2^{m} points, group {group}, 2^{k} columns");
                    }
                }
            }
        }
    }

    #[test]
    fn every_dimension_is_stratified_in_any_aligned_block() {
        for start in [0_u64, 4096, (1 << 32) - 256, 1 << 32, 1 << 50] {
            let mut hit = vec![[false; 7]; 256];
            for i in start..start + 256 {
                let mut sampler = OwenSobol::new(5).sampler(9, i);
                for dimension in 0..7 {
                    let cell: &mut [bool; 7] = &mut hit[(sampler.next_1d() * 256.0) as usize];
                    cell[dimension] = true;
                }
            }
            assert!(hit.iter().flatten().all(|&h| h), "from {start}");
        }
    }

    #[test]
    fn one_and_two_dimensional_draws_agree_with_four() {
        let sampler = OwenSobol::new(3).sampler(4, 5);
        let [a, b, c, d] = sampler.clone().next_4d();
        let mut mixed = sampler.clone();
        assert_eq!((mixed.next_1d(), mixed.next_1d(), mixed.next_2d()), (a, b, [c, d]));
        let mut skipping = sampler.clone();
        assert_eq!(skipping.next_1d(), a);
        assert_eq!(skipping.next_2d(), [c, d]);
        let mut next = sampler.clone();
        next.next_1d();
        let mut whole = sampler;
        whole.next_4d();
        assert_eq!(next.next_4d(), whole.next_4d());
    }
}
