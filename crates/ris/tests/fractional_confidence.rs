//! Confidences below one, exactly.

use ris::{Resampled, Reservoir, Selected};

/// What a neighbour of this confidence offers: state `x` with contribution weight `w`.
fn given(sample: usize, contribution_weight: f64, confidence: f64) -> Resampled<usize, f64> {
    Resampled { selected: Some(Selected { sample, score: 1.0, contribution_weight }), confidence }
}

/// Two halves make one candidate's confidence, and are two candidates all the same: both weights have to count.
#[test]
fn confidences_that_add_up_to_one_are_not_one_candidate() {
    let target = |x: &usize| [1.0, 3.0][*x];
    let mut reservoir = Reservoir::new();
    reservoir.merge(given(0, 2.0, 0.5), &target, 0.5);
    reservoir.merge(given(1, 2.0, 0.5), &target, 0.9);
    let picked = reservoir.finish();
    assert_eq!(picked.sample(), Some(&0));
    // (1/2 * 1 * 2 + 1/2 * 3 * 2) / g(Y)
    assert_eq!(picked.contribution_weight(), 4.0);
}
