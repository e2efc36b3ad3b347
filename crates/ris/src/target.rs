//! What a sample is worth.

/// A target function `g >= 0`: the closer to proportional to the integrand, the better.
///
/// It need not be normalised. Closures `|x| -> F` are targets.
///
/// # Laws
/// - `score(x)` is a deterministic function of `x`.
/// - Wherever the integrand is not zero, `score` is positive. Otherwise the estimate lacks that part of the integral.
/// - Scores that are zero, negative, infinite or NaN count as zero: such a candidate is never selected, but it counts
///   among the `M`.
///
/// # Measure
/// `g` is a density with respect to the same measure as the candidates' density `p`.
///
/// Dyn compatible: `&dyn Target<X, F>`.
pub trait Target<X: ?Sized, F = f32> {
    /// The value of `g` at `x`.
    fn score(&self, x: &X) -> F;
}

// Its docs say so.
const _: Option<&dyn Target<f64, f64>> = None;

impl<X: ?Sized, F, G: Fn(&X) -> F> Target<X, F> for G {
    #[inline(always)]
    fn score(&self, x: &X) -> F {
        self(x)
    }
}
