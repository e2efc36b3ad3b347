//! What candidates and samples cost.

use alloc::vec::Vec;

/// `T_X` and `T_Y`, in any unit of time they share (or in rays).
///
/// ```text
/// T = N (M T_X + T_Y)                                                           (Talbot, Cline and Egbert 2005, section 4.2, without r(M))
/// ```
///
/// **Symbols.** `T_X`: drawing a candidate and evaluating source and target; `T_Y`: what a selected sample costs, that is
/// everything that is done once per sample: integrand, visibility, selection. Talbot, Cline and Egbert 2005 says "the time to compute
/// equation 1" in section 4.2 and "the time to check visibility" in 5.1; what is really spent counts.
///
/// ```
/// use ris::CostModel;
/// let cost = CostModel::new(2.0, 30.0)?;
/// assert_eq!(cost.robust().candidates(), 15.0); // M = T_Y / T_X
/// assert!(CostModel::new(0.0, 1.0).is_err());
/// # Ok::<(), ris::CostError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Costs"))]
pub struct CostModel {
    candidate: f64,
    sample: f64,
}

/// As they are in a file.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Costs {
    candidate: f64,
    sample: f64,
}

#[cfg(feature = "serde")]
impl TryFrom<Costs> for CostModel {
    type Error = CostError;
    fn try_from(Costs { candidate, sample }: Costs) -> Result<Self, CostError> {
        Self::new(candidate, sample)
    }
}

/// Why costs make no sense.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum CostError {
    /// A cost of candidates that is not positive and finite.
    Candidate(f64),
    /// A cost of samples that is negative or not finite.
    Sample(f64),
    /// Too few timings.
    TooFew {
        /// How many there are.
        count: usize,
    },
}

impl core::fmt::Display for CostError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Candidate(cost) => write!(f, "a candidate cannot cost {cost}: it has to be positive and finite"),
            Self::Sample(cost) => write!(f, "a sample cannot cost {cost}: it has to be finite and not negative"),
            Self::TooFew { count } => write!(f, "{count} timings are too few for a robust mean, it takes four"),
        }
    }
}

impl core::error::Error for CostError {}

impl CostModel {
    /// Of given costs.
    ///
    /// # Errors
    /// If a candidate costs nothing, or a cost is negative or not finite.
    pub const fn new(candidate: f64, sample: f64) -> Result<Self, CostError> {
        if !(candidate > 0.0 && candidate.is_finite()) {
            return Err(CostError::Candidate(candidate));
        }
        if !(sample >= 0.0 && sample.is_finite()) {
            return Err(CostError::Sample(sample));
        }
        Ok(Self { candidate, sample })
    }

    /// `T_X`, positive.
    #[inline]
    #[must_use]
    pub const fn candidate(&self) -> f64 {
        self.candidate
    }

    /// `T_Y`.
    #[inline]
    #[must_use]
    pub const fn sample(&self) -> f64 {
        self.sample
    }

    /// From timings of real evaluations, by their [`robust_mean`]. Each timing is the time of one evaluation, or of a block of
    /// them divided by their number (clocks are coarse).
    ///
    /// # Errors
    /// Fewer than four timings of either; timings without a positive mean.
    pub fn from_timings(candidates: &[f64], samples: &[f64]) -> Result<Self, CostError> {
        Self::new(robust_mean(candidates)?, robust_mean(samples)?)
    }

    /// Measures both: `blocks` times `candidate` and `sample` are called, in turn, so that drift of the machine hits both. Each
    /// call does a block of evaluations and returns their number (zero: nothing was done, and nothing counts). `clock` returns
    /// the time in any unit.
    ///
    /// # Errors
    /// As [`from_timings`](Self::from_timings).
    ///
    /// ```
    /// # #[cfg(feature = "std")] {
    /// use ris::{CostModel, seconds};
    /// let work = |n: u32| (0..n).map(f64::from).map(f64::sqrt).sum::<f64>();
    /// let cost = CostModel::measure(
    ///     64,
    ///     seconds(),
    ///     || { std::hint::black_box(work(100)); 1 },
    ///     || { std::hint::black_box(work(1000)); 1 },
    /// )?;
    /// assert!(cost.robust().candidates() >= 1.0);
    /// # }
    /// # Ok::<(), ris::CostError>(())
    /// ```
    pub fn measure(
        blocks: usize,
        mut clock: impl FnMut() -> f64,
        mut candidate: impl FnMut() -> usize,
        mut sample: impl FnMut() -> usize,
    ) -> Result<Self, CostError> {
        let mut timings: [Vec<f64>; 2] = [Vec::with_capacity(blocks), Vec::with_capacity(blocks)];
        let mut time = |work: &mut dyn FnMut() -> usize, timings: &mut Vec<f64>| {
            let start = clock();
            let count = work();
            let end = clock();
            if count > 0 {
                timings.push((end - start) / count as f64);
            }
        };
        for _ in 0..blocks {
            time(&mut candidate, &mut timings[0]);
            time(&mut sample, &mut timings[1]);
        }
        Self::from_timings(&timings[0], &timings[1])
    }

    /// The robust choice `M = T_Y / T_X`, at least 1 and at most 2^24 (Talbot, Cline and Egbert 2005, equation 4), for one sample.
    ///
    /// It gives candidates and samples equal time. Within any time no other choice has more than twice its `M N` and none more
    /// than twice its `N`, so, for real counts, **if `e3 >= e2` in every component** its variance is at most twice the least. Where more candidates hurt
    /// (`e3 < e2`) the bound fails, and `M = 1` is the choice; see [`VarianceModel`](crate::VarianceModel).
    #[must_use]
    pub fn robust(&self) -> crate::Budget {
        crate::Budget::new(self.sample / self.candidate, 1.0)
    }
}

/// The mean of the middle half of the values (interquartile mean): neither an interrupt nor a warm cache moves it.
///
/// Values that are not finite are left out.
///
/// # Errors
/// [`CostError::TooFew`] with fewer than four finite values.
///
/// ```
/// assert_eq!(ris::robust_mean(&[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1e9])?, 1.0);
/// # Ok::<(), ris::CostError>(())
/// ```
pub fn robust_mean(values: &[f64]) -> Result<f64, CostError> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    if sorted.len() < 4 {
        return Err(CostError::TooFew { count: sorted.len() });
    }
    sorted.sort_unstable_by(f64::total_cmp);
    let quarter = sorted.len() / 4;
    let middle = &sorted[quarter..sorted.len() - quarter];
    Ok(middle.iter().sum::<f64>() / middle.len() as f64)
}

/// A clock in seconds, for [`CostModel::measure`].
#[cfg(feature = "std")]
pub fn seconds() -> impl FnMut() -> f64 {
    let start = std::time::Instant::now();
    move || start.elapsed().as_secs_f64()
}
