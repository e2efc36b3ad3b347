//! The laws of the trait of this crate: [`Domain`].

use super::tools::{Law, hold};
use crate::domain::{Coordinates, Domain};
use crate::outcome::Outcome;

/// Steps of the grid along each parameter.
const STEPS: u16 = 40;
/// Half of a step of the finite differences.
const STEP: f64 = 1e-5;

/// Checks the laws of a [`Domain`].
///
/// ```text
/// (1)  measure() is positive and finite, points are finite
/// (2)  | dx/du x dx/dv | = measure()          the map preserves area; | dx/du | = measure() for one dimension
/// (3)  parameters(point(u, v)) = (u, v)       (u alone for one dimension)
/// (4)  parameters is nothing for what is none of its points
/// ```
///
/// `coordinates` takes a point `x` apart; `outside` are points that are none of the domain. Derivatives are finite differences, so (2)
/// holds within 1e-4 relative, (3) within 1e-6. No chance is involved: the parameters are a grid.
///
/// ```
/// use estimator_checks::{Sphere, laws::domain::check_domain};
///
/// check_domain("sphere", &Sphere, |w| w, [[0.0; 3], [f64::NAN; 3]]).expect_pass();
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_domain<D: Domain, C: AsRef<[f64]>>(
    test: &str,
    domain: &D,
    coordinates: impl Fn(D::Point) -> C,
    outside: impl IntoIterator<Item = D::Point>,
) -> Outcome {
    Outcome::of_laws(test, laws(domain, |point| coordinates(point).as_ref().to_vec(), outside))
}

fn laws<D: Domain>(
    domain: &D,
    coordinates: impl Fn(D::Point) -> Vec<f64>,
    outside: impl IntoIterator<Item = D::Point>,
) -> Law {
    let measure = domain.measure();
    hold("the measure is positive and finite", measure > 0.0 && measure.is_finite(), || format!("{measure}"))?;
    let inside = |i: u16| (f64::from(i) + 0.5) / f64::from(STEPS);
    for [u, v] in (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| [inside(i), inside(j)])) {
        let point = domain.point([u, v]);
        let shown = || format!("{point:?} at {u}, {v}");
        hold("points are finite", point.is_finite(), shown)?;
        let found = domain.parameters(point);
        let near = |axis: usize| found.is_some_and(|found| (found[axis] - [u, v][axis]).abs() <= 1e-6);
        let same = near(0) && (D::DIMENSIONS == 1 || near(1));
        hold("parameters inverts point", same, || format!("{found:?} for {}", shown()))?;
        let stretch = stretch(domain, &coordinates, [u, v]);
        let shown = || format!("{stretch} instead of {measure} for {}", shown());
        hold("point preserves area", (stretch - measure).abs() <= 1e-4 * measure, shown)?;
    }
    for point in outside {
        let found = domain.parameters(point);
        hold("what is no point has no parameters", found.is_none(), || format!("{found:?} for {point:?}"))?;
    }
    Ok(())
}

/// By how much the map stretches area, or length.
fn stretch<D: Domain>(domain: &D, coordinates: impl Fn(D::Point) -> Vec<f64>, [u, v]: [f64; 2]) -> f64 {
    let difference = |du: f64, dv: f64| -> Vec<f64> {
        let [ahead, behind] = [1.0, -1.0].map(|sign| coordinates(domain.point([u + sign * du, v + sign * dv])));
        ahead.iter().zip(&behind).map(|(a, b)| (a - b) / (2.0 * STEP)).collect()
    };
    let (along_u, along_v) = (difference(STEP, 0.0), difference(0.0, STEP));
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    if D::DIMENSIONS == 1 {
        return dot(&along_u, &along_u).sqrt();
    }
    (dot(&along_u, &along_u) * dot(&along_v, &along_v) - dot(&along_u, &along_v).powi(2)).max(0.0).sqrt()
}
