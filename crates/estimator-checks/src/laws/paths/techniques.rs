//! The laws of `PathTechniques`.

use mis_heuristics::Densities;
use vpl_gi::PathTechniques;

use crate::laws::{Law, hold, near};
use crate::outcome::Outcome;

/// Relative tolerance of lengths and directions, which are `f32`.
const ROUND_OFF: f32 = 1e-3;
/// Of the density that is one.
const ONE: f64 = 1e-6;

/// Checks the laws of a path's description (the trait `PathTechniques` of crate `vpl-gi`) on one path `x_0 .. x_l`, which
/// `technique` generated.
///
/// ```text
/// (1)  there are l techniques, or l + 1 with the lens; the one that generated the path is among them
/// (2)  densities are finite and not negative; that of the technique that generated the path is one; again the same
/// (3)  a technique that cannot generate the path (can_connect(l - i), can_hit) has density zero
/// (4)  can_connect(k) implies that neither x_k nor x_(k+1) is specular; x_0 and x_l never are
/// (5)  all but x_l have a position; distance_squared(k), direction(k) are those of the positions
/// (6)  0 <= geometry_term(k) <= 1 / distance_squared(k); zero at infinity
/// ```
///
/// Within 1e-3 relative where numbers are computed in `f32`. Directions are those between the positions: a renderer that keeps the directions of
/// its rays, which start a little off the surface, breaks (5) on edges that are short beside that. No chance is involved. Cost: all densities, twice.
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_path(test: &str, technique: usize, path: &impl PathTechniques) -> Outcome {
    Outcome::of_laws(test, path_laws(technique, path))
}

/// Whether `technique` can generate the path.
pub(super) fn is_possible(path: &impl PathTechniques, technique: usize) -> bool {
    if technique == 0 { path.can_hit() } else { path.can_connect(path.segments() - technique) }
}

pub(super) fn path_laws(technique: usize, path: &impl PathTechniques) -> Law {
    let (l, densities) = (path.segments(), path.densities());
    let count = densities.len();
    let counted = l > 0 && (count == l || count == l + 1);
    hold("a path of l segments has l techniques, or l + 1 with the lens", counted, || format!("{count} for l = {l}"))?;
    let shown = || format!("it is technique {technique} of {count}");
    hold("the technique that generated the path is one of its techniques", technique < count, shown)?;
    for i in 0..count {
        let density = densities.density(i);
        let shown = || format!("that of technique {i} of {count} is {density}");
        hold("densities of a path are finite and not negative", density.is_finite() && density >= 0.0, shown)?;
        let again = path.densities().density(i);
        let shown = || format!("density {i} is {density}, then {again}");
        hold("the same path has the same densities", density.to_bits() == again.to_bits(), shown)?;
        let holds = density == 0.0 || is_possible(path, i);
        let shown = || format!("that of technique {i} of {count} is {density}");
        hold("a technique that cannot generate the path has density zero", holds, shown)?;
    }
    let own = densities.density(technique);
    let shown = || format!("that of technique {technique} is {own}");
    hold("densities are over that of the technique that generated the path", near(own, 1.0, ONE), shown)?;
    let ends = !path.is_specular(0) && !path.is_specular(l);
    hold("a path scatters between its ends", ends, || format!("an end of {l} segments is specular"))?;
    (0..l).try_for_each(|k| edge(path, k))
}

/// (4) to (6), for the edge from `x_k` to `x_(k+1)`.
fn edge(path: &impl PathTechniques, k: usize) -> Law {
    let specular = path.is_specular(k) || path.is_specular(k + 1);
    let shown = || format!("edge {k} of {} can be connected", path.segments());
    hold("what scatters by a Dirac delta is never connected", !(specular && path.can_connect(k)), shown)?;

    let (from, to) = (path.position(k), path.position(k + 1));
    let shown = || format!("edge {k} of {} goes from {from:?} to {to:?}", path.segments());
    let is_light = k + 1 == path.segments();
    let finite = from.is_some_and(|x| x.is_finite()) && to.map_or(is_light, |x| x.is_finite());
    hold("all vertices but the light's have a position", finite, shown)?;
    let (squared, direction, geometry) = (path.distance_squared(k), path.direction(k), path.geometry_term(k));
    let shown = || format!("geometry term {geometry}, squared distance {squared}, direction {direction}: {}", shown());
    let (Some(from), Some(to)) = (from, to) else {
        hold("the way to infinity is infinite", squared == f32::INFINITY, shown)?;
        hold("the geometry term vanishes at infinity", geometry == 0.0, shown)?;
        return hold("directions have unit length", (direction.length() - 1.0).abs() <= ROUND_OFF, shown);
    };
    let between = to - from;
    let same = near(squared.into(), between.length_squared().into(), ROUND_OFF.into());
    hold("the squared distance is that of the positions", same, shown)?;
    hold("geometry terms are not negative", geometry >= 0.0, shown)?;
    // Of coincident points nothing else can be asked.
    if between.length() > f32::EPSILON * from.length().max(to.length()) / ROUND_OFF {
        let bounded = geometry <= (1.0 + ROUND_OFF) / between.length_squared();
        hold("cosines are at most one in the geometry term", bounded, shown)?;
        hold("directions have unit length", (direction.length() - 1.0).abs() <= ROUND_OFF, shown)?;
        let along = direction.distance(between.normalize()) <= ROUND_OFF;
        hold("directions lead from each vertex to the next", along, shown)?;
    }
    Ok(())
}

/// Checks that two descriptions of the **same** path, generated by two techniques, are the same: `(i, a)` by technique `i`, `(j, b)`
/// by technique `j`.
///
/// ```text
/// (1)  both keep the laws of check_path
/// (2)  segments, techniques, specular vertices, can_connect and can_hit are the same
/// (3)  positions, directions, geometry terms are the same
/// (4)  b.density(n) a.density(j) = a.density(n)            densities up to a common factor
/// ```
///
/// Without (4) no heuristic's weights sum to one over the techniques, whatever it does with them. (3) and (4) within `tolerance`,
/// relative: 1e-3 suits paths in `f32` without short edges. No chance is involved.
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_same_path<A: PathTechniques, B: PathTechniques>(
    test: &str,
    (i, a): (usize, &A),
    (j, b): (usize, &B),
    tolerance: f64,
) -> Outcome {
    let laws = || {
        path_laws(i, a)?;
        path_laws(j, b)?;
        let (l, count) = (a.segments(), a.densities().len());
        let shown = || format!("{l} and {}, {count} and {}", b.segments(), b.densities().len());
        let same = b.segments() == l && b.densities().len() == count;
        hold("the same path has the same segments and techniques", same, shown)?;
        let hit = a.can_hit() == b.can_hit();
        hold("the same path has the same abilities", hit, || format!("it can be hit for technique {i} or {j} alone"))?;
        (0..l).try_for_each(|k| same_edge(a, b, k, tolerance))?;
        for n in 0..count {
            let (of_a, of_b) = (a.densities().density(n), b.densities().density(n));
            let common = a.densities().density(j);
            let shown =
                || format!("technique {n}: {of_a} over that of {i}, {of_b} over that of {j}, which is {common} of {i}");
            let same = near(of_b * common, of_a, tolerance);
            hold("densities are a function of the path, up to a common factor", same, shown)?;
        }
        Ok(())
    };
    Outcome::of_laws(test, laws() as Law)
}

fn same_edge(a: &impl PathTechniques, b: &impl PathTechniques, k: usize, tolerance: f64) -> Law {
    let same = a.can_connect(k) == b.can_connect(k)
        && a.is_specular(k) == b.is_specular(k)
        && a.position(k + 1).is_some() == b.position(k + 1).is_some();
    hold("the same path has the same abilities", same, || format!("they differ at edge {k}"))?;
    let distance = a.distance_squared(k).sqrt().min(b.distance_squared(k).sqrt());
    let moved = [k, k + 1].map(|k| match (a.position(k), b.position(k)) {
        (Some(x), Some(y)) => f64::from(x.distance(y)),
        _ => 0.0,
    });
    let turned = a.direction(k).distance(b.direction(k));
    let [of_a, of_b] = [a.geometry_term(k), b.geometry_term(k)].map(f64::from);
    let shown =
        || format!("edge {k} of length {distance}: moved by {moved:?}, turned by {turned}, G {of_a} and {of_b}");
    let size = f64::from(if distance.is_finite() { distance } else { 1.0 });
    let near_by = moved.iter().all(|&moved| moved <= tolerance * size);
    let same = near_by && f64::from(turned) <= tolerance && near(of_a, of_b, tolerance);
    hold("geometry is a function of the path", same, shown)
}
