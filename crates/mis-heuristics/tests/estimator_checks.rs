//! The laws once more, by the check that is offered to everybody.

use estimator_checks::{HeuristicLaws, check_heuristic};
use mis_heuristics::{Balance, Cutoff, Densities, Heuristic, Maximum, OptimalMoments, Power, Stratification};

#[test]
fn classical_heuristics() {
    check_heuristic::<f32>("balance f32", &Balance).expect_pass();
    check_heuristic::<f64>("balance f64", &Balance).expect_pass();
    check_heuristic::<f32>("maximum f32", &Maximum).expect_pass();
    check_heuristic::<f64>("maximum f64", &Maximum).expect_pass();
    for beta in [1.0, 1.5, 2.0, 2.5, 4.0, 7.0, f64::INFINITY] {
        let power = Power::new(beta).unwrap();
        // Powers amplify the rounding of the ratio.
        let laws = HeuristicLaws::new().ulps(if beta.is_finite() { 8.0 * beta } else { 8.0 });
        laws.run::<f32>(&format!("power {beta} f32"), &power).expect_pass();
        laws.run::<f64>(&format!("power {beta} f64"), &power).expect_pass();
    }
    for alpha in [0.0, 0.1, 1.0] {
        let cutoff = Cutoff::new(alpha).unwrap();
        check_heuristic::<f32>(&format!("cutoff {alpha} f32"), &cutoff).expect_pass();
        check_heuristic::<f64>(&format!("cutoff {alpha} f64"), &cutoff).expect_pass();
    }
}

#[test]
fn strata() {
    let laws = HeuristicLaws::new().positive_only();
    for chosen in 0..8 {
        laws.run::<f32>(&format!("hard {chosen}"), &Stratification::new(|k| k == chosen)).expect_pass();
        laws.run::<f64>(&format!("reversed {chosen}"), &Stratification::by_light_vertices(|k| k == chosen))
            .expect_pass();
    }
    laws.run::<f32>("soft", &Stratification::new(|k| 1.0 / (2 + k) as f32)).expect_pass();
    // A technique that is impossible must be told so.
    check_heuristic::<f32>("unaware", &Stratification::new(|k| k == 0)).expect_reject();
}

#[test]
fn optimal_weights() {
    let mut moments = OptimalMoments::new([1, 2, 3]).unwrap();
    for (f, densities) in
        [(1.0, [0.2, 0.1, 0.9]), (0.0, [1.0, 0.0, 0.3]), (5.0, [0.5, 2.0, 0.1]), (2.0, [0.1, 0.1, 4.0])]
    {
        moments.add(f, &densities).unwrap();
    }
    let weights = moments.solve();
    let laws = HeuristicLaws::new().techniques(3..=3);
    laws.run::<f64>("optimal f64", &weights.at(1.5)).expect_pass();
    laws.run::<f32>("optimal f32", &weights.at(1.5)).expect_pass();
}

/// A planted bug: the balance heuristic, forgetting itself in the sum.
struct Forgetful;

impl Heuristic<f64> for Forgetful {
    fn weight(&self, technique: usize, densities: &(impl Densities<f64> + ?Sized)) -> f64 {
        let sum: f64 = (0..densities.len()).filter(|&i| i != technique).map(|i| densities.density(i)).sum();
        densities.density(technique) / (sum + 1e-300)
    }
}

#[test]
fn planted_bug() {
    check_heuristic("forgetful", &Forgetful).expect_reject();
}
