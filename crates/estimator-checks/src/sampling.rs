//! The laws that tie a sampler, its density and the function it is made for together.

use crate::bins::{Stop, checked_density, checked_point};
use crate::chi_square::{ChiSquare, Missing};
use crate::domain::{Domain, IntoPoint};
use crate::mean::{Truth, mean_is};
use crate::moments::Moments;
use crate::normalisation::Normalisation;
use crate::outcome::{Outcome, Report};
use crate::pearson::{Pearson, decide};
use crate::quadrature::Integral;
use crate::suite::Check;
use crate::verdict::{Undecided, Verdict, Violation};

/// What the mean of weights in `f32` may be off by, relative to its size: 16 units of their round-off, 2e-6. It is far below
/// what samples that vary can resolve, and decides alone for those that do not.
const WEIGHT_ROUND_OFF: f64 = 16.0 * f32::EPSILON as f64;

/// What the sampler of a BSDF, a phase function or a light returns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampled<P> {
    /// The sample, as array of `f32` or `f64`.
    pub point: P,
    /// The weight of the estimator, `f / pdf`; for a BSDF `f cos / pdf`. One channel.
    pub weight: f64,
    /// The density that the sampler reports.
    pub pdf: f64,
}

/// Checks a sampler with the default [`SamplingCheck`].
///
/// ```
/// use std::f64::consts::{FRAC_1_PI, TAU};
/// use estimator_checks::{Check, Hemisphere, Sampled, check_sampling};
///
/// // A Lambertian surface of albedo 0.8.
/// let sample = |[u, v, _]: [f64; 3]| {
///     let (sin, cos) = (TAU * v).sin_cos();
///     let z = (1.0 - u).sqrt();
///     Some(Sampled { point: [u.sqrt() * cos, u.sqrt() * sin, z], weight: 0.8, pdf: z * FRAC_1_PI })
/// };
/// let pdf = |w: [f64; 3]| w[2] * FRAC_1_PI;
/// let eval = |w: [f64; 3]| 0.8 * FRAC_1_PI * w[2];
/// check_sampling(Check::new("Lambert", 1e-6)?, Hemisphere, sample, pdf, eval).expect_pass();
/// // The twin with a planted bug: the cosine is missing from the function.
/// check_sampling(Check::new("no cosine", 1e-6)?, Hemisphere, sample, pdf, |_| 0.8 * FRAC_1_PI).expect_reject();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
pub fn check_sampling<D: Domain + Clone, S: IntoPoint<D::Point>>(
    check: Check,
    domain: D,
    sample: impl FnMut([f64; 3]) -> Option<Sampled<S>>,
    pdf: impl Fn(D::Point) -> f64,
    eval: impl Fn(D::Point) -> f64,
) -> Report {
    SamplingCheck::on(domain).run(check, sample, pdf, eval)
}

/// Checks that a sampler, its density and the function it estimates belong together.
///
/// ```text
/// (1)  reported pdf = pdf(x) > 0,  weight * pdf = eval(x),  all finite        for every sample x
/// (2)  x is distributed like pdf                                              chi-square
/// (3)  E[weight] = integral eval(x) dx                                        t-test against quadrature: the albedo
/// ```
///
/// - `eval`: for a BSDF `f cos`; for a phase function or a light `f`. One channel of a spectrum at a time,
/// - `None` from the sampler counts as weight zero, and as [`Missing::Counted`] for (2): samples from a specular part
///   return `None`, because neither `pdf` nor `eval` know them.
///
/// (3) finds what (1) and (2) cannot: a sampler that never visits a part of the support of `eval`. Means that differ by
/// less than 2e-6 of their size are the same: weights that do not vary at all, as those of a diffuse surface, would else be
/// held against the round-off of an implementation in `f32`.
///
/// Assumes independent samples. (1) is exact and holds within a relative tolerance; (2) and (3) share the level of the
/// check equally. The report has three outcomes in this order; after a violation that prevents the others, one.
/// Cost: that of [`ChiSquare`], the quadrature of `eval`, and `n` more evaluations of `eval`. What is not finite, outside
/// of the domain or negative is a violation.
///
/// Source: the white furnace and chi-square tests of Mitsuba and pbrt, taken together.
#[derive(Clone, Debug)]
pub struct SamplingCheck<D: Domain> {
    chi_square: ChiSquare<D>,
    albedo: Normalisation<D>,
    tolerance: f64,
    outliers: f64,
}

impl<D: Domain + Clone> SamplingCheck<D> {
    /// 200 000 samples, a relative tolerance of 1e-3, no outliers.
    pub fn on(domain: D) -> Self {
        let albedo = Normalisation::on(domain.clone());
        Self { chi_square: ChiSquare::on(domain), albedo, tolerance: 1e-3, outliers: 0.0 }
    }

    /// The number of samples.
    #[must_use]
    pub fn samples(mut self, samples: usize) -> Self {
        self.chi_square = self.chi_square.samples(samples);
        self
    }

    /// The number of cells of the chi-square test.
    #[must_use]
    pub fn cells(mut self, rows: usize, columns: usize) -> Self {
        self.chi_square = self.chi_square.cells(rows, columns);
        self
    }

    /// What a sampler's `None` means to the chi-square test.
    #[must_use]
    pub fn missing(mut self, missing: Missing) -> Self {
        self.chi_square = self.chi_square.missing(missing);
        self
    }

    /// The relative tolerance of (1), for densities evaluated in `f32`; 1e-3 unless set.
    #[must_use]
    pub fn tolerance(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }

    /// The share of the samples that may break the equalities of (1), as where `f32` loses a grazing cosine; 0 unless set.
    #[must_use]
    pub fn outliers(self, outliers: f64) -> Self {
        Self { outliers, ..self }
    }

    /// The absolute error to which `eval` is integrated; 1e-4 unless set.
    #[must_use]
    pub fn albedo_tolerance(mut self, tolerance: f64) -> Self {
        self.albedo = self.albedo.tolerance(tolerance);
        self
    }

    /// Names a point where `eval` has a narrow peak.
    #[must_use]
    pub fn peak(mut self, point: D::Point) -> Self {
        self.albedo = self.albedo.peak(point);
        self
    }

    /// Draws the samples and checks (1), (2) and (3).
    pub fn run<S: IntoPoint<D::Point>>(
        &self,
        check: Check,
        sample: impl FnMut([f64; 3]) -> Option<Sampled<S>>,
        pdf: impl Fn(D::Point) -> f64,
        eval: impl Fn(D::Point) -> f64,
    ) -> Report {
        let drawn = self.chi_square.validate().and_then(|()| Ok(self.draw(&check, sample, &pdf, &eval)?));
        let drawn = match drawn {
            Ok(drawn) => drawn,
            Err(stop) => return Report { outcomes: vec![stop.into_outcome(check, "samples")] },
        };
        let equal = Outcome::exact(
            check.test(),
            check.seed(),
            "pdf and weight of each sample",
            drawn.worst,
            match drawn.unequal {
                Some(Violation::Unequal { cases, .. })
                    if cases as f64 <= self.outliers * self.chi_square.samples as f64 =>
                {
                    Verdict::Pass
                }
                Some(violation) => Verdict::Violation(violation),
                None => Verdict::Pass,
            },
        );
        let [shape, albedo] = check.split(["shape", "albedo"]);
        let shape = match drawn.shape {
            Ok(pearson) => decide(shape, "chi-square", pearson),
            Err(stop) => stop.into_outcome(shape, "chi-square"),
        };
        Report { outcomes: vec![equal, shape, self.judge_albedo(albedo, &drawn.weights, &drawn.highest, &eval)] }
    }

    fn draw<S: IntoPoint<D::Point>>(
        &self,
        check: &Check,
        mut sample: impl FnMut([f64; 3]) -> Option<Sampled<S>>,
        pdf: &impl Fn(D::Point) -> f64,
        eval: &impl Fn(D::Point) -> f64,
    ) -> Result<Drawn<D::Point>, Violation> {
        let mut uniforms = check.uniforms();
        let mut bins = self.chi_square.bins(&mut uniforms, |u| sample(u).map(|sampled| sampled.point))?;
        let mut comparison = Comparison { tolerance: self.tolerance, worst: 0.0, unequal: None };
        let mut weights = Moments::new();
        let mut missing = 0;
        let mut highest = Vec::new();
        let mut height = 0.0;
        for _ in 0..self.chi_square.samples {
            let Some(Sampled { point, weight, pdf: reported }) = sample(uniforms.array()) else {
                missing += 1;
                weights.push(0.0);
                continue;
            };
            let point = checked_point(point)?;
            let (density, value) = (checked_density(pdf, point)?, checked_density(eval, point)?);
            let at = || format!("{point:?}");
            if !weight.is_finite() || !reported.is_finite() {
                let what = if weight.is_finite() { "reported pdf" } else { "weight" };
                return Err(Violation::NotFinite { what, at: at() });
            }
            if reported <= 0.0 {
                return Err(Violation::Law {
                    law: "the pdf of a sample is positive",
                    counterexample: format!("it is {reported} at {}", at()),
                });
            }
            comparison.add("reported pdf and pdf() differ", reported, density, at);
            comparison.add("weight * pdf and eval() differ", weight * reported, value, at);
            weights.push(weight);
            bins.add(point, density)?;
            if value > height {
                height = value;
                highest = vec![point];
            }
        }
        let shape = self.chi_square.compare(&bins, missing, pdf);
        Ok(Drawn { worst: comparison.worst, unequal: comparison.unequal, shape, weights, highest })
    }

    fn judge_albedo(
        &self,
        check: Check,
        weights: &Moments,
        highest: &[D::Point],
        eval: &impl Fn(D::Point) -> f64,
    ) -> Outcome {
        const METHOD: &str = "mean weight against quadrature";
        let quadrature = highest.iter().fold(self.albedo.clone(), |quadrature, &point| quadrature.peak(point));
        match quadrature.integral(eval) {
            Err(violation) => Outcome::violation(check, METHOD, violation),
            Ok(integral) if !integral.converged => {
                let (error, evaluations) = (integral.error, integral.evaluations);
                Outcome::undecided(
                    check,
                    METHOD,
                    Undecided::Quadrature { integral: integral.value, error, evaluations },
                )
            }
            Ok(Integral { value, error, .. }) => {
                mean_is(check, weights, Truth { value, error: error + WEIGHT_ROUND_OFF * value.abs() })
            }
        }
    }
}

/// What the samples showed.
struct Drawn<P> {
    worst: f64,
    unequal: Option<Violation>,
    shape: Result<Option<Pearson>, Stop>,
    weights: Moments,
    highest: Vec<P>,
}

/// The worst of many relative differences.
struct Comparison {
    tolerance: f64,
    worst: f64,
    unequal: Option<Violation>,
}

impl Comparison {
    fn add(&mut self, what: &'static str, left: f64, right: f64, at: impl Fn() -> String) {
        let size = left.abs().max(right.abs());
        let difference = if size > 0.0 { (left - right).abs() / size } else { 0.0 };
        if difference > self.tolerance {
            let cases = match &self.unequal {
                Some(Violation::Unequal { cases, .. }) => cases + 1,
                _ => 1,
            };
            match &mut self.unequal {
                Some(Violation::Unequal { cases: count, .. }) if difference <= self.worst => *count = cases,
                unequal => *unequal = Some(Violation::Unequal { what, left, right, at: at(), cases }),
            }
        }
        self.worst = self.worst.max(difference);
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_1_PI, TAU};

    use super::*;
    use crate::domain::{Hemisphere, Interval};

    fn check(name: &str) -> Check {
        Check::new(name, 1e-8).unwrap()
    }

    fn cosine(u: f64, v: f64) -> [f64; 3] {
        let (sin, cos) = (TAU * v).sin_cos();
        [u.sqrt() * cos, u.sqrt() * sin, (1.0 - u).sqrt()]
    }

    fn pdf(w: [f64; 3]) -> f64 {
        w[2] * FRAC_1_PI
    }

    /// A cosine-sampled BSDF that is anisotropic and absorbs a tenth of the samples; in `f32`, as a renderer would.
    fn eval(w: [f64; 3]) -> f64 {
        0.5 * FRAC_1_PI * w[2] * (1.0 + w[0])
    }

    fn sample([u, v, x]: [f64; 3]) -> Option<Sampled<[f32; 3]>> {
        let point = cosine(u, v).map(|x| x as f32);
        let pdf = 0.9 * FRAC_1_PI * f64::from(point[2]);
        (x < 0.9).then(|| Sampled { point, weight: eval(point.map(f64::from)) / pdf, pdf })
    }

    fn run(name: &str, sample: impl FnMut([f64; 3]) -> Option<Sampled<[f32; 3]>>) -> Report {
        SamplingCheck::on(Hemisphere).run(check(name), sample, |w| 0.9 * pdf(w), eval)
    }

    #[test]
    fn a_consistent_sampler_passes() {
        assert_eq!(run("good", sample).expect_pass().outcomes.len(), 3);
    }

    #[test]
    fn planted_bugs() {
        let text = |report: Report| report.expect_reject().to_string();
        let broken = |change: fn(&mut Sampled<[f32; 3]>)| {
            move |u| {
                sample(u).map(|mut s| {
                    change(&mut s);
                    s
                })
            }
        };
        assert!(text(run("pdf 2 %", broken(|s| s.pdf *= 1.02))).contains("pdf() differ"));
        assert!(text(run("weight 2 %", broken(|s| s.weight *= 1.02))).contains("eval() differ"));
        assert!(text(run("nan", broken(|s| s.weight = f64::NAN))).contains("weight is not finite"));
        assert!(text(run("zero pdf", broken(|s| s.pdf = 0.0))).contains("is positive"));
        let swapped = broken(|s| s.point = [-s.point[1], s.point[0], s.point[2]]);
        assert!(text(run("rotated", swapped)).contains("differ"));
    }

    #[test]
    fn planted_bug_wrong_distribution() {
        // All equalities hold, but the samples are uniform instead of cosine-distributed.
        let uniform = |[u, v, x]: [f64; 3]| {
            let point = cosine(1.0 - (1.0 - u) * (1.0 - u), v);
            (x < 0.9).then(|| Sampled { point, weight: eval(point) / (0.9 * pdf(point)), pdf: 0.9 * pdf(point) })
        };
        let report = check_sampling(check("uniform"), Hemisphere, uniform, |w| 0.9 * pdf(w), eval);
        let report = report.expect_reject();
        assert!(report.outcomes[0].passed() && report.outcomes[1].rejected(), "{report}");
    }

    #[test]
    fn planted_bug_part_of_the_function_is_never_sampled() {
        let half = |u: [f64; 3]| Some(Sampled { point: 0.5 * u[0], weight: 0.5, pdf: 2.0 });
        let pdf = |x: f64| if x <= 0.5 { 2.0 } else { 0.0 };
        let report = check_sampling(check("half"), Interval::UNIT, half, pdf, |_| 1.0).expect_reject();
        let passed: Vec<bool> = report.outcomes.iter().map(Outcome::passed).collect();
        assert_eq!(passed, [true, true, false], "{report}");
    }

    /// A diffuse surface in `f32`: its weights do not vary but by round-off, nor do those of one that is a little too bright.
    #[test]
    fn weights_without_variance_are_not_held_against_round_off() {
        let albedo = 0.7_f32;
        let eval = |w: [f64; 3]| f64::from(albedo * std::f32::consts::FRAC_1_PI * w[2] as f32);
        let pdf = |w: [f64; 3]| f64::from(std::f32::consts::FRAC_1_PI * w[2] as f32);
        let run = |name: &str, ulps: f32| {
            let sample = |[u, v, _]: [f64; 3]| {
                let point = cosine(u, v).map(|x| x as f32);
                let weight = albedo * (1.0 + ulps * f32::EPSILON);
                Some(Sampled { point, weight: weight.into(), pdf: pdf(point.map(f64::from)) })
            };
            SamplingCheck::on(Hemisphere).samples(50_000).run(check(name), sample, pdf, eval)
        };
        run("constant weight", 0.0).expect_pass();
        run("constant weight, 4 ulps", 4.0).expect_pass();
        let report = run("constant weight, 100 ulps", 100.0).expect_reject();
        assert!(report.outcomes[0].passed() && report.outcomes[2].rejected(), "{report}");
    }

    #[test]
    fn outliers_are_counted() {
        let sometimes = |u: [f64; 3]| {
            sample(u).map(|mut s| {
                if u[2] < 1e-3 {
                    s.pdf *= 1.1;
                    s.weight /= 1.1;
                }
                s
            })
        };
        let strict = SamplingCheck::on(Hemisphere).samples(50_000);
        let lenient = strict.clone().outliers(0.01);
        strict.run(check("strict"), sometimes, |w| 0.9 * pdf(w), eval).expect_reject();
        let report = lenient.run(check("lenient"), sometimes, |w| 0.9 * pdf(w), eval);
        assert!(report.outcomes[0].passed(), "{report}");
    }

    #[test]
    fn no_samples_are_undecided() {
        let report = SamplingCheck::on(Hemisphere).samples(0).run(check("none"), sample, pdf, eval);
        assert!(!report.passed() && !report.rejected());
    }
}
