//! What a filter returns.

/// The average of each vertex of a batch, in the order of the vertices.
///
/// Iterates over the averages.
#[derive(Clone, Debug, PartialEq)]
pub struct Averages<C> {
    pub(crate) values: Vec<C>,
    pub(crate) counts: Counts,
}

/// How many contributions were averaged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counts {
    pub(crate) max: u32,
    pub(crate) total: u64,
    pub(crate) vertices: u64,
}

impl Counts {
    pub(crate) fn add(&mut self, count: u32) {
        self.max = self.max.max(count);
        self.total += u64::from(count);
        self.vertices += 1;
    }
}

impl<C> Averages<C> {
    /// The averages.
    pub fn values(&self) -> &[C] {
        &self.values
    }

    /// The averages.
    pub fn into_values(self) -> Vec<C> {
        self.values
    }

    /// The largest number of contributions in an average; 1 if the radius is so small that every vertex is alone, 0 if there is none that takes part.
    /// Compare it with a threshold to switch the filter off: [`SwitchOff`](crate::SwitchOff).
    pub fn max_count(&self) -> u32 {
        self.counts.max
    }

    /// The mean number of contributions in an average, over all vertices that take part.
    pub fn mean_count(&self) -> f64 {
        self.counts.total as f64 / self.counts.vertices.max(1) as f64
    }
}

impl<C> IntoIterator for Averages<C> {
    type Item = C;
    type IntoIter = std::vec::IntoIter<C>;

    fn into_iter(self) -> Self::IntoIter {
        self.values.into_iter()
    }
}

impl<'a, C> IntoIterator for &'a Averages<C> {
    type Item = &'a C;
    type IntoIter = std::slice::Iter<'a, C>;

    fn into_iter(self) -> Self::IntoIter {
        self.values.iter()
    }
}
