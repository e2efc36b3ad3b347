//! Weights by distance.

/// A weight by distance from the centre, as a function of `t = d / r` in `[0, 1]`.
///
/// [`Ball`], which weighs all alike, is the paper's and the best: any other kernel averages as if it had a smaller radius. The others are here to show that.
/// With weights `w_j` the variance of an average of independent contributions of equal variance is `sum w^2 / (sum w)^2` times theirs, at least `1 / K`.
///
/// **Laws.** The weight is finite, not negative, and 1 in the centre.
///
/// Dyn compatible: `&dyn Kernel`.
pub trait Kernel {
    /// The weight at a squared distance, over the squared radius: in `[0, 1]`, up to round-off.
    fn weight(&self, t_squared: f32) -> f32;
}

// Its docs say so.
const _: Option<&dyn Kernel> = None;

/// The characteristic function of the ball.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "BallName", into = "BallName"))]
pub struct Ball;

#[cfg(feature = "serde")]
by_name!(BallName: Ball);

impl Kernel for Ball {
    #[inline(always)]
    fn weight(&self, _: f32) -> f32 {
        1.0
    }
}

/// `1 - t^2`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "EpanechnikovName", into = "EpanechnikovName"))]
pub struct Epanechnikov;

#[cfg(feature = "serde")]
by_name!(EpanechnikovName: Epanechnikov);

impl Kernel for Epanechnikov {
    #[inline(always)]
    fn weight(&self, t_squared: f32) -> f32 {
        (1.0 - t_squared).max(0.0)
    }
}

/// `(1 - t^2)^3`, the poly6 kernel of smoothed particle hydrodynamics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "Poly6Name", into = "Poly6Name"))]
pub struct Poly6;

#[cfg(feature = "serde")]
by_name!(Poly6Name: Poly6);

impl Kernel for Poly6 {
    #[inline(always)]
    fn weight(&self, t_squared: f32) -> f32 {
        let base = (1.0 - t_squared).max(0.0);
        base * base * base
    }
}

/// `exp(-4.5 t^2)`: a Gaussian whose standard deviation is a third of the radius.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "GaussianName", into = "GaussianName"))]
pub struct Gaussian;

#[cfg(feature = "serde")]
by_name!(GaussianName: Gaussian);

impl Kernel for Gaussian {
    #[inline(always)]
    fn weight(&self, t_squared: f32) -> f32 {
        (-4.5 * t_squared).exp()
    }
}
