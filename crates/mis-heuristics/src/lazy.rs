//! Closures as densities.

use crate::Densities;

/// Densities computed by a closure when they are asked for.
///
/// Nothing is remembered: a heuristic that asks twice computes twice. All heuristics of this crate ask for a density
/// at most once (the cutoff heuristic for the first 32 techniques).
///
/// # Example
/// ```
/// use mis_heuristics::{Heuristic, Lazy, Maximum};
///
/// let cosines = [0.5_f32, 1.0, 0.25];
/// let densities = Lazy::new(cosines.len(), |technique| cosines[technique] / core::f32::consts::PI);
/// assert_eq!(Maximum.weight(1, &densities), 1.0);
/// assert_eq!(Maximum.weight(2, &densities), 0.0);
/// ```
#[derive(Clone, Copy)]
pub struct Lazy<G> {
    len: usize,
    density: G,
}

impl<G> Lazy<G> {
    /// `len` techniques, whose densities `density` computes.
    #[inline]
    pub const fn new(len: usize, density: G) -> Self {
        Self { len, density }
    }
}

impl<G> core::fmt::Debug for Lazy<G> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Lazy").field("len", &self.len).finish_non_exhaustive()
    }
}

impl<F, G: Fn(usize) -> F> Densities<F> for Lazy<G> {
    #[inline]
    fn len(&self) -> usize {
        self.len
    }
    #[inline]
    fn density(&self, technique: usize) -> F {
        (self.density)(technique)
    }
}
