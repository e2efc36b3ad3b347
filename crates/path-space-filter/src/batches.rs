//! Contiguous batches of one sequence of paths.

use crate::Averages;

/// Why there are no such batches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BatchError {
    /// Not a base.
    #[error("batches of powers of {0}: the base is at least 2")]
    Base(u32),
    /// Too long.
    #[error("batches of {base}^{exponent} paths, which does not fit 63 bits")]
    Length {
        /// The base `b`.
        base: u32,
        /// The exponent `m`.
        exponent: u32,
    },
    /// Not even one path fits.
    #[error("{bytes} bytes do not hold a vertex of {bytes_per_vertex}")]
    Memory {
        /// The limit.
        bytes: u64,
        /// What a vertex takes.
        bytes_per_vertex: u64,
    },
    /// Not the start of a batch.
    #[error("path number {start} is not the first one of a batch of {len}")]
    Start {
        /// Where to go on.
        start: u64,
        /// The length of a batch.
        len: u64,
    },
}

/// A batch of consecutive paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Batch {
    /// Index of its first path in the sequence, `s_i`.
    pub start: u64,
    /// Number of paths, `b^m`.
    pub len: u64,
    /// Number of the batch, from 1: what the radius shrinks with.
    pub number: u64,
}

/// Cuts one low-discrepancy sequence of paths into contiguous batches of `b^m`, for each of which the vertices are held in memory.
///
/// Blocks of `b^m` points of a `(t, s)`-sequence in base `b` are `(t, m, s)`-nets: every batch is as well distributed as the whole.
/// The larger the batch, the more contributions there are to average; memory is the limit.
///
/// The state is [`next_start`](Self::next_start): stored with an image, it is all that is needed to refine it later.
///
/// ```
/// use path_space_filter::Batches;
/// let mut batches = Batches::within_memory(2, 1 << 30, 128)?;        // of 2^m paths in 1 GiB
/// let first = batches.next_batch();
/// assert_eq!((first.start, first.len, first.number), (0, 1 << 23, 1));
/// let mut later = Batches::within_memory(2, 1 << 30, 128)?.resume(batches.next_start())?;
/// assert_eq!(later.next_batch(), batches.next_batch());
/// # Ok::<(), path_space_filter::BatchError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked"))]
pub struct Batches {
    base: u32,
    exponent: u32,
    /// Base to the power of the exponent.
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    len: u64,
    next_start: u64,
}

/// The fields, before they are checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Unchecked {
    base: u32,
    exponent: u32,
    next_start: u64,
}

#[cfg(feature = "serde")]
impl TryFrom<Unchecked> for Batches {
    type Error = BatchError;

    fn try_from(Unchecked { base, exponent, next_start }: Unchecked) -> Result<Self, BatchError> {
        Self::new(base, exponent)?.resume(next_start)
    }
}

impl Batches {
    /// Batches of `base^exponent` paths.
    ///
    /// # Errors
    /// If the base is below 2, or the length does not fit.
    pub fn new(base: u32, exponent: u32) -> Result<Self, BatchError> {
        if base < 2 {
            return Err(BatchError::Base(base));
        }
        let len = u64::from(base).checked_pow(exponent).filter(|&len| len <= u64::MAX / 2);
        Ok(Self { base, exponent, len: len.ok_or(BatchError::Length { base, exponent })?, next_start: 0 })
    }

    /// The longest batches that fit into so many bytes.
    ///
    /// # Errors
    /// If the base is below 2, or not even one vertex fits.
    pub fn within_memory(base: u32, bytes: u64, bytes_per_vertex: u64) -> Result<Self, BatchError> {
        let most = bytes / bytes_per_vertex.max(1);
        if most == 0 {
            return Err(BatchError::Memory { bytes, bytes_per_vertex });
        }
        let most = most.min(u64::MAX / 2);
        Self::new(base, most.checked_ilog(u64::from(base.max(2))).unwrap_or(0))
    }

    /// The same batches, from one that begins with path number `start`.
    ///
    /// # Errors
    /// If no batch does.
    pub fn resume(self, start: u64) -> Result<Self, BatchError> {
        if start.is_multiple_of(self.len) {
            Ok(Self { next_start: start, ..self })
        } else {
            Err(BatchError::Start { start, len: self.len })
        }
    }

    /// Number of paths of a batch.
    pub fn len_of_batch(&self) -> u64 {
        self.len
    }

    /// Index of the first path that belongs to no batch yet.
    pub fn next_start(&self) -> u64 {
        self.next_start
    }

    /// The next batch.
    pub fn next_batch(&mut self) -> Batch {
        let batch =
            Batch { start: self.next_start, len: self.len, number: (self.next_start / self.len).saturating_add(1) };
        self.next_start = self.next_start.saturating_add(self.len);
        batch
    }
}

/// Switches the filter off when hardly anything is averaged any more: from then on images are the unfiltered ones, at no cost.
///
/// ```
/// use path_space_filter::SwitchOff;
/// let mut switch = SwitchOff::new(1);
/// # let averages = path_space_filter::PathFilter::average(&path_space_filter::PathSpaceFilter::new(path_space_filter::Radius::absolute(0.0)?), &[path_space_filter::Vertex::<f32>::default()], 1);
/// assert_eq!(averages.max_count(), 1); // everybody is alone
/// switch.observe(&averages);
/// assert!(switch.is_off());
/// # Ok::<(), path_space_filter::RadiusError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct SwitchOff {
    threshold: u32,
    off: bool,
}

impl SwitchOff {
    /// Off for good as soon as no vertex of a batch averages more than `threshold` contributions, its own among them.
    pub fn new(threshold: u32) -> Self {
        Self { threshold, off: false }
    }

    /// Looks at a batch. One without vertices says nothing.
    pub fn observe<C>(&mut self, averages: &Averages<C>) {
        let count = averages.max_count();
        self.off |= count > 0 && count <= self.threshold;
    }

    /// Whether the filter is off.
    pub fn is_off(&self) -> bool {
        self.off
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_are_contiguous_and_counted_from_one() {
        let mut batches = Batches::new(3, 2).unwrap();
        let all: Vec<_> = (0..3).map(|_| batches.next_batch()).map(|b| (b.start, b.len, b.number)).collect();
        assert_eq!(all, [(0, 9, 1), (9, 9, 2), (18, 9, 3)]);
    }

    #[test]
    fn memory_bounds_the_length() {
        assert_eq!(Batches::within_memory(2, 1000, 10).unwrap().len_of_batch(), 64);
        assert_eq!(Batches::within_memory(10, 1000, 10).unwrap().len_of_batch(), 100);
        assert_eq!(Batches::within_memory(2, 10, 10).unwrap().len_of_batch(), 1);
        assert!(Batches::within_memory(2, u64::MAX, 0).is_ok() && Batches::within_memory(3, u64::MAX, 1).is_ok());
        let mut last = Batches::new(2, 0).unwrap().resume(u64::MAX - 1).unwrap();
        assert_eq!([(); 3].map(|()| last.next_batch().start), [u64::MAX - 1, u64::MAX, u64::MAX]);
    }

    #[test]
    fn what_is_no_batch_is_refused() {
        assert_eq!(Batches::new(1, 3), Err(BatchError::Base(1)));
        assert!(Batches::new(2, 63).is_err() && Batches::new(7, u32::MAX).is_err());
        assert!(matches!(Batches::within_memory(2, 9, 10), Err(BatchError::Memory { .. })));
        let error = Batches::new(2, 4).unwrap().resume(17).unwrap_err();
        assert_eq!(error.to_string(), "path number 17 is not the first one of a batch of 16");
    }
}
