//! Tests the laws of [`RangeIndex`] on anybody's implementation, against the rule as it is written.
//!
//! ```
//! use range_search::{HashGrid, check};
//! for (name, points) in check::point_sets() {
//!     let grid = HashGrid::build(&points, |p| *p, 0.1)?;
//!     check::check_index(&grid, &points).unwrap_or_else(|violation| panic!("{name}: {violation}"));
//! }
//! # Ok::<(), range_search::BuildError>(())
//! ```

use core::fmt;
use core::ops::ControlFlow;

use crate::ball::{Ball, distance_squared, is_finite};
use crate::index::RangeIndex;
use crate::neighbour::Neighbour;

/// A law that is broken, and what shows it. The crates that are built on this one return it as well.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// The law.
    pub law: &'static str,
    /// The counterexample: of an index, the query.
    pub counterexample: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, but {}", self.law, self.counterexample)
    }
}

impl core::error::Error for Violation {}

/// A law, and what shows that it does not hold.
///
/// # Errors
/// The violation, unless it holds.
pub fn hold(law: &'static str, holds: bool, counterexample: impl FnOnce() -> String) -> Result<(), Violation> {
    if holds { Ok(()) } else { Err(Violation { law, counterexample: counterexample() }) }
}

/// What is within a radius, in the order of [`Neighbour`], by the rule: a loop over all points.
pub fn expected(points: &[[f32; 3]], center: [f32; 3], radius: f32) -> Vec<Neighbour> {
    let Some(ball) = Ball::new(center, radius) else { return Vec::new() };
    let finite = (0..).zip(points).filter(|(_, point)| is_finite(**point));
    let all = finite.map(|(id, point)| Neighbour::new(id, distance_squared(*point, center)));
    let mut found: Vec<_> = all.filter(|neighbour| neighbour.distance_squared() <= ball.radius_squared).collect();
    found.sort_unstable();
    found
}

/// Compares an index with the rule: around some of its points and away from them, with radii at which points are exactly on the boundary, and
/// with those that nobody should ask for.
///
/// Cost: some thousand queries for a thousand points, each of them also by a loop over all points.
///
/// # Errors
/// The first law that is broken.
pub fn check_index(index: &impl RangeIndex, points: &[[f32; 3]]) -> Result<(), Violation> {
    let finite = points.iter().filter(|point| is_finite(**point)).count();
    let (len, skipped) = (index.len(), index.skipped());
    let counted = len == finite && index.is_empty() == (finite == 0);
    let shown = || format!("len is {len}, is_empty {}, for {finite} of them", index.is_empty());
    hold("len is the number of finite points", counted, shown)?;
    let rest = points.len() - finite;
    let shown = || format!("it is {skipped}, and there are {rest}");
    hold("skipped is the number of points that are not finite", skipped == rest, shown)?;
    for center in centers(points) {
        for radius in radii(points, center) {
            check_query(index, points, center, radius)?;
        }
    }
    Ok(())
}

/// Compares one fixed-radius query, and nearest ones up to the radius, with the rule.
///
/// # Errors
/// The first law that is broken.
pub fn check_query(
    index: &impl RangeIndex,
    points: &[[f32; 3]],
    center: [f32; 3],
    radius: f32,
) -> Result<(), Violation> {
    let hold = |law, holds: bool, k: Option<usize>| {
        let with_k = || k.map_or(String::new(), |k| format!(", k = {k}"));
        hold(law, holds, || format!("not around {center:?}, radius {radius:e}{}", with_k()))
    };
    let expected = expected(points, center, radius);
    let visits = || {
        let mut visits = Vec::new();
        index.for_each_within(center, radius, |id, distance_squared| visits.push((id, distance_squared.to_bits())));
        visits
    };
    let visited = visits();
    let sorted = |visits: &[(usize, u32)]| {
        let mut sorted: Vec<_> =
            visits.iter().map(|(id, bits)| Neighbour::new(*id as u32, f32::from_bits(*bits))).collect();
        sorted.sort_unstable();
        sorted
    };
    hold("each point within the radius is visited once, and no other", sorted(&visited) == expected, None)?;
    hold("visits come in the same order the second time", visits() == visited, None)?;
    hold("within is all that is visited, sorted", index.within(center, radius) == expected, None)?;
    hold("count_within is the number of visits", index.count_within(center, radius) == expected.len(), None)?;
    hold("any_within says whether anything is visited", index.any_within(center, radius) != expected.is_empty(), None)?;

    // Breaking after some visits leaves these.
    let stop = visited.len().div_ceil(2);
    let mut before = Vec::new();
    let flow = index.try_for_each_within(center, radius, |id, distance_squared| {
        before.push((id, distance_squared.to_bits()));
        if before.len() == stop { ControlFlow::Break(id) } else { ControlFlow::Continue(()) }
    });
    let last = visited[..stop].last().map(|visit| visit.0);
    hold("a break ends the visits", before == visited[..stop] && flow.break_value() == last, None)?;

    // What was in the vector must not stay there.
    let mut found = vec![Neighbour::new(u32::MAX, 0.0); 3];
    for k in [0, 1, 2, 7, 50, expected.len() / 2, expected.len(), points.len() + 1, usize::MAX] {
        index.k_nearest(center, k, radius, &mut found);
        hold("k_nearest are the first of within", found == expected[..k.min(expected.len())], Some(k))?;
    }
    Ok(())
}

/// Centres on points, between them, and off all of them.
fn centers(points: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let step = points.len().div_ceil(6).max(1);
    let some: Vec<_> = points.iter().step_by(step).copied().collect();
    let mut centers = some.clone();
    centers.extend(some.windows(2).map(|pair| [0, 1, 2].map(|axis| 0.5 * pair[0][axis] + 0.5 * pair[1][axis])));
    centers.extend([[0.0; 3], [0.3, -0.2, 0.1], [1e4, 0.0, 0.0], [0.0, -3e38, 3e38], [1e-30; 3]]);
    centers.extend([[f32::NAN, 0.0, 0.0], [0.0, f32::INFINITY, 0.0], [0.0, 0.0, f32::NEG_INFINITY]]);
    centers
}

/// Radii of the points' own scale, some of them distances to points, and extreme ones.
fn radii(points: &[[f32; 3]], center: [f32; 3]) -> Vec<f32> {
    let mut distances: Vec<f32> = points.iter().map(|point| distance_squared(*point, center).sqrt()).collect();
    distances.retain(|distance| distance.is_finite());
    distances.sort_unstable_by(f32::total_cmp);
    let count = distances.len();
    let ranks = [0, 1, 5, 50, count / 10, count / 2, count.saturating_sub(1)];
    let mut radii: Vec<f32> = ranks.iter().filter_map(|rank| distances.get(*rank).copied()).collect();
    // Just inside and just outside.
    radii.extend(radii.clone().into_iter().flat_map(|radius| [radius.next_down(), radius.next_up()]));
    radii.extend([0.0, -0.0, 1e-30, 0.1, 1e19, 3e38, f32::INFINITY, -1.0, f32::NEG_INFINITY, f32::NAN]);
    radii
}

/// Sets of up to some hundred points that have broken indices: coincident, collinear, planar, on the borders of cells, huge, tiny, of
/// all magnitudes, and with coordinates that are not finite.
pub fn point_sets() -> Vec<(&'static str, Vec<[f32; 3]>)> {
    // Numbers of a generator that every language has (Knuth's MMIX).
    let mut state = 1_u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1 << 23) as f32 - 1.0
    };
    let mut set = |count: usize, point: &dyn Fn([f32; 3], usize) -> [f32; 3]| -> Vec<[f32; 3]> {
        (0..count).map(|i| point([random(), random(), random()], i)).collect()
    };
    let all_magnitudes = |u: f32| u * 10.0_f32.powi((u * 1e4) as i32 % 38);
    vec![
        ("none", Vec::new()),
        ("one", set(1, &|p, _| p)),
        ("uniform", set(300, &|p, _| p)),
        ("coincident", set(300, &|_, _| [0.3, 0.2, -0.1])),
        ("coincident in two places", set(300, &|_, i| [(i % 2) as f32, 0.0, 0.5])),
        ("collinear", set(200, &|p, _| [p[0], 0.0, 0.0])),
        ("collinear, oblique", set(200, &|p, _| [p[0]; 3])),
        ("planar", set(300, &|p, _| [p[0], p[1], 0.1])),
        (
            "lattice, on the borders of cells",
            set(343, &|_, i| [i % 7, i / 7 % 7, i / 49].map(|x| x as f32 * 0.1 - 0.3)),
        ),
        ("cluster and outlier", set(200, &|p, i| if i == 7 { [1e30, -1e30, 0.0] } else { p.map(|x| x * 1e-3) })),
        ("huge", set(100, &|p, _| p.map(|x| x * 3e38))),
        ("tiny", set(100, &|p, _| p.map(|x| x * 1e-38))),
        ("subnormal", set(100, &|p, _| p.map(|x| x * 1e-43))),
        ("far from the origin", set(200, &|p, _| p.map(|x| 1e6 + x))),
        ("all magnitudes", set(300, &|p, _| p.map(all_magnitudes))),
        ("zeros of both signs", set(50, &|p, _| p.map(|x| x * 0.0))),
        (
            "not finite",
            set(200, &|p, i| match i % 8 {
                0 => [f32::NAN, p[1], p[2]],
                1 => [p[0], f32::INFINITY, p[2]],
                2 => [p[0], p[1], f32::NEG_INFINITY],
                _ => p,
            }),
        ),
        ("only NaN", set(20, &|_, _| [f32::NAN; 3])),
    ]
}
