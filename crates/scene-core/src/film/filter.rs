//! Reconstruction filters, by importance sampling.

use thiserror::Error;

use super::gaussian;

/// Radii beyond this many pixels are taken for a mistake.
const MAX_RADIUS: f32 = 64.0;

/// A separable reconstruction filter `h(x, y) = h(x) h(y)` of unit integral, non-negative.
///
/// The value of the pixel with centre `c` is
/// ```text
/// I = integral h(r - c) L(r) dr  =  E[ L(c + offset) ],   offset ~ h
/// ```
/// with `L` the radiance that arrives at the raster position `r`, both in pixels. So a pixel is the plain mean of
/// samples whose positions are drawn with density `h` around its centre ([`sample`](Self::sample)): all samples
/// weigh the same, neighbours stay uncorrelated, and a thread never writes to the pixel of another one.
///
/// Contributions of light paths arrive at given positions instead: there the weight is [`density`](Self::density).
///
/// | filter | `h(x)`, up to scale | support |
/// |---|---|---|
/// | box | `1` | `[-1/2, 1/2)` |
/// | tent | `1 - abs(x) / r` | `abs(x) <= r` |
/// | Gaussian | `exp(-x^2 / (2 s^2)) - exp(-8)` | `abs(x) <= 4 s` |
///
/// The Gaussian is lowered so that it ends continuously at four standard deviations, as in Mitsuba 3.
///
/// **Unbiased** with respect to the filtered image. **Cost**: two inversions of a cumulative distribution; in closed
/// form for box and tent, one binary search each for the Gaussian.
///
/// **Source**: M. Ernst, M. Stamminger, G. Greiner, *Filter Importance Sampling*, IEEE Symposium on Interactive Ray
/// Tracing 2006.
///
/// ```
/// use scene_core::film::Filter;
///
/// let tent = Filter::tent(2.0)?;
/// assert_eq!(tent.sample([0.5, 0.125]), [0.0, -1.0]);
/// assert_eq!(tent.density([0.0, -1.0]), 0.5 * 0.25);
/// assert!(Filter::tent(f32::NAN).is_err());
/// # Ok::<(), scene_core::film::FilterError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Filter(Kind);

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Kind {
    #[default]
    Box,
    Tent {
        radius: f32,
    },
    Gaussian {
        standard_deviation: f32,
    },
}

/// A parameter of a filter is out of range.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FilterError {
    /// The radius of a tent is not in `(0, 64]` pixels.
    #[error("radius of the tent filter is {0}, must be greater than 0 and at most 64 pixels")]
    Radius(f32),
    /// The standard deviation of a Gaussian is not in `(0, 16]` pixels.
    #[error("standard deviation of the Gaussian filter is {0}, must be greater than 0 and at most 16 pixels")]
    StandardDeviation(f32),
}

impl Filter {
    /// The mean over the pixel.
    pub const BOX: Self = Self(Kind::Box);

    /// The tent of radius one pixel.
    pub const TENT: Self = Self(Kind::Tent { radius: 1.0 });

    /// The Gaussian with a standard deviation of half a pixel, which Mitsuba 3 uses unless told otherwise.
    pub const GAUSSIAN: Self = Self(Kind::Gaussian { standard_deviation: 0.5 });

    /// A tent that falls to zero at `radius` pixels.
    ///
    /// # Errors
    /// [`FilterError::Radius`] unless `0 < radius <= 64`; NaN is such a case.
    pub fn tent(radius: f32) -> Result<Self, FilterError> {
        // Subnormal radii would make the density infinite.
        if radius >= f32::MIN_POSITIVE.sqrt() && radius <= MAX_RADIUS {
            Ok(Self(Kind::Tent { radius }))
        } else {
            Err(FilterError::Radius(radius))
        }
    }

    /// A Gaussian, cut off at four standard deviations (given in pixels).
    ///
    /// # Errors
    /// [`FilterError::StandardDeviation`] unless `0 < standard_deviation <= 16`; NaN is such a case.
    pub fn gaussian(standard_deviation: f32) -> Result<Self, FilterError> {
        if standard_deviation >= f32::MIN_POSITIVE.sqrt() && standard_deviation <= MAX_RADIUS / gaussian::CUTOFF as f32
        {
            Ok(Self(Kind::Gaussian { standard_deviation }))
        } else {
            Err(FilterError::StandardDeviation(standard_deviation))
        }
    }

    /// Largest offset along an axis, in pixels.
    pub fn radius(&self) -> f32 {
        match self.0 {
            Kind::Box => 0.5,
            Kind::Tent { radius } => radius,
            Kind::Gaussian { standard_deviation } => gaussian::CUTOFF as f32 * standard_deviation,
        }
    }

    /// An offset from the pixel's centre in pixels, with density `h`, from two numbers in `[0, 1)`. Monotonic in each
    /// of them, so that stratification survives. Numbers outside are clamped.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> [f32; 2] {
        [self.sample_1d(u[0]), self.sample_1d(u[1])]
    }

    /// The filter's value `h(x) h(y)` at an offset from the pixel's centre, in 1/pixel^2: the density of
    /// [`sample`](Self::sample).
    #[inline]
    pub fn density(&self, offset: [f32; 2]) -> f32 {
        self.density_1d(offset[0]) * self.density_1d(offset[1])
    }

    #[inline]
    fn sample_1d(&self, u: f32) -> f32 {
        let u = u.clamp(0.0, 1.0);
        match self.0 {
            Kind::Box => u - 0.5,
            Kind::Tent { radius } if u < 0.5 => radius * ((2.0 * u).sqrt() - 1.0),
            Kind::Tent { radius } => radius * (1.0 - (2.0 * (1.0 - u)).sqrt()),
            Kind::Gaussian { standard_deviation } => standard_deviation * gaussian::sample(u),
        }
    }

    /// One factor of the density, in 1/pixel.
    #[inline]
    pub(super) fn density_1d(&self, x: f32) -> f32 {
        match self.0 {
            Kind::Box => f32::from((-0.5..0.5).contains(&x)),
            Kind::Tent { radius } => (1.0 - x.abs() / radius).max(0.0) / radius,
            Kind::Gaussian { standard_deviation } => gaussian::density(x / standard_deviation) / standard_deviation,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filters() -> [Filter; 5] {
        [Filter::BOX, Filter::TENT, Filter::tent(2.5).unwrap(), Filter::GAUSSIAN, Filter::gaussian(1.3).unwrap()]
    }

    /// Integral of the density from minus the radius to `x`, by the midpoint rule.
    fn cumulative(filter: Filter, x: f64) -> f64 {
        let radius = f64::from(filter.radius());
        let steps = 20_000;
        let width = (x + radius) / f64::from(steps);
        (0..steps).map(|i| f64::from(filter.density_1d((-radius + (f64::from(i) + 0.5) * width) as f32)) * width).sum()
    }

    #[test]
    fn densities_integrate_to_one() {
        for filter in filters() {
            let mass = cumulative(filter, f64::from(filter.radius()));
            assert!((mass - 1.0).abs() < 1e-5, "{filter:?}: {mass}");
        }
    }

    #[test]
    fn sampling_inverts_the_cumulative_distribution() {
        for filter in filters() {
            for i in 1..200 {
                let u = i as f32 / 200.0;
                let [x, y] = filter.sample([u, 1.0 - u]);
                let back = cumulative(filter, f64::from(x));
                assert!((back - f64::from(u)).abs() < 2e-5, "{filter:?}: u = {u}, x = {x}, back = {back}");
                assert!((x + y).abs() < 1e-4 * filter.radius(), "{filter:?} is not symmetric: {x}, {y}");
            }
        }
    }

    #[test]
    fn sampling_is_monotonic_and_within_the_radius() {
        for filter in filters() {
            let mut last = -filter.radius();
            for u in (0..=4000).map(|i| i as f32 / 4000.0).chain([1.0 - f32::EPSILON / 2.0]).take(4001) {
                let x = filter.sample_1d(u);
                assert!(x >= last && x <= filter.radius(), "{filter:?}: u = {u}, x = {x} after {last}");
                last = x;
            }
        }
    }

    #[test]
    fn parameters_are_checked() {
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY, 65.0, 1e-40] {
            assert!(matches!(Filter::tent(bad), Err(FilterError::Radius(_))), "{bad}");
            assert!(matches!(Filter::gaussian(bad), Err(FilterError::StandardDeviation(_))), "{bad}");
        }
        assert!(Filter::gaussian(17.0).unwrap_err().to_string().contains("17"));
        assert_eq!((Filter::tent(1.0), Filter::gaussian(0.5)), (Ok(Filter::TENT), Ok(Filter::GAUSSIAN)));
    }

    #[test]
    fn density_matches_mitsubas_gaussian() {
        let filter = Filter::GAUSSIAN;
        let mitsuba = |x: f32| ((-2.0 * x * x).exp() - (-8.0f32).exp()).max(0.0);
        let ratio = filter.density_1d(0.0) / mitsuba(0.0);
        for x in [0.1, 0.5, 1.0, 1.7, 1.99, 2.0, 3.0] {
            assert!((filter.density_1d(x) - ratio * mitsuba(x)).abs() < 1e-6, "{x}");
        }
    }
}
