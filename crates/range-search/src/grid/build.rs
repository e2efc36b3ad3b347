//! Counting sort into buckets, in two steps, so that each works on memory that fits into caches.
//!
//! 1. Pieces of the input are sorted into partitions, which are ranges of buckets.
//! 2. Each partition is sorted into its buckets.
//!
//! Both are stable, pieces and partitions do not depend on the number of threads, and so the result is the same however many
//! there are.

use super::HashGrid;
use super::cells::{CellBounds, Layout, Scale};
use crate::ball::is_finite;
use crate::error::{BuildError, check_count};
use crate::lanes::Lanes;

/// Points of a piece of the input.
const PIECE: usize = 1 << 14;
/// Partitions at most.
const MOST_PARTITIONS: usize = 1 << 10;
/// Buckets of a partition at least.
const FEWEST_BUCKETS: usize = 1 << 12;

/// A point on its way.
#[derive(Clone, Copy, Default)]
struct Entry {
    bucket: u32,
    id: u32,
    position: [f32; 3],
}

/// A piece of the input, sorted into partitions.
struct Piece {
    entries: Vec<Entry>,
    /// Where the entries of each partition start, and where those of the last one end.
    starts: Vec<u32>,
}

/// What both steps need to know.
struct Plan {
    scale: Scale,
    bounds: CellBounds,
    layout: Layout,
    buckets: usize,
    /// Buckets of a partition, a power of two.
    partition: usize,
    /// There are no points that are not kept out.
    empty: bool,
}

pub(super) fn build<P>(
    points: &[P],
    position: impl Fn(&P) -> [f32; 3],
    cell_size: f32,
) -> Result<HashGrid, BuildError> {
    let scale = check(points.len(), cell_size)?;
    let bounds = points.iter().map(&position).fold(Bounds::EMPTY, Bounds::with);
    let plan = Plan::new(scale, bounds);
    let pieces: Vec<Piece> =
        points.chunks(PIECE).enumerate().map(|(piece, points)| plan.sort_piece(piece, points, &position)).collect();

    let bases = plan.bases(&pieces);
    let mut starts = vec![0; plan.buckets + 1];
    let mut lanes = Lanes::new(bases[plan.partitions()] as usize);
    for (partition, starts) in starts[1..].chunks_mut(plan.partition).enumerate() {
        plan.sort_partition(partition, &pieces, bases[partition], starts, |slot, entry| {
            lanes.set(slot as usize, entry.id, entry.position);
        });
    }
    Ok(plan.finish(lanes, starts, points.len()))
}

/// The same, on all threads.
#[cfg(feature = "rayon")]
pub(super) fn par_build<P: Sync>(
    points: &[P],
    position: impl Fn(&P) -> [f32; 3] + Sync,
    cell_size: f32,
) -> Result<HashGrid, BuildError> {
    use rayon::prelude::*;
    let scale = check(points.len(), cell_size)?;
    let bounds = points
        .par_chunks(PIECE)
        .map(|points| points.iter().map(&position).fold(Bounds::EMPTY, Bounds::with))
        .reduce(|| Bounds::EMPTY, Bounds::union);
    let plan = Plan::new(scale, bounds);
    let pieces: Vec<Piece> =
        points.par_chunks(PIECE).enumerate().map(|(piece, points)| plan.sort_piece(piece, points, &position)).collect();

    let bases = plan.bases(&pieces);
    let mut starts = vec![0; plan.buckets + 1];
    let sorted: Vec<Vec<Entry>> = starts[1..]
        .par_chunks_mut(plan.partition)
        .enumerate()
        .map(|(partition, starts)| {
            let base = bases[partition];
            let mut sorted = vec![Entry::default(); (bases[partition + 1] - base) as usize];
            plan.sort_partition(partition, &pieces, base, starts, |slot, entry| {
                sorted[(slot - base) as usize] = *entry;
            });
            sorted
        })
        .collect();
    drop(pieces);
    let mut lanes = Lanes::new(bases[plan.partitions()] as usize);
    lanes.par_fill(PIECE, |first| {
        let partition = bases.partition_point(|&base| base as usize <= first) - 1;
        let rest = sorted[partition][first - bases[partition] as usize..].iter();
        rest.chain(sorted[partition + 1..].iter().flatten()).map(|entry| (entry.id, entry.position))
    });
    Ok(plan.finish(lanes, starts, points.len()))
}

fn check(points: usize, cell_size: f32) -> Result<Scale, BuildError> {
    check_count(points)?;
    // NaN is not larger than zero.
    let valid = cell_size > 0.0 && cell_size < f32::INFINITY;
    if valid { Ok(Scale::new(cell_size)) } else { Err(BuildError::CellSize(cell_size)) }
}

/// Bounds and number of the points that are not kept out.
#[derive(Clone, Copy)]
struct Bounds {
    min: [f32; 3],
    max: [f32; 3],
    len: usize,
}

impl Bounds {
    const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3], len: 0 };

    #[inline(always)]
    fn with(self, point: [f32; 3]) -> Self {
        if is_finite(point) { self.union(Self { min: point, max: point, len: 1 }) } else { self }
    }

    #[inline(always)]
    fn union(mut self, other: Self) -> Self {
        for axis in 0..3 {
            self.min[axis] = self.min[axis].min(other.min[axis]);
            self.max[axis] = self.max[axis].max(other.max[axis]);
        }
        self.len += other.len;
        self
    }
}

impl Plan {
    fn new(scale: Scale, bounds: Bounds) -> Self {
        // Cells are monotone, so those of the extreme points bound all of them.
        let cells = CellBounds { min: scale.cell(bounds.min), max: scale.cell(bounds.max) };
        let (layout, buckets) = Layout::new(&cells, bounds.len);
        let partition = buckets.div_ceil(MOST_PARTITIONS).max(FEWEST_BUCKETS).next_power_of_two();
        Self { scale, bounds: cells, layout, buckets, partition, empty: bounds.len == 0 }
    }

    fn partitions(&self) -> usize {
        self.buckets.div_ceil(self.partition)
    }

    /// The bucket of a point that is not kept out. A point whose position is not what it was before, and out of bounds now, is moved
    /// into them.
    #[inline(always)]
    fn bucket(&self, point: [f32; 3]) -> Option<u32> {
        if !is_finite(point) || self.empty {
            return None;
        }
        let mut cell = self.scale.cell(point);
        for (axis, x) in cell.iter_mut().enumerate() {
            *x = (*x).clamp(self.bounds.min[axis], self.bounds.max[axis]);
        }
        Some(self.layout.bucket(&self.bounds, cell))
    }

    /// Step 1: a counting sort of the piece by partitions.
    fn sort_piece<P>(&self, piece: usize, points: &[P], position: impl Fn(&P) -> [f32; 3]) -> Piece {
        let shift = self.partition.trailing_zeros();
        let mut starts = vec![0; self.partitions() + 1];
        let mut unsorted = Vec::with_capacity(points.len());
        for (id, point) in points.iter().enumerate() {
            let position = position(point);
            if let Some(bucket) = self.bucket(position) {
                unsorted.push(Entry { bucket, id: (piece * PIECE + id) as u32, position });
                starts[(bucket >> shift) as usize + 1] += 1;
            }
        }
        sum_up(&mut starts[1..], 0);
        let mut entries = vec![Entry::default(); unsorted.len()];
        for entry in unsorted {
            let place = &mut starts[(entry.bucket >> shift) as usize + 1];
            entries[*place as usize] = entry;
            *place += 1;
        }
        Piece { entries, starts }
    }

    /// The first slot of each partition, and the number of all slots.
    fn bases(&self, pieces: &[Piece]) -> Vec<u32> {
        let mut bases = vec![0; self.partitions() + 1];
        for piece in pieces {
            for (base, ends) in bases.iter_mut().zip(piece.starts.windows(2)) {
                *base += ends[1] - ends[0];
            }
        }
        sum_up(&mut bases, 0);
        bases
    }

    /// Step 2: a counting sort of a partition by buckets. Leaves in `starts` where each bucket ends.
    fn sort_partition(
        &self,
        partition: usize,
        pieces: &[Piece],
        base: u32,
        starts: &mut [u32],
        mut put: impl FnMut(u32, &Entry),
    ) {
        let first = (partition * self.partition) as u32;
        let entries = || pieces.iter().flat_map(|piece| piece.partition(partition));
        for entry in entries() {
            starts[(entry.bucket - first) as usize] += 1;
        }
        sum_up(starts, base);
        for entry in entries() {
            let slot = &mut starts[(entry.bucket - first) as usize];
            put(*slot, entry);
            *slot += 1;
        }
    }

    fn finish(self, points: Lanes, starts: Vec<u32>, input: usize) -> HashGrid {
        let skipped = input - points.len();
        HashGrid { points, starts, scale: self.scale, bounds: self.bounds, layout: self.layout, skipped }
    }
}

impl Piece {
    fn partition(&self, partition: usize) -> &[Entry] {
        &self.entries[self.starts[partition] as usize..self.starts[partition + 1] as usize]
    }
}

/// Replaces counts by the sums of those before.
fn sum_up(counts: &mut [u32], mut sum: u32) {
    for count in counts {
        sum += core::mem::replace(count, sum);
    }
}
