//! The detailed caustic map and the coarse global map.

use crate::{Deposition, DepositionExt, Flux, Photon, Photons};

/// How photons are shared out between a detailed caustic map and a coarse global map.
///
/// ```text
/// sum_k delta_k flux_k  ~  sum over caustic k of  delta_k flux_k / p_k       [stored with probability p_k]
///                        + sum over other k of    delta_k flux_k / (q p_k)   [stored with probability q p_k]
/// ```
///
/// **Symbols.** `q` in `(0, 1]`: the ratio; `1 / q` times as many paths are traced as the global map needs alone.
/// `p_k`: the probability of [`Deposition`]. `N`: number of paths.
///
/// | variant | a photon that is not caustic | asks for `p` | global map is divided by |
/// |---|---|---|---|
/// | [`one_number`] | stored if `u_1 < q p`, flux over `q p` | if `u_1 < q` | `N` |
/// | [`two_numbers`] | stored if `u_1 < q` and `u_2 < p`, flux over `q p` | if `u_1 < q` | `N` |
/// | [`trajectories`] | in the first `floor(q N)` paths stored if `u_2 < p`, flux over `p` | there | `floor(q N)` |
///
/// [`one_number`]: Self::one_number
/// [`two_numbers`]: Self::two_numbers
/// [`trajectories`]: Self::trajectories
///
/// All three are one piece of code: a gate that does not need `p`, then the deposition. For the first one `u_1 / q`
/// is the second number: given `u_1 < q` it is uniform, and `u_1 / q < p` is what Keller and Wald 2000 writes. So it does not ask for
/// `p` in vain either.
///
/// Keller and Wald 2000 prints the two-number variant with `p` in both tests; the first is against `q`. In the trajectory variant there
/// is no further `1 / q`: the global map has seen `floor(q N)` paths, and is divided by that, exactly, whatever was
/// rounded.
///
/// **Unbiased**, all three, with equal expectations. With `X` the sum of a path's photons `x_i` in some estimate, the
/// variance of the global map is `(Var X + (1/q - 1) sum E x_i^2) / N` if photons are thinned and `Var X / (q N)` if
/// paths are: paths are better where a path leaves one photon (`E x^2 > Var x`), photons where a path leaves many
/// that are alike. Paths leave nothing to chance, though, and of a low-discrepancy sequence the global map gets a
/// contiguous part.
///
/// **Cost.** A comparison; the third variant traces nothing for the global map beyond `floor(q N)` paths, and a
/// renderer may end those paths as soon as they cannot become caustic.
///
/// **Source.** Keller and Wald 2000, sections 2.2 and 2.3.
///
/// # Example
/// ```
/// use photon_map::{KeepAll, MapPartition, Photon, PhotonMaps};
/// let partition = MapPartition::trajectories(0.25, 1000)?;
/// let mut maps = PhotonMaps::new();
/// for path in 0..1000 {
///     let photon = Photon::new([0.0; 3], [0.0, 0.0, 1.0], 1.0_f32); // of this path
///     if let Some(photon) = partition.decide(photon, path, &KeepAll, [0.5, 0.5]) {
///         maps.store(photon);
///     }
/// }
/// maps.add_paths(&partition, 1000);
/// assert_eq!(maps.global.len(), 250);
/// assert_eq!(maps.global.total_flux(), 1.0);
/// # Ok::<(), photon_map::PartitionError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Named", into = "Named"))]
pub struct MapPartition {
    ratio: f64,
    variant: Variant,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Variant {
    OneNumber,
    TwoNumbers,
    Trajectories {
        /// Of all photons.
        paths: u64,
        /// Whose photons go to the global map.
        global: u64,
    },
}

/// Why there is no such partition.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PartitionError {
    /// A ratio that is not in `(0, 1]`, or below the resolution `2^-53` of random numbers.
    #[error("the ratio of global to caustic photons lies in [2^-53, 1], not at {0}")]
    Ratio(f64),
    /// No path is left for the global map.
    #[error("the fraction {ratio} of {paths} paths is less than one path for the global map")]
    NoPath {
        /// The ratio.
        ratio: f64,
        /// The number of paths.
        paths: u64,
    },
}

/// As it is in a file: the name of the constructor, and what it takes.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum Named {
    OneNumber(f64),
    TwoNumbers(f64),
    Trajectories { ratio: f64, paths: u64 },
}

#[cfg(feature = "serde")]
impl TryFrom<Named> for MapPartition {
    type Error = PartitionError;

    fn try_from(named: Named) -> Result<Self, PartitionError> {
        match named {
            Named::OneNumber(ratio) => Self::one_number(ratio),
            Named::TwoNumbers(ratio) => Self::two_numbers(ratio),
            Named::Trajectories { ratio, paths } => Self::trajectories(ratio, paths),
        }
    }
}

#[cfg(feature = "serde")]
impl From<MapPartition> for Named {
    fn from(MapPartition { ratio, variant }: MapPartition) -> Self {
        match variant {
            Variant::OneNumber => Self::OneNumber(ratio),
            Variant::TwoNumbers => Self::TwoNumbers(ratio),
            Variant::Trajectories { paths, .. } => Self::Trajectories { ratio, paths },
        }
    }
}

impl MapPartition {
    fn new(ratio: f64, variant: Variant) -> Result<Self, PartitionError> {
        let valid = (f64::EPSILON / 2.0..=1.0).contains(&ratio);
        if valid { Ok(Self { ratio, variant }) } else { Err(PartitionError::Ratio(ratio)) }
    }

    /// One random number decides against `q p`.
    ///
    /// # Errors
    /// [`PartitionError::Ratio`] if the ratio is out of range or NaN.
    pub fn one_number(ratio: f64) -> Result<Self, PartitionError> {
        Self::new(ratio, Variant::OneNumber)
    }

    /// One random number decides against `q`, a second one against `p`.
    ///
    /// # Errors
    /// [`PartitionError::Ratio`] if the ratio is out of range or NaN.
    pub fn two_numbers(ratio: f64) -> Result<Self, PartitionError> {
        Self::new(ratio, Variant::TwoNumbers)
    }

    /// The first `floor(q N)` of `N` paths fill both maps, the others the caustic map only.
    ///
    /// # Errors
    /// [`PartitionError::Ratio`] if the ratio is out of range or NaN, [`PartitionError::NoPath`] if `q N < 1`.
    pub fn trajectories(ratio: f64, paths: u64) -> Result<Self, PartitionError> {
        let partition = Self::new(ratio, Variant::TwoNumbers)?;
        let global = (ratio * paths as f64).floor() as u64;
        if global == 0 {
            return Err(PartitionError::NoPath { ratio, paths });
        }
        // Above 2^53 paths the product may round up.
        Ok(Self { variant: Variant::Trajectories { paths, global: global.min(paths) }, ..partition })
    }

    /// The ratio `q`.
    #[must_use]
    pub const fn ratio(&self) -> f64 {
        self.ratio
    }

    /// Keeps a photon of the given path, its flux divided by the probability to be kept, or discards it.
    ///
    /// `u`: two numbers, uniform in `[0, 1)`, for this photon alone. The path's index counts from zero; only the
    /// trajectory variant looks at it.
    #[inline]
    pub fn decide<F: Flux>(
        &self,
        photon: Photon<F>,
        path: u64,
        deposition: &impl Deposition,
        u: [f64; 2],
    ) -> Option<Photon<F>> {
        let (passes, worth, u) = match self.variant {
            _ if photon.caustic => (true, 1.0, if self.variant == Variant::OneNumber { u[0] } else { u[1] }),
            Variant::OneNumber => (u[0] < self.ratio, 1.0 / self.ratio, u[0] / self.ratio),
            Variant::TwoNumbers => (u[0] < self.ratio, 1.0 / self.ratio, u[1]),
            Variant::Trajectories { global, .. } => (path < global, 1.0, u[1]),
        };
        if !passes {
            return None;
        }
        let kept = deposition.decide(photon, u)?;
        Some(if worth == 1.0 { kept } else { kept.scaled(worth) })
    }

    /// Whether a path can store anything in the global map: if not, it may end when it cannot become caustic any more.
    #[must_use]
    pub fn fills_global_map(&self, path: u64) -> bool {
        !matches!(self.variant, Variant::Trajectories { global, .. } if path >= global)
    }

    /// Of `traced` paths, how many the global map is to be divided by.
    #[must_use]
    pub fn global_paths(&self, traced: u64) -> u64 {
        match self.variant {
            Variant::OneNumber | Variant::TwoNumbers => traced,
            Variant::Trajectories { global, .. } => traced.min(global),
        }
    }
}

/// The two maps while they are collected; see [`MapPartition`].
#[derive(Clone, Debug, Default)]
pub struct PhotonMaps<F: Flux> {
    /// Photons whose last bounce was sharp.
    pub caustic: Photons<F>,
    /// All others.
    pub global: Photons<F>,
}

impl<F: Flux> PhotonMaps<F> {
    /// No photons yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { caustic: Photons::new(), global: Photons::new() }
    }

    /// Stores a photon in the map that it belongs to.
    #[inline]
    pub fn store(&mut self, photon: Photon<F>) {
        if photon.caustic { self.caustic.store(photon) } else { self.global.store(photon) }
    }

    /// Counts the paths `0 .. traced`: all of them for the caustic map, those that fill it for the global map.
    ///
    /// To be called **once**, with all paths of the partition: threads that collect parts leave it to whom puts them
    /// together.
    pub fn add_paths(&mut self, partition: &MapPartition, traced: u64) {
        self.caustic.add_paths(traced);
        self.global.add_paths(partition.global_paths(traced));
    }

    /// Appends both maps of another collection.
    pub fn append(&mut self, other: Self) {
        self.caustic.append(other.caustic);
        self.global.append(other.global);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATHS: u64 = 64;
    const P: f64 = 3.0 / 8.0;

    /// The expected flux per path in the two maps, exactly: all pairs of random numbers, one between each two
    /// multiples of 1/64, for each path.
    fn expected(partition: &MapPartition) -> [f64; 2] {
        let deposition = |_: [f32; 3], _: [f32; 3]| P;
        let mut maps = PhotonMaps::new();
        let number = |i: u32| (f64::from(i) + 0.5) / 64.0;
        for path in 0..PATHS {
            for (i, j) in (0..64).flat_map(|i| (0..64).map(move |j| (i, j))) {
                for caustic in [false, true] {
                    let photon = Photon { caustic, ..Photon::new([0.0; 3], [0.0, 0.0, 1.0], 1.0_f64) };
                    if let Some(photon) = partition.decide(photon, path, &deposition, [number(i), number(j)]) {
                        maps.store(photon);
                    }
                }
            }
        }
        maps.add_paths(partition, PATHS);
        [&maps.caustic, &maps.global].map(|map| map.total_flux() / (64.0 * 64.0))
    }

    #[test]
    fn the_three_variants_have_equal_expectations() {
        // q p is a multiple of 1/64, so that the enumeration is exact.
        for ratio in [1.0 / 8.0, 0.5, 1.0] {
            let variants = [
                MapPartition::one_number(ratio),
                MapPartition::two_numbers(ratio),
                MapPartition::trajectories(ratio, PATHS),
            ];
            for partition in variants.map(Result::unwrap) {
                let [caustic, global] = expected(&partition);
                assert!(
                    (caustic - 1.0).abs() < 1e-11 && (global - 1.0).abs() < 1e-11,
                    "{partition:?} {caustic} {global}"
                );
            }
        }
    }

    #[test]
    fn the_trajectory_variant_divides_by_what_it_really_used() {
        let partition = MapPartition::trajectories(0.29, 100).unwrap();
        // 0.29 * 100 is 28.999999999999996.
        assert_eq!(partition.global_paths(100), 28);
        assert_eq!(partition.global_paths(5), 5);
        assert!(partition.fills_global_map(27) && !partition.fills_global_map(28));
        assert!(MapPartition::two_numbers(0.1).unwrap().fills_global_map(99));
        assert_eq!(partition.ratio(), 0.29);
    }

    #[test]
    fn impossible_partitions_are_refused() {
        for ratio in [0.0, -1.0, 1.5, f64::NAN, f64::INFINITY] {
            assert!(matches!(MapPartition::one_number(ratio), Err(PartitionError::Ratio(_))));
        }
        let error = MapPartition::trajectories(0.001, 100).unwrap_err();
        assert_eq!(error, PartitionError::NoPath { ratio: 0.001, paths: 100 });
    }

    #[test]
    fn no_variant_asks_for_the_probability_in_vain() {
        let asked = std::cell::Cell::new(0);
        let deposition = |_: [f32; 3], _: [f32; 3]| {
            asked.set(asked.get() + 1);
            1.0
        };
        let photon = Photon::new([0.0; 3], [0.0, 0.0, 1.0], 1.0_f32);
        for partition in
            [MapPartition::one_number(0.5), MapPartition::two_numbers(0.5), MapPartition::trajectories(0.5, 10)]
        {
            assert_eq!(partition.unwrap().decide(photon, 5, &deposition, [0.5, 0.0]), None);
        }
        assert_eq!(asked.get(), 0);
    }
}
