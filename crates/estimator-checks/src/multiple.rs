//! Many tests at once: corrections of p-values that keep the rate of the family.

/// The Bonferroni correction of the smallest of `count` p-values.
///
/// ```text
/// p' = min(1, count * p)
/// ```
///
/// Rejecting if `p' < alpha` keeps the probability of any false rejection among `count` tests below `alpha`, whatever
/// their dependence. NaN stays NaN.
///
/// ```
/// assert_eq!(estimator_checks::bonferroni(0.01, 20), 0.2);
/// assert_eq!(estimator_checks::bonferroni(0.2, 20), 1.0);
/// ```
pub fn bonferroni(p_value: f64, count: usize) -> f64 {
    let corrected = p_value * count as f64;
    if corrected > 1.0 { 1.0 } else { corrected }
}

/// Holm's step-down procedure: which hypotheses of a family are rejected at level `alpha`.
///
/// ```text
/// p_(1) <= .. <= p_(m):  reject (1), .., (k-1), where k is the first with p_(k) >= alpha / (m + 1 - k)
/// ```
///
/// The probability of any false rejection is at most `alpha`, whatever the dependence; the procedure rejects whatever
/// Bonferroni rejects, and possibly more. The cost is a sort.
///
/// A NaN is a test that failed to compute; it counts as a p-value of zero, so that it cannot hide. An empty family
/// gives an empty answer.
///
/// Source: Holm, "A simple sequentially rejective multiple test procedure", Scand. J. Statist. 6 (1979), 65-70.
///
/// ```
/// // The second survives Bonferroni (0.02 > 0.05 / 3), but not Holm (0.02 < 0.05 / 2).
/// assert_eq!(estimator_checks::holm(&[0.6, 0.02, 0.001], 0.05), [false, true, true]);
/// ```
pub fn holm(p_values: &[f64], alpha: f64) -> Vec<bool> {
    holm_adjusted(p_values).into_iter().map(|p| p < alpha).collect()
}

/// Holm's procedure as adjusted p-values: a hypothesis is rejected at any level above its adjusted p-value.
///
/// ```text
/// p'_(k) = max_{j <= k} min(1, (m + 1 - j) p_(j))
/// ```
///
/// See [`holm`] for the source and for NaN.
///
/// ```
/// assert_eq!(estimator_checks::holm_adjusted(&[0.5, 0.25]), [0.5, 0.5]);
/// ```
pub fn holm_adjusted(p_values: &[f64]) -> Vec<f64> {
    let value = |i: usize| if p_values[i].is_nan() { 0.0 } else { p_values[i] };
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&a, &b| value(a).total_cmp(&value(b)));
    let mut adjusted = vec![0.0; p_values.len()];
    let mut running = 0.0_f64;
    for (rank, &i) in order.iter().enumerate() {
        running = running.max(bonferroni(value(i), p_values.len() - rank));
        adjusted[i] = running;
    }
    adjusted
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_nan_cannot_hide() {
        assert_eq!(holm(&[f64::NAN, 0.9], 0.05), [true, false]);
        assert!(holm(&[], 0.05).is_empty());
    }

    proptest! {
        #[test]
        fn holm_agrees_with_its_definition(p in prop::collection::vec(0.0..0.2_f64, 1..12)) {
            let alpha = 0.1;
            let mut order: Vec<usize> = (0..p.len()).collect();
            order.sort_by(|&a, &b| p[a].total_cmp(&p[b]));
            let mut expected = vec![false; p.len()];
            for (k, &i) in order.iter().enumerate() {
                if p[i] >= alpha / (p.len() - k) as f64 { break; }
                expected[i] = true;
            }
            prop_assert_eq!(holm(&p, alpha), expected);
        }
    }
}
