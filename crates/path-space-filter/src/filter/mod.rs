//! Equation 1.

mod grid;
mod mean;
mod prepared;
mod screen;
mod search;

use range_search::RangeIndex;

pub use screen::{Screen, ScreenError};
pub use search::Search;

use crate::{AsStored, Averages, Ball, Everything, Kernel, Modulation, PathVertex, Radius, Similarity};
use mean::Rule;
use prepared::Prepared;

/// A filter over the vertices of a batch. Implemented by [`PathSpaceFilter`] and [`JitteredHash`](crate::JitteredHash).
///
/// Dyn compatible: `&dyn PathFilter<V>`.
pub trait PathFilter<V: PathVertex> {
    /// The average of each vertex, among all of them, in batch number `batch`, counted from 1.
    fn average(&self, vertices: &[V], batch: u64) -> Averages<V::Contribution>;

    /// The average at queries that have no contribution of their own, such as those of more camera paths for anti-aliasing; what
    /// [`PathVertex::contribution`] says of them is not looked at. `None` where there is nothing to average: such a
    /// query is left out of the image, it is not black.
    fn average_at(&self, queries: &[V], vertices: &[V], batch: u64) -> Vec<Option<V::Contribution>>;

    /// An upper bound of the memory that [`average`](Self::average) takes per vertex, beyond the vertices themselves, in bytes.
    fn bytes_per_vertex(&self) -> usize;
}

// Its docs say so.
const _: Option<&dyn PathFilter<crate::Vertex<f32>>> = None;

/// Path space filtering: consistent weighted averages of the contributions of path vertices.
///
/// ```text
/// mean_i = sum_j X(x_j - x_i) w_ij c_j  /  sum_j X(x_j - x_i) w_ij            (1)
/// ```
/// **Symbols.** `j` runs through the batch; `x_i`: position of vertex `i`; `c_j`: contribution of the light path towards `x_j`; `X`: characteristic
/// function of the ball of radius `r(n)`, a [`Radius`]; `w_ij`: [`Similarity`]. The image sums up attenuation times `mean_i`.
///
/// **Assumptions.** None for consistency but contributions of finite variance. For the noise to fall, that neighbours' contributions are about as if they had been made
/// here.
///
/// **Consistent, not unbiased.** The centre is always included, whatever its weight, and the radius vanishes: `mean_i` becomes `c_i`. Before that, light blurs
/// within the radius and the similarity. Linear in the contributions. With binary weights the average of `K` independent contributions of variance `s^2` has
/// variance `s^2 / K`.
///
/// **Bad input.** A vertex whose position or contribution is not finite keeps what it has, and nobody averages it.
///
/// **Cost.** A range search and a weight for each pair of neighbours: linear in the number of vertices for a given number of neighbours.
///
/// **Source.** A. Keller, K. Dahm, N. Binder, *Path Space Filtering*, Monte Carlo and Quasi-Monte Carlo Methods 2014.
///
/// # Example
/// ```
/// use path_space_filter::{AlbedoDifference, NormalCone, PathFilter, PathSpaceFilter, Radius, SimilarityExt, Vertex};
/// let vertex = |x: f32, normal, contribution| {
///     Vertex { position: [x, 0.0, 0.0], normal, contribution, ..Vertex::default() }
/// };
/// let up = [0.0, 0.0, 1.0];
/// let vertices = [vertex(0.0, up, 1.0), vertex(0.1, up, 3.0), vertex(0.2, [0.0, 1.0, 0.0], 100.0), vertex(5.0, up, 7.0_f32)];
///
/// let filter = PathSpaceFilter::new(Radius::absolute(1.0)?).similarity(NormalCone::PAPER.and(AlbedoDifference::PAPER));
/// let averages = filter.average(&vertices, 1);
/// assert_eq!(averages.values(), [2.0, 2.0, 100.0, 7.0]);
/// # Ok::<(), path_space_filter::RadiusError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct PathSpaceFilter<S = Everything, K = Ball, M = AsStored> {
    radius: Radius,
    similarity: S,
    kernel: K,
    modulation: M,
    iterations: u32,
    search: Search,
}

impl PathSpaceFilter {
    /// Averages everything in the ball alike, once.
    pub fn new(radius: Radius) -> Self {
        Self { radius, similarity: Everything, kernel: Ball, modulation: AsStored, iterations: 1, search: Search::Grid }
    }
}

impl<S, K, M> PathSpaceFilter<S, K, M> {
    /// Weighs by similarity.
    pub fn similarity<T>(self, similarity: T) -> PathSpaceFilter<T, K, M> {
        let Self { radius, kernel, modulation, iterations, search, .. } = self;
        PathSpaceFilter { radius, similarity, kernel, modulation, iterations, search }
    }

    /// Weighs by distance: for comparison, see [`Kernel`].
    pub fn kernel<L>(self, kernel: L) -> PathSpaceFilter<S, L, M> {
        let Self { radius, similarity, modulation, iterations, search, .. } = self;
        PathSpaceFilter { radius, similarity, kernel, modulation, iterations, search }
    }

    /// Leaves surface colour out of the average: [`Demodulated`](crate::Demodulated).
    pub fn modulation<N>(self, modulation: N) -> PathSpaceFilter<S, K, N> {
        let Self { radius, similarity, kernel, iterations, search, .. } = self;
        PathSpaceFilter { radius, similarity, kernel, modulation, iterations, search }
    }

    /// Averages the averages, so many times in all: smoother at the cost of detail, as if the radius was about the square root of the number times as large.
    /// 0 changes nothing at all. Consistent just the same.
    #[must_use]
    pub fn iterations(self, iterations: u32) -> Self {
        Self { iterations, ..self }
    }

    /// Looks for neighbours in another way. Averages agree up to round-off.
    #[must_use]
    pub fn search(self, search: Search) -> Self {
        Self { search, ..self }
    }

    /// The radius.
    pub fn radius(&self) -> Radius {
        self.radius
    }

    fn rule(&self) -> Rule<'_, S, K> {
        Rule { similarity: &self.similarity, kernel: &self.kernel }
    }

    /// The average of each vertex, with an index of yours over the positions of the vertices, whose ids are positions in this slice.
    pub fn average_with<V, I>(&self, index: &I, vertices: &[V], batch: u64) -> Averages<V::Contribution>
    where
        V: PathVertex + Sync,
        V::Contribution: Send + Sync,
        S: Similarity<V> + Sync,
        S::Features: Send + Sync,
        K: Kernel + Sync,
        M: Modulation<V> + Sync,
        I: RangeIndex + Sync,
    {
        let prepared = Prepared::new(self, vertices, batch);
        prepared.iterate(self, vertices, |prepared| search::with_index(index, prepared, &self.rule()))
    }

    /// The average of each vertex among those in the neighbourhood of its pixel: a part of the pairs that the other searches find, at the cost of none.
    /// Vertices outside of the screen keep what they have.
    pub fn average_on_screen<V>(&self, screen: &Screen, vertices: &[V], batch: u64) -> Averages<V::Contribution>
    where
        V: PathVertex + crate::HasPixel + Sync,
        V::Contribution: Send + Sync,
        S: Similarity<V> + Sync,
        S::Features: Send + Sync,
        K: Kernel + Sync,
        M: Modulation<V> + Sync,
    {
        let prepared = Prepared::new(self, vertices, batch);
        let pixels = screen.pixels(vertices);
        prepared.iterate(self, vertices, |prepared| pixels.averages(prepared, &self.rule()))
    }
}

impl<V, S, K, M> PathFilter<V> for PathSpaceFilter<S, K, M>
where
    V: PathVertex + Sync,
    V::Contribution: Send + Sync,
    S: Similarity<V> + Sync,
    S::Features: Send + Sync,
    K: Kernel + Sync,
    M: Modulation<V> + Sync,
{
    fn average(&self, vertices: &[V], batch: u64) -> Averages<V::Contribution> {
        let prepared = Prepared::new(self, vertices, batch);
        let searched = search::Searched::new(self.search, &prepared);
        prepared.iterate(self, vertices, |prepared| searched.averages(prepared, &self.rule()))
    }

    fn average_at(&self, queries: &[V], vertices: &[V], batch: u64) -> Vec<Option<V::Contribution>> {
        if self.iterations == 0 {
            return vec![None; queries.len()];
        }
        // All iterations but the last at the vertices themselves.
        let mut prepared = Prepared::new(self, vertices, batch);
        if self.iterations > 1 {
            let searched = search::Searched::new(self.search, &prepared);
            for _ in 1..self.iterations {
                prepared.values = searched.averages(&prepared, &self.rule()).0;
            }
        }
        search::at_queries(self, &prepared, queries, batch)
    }

    fn bytes_per_vertex(&self) -> usize {
        let (features, value) = (size_of::<S::Features>(), size_of::<V::Contribution>());
        // Position and radius; features and values in the order of vertices and in that of slots; the grid and what builds it; results.
        16 + 2 * (features + value) + 4 + 16 + 16 + 40 + 3 * (value + 4)
    }
}
