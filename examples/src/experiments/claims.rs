//! Claims about ratios.

use super::{Claim, Ratio};

fn claim(id: impl Into<String>, paper: String, ratio: Ratio, holds: bool) -> Claim {
    Claim { id: id.into(), paper, measured: ratio.value, ci95: ratio.ci95, holds }
}

/// A claim that a ratio is no less than a limit.
pub(super) fn at_least(id: impl Into<String>, ratio: Ratio, limit: f64) -> Claim {
    claim(id, format!(">= {limit}"), ratio, ratio.value >= limit)
}

/// A claim that a ratio is no more than a limit.
pub(super) fn at_most(id: impl Into<String>, ratio: Ratio, limit: f64) -> Claim {
    claim(id, format!("<= {limit}"), ratio, ratio.value <= limit)
}

/// A claim without a limit: reported as it is.
pub(super) fn reported(id: impl Into<String>, ratio: Ratio) -> Claim {
    claim(id, "-".to_owned(), ratio, true)
}
