//! Does a density integrate to one?

use crate::bins::checked_density;
use crate::domain::Domain;
use crate::outcome::Outcome;
use crate::quadrature::{Hint, Integral, Rectangle, integrate};
use crate::verdict::{Undecided, Verdict, Violation};

/// The grid that the quadrature starts from.
const GRID: [usize; 2] = [8, 16];

/// What a density must integrate to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Total {
    /// One: every call of the sampler returns a sample.
    #[default]
    One,
    /// At most one: samples may be absorbed, rejected or discrete.
    AtMostOne,
}

/// Checks by quadrature that a density integrates to one, or to at most one. No chance is involved.
///
/// ```text
/// | integral p(x) dx - 1 | <= tolerance
/// ```
///
/// The quadrature is adaptive (3-point Gauss, 7-point Kronrod, in each direction) and starts from 8 x 16 cells of equal
/// measure. It may overlook a peak that is much narrower than the distance of its nodes, about 1/50 of a cell: name a
/// point on such a peak with [`peak`](Self::peak). Cost: 6000 densities for a smooth one.
///
/// NaN, infinite and negative densities are violations. A quadrature that does not reach a sixteenth of the tolerance
/// within its budget leaves the check undecided, unless the error does not matter.
///
/// ```
/// use std::f64::consts::PI;
/// use estimator_checks::{Hemisphere, Normalisation};
///
/// let check = Normalisation::on(Hemisphere);
/// check.run("cosine", |w| w[2] / PI).expect_pass();
/// check.run("cosine, not divided by pi", |w| w[2]).expect_reject();
/// assert!((check.integral(|w| w[2])?.value - PI).abs() < 1e-6);
/// # Ok::<(), estimator_checks::Violation>(())
/// ```
#[derive(Clone, Debug)]
pub struct Normalisation<D: Domain> {
    domain: D,
    total: Total,
    tolerance: f64,
    budget: usize,
    peaks: Vec<D::Point>,
}

impl<D: Domain> Normalisation<D> {
    /// A check that a density integrates to one within 1e-4.
    pub fn on(domain: D) -> Self {
        Self { domain, total: Total::One, tolerance: 1e-4, budget: 20_000_000, peaks: Vec::new() }
    }

    /// What the density must integrate to.
    #[must_use]
    pub fn total(self, total: Total) -> Self {
        Self { total, ..self }
    }

    /// The absolute tolerance of the integral; 1e-4 unless set.
    #[must_use]
    pub fn tolerance(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }

    /// The largest number of evaluations of the density; 20 million unless set.
    #[must_use]
    pub fn budget(self, budget: usize) -> Self {
        Self { budget, ..self }
    }

    /// Names a point where the density has a narrow peak. Points outside of the domain are ignored.
    #[must_use]
    pub fn peak(mut self, point: D::Point) -> Self {
        self.peaks.push(point);
        self
    }

    /// The integral of a non-negative function, to a sixteenth of the tolerance if the budget allows.
    ///
    /// # Errors
    /// The [`Violation`] if the function is NaN, infinite or negative somewhere.
    pub fn integral(&self, density: impl Fn(D::Point) -> f64) -> Result<Integral, Violation> {
        let measure = self.domain.measure();
        let mut hints = Vec::new();
        for &point in &self.peaks {
            let Some(at) = self.domain.parameters(point) else { continue };
            hints.push(Hint { at, value: checked_density(&density, point)? * measure });
            // A peak near a pole or the seam of the parametrisation has a part in other columns.
            for v in (0..=2 * GRID[1]).map(|half| half as f64 / (2 * GRID[1]) as f64) {
                let at = [at[0], v];
                hints.push(Hint { at, value: checked_density(&density, self.domain.point(at))? * measure });
            }
        }
        let cells = (0..GRID[0] * GRID[1]).map(|index| {
            let shape = if D::DIMENSIONS == 1 { [GRID[0] * GRID[1], 1] } else { GRID };
            Rectangle::cell(index, shape)
        });
        let mut f = |at| Ok(checked_density(&density, self.domain.point(at))? * measure);
        integrate(D::DIMENSIONS, cells, &hints, &mut f, |_| self.tolerance / 16.0, self.budget)
    }

    /// Integrates a density and judges the result.
    #[must_use = "it decides nothing until it is expected to pass or to reject"]
    pub fn run(&self, test: &str, density: impl Fn(D::Point) -> f64) -> Outcome {
        let exact = |statistic, verdict| Outcome::exact(test, 0, "quadrature", statistic, verdict);
        let Integral { value: integral, error, evaluations, converged } = match self.integral(density) {
            Ok(integral) => integral,
            Err(violation) => return exact(f64::NAN, Verdict::Violation(violation)),
        };
        let (excess, expected) = match self.total {
            Total::One => ((integral - 1.0).abs(), "one"),
            Total::AtMostOne => (integral - 1.0, "at most one"),
        };
        let verdict = if excess + error <= self.tolerance || (converged && excess <= self.tolerance) {
            Verdict::Pass
        } else if converged || excess - error > self.tolerance {
            Verdict::Violation(Violation::NotNormalised { integral, error, expected })
        } else {
            Verdict::Undecided(Undecided::Quadrature { integral, error, evaluations })
        };
        exact(integral, verdict)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_1_PI, TAU};

    use super::*;
    use crate::domain::{Disk, Hemisphere, Interval, Sphere, Square};

    #[test]
    fn every_domain() {
        Normalisation::on(Sphere).run("sphere", |_| 0.25 * FRAC_1_PI).expect_pass();
        Normalisation::on(Disk).run("disk", |_| FRAC_1_PI).expect_pass();
        Normalisation::on(Square).run("square", |x| 4.0 * x[0] * x[1]).expect_pass();
        let interval = Interval::new(1.0, 3.0).unwrap();
        Normalisation::on(interval).run("interval", |x| x / 4.0).expect_pass();
        Normalisation::on(interval).run("interval, 2 % off", |x| 1.02 * x / 4.0).expect_reject();
        Normalisation::on(Sphere).run("half a sphere", |w| w[2].max(0.0) * FRAC_1_PI).expect_pass();
        // An edge that no cell follows.
        let cone = |w: [f64; 3]| if w[0] > 0.9 { 1.0 / (TAU * 0.1) } else { 0.0 };
        Normalisation::on(Sphere).tolerance(1e-3).run("cone around x", cone).expect_pass();
    }

    #[test]
    fn at_most_one() {
        let half = Normalisation::on(Hemisphere);
        half.run("half", |w| 0.5 * w[2] * FRAC_1_PI).expect_reject();
        let half = half.total(Total::AtMostOne);
        half.run("half", |w| 0.5 * w[2] * FRAC_1_PI).expect_pass();
        half.run("too much", |w| 1.01 * w[2] * FRAC_1_PI).expect_reject();
    }

    #[test]
    fn a_named_peak_is_found() {
        let kappa = 1e8;
        let axis = [0.36, 0.48, 0.8];
        let density = move |w: [f64; 3]| {
            let squared: f64 = w.iter().zip(axis).map(|(a, b)| (a - b) * (a - b)).sum();
            kappa / TAU * (-0.5 * kappa * squared).exp()
        };
        Normalisation::on(Sphere).run("overlooked", density).expect_reject();
        Normalisation::on(Sphere).peak(axis).run("named", density).expect_pass();
    }

    #[test]
    fn peaks_at_the_pole_and_at_the_seam_are_found() {
        let kappa = 1e8;
        for axis in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.6, -1e-5, 0.8], [2e-4, 0.0, 1.0]] {
            let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
            let axis = axis.map(|x| x / length);
            let density = |w: [f64; 3]| {
                let squared: f64 = w.iter().zip(axis).map(|(a, b)| (a - b) * (a - b)).sum();
                kappa / TAU * (-0.5 * kappa * squared).exp()
            };
            Normalisation::on(Sphere).peak(axis).run(&format!("{axis:?}"), density).expect_pass();
        }
    }

    #[test]
    fn violations_and_undecided() {
        let check = Normalisation::on(Square);
        assert!(check.run("nan", |_| f64::NAN).expect_reject().to_string().contains("not finite"));
        assert!(check.run("negative", |x| 2.0 - 2.0 * x[0] - x[1]).expect_reject().to_string().contains("negative"));
        let outcome = check.budget(10_000).run("rough", |x| 2.0 * (1e5 * x[0] * x[1]).sin().powi(2));
        assert!(!outcome.passed() && !outcome.rejected(), "{outcome}");
    }
}
