//! Ways to find neighbours.

use std::sync::OnceLock;

use range_search::{BruteForce, BuildError, HashGrid, RangeIndex};

use super::PathSpaceFilter;
use super::grid;
use super::mean::{Counted, Mean, Rule, over_squared};
use super::prepared::{Iterated, Prepared};
use crate::{Contribution, Kernel, Modulation, PathVertex, Similarity, parallel};

/// How neighbours are found. All find the same ones; averages differ by round-off, since sums run in another order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Search {
    /// Hash grids, one for each order of magnitude of the radii: the fastest.
    #[default]
    Grid,
    /// No index: queries are halved until there are few points left. For radii that hardly vary, since it looks as far as the largest.
    DivideAndConquer,
    /// A k-d tree.
    #[cfg(feature = "kiddo")]
    KdTree,
    /// A bounding volume hierarchy.
    #[cfg(feature = "obvhs")]
    Hierarchy,
    /// All pairs: the oracle of the others.
    BruteForce,
}

/// What a search has built.
pub(super) enum Searched {
    /// Built when they are asked, and not kept.
    Grid,
    DivideAndConquer,
    Index(Box<dyn Finder>),
    /// More vertices than an index can name.
    Nothing,
}

impl Searched {
    pub(super) fn new<F, C>(search: Search, prepared: &Prepared<F, C>) -> Self {
        let positions = &prepared.positions;
        match search {
            Search::Grid => Self::Grid,
            Search::DivideAndConquer => Self::DivideAndConquer,
            #[cfg(feature = "kiddo")]
            Search::KdTree => Self::index(range_search::KdTree::build(positions, |x| *x)),
            #[cfg(feature = "obvhs")]
            Search::Hierarchy => Self::index(range_search::Bvh::build(positions, |x| *x)),
            Search::BruteForce => Self::index(BruteForce::build(positions, |x| *x)),
        }
    }

    fn index(built: Result<impl RangeIndex + Sync + 'static, BuildError>) -> Self {
        built.map_or(Self::Nothing, |index| Self::Index(Box::new(index)))
    }

    pub(super) fn averages<V, C, S, K>(&self, prepared: &Prepared<S::Features, C>, rule: &Rule<'_, S, K>) -> Iterated<C>
    where
        C: Contribution + Send + Sync,
        S: Similarity<V> + Sync,
        S::Features: Clone + Send + Sync,
        K: Kernel + Sync,
    {
        match self {
            Self::Grid => grid::averages(prepared, rule),
            Self::DivideAndConquer => divide_and_conquer(prepared, rule),
            Self::Index(index) => with_index(&**index, prepared, rule),
            Self::Nothing => (prepared.values.clone(), vec![1; prepared.values.len()]),
        }
    }
}

/// An index as an object: one copy of the code for all of them, and a call for each neighbour, which only grids are too fast for.
pub(super) trait Finder: Sync {
    /// Calls `f` with id and squared distance of all within the radius.
    fn find(&self, center: [f32; 3], radius: f32, f: &mut dyn FnMut(usize, f32));
}

impl<I: RangeIndex + Sync> Finder for I {
    fn find(&self, center: [f32; 3], radius: f32, f: &mut dyn FnMut(usize, f32)) {
        self.for_each_within(center, radius, f);
    }
}

/// The average of each vertex, one query after the other.
pub(super) fn with_index<V, C, S, K>(
    index: &dyn Finder,
    prepared: &Prepared<S::Features, C>,
    rule: &Rule<'_, S, K>,
) -> Iterated<C>
where
    C: Contribution + Send + Sync,
    S: Similarity<V> + Sync,
    S::Features: Clone + Send + Sync,
    K: Kernel + Sync,
{
    let mean = |i: usize| {
        if !prepared.takes_part(i) {
            return prepared.own(i, None);
        }
        let (features, over) = (&prepared.features[i], over_squared(prepared.radii[i]));
        let mut mean = Mean::new();
        index.find(prepared.positions[i], prepared.radii[i], &mut |j, distance_squared| {
            // An index of the caller's may hold what takes no part.
            if !prepared.takes_part(j) {
                return;
            }
            let weight = rule.weight(features, &prepared.features[j], distance_squared * over, i == j);
            mean.add(weight, prepared.values[j]);
        });
        prepared.own(i, mean.finish())
    };
    parallel::map_range(prepared.values.len(), mean).into_iter().unzip()
}

fn divide_and_conquer<V, C, S, K>(prepared: &Prepared<S::Features, C>, rule: &Rule<'_, S, K>) -> Iterated<C>
where
    C: Contribution + Send + Sync,
    S: Similarity<V> + Sync,
    S::Features: Clone + Send + Sync,
    K: Kernel + Sync,
{
    let found: Vec<OnceLock<Counted<C>>> = prepared.values.iter().map(|_| OnceLock::new()).collect();
    let widest = prepared.radii.iter().fold(-1.0_f32, |widest, &radius| widest.max(radius));
    let visit = |i: usize, neighbours: &[range_search::Neighbour]| {
        let (features, radius) = (&prepared.features[i], prepared.radii[i]);
        let over = over_squared(radius);
        let mut mean = Mean::new();
        for neighbour in neighbours {
            let (j, distance_squared) = (neighbour.id(), neighbour.distance_squared());
            // Those that a smaller radius finds; none if it is negative or NaN.
            if radius >= 0.0 && distance_squared <= radius * radius {
                let weight = rule.weight(features, &prepared.features[j], distance_squared * over, i == j);
                mean.add(weight, prepared.values[j]);
            }
        }
        if let Some(mean) = mean.finish() {
            // Every query is answered once.
            let _ = found[i].set(mean);
        }
    };
    divide(&prepared.positions, widest, &visit);
    found.into_iter().enumerate().map(|(i, found)| prepared.own(i, found.into_inner())).unzip()
}

/// Visits the neighbours of all positions. Of too many there are none, and everybody keeps what they have.
fn divide(positions: &[[f32; 3]], radius: f32, visit: &(dyn Fn(usize, &[range_search::Neighbour]) + Sync)) {
    #[cfg(feature = "rayon")]
    let _ = range_search::par_divide_and_conquer(positions, |x| *x, positions, |x| *x, radius, visit);
    #[cfg(not(feature = "rayon"))]
    let _ = range_search::divide_and_conquer(positions, |x| *x, positions, |x| *x, radius, visit);
}

/// The averages at queries without contributions.
pub(super) fn at_queries<V, S, K, M>(
    filter: &PathSpaceFilter<S, K, M>,
    prepared: &Prepared<S::Features, V::Contribution>,
    queries: &[V],
    batch: u64,
) -> Vec<Option<V::Contribution>>
where
    V: PathVertex + Sync,
    V::Contribution: Send + Sync,
    S: Similarity<V> + Sync,
    S::Features: Clone + Send + Sync,
    K: Kernel + Sync,
    M: Modulation<V> + Sync,
{
    let shrinkage = filter.radius().shrinkage(batch);
    let radii = parallel::map(queries, |query| filter.radius().at(1, query.path_length()) * shrinkage);
    let asked = Asked { filter, prepared, queries, radii };
    let found = match Searched::new(filter.search, prepared) {
        Searched::Grid | Searched::DivideAndConquer => asked.of_grids(),
        Searched::Index(index) => Some(parallel::map_range(queries.len(), |i| asked.mean(&*index, i))),
        Searched::Nothing => None,
    };
    found.unwrap_or_else(|| vec![None; queries.len()])
}

/// Queries with what they ask.
struct Asked<'a, V: PathVertex, S: Similarity<V>, K, M> {
    filter: &'a PathSpaceFilter<S, K, M>,
    prepared: &'a Prepared<S::Features, V::Contribution>,
    queries: &'a [V],
    radii: Vec<f32>,
}

impl<V, S, K, M> Asked<'_, V, S, K, M>
where
    V: PathVertex + Sync,
    V::Contribution: Send + Sync,
    S: Similarity<V> + Sync,
    S::Features: Clone + Send + Sync,
    K: Kernel + Sync,
    M: Modulation<V> + Sync,
{
    /// One grid for each order of magnitude.
    fn of_grids(&self) -> Option<Vec<Option<V::Contribution>>> {
        let (level_of, sizes) = grid::divide(&self.radii);
        let grids: Option<Vec<HashGrid>> = sizes.iter().map(|&s| grid::build(&self.prepared.positions, s)).collect();
        let grids = grids?;
        Some(parallel::map_range(self.queries.len(), |i| self.mean(&grids[level_of[i]], i)))
    }

    fn mean(&self, index: &dyn Finder, i: usize) -> Option<V::Contribution> {
        let (query, over) = (&self.queries[i], over_squared(self.radii[i]));
        let (rule, prepared) = (self.filter.rule(), self.prepared);
        let features = self.filter.similarity.features(query);
        let mut mean = Mean::new();
        index.find(query.position(), self.radii[i], &mut |j, distance_squared| {
            let weight = rule.weight(&features, &prepared.features[j], distance_squared * over, false);
            mean.add(weight, prepared.values[j]);
        });
        mean.finish().map(|(mean, _)| self.filter.modulation.remodulate(query, mean))
    }
}
