//! Densities for use beside another technique.
use crate::Real;
use alloc::vec::Vec;

/// Weights less their mean, where positive: the density that serves best beside a uniform technique under the balance
/// heuristic, instead of alone.
///
/// The dark parts are left to the other technique, so these weights must be used with multiple importance sampling: alone
/// they are biased. Weights that are all alike are returned as they are. Weights that are NaN give NaN, which tables refuse.
///
/// Source: Karlík, Šik, Vévoda, Skřivan and Křivánek, "MIS compensation: optimizing sampling techniques in multiple importance
/// sampling" (2019), equation 12.
///
/// ```
/// use qmc_sampling::warp::mis_compensated;
/// assert_eq!(mis_compensated(&[1.0_f32, 1.0, 4.0]), [0.0, 0.0, 2.0]);
/// assert_eq!(mis_compensated(&[3.0_f32, 3.0]), [3.0, 3.0]);
/// ```
#[must_use]
pub fn mis_compensated<F: Real>(weights: &[F]) -> Vec<F> {
    let mean = weights.iter().map(|w| w.to_f64()).sum::<f64>() / weights.len() as f64;
    let compensated: Vec<F> = weights.iter().map(|w| compensate(w.to_f64() - mean)).collect();
    if compensated.iter().all(|&w| w == F::ZERO) { weights.to_vec() } else { compensated }
}

fn compensate<F: Real>(difference: f64) -> F {
    if difference < 0.0 { F::ZERO } else { F::of(difference) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::{PiecewiseConstant1d, TableError};

    #[test]
    fn ends() {
        assert!(mis_compensated::<f32>(&[]).is_empty());
        assert_eq!(mis_compensated(&[2.0_f64]), [2.0]);
        let refused = PiecewiseConstant1d::new(&mis_compensated(&[1.0_f32, f32::NAN]));
        assert!(matches!(refused, Err(TableError::InvalidWeight { .. })));
    }
}
