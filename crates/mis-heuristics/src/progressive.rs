//! The progressive estimator with optimal weights.

use crate::{Densities, Float, OptimalError, OptimalMoments, OptimalWeights, RunningVariance};

/// Optimal weights, learnt while the estimate is made: each iteration is weighted by what the iterations before it
/// have shown.
///
/// ```text
/// estimate of iteration t = sum_k n_k beta_k + sum over its samples of (f - sum_k beta_k d_k) / D
/// beta from the moments of iterations 1 .. t-1;    result: the mean over the iterations
/// ```
///
/// **Symbols.** As for [`OptimalMoments`] and [`OptimalWeights`].
///
/// **Assumptions.** Iterations are independent; in each of them technique `i` takes exactly `n_i` samples, and all
/// are added.
///
/// **Unbiased**, since the coefficients of an iteration do not depend on its samples.
///
/// **Cost.** Per sample `N^2 + 2 N` multiply-adds, per iteration `N^3` operations.
///
/// **Source.** Kondapaneni et al. 2019, the progressive estimator.
///
/// # Example
/// ```
/// use mis_heuristics::ProgressiveOptimal;
/// // A die: technique 0 is fair, technique 1 prefers large numbers. The sum of the pips is 21.
/// let p = |x: usize| [1.0 / 6.0, x as f64 / 21.0];
/// let mut estimate = ProgressiveOptimal::new([1, 1], 1)?;
/// for samples in [[1, 6], [5, 3], [2, 5], [6, 4]] {
///     for x in samples {
///         estimate.add(x as f64, &p(x))?;
///     }
///     estimate.end_iteration();
/// }
/// // The integrand is 21 times technique 1: from the second iteration on the estimate is exact.
/// assert!((estimate.last().unwrap_or(0.0) - 21.0).abs() < 1e-9);
/// # Ok::<(), mis_heuristics::OptimalError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ProgressiveOptimal<const N: usize> {
    moments: OptimalMoments<N>,
    weights: OptimalWeights<N>,
    training: u64,
    current: f64,
    last: Option<f64>,
    estimates: RunningVariance,
}

impl<const N: usize> ProgressiveOptimal<N> {
    /// `counts` samples per technique and iteration; the first `training` iterations (at least one) use the balance
    /// heuristic.
    ///
    /// Coefficients learnt from few samples can be worse than none: a handful of training iterations pays for noisy
    /// integrands.
    ///
    /// # Errors
    /// [`OptimalError::NoTechnique`] if `N` is zero, [`OptimalError::NoSamples`] if a count is zero.
    pub fn new(counts: [u32; N], training: u32) -> Result<Self, OptimalError> {
        Ok(Self {
            moments: OptimalMoments::new(counts)?,
            weights: OptimalWeights::balance(counts)?,
            training: u64::from(training),
            current: 0.0,
            last: None,
            estimates: RunningVariance::new(),
        })
    }

    /// Adds a sample of any technique to the current iteration.
    ///
    /// # Errors
    /// [`OptimalError::Value`], [`OptimalError::DensitySum`] or [`OptimalError::Techniques`]; nothing is added then.
    pub fn add<F: Float>(&mut self, f: f64, densities: &(impl Densities<F> + ?Sized)) -> Result<(), OptimalError> {
        let contribution = self.weights.contribution(f, densities)?;
        self.moments.add(f, densities)?;
        self.current += contribution;
        Ok(())
    }

    /// Ends an iteration, returns its estimate, and solves for the coefficients of the next.
    pub fn end_iteration(&mut self) -> f64 {
        let estimate = self.weights.constant() + self.current;
        self.estimates.push(estimate);
        self.current = 0.0;
        self.last = Some(estimate);
        if self.estimates.count() >= self.training {
            self.weights = self.moments.solve();
        }
        estimate
    }

    /// The estimate of the last iteration; `None` before the first one ended.
    pub fn last(&self) -> Option<f64> {
        self.last
    }

    /// The estimates of the iterations: their mean is the result, their variance that of one iteration.
    pub fn estimates(&self) -> &RunningVariance {
        &self.estimates
    }

    /// The weights of the current iteration.
    pub fn weights(&self) -> &OptimalWeights<N> {
        &self.weights
    }
}
