//! The difference that people see.

use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8};
use rayon::prelude::*;
use scene_core::film::srgb_from_linear;

use super::ImagePair;
use super::squared_error::luminance;

/// Exposures span at most this many stops, however dark most of the reference is.
const MAX_STOPS: f64 = 20.0;
/// The share of white that the brightest, or the median pixel is exposed to.
const TARGET: f64 = 0.85;
/// ACES by K. Narkowicz, with the factor 0.6 on its input: `(a x^2 + b x + c) / (d x^2 + e x + f)`.
const ACES: [f64; 6] = [0.6 * 0.6 * 2.51, 0.6 * 0.03, 0.0, 0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14];

/// LDR-FLIP of the images as they are shown at exposure 0: clamped to `[0, 1]`, in sRGB with 8 bits.
///
/// The mean over the pixels of the perceived difference when one alternates between the two images, between 0 and 1,
/// at 67 pixels per degree (a 4K display seen from 0.7 m).
///
/// **Source**: P. Andersson, J. Nilsson, T. Akenine-Moller, M. Oskarsson, K. Astrom, M. Fairchild, *FLIP: A Difference
/// Evaluator for Alternating Images*, 2020; computed by NVIDIA's implementation.
pub fn flip_ldr(pair: &ImagePair) -> f64 {
    mean_compared(pair, &flip_ldr_map(pair))
}

/// The differences whose mean is [`flip_ldr`], one for each pixel, row by row.
pub fn flip_ldr_map(pair: &ImagePair) -> Vec<f32> {
    error_map(pair, |linear| linear)
}

/// HDR-FLIP: per pixel the largest LDR-FLIP over a range of [exposures](exposures()), tone mapped by ACES; then the
/// mean over the pixels.
///
/// **Differs from the original** in that the tone mapped images are rounded to 8 bits, and in a limit of 20 stops.
/// **Cost**: one LDR-FLIP per exposure, in parallel.
///
/// **Source**: P. Andersson, J. Nilsson, P. Shirley, T. Akenine-Moller, *Visualizing Errors in Rendered High Dynamic
/// Range Images*, Eurographics Short Papers 2021.
pub fn flip_hdr(pair: &ImagePair) -> f64 {
    let exposed = |stops: &f64| {
        let factor = stops.exp2();
        error_map(pair, |linear| aces(factor * f64::from(linear)) as f32)
    };
    let black = || vec![0.0f32; pair.test().len()];
    let largest = |mut one: Vec<f32>, other: Vec<f32>| {
        one.iter_mut().zip(other).for_each(|(one, other)| *one = one.max(other));
        one
    };
    let worst = exposures(pair).par_iter().map(exposed).reduce(black, largest);
    mean_compared(pair, &worst)
}

/// The exposures of HDR-FLIP in stops: from the one that shows the brightest pixel of the reference at 85 % to the one
/// that shows its median so, at most one stop apart, at least two. Just 0 if the reference is black.
pub fn exposures(pair: &ImagePair) -> Vec<f64> {
    let mut luminances: Vec<f64> = pair.pixels().map(|(_, reference)| luminance(reference).max(0.0)).collect();
    luminances.sort_unstable_by(f64::total_cmp);
    let count = luminances.len();
    let brightest = luminances.last().copied().unwrap_or(0.0);
    if brightest <= 0.0 {
        return vec![0.0];
    }
    let median = 0.5 * (luminances[(count - 1) / 2] + luminances[count / 2]);
    let start = (inverse_aces(TARGET) / brightest).log2();
    // At least a step of one stop, also if all pixels are alike.
    let stop = (inverse_aces(TARGET) / median).log2().clamp(start, start + MAX_STOPS);
    let steps = (stop - start).ceil().max(2.0);
    (0..steps as u32).map(|step| start + (stop - start) * f64::from(step) / (steps - 1.0)).collect()
}

fn aces(x: f64) -> f64 {
    let [a, b, c, d, e, f] = ACES;
    let x = x.max(0.0);
    ((a * x * x + b * x + c) / (d * x * x + e * x + f)).clamp(0.0, 1.0)
}

/// Solves `aces(x) = y` for the positive `x`.
fn inverse_aces(y: f64) -> f64 {
    let [a, b, c] = std::array::from_fn(|i| ACES[i] - y * ACES[i + 3]);
    let half = -0.5 * b / a;
    half + (half * half - c / a).sqrt()
}

fn error_map(pair: &ImagePair, tone_map: impl Fn(f32) -> f32) -> Vec<f32> {
    let [width, height] = pair.size();
    let encode = |linear: f32| (255.0 * srgb_from_linear(tone_map(linear))).round() as u8;
    let [test, reference] = [pair.test(), pair.reference()].map(|pixels| {
        let bytes: Vec<u8> = pixels.iter().flatten().map(|&linear| encode(linear)).collect();
        FlipImageRgb8::with_data(width, height, &bytes)
    });
    nv_flip::flip(reference, test, DEFAULT_PIXELS_PER_DEGREE).to_vec()
}

fn mean_compared(pair: &ImagePair, errors: &[f32]) -> f64 {
    let compared = errors.iter().zip(pair.compared()).filter(|(_, compared)| **compared);
    let (sum, count) = compared.fold((0.0, 0u64), |(sum, count), (&error, _)| (sum + f64::from(error), count + 1));
    sum / count as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tone_mapping_is_inverted() {
        for y in [0.1, 0.5, TARGET, 0.95] {
            assert!((aces(inverse_aces(y)) - y).abs() < 1e-12);
        }
        assert_eq!(aces(-1.0), 0.0);
        assert_eq!(aces(1e9), 1.0);
    }

    #[test]
    fn exposures_span_from_the_brightest_to_the_median() {
        let pixels = |values: &[f32]| values.iter().map(|&value| [value; 3]).collect::<Vec<_>>();
        let of = |values: &[f32]| {
            exposures(&ImagePair::new([values.len() as u32, 1], pixels(values), pixels(values)).unwrap())
        };
        let found = of(&[0.5, 1.0, 16.0]);
        assert_eq!(found.len(), 4);
        assert!((found[3] - found[0] - 4.0).abs() < 1e-9, "{found:?}");
        assert!((aces(16.0 * found[0].exp2()) - TARGET).abs() < 1e-9);
        assert_eq!(of(&[0.0, 0.0, 0.0]), [0.0]);
        assert_eq!(of(&[0.0, 0.0, 1.0]).len(), MAX_STOPS as usize, "a black median");
        assert_eq!(of(&[2.0, 2.0]).len(), 2);
    }
}
