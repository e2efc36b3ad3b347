//! Photons are kept where importons are.

use range_search::{HashGrid, RangeIndex};

use super::{ImportanceMap, ImportanceScale};
use crate::{Bound, BoundError, Deposition};

/// How much light from one direction matters to an observer in another.
///
/// Implemented for closures `(wi of the photon, wi of the importon) -> weight`. Weights are not negative.
///
/// Not dyn compatible, because `weight` is generic: to choose at run time, implement it for an enum of the choices.
pub trait DirectionWeight {
    /// The weight. The importon's direction is computed when asked for.
    fn weight(&self, photon: [f32; 3], importon: impl FnOnce() -> [f32; 3]) -> f64;
}

/// All directions matter alike: the probability depends on the place alone, as in Keller and Wald 2000.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AnyDirection;

impl DirectionWeight for AnyDirection {
    #[inline]
    fn weight(&self, _: [f32; 3], _: impl FnOnce() -> [f32; 3]) -> f64 {
        1.0
    }
}

impl<G: Fn([f32; 3], [f32; 3]) -> f64> DirectionWeight for G {
    #[inline]
    fn weight(&self, photon: [f32; 3], importon: impl FnOnce() -> [f32; 3]) -> f64 {
        self(photon, importon())
    }
}

/// Keeps photons where importons are.
///
/// ```text
/// p(x) = bound(min(1, f W(x)))        or p(x, wi) with W(x, wi)
/// ```
///
/// **Symbols.** `W`: importance, see [`ImportanceMap`]; `f`: [`ImportanceScale`]; the bound: [`Bound`].
///
/// **Unbiased** with [`Bound::Floor`]: `p >= eps > 0` everywhere. **Biased** with [`Bound::Cutoff`]: light is lost
/// where `f W < eps`, places without importon included. With `Cutoff(0.0)` these places alone are lost. Where `p =
/// 1`, in what is seen well, photons keep their flux.
///
/// **Cost.** One density estimate per photon, which is dear; [`MapPartition`](crate::MapPartition) asks for it only
/// when it must. Within a fixed radius nothing is allocated.
///
/// **Source.** Keller and Wald 2000, sections 2.1 and 2.3.
///
/// # Example
/// ```
/// use photon_map::{
///     Bound, DensityEstimation, DepositionExt, Gather, ImportanceMap, ImportanceScale, ImportonDeposition, Kernel, Photon,
///     PhotonMap, Photons,
/// };
/// // The camera sees a square of 1 m around the origin, evenly.
/// let mut importons = Photons::new();
/// for i in 0..400 {
///     let position = [(i % 20) as f32 * 0.05 - 0.475, (i / 20) as f32 * 0.05 - 0.475, 0.0];
///     importons.store(Photon::new(position, [0.0, 0.0, 1.0], 1.0));
/// }
/// importons.add_paths(400);
/// let estimation = DensityEstimation { gather: Gather::within(0.2)?, kernel: Kernel::Constant };
/// let importance = ImportanceMap::new(PhotonMap::build(importons, 0.2)?, estimation);
///
/// // Test rays see these places.
/// let seen = [[0.0, 0.0, 0.0], [0.1, 0.2, 0.0], [-0.2, 0.1, 0.0]];
/// let scale = ImportanceScale::from_queries(seen.map(|x| importance.at(x)), 0.0)?;
/// let deposition = ImportonDeposition::new(&importance, scale, Bound::Floor(0.01))?;
///
/// let photon = |x| Photon::new([x, 0.0, 0.0], [0.0, 0.0, 1.0], 2.0_f32);
/// let thinned = deposition.and(|_: [f32; 3], _: [f32; 3]| 0.5); // a copy
/// assert_eq!(deposition.decide(photon(0.0), 0.9), Some(photon(0.0)));
/// assert_eq!(thinned.decide(photon(0.0), 0.4).map(|p| p.flux), Some(4.0));
/// assert_eq!(deposition.decide(photon(5.0), 0.9), None);
/// assert_eq!(deposition.decide(photon(5.0), 0.001).map(|p| p.flux), Some(200.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct ImportonDeposition<'a, I = HashGrid, G = AnyDirection> {
    importance: &'a ImportanceMap<I>,
    scale: ImportanceScale,
    bound: Bound,
    direction: G,
}

// Not derived: the index behind the reference need not be `Clone`.
impl<I, G: Clone> Clone for ImportonDeposition<'_, I, G> {
    fn clone(&self) -> Self {
        Self { direction: self.direction.clone(), ..*self }
    }
}

impl<I, G: Copy> Copy for ImportonDeposition<'_, I, G> {}

impl<'a, I: RangeIndex> ImportonDeposition<'a, I> {
    /// The probability depends on the place.
    ///
    /// # Errors
    /// [`BoundError`] if the bound is out of range or NaN.
    pub fn new(importance: &'a ImportanceMap<I>, scale: ImportanceScale, bound: Bound) -> Result<Self, BoundError> {
        Self::with_directions(importance, scale, bound, AnyDirection)
    }
}

impl<'a, I: RangeIndex, G: DirectionWeight> ImportonDeposition<'a, I, G> {
    /// The probability depends on the place and on where the photon came from. The scale then comes from
    /// queries [`ImportanceMap::towards`].
    ///
    /// # Errors
    /// [`BoundError`] if the bound is out of range or NaN.
    pub fn with_directions(
        importance: &'a ImportanceMap<I>,
        scale: ImportanceScale,
        bound: Bound,
        direction: G,
    ) -> Result<Self, BoundError> {
        Ok(Self { importance, scale, bound: bound.validate()?, direction })
    }
}

impl<I: RangeIndex, G: DirectionWeight> Deposition for ImportonDeposition<'_, I, G> {
    fn probability(&self, position: [f32; 3], wi: [f32; 3]) -> f64 {
        let importance = self.importance.towards(position, wi, &self.direction);
        self.bound.apply((self.scale.value() * importance).min(1.0))
    }
}
