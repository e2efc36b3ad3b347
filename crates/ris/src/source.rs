//! Where candidates come from.

use crate::{Float, Uniform};

/// A candidate with the density of which it was drawn.
///
/// One that could not be drawn still counts among the `M`: where a stream of proposals is wanted, give it density zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proposal<X, F = f32> {
    /// The candidate.
    pub sample: X,
    /// Its probability density `p`, in the measure of target and integrand.
    pub density: F,
}

/// A source distribution `p`.
///
/// [`from_fn`] makes one of two closures.
///
/// # Laws
/// - `propose` draws `x` with density `density(x)`, or nothing with what probability is left. Nothing counts as a candidate
///   of weight zero.
/// - Wherever the integrand is not zero, `density` is positive.
///
/// A source whose [`density`](Self::density) is never asked (all but those in a [`Mixture`](crate::Mixture)) may
/// return NaN there.
///
/// Not dyn compatible, because `propose` is generic: to choose at run time, implement it for an enum of the choices.
pub trait Source<X, F = f32> {
    /// Draws a candidate.
    fn propose(&self, uniform: &mut impl Uniform<F>) -> Option<Proposal<X, F>>;

    /// The density with which [`propose`](Self::propose) draws `x`.
    fn density(&self, x: &X) -> F;
}

impl<X, F, S: Source<X, F>> Source<X, F> for &S {
    #[inline]
    fn propose(&self, uniform: &mut impl Uniform<F>) -> Option<Proposal<X, F>> {
        (**self).propose(uniform)
    }
    #[inline]
    fn density(&self, x: &X) -> F {
        (**self).density(x)
    }
}

/// A source made of two closures: one maps a number to a candidate and its density, the other gives the density.
///
/// ```
/// use ris::{Source, from_fn};
/// // Uniform on [0, 2].
/// let source = from_fn(|u: &mut dyn FnMut() -> f64| (2.0 * u(), 0.5), |_: &f64| 0.5);
/// let proposal = source.propose(&mut || 0.25).unwrap();
/// assert_eq!((proposal.sample, proposal.density), (0.5, 0.5));
/// ```
pub fn from_fn<X, F, P, D>(propose: P, density: D) -> FromFn<P, D>
where
    F: Float,
    P: Fn(&mut dyn FnMut() -> F) -> (X, F),
    D: Fn(&X) -> F,
{
    FromFn { propose, density }
}

/// See [`from_fn`].
#[derive(Clone, Copy, Debug)]
pub struct FromFn<P, D> {
    propose: P,
    density: D,
}

impl<X, F, P, D> Source<X, F> for FromFn<P, D>
where
    F: Float,
    P: Fn(&mut dyn FnMut() -> F) -> (X, F),
    D: Fn(&X) -> F,
{
    #[inline]
    fn propose(&self, uniform: &mut impl Uniform<F>) -> Option<Proposal<X, F>> {
        let (sample, density) = (self.propose)(&mut || uniform.next_uniform());
        Some(Proposal { sample, density })
    }
    #[inline]
    fn density(&self, x: &X) -> F {
        (self.density)(x)
    }
}
