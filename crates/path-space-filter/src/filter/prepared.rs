//! A batch in the form that averages read.

use super::PathSpaceFilter;
use super::mean::Counted;
use crate::averages::Counts;
use crate::modulation::takes_part;
use crate::{Averages, Contribution, Modulation, PathVertex, Similarity, parallel};

/// Vertices taken apart, in their order.
pub(super) struct Prepared<F, C> {
    /// NaN if the vertex takes no part, so that no index finds it.
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) radii: Vec<f32>,
    pub(super) features: Vec<F>,
    /// What is averaged next.
    pub(super) values: Vec<C>,
}

/// What an iteration made of each vertex, and of how many contributions.
pub(super) type Iterated<C> = (Vec<C>, Vec<u32>);

impl<F: Clone + Send + Sync, C: Contribution + Send + Sync> Prepared<F, C> {
    pub(super) fn new<V, S, K, M>(filter: &PathSpaceFilter<S, K, M>, vertices: &[V], batch: u64) -> Self
    where
        V: PathVertex<Contribution = C> + Sync,
        S: Similarity<V, Features = F> + Sync,
        M: Modulation<V> + Sync,
        K: Sync,
    {
        let values = parallel::map(vertices, |vertex| filter.modulation.demodulate(vertex));
        let position = |i: usize| {
            let part = takes_part(&vertices[i]) && values[i].is_finite();
            if part { vertices[i].position() } else { [f32::NAN; 3] }
        };
        let shrinkage = filter.radius.shrinkage(batch);
        Self {
            positions: parallel::map_range(vertices.len(), position),
            radii: parallel::map(vertices, |vertex| filter.radius.at(1, vertex.path_length()) * shrinkage),
            features: parallel::map(vertices, |vertex| filter.similarity.features(vertex)),
            values,
        }
    }

    /// Whether the vertex takes part.
    pub(super) fn takes_part(&self, i: usize) -> bool {
        !self.positions[i][0].is_nan()
    }

    /// Averages as often as the filter says, and brings the averages back to the vertices' colours.
    pub(super) fn iterate<V, S, K, M>(
        mut self,
        filter: &PathSpaceFilter<S, K, M>,
        vertices: &[V],
        mut averages: impl FnMut(&Self) -> Iterated<C>,
    ) -> Averages<C>
    where
        V: PathVertex<Contribution = C> + Sync,
        M: Modulation<V> + Sync,
        S: Sync,
        K: Sync,
    {
        let mut counts = vec![1; vertices.len()];
        for _ in 0..filter.iterations {
            (self.values, counts) = averages(&self);
        }
        // A vertex that is alone keeps its contribution bit for bit.
        let finish = |i: usize| match counts[i] {
            0 | 1 => vertices[i].contribution(),
            _ => filter.modulation.remodulate(&vertices[i], self.values[i]),
        };
        let values = parallel::map_range(vertices.len(), finish);
        let mut all = Counts::default();
        (0..vertices.len()).filter(|&i| self.takes_part(i)).for_each(|i| all.add(counts[i]));
        Averages { values, counts: all }
    }

    /// What is kept where nothing is averaged.
    pub(super) fn own(&self, i: usize, found: Option<Counted<C>>) -> Counted<C> {
        found.unwrap_or((self.values[i], 1))
    }
}
