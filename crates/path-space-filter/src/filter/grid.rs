//! Neighbours by a grid for each order of magnitude of the radius.

use range_search::{HashGrid, Neighbourhood};

use super::mean::{Counted, Mean, Rule, over_squared};
use super::prepared::{Iterated, Prepared};
use crate::{Contribution, Kernel, Similarity, parallel};

/// Radii of a level differ by this factor at most.
const RATIO: f32 = 4.0;
/// Levels at most; the last one takes all smaller radii.
const LEVELS: usize = 8;
/// A level with fewer than this part of the vertices is not worth a grid of its own.
const SMALLEST_PART: usize = 32;

/// Slots that a task takes.
const PART: usize = 1 << 12;

/// A grid over all vertices, for those whose radius is about its cell size.
struct Level<F> {
    grid: HashGrid,
    /// In the order of slots; negative where the vertex asks another level.
    radii: Vec<f32>,
    features: Vec<F>,
}

/// Builds them one after the other, coarsest first: only one of them takes memory at a time.
fn levels<F: Clone + Send + Sync, C>(prepared: &Prepared<F, C>) -> impl Iterator<Item = Level<F>> {
    let (level_of, sizes) = divide(&prepared.radii);
    sizes.into_iter().enumerate().filter_map(move |(number, size)| {
        let grid = build(&prepared.positions, size)?;
        let radii = grid.order().map(|id| if level_of[id] == number { prepared.radii[id] } else { -1.0 }).collect();
        let features = grid.reorder(&prepared.features);
        Some(Level { grid, radii, features })
    })
}

/// Nothing if there are more points than ids.
pub(super) fn build(positions: &[[f32; 3]], size: f32) -> Option<HashGrid> {
    #[cfg(feature = "rayon")]
    return HashGrid::par_build(positions, |x| *x, size).ok();
    #[cfg(not(feature = "rayon"))]
    HashGrid::build(positions, |x| *x, size).ok()
}

/// The level of each radius, and the cell sizes of the levels.
pub(super) fn divide(radii: &[f32]) -> (Vec<usize>, Vec<f32>) {
    // Radii that matter for the size of cells: not those that find nobody, or everybody.
    let usual = |r: &&f32| **r > 1e-30 && **r < 1e18;
    let (min, max) = radii.iter().filter(usual).fold((f32::INFINITY, 0.0_f32), |(a, b), &r| (a.min(r), b.max(r)));
    if max == 0.0 {
        return (vec![0; radii.len()], vec![1.0]);
    }
    if max <= RATIO * min {
        return (vec![0; radii.len()], vec![(min * max).sqrt()]);
    }
    // Which order of magnitude.
    let rank =
        |r: f32| if r > 0.0 { ((max / r).ln() / RATIO.ln()).clamp(0.0, LEVELS as f32 - 1.0) as usize } else { 0 };
    let mut counts = [0_usize; LEVELS];
    radii.iter().for_each(|&r| counts[rank(r)] += 1);
    // Few of one go to the next coarser one.
    let mut target: [usize; LEVELS] = core::array::from_fn(|level| level);
    for level in (1..LEVELS).rev() {
        if counts[level] < radii.len() / SMALLEST_PART + 1 {
            counts[level - 1] += core::mem::take(&mut counts[level]);
            target[level] = level - 1;
        }
    }
    for level in 1..LEVELS {
        target[level] = target[target[level]];
    }
    // Number those that are left.
    let (mut number, mut sizes) = ([0; LEVELS], Vec::new());
    for level in 0..LEVELS {
        if counts[level] > 0 {
            number[level] = sizes.len();
            sizes.push(max * RATIO.powf(-(level as f32) - 0.5));
        }
    }
    (radii.iter().map(|&r| number[target[rank(r)]]).collect(), sizes)
}

/// The average of each vertex.
pub(super) fn averages<V, C, S, K>(prepared: &Prepared<S::Features, C>, rule: &Rule<'_, S, K>) -> Iterated<C>
where
    C: Contribution + Send + Sync,
    S: Similarity<V> + Sync,
    S::Features: Clone + Send + Sync,
    K: Kernel + Sync,
{
    let (mut means, mut counts) = (prepared.values.clone(), vec![1; prepared.values.len()]);
    for level in levels(prepared) {
        let values = level.grid.reorder(&prepared.values);
        let query = level.grid.self_query(|slot: usize| level.radii[slot]);
        let of_part = |part: usize| {
            let slots = part * PART..level.radii.len().min((part + 1) * PART);
            let mut found: Vec<Option<Counted<C>>> = Vec::with_capacity(slots.len());
            query.for_each_in(slots, |neighbourhood| found.push(level.mean(&values, rule, &neighbourhood)));
            found
        };
        let found = parallel::map_parts(level.radii.len().div_ceil(PART), of_part);
        for (id, found) in level.grid.order().zip(found.into_iter().flatten()) {
            if let Some(found) = found {
                (means[id], counts[id]) = found;
            }
        }
    }
    (means, counts)
}

impl<F> Level<F> {
    #[inline]
    fn mean<V, C, S, K>(
        &self,
        values: &[C],
        rule: &Rule<'_, S, K>,
        neighbourhood: &Neighbourhood<'_>,
    ) -> Option<Counted<C>>
    where
        C: Contribution,
        S: Similarity<V, Features = F>,
        K: Kernel,
    {
        let center = neighbourhood.slot();
        let over = over_squared(self.radii[center]);
        let features = &self.features[center];
        let mut mean = Mean::new();
        for (&slot, distance_squared) in neighbourhood.slots().iter().zip(neighbourhood.distances_squared()) {
            let slot = slot as usize;
            let weight = rule.weight(features, &self.features[slot], distance_squared * over, slot == center);
            mean.add(weight, values[slot]);
        }
        mean.finish()
    }
}
