//! A discrete distribution over lights from which some may be left out.

use super::ContributingLights;

/// The largest weight in units; the smallest is at least one.
const UNITS: f64 = (1u64 << 32) as f64;

/// A discrete distribution over lights, from which any few can be excluded at no cost to speak of.
///
/// ```text
/// P(j) = a_j / sum_i a_i,        P(j | not in C) = a_j / sum over i not in C of a_i
/// ```
///
/// **Symbols.** `a_j > 0`: the weight of light `j`: its emission area, its power, or 1 for Keller and Wald's equation 1. `C`: the
/// contributing lights.
///
/// **Exact.** Weights are rounded to whole numbers of `max_i a_i / 2^32`, at least one, and their prefix sums are
/// whole numbers, too: the probabilities that are reported are those of the sampling, without cancellation, whatever
/// is excluded. The rounding changes which probabilities these are, not the unbiasedness, and leaves every light a
/// positive one.
///
/// **Cost.** Building is O(M) for `M` lights, 8 bytes each. Sampling is a binary search, O(log M), with exclusion
/// O(log |C| + log M): one random number, no rejection, hence no worst case when nearly everything is excluded.
///
/// **Source.** Keller and Wald 2000, section 3, equation 1 (with `s_j` for the summand), generalised to unequal weights; inversion of a
/// prefix sum with the excluded parts cut out.
///
/// # Example
/// ```
/// use photon_map::{ContributingLights, LightTable};
/// let table = LightTable::new(&[1.0, 2.0, 4.0, 1.0])?;
/// assert_eq!(table.sample(0.5), (2, 0.5));
/// let contributing = ContributingLights::from_lights(4, [2]);
/// assert_eq!(table.others(&contributing).sample(0.3), Some((1, 0.5)));
/// # Ok::<(), photon_map::LightTableError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LightTable {
    /// Sums of the weights before each light, and of all.
    prefix: Vec<u64>,
}

/// Why there is no such table.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LightTableError {
    /// No light, or more than `2^30`.
    #[error("a table of {0} lights: there must be at least one, and at most 2^30")]
    Count(usize),
    /// A weight that is not positive and finite: a light of probability zero would be missing from the estimate.
    #[error("light {light} has the weight {weight}, which is not positive and finite")]
    Weight {
        /// The light.
        light: usize,
        /// Its weight.
        weight: f64,
    },
    /// Powers and importance of different numbers of lights.
    #[error("{powers} lights have power, {importance} have importance")]
    Lengths {
        /// Number of powers.
        powers: usize,
        /// Number of importances.
        importance: usize,
    },
    /// A share that leaves nothing to the original probabilities.
    #[error("the share of guided choices lies in [0, 1), not at {0}")]
    Share(f64),
}

impl LightTable {
    /// Lights with these weights.
    ///
    /// # Errors
    /// [`LightTableError`] if there is no light or more than `2^30`, or a weight is not positive and finite.
    pub fn new(weights: &[f64]) -> Result<Self, LightTableError> {
        if weights.is_empty() || weights.len() > 1 << 30 {
            return Err(LightTableError::Count(weights.len()));
        }
        if let Some(light) = weights.iter().position(|&weight| !(weight > 0.0 && weight.is_finite())) {
            return Err(LightTableError::Weight { light, weight: weights[light] });
        }
        let largest = weights.iter().copied().fold(0.0, f64::max);
        let mut prefix = Vec::with_capacity(weights.len() + 1);
        let mut sum = 0;
        prefix.push(sum);
        for weight in weights {
            // The division first: weight * UNITS may overflow.
            sum += ((weight / largest * UNITS).round() as u64).max(1);
            prefix.push(sum);
        }
        Ok(Self { prefix })
    }

    /// Equal weights: Keller and Wald's equation 1.
    ///
    /// # Errors
    /// [`LightTableError::Count`] if there is no light or more than `2^30`.
    pub fn uniform(lights: usize) -> Result<Self, LightTableError> {
        if lights == 0 || lights > 1 << 30 {
            return Err(LightTableError::Count(lights));
        }
        Ok(Self { prefix: (0..=lights as u64).map(|light| light << 32).collect() })
    }

    /// Where paths of photons begin when importance guides them: the original choice by power, mixed with one by
    /// importance.
    ///
    /// ```text
    /// P(j) = (1 - b) power_j / sum power + b importance_j / sum importance
    /// ```
    ///
    /// `b` in `[0, 1)`: the share that is guided. **Unbiased** if each path's flux is `power_j / P(j)`, whatever the
    /// importance, since every light keeps `(1 - b)` of its original probability. Importance that is negative,
    /// infinite or NaN counts as zero; if all is zero, the choice is by power. Source: Peter and Pietrek 1998, where
    /// `b = 1`.
    ///
    /// # Errors
    /// [`LightTableError`]; powers must be positive and finite.
    pub fn guided(powers: &[f64], importance: &[f64], share: f64) -> Result<Self, LightTableError> {
        if powers.len() != importance.len() {
            return Err(LightTableError::Lengths { powers: powers.len(), importance: importance.len() });
        }
        if !(0.0..1.0).contains(&share) {
            return Err(LightTableError::Share(share));
        }
        let usable = |weight: f64| if weight > 0.0 && weight.is_finite() { weight } else { 0.0 };
        let sum = |weights: &[f64]| weights.iter().map(|&weight| usable(weight)).sum::<f64>();
        let (power, guided) = (sum(powers), sum(importance));
        let share = if guided > 0.0 && guided.is_finite() { share } else { 0.0 };
        let mixed = powers.iter().zip(importance).map(|(&own, &important)| {
            let guidance = if share > 0.0 { share * usable(important) / guided } else { 0.0 };
            // An unusable power stays visible to the check of `new`.
            (1.0 - share) * own / power + guidance
        });
        let mixed: Vec<f64> = mixed.collect();
        Self::new(&mixed).map_err(|error| match error {
            LightTableError::Weight { light, .. } => LightTableError::Weight { light, weight: powers[light] },
            other => other,
        })
    }

    /// The number of lights.
    #[must_use]
    pub fn len(&self) -> usize {
        self.prefix.len() - 1
    }

    /// Never: there is at least one light.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    fn total(&self) -> u64 {
        self.prefix[self.len()]
    }

    /// The weight of a light in the table's units; zero for a light that does not exist.
    #[must_use]
    pub fn weight(&self, light: u32) -> u64 {
        let light = light as usize;
        if light < self.len() { self.prefix[light + 1] - self.prefix[light] } else { 0 }
    }

    /// The probability of a light; zero for a light that does not exist.
    #[must_use]
    pub fn probability(&self, light: u32) -> f64 {
        self.weight(light) as f64 / self.total() as f64
    }

    /// A light with its probability.
    ///
    /// `u`: uniform in `[0, 1)`. Numbers of `b` bits choose lights of probability below `2^-b` too often or never.
    #[must_use]
    pub fn sample(&self, u: f64) -> (u32, f64) {
        let light = self.light_at(whole(u, self.total()));
        (light, self.probability(light))
    }

    /// The lights that are not among the contributing ones.
    #[must_use]
    pub fn others(&self, contributing: &ContributingLights) -> OtherLights<'_> {
        let mut excluded = Excluded::default();
        excluded.set(self, contributing);
        OtherLights { table: self, excluded }
    }

    /// A light that is not excluded, with its probability; `None` if all are.
    pub(super) fn sample_outside(&self, excluded: &Excluded, u: f64) -> Option<(u32, f64)> {
        let rest = self.total() - excluded.sum;
        if rest == 0 {
            return None;
        }
        let at = whole(u, rest);
        // Skip the excluded lights before the place: those of which the others before them do not reach beyond it.
        let skipped = excluded.lights.partition_point(|&(light, before)| self.prefix[light as usize] - before <= at);
        let before = excluded.lights.get(skipped).map_or(excluded.sum, |&(_, before)| before);
        let light = self.light_at(at + before);
        Some((light, self.weight(light) as f64 / rest as f64))
    }

    /// The light whose part of the prefix sum holds a place.
    fn light_at(&self, place: u64) -> u32 {
        (self.prefix.partition_point(|&before| before <= place) - 1) as u32
    }
}

/// A whole number below `total` from a number of `[0, 1)`; NaN gives zero.
fn whole(u: f64, total: u64) -> u64 {
    ((u * total as f64) as u64).min(total - 1)
}

/// The lights of a table that do not contribute, see [`LightTable::others`].
#[derive(Clone, Debug)]
pub struct OtherLights<'a> {
    table: &'a LightTable,
    excluded: Excluded,
}

impl OtherLights<'_> {
    /// One of them, with its probability; `None` if all lights contribute.
    ///
    /// `u` as in [`LightTable::sample`].
    #[must_use]
    pub fn sample(&self, u: f64) -> Option<(u32, f64)> {
        self.table.sample_outside(&self.excluded, u)
    }
}

/// Lights to be left out, in ascending order.
#[derive(Clone, Debug, Default)]
pub(super) struct Excluded {
    /// Each with the weight of those before it.
    lights: Vec<(u32, u64)>,
    sum: u64,
}

impl Excluded {
    /// Leaves out the contributing lights; those that the table does not have cannot be drawn anyway.
    pub(super) fn set(&mut self, table: &LightTable, contributing: &ContributingLights) {
        self.lights.clear();
        self.sum = 0;
        for &(light, _) in contributing.as_slice().iter().take_while(|(light, _)| (*light as usize) < table.len()) {
            self.lights.push((light, self.sum));
            self.sum += table.weight(light);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Weights that are whole numbers, so that a grid of numbers meets every light exactly as often as it should.
    fn counts(table: &LightTable, contributing: &ContributingLights, places: u32) -> Vec<u32> {
        let mut counts = vec![0; table.len()];
        for i in 0..places {
            let u = (f64::from(i) + 0.5) / f64::from(places);
            if let Some((light, probability)) = table.others(contributing).sample(u) {
                counts[light as usize] += 1;
                let rest: u64 =
                    (0..table.len() as u32).filter(|&l| !contributing.contains(l)).map(|l| table.weight(l)).sum();
                assert_eq!(probability, table.weight(light) as f64 / rest as f64);
            }
        }
        counts
    }

    proptest! {
        #[test]
        fn others_are_chosen_by_their_weights_and_the_contributing_never(
            exponents in prop::collection::vec(0_u32..4, 1..20),
            excluded in prop::collection::vec(any::<bool>(), 20),
        ) {
            let weights: Vec<f64> = exponents.iter().map(|&e| f64::from(1 << e)).collect();
            let table = LightTable::new(&weights).unwrap();
            let excluded = (0..weights.len() as u32).filter(|&light| excluded[light as usize]);
            let contributing = ContributingLights::from_lights(table.len(), excluded);
            let others = |light: u32| !contributing.contains(light);
            let rest: f64 = (0..).zip(&weights).filter(|(light, _)| others(*light)).map(|(_, weight)| weight).sum();
            let found = counts(&table, &contributing, (rest as u32).max(1) * 4);
            let expected = |(light, weight): (u32, &f64)| if others(light) { 4 * *weight as u32 } else { 0 };
            prop_assert_eq!(found, (0..).zip(&weights).map(expected).collect::<Vec<_>>());
        }
    }

    #[test]
    fn nothing_cancels_when_nearly_everything_is_excluded() {
        let mut weights = vec![1e9; 1000];
        weights[500] = 1e-6;
        weights[501] = 3.0;
        let table = LightTable::new(&weights).unwrap();
        let lights = (0..1000).filter(|&light| light != 500 && light != 501);
        let contributing = ContributingLights::from_lights(table.len(), lights);
        let (_, least) = table.others(&contributing).sample(0.0).unwrap();
        let (light, most) = table.others(&contributing).sample(0.5).unwrap();
        assert!(least > 0.0 && light == 501 && (least + most - 1.0).abs() < 1e-15);
        let all = ContributingLights::from_lights(table.len(), 0..1000);
        assert_eq!(table.others(&all).sample(0.3), None);
    }

    #[test]
    fn sets_of_other_scenes_exclude_what_the_table_has() {
        let table = LightTable::uniform(3).unwrap();
        let larger = ContributingLights::from_lights(10, [1, 3, 9]);
        assert_eq!(table.others(&larger).sample(0.9), Some((2, 0.5)));
        let smaller = ContributingLights::from_lights(1, [0]);
        assert_eq!(table.others(&smaller).sample(0.0), Some((1, 0.5)));
    }

    #[test]
    fn every_light_has_a_probability() {
        let table = LightTable::new(&[1e-300, 1e300]).unwrap();
        assert!(table.probability(0) > 0.0);
        assert_eq!(table.probability(2), 0.0);
        assert_eq!(table.sample(f64::NAN).0, 0);
        assert_eq!((table.len(), table.is_empty()), (2, false));
        let uniform = LightTable::uniform(3).unwrap();
        assert_eq!(uniform.sample(0.5), (1, 1.0 / 3.0));
        for weight in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(LightTable::new(&[1.0, weight]), Err(LightTableError::Weight { light: 1, .. })));
        }
        assert!(matches!(LightTable::new(&[]), Err(LightTableError::Count(0))));
        assert!(matches!(LightTable::uniform(0), Err(LightTableError::Count(0))));
    }

    #[test]
    fn guided_choices_keep_every_light() {
        let table = LightTable::guided(&[1.0, 3.0], &[0.0, 5.0], 0.5).unwrap();
        assert!((table.probability(0) - 0.125).abs() < 1e-9);
        let unguided = LightTable::guided(&[1.0, 3.0], &[f64::NAN, 0.0], 0.5).unwrap();
        assert!((unguided.probability(0) - 0.25).abs() < 1e-9);
        assert!(matches!(LightTable::guided(&[1.0], &[], 0.5), Err(LightTableError::Lengths { .. })));
        assert!(matches!(LightTable::guided(&[1.0], &[1.0], 1.0), Err(LightTableError::Share(_))));
        assert!(matches!(
            LightTable::guided(&[1.0, f64::NAN], &[1.0, 1.0], 0.5),
            Err(LightTableError::Weight { light: 1, .. })
        ));
    }
}
