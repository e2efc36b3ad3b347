//! Where random numbers come from: always from the caller.

use crate::Float;

/// A stream of numbers in `[0, 1)`: a generator, a quasi-Monte Carlo sampler, a table of a test.
///
/// Closures are streams, so `&mut || rng.random()` or `&mut || sampler.next_1d()` is all the glue there is.
///
/// # Laws
/// The numbers lie in `[0, 1)` and are uniformly distributed; for unbiasedness the numbers of one estimate have to be
/// independent of each other, or (quasi-Monte Carlo) jointly uniform in their cube.
///
/// Dyn compatible: `&mut dyn Uniform<F>`.
pub trait Uniform<F> {
    /// The next number.
    fn next_uniform(&mut self) -> F;
}

// Its docs say so.
const _: Option<&dyn Uniform<f64>> = None;

impl<F, G: FnMut() -> F> Uniform<F> for G {
    #[inline(always)]
    fn next_uniform(&mut self) -> F {
        self()
    }
}

/// One uniform number that decides as often as one likes: after each decision what is left of it is stretched to
/// `[0, 1)` again.
///
/// ```text
/// u < p:  yes, u <- u / p              else:  no, u <- (u - p) / (1 - p)
/// ```
///
/// So a whole streaming selection takes **one** dimension of a quasi-Monte Carlo point, and the selected candidate is a
/// deterministic function of it.
///
/// **Exactness.** A number of `b` bits has `b` bits of decisions in it: the probability of each outcome is exact up to
/// `2^-b` for each of the intervals of `u` that lead to it. Selecting one of `M` candidates of equal weight takes, on average,
/// `0.72 (ln M)^2 + 1.44 ln M - 1` bits: 17 for 60 candidates, 43 for 1000. So a number in `f32` does for tens of candidates, one
/// in `f64` for hundreds; beyond, take one number per candidate.
///
/// **Source.** The stretching is folklore; Shirley, Wang, Zimmerman 1996 use it to choose luminaires.
///
/// ```
/// use ris::OneNumber;
/// let mut u = OneNumber::new(0.3);
/// assert!(!u.accept(0.25)); // 0.3 >= 0.25: what is left is (0.3 - 0.25) / 0.75
/// assert!(u.accept(0.5));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneNumber(f64);

impl OneNumber {
    /// Of a number in `[0, 1)`; what lies outside, or is NaN, is moved to the nearer end.
    #[inline]
    pub fn new<F: Float>(u: F) -> Self {
        let u = u.to_f64();
        Self(if u > 0.0 { u.min(BELOW_ONE) } else { 0.0 })
    }

    /// Whether an event of probability `p` happens. Probabilities that are not positive never do.
    #[inline]
    pub fn accept(&mut self, p: f64) -> bool {
        let yes = self.0 < p;
        let rest = if yes { self.0 / p } else { (self.0 - p) / (1.0 - p) };
        self.0 = if rest > 0.0 { rest.min(BELOW_ONE) } else { 0.0 };
        yes
    }

    /// What is left: uniform, and independent of the decisions.
    #[inline]
    pub fn rest(&self) -> f64 {
        self.0
    }
}

/// The largest number below one.
pub(crate) const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_number_is_consumed_and_stays_in_range() {
        for u in [0.0, 0.1, 0.5, 0.999_999, 1.0, 7.0, -1.0, f64::NAN] {
            let mut number = OneNumber::new(u);
            for p in [0.0, 0.3, 1.0, 0.0, 1e-300, 0.999] {
                number.accept(p);
                assert!((0.0..1.0).contains(&number.rest()), "{u} {p}");
            }
        }
    }

    #[test]
    fn certain_and_impossible_events() {
        let mut number = OneNumber::new(0.7_f32);
        let before = number.rest();
        assert!(number.accept(1.0));
        assert!(!number.accept(0.0));
        assert_eq!(number.rest(), before);
    }
}
