//! The laws of every heuristic, over random numbers of techniques and densities of any size.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use mis_heuristics::{
    Balance, Counting, Cutoff, Densities, Float, Heuristic, Lazy, Maximum, MultiSample, OptimalMoments, Power,
    Stratification,
};
use proptest::prelude::*;

/// The three laws of [`Heuristic`]; the sum may be off by a few roundings per technique.
fn check_laws<F: Float>(
    heuristic: &impl Heuristic<F>,
    densities: &(impl Densities<F> + ?Sized),
    slack: f64,
) -> Result<(), String> {
    let mut sum = 0.0;
    let mut any = false;
    for technique in 0..densities.len() {
        let weight = heuristic.weight(technique, densities).to_f64();
        let density = densities.density(technique);
        if !weight.is_finite() {
            return Err(format!("technique {technique} has the weight {weight}"));
        }
        if density == F::ZERO && weight != 0.0 {
            return Err(format!("technique {technique} has density zero and the weight {weight}"));
        }
        any |= density > F::ZERO;
        sum += weight;
    }
    let tolerance = slack * (4 + densities.len()) as f64 * F::EPSILON.to_f64();
    let expected = if any { 1.0 } else { 0.0 };
    if (sum - expected).abs() <= tolerance { Ok(()) } else { Err(format!("the weights sum to {sum}")) }
}

#[test]
fn slices_and_densities_behind_pointers_are_densities() {
    let (array, expected) = ([6.0_f32, 2.0, 0.0], 0.9);
    let slice: &[f32] = &array;
    let pointer: &dyn Densities<f32> = &array;
    assert_eq!(Power::TWO.weight(0, slice), expected);
    assert_eq!(Power::TWO.weight(0, pointer), expected);
    assert_eq!(Power::TWO.weight(0, &vec![6.0_f32, 2.0][..]), expected);
    let model = MultiSample::new([1, 3, 1]).unwrap();
    assert_eq!(model.factor(&Balance, 0, slice), model.factor(&Balance, 0, &array));
}

/// All heuristics of the crate that see nothing but densities.
fn check_all<F: Float>(densities: &[F]) -> Result<(), String> {
    let named = |name: &str, result: Result<(), String>| result.map_err(|e| format!("{name}: {e} for {densities:?}"));
    named("balance", check_laws(&Balance, &densities, 1.0))?;
    named("maximum", check_laws(&Maximum, &densities, 1.0))?;
    for beta in [1.0, 1.1, 1.5, 2.0, 2.5, 3.0, 5.0, 16.0, 33.3, 1e6, f64::INFINITY] {
        // Powers amplify the rounding of the ratio.
        let slack = if beta.is_finite() { 2.0 * beta } else { 1.0 };
        let power = Power::new(beta).unwrap();
        named(&format!("power {beta}"), check_laws(&power, &densities, slack))?;
    }
    for alpha in [0.0, 0.01, 0.5, 1.0] {
        named(&format!("cutoff {alpha}"), check_laws(&Cutoff::new(alpha).unwrap(), &densities, 1.0))?;
    }
    Ok(())
}

/// The stratification heuristic when told which techniques are possible.
fn check_strata<F: Float>(densities: &[F], shares: &[f64]) -> Result<(), String> {
    let possible = |k: usize| densities[k] > F::ZERO;
    let last = densities.len() - 1;
    let hard = Stratification::new(|k| possible(k).then(|| shares[k] > 0.5));
    let soft = Stratification::new(|k| possible(k).then(|| F::from_f64(shares[k])));
    if possible(last) {
        check_laws(&hard, &densities, 1.0)?;
        check_laws(&soft, &densities, 1.0)
    } else {
        check_laws(&hard.without_last(), &densities, 1.0)?;
        check_laws(&soft.without_last(), &densities, 1.0)
    }
    .map_err(|e| format!("{e} for {densities:?}, {shares:?}"))
}

/// Densities from 1e-38 to 1e38, zeros, and repetitions.
fn density() -> impl Strategy<Value = f64> {
    prop_oneof![
        2 => Just(0.0),
        1 => Just(1.0),
        2 => 0.1..10.0_f64,
        5 => (-38.0..38.0_f64).prop_map(|exponent| 10_f64.powf(exponent)),
        1 => Just(1e-38),
        1 => Just(1e38),
    ]
}

fn densities() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(density(), 1..40)
}

/// Every heuristic when technique `delta` has an infinite density.
fn check_delta(densities: &[f32], delta: usize) -> Result<(), String> {
    fn check(name: &str, heuristic: &impl Heuristic<f32>, densities: &[f32], delta: usize) -> Result<(), String> {
        for technique in 0..densities.len() {
            let weight = heuristic.weight(technique, &densities);
            let expected = if technique == delta { 1.0 } else { 0.0 };
            if weight != expected {
                return Err(format!("{name}: technique {technique} has weight {weight} for {densities:?}"));
            }
        }
        Ok(())
    }
    check("balance", &Balance, densities, delta)?;
    check("maximum", &Maximum, densities, delta)?;
    for beta in [1.5, 2.0, 3.0, f64::INFINITY] {
        check("power", &Power::new(beta).unwrap(), densities, delta)?;
    }
    for alpha in [0.0, 0.1, 1.0] {
        check("cutoff", &Cutoff::new(alpha).unwrap(), densities, delta)?;
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 500, ..ProptestConfig::default() })]

    #[test]
    fn laws_hold(densities in densities()) {
        check_all(&densities).map_err(TestCaseError::fail)?;
        let single: Vec<f32> = densities.iter().map(|&d| d as f32).collect();
        check_all(&single).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn laws_hold_over_the_range_of_f64(exponents in prop::collection::vec(-307.0..308.0_f64, 1..12)) {
        let densities: Vec<f64> = exponents.iter().map(|&e| 10_f64.powf(e)).collect();
        check_all(&densities).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn laws_hold_for_strata(techniques in prop::collection::vec((density(), -0.2..1.2_f64), 1..12)) {
        let (densities, shares): (Vec<f64>, Vec<f64>) = techniques.into_iter().unzip();
        check_strata(&densities, &shares).map_err(TestCaseError::fail)?;
        let single: Vec<f32> = densities.iter().map(|&d| d as f32).collect();
        check_strata(&single, &shares).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn laws_hold_for_optimal_weights(
        samples in prop::collection::vec((prop::array::uniform4(density()), -10.0..10.0_f64), 0..20),
        densities in prop::array::uniform4(density()), f in -1e3..1e3_f64,
    ) {
        let mut moments = OptimalMoments::new([1, 2, 3, 4]).unwrap();
        for (densities, f) in samples {
            let possible = densities.iter().any(|&d| d > 0.0);
            prop_assert_eq!(moments.add(f, &densities).is_ok(), possible);
        }
        let weights = moments.solve();
        for f in [f, 1e-30, 0.0, f64::NAN] {
            // Weights up to a thousand: so much larger are their roundings.
            check_laws(&weights.at(f), &densities, 1e4).map_err(TestCaseError::fail)?;
            check_laws(&weights.at(f), &densities.map(|d| d as f32), 1e4).map_err(TestCaseError::fail)?;
        }
    }

    #[test]
    fn an_infinite_density_takes_all(densities in densities(), delta in any::<prop::sample::Index>()) {
        let mut single: Vec<f32> = densities.iter().map(|&d| d as f32).collect();
        let delta = delta.index(single.len());
        single[delta] = f32::INFINITY;
        check_delta(&single, delta).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn nan_and_negative_count_as_zero(densities in densities(), bad in any::<prop::sample::Index>()) {
        let bad = bad.index(densities.len());
        let with = |value: f64| {
            let mut changed = densities.clone();
            changed[bad] = value;
            changed
        };
        for technique in 0..densities.len() {
            for value in [f64::NAN, -1.0, f64::NEG_INFINITY] {
                let (changed, zero) = (with(value), with(0.0));
                for beta in [1.0, 1.5, 2.0, 3.0, f64::INFINITY] {
                    let power = Power::new(beta).unwrap();
                    prop_assert_eq!(power.weight(technique, &&changed[..]), power.weight(technique, &&zero[..]));
                }
                let cutoff = Cutoff::new(0.3).unwrap();
                prop_assert_eq!(cutoff.weight(technique, &&changed[..]), cutoff.weight(technique, &&zero[..]));
            }
        }
    }

    #[test]
    fn every_density_is_asked_for_at_most_once(densities in prop::collection::vec(density(), 1..32)) {
        let single = Counting::new(Lazy::new(densities.len(), |i| densities[i] as f32));
        let len = densities.len() as u64;
        for technique in 0..densities.len() {
            let impossible = densities[technique] as f32 == 0.0;
            for beta in [1.0, 1.5, 2.0, 3.0] {
                Power::new(beta).unwrap().weight(technique, &single);
                prop_assert_eq!(single.take(), if impossible { 1 } else { len });
            }
            Maximum.weight(technique, &single);
            prop_assert!((1..=len).contains(&single.take()));
            Cutoff::new(0.1).unwrap().weight(technique, &single);
            prop_assert!((1..=len).contains(&single.take()));
            let _: f32 = Stratification::new(|k| densities[k] > 1.0).weight(technique, &single);
            prop_assert_eq!(single.take(), 0);
        }
    }
}

/// Heuristics with one error each: the check must find it.
mod planted {
    use super::*;

    /// The stratification heuristic as printed: the last weight is left out.
    struct AsPrinted;
    impl Heuristic<f64> for AsPrinted {
        fn weight(&self, technique: usize, densities: &(impl Densities<f64> + ?Sized)) -> f64 {
            if technique + 1 == densities.len() {
                0.0
            } else {
                Stratification::new(|k| k == 5).weight(technique, densities)
            }
        }
    }

    /// Ignores that a technique may be impossible.
    struct Equal;
    impl Heuristic<f64> for Equal {
        fn weight(&self, _: usize, densities: &(impl Densities<f64> + ?Sized)) -> f64 {
            1.0 / densities.len() as f64
        }
    }

    /// Squares that leave the range.
    struct Unguarded;
    impl Heuristic<f32> for Unguarded {
        fn weight(&self, technique: usize, densities: &(impl Densities<f32> + ?Sized)) -> f32 {
            let square = |i| densities.density(i) * densities.density(i);
            square(technique) / (0..densities.len()).map(square).sum::<f32>()
        }
    }

    /// Several largest densities, all of which take everything.
    struct Ties;
    impl Heuristic<f64> for Ties {
        fn weight(&self, technique: usize, densities: &(impl Densities<f64> + ?Sized)) -> f64 {
            let largest = (0..densities.len()).map(|i| densities.density(i)).fold(0.0, f64::max);
            if densities.density(technique) == largest { 1.0 } else { 0.0 }
        }
    }

    #[test]
    fn bugs_are_found() {
        assert!(check_laws(&AsPrinted, &[1.0, 1.0, 1.0], 1.0).is_err());
        assert!(check_laws(&Equal, &[1.0, 0.0], 1.0).is_err());
        assert!(check_laws(&Unguarded, &[1e30, 1e30], 1.0).is_err());
        assert!(check_laws(&Unguarded, &[1e-30, 1e-30], 1.0).is_err());
        assert!(check_laws(&Ties, &[2.0, 2.0], 1.0).is_err());
        // A specular vertex at which the light is connected all the same.
        assert!(check_laws(&Stratification::new(|_| true), &[0.0, 1.0], 1.0).is_err());
    }
}
