//! Chi-square goodness of fit of a sampler against its density.

use crate::bins::{Bins, Stop, checked_density, checked_point};
use crate::domain::{Domain, IntoPoint};
use crate::outcome::Outcome;
use crate::pearson::{MIN_EXPECTED, Pearson, decide, pearson};
use crate::suite::Check;
use crate::verdict::{Undecided, Violation};

/// What it means that a sampler returns `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Missing {
    /// The sample was absorbed, rejected, or drawn from a discrete (specular) part: the density integrates to the
    /// probability of a sample, `q <= 1`, and `None` is a cell of its own, with probability `1 - q`.
    #[default]
    Counted,
    /// The density is that of the samples that there are, up to a constant factor: `None` is skipped, and the density is
    /// normalised by its integral. An error of the normalisation goes unnoticed; see
    /// [`Normalisation`](crate::Normalisation).
    Ignored,
}

/// Chi-square goodness of fit of a sampler against its density, over any [`Domain`].
///
/// ```text
/// X^2 = sum_i (O_i - E_i)^2 / E_i,     E_i = n integral_{cell i} p(x) dx
/// ```
///
/// - `O_i`: the number of samples in cell `i` of `rows * columns` cells of equal measure,
/// - `p`: the claimed density, with respect to the domain's measure (solid angle, area or length),
/// - `n`: the number of calls of the sampler.
///
/// Assumes that the samples are independent: a quasi-Monte Carlo sampler fails by fitting too well or too badly.
///
/// The expected counts come from adaptive quadrature in `f64`, refined until its error is far below what `n` samples
/// resolve; the samples show it where narrow peaks are. Cells that expect fewer than `min_expected` samples are pooled.
/// The p-value is that of [`chi_square_counts`](crate::chi_square_counts). Cost: `n` samples, and at least `n +
/// 49 rows columns` densities.
///
/// These refute the density with certainty: samples or densities that are NaN or infinite, negative densities, samples
/// outside of the domain, samples in a cell of zero density (but for round-off at its edge), and an integral above one.
/// These leave the check undecided: too few samples for two pools, a quadrature that exceeds its budget, zero cells.
///
/// Sources: Pearson (1900); the use on directions follows Wenzel Jakob's tests in Mitsuba, Nori and pbrt.
///
/// ```
/// use estimator_checks::{Check, ChiSquare, Hemisphere};
///
/// let cosine = |[u, v, _]: [f64; 3]| {
///     let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
///     Some([u.sqrt() * cos, u.sqrt() * sin, (1.0 - u).sqrt()])
/// };
/// let test = ChiSquare::on(Hemisphere).samples(50_000);
/// test.run(Check::new("cosine", 1e-6)?, cosine, |w| w[2] / std::f64::consts::PI).expect_pass();
/// // The twin with a planted bug: the density forgets the cosine.
/// test.run(Check::new("uniform", 1e-6)?, cosine, |_| 0.5 / std::f64::consts::PI).expect_reject();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ChiSquare<D> {
    pub(crate) domain: D,
    pub(crate) cells: [usize; 2],
    pub(crate) samples: usize,
    pub(crate) min_expected: f64,
    pub(crate) missing: Missing,
    pub(crate) tolerance: f64,
    pub(crate) budget: usize,
}

impl<D: Domain> ChiSquare<D> {
    /// A test with 200 000 samples in 16 x 32 cells.
    pub fn on(domain: D) -> Self {
        Self {
            domain,
            cells: [16, 32],
            samples: 200_000,
            min_expected: MIN_EXPECTED,
            missing: Missing::Counted,
            tolerance: 1e-3,
            budget: 20_000_000,
        }
    }

    /// The number of cells along the two parameters of the domain; their product for one dimension.
    #[must_use]
    pub fn cells(self, rows: usize, columns: usize) -> Self {
        Self { cells: [rows, columns], ..self }
    }

    /// The number of calls of the sampler.
    #[must_use]
    pub fn samples(self, samples: usize) -> Self {
        Self { samples, ..self }
    }

    /// Cells that expect fewer samples are pooled; 10 unless set. Larger values make the far tail more exact.
    #[must_use]
    pub fn min_expected(self, min_expected: f64) -> Self {
        Self { min_expected, ..self }
    }

    /// What a sampler's `None` means.
    #[must_use]
    pub fn missing(self, missing: Missing) -> Self {
        Self { missing, ..self }
    }

    /// By how much the integral of the density may exceed one, for densities evaluated in `f32`; 1e-3 unless set.
    #[must_use]
    pub fn tolerance(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }

    /// The largest number of evaluations of the density by the quadrature; 20 million unless set.
    #[must_use]
    pub fn budget(self, budget: usize) -> Self {
        Self { budget, ..self }
    }

    /// Draws the samples and compares them with the density.
    ///
    /// `sample` maps three uniform numbers in `[0, 1)` to a point, as `f32` or `f64` array; it may use fewer, or draw
    /// more from a generator of its own (see [`Check::rng`]). `density` is evaluated at points in `f64`.
    pub fn run<S: IntoPoint<D::Point>>(
        &self,
        check: Check,
        mut sample: impl FnMut([f64; 3]) -> Option<S>,
        density: impl Fn(D::Point) -> f64,
    ) -> Outcome {
        let mut uniforms = check.uniforms();
        let mut bins = Bins::new(&self.domain, self.cells);
        let mut missing = 0;
        let result = self.validate().and_then(|()| {
            for _ in 0..self.samples {
                match sample(uniforms.array()) {
                    None => missing += 1,
                    Some(sample) => {
                        let point = checked_point(sample)?;
                        bins.add(point, checked_density(&density, point)?)?;
                    }
                }
            }
            self.compare(&bins, missing, &density)
        });
        match result {
            Ok(pearson) => decide(check, "chi-square", pearson)
                .with_detail(format!("{missing} of {} samples missing", self.samples)),
            Err(stop) => stop.into_outcome(check, "chi-square"),
        }
    }

    pub(crate) fn validate(&self) -> Result<(), Stop> {
        let argument = |text: String| Err(Undecided::Argument(text).into());
        if self.cells.contains(&0) {
            return argument(format!("a grid of {} x {} cells is empty", self.cells[0], self.cells[1]));
        }
        if self.samples == 0 {
            return Err(Undecided::TooFew { what: "samples", count: 0, needed: 1 }.into());
        }
        if !(self.min_expected > 0.0 && self.min_expected.is_finite()) {
            return argument(format!("{} is no minimum of expected counts", self.min_expected));
        }
        if !(self.tolerance >= 0.0 && self.tolerance.is_finite()) {
            return argument(format!("{} is no tolerance", self.tolerance));
        }
        Ok(())
    }

    /// Compares a filled histogram with the density.
    pub(crate) fn compare(
        &self,
        bins: &Bins<'_, D>,
        missing: u64,
        density: &impl Fn(D::Point) -> f64,
    ) -> Result<Option<Pearson>, Stop> {
        let masses = bins.masses(density, self.samples, self.budget)?;
        let integral = masses.total.value;
        let mut counts = bins.counts_on_support(&masses.cells)?;
        let n = self.samples as f64;
        let mut expected: Vec<f64>;
        match self.missing {
            Missing::Counted => {
                if integral > 1.0 + self.tolerance + masses.total.error {
                    let error = masses.total.error;
                    return Err(Violation::NotNormalised { integral, error, expected: "at most one" }.into());
                }
                // An integral within the tolerance above one is taken for one.
                let scale = n / integral.max(1.0);
                expected = masses.cells.iter().map(|mass| mass * scale).collect();
                expected.push(n * (1.0 - integral).max(0.0));
                counts.push(missing);
            }
            Missing::Ignored => {
                let scale = (n - missing as f64) / integral;
                expected = masses.cells.iter().map(|mass| mass * scale).collect();
            }
        }
        if expected.iter().any(|e| e.is_nan()) {
            return Err(Undecided::TooFew { what: "samples", count: 0, needed: 1 }.into());
        }
        Ok(pearson(&counts, &expected, self.min_expected))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_1_PI, TAU};

    use super::*;
    use crate::domain::{Disk, Hemisphere, Interval, Sphere, Square};
    use crate::kolmogorov_smirnov::kolmogorov_smirnov;

    fn check(name: &str) -> Check {
        Check::new(name, 1e-8).unwrap()
    }

    fn polar(z: f64, turns: f64) -> [f64; 3] {
        let r = (1.0 - z * z).max(0.0).sqrt();
        [r * (TAU * turns).cos(), r * (TAU * turns).sin(), z]
    }

    fn cosine([u, v, _]: [f64; 3]) -> Option<[f32; 3]> {
        Some(polar((1.0 - u).sqrt(), v).map(|x| x as f32))
    }

    /// A power-cosine lobe: p = (k + 1) z^k / 2 pi.
    fn lobe(k: f64) -> impl Fn([f64; 3]) -> Option<[f64; 3]> {
        move |[u, v, _]| Some(polar((1.0 - u).powf(1.0 / (k + 1.0)), v))
    }

    fn lobe_density(k: f64) -> impl Fn([f64; 3]) -> f64 {
        move |w| (k + 1.0) * w[2].max(0.0).powf(k) / TAU
    }

    #[test]
    fn hemisphere_cosine_and_its_twins() {
        let test = ChiSquare::on(Hemisphere);
        test.run(check("cosine"), cosine, |w| w[2] * FRAC_1_PI).expect_pass();
        test.run(check("cosine forgotten"), cosine, |_| 0.5 * FRAC_1_PI).expect_reject();
        test.run(check("2 % too large"), cosine, |w| 1.02 * w[2] * FRAC_1_PI).expect_reject();
        test.run(check("2 % too small"), cosine, |w| 0.98 * w[2] * FRAC_1_PI).expect_reject();
        let tilted = |w: [f64; 3]| w[2] * FRAC_1_PI * (1.0 + 0.02 * w[0] / (1.0 - w[2] * w[2]).sqrt().max(1e-9));
        ChiSquare::on(Hemisphere).samples(1_000_000).run(check("tilted by 2 %"), cosine, tilted).expect_reject();
    }

    #[test]
    fn sphere_peaks_that_are_narrower_than_a_cell() {
        for k in [1.0, 100.0, 1e4, 1e7] {
            let (sample, density) = (lobe(k), lobe_density(k));
            let test = ChiSquare::on(Sphere).samples(50_000).cells(8, 16);
            let outcome = test.run(check(&format!("lobe {k}")), &sample, &density);
            outcome.expect_pass();
            test.run(check(&format!("lobe {k}, 2 %")), &sample, |w| 0.98 * density(w)).expect_reject();
        }
        // The exponent is off: cells that resolve the lobe notice.
        let test = ChiSquare::on(Sphere).cells(256, 4);
        test.run(check("exponent off"), lobe(100.0), lobe_density(105.0)).expect_reject();
    }

    #[test]
    fn peaks_away_from_the_pole() {
        // Two narrow lobes around x and -y, one of them with 5 % of the mass.
        let (sample, density) = (lobe(1e5), lobe_density(1e5));
        let rotate = |w: [f64; 3], second: bool| if second { [w[0], -w[2], w[1]] } else { [w[2], w[0], w[1]] };
        let both = |u: [f64; 3]| sample(u).map(|w| rotate(w, u[2] < 0.05));
        let pdf = |w: [f64; 3]| 0.95 * density([w[1], w[2], w[0]]) + 0.05 * density([w[0], w[2], -w[1]]);
        let test = ChiSquare::on(Sphere).samples(50_000);
        test.run(check("two lobes"), both, pdf).expect_pass();
        let wrong = |w: [f64; 3]| 0.93 * density([w[1], w[2], w[0]]) + 0.07 * density([w[0], w[2], -w[1]]);
        test.run(check("two lobes, wrong shares"), both, wrong).expect_reject();
    }

    #[test]
    fn disk_square_and_interval() {
        let disk = |[u, v, _]: [f64; 3]| {
            let (sin, cos) = (TAU * v).sin_cos();
            Some([u.sqrt() * cos, u.sqrt() * sin])
        };
        ChiSquare::on(Disk).run(check("disk"), disk, |_| FRAC_1_PI).expect_pass();
        let clumped = |[u, v, _]: [f64; 3]| disk([u * u, v, 0.0]);
        ChiSquare::on(Disk).run(check("disk without the root"), clumped, |_| FRAC_1_PI).expect_reject();

        let tent = |u: [f64; 3]| Some([u[0].max(u[1]), u[2]]);
        ChiSquare::on(Square).run(check("linear"), tent, |x| 2.0 * x[0]).expect_pass();
        let bug = |u: [f64; 3]| Some([u[0].max(u[1]), u[0]]);
        ChiSquare::on(Square).run(check("correlated coordinates"), bug, |x| 2.0 * x[0]).expect_reject();

        let interval = Interval::new(0.0, 4.0).unwrap();
        let root = |x: f64| 0.25 / x.sqrt();
        ChiSquare::on(interval).run(check("singular"), |u| Some(4.0 * u[0] * u[0]), root).expect_pass();
        ChiSquare::on(interval).run(check("singular, off"), |u| Some(4.0 * u[0].powf(1.9)), root).expect_reject();
    }

    #[test]
    fn missing_samples_are_a_cell_of_their_own() {
        let absorbing = |u: [f64; 3]| if u[2] < 0.3 { None } else { cosine(u) };
        let test = ChiSquare::on(Hemisphere);
        test.run(check("absorbed 30 %"), absorbing, |w| 0.7 * w[2] * FRAC_1_PI).expect_pass();
        test.run(check("claimed 28 %"), absorbing, |w| 0.72 * w[2] * FRAC_1_PI).expect_reject();
        test.run(check("not divided"), absorbing, |w| w[2] * FRAC_1_PI).expect_reject();
        let ignoring = test.missing(Missing::Ignored);
        ignoring.run(check("conditional"), absorbing, |w| w[2] * FRAC_1_PI).expect_pass();
        ignoring.run(check("conditional, wrong shape"), absorbing, |_| 1.0).expect_reject();
    }

    #[test]
    fn violations_are_named() {
        let test = ChiSquare::on(Sphere).samples(20_000);
        let pdf = |w: [f64; 3]| w[2].max(0.0) * FRAC_1_PI;
        let text = |outcome: Outcome| outcome.expect_reject().to_string();
        let below = |u: [f64; 3]| cosine(u).map(|w| if u[2] < 0.001 { [w[0], w[1], -w[2]] } else { w });
        assert!(text(test.run(check("below"), below, pdf)).contains("density is zero"));
        let nan = |u: [f64; 3]| Some(if u[2] < 0.001 { [f64::NAN; 3] } else { polar(u[0], u[1]) });
        assert!(text(test.run(check("nan"), nan, pdf)).contains("sample is not finite"));
        assert!(text(test.run(check("long"), |_| Some([0.0, 0.0, 2.0]), pdf)).contains("outside"));
        assert!(text(test.run(check("nan density"), cosine, |_| f64::NAN)).contains("density is not finite"));
        assert!(text(test.run(check("negative"), cosine, |w| w[2] - 0.5)).contains("negative"));
        assert!(text(test.run(check("too large"), cosine, |_| 1.0)).contains("integrates"));
    }

    #[test]
    fn round_off_at_the_edge_of_the_support_is_forgiven() {
        let grazing = |u: [f64; 3]| cosine(u).map(|w| if u[2] < 1e-4 { [1.0, 0.0, -1e-8] } else { w });
        let pdf = |w: [f64; 3]| w[2].max(0.0) * FRAC_1_PI;
        ChiSquare::on(Sphere).samples(20_000).run(check("grazing"), grazing, pdf).expect_pass();
    }

    #[test]
    fn undecided_cases() {
        let pdf = |w: [f64; 3]| w[2] * FRAC_1_PI;
        let test = ChiSquare::on(Hemisphere);
        let undecided = [
            test.samples(0).run(check("none"), cosine, pdf),
            test.samples(15).run(check("few"), cosine, pdf),
            test.cells(0, 3).run(check("no cells"), cosine, pdf),
            test.min_expected(f64::NAN).run(check("nan"), cosine, pdf),
            test.tolerance(f64::NAN).run(check("nan tolerance"), cosine, pdf),
            test.samples(1000).budget(100).run(check("no budget"), cosine, |w| (1e4 * w[0]).sin().abs()),
            test.missing(Missing::Ignored).run(check("all missing"), |_| None::<[f64; 3]>, pdf),
        ];
        for outcome in undecided {
            assert!(!outcome.passed() && !outcome.rejected(), "{outcome}");
        }
    }

    #[test]
    fn p_values_are_uniform_under_the_null() {
        let test = ChiSquare::on(Hemisphere).samples(4_000).cells(8, 8);
        let p_values: Vec<f64> =
            (0..300).map(|i| test.run(check(&format!("null {i}")), cosine, |w| w[2] * FRAC_1_PI).p_value).collect();
        kolmogorov_smirnov(check("chi-square p-values"), &p_values, |p| p).expect_pass();
    }
}
