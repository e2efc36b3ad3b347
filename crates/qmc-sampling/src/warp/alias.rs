//! The alias method: discrete distributions in constant time.
use super::TableError;
use super::error::checked_sum;
use crate::Real;
use alloc::vec::Vec;

/// A discrete distribution over `0..n`, sampled in constant time.
///
/// `probability(i) = w_i / sum_j w_j`. Not monotonic: stratification of the number survives only in part, so prefer
/// [`PiecewiseConstant1d`](super::PiecewiseConstant1d) for low-discrepancy points; and it has no inverse.
///
/// In single precision a uniform number has 24 bits, of which `log2 n` go into the choice of a bin: for more than some
/// ten thousand entries take `AliasTable<f64>`.
///
/// `ris::AliasTable` takes weights as they come, not positive ones as zeros, and returns no probabilities: it selects among candidates.
///
/// Source: Walker (1974), built in linear time as by Vose (1991).
///
/// ```
/// use qmc_sampling::warp::AliasTable;
/// # fn main() -> Result<(), qmc_sampling::warp::TableError> {
/// let table = AliasTable::new(&[1.0_f32, 0.0, 3.0])?;
/// let (index, probability, rest) = table.sample(0.7);
/// assert_ne!(index, 1);
/// assert_eq!(probability, table.probability(index));
/// assert!((0.0..1.0).contains(&rest)); // another uniform number
/// # Ok(()) }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct AliasTable<F = f32> {
    bins: Vec<Bin<F>>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Bin<F> {
    /// Below this fraction of the bin its own index is taken, above the alias.
    threshold: F,
    /// Of the index itself.
    probability: F,
    alias: u32,
}

impl<F: Real> AliasTable<F> {
    /// The distribution proportional to `weights`.
    ///
    /// # Errors
    /// No weights or 2^32 and more; a weight that is negative, infinite or NaN; all weights zero.
    pub fn new(weights: &[F]) -> Result<Self, TableError> {
        let sum = checked_sum(weights)?;
        let limit = u32::MAX as usize;
        if weights.len() > limit {
            return Err(TableError::TooMany { len: weights.len(), limit });
        }
        if !(sum > 0.0 && sum.is_finite()) {
            return Err(TableError::InvalidSum(sum));
        }
        let n = weights.len() as f64;
        // Where all goes that has no place: rounding must never lead to a weight of zero.
        let largest =
            weights.iter().enumerate().fold(0, |best, (i, &w)| if w > weights[best] { i } else { best }) as u32;
        let mut scaled: Vec<f64> = weights.iter().map(|w| w.to_f64() / sum * n).collect();
        let mut bins: Vec<Bin<F>> = weights
            .iter()
            .map(|w| Bin { threshold: F::ONE, probability: F::of(w.to_f64() / sum), alias: largest })
            .collect();
        let (mut small, mut large): (Vec<u32>, Vec<u32>) =
            (0..weights.len() as u32).partition(|&i| scaled[i as usize] < 1.0);
        // Fill each small bin up with a part of a large one.
        while let (Some(&giver), Some(taker)) = (large.last(), small.pop()) {
            let (g, t) = (giver as usize, taker as usize);
            bins[t] = Bin { threshold: F::of(scaled[t]), alias: giver, ..bins[t] };
            scaled[g] -= 1.0 - scaled[t];
            if scaled[g] < 1.0 {
                large.pop();
                small.push(giver);
            }
        }
        // What is left is full, but for rounding.
        for i in small {
            if weights[i as usize] == F::ZERO {
                bins[i as usize].threshold = F::ZERO;
            }
        }
        Ok(Self { bins })
    }

    /// The number of entries.
    #[must_use]
    pub fn len(&self) -> usize {
        self.bins.len()
    }

    /// Never: a table has at least one entry.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// An index, its probability, and what is left of `u` as a uniform number in `[0, 1)`. Numbers outside of `[0, 1)` are
    /// clamped, NaN is 0.
    #[inline]
    #[must_use]
    pub fn sample(&self, u: F) -> (usize, F, F) {
        let scaled = u.clamp_unit() * F::of_usize(self.bins.len());
        let own = scaled.to_usize().min(self.bins.len() - 1);
        let within = (scaled - F::of_usize(own)).clamp_unit();
        let bin = self.bins[own];
        if within < bin.threshold {
            (own, bin.probability, (within / bin.threshold).clamp_unit())
        } else {
            let alias = bin.alias as usize;
            let rest = (within - bin.threshold) / (F::ONE - bin.threshold);
            (alias, self.bins[alias].probability, rest.clamp_unit())
        }
    }

    /// The probability of an index.
    ///
    /// # Panics
    /// If there is no such index.
    #[inline]
    #[must_use]
    pub fn probability(&self, index: usize) -> F {
        self.bins[index].probability
    }

    /// The probability of an index, or zero beyond the end: the density with respect to counting.
    #[inline]
    #[must_use]
    pub fn pdf(&self, index: usize) -> F {
        self.bins.get(index).map_or(F::ZERO, |bin| bin.probability)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;

    #[test]
    fn frequencies_are_the_probabilities() {
        for weights in
            [vec![1.0_f64], vec![0.0, 1.0], vec![1.0, 2.0, 3.0, 0.0, 4.0], vec![1e-9, 1.0, 1e-9], vec![0.1; 10]]
        {
            let table = AliasTable::new(&weights).unwrap();
            let sum: f64 = weights.iter().sum();
            let n = 200_000;
            let mut counts = vec![0.0; weights.len()];
            for i in 0..n {
                let (index, probability, rest) = table.sample((f64::from(i) + 0.5) / f64::from(n));
                assert!(weights[index] > 0.0 && (0.0..1.0).contains(&rest));
                assert!((probability - weights[index] / sum).abs() < 1e-12);
                counts[index] += 1.0 / f64::from(n);
            }
            for (count, weight) in counts.iter().zip(&weights) {
                // each of at most n bins may be cut once
                assert!((count - weight / sum).abs() <= weights.len() as f64 / f64::from(n));
            }
        }
    }

    #[test]
    fn ends_of_the_interval() {
        let table = AliasTable::new(&[0.0_f32, 1.0, 0.0]).unwrap();
        for u in [0.0, f32::ONE_MINUS_EPSILON, 1.0, -3.0, f32::NAN] {
            assert_eq!(table.sample(u).0, 1);
        }
        assert_eq!((table.pdf(1), table.pdf(0), table.pdf(9)), (1.0, 0.0, 0.0));
    }

    #[test]
    fn refuses_what_is_no_distribution() {
        assert_eq!(AliasTable::<f32>::new(&[]), Err(TableError::Empty));
        assert_eq!(AliasTable::new(&[0.0_f32]), Err(TableError::InvalidSum(0.0)));
        assert!(matches!(AliasTable::new(&[-1.0_f32]), Err(TableError::InvalidWeight { index: 0, .. })));
    }
}
