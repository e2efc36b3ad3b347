//! What a pixel accumulates.

use super::sum::Sum;

/// Sums over the samples of one pixel, in f64 with their rounding errors: exact for all practical purposes, and so the same in any order.
///
/// With `x_i` the samples of a channel and `n` their number,
/// ```text
/// mean m = sum x_i / n,   variance of the mean = (sum x_i^2 / n - m^2) / (n - 1)
/// ```
/// The mean is an unbiased estimate whenever each sample is. The variance is unbiased for independent samples; for
/// quasi-Monte Carlo points, which are correlated on purpose, it overestimates as a rule.
///
/// **Not a number, infinities**: such a sample is counted, with the value zero, and also counted in
/// [`rejected`](Self::rejected); it never poisons the sums. Negative finite values are added as they are.
///
/// ```
/// use scene_core::film::Pixel;
///
/// let mut pixel = Pixel::default();
/// pixel.add([1.0, 2.0, 0.0]);
/// pixel.add([3.0, 2.0, f32::NAN]);
/// assert_eq!(pixel.mean(), [0.5, 1.0, 0.0]); // the second sample counts as black
/// assert_eq!((pixel.samples(), pixel.rejected()), (2, 1));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    pub(super) sum: [Sum; 3],
    pub(super) sum_squares: [Sum; 3],
    pub(super) albedo: [Sum; 3],
    pub(super) normal: [Sum; 3],
    pub(super) depth: Sum,
    pub(super) samples: u64,
    pub(super) aov_samples: u64,
    pub(super) rejected: u64,
}

impl Pixel {
    /// Adds a sample of linear RGB. One that is not finite counts as black and as rejected.
    #[inline]
    pub fn add(&mut self, rgb: [f32; 3]) {
        self.samples += 1;
        if !is_finite(&rgb) {
            self.rejected += 1;
            return;
        }
        for (channel, value) in rgb.into_iter().enumerate() {
            let value = f64::from(value);
            self.sum[channel].add(value);
            self.sum_squares[channel].add(value * value);
        }
    }

    /// Adds auxiliary quantities of what the pixel sees: albedo, unit normal, distance from the sensor. Call it for
    /// samples that hit something; the means run over these alone. If anything is not finite, nothing is added, and
    /// it counts as rejected.
    #[inline]
    pub fn add_aov(&mut self, albedo: [f32; 3], normal: [f32; 3], depth: f32) {
        if !(is_finite(&albedo) && is_finite(&normal) && depth.is_finite()) {
            self.rejected += 1;
            return;
        }
        self.aov_samples += 1;
        for channel in 0..3 {
            self.albedo[channel].add(f64::from(albedo[channel]));
            self.normal[channel].add(f64::from(normal[channel]));
        }
        self.depth.add(f64::from(depth));
    }

    /// Adds the sums of another pixel, as if its samples had been added here.
    pub fn merge(&mut self, other: &Self) {
        for channel in 0..3 {
            self.sum[channel].merge(&other.sum[channel]);
            self.sum_squares[channel].merge(&other.sum_squares[channel]);
            self.albedo[channel].merge(&other.albedo[channel]);
            self.normal[channel].merge(&other.normal[channel]);
        }
        self.depth.merge(&other.depth);
        self.samples += other.samples;
        self.aov_samples += other.aov_samples;
        self.rejected += other.rejected;
    }

    /// Number of samples of radiance, rejected ones included.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Number of samples of radiance or auxiliary quantities that were not finite.
    pub fn rejected(&self) -> u64 {
        self.rejected
    }

    /// Mean of the samples; zero if there are none.
    pub fn mean(&self) -> [f64; 3] {
        scaled(self.sum, self.samples)
    }

    /// Estimated variance of [`mean`](Self::mean), per channel; `None` with less than two samples.
    pub fn variance_of_mean(&self) -> Option<[f64; 3]> {
        variance_of_mean(self.sum, self.sum_squares, self.samples)
    }

    /// Mean albedo of what the samples hit; zero if there are none.
    pub fn albedo(&self) -> [f64; 3] {
        scaled(self.albedo, self.aov_samples)
    }

    /// Mean normal (not normalised: its length tells how much the normals agree); zero if there are none.
    pub fn normal(&self) -> [f64; 3] {
        scaled(self.normal, self.aov_samples)
    }

    /// Mean distance of what the samples hit; zero if there are none.
    pub fn depth(&self) -> f64 {
        if self.aov_samples == 0 { 0.0 } else { self.depth.value() / self.aov_samples as f64 }
    }
}

pub(super) fn is_finite(values: &[f32; 3]) -> bool {
    values.iter().all(|value| value.is_finite())
}

pub(super) fn scaled(sum: [Sum; 3], count: u64) -> [f64; 3] {
    if count == 0 { [0.0; 3] } else { sum.map(|sum| sum.value() / count as f64) }
}

/// Variance of the mean of `count` values, of which the sums of their powers are given.
pub(super) fn variance_of_mean(sum: [Sum; 3], sum_squares: [Sum; 3], count: u64) -> Option<[f64; 3]> {
    if count < 2 {
        return None;
    }
    let n = count as f64;
    Some(std::array::from_fn(|channel| {
        let mean = sum[channel].value() / n;
        ((sum_squares[channel].value() / n - mean * mean) / (n - 1.0)).max(0.0)
    }))
}
