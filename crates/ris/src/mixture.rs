//! Two sources as one: the one-sample model.

use crate::{Float, Proposal, Source, Uniform};

/// A mixture of two sources: each candidate comes from one of them, chosen at random, and has the density of the mixture.
///
/// ```text
/// p(x) = (1 - a) p_first(x) + a p_second(x)
/// ```
///
/// Mixtures nest. A mixture is one source, so `M` may be fractional and `M = 1` is importance sampling with the density of
/// the mixture, that is, one-sample multiple importance sampling with the balance heuristic.
///
/// **Symbols.** `a`: the probability of the second source.
///
/// **Cost.** Both densities per candidate. **Source.** Veach 1997, section 9.2.4.
///
/// ```
/// use ris::{Mixture, Source, from_fn};
/// let low = from_fn(|u: &mut dyn FnMut() -> f64| (u(), 1.0), |x: &f64| f64::from(*x < 1.0));
/// let high = from_fn(|u: &mut dyn FnMut() -> f64| (2.0 * u(), 0.5), |_: &f64| 0.5);
/// let mixture = Mixture::new(low, high, 0.5);
/// assert_eq!(mixture.density(&0.5), 0.75);
/// assert_eq!(mixture.density(&1.5), 0.25);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixture<A, B, F = f32> {
    first: A,
    second: B,
    probability: F,
}

impl<A, B, F: Float> Mixture<A, B, F> {
    /// The second source with this probability, the first one with what is left. Probabilities outside of `[0, 1]` are
    /// moved to the nearer end, NaN is zero.
    pub fn new(first: A, second: B, probability: F) -> Self {
        Self { first, second, probability: probability.weight_or_zero().at_most(F::ONE) }
    }
}

impl<X, F: Float, A: Source<X, F>, B: Source<X, F>> Source<X, F> for Mixture<A, B, F> {
    #[inline]
    fn propose(&self, uniform: &mut impl Uniform<F>) -> Option<Proposal<X, F>> {
        if uniform.next_uniform() < self.probability {
            let Proposal { sample, density } = self.second.propose(uniform)?;
            let density = (F::ONE - self.probability) * self.first.density(&sample) + self.probability * density;
            Some(Proposal { sample, density })
        } else {
            let Proposal { sample, density } = self.first.propose(uniform)?;
            let density = (F::ONE - self.probability) * density + self.probability * self.second.density(&sample);
            Some(Proposal { sample, density })
        }
    }

    #[inline]
    fn density(&self, x: &X) -> F {
        (F::ONE - self.probability) * self.first.density(x) + self.probability * self.second.density(x)
    }
}
