//! Photons while they are collected.

use crate::{Flux, PackedPhoton, Photon};

/// Photons while they are collected, with the number of paths that they come from.
///
/// **Memory.** 32 bytes per photon with RGB flux (24 with one `f32`), 32 MB per million; while the vector grows up to
/// twice that, unless [`with_capacity`](Self::with_capacity) is told how many.
///
/// Photons that are no photons (see [`PackedPhoton::pack`]) are not stored but counted: [`refused`](Self::refused).
///
/// # Example
/// Each thread collects its own; put together in the order of the paths, the result does not depend on the threads.
/// ```
/// use photon_map::{Photon, Photons};
/// let mut all = Photons::new();
/// for task in 0..4 {
///     let mut photons = Photons::new();
///     photons.store(Photon::new([task as f32, 0.0, 0.0], [0.0, 0.0, 1.0], 1.0_f32));
///     photons.add_paths(100);
///     all.append(photons);
/// }
/// assert_eq!((all.len(), all.paths()), (4, 400));
/// ```
#[derive(Clone, Debug)]
pub struct Photons<F> {
    photons: Vec<PackedPhoton<F>>,
    paths: u64,
    refused: u64,
}

impl<F: Flux> Photons<F> {
    /// None yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { photons: Vec::new(), paths: 0, refused: 0 }
    }

    /// None yet, with memory for some.
    #[must_use]
    pub fn with_capacity(photons: usize) -> Self {
        Self { photons: Vec::with_capacity(photons), paths: 0, refused: 0 }
    }

    /// Stores a photon, if it is one.
    #[inline]
    pub fn store(&mut self, photon: Photon<F>) {
        match PackedPhoton::pack(&photon) {
            Some(packed) => self.photons.push(packed),
            None => self.refused += 1,
        }
    }

    /// Counts paths, whether they stored photons or not: flux is divided by their number in the end.
    pub fn add_paths(&mut self, paths: u64) {
        self.paths += paths;
    }

    /// Appends photons and paths of another collection.
    pub fn append(&mut self, mut other: Self) {
        self.photons.append(&mut other.photons);
        self.paths += other.paths;
        self.refused += other.refused;
    }

    /// How many photons are stored.
    #[must_use]
    pub fn len(&self) -> usize {
        self.photons.len()
    }

    /// Whether none is.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.photons.is_empty()
    }

    /// The number of paths.
    #[must_use]
    pub const fn paths(&self) -> u64 {
        self.paths
    }

    /// How many photons were not stored because something about them is not finite, or their light out of range.
    #[must_use]
    pub const fn refused(&self) -> u64 {
        self.refused
    }

    /// What is stored.
    #[must_use]
    pub fn as_slice(&self) -> &[PackedPhoton<F>] {
        &self.photons
    }

    pub(crate) const fn from_parts(photons: Vec<PackedPhoton<F>>, paths: u64, refused: u64) -> Self {
        Self { photons, paths, refused }
    }

    pub(crate) fn into_vec(self) -> Vec<PackedPhoton<F>> {
        self.photons
    }

    /// Gives back memory that waits for more photons.
    pub fn shrink(&mut self) {
        self.photons.shrink_to_fit();
    }

    /// The flux of all photons together, per path; zero if there are no paths.
    ///
    /// Summed up in halves of halves, so that round-off grows with the logarithm of their number.
    #[must_use]
    pub fn total_flux(&self) -> F {
        if self.paths == 0 { F::ZERO } else { sum(&self.photons).scale(1.0 / self.paths as f64) }
    }
}

fn sum<F: Flux>(photons: &[PackedPhoton<F>]) -> F {
    if photons.len() <= 64 {
        return photons.iter().fold(F::ZERO, |sum, photon| sum.add(photon.flux()));
    }
    let (a, b) = photons.split_at(photons.len() / 2);
    sum(a).add(sum(b))
}

impl<F: Flux> Default for Photons<F> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refused_photons_are_counted() {
        let mut photons = Photons::new();
        photons.store(Photon::new([f32::NAN; 3], [0.0, 0.0, 1.0], 1.0));
        photons.store(Photon::new([0.0; 3], [0.0, 0.0, 1.0], 2.0));
        photons.add_paths(4);
        let mut all = Photons::with_capacity(2);
        all.append(photons.clone());
        all.append(photons);
        all.shrink();
        assert_eq!((all.len(), all.refused(), all.paths()), (2, 2, 8));
        assert!(!all.is_empty());
        assert_eq!(all.total_flux(), 0.5);
        assert_eq!(Photons::<f32>::default().total_flux(), 0.0);
    }

    #[test]
    fn total_flux_loses_no_photon_to_round_off() {
        let mut photons = Photons::new();
        photons.store(Photon::new([0.0; 3], [0.0, 0.0, 1.0], 1e8_f32));
        (0..1_000_000).for_each(|_| photons.store(Photon::new([0.0; 3], [0.0, 0.0, 1.0], 1.0_f32)));
        photons.add_paths(1);
        // One after the other, none of the small ones would count: at 1e8 numbers are 8 apart.
        assert!((f64::from(photons.total_flux()) / 1.01e8 - 1.0).abs() < 1e-6, "{}", photons.total_flux());
    }
}
