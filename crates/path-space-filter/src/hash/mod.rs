//! One average per hashed cell.

mod cells;
mod key;

pub use key::{CellKey, NoKey};

use crate::averages::Counts;
use crate::modulation::takes_part;
use crate::vertex::HasNormal;
use crate::{AsStored, Averages, Contribution, Modulation, PathFilter, PathVertex, Radius, parallel};
use cells::Cells;
use key::{Key, Quantizer};

/// Path space filtering by jittered spatial hashing: the average of a vertex is that of the cell into which it falls.
///
/// ```text
/// mean_i = sum c_j / |{j}|   over all j with key_j = key_i,
/// key = (floor((x + s xi) / s), level of s, rounded normal, key of the caller's)
/// ```
/// **Symbols.** `s`: edge length of the cells, `sqrt(pi) r(n)`, so that a cell cuts as much off a plane as the ball of the [`Radius`] does; it grows with the length of the camera path in
/// powers of two. `xi`: uniform in `[-1/2, 1/2)^2` in the tangent plane, another one for each vertex and batch (for each query of a call). It turns the edges of cells into noise, which pixels average.
///
/// **Assumptions.** As equation 1's; what would be a similarity weight is part of the key.
///
/// **Consistent, and more biased than equation 1** before the radius vanishes: the centre is not in the middle of what is averaged. A vertex averages over its jittered cell,
/// so that the mean over jitter is a tent twice as wide as the cell in place of a ball; normals and keys on either side of a rounding
/// boundary never mix, however alike; levels change by factors of two. The centre itself is always in its cell: alone, it keeps its contribution.
///
/// **Cost.** Linear, without a search: each vertex is written and read once, whatever the number of neighbours. Keys are compared whole: different cells do not mix, whatever
/// their hashes. Memory: 32 bytes per vertex and as much per cell.
///
/// **Source.** N. Binder, S. Fricke, A. Keller, *Fast Path Space Filtering by Jittered Spatial Hashing*, SIGGRAPH 2018 talks.
///
/// # Example
/// ```
/// use path_space_filter::{JitteredHash, PathFilter, Radius, Vertex};
/// let vertices: Vec<_> = (0..1000).map(|i| Vertex {
///     position: [0.01 * (i % 32) as f32, 0.01 * (i / 32) as f32, 0.0],
///     normal: [0.0, 0.0, 1.0],
///     contribution: if i % 2 == 0 { 0.0_f32 } else { 2.0 },
///     ..Vertex::default()
/// }).collect();
/// let averages = JitteredHash::new(Radius::absolute(0.05)?).average(&vertices, 1);
/// let deviation = |values: &[f32]| values.iter().map(|c| (c - 1.0).powi(2)).sum::<f32>() / values.len() as f32;
/// assert!(deviation(averages.values()) < 0.1); // from 1
/// # Ok::<(), path_space_filter::RadiusError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct JitteredHash<K = NoKey, M = AsStored> {
    radius: Radius,
    key: K,
    modulation: M,
    iterations: u32,
    #[cfg_attr(feature = "serde", serde(deserialize_with = "read_steps"))]
    normal_steps: u32,
}

/// Rounded normals fit a byte per coordinate.
const MOST_STEPS: u32 = 100;

/// As many as [`JitteredHash::normal_steps`] takes.
#[cfg(feature = "serde")]
fn read_steps<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
    <u32 as serde::Deserialize>::deserialize(deserializer).map(|steps| steps.min(MOST_STEPS))
}

impl JitteredHash {
    /// Cells by place and normal alone.
    pub fn new(radius: Radius) -> Self {
        Self { radius, key: NoKey, modulation: AsStored, iterations: 1, normal_steps: 2 }
    }
}

impl<K, M> JitteredHash<K, M> {
    /// Only vertices with the same key share a cell: object, quantised albedo, visibility, frame, ..
    pub fn key<L>(self, key: L) -> JitteredHash<L, M> {
        let Self { radius, modulation, iterations, normal_steps, .. } = self;
        JitteredHash { radius, key, modulation, iterations, normal_steps }
    }

    /// Leaves surface colour out of the average: [`Demodulated`](crate::Demodulated).
    pub fn modulation<N>(self, modulation: N) -> JitteredHash<K, N> {
        let Self { radius, key, iterations, normal_steps, .. } = self;
        JitteredHash { radius, key, modulation, iterations, normal_steps }
    }

    /// Averages the averages, so many times in all, with other jitter each time.
    #[must_use]
    pub fn iterations(self, iterations: u32) -> Self {
        Self { iterations, ..self }
    }

    /// Rounds the components of normals to multiples of `1/steps`: 2 unless set, 0 leaves normals out. At most 100.
    #[must_use]
    pub fn normal_steps(self, steps: u32) -> Self {
        Self { normal_steps: steps.min(MOST_STEPS), ..self }
    }

    fn quantizer(&self, batch: u64, iteration: u32) -> Quantizer {
        Quantizer::new(self.radius, self.normal_steps as f32, batch, iteration)
    }

    /// The key of each vertex; none if it takes no part.
    fn keys<V>(&self, vertices: &[V], values: &[V::Contribution], batch: u64, iteration: u32) -> Vec<Option<Key>>
    where
        V: PathVertex + HasNormal + Sync,
        V::Contribution: Sync,
        K: CellKey<V> + Sync,
        M: Sync,
    {
        let quantizer = self.quantizer(batch, iteration);
        parallel::map_range(vertices.len(), |i| {
            let part = takes_part(&vertices[i]) && values[i].is_finite();
            if part { quantizer.key(&vertices[i], i, self.key.key(&vertices[i])) } else { None }
        })
    }
}

impl<V, K, M> PathFilter<V> for JitteredHash<K, M>
where
    V: PathVertex + HasNormal + Sync,
    V::Contribution: Send + Sync,
    K: CellKey<V> + Sync,
    M: Modulation<V> + Sync,
{
    fn average(&self, vertices: &[V], batch: u64) -> Averages<V::Contribution> {
        let mut values = parallel::map(vertices, |vertex| self.modulation.demodulate(vertex));
        let mut counts = vec![0; vertices.len()];
        for iteration in 0..self.iterations {
            let keys = self.keys(vertices, &values, batch, iteration);
            let more = cells::averages(&keys, &mut values);
            counts.iter_mut().zip(more).for_each(|(count, more)| *count = more.max(*count));
        }
        let finish = |i: usize| match counts[i] {
            0 | 1 => vertices[i].contribution(),
            _ => self.modulation.remodulate(&vertices[i], values[i]),
        };
        let values = parallel::map_range(vertices.len(), finish);
        let mut all = Counts::default();
        // Without a key, and so without a count, are vertices that take no part, and all if there is no radius.
        for (&count, vertex) in counts.iter().zip(vertices) {
            if count > 0 || takes_part(vertex) {
                all.add(count.max(1));
            }
        }
        Averages { values, counts: all }
    }

    fn average_at(&self, queries: &[V], vertices: &[V], batch: u64) -> Vec<Option<V::Contribution>> {
        let Some(last) = self.iterations.checked_sub(1) else { return vec![None; queries.len()] };
        let mut values = parallel::map(vertices, |vertex| self.modulation.demodulate(vertex));
        for iteration in 0..last {
            let keys = self.keys(vertices, &values, batch, iteration);
            cells::averages(&keys, &mut values);
        }
        let cells = Cells::new(&self.keys(vertices, &values, batch, last), &values);
        let quantizer = self.quantizer(batch, last);
        parallel::map_range(queries.len(), |i| {
            let query = &queries[i];
            let mean = cells.mean(&quantizer.key(query, i, self.key.key(query))?)?;
            Some(self.modulation.remodulate(query, mean))
        })
    }

    fn bytes_per_vertex(&self) -> usize {
        let cell = size_of::<Key>() + size_of::<<V::Contribution as Contribution>::Sum>() + 16;
        // Values twice, keys, vertices sorted into parts, numbers of parts and of cells, counts; tables and cells.
        3 * size_of::<V::Contribution>() + 2 * size_of::<Option<Key>>() + 16 + 2 * cell
    }
}
