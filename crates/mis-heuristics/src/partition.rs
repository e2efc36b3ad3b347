//! Partitions of the geometry term.

use crate::Float;
use crate::math::sqrt;

/// Why a partition makes no sense.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PartitionError {
    /// The threshold is negative or NaN.
    Threshold(f64),
}

impl core::fmt::Display for PartitionError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Threshold(threshold) => {
                write!(f, "the geometry term's threshold must be at least 0, not {threshold}")
            }
        }
    }
}

impl core::error::Error for PartitionError {}

/// How a geometry term is divided between connecting two points and scattering a ray.
///
/// ```text
/// G = cos_x cos_y / |x - y|^2
/// hard:  s(G) = 1 if G < t, else 0          (a point light takes all of G, or nothing)
/// soft:  s(G) = min(1, b / G)               (a point light takes min(G, b), the scattered ray max(0, G - b))
/// ```
///
/// **Symbols.** `G`: geometry term between two path vertices, in 1/length^2; `t`, `b`: the threshold, in the same
/// unit, hence
/// dependent on the unit of the scene; `s`: the share of the connection, for
/// [`Stratification`](crate::Stratification) or [`Remainder`](crate::Remainder).
///
/// **Assumptions.** `G >= 0`. An infinite `G` (coincident points) and NaN always go to the scattered ray.
///
/// **Unbiased** as the stratification heuristic. `t = 0` is path tracing, `t = inf` instant radiosity. The soft
/// partition
/// has no jump where `G = b`, and its point lights contribute a bounded but never vanishing amount; in exchange it
/// traces
/// shadow rays to all point lights, and all scattered rays with `G > b` carry a part of the light.
///
/// **Cost.** One comparison; one division more for the soft partition where `G > b`.
///
/// **Source.** Kollig and Keller 2004, equations 2 and 3; soft: T. Kollig and A. Keller, "Illumination in the Presence of Weak
/// Singularities", 2006.
///
/// # Example
/// ```
/// use mis_heuristics::GeometryPartition;
/// let (hard, soft) = (GeometryPartition::hard(0.5)?, GeometryPartition::soft(0.5)?);
/// assert_eq!((hard.share(0.4), hard.share(2.0)), (1.0, 0.0));
/// assert_eq!((soft.share(0.4), soft.share(2.0)), (1.0, 0.25));
/// assert_eq!((soft.bounded(2.0), soft.residual(2.0)), (0.5, 1.5));
/// assert_eq!(soft.reach(0.5), 1.0); // what the scattered ray may be needed for is at most this far away
/// # Ok::<(), mis_heuristics::PartitionError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(
        try_from = "Named<F>",
        into = "Named<F>",
        bound(serialize = "F: Float + serde::Serialize", deserialize = "F: Float + serde::Deserialize<'de>")
    )
)]
pub struct GeometryPartition<F> {
    threshold: F,
    soft: bool,
}

/// As it is in a file: the name of the constructor, and its threshold.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
enum Named<F> {
    Hard(F),
    Soft(F),
}

#[cfg(feature = "serde")]
impl<F: Float> TryFrom<Named<F>> for GeometryPartition<F> {
    type Error = PartitionError;

    fn try_from(named: Named<F>) -> Result<Self, PartitionError> {
        match named {
            Named::Hard(threshold) => Self::hard(threshold),
            Named::Soft(bound) => Self::soft(bound),
        }
    }
}

#[cfg(feature = "serde")]
impl<F> From<GeometryPartition<F>> for Named<F> {
    fn from(GeometryPartition { threshold, soft }: GeometryPartition<F>) -> Self {
        if soft { Self::Soft(threshold) } else { Self::Hard(threshold) }
    }
}

impl<F: Float> GeometryPartition<F> {
    /// All or nothing at the threshold `t`.
    ///
    /// # Errors
    /// [`PartitionError::Threshold`] if `threshold` is negative or NaN. (Zero and infinity are allowed.)
    pub fn hard(threshold: F) -> Result<Self, PartitionError> {
        Self::new(threshold, false)
    }

    /// The part of the geometry term up to `bound` is connected, the rest is scattered.
    ///
    /// # Errors
    /// [`PartitionError::Threshold`] if `bound` is negative or NaN. (Zero and infinity are allowed.)
    pub fn soft(bound: F) -> Result<Self, PartitionError> {
        Self::new(bound, true)
    }

    fn new(threshold: F, soft: bool) -> Result<Self, PartitionError> {
        if threshold >= F::ZERO {
            Ok(Self { threshold, soft })
        } else {
            Err(PartitionError::Threshold(threshold.to_f64()))
        }
    }

    /// The threshold `t` or bound `b`, in 1/length^2.
    #[inline]
    pub fn threshold(&self) -> F {
        self.threshold
    }

    /// Whether this is the soft partition.
    #[inline]
    pub fn is_soft(&self) -> bool {
        self.soft
    }

    /// The connection's share of the geometry term `g`, in `[0, 1]`.
    #[inline]
    pub fn share(&self, g: F) -> F {
        if g < self.threshold {
            F::ONE
        } else if self.soft && g < F::INFINITY {
            // g >= threshold here; 0/0 (a bound of zero) is not a share.
            (self.threshold / g).positive_part()
        } else {
            F::ZERO
        }
    }

    /// The connected part of the geometry term `g`: `g * share(g)`, at most the threshold.
    #[inline]
    pub fn bounded(&self, g: F) -> F {
        if g < self.threshold {
            g
        } else if self.soft && g >= self.threshold && g < F::INFINITY {
            self.threshold
        } else {
            F::ZERO
        }
    }

    /// The scattered part of the geometry term `g`: `g * (1 - share(g))`.
    #[inline]
    pub fn residual(&self, g: F) -> F {
        if g < self.threshold {
            F::ZERO
        } else if self.soft && g < F::INFINITY {
            g - self.threshold
        } else {
            g
        }
    }

    /// How far a scattered ray can be needed, given its cosine at the surface it leaves: `sqrt(cos / t)`.
    ///
    /// Beyond, `G < t`, since the cosine at the other end is at most one; the bound holds up to rounding. Infinite
    /// for `t = 0`;
    /// zero for a cosine that is negative or NaN.
    #[inline]
    pub fn reach(&self, cos_theta: F) -> F {
        F::from_f64(sqrt(self.reach_squared(cos_theta).to_f64()))
    }

    /// The square of [`reach`](Self::reach), cheaper: `cos / t`.
    #[inline]
    pub fn reach_squared(&self, cos_theta: F) -> F {
        if self.threshold == F::ZERO { F::INFINITY } else { cos_theta.positive_part() / self.threshold }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_are_checked() {
        for t in [-1.0_f32, f32::NEG_INFINITY, f32::NAN] {
            assert!(GeometryPartition::hard(t).is_err() && GeometryPartition::soft(t).is_err());
        }
        assert!(GeometryPartition::hard(-1.0_f64).unwrap_err().to_string_contains("-1"));
    }

    trait Contains {
        fn to_string_contains(&self, part: &str) -> bool;
    }
    impl Contains for PartitionError {
        fn to_string_contains(&self, part: &str) -> bool {
            extern crate std;
            std::string::ToString::to_string(self).contains(part)
        }
    }

    #[test]
    fn limits_are_path_tracing_and_instant_radiosity() {
        for g in [0.0_f32, 1e-30, 1.0, 1e30] {
            for (zero, infinite) in [
                (GeometryPartition::hard(0.0), GeometryPartition::hard(f32::INFINITY)),
                (GeometryPartition::soft(0.0), GeometryPartition::soft(f32::INFINITY)),
            ] {
                let (zero, infinite) = (zero.unwrap(), infinite.unwrap());
                assert_eq!((zero.share(g), zero.bounded(g), zero.residual(g)), (0.0, 0.0, g));
                assert_eq!((infinite.share(g), infinite.bounded(g), infinite.residual(g)), (1.0, g, 0.0));
                assert_eq!((zero.reach(0.5), infinite.reach(0.5)), (f32::INFINITY, 0.0));
            }
        }
    }

    #[test]
    fn coincident_points_and_nan_are_scattered() {
        for t in [0.0_f64, 0.3, f64::INFINITY] {
            for partition in [GeometryPartition::hard(t).unwrap(), GeometryPartition::soft(t).unwrap()] {
                assert_eq!((partition.share(f64::INFINITY), partition.bounded(f64::INFINITY)), (0.0, 0.0));
                assert_eq!((partition.share(f64::NAN), partition.bounded(f64::NAN)), (0.0, 0.0));
            }
        }
    }

    #[test]
    fn parts_add_up_and_match_the_share() {
        for t in [0.0_f64, 0.05, 0.3, 10.0] {
            for partition in [GeometryPartition::hard(t).unwrap(), GeometryPartition::soft(t).unwrap()] {
                for k in 0..200 {
                    let g = 0.1 * f64::from(k);
                    let share = partition.share(g);
                    assert!((0.0..=1.0).contains(&share));
                    assert!((partition.bounded(g) + partition.residual(g) - g).abs() < 1e-14);
                    assert!((partition.bounded(g) - g * share).abs() < 1e-14);
                    assert!(partition.bounded(g) <= t);
                }
            }
        }
    }

    #[test]
    fn nothing_beyond_the_reach_is_scattered() {
        let partition = GeometryPartition::soft(0.3_f64).unwrap();
        for cos in [0.0, 0.1, 0.7, 1.0] {
            let distance = partition.reach(cos) * 1.000_001 + 1e-9;
            assert_eq!(partition.share(cos / (distance * distance)), 1.0);
        }
        assert_eq!(partition.reach(-0.5), 0.0);
        assert_eq!(partition.reach(f64::NAN), 0.0);
    }
}
