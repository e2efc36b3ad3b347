//! Images compared block by block.

use std::fmt;

use crate::bins::Stop as Refused;
use crate::mean::{Truth, one_sample, two_sample, unusable};
use crate::moments::Moments;
use crate::multiple::holm_adjusted;
use crate::outcome::Outcome;
use crate::suite::Check;
use crate::verdict::{Undecided, Violation};

/// Why a batch or an image was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum BlockError {
    /// The number of values is not the number of blocks, or of pixels.
    Length {
        /// How many there should be.
        expected: usize,
        /// How many there are.
        got: usize,
    },
    /// An image or a block without pixels.
    Empty,
}

impl fmt::Display for BlockError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length { expected, got } => write!(f, "expected {expected} values, got {got}"),
            Self::Empty => write!(f, "an image and a block have at least one pixel"),
        }
    }
}

impl std::error::Error for BlockError {}

/// The means of the blocks of an image, over independent batches; two estimators are compared block by block.
///
/// ```text
/// t_b = (mean_r x_{b,r} - mean_r y_{b,r}) / sqrt(s_x^2 / R_x + s_y^2 / R_y)        (Welch)
/// ```
///
/// - `x_{b,r}`: the mean of block `b` in batch `r`, over the pixels of the block and the samples of the batch,
/// - `R`: the number of batches; the degrees of freedom are between `min(R_x, R_y) - 1` and `R_x + R_y - 2`.
///
/// A single pixel of a rendering has far too heavy a tail for a t-test. The mean of a block over a batch averages
/// thousands of samples and is nearly normal; its variance is estimated from the batches alone, so that the samples
/// within a batch may depend on each other (stratification, quasi-Monte Carlo, light paths shared by the pixels). Batches
/// must be independent: other seeds. Use 16 batches or more, and blocks so large that each holds some light in every
/// batch. Blocks may depend on each other: the family is decided by [`holm`](crate::holm), so the image as a whole fails
/// by chance with probability `alpha`. A colour channel is a block of its own.
///
/// NaN and infinities are violations that name the block; fewer than two batches, or images of different size, are
/// undecided. Without any variance, as in a furnace, a block is rejected exactly if it differs.
///
/// Sources: Schmeiser, "Batch size effects in the analysis of simulation output" (1982); Welch (1947); Holm (1979).
///
/// ```
/// use estimator_checks::{BatchMeans, Check, Uniforms};
///
/// let render = |name: &str, gain: f64| -> Result<BatchMeans, estimator_checks::BlockError> {
///     let mut uniforms = Uniforms::named(name);
///     let mut means = BatchMeans::new(4);
///     for _ in 0..32 {
///         let pixels: Vec<f64> = (0..64).map(|_| gain * -(1.0 - uniforms.next_f64()).ln()).collect();
///         means.push_image(&pixels, 8, 4)?;
///     }
///     Ok(means)
/// };
/// let (a, b, c) = (render("path", 1.0)?, render("light", 1.0)?, render("light with a bug", 1.5)?);
/// a.agrees_with(Check::new("same image", 1e-6)?, &b).expect_pass();
/// a.agrees_with(Check::new("too bright", 1e-6)?, &c).expect_reject();
/// a.agrees_with_truth(Check::new("truth", 1e-6)?, &[1.0; 4]).expect_pass();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BatchMeans {
    blocks: Vec<Moments>,
    allowance: f64,
}

impl BatchMeans {
    /// A number of blocks, without any batches yet.
    pub fn new(blocks: usize) -> Self {
        Self { blocks: vec![Moments::new(); blocks], allowance: 0.0 }
    }

    /// Blocks whose moments over independent batches are already known.
    pub fn from_moments(blocks: Vec<Moments>) -> Self {
        Self { blocks, allowance: 0.0 }
    }

    /// Allows a relative difference of the means, as from `f32` accumulation; zero unless set.
    #[must_use]
    pub fn allowance(self, relative: f64) -> Self {
        Self { allowance: relative, ..self }
    }

    /// Adds the block means of a batch.
    ///
    /// # Errors
    /// [`BlockError::Length`] if there is not one mean per block.
    pub fn push_batch(&mut self, means: &[f64]) -> Result<(), BlockError> {
        if means.len() != self.blocks.len() {
            return Err(BlockError::Length { expected: self.blocks.len(), got: means.len() });
        }
        self.blocks.iter_mut().zip(means).for_each(|(moments, &mean)| moments.push(mean));
        Ok(())
    }

    /// Adds a batch given as an image of one channel, in row-major order, averaged over blocks of `block * block` pixels;
    /// the blocks at the right and lower edge may be smaller. Blocks are in row-major order, too.
    ///
    /// # Errors
    /// [`BlockError::Empty`] if `width` or `block` is zero, [`BlockError::Length`] if the pixels do not fill whole rows, or
    /// the image has another number of blocks.
    pub fn push_image(&mut self, pixels: &[f64], width: usize, block: usize) -> Result<(), BlockError> {
        if width == 0 || block == 0 || pixels.is_empty() {
            return Err(BlockError::Empty);
        }
        let height = pixels.len() / width;
        if height * width != pixels.len() {
            return Err(BlockError::Length { expected: (height + 1) * width, got: pixels.len() });
        }
        let columns = width.div_ceil(block);
        let mut sums = vec![(0.0, 0u32); columns * height.div_ceil(block)];
        for (y, row) in pixels.chunks(width).enumerate() {
            for (x, value) in row.iter().enumerate() {
                let sum = &mut sums[y / block * columns + x / block];
                *sum = (sum.0 + value, sum.1 + 1);
            }
        }
        let means: Vec<f64> = sums.into_iter().map(|(sum, count)| sum / f64::from(count)).collect();
        self.push_batch(&means)
    }

    /// The moments of each block over the batches.
    pub fn blocks(&self) -> &[Moments] {
        &self.blocks
    }

    /// Tests that another estimator renders the same image: Welch's t-test per block, Holm's procedure over the blocks.
    ///
    /// The statistic is that of the most significant block, the p-value is adjusted for the number of blocks.
    #[must_use = "it decides nothing until it is expected to pass or to reject"]
    pub fn agrees_with(&self, check: Check, other: &Self) -> Outcome {
        let method = "Welch's t per block, Holm";
        if let Some(refused) = self.refuse(other.blocks.len(), other.blocks.iter()) {
            return refused.into_outcome(check, method);
        }
        let allowance = self.allowance.max(other.allowance);
        let tests = self.blocks.iter().zip(&other.blocks).map(|(a, b)| {
            let (t, _, p_value) = two_sample(a, b, allowance * a.mean().abs().max(b.mean().abs()));
            Block { t, p_value, means: [a.mean(), b.mean()] }
        });
        decide(check, method, tests.collect())
    }

    /// Tests that the image is the true one: Student's t-test per block, Holm's procedure over the blocks.
    ///
    /// Skewed block means fail this one-sample test more often than [`agrees_with`](Self::agrees_with), where the skewness
    /// of similar estimators cancels: give it more batches, or larger ones.
    #[must_use = "it decides nothing until it is expected to pass or to reject"]
    pub fn agrees_with_truth(&self, check: Check, truth: &[f64]) -> Outcome {
        let method = "Student's t per block, Holm";
        if let Some(refused) = self.refuse(truth.len(), [].iter()) {
            return refused.into_outcome(check, method);
        }
        let tests = self.blocks.iter().zip(truth).map(|(a, &value)| {
            let (t, _, p_value) = one_sample(a, Truth::relative(value, self.allowance));
            Block { t, p_value, means: [a.mean(), value] }
        });
        decide(check, method, tests.collect())
    }

    fn refuse<'a>(&'a self, other: usize, others: impl Iterator<Item = &'a Moments>) -> Option<Refused> {
        if self.blocks.is_empty() {
            return Some(Refused::Undecided(Undecided::TooFew { what: "blocks", count: 0, needed: 1 }));
        }
        if self.blocks.len() != other {
            let text = format!("images of {} and {other} blocks", self.blocks.len());
            return Some(Refused::Undecided(Undecided::Argument(text)));
        }
        let bad = self.blocks.iter().enumerate().chain(others.enumerate());
        bad.filter_map(|(i, moments)| unusable(moments).map(|reason| (i, reason))).next().map(
            |(i, reason)| match reason {
                Ok(_) => Refused::Violation(Violation::NotFinite { what: "a batch mean", at: format!("block {i}") }),
                Err(Undecided::TooFew { count, needed, .. }) => {
                    Refused::Undecided(Undecided::TooFew { what: "batches", count, needed })
                }
                Err(reason) => Refused::Undecided(reason),
            },
        )
    }
}

struct Block {
    t: f64,
    p_value: f64,
    means: [f64; 2],
}

fn decide(check: Check, method: &str, blocks: Vec<Block>) -> Outcome {
    let raw: Vec<f64> = blocks.iter().map(|block| block.p_value).collect();
    let adjusted = holm_adjusted(&raw);
    let rejected = adjusted.iter().filter(|&&p| p < check.alpha()).count();
    let worst = (0..blocks.len())
        .min_by(|&i, &j| adjusted[i].total_cmp(&adjusted[j]).then(blocks[j].t.abs().total_cmp(&blocks[i].t.abs())));
    // `refuse` has made sure that there are blocks.
    let worst = worst.unwrap_or(0);
    let Block { t, means: [a, b], .. } = blocks[worst];
    Outcome::decide(check, format!("{method}, {} blocks", blocks.len()), t, adjusted[worst])
        .with_detail(format!("{rejected} blocks differ, worst block {worst} with means {a:.6e} and {b:.6e}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kolmogorov_smirnov::kolmogorov_smirnov;
    use crate::seed::Uniforms;

    const BLOCKS: usize = 64;

    fn check(name: &str) -> Check {
        Check::new(name, 1e-8).unwrap()
    }

    /// Heavy-tailed pixels: 1/sqrt(u) has infinite variance, u^-0.3 a finite one.
    fn render(name: &str, batches: usize, gain: impl Fn(usize) -> f64) -> BatchMeans {
        let mut uniforms = Uniforms::named(name);
        let mut means = BatchMeans::new(BLOCKS);
        for _ in 0..batches {
            let batch: Vec<f64> = (0..BLOCKS)
                .map(|b| gain(b) * (0..64).map(|_| 0.7 * (1.0 - uniforms.next_f64()).powf(-0.3)).sum::<f64>() / 64.0)
                .collect();
            means.push_batch(&batch).unwrap();
        }
        means
    }

    #[test]
    fn planted_bug_one_dark_block() {
        let (a, b) = (render("a", 32, |_| 1.0), render("b", 32, |_| 1.0));
        let dark = render("dark", 32, |block| if block == 17 { 0.8 } else { 1.0 });
        a.agrees_with(check("same"), &b).expect_pass();
        let outcome = a.agrees_with(check("dark"), &dark).expect_reject();
        assert!(outcome.detail.contains("worst block 17"), "{outcome}");
        a.agrees_with_truth(check("truth"), &[1.0; BLOCKS]).expect_pass();
        dark.agrees_with_truth(check("dark truth"), &[1.0; BLOCKS]).expect_reject();
    }

    #[test]
    fn planted_bug_two_percent_everywhere() {
        let (a, b) = (render("a2", 400, |_| 1.0), render("b2", 400, |_| 1.02));
        a.agrees_with(check("2 %"), &b).expect_reject();
        a.allowance(0.03).agrees_with(check("2 % allowed"), &b).expect_pass();
    }

    #[test]
    fn the_family_keeps_its_rate() {
        // The smallest of m adjusted p-values is below alpha < 1 with probability 1 - (1 - alpha / m)^m; spread the atom at 1.
        let mut uniforms = Uniforms::named("atom");
        let p_values: Vec<f64> = (0..200)
            .map(|i| {
                let (a, b) = (render(&format!("x{i}"), 16, |_| 1.0), render(&format!("y{i}"), 16, |_| 1.0));
                a.agrees_with(check("p"), &b).p_value
            })
            .collect();
        let m = BLOCKS as f64;
        let cdf = |p: f64| 1.0 - (1.0 - p / m).powf(m);
        let uniform = |p: f64, u: f64| if p < 1.0 { cdf(p) } else { cdf(1.0) + u * (1.0 - cdf(1.0)) };
        let spread: Vec<f64> = p_values.iter().map(|&p| uniform(p, uniforms.next_f64())).collect();
        kolmogorov_smirnov(check("block p-values"), &spread, |p| p).expect_pass();
        let alarms = p_values.iter().filter(|&&p| p < 0.05).count();
        assert!(alarms < 30, "{alarms} of 200 at a level of 5 %");
    }

    #[test]
    fn images_are_cut_into_blocks() {
        let mut means = BatchMeans::new(4);
        let pixels: Vec<f64> = (0..9).map(f64::from).collect();
        means.push_image(&pixels, 3, 2).unwrap();
        let values: Vec<f64> = means.blocks().iter().map(Moments::mean).collect();
        assert_eq!(values, [2.0, 3.5, 6.5, 8.0]);
        assert_eq!(means.push_image(&pixels[..8], 3, 2), Err(BlockError::Length { expected: 9, got: 8 }));
        assert_eq!(means.push_image(&pixels, 0, 2), Err(BlockError::Empty));
        assert_eq!(means.push_image(&pixels, 3, 3), Err(BlockError::Length { expected: 4, got: 1 }));
    }

    #[test]
    fn edges() {
        let furnace = BatchMeans::from_moments(vec![std::iter::repeat_n(0.3, 16).collect(); 3]);
        furnace.agrees_with_truth(check("furnace"), &[0.3; 3]).expect_pass();
        furnace.agrees_with_truth(check("furnace, off"), &[0.3, 0.3, 0.3001]).expect_reject();
        let nan = BatchMeans::from_moments(vec![[1.0, f64::NAN].into_iter().collect(); 3]);
        let outcome = furnace.agrees_with(check("nan"), &nan).expect_reject();
        assert!(outcome.to_string().contains("block 0"), "{outcome}");
        let single = BatchMeans::from_moments(vec![[1.0].into_iter().collect(); 3]);
        for outcome in [
            furnace.agrees_with(check("single"), &single),
            furnace.agrees_with(check("size"), &BatchMeans::new(2)),
            BatchMeans::new(0).agrees_with_truth(check("empty"), &[]),
        ] {
            assert!(!outcome.passed() && !outcome.rejected(), "{outcome}");
        }
    }
}
