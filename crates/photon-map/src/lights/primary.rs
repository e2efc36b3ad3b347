//! Primary photons, from which contributing lights are found.

use range_search::HashGrid;

use super::ContributingLights;
use crate::vector::is_finite;
use crate::{Flux, Gather, MapError, Photon};

/// A primary photon: where it arrived, and of which light it is. 16 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PrimaryPhoton {
    position: [f32; 3],
    light: u32,
}

/// Primary photons while they are collected: those that came directly from a light.
///
/// **Apart from deposition.** To be offered every photon *before* a [`Deposition`](crate::Deposition) decides: the
/// lights that contribute are found from all primary photons, or lights would be missing where deposition keeps few.
///
/// **Memory.** 16 bytes per photon, and 16 to 32 more in the map: 32 to 48 MB per million.
///
/// # Example
/// See [`PrimaryPhotonMap`].
#[derive(Clone, Debug, Default)]
pub struct PrimaryPhotons {
    photons: Vec<PrimaryPhoton>,
}

impl PrimaryPhotons {
    /// None yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { photons: Vec::new() }
    }

    /// Stores position and light of a photon, if it is primary and its light is known.
    #[inline]
    pub fn offer<F: Flux>(&mut self, photon: &Photon<F>) {
        if let Some(light) = photon.light.filter(|_| photon.primary && is_finite(photon.position)) {
            self.photons.push(PrimaryPhoton { position: photon.position, light });
        }
    }

    /// Appends another collection.
    pub fn append(&mut self, mut other: Self) {
        self.photons.append(&mut other.photons);
    }

    /// How many.
    #[must_use]
    pub fn len(&self) -> usize {
        self.photons.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.photons.is_empty()
    }
}

/// Finds the lights that contribute to a point: those that primary photons around it came from.
///
/// **Assumptions.** A light that lights the point leaves photons within the radius, with high probability: with `n`
/// photons of a light on the area `A` that it lights, it is missed in a disk of radius `r` with probability about
/// `exp(-n pi r^2 / A)`. What is missed is left to the other rays of a [`LightSelection`](crate::LightSelection), so
/// nothing is biased by it.
///
/// **Cost.** O(photons in the ball), and `O(c log c)` for `c` contributing lights; nothing is proportional to the
/// number of lights.
///
/// **Source.** Keller and Wald 2000, section 3.
///
/// # Example
/// ```
/// use photon_map::{
///     CausticRule, ContributingLights, Gather, LastBounce, Photon, PrimaryPhotonMap, PrimaryPhotons,
/// };
/// let mut primary = PrimaryPhotons::new();
/// for (x, light) in [(0.0, 3), (0.1, 3), (0.2, 90), (5.0, 7)] {
///     let photon = Photon::new([x, 0.0, 0.0], [0.0, 0.0, 1.0], 1.0_f32).from_light(light);
///     primary.offer(&CausticRule::SPECULAR.label(photon, LastBounce::Emission));
/// }
/// let map = PrimaryPhotonMap::build(primary, 1.0)?;
/// let mut contributing = ContributingLights::new(100);
/// map.contributing([0.0; 3], &Gather::within(1.0)?, &mut contributing);
/// assert_eq!(contributing.as_slice(), [(3, 2), (90, 1)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PrimaryPhotonMap {
    lights: Vec<u32>,
    index: HashGrid,
}

impl PrimaryPhotonMap {
    /// Sorts primary photons into a grid. `radius`: that of most queries.
    ///
    /// # Errors
    /// [`MapError::Index`] if the radius is not positive and finite.
    pub fn build(primary: PrimaryPhotons, radius: f32) -> Result<Self, MapError> {
        let grid = |photons: &[PrimaryPhoton]| {
            HashGrid::build(photons, |photon| photon.position, radius).map_err(MapError::Index)
        };
        // As in `PhotonMap::build`.
        let photons = grid(&primary.photons)?.reorder(&primary.photons);
        drop(primary);
        let index = grid(&photons)?;
        Ok(Self { lights: photons.iter().map(|photon| photon.light).collect(), index })
    }

    /// How many photons.
    #[must_use]
    pub fn len(&self) -> usize {
        self.lights.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// Bytes on the heap.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.lights.capacity() * size_of::<u32>() + self.index.bytes()
    }

    /// Replaces what is in `contributing` by the lights of the photons around a point; lights beyond its number of
    /// lights are left out.
    pub fn contributing(&self, position: [f32; 3], gather: &Gather, contributing: &mut ContributingLights) {
        let mut scratch = contributing.begin();
        gather.for_each(&self.index, position, &mut scratch, |_, id, _| contributing.insert(self.lights[id]));
        contributing.seal(scratch);
    }
}
