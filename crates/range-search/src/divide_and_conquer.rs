//! All queries at once, without an index.

use core::convert::Infallible;
use core::ops::ControlFlow;

use crate::ball::{Ball, is_finite};
use crate::error::{BuildError, check_count};
use crate::lanes::Lanes;
use crate::neighbour::Neighbour;

/// So many queries or points are no longer divided.
const FEW: usize = 64;
/// So many queries are worth a thread of their own.
#[cfg(feature = "rayon")]
const MANY: usize = 1 << 12;

/// A query: its position in the input, and where it is.
type Query = (u32, [f32; 3]);

/// The points within a radius of each of many queries, which are all known beforehand: no index is built.
///
/// Queries are halved along the longest axis of their bounding box, and the points sorted out that are too far from each half, until there are
/// few of either; then each point is tested. Pays if there are few queries in a part of space with many points, or if the points are
/// asked just once; points and queries may be distributed in any way.
///
/// `f` is called once for each query, with its position in the input and the neighbours, whose ids ascend. The order of queries is a
/// function of the input: as they were divided, then those whose centres are not finite, whose neighbours are none. For radii see the table
/// of [`RangeIndex`](crate::RangeIndex).
///
/// Cost: `m log m` for `m` queries, and each point as often as there are groups of queries it is close to, on each of `log m` levels.
/// Memory: 16 bytes per point, and as much again for those that the halves have in common.
///
/// Source: after B. Mora, *Naive Ray-Tracing: A Divide-And-Conquer Approach* (2011), with balls for rays.
///
/// # Errors
/// If there are more points or queries than ids.
///
/// ```
/// use range_search::divide_and_conquer;
/// let points = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [5.0, 0.0, 0.0]];
/// let queries = [[0.5_f32, 0.0, 0.0], [9.0, 0.0, 0.0]];
/// let mut counts = [0; 2];
/// divide_and_conquer(&points, |p| *p, &queries, |q| *q, 1.0, |query, found| counts[query] = found.len())?;
/// assert_eq!(counts, [2, 0]);
/// # Ok::<(), range_search::BuildError>(())
/// ```
pub fn divide_and_conquer<P, Q>(
    points: &[P],
    position: impl Fn(&P) -> [f32; 3],
    queries: &[Q],
    center: impl Fn(&Q) -> [f32; 3],
    radius: f32,
    mut f: impl FnMut(usize, &[Neighbour]),
) -> Result<(), BuildError> {
    let (points, mut finite, others) = prepare(points, position, queries, center, radius)?;
    let mut found = Vec::new();
    if !finite.is_empty() {
        divide(&mut finite, &points, radius, &mut |queries, points| {
            conquer(queries, points, radius, &mut found, &mut f)
        });
    }
    others.into_iter().for_each(|(query, _)| f(query as usize, &[]));
    Ok(())
}

/// As [`divide_and_conquer`], on all threads of rayon's pool: the same neighbours of each query, but queries come in any order.
///
/// # Errors
/// As there.
#[cfg(feature = "rayon")]
pub fn par_divide_and_conquer<P, Q>(
    points: &[P],
    position: impl Fn(&P) -> [f32; 3],
    queries: &[Q],
    center: impl Fn(&Q) -> [f32; 3],
    radius: f32,
    f: impl Fn(usize, &[Neighbour]) + Sync,
) -> Result<(), BuildError> {
    let (points, mut finite, others) = prepare(points, position, queries, center, radius)?;
    if !finite.is_empty() {
        par_divide(&mut finite, &points, radius, &f);
    }
    others.into_iter().for_each(|(query, _)| f(query as usize, &[]));
    Ok(())
}

/// Points, queries that may find something, and those that find nothing.
fn prepare<P, Q>(
    points: &[P],
    position: impl Fn(&P) -> [f32; 3],
    queries: &[Q],
    center: impl Fn(&Q) -> [f32; 3],
    radius: f32,
) -> Result<(Lanes, Vec<Query>, Vec<Query>), BuildError> {
    check_count(points.len())?;
    check_count(queries.len())?;
    let kept: Vec<_> = (0..).zip(points.iter().map(position)).filter(|(_, point)| is_finite(*point)).collect();
    let centers = (0..).zip(queries.iter().map(center));
    let (valid, others) = centers.partition(|(_, center)| Ball::new(*center, radius).is_some());
    Ok((Lanes::from_points(&kept), valid, others))
}

/// Halves queries until there are few, or few points.
fn divide(queries: &mut [Query], points: &Lanes, radius: f32, conquer: &mut impl FnMut(&[Query], &Lanes)) {
    if is_few(queries, points) {
        return conquer(queries, points);
    }
    for half in halve(queries) {
        let near = near(half, points, radius);
        divide(half, &near, radius, conquer);
    }
}

#[cfg(feature = "rayon")]
fn par_divide(queries: &mut [Query], points: &Lanes, radius: f32, f: &(impl Fn(usize, &[Neighbour]) + Sync)) {
    if queries.len() < MANY || is_few(queries, points) {
        let mut found = Vec::new();
        return divide(queries, points, radius, &mut |queries, points| {
            conquer(queries, points, radius, &mut found, &mut |query, found: &[Neighbour]| f(query, found));
        });
    }
    let [left, right] = halve(queries);
    rayon::join(
        || par_divide(left, &near(left, points, radius), radius, f),
        || par_divide(right, &near(right, points, radius), radius, f),
    );
}

/// Whether it is time to conquer.
fn is_few(queries: &[Query], points: &Lanes) -> bool {
    queries.len() <= FEW || points.len() <= FEW
}

/// Two halves along the longest axis.
fn halve(queries: &mut [Query]) -> [&mut [Query]; 2] {
    let (min, max) = bounds(queries);
    let extent = [0, 1, 2].map(|axis| max[axis] - min[axis]);
    let axis = (0..3).fold(0, |longest, axis| if extent[axis] > extent[longest] { axis } else { longest });
    let middle = queries.len() / 2;
    // The order is total, so that the halves do not depend on how they are found.
    queries.select_nth_unstable_by(middle, |(i, a), (j, b)| a[axis].total_cmp(&b[axis]).then(i.cmp(j)));
    let (left, right) = queries.split_at_mut(middle);
    [left, right]
}

fn bounds(queries: &[Query]) -> ([f32; 3], [f32; 3]) {
    queries.iter().fold(([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]), |(min, max), (_, center)| {
        ([0, 1, 2].map(|axis| min[axis].min(center[axis])), [0, 1, 2].map(|axis| max[axis].max(center[axis])))
    })
}

/// The points that any of the queries may find, in the same order.
fn near(queries: &[Query], points: &Lanes, radius: f32) -> Lanes {
    let (min, max) = bounds(queries);
    let (Some(lower), Some(upper)) = (Ball::new(min, radius), Ball::new(max, radius)) else { return Lanes::default() };
    if lower.is_everything() {
        return points.clone();
    }
    let (min, max) = (lower.bounds().0, upper.bounds().1);
    let inside = |(_, point): &(u32, [f32; 3])| (0..3).all(|axis| point[axis] >= min[axis] && point[axis] <= max[axis]);
    let kept: Vec<_> = (0..points.len()).map(|slot| (points.id(slot), points.position(slot))).filter(inside).collect();
    Lanes::from_points(&kept)
}

/// Tests each point for each query.
fn conquer(
    queries: &[Query],
    points: &Lanes,
    radius: f32,
    found: &mut Vec<Neighbour>,
    f: &mut impl FnMut(usize, &[Neighbour]),
) {
    for (query, center) in queries {
        found.clear();
        if let Some(ball) = Ball::new(*center, radius) {
            let all = core::iter::once(0..points.len());
            let ControlFlow::Continue(()) = points.scan(&ball, all, |id, distance_squared| {
                found.push(Neighbour::new(id as u32, distance_squared));
                ControlFlow::<Infallible>::Continue(())
            });
        }
        f(*query as usize, found);
    }
}
