//! Photons, and how they are stored.

use crate::direction::PackedDirection;
use crate::vector::is_finite;
use crate::{Flux, FluxWords};

/// A photon: flux that arrived at a point of a surface.
///
/// ```text
/// L_i(x, wi) cos dwi dA  ~  sum over photons k of  delta(x - x_k) delta(wi - wi_k) flux_k / N
/// ```
///
/// **Symbols.** `flux`: watts per component, of one of `N` paths: `N` is divided out by the map, not here. (Keller and Wald 2000 calls it
/// irradiance; what a path carries is flux.) `wi`: unit vector, away from the surface, to where the light came from.
///
/// An *importon* is a `Photon<f32>` on a path that began at the sensor; its flux is importance.
///
/// # Example
/// ```
/// use photon_map::Photon;
/// let photon = Photon::new([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [2.0, 1.0, 0.5]).from_light(7);
/// assert_eq!(photon.light, Some(7));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
#[non_exhaustive]
pub struct Photon<F> {
    /// Where it arrived.
    pub position: [f32; 3],
    /// Where it came from: a unit vector away from the surface.
    pub wi: [f32; 3],
    /// What it carries, in watts; not yet divided by the number of paths.
    pub flux: F,
    /// The light that its path began at, if it matters: at most [`Self::MAX_LIGHT`].
    pub light: Option<u32>,
    /// Whether it came directly from the light.
    pub primary: bool,
    /// Whether it belongs to the caustic map, see [`CausticRule`](crate::CausticRule).
    pub caustic: bool,
}

/// Photons of a sensor's paths, which carry importance.
pub type Importon = Photon<f32>;

impl<F: Flux> Photon<F> {
    /// The largest identification of a light: `2^30 - 2`.
    pub const MAX_LIGHT: u32 = NO_LIGHT - 1;

    /// A photon of no light in particular, neither primary nor caustic.
    pub const fn new(position: [f32; 3], wi: [f32; 3], flux: F) -> Self {
        Self { position, wi, flux, light: None, primary: false, caustic: false }
    }

    /// With the light that its path began at.
    #[must_use]
    pub const fn from_light(mut self, light: u32) -> Self {
        self.light = Some(light);
        self
    }

    /// With its flux multiplied.
    #[must_use]
    #[inline]
    pub fn scaled(mut self, factor: f64) -> Self {
        self.flux = self.flux.scale(factor);
        self
    }
}

const NO_LIGHT: u32 = (1 << 30) - 1;
const PRIMARY: u32 = 1 << 30;
const CAUSTIC: u32 = 1 << 31;

/// A photon as it is stored: 32 bytes with RGB flux.
///
/// | part | bytes | round-off |
/// |---|---|---|
/// | position | 12 | none |
/// | flux | that of `F`: 12 for `[f32; 3]` | none |
/// | direction | 4, octahedral | at most 6.5e-5 rad |
/// | light and flags | 4 | none |
///
/// # Example
/// ```
/// use photon_map::{PackedPhoton, Photon};
/// assert_eq!(size_of::<PackedPhoton<[f32; 3]>>(), 32);
/// assert_eq!(size_of::<PackedPhoton<f32>>(), 24);
/// let photon = Photon::new([0.1, 0.2, 0.3], [0.0, 0.0, 1.0], [2.0, 1.0, 0.5]).from_light(7);
/// assert_eq!(PackedPhoton::pack(&photon).ok_or("not finite")?.unpack(), photon);
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackedPhoton<F> {
    position: [f32; 3],
    wi: PackedDirection,
    flux: F,
    tag: u32,
}

impl<F: Flux> PackedPhoton<F> {
    /// Packs a photon.
    ///
    /// `None` if its position or flux is not finite, its direction has no direction, or its light is above
    /// [`Photon::MAX_LIGHT`].
    pub fn pack(photon: &Photon<F>) -> Option<Self> {
        let light = match photon.light {
            None => NO_LIGHT,
            Some(light) if light <= Photon::<F>::MAX_LIGHT => light,
            Some(_) => return None,
        };
        if !(is_finite(photon.position) && photon.flux.is_finite()) {
            return None;
        }
        let flag = |set: bool, bit: u32| if set { bit } else { 0 };
        let tag = light | flag(photon.primary, PRIMARY) | flag(photon.caustic, CAUSTIC);
        Some(Self { position: photon.position, wi: PackedDirection::pack(photon.wi)?, flux: photon.flux, tag })
    }

    /// The photon.
    #[inline]
    pub fn unpack(&self) -> Photon<F> {
        let light = self.tag & NO_LIGHT;
        Photon {
            position: self.position,
            wi: self.wi(),
            flux: self.flux,
            light: (light != NO_LIGHT).then_some(light),
            primary: self.tag & PRIMARY != 0,
            caustic: self.tag & CAUSTIC != 0,
        }
    }

    /// Where it arrived.
    #[inline]
    pub const fn position(&self) -> [f32; 3] {
        self.position
    }

    /// Where it came from.
    #[inline]
    pub fn wi(&self) -> [f32; 3] {
        self.wi.unpack()
    }

    /// Where it came from, not of unit length.
    #[inline]
    pub(crate) fn wi_unnormalised(&self) -> [f32; 3] {
        self.wi.unnormalised()
    }

    /// What it carries.
    #[inline]
    pub const fn flux(&self) -> F {
        self.flux
    }
}

impl<F: FluxWords> PackedPhoton<F> {
    /// Words of 32 bits, without those of the flux.
    pub(crate) const OTHER_WORDS: usize = 5;

    /// All parts, bit for bit.
    pub(crate) fn words(&self, mut give: impl FnMut(u32)) {
        self.position.iter().for_each(|coordinate| give(coordinate.to_bits()));
        give(self.wi.code());
        give(self.tag);
        self.flux.words(give);
    }

    /// The photon of such words, if it is one.
    pub(crate) fn from_words(mut take: impl FnMut() -> u32) -> Option<Self> {
        let position = std::array::from_fn(|_| f32::from_bits(take()));
        let wi = PackedDirection::from_code(take());
        let tag = take();
        let flux = F::from_words(take);
        (is_finite(position) && flux.is_finite()).then_some(Self { position, wi: wi?, flux, tag })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_but_the_direction_survives_packing() {
        for light in [None, Some(0), Some(12), Some(Photon::<f32>::MAX_LIGHT)] {
            for (primary, caustic) in [(false, false), (true, false), (false, true), (true, true)] {
                let photon =
                    Photon { light, primary, caustic, ..Photon::new([1e-30, -5.0, 1e30], [0.0, -3.0, 0.0], 2e-9_f64) };
                let back = PackedPhoton::pack(&photon).unwrap().unpack();
                assert_eq!(back, Photon { wi: [0.0, -1.0, 0.0], ..photon });
            }
        }
    }

    #[test]
    fn what_is_no_photon_is_refused() {
        let good = Photon::new([0.0; 3], [0.0, 0.0, 1.0], [1.0_f32; 3]);
        for bad in [
            Photon { position: [f32::NAN, 0.0, 0.0], ..good },
            Photon { wi: [0.0; 3], ..good },
            Photon { flux: [1.0, f32::INFINITY, 1.0], ..good },
            good.from_light(Photon::<f32>::MAX_LIGHT + 1),
        ] {
            assert_eq!(PackedPhoton::pack(&bad), None);
        }
    }
}
