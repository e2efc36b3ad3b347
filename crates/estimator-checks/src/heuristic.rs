//! The laws of multiple importance sampling weights.

use std::cell::Cell;
use std::ops::RangeInclusive;

use mis_heuristics::{Densities, Float, Heuristic};

use crate::outcome::Outcome;
use crate::seed::{Uniforms, seed};
use crate::verdict::{Undecided, Verdict, Violation};

const METHOD: &str = "laws of heuristics";

/// Densities of which every combination is tried for up to three techniques.
const GRID: [f64; 9] = [0.0, 1e-38, 1e-20, 1e-3, 1.0, 1.5, 1e3, 1e20, 1e38];

/// Checks the laws of a heuristic with the default [`HeuristicLaws`].
///
/// ```
/// use estimator_checks::check_heuristic;
/// use mis_heuristics::{Balance, Densities, Heuristic};
///
/// check_heuristic::<f32>("balance", &Balance).expect_pass();
///
/// /// Forgets that the sum may overflow or vanish.
/// struct Naive;
/// impl Heuristic<f32> for Naive {
///     fn weight(&self, technique: usize, densities: &(impl Densities<f32> + ?Sized)) -> f32 {
///         densities.density(technique) / (0..densities.len()).map(|i| densities.density(i)).sum::<f32>()
///     }
/// }
/// check_heuristic::<f32>("naive", &Naive).expect_reject();
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_heuristic<F: Float>(test: &str, heuristic: &impl Heuristic<F>) -> Outcome {
    HeuristicLaws::new().run(test, heuristic)
}

/// Checks the laws of a heuristic on many density vectors.
///
/// ```text
/// (1)  sum_i w_i = 1        wherever any density is positive
/// (2)  w_i = 0              if density i is zero
/// (3)  w_i is finite        for any finite densities, all of them zero included
/// ```
///
/// - `w_i = heuristic.weight(i, densities)`; density `i` is `n_i p_i` in a measure common to all techniques.
///
/// Law (1) holds within `ulps * n * epsilon * max(1, sum_i |w_i|)`. The densities are all combinations of nine values from
/// zero through 1e-38 to 1e38 for up to three techniques, and random ones, log-uniform in the same range with zeros
/// among them, for more. A heuristic that asks for a technique that does not exist breaks a law, too.
///
/// No chance is involved: the random vectors follow from the name, and a counterexample is a proof. The statistic is the
/// largest deviation of a sum from one.
///
/// Source: Veach, Guibas, "Optimally combining sampling techniques for Monte Carlo rendering" (1995), section 3.
///
/// ```
/// use estimator_checks::HeuristicLaws;
/// use mis_heuristics::Power;
///
/// HeuristicLaws::new().techniques(2..=4).ulps(16.0).run::<f64>("power", &Power::TWO).expect_pass();
/// ```
#[derive(Clone, Debug)]
pub struct HeuristicLaws {
    techniques: RangeInclusive<usize>,
    vectors: usize,
    ulps: f64,
    zeros: bool,
}

impl Default for HeuristicLaws {
    fn default() -> Self {
        Self::new()
    }
}

impl HeuristicLaws {
    /// One to eight techniques, 1000 random vectors for each number above three, 8 ulps per technique.
    pub fn new() -> Self {
        Self { techniques: 1..=8, vectors: 1000, ulps: 8.0, zeros: true }
    }

    /// The numbers of techniques to try.
    #[must_use]
    pub fn techniques(self, techniques: RangeInclusive<usize>) -> Self {
        Self { techniques, ..self }
    }

    /// How many random vectors for each number of techniques above three.
    #[must_use]
    pub fn vectors(self, vectors: usize) -> Self {
        Self { vectors, ..self }
    }

    /// The round-off per technique that law (1) forgives.
    #[must_use]
    pub fn ulps(self, ulps: f64) -> Self {
        Self { ulps, ..self }
    }

    /// Tries positive densities only: for heuristics that ask for none and learn by other means which technique cannot
    /// generate a sample, such as stratification by a predicate.
    #[must_use]
    pub fn positive_only(self) -> Self {
        Self { zeros: false, ..self }
    }

    /// Checks the laws of a heuristic. An empty range of techniques leaves the check undecided.
    #[must_use = "it decides nothing until it is expected to pass or to reject"]
    pub fn run<F: Float>(&self, test: &str, heuristic: &impl Heuristic<F>) -> Outcome {
        let seed = seed(test);
        let mut uniforms = Uniforms::new(seed);
        let (mut vectors, mut worst) = (0_u64, 0.0_f64);
        let mut densities: Vec<f64> = Vec::new();
        for n in self.techniques.clone().filter(|&n| n > 0) {
            let combinations = if n <= 3 { GRID.len().pow(n as u32) } else { self.vectors };
            for index in 0..combinations {
                densities.clear();
                densities.extend((0..n).map(|i| self.density(n, index, i, &mut uniforms)));
                if !self.zeros && densities.contains(&0.0) {
                    continue;
                }
                vectors += 1;
                match self.judge(heuristic, &densities) {
                    Ok(deviation) => worst = worst.max(deviation),
                    Err(violation) => {
                        return Outcome::exact(test, seed, METHOD, worst, Verdict::Violation(violation));
                    }
                }
            }
        }
        let verdict = if vectors == 0 {
            Verdict::Undecided(Undecided::TooFew { what: "vectors of densities", count: 0, needed: 1 })
        } else {
            Verdict::Pass
        };
        Outcome::exact(test, seed, METHOD, worst, verdict).with_detail(format!("{vectors} vectors of densities"))
    }

    fn density(&self, n: usize, index: usize, technique: usize, uniforms: &mut Uniforms) -> f64 {
        if n <= 3 {
            return GRID[index / GRID.len().pow(technique as u32) % GRID.len()];
        }
        let [zero, exponent] = uniforms.array();
        if self.zeros && zero < 0.25 { 0.0 } else { 10.0_f64.powf(76.0 * exponent - 38.0) }
    }

    /// The deviation of the sum of the weights from one.
    fn judge<F: Float>(&self, heuristic: &impl Heuristic<F>, densities: &[f64]) -> Result<f64, Violation> {
        let probe = Probe { densities, out_of_range: Cell::new(None) };
        let law = |law, counterexample| Violation::Law { law, counterexample };
        let (mut sum, mut size) = (0.0, 0.0);
        for (technique, &density) in densities.iter().enumerate() {
            let weight = heuristic.weight(technique, &probe).to_f64();
            if let Some(asked) = probe.out_of_range.get() {
                let text = format!("technique {asked} was asked for among {densities:?}");
                return Err(law("a heuristic asks for techniques that exist", text));
            }
            if !weight.is_finite() {
                return Err(law("weights are finite", format!("w_{technique} = {weight} for {densities:?}")));
            }
            if density == 0.0 && weight != 0.0 {
                let text = format!("w_{technique} = {weight} for {densities:?}");
                return Err(law("a technique of density zero has weight zero", text));
            }
            sum += weight;
            size += weight.abs();
        }
        if densities.iter().all(|&density| density == 0.0) {
            return Ok(0.0);
        }
        let deviation = (sum - 1.0).abs();
        if deviation > self.ulps * densities.len() as f64 * F::EPSILON.to_f64() * size.max(1.0) {
            return Err(law("weights sum to one", format!("the sum is 1 + {:e} for {densities:?}", sum - 1.0)));
        }
        Ok(deviation)
    }
}

/// Densities that notice when a technique is asked for that does not exist.
struct Probe<'a> {
    densities: &'a [f64],
    out_of_range: Cell<Option<usize>>,
}

impl<F: Float> Densities<F> for Probe<'_> {
    fn len(&self) -> usize {
        self.densities.len()
    }

    fn density(&self, technique: usize) -> F {
        match self.densities.get(technique) {
            Some(&density) => F::from_f64(density),
            None => {
                self.out_of_range.set(Some(technique));
                F::ZERO
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A careful balance heuristic, with room for a bug.
    struct Shares {
        total: f64,
        floor: f64,
        ask: usize,
    }

    const CORRECT: Shares = Shares { total: 1.0, floor: 0.0, ask: 0 };

    impl<F: Float> Heuristic<F> for Shares {
        fn weight(&self, technique: usize, densities: &(impl Densities<F> + ?Sized)) -> F {
            let own = densities.density(technique + self.ask).to_f64();
            let sum: f64 = (0..densities.len()).map(|i| densities.density(i).to_f64()).sum();
            F::from_f64(if sum > 0.0 { self.total * own / sum + self.floor } else { 0.0 })
        }
    }

    fn message(outcome: Outcome) -> String {
        outcome.expect_reject().to_string()
    }

    #[test]
    fn a_correct_heuristic_passes() {
        check_heuristic::<f32>("f32", &CORRECT).expect_pass();
        check_heuristic::<f64>("f64", &CORRECT).expect_pass();
    }

    #[test]
    fn planted_bugs_are_named() {
        let leaky = Shares { total: 0.99, ..CORRECT };
        assert!(message(check_heuristic::<f32>("0.99", &leaky)).contains("weights sum to one"));
        let floored = Shares { floor: 1e-3, ..CORRECT };
        assert!(message(HeuristicLaws::new().techniques(2..=2).run::<f64>("floor", &floored)).contains("density zero"));
        let off_by_one = Shares { ask: 1, ..CORRECT };
        assert!(message(check_heuristic::<f64>("off by one", &off_by_one)).contains("techniques that exist"));
    }

    #[test]
    fn planted_bug_overflow() {
        struct Squares;
        impl Heuristic<f32> for Squares {
            fn weight(&self, technique: usize, densities: &(impl Densities<f32> + ?Sized)) -> f32 {
                let square = |i| densities.density(i) * densities.density(i);
                let sum: f32 = (0..densities.len()).map(square).sum();
                if sum > 0.0 { square(technique) / sum } else { 0.0 }
            }
        }
        check_heuristic("squares", &Squares).expect_reject();
    }

    #[test]
    fn heuristics_that_ask_for_nothing() {
        struct First;
        impl Heuristic<f32> for First {
            fn weight(&self, technique: usize, _: &(impl Densities<f32> + ?Sized)) -> f32 {
                f32::from(u8::from(technique == 0))
            }
        }
        HeuristicLaws::new().positive_only().run("first", &First).expect_pass();
        check_heuristic("first", &First).expect_reject();
    }

    #[test]
    fn nothing_to_try_is_undecided() {
        let none = HeuristicLaws::new().techniques(0..=0).run::<f64>("none", &CORRECT);
        assert!(!none.passed() && !none.rejected());
    }
}
