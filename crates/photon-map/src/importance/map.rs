//! The map of importons.

use range_search::{HashGrid, RangeIndex};

use super::{AnyDirection, DirectionWeight};
use crate::{DensityEstimation, DirectionalHistogram, GatherPoint, PhotonMap, Scratch};

/// The visual importance of places, from importons: photons of paths that began at the sensor.
///
/// ```text
/// W(x)     = 1/N sum over importons k of K(t_k) / r^2 W_k
/// W(x, wi) = 1/N sum over importons k of K(t_k) / r^2 W_k g(wi, wi_k)
/// ```
///
/// **Symbols.** `W_k`: importance that importon `k` carries; `g`: how much light from `wi` matters to an observer
/// that came from `wi_k`, a [`DirectionWeight`] (a BSDF for instance).
///
/// **Biased** as every density estimate, and harmless: what is made of it here are probabilities, which need not be
/// right. Importance shines through thin walls, for photons that are asked about have no normal; Keller and Wald 2000 calls it energy
/// bleeding.
///
/// **Cost.** A density estimate for each question.
///
/// **Source.** Keller and Wald 2000, section 2.3; I. Peter and G. Pietrek 1998.
///
/// # Example
/// ```
/// use photon_map::{
///     DensityEstimation, DirectionalHistogram, Gather, GatherPoint, ImportanceMap, Kernel, Photon, PhotonMap, Photons,
///     Scratch,
/// };
/// let mut importons = Photons::new();
/// importons.store(Photon::new([0.0; 3], [0.6, 0.0, 0.8], 3.0));
/// importons.add_paths(1);
/// let estimation = DensityEstimation { gather: Gather::within(1.0)?, kernel: Kernel::Constant };
/// let importance = ImportanceMap::new(PhotonMap::build(importons, 1.0)?, estimation);
/// assert!((importance.at([0.5, 0.0, 0.0]) - 3.0 / std::f64::consts::PI).abs() < 1e-6);
/// assert_eq!(importance.at([2.0, 0.0, 0.0]), 0.0);
///
/// let mut histogram = DirectionalHistogram::new(8, 8)?;
/// importance.directions(&GatherPoint::at([0.5, 0.0, 0.0]), &mut histogram, &mut Scratch::default());
/// assert!(histogram.pdf_solid_angle([0.6, 0.01, 0.8]) > 5.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ImportanceMap<I = HashGrid> {
    importons: PhotonMap<f32, I>,
    estimation: DensityEstimation,
}

impl<I: RangeIndex> ImportanceMap<I> {
    /// From importons. With [`Gather::nearest`](crate::Gather::nearest) queries allocate, but hardly ever come back
    /// empty.
    #[must_use]
    pub const fn new(importons: PhotonMap<f32, I>, estimation: DensityEstimation) -> Self {
        Self { importons, estimation }
    }

    /// The importance of a place, per area and path.
    #[must_use]
    pub fn at(&self, position: [f32; 3]) -> f64 {
        self.towards(position, [0.0; 3], &AnyDirection)
    }

    /// The importance of light that arrives at a place from `wi`.
    #[must_use]
    pub fn towards(&self, position: [f32; 3], wi: [f32; 3], weight: &impl DirectionWeight) -> f64 {
        let (at, mut scratch) = (GatherPoint::at(position), Scratch::default());
        let contribution =
            |importon: &crate::PackedPhoton<f32>| f64::from(importon.flux()) * weight.weight(wi, || importon.wi());
        self.importons.estimate(&self.estimation, &at, &mut scratch, contribution).value
    }

    /// Fills a histogram with the directions that the importons around a place came from, each with its importance
    /// and kernel: where scattered light is wanted. What was in the histogram is forgotten.
    ///
    /// `at` with a normal leaves importons of the other side out. The nearest few dozens are enough, and cost less than
    /// all within a radius: see [`Gather::nearest`](crate::Gather::nearest).
    pub fn directions(&self, at: &GatherPoint, histogram: &mut DirectionalHistogram, scratch: &mut Scratch) {
        histogram.clear();
        let (gather, kernel) = (self.estimation.gather, self.estimation.kernel);
        gather.for_each(self.importons.index(), at.position(), scratch, |disk, id, distance_squared| {
            let importon = &self.importons.photons()[id];
            if let Some(d2) = at.distance_squared(importon, distance_squared) {
                histogram.add(importon.wi(), importon.flux() * disk.weight(&kernel, d2) as f32);
            }
        });
    }

    /// The importons.
    #[must_use]
    pub const fn importons(&self) -> &PhotonMap<f32, I> {
        &self.importons
    }
}
