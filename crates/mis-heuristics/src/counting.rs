//! A counter of densities asked for.

use core::cell::Cell;

use crate::Densities;

/// Densities that count how often they are asked for: the cost of a heuristic, exact and repeatable.
///
/// Not `Sync`: one per thread.
///
/// # Example
/// ```
/// use mis_heuristics::{Balance, Counting, Heuristic, Stratification};
/// let densities = Counting::new([0.2, 0.3, 0.5]);
///
/// Balance.weight(0, &densities);
/// assert_eq!(densities.take(), 3);
///
/// let geometry_terms = [7.0, 0.1];
/// let weight = Stratification::new(|k| geometry_terms[k] < 0.3).weight(1, &densities);
/// assert_eq!(weight, 1.0);
/// assert_eq!(densities.take(), 0);
/// ```
#[derive(Clone, Debug)]
pub struct Counting<D> {
    densities: D,
    asked: Cell<u64>,
}

impl<D> Counting<D> {
    /// Counts from zero what `densities` are asked.
    pub const fn new(densities: D) -> Self {
        Self { densities, asked: Cell::new(0) }
    }

    /// How often a density was asked for.
    pub const fn asked(&self) -> u64 {
        self.asked.get()
    }

    /// How often a density was asked for; counts from zero again.
    pub fn take(&self) -> u64 {
        self.asked.take()
    }

    /// The densities without the counter.
    pub fn into_inner(self) -> D {
        self.densities
    }
}

impl<F, D: Densities<F>> Densities<F> for Counting<D> {
    #[inline]
    fn len(&self) -> usize {
        self.densities.len()
    }
    #[inline]
    fn density(&self, technique: usize) -> F {
        self.asked.set(self.asked.get() + 1);
        self.densities.density(technique)
    }
}
