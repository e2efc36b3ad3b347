//! Claims about ratios.
//!
//! Bounds on how much is gained are decided by what was measured, whose interval stands beside it; that two things differ, or agree,
//! by the interval.

use super::{Claim, Ratio};

fn claim(id: impl Into<String>, paper: String, ratio: Ratio, holds: bool) -> Claim {
    Claim { id: id.into(), paper, measured: ratio.value, ci95: ratio.ci95, holds, note: String::new() }
}

/// A claim that a ratio is no less than a limit.
pub(super) fn at_least(id: impl Into<String>, ratio: Ratio, limit: f64) -> Claim {
    claim(id, format!(">= {limit}"), ratio, ratio.value >= limit)
}

/// A claim that a ratio is no more than a limit.
pub(super) fn at_most(id: impl Into<String>, ratio: Ratio, limit: f64) -> Claim {
    claim(id, format!("<= {limit}"), ratio, ratio.value <= limit)
}

/// A claim that a ratio is more than a limit: so is all of the interval.
pub(super) fn above(id: impl Into<String>, ratio: Ratio, limit: f64) -> Claim {
    claim(id, format!("> {limit}"), ratio, ratio.ci95[0] > limit)
}

/// A claim that a ratio is less than a limit: so is all of the interval.
pub(super) fn below(id: impl Into<String>, ratio: Ratio, limit: f64) -> Claim {
    claim(id, format!("< {limit}"), ratio, ratio.ci95[1] < limit)
}

/// A claim that a ratio has a value. A true value lies outside of one interval in twenty, hence the share of it by which the interval may
/// miss: the tests decide on bias, with another error rate.
pub(super) fn equals(id: impl Into<String>, ratio: Ratio, value: f64, miss: f64) -> Claim {
    let [low, high] = ratio.ci95;
    claim(id, value.to_string(), ratio, low <= value * (1.0 + miss) && high >= value * (1.0 - miss))
}

/// A claim that a ratio is one, up to an error.
pub(super) fn about_one(id: impl Into<String>, ratio: Ratio, error: f64) -> Claim {
    claim(id, format!("1 +- {error}"), ratio, (ratio.value - 1.0).abs() <= error)
}

/// A claim without a limit: reported as it is.
pub(super) fn reported(id: impl Into<String>, ratio: Ratio) -> Claim {
    claim(id, "-".to_owned(), ratio, true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn claims_are_decided_as_they_say() {
        let ratio = Ratio { value: 2.0, ci95: [1.5, 2.5] };
        assert!(at_least("a", ratio, 2.0).holds && !at_least("a", ratio, 2.1).holds);
        assert!(at_most("a", ratio, 2.0).holds && !at_most("a", ratio, 1.9).holds);
        assert!(above("a", ratio, 1.4).holds && !above("a", ratio, 1.6).holds);
        assert!(below("a", ratio, 2.6).holds && !below("a", ratio, 2.4).holds);
        assert!(equals("a", ratio, 2.5, 0.0).holds && !equals("a", ratio, 2.6, 0.01).holds);
        assert!(!equals("a", ratio, 1.4, 0.01).holds && equals("a", ratio, 2.6, 0.05).holds);
        assert!(about_one("a", ratio, 1.0).holds && !about_one("a", ratio, 0.9).holds);
        let undefined = Ratio { value: f64::NAN, ci95: [f64::NAN; 2] };
        for claim in [at_least("a", undefined, 1.0), below("a", undefined, 1.0), equals("a", undefined, 1.0, 0.1)] {
            assert!(!claim.holds, "nothing was measured");
        }
    }

    #[test]
    fn reasons_belong_to_claims_that_do_not_hold() {
        let ratio = Ratio { value: 2.0, ci95: [1.5, 2.5] };
        assert_eq!(at_least("a", ratio, 3.0).because("rays are cheap").note, "rays are cheap");
        assert_eq!(at_least("a", ratio, 2.0).because("rays are cheap").note, "");
    }
}
