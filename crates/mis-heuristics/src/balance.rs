//! The balance heuristic.

use crate::math::{ratio, ratio_weight};
use crate::{Densities, Float, Heuristic};

/// The balance heuristic: weights in proportion to the densities.
///
/// ```text
/// w_i = d_i / sum_j d_j,    d_j = n_j p_j
/// ```
///
/// **Symbols.** `d_j`: density of technique `j`, all in the same measure.
///
/// **Assumptions.** The laws of [`Heuristic`]; none beyond.
///
/// **Unbiased.** Its variance is at most `(1/n) E^2` above that of the best weights, see
/// [`variance_bound`](crate::variance_bound).
///
/// **Cost.** Asks for all densities, each once; for one only if the technique's own density is zero. With two
/// techniques one addition and one division. Sums that overflow are avoided by adding up ratios of densities.
///
/// **Source.** E. Veach and L. Guibas 1995, equation 8; Kollig and Keller 2004, section 3.1 with beta = 1.
///
/// # Example
/// ```
/// use mis_heuristics::{Balance, Heuristic};
/// assert_eq!(Balance.weight(0, &[1.0, 3.0]), 0.25);
/// assert_eq!(Balance.weight(1, &[3e38_f32, 3e38]), 0.5);        // no overflow
/// assert_eq!(Balance.weight(1, &[1.0, f32::INFINITY]), 1.0);    // the delta takes all
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Balance;

impl<F: Float> Heuristic<F> for Balance {
    #[inline(always)]
    fn weight(&self, technique: usize, densities: &(impl Densities<F> + ?Sized)) -> F {
        if densities.len() != 2 {
            return ratio_weight(technique, densities, |ratio| ratio);
        }
        let own = densities.density(technique).positive_part();
        if own <= F::ZERO {
            return F::ZERO;
        }
        let other = densities.density(1 - technique).positive_part();
        let sum = own + other;
        if sum < F::INFINITY { own / sum } else { F::ONE / (F::ONE + ratio(other, own)) }
    }
}
