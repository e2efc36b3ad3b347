//! What is averaged.

/// A contribution of a light path: radiance or whatever a vertex stores, in whatever components the renderer has.
///
/// Implemented for `f32`, `f64` and arrays of them.
///
/// **Laws**, up to round-off: `add` is linear in `self` and in the weight; `mean` of a sum that holds `k` times the same
/// contribution with weights that are powers of two is that contribution, bit for bit, as long as the sum has enough digits
/// (that is why [`Sum`](Self::Sum) is wider than the contribution).
///
/// # Example
/// A renderer with its own spectrum:
/// ```
/// use path_space_filter::Contribution;
/// #[derive(Clone, Copy)]
/// struct Spectrum([f32; 8]);
/// impl Contribution for Spectrum {
///     type Sum = [f64; 8];
///     const NOTHING: [f64; 8] = [0.0; 8];
///     fn add(self, weight: f32, sum: &mut [f64; 8]) {
///         for (sum, c) in sum.iter_mut().zip(self.0) { *sum += f64::from(weight * c); }
///     }
///     fn mean(sum: &[f64; 8], weights: f64) -> Self { Self(sum.map(|s| (s / weights) as f32)) }
///     fn is_finite(self) -> bool { self.0.iter().all(|c| c.is_finite()) }
/// }
/// let mut sum = Spectrum::NOTHING;
/// Spectrum([1.0; 8]).add(0.5, &mut sum);
/// Spectrum([4.0; 8]).add(1.0, &mut sum);
/// assert_eq!(Spectrum::mean(&sum, 1.5).0, [3.0; 8]);
/// ```
///
/// Not dyn compatible: it is a number.
pub trait Contribution: Copy {
    /// Weighted sums of contributions.
    type Sum: Clone + Send + Sync;
    /// The sum of none.
    const NOTHING: Self::Sum;
    /// Adds `weight` times this one.
    fn add(self, weight: f32, sum: &mut Self::Sum);
    /// A sum over the sum of the weights, which is positive.
    #[must_use]
    fn mean(sum: &Self::Sum, weights: f64) -> Self;
    /// Whether no component is NaN or infinite.
    fn is_finite(self) -> bool;
}

macro_rules! contribution {
    ($float:ty) => {
        impl Contribution for $float {
            type Sum = f64;
            const NOTHING: f64 = 0.0;
            #[inline(always)]
            fn add(self, weight: f32, sum: &mut f64) {
                *sum += f64::from(weight) * f64::from(self);
            }
            #[inline]
            fn mean(sum: &f64, weights: f64) -> Self {
                (*sum / weights) as Self
            }
            #[inline]
            fn is_finite(self) -> bool {
                <$float>::is_finite(self)
            }
        }

        impl<const N: usize> Contribution for [$float; N] {
            type Sum = [f64; N];
            const NOTHING: [f64; N] = [0.0; N];
            #[inline(always)]
            fn add(self, weight: f32, sum: &mut [f64; N]) {
                for (sum, component) in sum.iter_mut().zip(self) {
                    *sum += f64::from(weight) * f64::from(component);
                }
            }
            #[inline]
            fn mean(sum: &[f64; N], weights: f64) -> Self {
                sum.map(|sum| (sum / weights) as $float)
            }
            #[inline]
            fn is_finite(self) -> bool {
                self.iter().all(|component| component.is_finite())
            }
        }
    };
}

contribution!(f32);
contribution!(f64);
