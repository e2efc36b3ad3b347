//! Choosing among weights that are all known: prefix sums and the alias method.

use alloc::vec::Vec;

use crate::Float;
use crate::uniform::BELOW_ONE;

/// A way to choose an index in proportion to weights.
///
/// # Laws
/// `select(u)` with `u` uniform in `[0, 1)` is `i` with probability `w_i / sum_j w_j`, up to the resolution of `u`; an
/// index of weight zero is never returned, whatever `u` is. `None` exactly if all weights are zero.
///
/// Dyn compatible: `&dyn Select<F>`.
pub trait Select<F> {
    /// The index that `u` selects.
    fn select(&self, u: F) -> Option<usize>;
    /// Sum of the weights.
    fn sum(&self) -> F;
}

// Its docs say so.
const _: Option<&dyn Select<f64>> = None;

/// Below zero, and NaN, is zero: the first index that has weight.
fn from_zero(u: f64) -> f64 {
    if u > 0.0 { u } else { 0.0 }
}

/// Prefix sums, searched by bisection.
///
/// Monotonic: larger numbers select larger indices, so stratified numbers select stratified candidates. Building takes
/// `n` additions (in `f64`), selecting `log2 n` comparisons.
///
/// Weights that are not positive and finite count as zero.
///
/// ```
/// use ris::{PrefixSums, Select};
/// let sums = PrefixSums::new([1.0, 0.0, 3.0]);
/// assert_eq!([0.0, 0.2, 0.3, 0.99].map(|u| sums.select(u)), [Some(0), Some(0), Some(2), Some(2)]);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PrefixSums {
    /// Sum of the weights up to and including each.
    sums: Vec<f64>,
}

impl PrefixSums {
    /// Of these weights.
    pub fn new<F: Float>(weights: impl IntoIterator<Item = F>) -> Self {
        let mut sum = 0.0;
        let sums = weights.into_iter().map(|weight| {
            sum += weight.weight_or_zero().to_f64();
            sum.min(f64::MAX)
        });
        Self { sums: sums.collect() }
    }

    /// Number of weights.
    pub fn len(&self) -> usize {
        self.sums.len()
    }

    /// Whether there are no weights.
    pub fn is_empty(&self) -> bool {
        self.sums.is_empty()
    }

    /// Sum of all weights.
    pub fn total(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    /// The share of weight number `index` in the sum.
    ///
    /// # Panics
    /// If there is no such weight.
    pub fn probability(&self, index: usize) -> f64 {
        let below = if index == 0 { 0.0 } else { self.sums[index - 1] };
        let total = self.total();
        if total > 0.0 { (self.sums[index] - below) / total } else { 0.0 }
    }

    /// The index that `u` in `[0, 1)` selects, and where in its share it lies, in `[0, 1)`.
    pub fn select_with_rest(&self, u: f64) -> Option<(usize, f64)> {
        let total = self.total();
        let point = from_zero(u) * total;
        let index = self.sums.partition_point(|&sum| sum <= point);
        // Rounding of u * total may reach the total: the last positive weight is meant.
        let index = if index < self.sums.len() { index } else { self.sums.partition_point(|&sum| sum < total) };
        let above = self.sums.get(index).filter(|_| total > 0.0)?;
        let below = if index == 0 { 0.0 } else { self.sums[index - 1] };
        let rest = (point - below) / (above - below);
        Some((index, if rest > 0.0 { rest.min(BELOW_ONE) } else { 0.0 }))
    }
}

impl<F: Float> Select<F> for PrefixSums {
    #[inline]
    fn select(&self, u: F) -> Option<usize> {
        self.select_with_rest(u.to_f64()).map(|(index, _)| index)
    }

    #[inline]
    fn sum(&self) -> F {
        F::from_f64(self.total()).at_most(F::MAX)
    }
}

/// The alias method: `O(n)` to build, `O(1)` to select.
///
/// Not monotonic: stratification of the number survives only in part. Worth it if many samples are selected from the same
/// candidates. Weights that are not positive and finite count as zero.
///
/// `qmc_sampling::warp::AliasTable` is a distribution: it refuses such weights, and returns probabilities. This one is a [`Select`] for
/// weights as they come, none of them positive included, and neither crate takes the other for it.
///
/// **Source.** Walker 1974; built as by Vose 1991.
///
/// ```
/// use ris::{AliasTable, Select};
/// let table = AliasTable::new([1.0, 0.0, 3.0]);
/// let chosen = (0..400).filter(|k| table.select((*k as f64 + 0.5) / 400.0) == Some(2)).count();
/// assert_eq!(chosen, 300);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AliasTable {
    bins: Vec<Bin>,
    total: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Bin {
    /// Below this part of the bin its own index is taken, above it the alias.
    threshold: f64,
    alias: usize,
}

impl AliasTable {
    /// Of these weights.
    pub fn new<F: Float>(weights: impl IntoIterator<Item = F>) -> Self {
        let mut parts: Vec<f64> = weights.into_iter().map(|weight| weight.weight_or_zero().to_f64()).collect();
        let largest = parts.iter().copied().fold(0.0, f64::max);
        // Scaled by the largest weight first, so that the sum cannot overflow.
        let scaled_sum: f64 = parts.iter().map(|part| part / largest).sum();
        if largest == 0.0 {
            return Self { bins: Vec::new(), total: 0.0 };
        }
        let scale = parts.len() as f64 / scaled_sum;
        parts.iter_mut().for_each(|part| *part = *part / largest * scale);
        // Where rounding leaves a bin without an alias: an index that has weight.
        let heaviest = parts.iter().enumerate().fold(0, |best, (i, &part)| if part > parts[best] { i } else { best });
        let mut bins: Vec<Bin> =
            parts.iter().map(|&part| Bin { threshold: if part > 0.0 { 1.0 } else { 0.0 }, alias: heaviest }).collect();
        let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..parts.len()).partition(|&i| parts[i] < 1.0);
        // Fill each small bin up with a part of a large one.
        while let (Some(&giver), Some(taker)) = (large.last(), small.pop()) {
            bins[taker] = Bin { threshold: parts[taker], alias: giver };
            parts[giver] -= 1.0 - parts[taker];
            if parts[giver] < 1.0 {
                large.pop();
                small.push(giver);
            }
        }
        Self { bins, total: (scaled_sum * largest).min(f64::MAX) }
    }
}

impl<F: Float> Select<F> for AliasTable {
    #[inline]
    fn select(&self, u: F) -> Option<usize> {
        let place = from_zero(u.to_f64()) * self.bins.len() as f64;
        let index = (place as usize).min(self.bins.len().checked_sub(1)?);
        let bin = self.bins[index];
        Some(if place - (index as f64) < bin.threshold { index } else { bin.alias })
    }

    #[inline]
    fn sum(&self) -> F {
        F::from_f64(self.total).at_most(F::MAX)
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec;

    use super::*;

    #[test]
    fn nothing_to_select() {
        for weights in [vec![], vec![0.0], vec![0.0, f64::NAN, -1.0, f64::INFINITY]] {
            assert_eq!(PrefixSums::new(weights.iter().copied()).select(0.5), None, "{weights:?}");
            assert_eq!(AliasTable::new(weights.iter().copied()).select(0.5), None, "{weights:?}");
        }
    }

    #[test]
    fn numbers_at_the_ends_select_positive_weights() {
        let weights = [0.0_f32, 1.0, 0.0, 2.0, 0.0];
        for u in [0.0, f32::EPSILON, 1.0 - f32::EPSILON / 2.0, 1.0, 2.0, -1.0, f32::NAN, f32::INFINITY] {
            for index in [PrefixSums::new(weights).select(u), AliasTable::new(weights).select(u)] {
                assert!(matches!(index, Some(1 | 3)), "{u} {index:?}");
            }
        }
    }

    #[test]
    fn huge_weights() {
        let weights = [f64::MAX, f64::MAX, f64::MAX];
        assert!(Select::<f64>::sum(&PrefixSums::new(weights)).is_finite());
        let table = AliasTable::new(weights);
        assert!(Select::<f64>::sum(&table).is_finite());
        let counts = (0..300).fold([0; 3], |mut counts, k| {
            counts[table.select(f64::from(k) / 300.0).unwrap()] += 1;
            counts
        });
        assert_eq!(counts, [100; 3]);
    }
}
