//! The maximum heuristic.

use crate::{Densities, Float, Heuristic};

/// The maximum heuristic: the technique of largest density takes the whole weight.
///
/// ```text
/// w_i = 1 if d_i = max_j d_j, else 0,    d_j = n_j p_j
/// ```
///
/// **Symbols.** `d_j`: density of technique `j`, all in the same measure. Among equal ones the first wins.
///
/// **Assumptions.** The laws of [`Heuristic`]; none beyond.
///
/// **Unbiased.** It partitions the domain like the stratification heuristic, but by densities: all of them have to be
/// computed before anything is known.
///
/// **Cost.** Asks for the technique's own density and then for the others until one is larger: all of them, each once,
/// where the weight is one.
///
/// **Source.** E. Veach and L. Guibas 1995, section 4; Kollig and Keller 2004, section 3.1 with beta = infinity.
///
/// # Example
/// ```
/// use mis_heuristics::{Heuristic, Maximum};
/// let densities = [0.5, 2.0, 2.0];
/// assert_eq!([0, 1, 2].map(|i| Maximum.weight(i, &densities)), [0.0, 1.0, 0.0]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Maximum;

impl<F: Float> Heuristic<F> for Maximum {
    #[inline]
    fn weight(&self, technique: usize, densities: &(impl Densities<F> + ?Sized)) -> F {
        let own = densities.density(technique).positive_part();
        if own <= F::ZERO {
            return F::ZERO;
        }
        for other in 0..densities.len() {
            if other == technique {
                continue;
            }
            let density = densities.density(other).positive_part();
            if density > own || (density == own && other < technique) {
                return F::ZERO;
            }
        }
        F::ONE
    }
}
