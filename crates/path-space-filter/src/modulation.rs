//! Whether surface colour is part of what is averaged.

use crate::vertex::HasAlbedo;
use crate::{Contribution, PathVertex};

/// What of a contribution is averaged, and what becomes of the average at the vertex that asks.
///
/// **Law.** `remodulate(v, demodulate(v))` is `v.contribution()`, up to round-off.
///
/// Dyn compatible: `&dyn Modulation<V>`.
pub trait Modulation<V: PathVertex> {
    /// What is averaged.
    fn demodulate(&self, vertex: &V) -> V::Contribution;
    /// What an average is worth at a vertex.
    fn remodulate(&self, vertex: &V, mean: V::Contribution) -> V::Contribution;
}

// Its docs say so.
const _: Option<&dyn Modulation<crate::Vertex<f32>>> = None;

/// Contributions as they are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "AsStoredName", into = "AsStoredName"))]
pub struct AsStored;

#[cfg(feature = "serde")]
by_name!(AsStoredName: AsStored);

impl<V: PathVertex> Modulation<V> for AsStored {
    #[inline]
    fn demodulate(&self, vertex: &V) -> V::Contribution {
        vertex.contribution()
    }

    #[inline]
    fn remodulate(&self, _: &V, mean: V::Contribution) -> V::Contribution {
        mean
    }
}

/// Contributions over the albedo of their vertex; the average times that of the asking one, as if "the optical surface properties would be evaluated in `x_i`"
/// (section 2.1 of the paper), exactly so on diffuse surfaces.
///
/// ```text
/// mean_i = max(a_i, e) * ( sum w_ij c_j / max(a_j, e) ) / sum w_ij           per component
/// ```
/// The floor `e` keeps what dark surfaces reflect by other means than their albedo; the centre is not affected by it.
///
/// For RGB contributions; implement [`Modulation`] for others.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "DemodulatedName", into = "DemodulatedName"))]
pub struct Demodulated {
    floor: f32,
}

/// As it is in a file.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
enum DemodulatedName {
    Demodulated(f32),
}

#[cfg(feature = "serde")]
impl From<DemodulatedName> for Demodulated {
    fn from(DemodulatedName::Demodulated(floor): DemodulatedName) -> Self {
        Self::with_floor(floor)
    }
}

#[cfg(feature = "serde")]
impl From<Demodulated> for DemodulatedName {
    fn from(Demodulated { floor }: Demodulated) -> Self {
        Self::Demodulated(floor)
    }
}

impl Demodulated {
    /// With this floor, at least 1e-4.
    pub fn with_floor(floor: f32) -> Self {
        Self { floor: floor.max(1e-4) }
    }

    fn factor(&self, vertex: &impl HasAlbedo) -> [f32; 3] {
        // The floor also where the albedo is NaN.
        vertex.albedo().map(|a| if a > self.floor { a.min(f32::MAX) } else { self.floor })
    }
}

impl Default for Demodulated {
    /// A floor of 0.01.
    fn default() -> Self {
        Self::with_floor(0.01)
    }
}

impl<V: PathVertex<Contribution = [f32; 3]> + HasAlbedo> Modulation<V> for Demodulated {
    #[inline]
    fn demodulate(&self, vertex: &V) -> [f32; 3] {
        let (c, a) = (vertex.contribution(), self.factor(vertex));
        [c[0] / a[0], c[1] / a[1], c[2] / a[2]]
    }

    #[inline]
    fn remodulate(&self, vertex: &V, mean: [f32; 3]) -> [f32; 3] {
        let a = self.factor(vertex);
        [mean[0] * a[0], mean[1] * a[1], mean[2] * a[2]]
    }
}

/// Whether a vertex takes part: at a place, with a contribution that is a number.
#[inline]
pub(crate) fn takes_part<V: PathVertex>(vertex: &V) -> bool {
    vertex.position().iter().all(|x| x.is_finite()) && vertex.contribution().is_finite()
}
