//! The central trait.

use crate::{Densities, Float};

/// A rule that shares the weight of a sample out among the techniques that could have generated it.
///
/// With `n_i` samples from technique `i`, distributed like `p_i`, the estimator of Kollig and Keller's equation 4
/// ```text
/// integral of f  ~  sum_i 1/n_i sum_j  w_i(x_ij) f(x_ij) / p_i(x_ij)
/// ```
/// is unbiased if the following laws hold.
///
/// # Laws
/// For every sample, and for any finite, non-negative densities:
/// 1. the weights of all techniques sum to one (up to rounding) if any density is positive;
/// 2. a technique of density zero has weight zero;
/// 3. weights are finite. (They need not be in `[0, 1]`, although those of this crate's heuristics are.)
///
/// The heuristics of this crate moreover return zero if all densities are zero, and keep the laws for infinite
/// densities,
/// see [`Densities`]. The `check_heuristic` function of the `estimator-checks` crate tests the laws on anyone's
/// heuristic.
///
/// # Source
/// E. Veach and L. Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering", 1995, section 3;
/// T. Kollig and A. Keller, "On the Efficiency of Multiple Importance Sampling: Robust Instant Global Illumination",
/// 2004, section 3.1.
///
/// # Example
/// Writing one: every technique that can generate the sample gets the same share.
/// ```
/// use mis_heuristics::{Densities, Heuristic};
///
/// struct Equal;
/// impl Heuristic<f64> for Equal {
///     fn weight(&self, technique: usize, densities: &(impl Densities<f64> + ?Sized)) -> f64 {
///         if densities.density(technique) <= 0.0 {
///             return 0.0;
///         }
///         1.0 / (0..densities.len()).filter(|&i| densities.density(i) > 0.0).count() as f64
///     }
/// }
/// assert_eq!(Equal.weight(2, &[0.0, 3.0, 4.0]), 0.5);
/// ```
///
/// Not dyn compatible, because `weight` is generic: to choose at run time, implement it for an enum of the choices.
pub trait Heuristic<F> {
    /// The weight of `technique` for the sample that `densities` describe.
    ///
    /// # Panics
    /// May panic if `technique >= densities.len()`.
    fn weight(&self, technique: usize, densities: &(impl Densities<F> + ?Sized)) -> F;
}

impl<F, H: Heuristic<F> + ?Sized> Heuristic<F> for &H {
    #[inline]
    fn weight(&self, technique: usize, densities: &(impl Densities<F> + ?Sized)) -> F {
        (**self).weight(technique, densities)
    }
}

/// Conveniences on top of every [`Heuristic`].
pub trait HeuristicExt<F: Float>: Heuristic<F> {
    /// `w_i / (n_i p_i)`: what the integrand is multiplied by, zero where the density is zero.
    ///
    /// The technique's density is asked for once more than the weight asks. For an infinite density (a Dirac delta,
    /// whose integrand carries the same delta) the quotient has no meaning: use [`Heuristic::weight`] and cancel the
    /// delta.
    ///
    /// ```
    /// use mis_heuristics::{Balance, HeuristicExt};
    /// assert_eq!(Balance.factor(0, &[0.5, 1.5]), 0.5); // 1/4 of the weight, over 1/2
    /// assert_eq!(Balance.factor(0, &[0.0, 1.5]), 0.0);
    /// ```
    #[inline]
    fn factor(&self, technique: usize, densities: &(impl Densities<F> + ?Sized)) -> F {
        let density = densities.density(technique);
        if density > F::ZERO { self.weight(technique, densities) / density } else { F::ZERO }
    }

    /// The sum of all weights: one wherever a density is positive. For tests.
    ///
    /// ```
    /// use mis_heuristics::{HeuristicExt, Power};
    /// assert_eq!(Power::TWO.weight_sum(&[1.0_f32, 2.0, 2.0]), 1.0);
    /// assert_eq!(Power::TWO.weight_sum(&[0.0_f32, 0.0]), 0.0);
    /// ```
    fn weight_sum(&self, densities: &(impl Densities<F> + ?Sized)) -> F {
        (0..densities.len()).fold(F::ZERO, |sum, technique| sum + self.weight(technique, densities))
    }
}

impl<F: Float, H: Heuristic<F>> HeuristicExt<F> for H {}
