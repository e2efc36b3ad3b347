//! The lights that contribute to a point.

use crate::Scratch;

/// The lights that primary photons around a point came from, with the number of photons of each.
///
/// A sparse set: an array over all lights that is never cleared, and the list of those in the set. Inserting and
/// asking are O(1), forgetting everything is O(1), and nothing is O(number of lights) but making it. Keep one per
/// thread.
///
/// **Memory.** 4 bytes per light of the scene, and 8 per contributing light.
///
/// **Source.** P. Briggs and L. Torczon, "An efficient representation for sparse sets", 1993; the lights are `L_con`
/// of Keller and Wald 2000, section 3.
///
/// # Example
/// ```
/// use photon_map::ContributingLights;
/// let contributing = ContributingLights::from_lights(10_000, [4, 1200, 4]);
/// assert_eq!(contributing.as_slice(), [(4, 2), (1200, 1)]);
/// ```
#[derive(Clone, Debug)]
pub struct ContributingLights {
    /// Where in `lights` a light may stand. Stale entries point to another light, or beyond the end.
    places: Vec<u32>,
    /// Lights and their numbers of photons; by light once sealed.
    lights: Vec<(u32, u32)>,
    /// For queries of the nearest photons.
    scratch: Scratch,
}

impl ContributingLights {
    /// None yet, of a scene with so many lights.
    #[must_use]
    pub fn new(lights: usize) -> Self {
        Self { places: vec![0; lights], lights: Vec::new(), scratch: Scratch::default() }
    }

    /// Of a scene with so many `lights`, those that are listed; lights that do not exist are left out.
    #[must_use]
    pub fn from_lights(lights: usize, contributing: impl IntoIterator<Item = u32>) -> Self {
        let mut set = Self::new(lights);
        set.set(contributing);
        set
    }

    /// Replaces the set by these lights, listed once for each photon; lights that do not exist are left out.
    pub fn set(&mut self, lights: impl IntoIterator<Item = u32>) {
        let scratch = self.begin();
        lights.into_iter().for_each(|light| self.insert(light));
        self.seal(scratch);
    }

    /// Forgets everything, and lends the memory for queries until the set is sealed.
    pub(super) fn begin(&mut self) -> Scratch {
        self.lights.clear();
        std::mem::take(&mut self.scratch)
    }

    /// Counts a photon of a light.
    #[inline]
    pub(super) fn insert(&mut self, light: u32) {
        let Some(place) = self.places.get_mut(light as usize) else { return };
        match self.lights.get_mut(*place as usize) {
            Some((found, photons)) if *found == light => *photons += 1,
            _ => {
                *place = self.lights.len() as u32;
                self.lights.push((light, 1));
            }
        }
    }

    /// Sorts the lights.
    pub(super) fn seal(&mut self, scratch: Scratch) {
        self.scratch = scratch;
        self.lights.sort_unstable();
        for (place, &(light, _)) in self.lights.iter().enumerate() {
            self.places[light as usize] = place as u32;
        }
    }

    /// The lights in ascending order, each with its number of photons.
    #[must_use]
    pub fn as_slice(&self) -> &[(u32, u32)] {
        &self.lights
    }

    /// How many lights contribute.
    #[must_use]
    pub fn len(&self) -> usize {
        self.lights.len()
    }

    /// Whether none does.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    /// Whether a light contributes.
    #[must_use]
    pub fn contains(&self, light: u32) -> bool {
        let place = self.places.get(light as usize);
        place.and_then(|&place| self.lights.get(place as usize)).is_some_and(|&(found, _)| found == light)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    proptest! {
        #[test]
        fn it_is_a_map_of_counts_again_and_again(
            rounds in prop::collection::vec(prop::collection::vec(0_u32..40, 0..60), 1..5),
        ) {
            let mut set = ContributingLights::new(30);
            for lights in rounds {
                let mut counts = BTreeMap::new();
                lights.iter().filter(|&&light| light < 30).for_each(|&light| *counts.entry(light).or_insert(0) += 1);
                set.set(lights);
                prop_assert_eq!(set.as_slice().to_vec(), counts.clone().into_iter().collect::<Vec<(u32, u32)>>());
                prop_assert!((0..40).all(|light| set.contains(light) == counts.contains_key(&light)));
                prop_assert_eq!((set.len(), set.is_empty()), (counts.len(), counts.is_empty()));
            }
        }
    }
}
