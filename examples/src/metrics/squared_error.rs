//! Means of squares, plain and relative.

use super::ImagePair;

/// What is added to the square of the reference, so that black pixels do not decide alone.
pub const RELATIVE_EPSILON: f64 = 0.01;

/// The share of pixels of largest error that [`mrse`] leaves out.
pub const MRSE_TRIMMED: f64 = 0.001;

/// Mean squared error: the mean over pixels and channels of `(x - r)^2`.
///
/// `x` is the image under test and `r` the reference, linear. For an unbiased estimator and an exact reference its
/// expectation is the mean variance of the pixels.
pub fn mse(pair: &ImagePair) -> f64 {
    mean(pair.pixels().map(|(x, r)| mean_of_channels(|c| square(x[c] - r[c]))))
}

/// Relative mean squared error: the mean over pixels and channels of `(x - r)^2 / (r^2 + 0.01)`.
///
/// `x` is the image under test and `r` the reference, linear. Dark regions count as much as bright ones; each channel
/// is measured against itself. As used by F. Rousselle, C. Knaus, M. Zwicker, *Adaptive Sampling and Reconstruction
/// using Greedy Error Minimization*, 2011.
pub fn relative_mse(pair: &ImagePair) -> f64 {
    let error = |x: f64, r: f64| square(x - r) / (square(r) + RELATIVE_EPSILON);
    mean(pair.pixels().map(|(x, r)| mean_of_channels(|c| error(x[c], r[c]))))
}

/// Mean relative squared error, robust against outliers: the mean over pixels of
/// ```text
/// e = 1/3 sum_c (x_c - r_c)^2 / (Y(r)^2 + 0.01)
/// ```
/// without the 0.1 % of pixels (rounded down) with the largest `e`; `Y` is the luminance.
///
/// The literature knows several measures of this name. This one differs from [`relative_mse`] on purpose, so that the
/// two together tell more than each: a saturated colour is measured against the brightness of its pixel and not
/// against its own darkest channel, and a few fireflies do not decide. If it is much smaller than the relative MSE,
/// the error sits in a few pixels or in dark channels.
pub fn mrse(pair: &ImagePair) -> f64 {
    let error = |(x, r): ([f64; 3], [f64; 3])| {
        mean_of_channels(|c| square(x[c] - r[c])) / (square(luminance(r)) + RELATIVE_EPSILON)
    };
    let mut errors: Vec<f64> = pair.pixels().map(error).collect();
    errors.sort_unstable_by(f64::total_cmp);
    errors.truncate(errors.len() - (MRSE_TRIMMED * errors.len() as f64) as usize);
    mean(errors.into_iter())
}

/// Ratio of the means of image and reference, per channel; nothing where the reference is black.
pub fn mean_ratio(pair: &ImagePair) -> [Option<f64>; 3] {
    let [x, r] = means(pair);
    std::array::from_fn(|c| (r[c] != 0.0).then(|| x[c] / r[c]))
}

/// Means per channel of the image under test and of the reference.
pub(super) fn means(pair: &ImagePair) -> [[f64; 3]; 2] {
    [
        std::array::from_fn(|c| mean(pair.pixels().map(|(x, _)| x[c]))),
        std::array::from_fn(|c| mean(pair.pixels().map(|(_, r)| r[c]))),
    ]
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0u64), |(sum, count), value| (sum + value, count + 1));
    sum / count as f64
}

fn mean_of_channels(value: impl Fn(usize) -> f64) -> f64 {
    (value(0) + value(1) + value(2)) / 3.0
}

fn square(x: f64) -> f64 {
    x * x
}

/// Of linear RGB with the primaries of BT.709.
pub(super) fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}
