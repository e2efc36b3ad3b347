//! The scale of importance.

/// The factor `f` that turns importance into a probability, from what test rays find.
///
/// ```text
/// f = 1 / quantile of the positive W(x_i),      p(x) = min(1, f W(x))
/// ```
///
/// **Symbols.** `W(x_i)`: importance at the points that test rays from the camera hit first. Quantile 0 is their
/// minimum, as Keller and Wald 2000 has it: every photon is kept where any test ray found an importon.
///
/// **What if a test ray finds no importon?** Keller and Wald's minimum is zero then, and `f` infinite: `p = 1` wherever there is
/// any importance, 0 or the floor elsewhere, and nothing is saved. Here such queries are left out of the quantile and
/// counted: [`empty_share`](Self::empty_share). They lie in places that the camera sees and `p` does not know of: a
/// floor keeps the estimate unbiased there, with few photons of much flux; a cutoff makes these places black. So if
/// the share is more than a few percent, trace more importons or look farther for them (or for the nearest). Even
/// without empty queries the minimum is as unreliable as the worst of them: a quantile of 0.05 is a good choice, at
/// which `p = 1` for 95 percent of what test rays see. If *all* are empty there is no scale, and an error.
///
/// The choice of `f` changes variance and memory, never the expectation, as long as the bound is a floor.
///
/// **Cost.** A selection, linear in the number of queries.
///
/// **Source.** Keller and Wald 2000, section 2.3.
///
/// # Example
/// ```
/// use photon_map::ImportanceScale;
/// let scale = ImportanceScale::from_queries([4.0, 2.0, 0.0, 8.0], 0.0)?;
/// assert_eq!((scale.value(), scale.empty_share()), (0.5, 0.25));
/// assert!(ImportanceScale::from_queries([0.0, 0.0], 0.0).is_err());
/// # Ok::<(), photon_map::ScaleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked"))]
pub struct ImportanceScale {
    scale: f64,
    empty_share: f64,
}

#[cfg(feature = "serde")]
read_through!(ImportanceScale { scale: f64, empty_share: f64 } => {
    // With all queries empty there would be no scale.
    let valid = (0.0..1.0).contains(&empty_share);
    if valid { Ok(Self { empty_share, ..Self::new(scale)? }) } else { Err(ScaleError::EmptyShare(empty_share)) }
}, ScaleError);

/// Why there is no scale.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScaleError {
    /// No query found importance.
    #[error("none of {queries} test queries found importance: trace more importons, or look farther for them")]
    NoImportance {
        /// The number of queries.
        queries: usize,
    },
    /// No such quantile.
    #[error("a quantile lies in [0, 1], not at {0}")]
    Quantile(f64),
    /// No such scale.
    #[error("a scale is positive and finite, not {0}")]
    Scale(f64),
    /// No such share of empty queries, in a file.
    #[error("the share of test queries that found no importance lies in [0, 1), not at {0}")]
    EmptyShare(f64),
}

impl ImportanceScale {
    /// From the importance that test rays found; zeros and numbers that are negative or not finite count as empty.
    ///
    /// # Errors
    /// [`ScaleError::NoImportance`] if all queries are empty or there is none, [`ScaleError::Quantile`] if that is
    /// not in `[0, 1]`, [`ScaleError::Scale`] if one over the quantile overflows.
    pub fn from_queries(queries: impl IntoIterator<Item = f64>, quantile: f64) -> Result<Self, ScaleError> {
        if !(0.0..=1.0).contains(&quantile) {
            return Err(ScaleError::Quantile(quantile));
        }
        let mut count = 0;
        let counted = queries.into_iter().inspect(|_| count += 1);
        let mut found: Vec<f64> = counted.filter(|&importance| importance > 0.0 && importance.is_finite()).collect();
        if found.is_empty() {
            return Err(ScaleError::NoImportance { queries: count });
        }
        let place = (quantile * (found.len() - 1) as f64).floor() as usize;
        let least = *found.select_nth_unstable_by(place, f64::total_cmp).1;
        let scale = Self::new(1.0 / least)?;
        Ok(Self { empty_share: (count - found.len()) as f64 / count as f64, ..scale })
    }

    /// A scale that is known.
    ///
    /// # Errors
    /// [`ScaleError::Scale`] if it is not positive and finite.
    pub fn new(scale: f64) -> Result<Self, ScaleError> {
        let valid = scale > 0.0 && scale.is_finite();
        if valid { Ok(Self { scale, empty_share: 0.0 }) } else { Err(ScaleError::Scale(scale)) }
    }

    /// The factor `f`.
    #[must_use]
    pub const fn value(&self) -> f64 {
        self.scale
    }

    /// The share of the test queries that found no importance.
    #[must_use]
    pub const fn empty_share(&self) -> f64 {
        self.empty_share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_leave_outliers_out() {
        let queries = || (1..=100).map(f64::from).chain([f64::NAN, -1.0, f64::INFINITY, 0.0]);
        let scale = |quantile| ImportanceScale::from_queries(queries(), quantile).unwrap().value();
        assert_eq!([scale(0.0), scale(1.0), scale(0.5)], [1.0, 0.01, 1.0 / 50.0]);
        assert_eq!(ImportanceScale::from_queries(queries(), 0.0).unwrap().empty_share(), 4.0 / 104.0);
    }

    #[test]
    fn impossible_scales_are_refused() {
        assert_eq!(ImportanceScale::from_queries([], 0.0), Err(ScaleError::NoImportance { queries: 0 }));
        assert_eq!(ImportanceScale::from_queries([0.0; 3], 0.5), Err(ScaleError::NoImportance { queries: 3 }));
        assert!(matches!(ImportanceScale::from_queries([1.0], f64::NAN), Err(ScaleError::Quantile(_))));
        assert!(matches!(ImportanceScale::from_queries([1e-320], 0.0), Err(ScaleError::Scale(_))));
        assert!(matches!(ImportanceScale::new(0.0), Err(ScaleError::Scale(_))));
    }
}
