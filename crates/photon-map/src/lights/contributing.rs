//! The lights that contribute to a point.

use super::LightTable;
use crate::Scratch;

/// The lights that primary photons around a point came from, with the number of photons of each.
///
/// A sparse set: an array over all lights that is never cleared, and the list of those in the set. Inserting and asking are
/// O(1), forgetting everything is O(1), and nothing is O(number of lights) but making it. Keep one per thread.
///
/// **Memory.** 4 bytes per light of the scene, and 16 per contributing light.
///
/// **Source.** P. Briggs and L. Torczon, "An efficient representation for sparse sets", 1993; the lights are `L_con` of P2, section 3.
///
/// # Example
/// ```
/// use photon_map::{ContributingLights, LightTable};
/// let table = LightTable::uniform(10_000)?;
/// let contributing = ContributingLights::from_lights(&table, [4, 1200, 4]);
/// assert_eq!(contributing.as_slice(), [(4, 2), (1200, 1)]);
/// # Ok::<(), photon_map::LightTableError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ContributingLights {
    /// Where in `lights` a light may stand. Stale entries point to another light, or beyond the end.
    places: Vec<u32>,
    /// Lights and their numbers of photons; by light once sealed.
    lights: Vec<(u32, u32)>,
    /// The weights of the lights before each of the above, and of all: of the table that it was sealed with.
    excluded: Vec<u64>,
    /// For queries of the nearest photons.
    scratch: Scratch,
}

impl ContributingLights {
    /// None yet, of the lights of a table.
    #[must_use]
    pub fn new(table: &LightTable) -> Self {
        Self { places: vec![0; table.len()], lights: Vec::new(), excluded: vec![0], scratch: Scratch::default() }
    }

    /// Of the lights of a table, these; lights that do not exist are left out.
    #[must_use]
    pub fn from_lights(table: &LightTable, lights: impl IntoIterator<Item = u32>) -> Self {
        let mut contributing = Self::new(table);
        contributing.set(table, lights);
        contributing
    }

    /// Replaces the set by these lights of a table, once for each photon; lights that do not exist are left out.
    pub fn set(&mut self, table: &LightTable, lights: impl IntoIterator<Item = u32>) {
        let scratch = self.begin(table);
        lights.into_iter().for_each(|light| self.insert(light));
        self.seal(table, scratch);
    }

    /// Forgets everything, and lends the memory for queries until the set is sealed.
    pub(super) fn begin(&mut self, table: &LightTable) -> Scratch {
        self.lights.clear();
        self.places.resize(table.len(), 0);
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

    /// Sorts the lights and sums up their weights.
    pub(super) fn seal(&mut self, table: &LightTable, scratch: Scratch) {
        self.scratch = scratch;
        self.lights.sort_unstable();
        self.excluded.truncate(1);
        let mut sum = 0;
        for (place, &(light, _)) in self.lights.iter().enumerate() {
            self.places[light as usize] = place as u32;
            sum += table.weight(light);
            self.excluded.push(sum);
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

    /// The weight of all contributing lights in the table's units.
    pub(super) fn weight(&self) -> u64 {
        self.excluded[self.lights.len()]
    }

    /// The weight of the first lights for which `skip(light, weight of the lights before it)` holds.
    pub(super) fn skipped(&self, skip: impl Fn(u32, u64) -> bool) -> u64 {
        // Not partition_point of `lights`: the predicate needs the index as well.
        let (mut low, mut high) = (0, self.lights.len());
        while low < high {
            let middle = low + (high - low) / 2;
            if skip(self.lights[middle].0, self.excluded[middle]) { low = middle + 1 } else { high = middle }
        }
        self.excluded[low]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    proptest! {
        #[test]
        fn it_is_a_map_of_counts_again_and_again(rounds in prop::collection::vec(prop::collection::vec(0_u32..40, 0..60), 1..5)) {
            let table = LightTable::uniform(30).unwrap();
            let mut set = ContributingLights::new(&table);
            for lights in rounds {
                let mut counts = BTreeMap::new();
                lights.iter().filter(|&&light| light < 30).for_each(|&light| *counts.entry(light).or_insert(0) += 1);
                set.set(&table, lights);
                prop_assert_eq!(set.as_slice().to_vec(), counts.clone().into_iter().collect::<Vec<(u32, u32)>>());
                prop_assert!((0..40).all(|light| set.contains(light) == counts.contains_key(&light)));
                prop_assert_eq!(set.weight(), (counts.len() as u64) << 32);
                prop_assert_eq!((set.len(), set.is_empty()), (counts.len(), counts.is_empty()));
            }
        }
    }
}
