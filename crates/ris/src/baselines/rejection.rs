//! Rejection sampling.

use crate::{Float, Source, Target, Uniform};

/// Rejection sampling: candidates of density `p` are accepted with probability `g / (bound p)`, and those accepted have density
/// `g / integral of g`, exactly.
///
/// **Symbols.** `g`: the target; `p`: the density of the source; `bound >= g/p` everywhere.
///
/// **Exact** if the bound holds; where it does not, the density is that of `min(g, bound p)`, and the outcome tells. **Cost**:
/// `bound / integral of g` candidates on average, without limit in a single case, so it takes a limit.
///
/// Talbot, Cline and Egbert 2005 names its drawbacks: no stratification, no bound of the time, and a bound of the function has to be found.
///
/// **Source.** von Neumann 1951.
///
/// ```
/// use ris::{baselines::RejectionSampling, from_fn};
/// let source = from_fn(|u: &mut dyn FnMut() -> f64| (u(), 1.0), |_: &f64| 1.0);
/// let sampling = RejectionSampling::new(1.0, 100)?;
/// let mut numbers = [0.1, 0.5, 0.8, 0.7].into_iter();
/// let accepted = sampling.draw(&source, &|x: &f64| *x, &mut || numbers.next().unwrap_or(0.0)).unwrap();
/// assert_eq!((accepted.sample, accepted.candidates), (0.8, 2)); // 0.1 fell to 0.5, 0.8 was kept at 0.7
/// # Ok::<(), ris::baselines::RejectionError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RejectionSampling<F = f32> {
    bound: F,
    limit: u32,
}

/// Why there can be no rejection sampling.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum RejectionError {
    /// A bound that is not positive and finite.
    Bound(f64),
    /// No candidates are allowed.
    Limit,
}

impl core::fmt::Display for RejectionError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Bound(bound) => write!(f, "{bound} is no bound of target over density"),
            Self::Limit => write!(f, "rejection sampling needs at least one candidate"),
        }
    }
}

impl core::error::Error for RejectionError {}

/// A sample that was accepted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accepted<X> {
    /// The sample.
    pub sample: X,
    /// How many candidates it took, itself included.
    pub candidates: u32,
    /// Whether a candidate on the way, or this one, exceeded the bound: the distribution is then not the target's.
    pub bound_exceeded: bool,
}

impl<F: Float> RejectionSampling<F> {
    /// With this bound, giving up after `limit` candidates.
    ///
    /// # Errors
    /// A bound that is not positive and finite, or a limit of zero.
    pub fn new(bound: F, limit: u32) -> Result<Self, RejectionError> {
        if bound.weight_or_zero() == F::ZERO {
            return Err(RejectionError::Bound(bound.to_f64()));
        }
        if limit == 0 {
            return Err(RejectionError::Limit);
        }
        Ok(Self { bound, limit })
    }

    /// Draws a sample; `None` if the limit is reached.
    pub fn draw<X>(
        &self,
        source: &impl Source<X, F>,
        target: &impl Target<X, F>,
        uniform: &mut impl Uniform<F>,
    ) -> Option<Accepted<X>> {
        let mut bound_exceeded = false;
        for candidates in 1..=self.limit {
            let Some(proposal) = source.propose(uniform) else { continue };
            let weight = (target.score(&proposal.sample) / proposal.density).weight_or_zero();
            bound_exceeded |= weight > self.bound;
            if uniform.next_uniform() * self.bound < weight {
                return Some(Accepted { sample: proposal.sample, candidates, bound_exceeded });
            }
        }
        None
    }
}
