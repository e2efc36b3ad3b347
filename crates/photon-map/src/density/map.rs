//! The photon map.

use range_search::{BuildError, HashGrid, RangeIndex};

use super::{Gather, GatherPoint, Scratch};
use crate::{Flux, Kernel, PackedPhoton, Photons};

/// How densities are estimated: how far to look, and how photons at a distance count.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct DensityEstimation {
    /// How far.
    pub gather: Gather,
    /// How photons at a distance count.
    pub kernel: Kernel,
}

/// What photons say about a point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Estimate<T> {
    /// The sum of what photons contribute, per area and path.
    pub value: T,
    /// How many photons contributed.
    pub photons: usize,
    /// The radius.
    pub radius: f32,
}

/// Photons that can be looked for by place, and estimates of density from them.
///
/// ```text
/// E(x) ~ 1/N sum over photons k of K(t_k) / r^2 flux_k            irradiance, W/m^2
/// L(x, wo) ~ 1/N sum over k of K(t_k) / r^2 f(wi_k, x, wo) flux_k   reflected radiance, W/(m^2 sr)
/// ```
///
/// **Symbols.** `N`: paths; `K`: [`Kernel`]; `t_k`: squared distance over `r^2` in the metric of [`GatherPoint`];
/// `r`: radius of [`Gather`]; `f`: BSDF, without cosine: that is in the flux of the photons that hit the surface.
///
/// **Assumptions.** The surface within the radius is a plane, all of it lit: near its rim a part of the disk has no
/// photons, and the estimate is too small. Irradiance is uniform within the radius.
///
/// **Biased** for a fixed radius by `1/2 mu_2 r^2` times the Laplacian of the irradiance ([`Kernel::second_moment`]);
/// the variance is at most [`Kernel::roughness`]` / r^2` times the sum of `(flux / N)^2` per area. **Consistent** if
/// the radius shrinks slowly: [`ProgressiveRadius`](crate::ProgressiveRadius). Exact on uniform sheets.
///
/// **Round-off.** Photons of a query are summed up in their own type: for `f32` a relative error of 6e-8 times their
/// number at worst.
///
/// **Cost.** A query tests the photons around the point. Building sorts photons by place once, so that queries read
/// them in a row.
///
/// **Memory.** 32 bytes per photon with RGB flux and 16 to 32 for the grid: 48 to 64 MB per million photons, 3.2 GB
/// at most for 50 million; twice the photons and the grid while it is built. [`bytes`](Self::bytes) says it exactly.
///
/// **Source.** H. W. Jensen, "Global illumination using photon maps", 1996; Keller and Wald 2000, section 2.
///
/// # Example
/// ```
/// use photon_map::{DensityEstimation, Gather, GatherPoint, Kernel, Photon, PhotonMap, Photons, Scratch};
/// let mut photons = Photons::new();
/// for i in 0..10_000 {
///     // 10,000 W on a square of 10 x 10 m, from above.
///     let position = [(i % 100) as f32 * 0.1 + 0.05, (i / 100) as f32 * 0.1 + 0.05, 0.0];
///     photons.store(Photon::new(position, [0.0, 0.0, 1.0], 10_000.0_f32));
/// }
/// photons.add_paths(10_000);
/// let map = PhotonMap::build(photons, 1.0)?;
///
/// let estimation = DensityEstimation { gather: Gather::within(1.0)?, kernel: Kernel::Epanechnikov };
/// let point = GatherPoint::on([5.0, 5.0, 0.0], [0.0, 0.0, 1.0]);
/// let irradiance = map.irradiance(&estimation, &point, &mut Scratch::default());
/// assert!((irradiance.value - 100.0).abs() < 0.1);
/// let albedo_over_pi = 0.5 / std::f32::consts::PI;
/// let radiance = map.estimate(&estimation, &point, &mut Scratch::default(), |photon| photon.flux() * albedo_over_pi);
/// assert!((radiance.value - 100.0 * albedo_over_pi).abs() < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Photons move into the map, which takes no more of them: none can be stored that its index does not know.
///
/// ```compile_fail,E0382
/// use photon_map::{Photon, PhotonMap, Photons};
/// let mut photons = Photons::new();
/// photons.add_paths(1);
/// let map = PhotonMap::build(photons, 1.0)?;
/// photons.store(Photon::new([0.0; 3], [0.0, 0.0, 1.0], 1.0_f32));
/// # Ok::<(), photon_map::MapError>(())
/// ```
///
/// And a map of importons, whose flux is one number, is none of light:
///
/// ```compile_fail,E0308
/// use photon_map::{DensityEstimation, GatherPoint, PhotonMap, Scratch};
/// fn irradiance(map: &PhotonMap<f32>, how: &DensityEstimation, at: &GatherPoint) -> [f32; 3] {
///     map.irradiance(how, at, &mut Scratch::default()).value
/// }
/// ```
#[derive(Clone, Debug)]
pub struct PhotonMap<F, I = HashGrid> {
    photons: Vec<PackedPhoton<F>>,
    index: I,
    paths: u64,
}

/// Why there is no map.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MapError {
    /// Nobody said how many paths the photons are of.
    #[error("the photons are of no path: call add_paths for each path that was traced")]
    NoPaths,
    /// The index cannot be built.
    #[error("no index over the photons: {0}")]
    Index(BuildError),
}

impl<F: Flux> PhotonMap<F> {
    /// Sorts photons into a grid. `radius`: what most queries will have; others work, too, only slower.
    ///
    /// # Errors
    /// [`MapError`] if no paths were counted, or the radius is not positive and finite.
    pub fn build(photons: Photons<F>, radius: f32) -> Result<Self, MapError> {
        Self::sorted(photons, |photons| HashGrid::build(photons, PackedPhoton::position, radius))
    }

    /// The same map, built on all threads of rayon's pool.
    ///
    /// # Errors
    /// As [`build`](Self::build).
    #[cfg(feature = "rayon")]
    pub fn par_build(photons: Photons<F>, radius: f32) -> Result<Self, MapError>
    where
        F: Sync,
    {
        Self::sorted(photons, |photons| HashGrid::par_build(photons, PackedPhoton::position, radius))
    }

    fn sorted(
        photons: Photons<F>,
        grid: impl FnOnce(&[PackedPhoton<F>]) -> Result<HashGrid, BuildError>,
    ) -> Result<Self, MapError> {
        let (unsorted, paths) = parts(photons)?;
        let grid = grid(&unsorted).map_err(MapError::Index)?;
        // In the order of the grid photons of a cell lie in a row.
        let photons = grid.reorder(&unsorted);
        Ok(Self { photons, index: grid.renumbered(), paths })
    }

    /// Bytes on the heap.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.photons.capacity() * size_of::<PackedPhoton<F>>() + self.index.bytes()
    }
}

fn parts<F: Flux>(photons: Photons<F>) -> Result<(Vec<PackedPhoton<F>>, u64), MapError> {
    let paths = photons.paths();
    if paths == 0 { Err(MapError::NoPaths) } else { Ok((photons.into_vec(), paths)) }
}

impl<F: Flux, I: RangeIndex> PhotonMap<F, I> {
    /// With another index, which `build` makes from the photons in the order in which they were stored.
    ///
    /// # Errors
    /// [`MapError`] if no paths were counted, or the index cannot be built.
    pub fn with_index(
        photons: Photons<F>,
        build: impl FnOnce(&[PackedPhoton<F>]) -> Result<I, BuildError>,
    ) -> Result<Self, MapError> {
        let (photons, paths) = parts(photons)?;
        let index = build(&photons).map_err(MapError::Index)?;
        Ok(Self { photons, index, paths })
    }

    /// The photons, in the order of the index' ids.
    #[must_use]
    pub fn photons(&self) -> &[PackedPhoton<F>] {
        &self.photons
    }

    /// The number of paths.
    #[must_use]
    pub const fn paths(&self) -> u64 {
        self.paths
    }

    /// The index.
    #[must_use]
    pub const fn index(&self) -> &I {
        &self.index
    }

    /// The irradiance at a point.
    #[inline]
    pub fn irradiance(&self, estimation: &DensityEstimation, at: &GatherPoint, scratch: &mut Scratch) -> Estimate<F> {
        self.estimate(estimation, at, scratch, PackedPhoton::flux)
    }

    /// The density of anything: `contribution` is what a photon contributes, its flux times a BSDF for radiance.
    ///
    /// Zero if no photon counts, or the point is not finite.
    #[inline]
    pub fn estimate<T: Flux>(
        &self,
        estimation: &DensityEstimation,
        at: &GatherPoint,
        scratch: &mut Scratch,
        mut contribution: impl FnMut(&PackedPhoton<F>) -> T,
    ) -> Estimate<T> {
        let (mut sum, mut count) = (T::ZERO, 0);
        let disk = estimation.gather.for_each(&self.index, at.position(), scratch, |disk, id, distance_squared| {
            let photon = &self.photons[id];
            let Some(d2) = at.distance_squared(photon, distance_squared) else { return };
            let weight = disk.weight(&estimation.kernel, d2);
            if weight > 0.0 {
                count += 1;
                sum = sum.add(contribution(photon).scale(weight));
            }
        });
        let value = sum.scale(disk.per_area() / self.paths as f64);
        Estimate { value, photons: count, radius: disk.radius_squared.sqrt() }
    }

    /// Number and sum of the photons that count at a point, unweighted: what
    /// [`ProgressivePoint::add`](crate::ProgressivePoint::add) takes.
    ///
    /// Finds nothing for a radius that is not between 1e-15 and 1e18.
    pub fn collect<T: Flux>(
        &self,
        radius: f32,
        at: &GatherPoint,
        mut contribution: impl FnMut(&PackedPhoton<F>) -> T,
    ) -> (u64, T) {
        let (mut sum, mut count) = (T::ZERO, 0);
        let Ok(gather) = Gather::within(radius) else { return (count, sum) };
        gather.for_each(&self.index, at.position(), &mut Scratch::default(), |disk, id, distance_squared| {
            let photon = &self.photons[id];
            let counted = at.distance_squared(photon, distance_squared);
            if counted.is_some_and(|d2| d2 < disk.radius_squared) {
                count += 1;
                sum = sum.add(contribution(photon));
            }
        });
        (count, sum)
    }

    /// A radius within which about `count` photons are: the median over points of the distance of the `count`-th
    /// nearest.
    ///
    /// A beginning for a fixed or a [`ProgressiveRadius`](crate::ProgressiveRadius); points are those that the camera
    /// sees. Points with fewer photons within `max_radius` count as that. `None` without points, or if `count` is
    /// zero.
    #[must_use]
    pub fn typical_radius(
        &self,
        points: impl IntoIterator<Item = [f32; 3]>,
        count: usize,
        max_radius: f32,
    ) -> Option<f32> {
        let mut found = Vec::new();
        let distance = |point| {
            self.index.k_nearest(point, count, max_radius, &mut found);
            found.last().filter(|_| found.len() == count).map_or(max_radius, |farthest| farthest.distance())
        };
        let mut radii: Vec<f32> = points.into_iter().map(distance).collect();
        if radii.is_empty() || count == 0 {
            return None;
        }
        let middle = radii.len() / 2;
        Some(*radii.select_nth_unstable_by(middle, f32::total_cmp).1)
    }
}
