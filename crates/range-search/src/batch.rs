//! Many queries of an index.

use crate::index::RangeIndex;
use crate::neighbour::Neighbour;

/// Queries that one thread works on at a time.
#[cfg(feature = "rayon")]
const CHUNK: usize = 256;

/// What many queries found: a list of neighbours for each, one after the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lists {
    neighbours: Vec<Neighbour>,
    /// Where each list ends.
    ends: Vec<usize>,
}

impl Lists {
    fn new(queries: usize) -> Self {
        Self { neighbours: Vec::new(), ends: Vec::with_capacity(queries) }
    }

    fn end(&mut self) {
        self.ends.push(self.neighbours.len());
    }

    /// Number of queries.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there were no queries.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// What a query found; nothing if there was no such query.
    pub fn get(&self, query: usize) -> Option<&[Neighbour]> {
        let start = if query == 0 { 0 } else { *self.ends.get(query - 1)? };
        self.neighbours.get(start..*self.ends.get(query)?)
    }

    /// What each query found, in the order of queries.
    pub fn iter(&self) -> impl Iterator<Item = &[Neighbour]> {
        (0..self.len()).filter_map(|query| self.get(query))
    }
}

/// The points within a radius of each centre, in the order of [`Neighbour`].
///
/// ```
/// use range_search::{BruteForce, batch};
/// let index = BruteForce::build(&[[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0]], |p| *p)?;
/// let lists = batch::within(&index, &[[0.0; 3], [1.5, 0.0, 0.0], [9.0, 0.0, 0.0]], 1.0);
/// assert_eq!(lists.iter().map(|list| list.len()).collect::<Vec<_>>(), [2, 1, 0]);
/// # Ok::<(), range_search::BuildError>(())
/// ```
pub fn within(index: &impl RangeIndex, centers: &[[f32; 3]], radius: f32) -> Lists {
    let mut lists = Lists::new(centers.len());
    for &center in centers {
        let start = lists.neighbours.len();
        index.for_each_within(center, radius, |id, distance_squared| {
            lists.neighbours.push(Neighbour::new(id as u32, distance_squared));
        });
        lists.neighbours[start..].sort_unstable();
        lists.end();
    }
    lists
}

/// The `k` nearest points of each centre within a radius, in the order of [`Neighbour`].
pub fn k_nearest(index: &impl RangeIndex, centers: &[[f32; 3]], k: usize, max_radius: f32) -> Lists {
    let (mut lists, mut found) = (Lists::new(centers.len()), Vec::new());
    for &center in centers {
        index.k_nearest(center, k, max_radius, &mut found);
        lists.neighbours.extend_from_slice(&found);
        lists.end();
    }
    lists
}

/// As [`within`], on all threads of rayon's pool: the same result.
#[cfg(feature = "rayon")]
pub fn par_within(index: &(impl RangeIndex + Sync), centers: &[[f32; 3]], radius: f32) -> Lists {
    parallel(centers, |centers| within(index, centers, radius))
}

/// As [`k_nearest`], on all threads of rayon's pool: the same result.
#[cfg(feature = "rayon")]
pub fn par_k_nearest(index: &(impl RangeIndex + Sync), centers: &[[f32; 3]], k: usize, max_radius: f32) -> Lists {
    parallel(centers, |centers| k_nearest(index, centers, k, max_radius))
}

#[cfg(feature = "rayon")]
fn parallel(centers: &[[f32; 3]], query: impl Fn(&[[f32; 3]]) -> Lists + Sync) -> Lists {
    use rayon::prelude::*;
    let parts: Vec<Lists> = centers.par_chunks(CHUNK).map(&query).collect();
    let mut lists = Lists::new(centers.len());
    for part in parts {
        let start = lists.neighbours.len();
        lists.ends.extend(part.ends.iter().map(|end| start + end));
        lists.neighbours.extend(part.neighbours);
    }
    lists
}
