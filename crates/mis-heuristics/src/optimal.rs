//! Optimal weights.

use crate::math::solve_semidefinite;
use crate::{Densities, Float, Heuristic};

/// Why optimal weights cannot be computed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum OptimalError {
    /// There is no technique.
    NoTechnique,
    /// A technique takes no samples.
    NoSamples {
        /// Which technique.
        technique: usize,
    },
    /// The value of the integrand is infinite or NaN.
    Value(f64),
    /// The densities of a sample sum to this, which is not a positive, finite number: the sample cannot have been
    /// generated.
    DensitySum(f64),
    /// The number of densities differs from the number of techniques.
    Techniques {
        /// Number of techniques.
        expected: usize,
        /// Number of densities.
        found: usize,
    },
}

impl core::fmt::Display for OptimalError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NoTechnique => write!(f, "optimal weights need at least one technique"),
            Self::NoSamples { technique } => write!(f, "technique {technique} takes no samples"),
            Self::Value(value) => write!(f, "the integrand must be finite, not {value}"),
            Self::DensitySum(sum) => write!(f, "the densities of a sample must have a positive, finite sum, not {sum}"),
            Self::Techniques { expected, found } => write!(f, "{found} densities for {expected} techniques"),
        }
    }
}

impl core::error::Error for OptimalError {}

/// The moments from which the optimal weights of `N` techniques are found: the technique matrix and the contribution
/// vector.
///
/// ```text
/// A_ik = E sum over all samples of  d_i d_k / D^2
/// b_i  = E sum over all samples of  f d_i / D^2,        D = sum_j d_j
/// A beta = b
/// ```
///
/// **Symbols.** `d_j = n_j p_j`: densities of a sample, as everywhere in this crate; `f`: the integrand. The
/// publication writes the same with
/// `p_j` in place of `d_j` and `alpha_j = n_j beta_j`. The expectations are estimated by the samples of all
/// iterations so far.
///
/// **Assumptions.** Technique `i` takes exactly `n_i` samples per iteration, and **every** sample is added, above all
/// those where `f` is zero.
/// For colours, weight every channel on its own or by luminance: the weights stay unbiased for any `f`.
///
/// **Cost.** `N^2 + N` multiply-adds per sample, `N^3` operations per solution; no allocation. All in `f64`.
///
/// **Source.** I. Kondapaneni, P. Vévoda, P. Grittmann, T. Skřivan, P. Slusallek, J. Křivánek, "Optimal Multiple
/// Importance Sampling", 2019.
///
/// # Example
/// ```
/// use mis_heuristics::OptimalMoments;
/// // The integrand 2 p_0 + 3 p_1 lies in the span of the techniques: the optimal weights have no variance.
/// let mut moments = OptimalMoments::new([1, 1])?;
/// for p in [[0.5, 0.1], [0.2, 0.7], [0.3, 0.3]] {
///     moments.add(2.0 * p[0] + 3.0 * p[1], &p)?;
/// }
/// let weights = moments.solve();
/// assert!((weights.constant() - 5.0).abs() < 1e-9);
/// assert!(weights.contribution(2.0 * 0.4 + 3.0 * 0.6, &[0.4, 0.6])?.abs() < 1e-9);
/// # Ok::<(), mis_heuristics::OptimalError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct OptimalMoments<const N: usize> {
    counts: [u32; N],
    matrix: [[f64; N]; N],
    vector: [f64; N],
    samples: u64,
}

impl<const N: usize> OptimalMoments<N> {
    /// No samples yet, of techniques that take `counts` samples per iteration.
    ///
    /// # Errors
    /// [`OptimalError::NoTechnique`] if `N` is zero, [`OptimalError::NoSamples`] if a count is zero.
    pub fn new(counts: [u32; N]) -> Result<Self, OptimalError> {
        if N == 0 {
            return Err(OptimalError::NoTechnique);
        }
        if let Some(technique) = counts.iter().position(|&count| count == 0) {
            return Err(OptimalError::NoSamples { technique });
        }
        Ok(Self { counts, matrix: [[0.0; N]; N], vector: [0.0; N], samples: 0 })
    }

    /// Adds a sample of any technique: the value `f` of the integrand and the densities `n_i p_i` there.
    ///
    /// # Errors
    /// [`OptimalError::Value`], [`OptimalError::DensitySum`] or [`OptimalError::Techniques`]; nothing is added then.
    pub fn add<F: Float>(&mut self, f: f64, densities: &(impl Densities<F> + ?Sized)) -> Result<(), OptimalError> {
        let sample = Shares::<N>::of(f, densities)?;
        for i in 0..N {
            for k in 0..N {
                self.matrix[i][k] += sample.shares[i] * sample.shares[k];
            }
            self.vector[i] += sample.shares[i] * sample.balance;
        }
        self.samples += 1;
        Ok(())
    }

    /// Adds the moments of other samples of the same techniques.
    pub fn merge(&mut self, other: &Self) {
        for i in 0..N {
            for k in 0..N {
                self.matrix[i][k] += other.matrix[i][k];
            }
            self.vector[i] += other.vector[i];
        }
        self.samples += other.samples;
    }

    /// Number of samples added.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// The weights that are optimal for the moments. Before the first sample: those of the balance heuristic.
    ///
    /// Techniques that depend linearly on others (equal ones, or more techniques than samples) get a coefficient of
    /// zero, which
    /// changes nothing: any solution is as good.
    pub fn solve(&self) -> OptimalWeights<N> {
        OptimalWeights { counts: self.counts, beta: solve_semidefinite(self.matrix, self.vector) }
    }
}

/// Weights of least variance, among all weights that sum to one; they may be negative.
///
/// ```text
/// w_i = beta_i d_i / f + d_i / D (1 - sum_k beta_k d_k / f)
/// estimate = sum_k n_k beta_k + sum over all samples of (f - sum_k beta_k d_k) / D,      D = sum_j d_j
/// ```
///
/// **Symbols.** As for [`OptimalMoments`]. The second line is the same estimator without the division by `f`, and a
/// control variate: use it.
///
/// **Assumptions.** The coefficients do not depend on the samples they weight, otherwise the estimate is only
/// consistent: solve from
/// earlier iterations ([`ProgressiveOptimal`](crate::ProgressiveOptimal)). The sum runs over all samples, also those
/// where `f` is zero.
///
/// **Unbiased** for any coefficients; of least variance for the true moments. Negative weights can beat the bounds
/// that hold for
/// non-negative ones.
///
/// **Cost.** Asks for all densities, each once; `2 N` multiply-adds and `N` divisions.
///
/// **Source.** As for [`OptimalMoments`].
///
/// # Example
/// ```
/// use mis_heuristics::{Heuristic, OptimalWeights};
/// let weights = OptimalWeights::balance([1, 1])?;
/// assert_eq!(weights.at(7.0).weight(0, &[1.0, 3.0]), 0.25);
/// assert_eq!(weights.contribution(8.0, &[1.0, 3.0])?, 2.0);
/// # Ok::<(), mis_heuristics::OptimalError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct OptimalWeights<const N: usize> {
    counts: [u32; N],
    beta: [f64; N],
}

impl<const N: usize> OptimalWeights<N> {
    /// All coefficients zero: the balance heuristic.
    ///
    /// # Errors
    /// [`OptimalError::NoTechnique`] if `N` is zero, [`OptimalError::NoSamples`] if a count is zero.
    pub fn balance(counts: [u32; N]) -> Result<Self, OptimalError> {
        OptimalMoments::new(counts).map(|moments| moments.solve())
    }

    /// The coefficients `alpha_k = n_k beta_k` of the publication.
    pub fn alpha(&self) -> [f64; N] {
        core::array::from_fn(|k| f64::from(self.counts[k]) * self.beta[k])
    }

    /// `sum_k alpha_k`: what each iteration's estimate starts from.
    pub fn constant(&self) -> f64 {
        self.alpha().iter().sum()
    }

    /// `(f - sum_k beta_k d_k) / D`: what one sample adds to its iteration's estimate.
    ///
    /// # Errors
    /// [`OptimalError::Value`], [`OptimalError::DensitySum`] or [`OptimalError::Techniques`].
    pub fn contribution<F: Float>(
        &self,
        f: f64,
        densities: &(impl Densities<F> + ?Sized),
    ) -> Result<f64, OptimalError> {
        let sample = Shares::<N>::of(f, densities)?;
        Ok(sample.balance - self.control(&sample.shares))
    }

    fn control(&self, shares: &[f64; N]) -> f64 {
        self.beta.iter().zip(shares).map(|(beta, share)| beta * share).sum()
    }

    /// The weights as a heuristic, at a sample where the integrand is `f`.
    ///
    /// For comparison with other heuristics: the weights have no limit where `f` goes to zero
    /// ([`contribution`](Self::contribution) has).
    /// Where a weight would exceed a thousand times that of the balance heuristic (`f` next to zero), all are those
    /// of the balance heuristic;
    /// also where `f` is infinite or NaN, or a density is infinite. The laws hold all the same.
    pub fn at(&self, f: f64) -> OptimalAt<'_, N> {
        OptimalAt { weights: self, f }
    }
}

/// [`OptimalWeights`] at a sample where the value of the integrand is known; made by [`OptimalWeights::at`].
#[derive(Clone, Copy, Debug)]
pub struct OptimalAt<'a, const N: usize> {
    weights: &'a OptimalWeights<N>,
    f: f64,
}

impl<F: Float, const N: usize> Heuristic<F> for OptimalAt<'_, N> {
    fn weight(&self, technique: usize, densities: &(impl Densities<F> + ?Sized)) -> F {
        let Ok(sample) = Shares::<N>::of(self.f, densities) else {
            return crate::Balance.weight(technique, densities);
        };
        // w_i = s_i (1 + (beta_i - sum_k beta_k s_k) D / f), with s_i = d_i / D.
        let control = self.weights.control(&sample.shares);
        let excess = |beta: f64| (beta - control) / sample.balance;
        let share = sample.shares[technique];
        let bounded = self.weights.beta.iter().all(|&beta| excess(beta).abs() <= LARGEST_EXCESS);
        F::from_f64(if bounded { share * (1.0 + excess(self.weights.beta[technique])) } else { share })
    }
}

/// Beyond, the sum of the weights would drown in rounding errors.
const LARGEST_EXCESS: f64 = 1e3;

/// A sample as the formulas need it.
struct Shares<const N: usize> {
    /// `d_i / D`, the weights of the balance heuristic.
    shares: [f64; N],
    /// `f / D`, the contribution under the balance heuristic.
    balance: f64,
}

impl<const N: usize> Shares<N> {
    fn of<F: Float>(f: f64, densities: &(impl Densities<F> + ?Sized)) -> Result<Self, OptimalError> {
        if densities.len() != N {
            return Err(OptimalError::Techniques { expected: N, found: densities.len() });
        }
        if !f.is_finite() {
            return Err(OptimalError::Value(f));
        }
        let density: [f64; N] = core::array::from_fn(|i| densities.density(i).positive_part().to_f64());
        let sum: f64 = density.iter().sum();
        if sum > 0.0 && sum < f64::INFINITY {
            Ok(Self { shares: density.map(|d| d / sum), balance: f / sum })
        } else {
            Err(OptimalError::DensitySum(sum))
        }
    }
}
