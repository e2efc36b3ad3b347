//! What a path leaves behind, and what becomes of it.

use crate::{Contribution, PathVertex};

/// A path's selected vertex, the attenuation on its way to the camera, and everything that stays out of the average.
///
/// ```text
/// L_i = a_i mean_i + u_i
/// ```
/// **Symbols.** `a`: attenuation (throughput) from the vertex to the camera, without unit; `mean`: the average at the vertex; `u`: what was found before the
/// vertex, what it emits itself, and **photon map contributions** there, times their attenuation. A density estimate is an average over a disk
/// already: averaging it again only blurs (section 2.3 of the paper).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct PathSample<V, C> {
    /// The vertex, if the path has one that is to be filtered.
    pub vertex: Option<V>,
    /// Attenuation `a`, per component.
    pub attenuation: C,
    /// What stays out of the average, `u`.
    pub unfiltered: C,
}

impl<V, C> PathSample<V, C>
where
    V: PathVertex<Contribution = C>,
    C: Attenuate,
{
    /// What the path says without a filter.
    pub fn radiance(&self) -> C {
        match &self.vertex {
            Some(vertex) => self.shade(vertex.contribution()),
            None => self.unfiltered,
        }
    }

    /// What the path says if `mean` takes the place of its vertex's contribution.
    pub fn shade(&self, mean: C) -> C {
        self.unfiltered.plus(mean.times(self.attenuation))
    }
}

/// Contributions with a product per component.
pub trait Attenuate: Contribution {
    /// The product.
    #[must_use]
    fn times(self, factor: Self) -> Self;
    /// The sum.
    #[must_use]
    fn plus(self, other: Self) -> Self;
}

impl<const N: usize> Attenuate for [f32; N] {
    #[inline]
    fn times(self, factor: Self) -> Self {
        core::array::from_fn(|i| self[i] * factor[i])
    }

    #[inline]
    fn plus(self, other: Self) -> Self {
        core::array::from_fn(|i| self[i] + other[i])
    }
}

impl Attenuate for f32 {
    #[inline]
    fn times(self, factor: Self) -> Self {
        self * factor
    }

    #[inline]
    fn plus(self, other: Self) -> Self {
        self + other
    }
}
