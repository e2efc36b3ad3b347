//! Several renderings of the same setting.

use qmc_sampling::Replications;
use scene_core::film::LayeredImage;

use super::Row;
use crate::metrics::{ImagePair, MetricError, relative_mse};
use crate::render::Rendering;

/// The renderings of one setting with independent seeds, and their errors against a reference.
#[derive(Clone, Debug, Default)]
pub struct Trials {
    errors: Replications,
    seconds: Replications,
    rays: Replications,
    /// One for each channel of each pixel.
    values: Vec<Replications>,
}

impl Trials {
    /// None yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes in one rendering.
    ///
    /// # Errors
    /// If it cannot be compared with the reference.
    pub fn push(&mut self, rendering: &Rendering, reference: &LayeredImage) -> Result<(), MetricError> {
        self.push_image(&rendering.film.develop(rendering.light_paths), rendering, reference).map(drop)
    }

    /// Takes in one rendering whose image was worked on after it was developed. Returns its relative mean squared error.
    ///
    /// # Errors
    /// If it cannot be compared with the reference.
    pub fn push_image(
        &mut self,
        image: &LayeredImage,
        rendering: &Rendering,
        reference: &LayeredImage,
    ) -> Result<f64, MetricError> {
        let error = relative_mse(&ImagePair::of_images(image, reference)?);
        self.errors.push(error);
        self.seconds.push(rendering.seconds);
        self.rays.push(rendering.rays.total() as f64);
        let pixels = image.rgb()?;
        self.values.resize(3 * pixels.len(), Replications::new());
        for (moments, &value) in self.values.iter_mut().zip(pixels.iter().flatten()) {
            moments.push(f64::from(value));
        }
        Ok(error)
    }

    /// The moments of each channel of each pixel, row by row. Empty without renderings.
    pub fn values(&self) -> &[Replications] {
        &self.values
    }

    /// How many there are.
    pub fn count(&self) -> u64 {
        self.errors.count()
    }

    /// The relative mean squared errors of the renderings.
    pub fn relative_mse(&self) -> &Replications {
        &self.errors
    }

    /// The wall times of the renderings, in seconds.
    pub fn seconds(&self) -> &Replications {
        &self.seconds
    }

    /// The rays of the renderings.
    pub fn rays(&self) -> &Replications {
        &self.rays
    }

    /// The variance of a pixel's value from one rendering to another, mean over pixels and channels; infinite for fewer
    /// than two renderings. Needs no reference.
    pub fn variance(&self) -> f64 {
        self.values.iter().map(Replications::variance).sum::<f64>() / self.values.len().max(1) as f64
    }

    /// The variance of a pixel's value over the squared reference plus 0.01, mean over pixels and channels. Needs a reference of the same size.
    pub fn relative_variance(&self, reference: &[[f32; 3]]) -> f64 {
        let relative = |(pixel, &truth): (&Replications, &f32)| pixel.variance() / (f64::from(truth).powi(2) + 0.01);
        let sum: f64 = self.values.iter().zip(reference.iter().flatten()).map(relative).sum();
        sum / self.values.len().max(1) as f64
    }

    /// The measurements of a row.
    #[must_use]
    pub fn fill(&self, row: Row) -> Row {
        Row {
            seconds: self.seconds.mean(),
            rays: self.rays.mean().round() as u64,
            variance: self.variance(),
            rel_mse: self.errors.mean(),
            ..row
        }
    }
}

/// A ratio, and the interval that contains the true one with a probability of 95 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// The ratio of the means.
    pub value: f64,
    /// The interval.
    pub ci95: [f64; 2],
}

/// The ratio of the expectations of two independent measurements, from their replications.
///
/// The logarithm of the ratio of the means is about normal with variance `(s_a / a)^2 + (s_b / b)^2`, for standard errors
/// `s` that are small beside the means; the quantile is Student's, with the degrees of freedom of the smaller number
/// of replications, which is on the safe side. Means that are not positive give NaN.
///
/// ```
/// use lichtwerk::experiments::ratio_of_means;
/// use qmc_sampling::Replications;
///
/// let [mut a, mut b] = [Replications::new(); 2];
/// for x in [1.9, 2.0, 2.1, 2.0] {
///     a.push(x);
///     b.push(2.0 * x);
/// }
/// let ratio = ratio_of_means(&b, &a);
/// assert!((ratio.value - 2.0).abs() < 1e-12 && 1.7 < ratio.ci95[0] && ratio.ci95[1] < 2.3);
/// ```
pub fn ratio_of_means(numerator: &Replications, denominator: &Replications) -> Ratio {
    if numerator.count().min(denominator.count()) < 2 {
        return Ratio { value: numerator.mean() / denominator.mean(), ci95: [0.0, f64::INFINITY] };
    }
    let relative = |r: &Replications| r.standard_error() / r.mean();
    let quantile = |r: &Replications| {
        let half = r.confidence_interval(0.95)[1] - r.mean();
        // Without any scatter there is no error either.
        if half > 0.0 { half / r.standard_error() } else { 0.0 }
    };
    let error = quantile(numerator).max(quantile(denominator)) * relative(numerator).hypot(relative(denominator));
    let value = if numerator.mean() > 0.0 && denominator.mean() > 0.0 {
        numerator.mean() / denominator.mean()
    } else {
        f64::NAN
    };
    Ratio { value, ci95: [value * (-error).exp(), value * error.exp()] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn replications(values: &[f64]) -> Replications {
        let mut all = Replications::new();
        values.iter().for_each(|&value| all.push(value));
        all
    }

    #[test]
    fn intervals_of_ratios_cover() {
        // Means over 8 exponential numbers each: the true ratio is 3. 95 % of 1000 intervals contain it, give or take.
        let mut uniform = 0.5_f64;
        let mut exponential = |scale: f64| {
            uniform = (uniform * 997.0 + 0.123_456_789).fract();
            -scale * (1.0 - uniform).ln()
        };
        let mut mean_of_4 = |scale: f64| (0..4).map(|_| exponential(scale)).sum::<f64>() / 4.0;
        let mut covered = 0;
        for _ in 0..1000 {
            let a: Vec<f64> = (0..8).map(|_| mean_of_4(3.0)).collect();
            let b: Vec<f64> = (0..8).map(|_| mean_of_4(1.0)).collect();
            let [low, high] = ratio_of_means(&replications(&a), &replications(&b)).ci95;
            covered += u32::from(low < 3.0 && 3.0 < high);
        }
        assert!((925..=985).contains(&covered), "{covered}");
    }

    #[test]
    fn what_cannot_be_compared_has_no_ratio() {
        let one = replications(&[1.0]);
        assert_eq!(ratio_of_means(&one, &one).ci95, [0.0, f64::INFINITY]);
        let (zero, exact) = (replications(&[0.0, 0.0]), replications(&[2.0, 2.0]));
        assert!(ratio_of_means(&zero, &exact).value.is_nan());
        assert_eq!(ratio_of_means(&exact, &exact), Ratio { value: 1.0, ci95: [1.0, 1.0] });
    }
}
