//! Counting sort into buckets.

use super::HashGrid;
use super::cells::{CellBounds, Layout, Scale};
use crate::ball::is_finite;
use crate::error::{BuildError, check_count};
use crate::lanes::Lanes;

/// The bucket of points that are kept out. No grid has as many.
const NOWHERE: u32 = u32::MAX;

pub(super) fn build<P>(
    points: &[P],
    position: impl Fn(&P) -> [f32; 3],
    cell_size: f32,
) -> Result<HashGrid, BuildError> {
    let scale = check(points.len(), cell_size)?;

    // Bound the cells with points.
    let mut bounds = CellBounds::EMPTY;
    let mut len = 0;
    for point in points.iter().map(&position).filter(|point| is_finite(*point)) {
        bounds.add(scale.cell(point));
        len += 1;
    }
    let (layout, buckets) = Layout::new(&bounds, len);

    // Count the points of each bucket, one place ahead.
    let mut starts = vec![0_u32; buckets + 1];
    let mut bucket_of = Vec::with_capacity(points.len());
    for point in points.iter().map(&position) {
        let bucket = bucket(&scale, &bounds, &layout, point);
        if bucket != NOWHERE {
            starts[bucket as usize + 1] += 1;
        }
        bucket_of.push(bucket);
    }

    // Sum up: where each bucket starts, still one place ahead.
    let mut sum = 0;
    for start in &mut starts[1..] {
        sum += core::mem::replace(start, sum);
    }

    // Scatter the points. What was the start of a bucket becomes its end, and so the start of the next one.
    let len = sum as usize;
    let mut lanes = Lanes::new(len);
    for (id, (&bucket, point)) in bucket_of.iter().zip(points).enumerate() {
        if bucket != NOWHERE {
            let slot = &mut starts[bucket as usize + 1];
            lanes.set(*slot as usize, id as u32, position(point));
            *slot += 1;
        }
    }
    Ok(HashGrid { points: lanes, starts, scale, bounds, layout, skipped: points.len() - len })
}

fn check(points: usize, cell_size: f32) -> Result<Scale, BuildError> {
    check_count(points)?;
    // NaN is not larger than zero.
    if cell_size > 0.0 && cell_size < f32::INFINITY {
        Ok(Scale::new(cell_size))
    } else {
        Err(BuildError::CellSize(cell_size))
    }
}

/// The bucket of a point. A point that is not in the bounds, because its position is not what it was before, is moved there.
#[inline(always)]
fn bucket(scale: &Scale, bounds: &CellBounds, layout: &Layout, point: [f32; 3]) -> u32 {
    if !is_finite(point) || bounds.min[0] > bounds.max[0] {
        return NOWHERE;
    }
    let mut cell = scale.cell(point);
    for (axis, x) in cell.iter_mut().enumerate() {
        *x = (*x).clamp(bounds.min[axis], bounds.max[axis]);
    }
    layout.bucket(bounds, cell)
}
