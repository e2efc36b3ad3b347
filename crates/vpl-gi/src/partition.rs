//! How an edge of a path is shared between a connection and a scattered ray.

use mis_heuristics::{GeometryPartition, PartitionError};

/// The threshold of the geometry term, in units that the caller chooses.
///
/// The geometry term has the unit 1/length^2, and so has its threshold: the same number means another image cost after
/// the scene has been scaled (Kollig and Keller 2004, section 4.1.2). The normalised threshold does not.
///
/// ```
/// use vpl_gi::{Partition, Threshold};
/// let radius_of_the_scene = 3.0;
/// let partition = Partition::hard(Threshold::normalised(9.0).resolve(radius_of_the_scene))?;
/// assert_eq!(partition.threshold(), 1.0);
/// # Ok::<(), mis_heuristics::PartitionError>(())
/// ```
///
/// It has to be resolved with the radius of a scene first:
///
/// ```compile_fail,E0308
/// use vpl_gi::{Partition, Threshold};
/// let partition = Partition::hard(Threshold::normalised(9.0))?;
/// # Ok::<(), mis_heuristics::PartitionError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked", rename_all = "snake_case"))]
pub enum Threshold {
    /// In 1/length^2, in the scene's unit of length.
    Absolute(f32),
    /// In 1/R^2, where `R` is the radius of [`Scene::bounding_sphere`](scene_core::Scene::bounding_sphere): `t = value / R^2`.
    /// Scaling the scene changes neither the image nor the number of rays.
    Normalised(f32),
}

/// What is read, before it is checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(rename_all = "snake_case")]
enum Unchecked {
    Absolute(f32),
    Normalised(f32),
}

#[cfg(feature = "serde")]
impl TryFrom<Unchecked> for Threshold {
    type Error = PartitionError;

    fn try_from(unchecked: Unchecked) -> Result<Self, PartitionError> {
        let (Unchecked::Absolute(value) | Unchecked::Normalised(value)) = unchecked;
        Partition::hard(value)?;
        Ok(match unchecked {
            Unchecked::Absolute(value) => Self::Absolute(value),
            Unchecked::Normalised(value) => Self::Normalised(value),
        })
    }
}

impl Threshold {
    /// A threshold in units of one over the squared radius of the scene.
    pub const fn normalised(value: f32) -> Self {
        Self::Normalised(value)
    }

    /// The threshold in 1/length^2 for a scene of this radius.
    pub fn resolve(self, radius: f32) -> f32 {
        match self {
            Self::Absolute(threshold) => threshold,
            // Zero and infinity stay what they are, whatever the radius.
            Self::Normalised(value) if value == 0.0 || value.is_infinite() => value,
            Self::Normalised(value) => value / (radius * radius),
        }
    }
}

/// The share `s` of an edge from `x` to `y` that a connection takes; a scattered ray takes `1 - s`.
///
/// ```text
/// G = |cos_x cos_y| / |x - y|^2
/// hard:      s = 1 if G < t, else 0                        (Kollig and Keller 2004, equation 2)
/// soft:      s = min(1, t / G)                             (connections take min(G, t))
/// balance:   s = t / (t + G)                               (connections take less than t)
/// distance:  s = 1 if 1 / |x - y|^2 < t, else 0
/// ```
///
/// **Symbols.** `G`: geometry term with geometric normals, in 1/length^2; `t`: threshold, in the same unit. `balance` is the balance
/// heuristic between a constant density of light vertices by area and cosine-distributed rays, `t` being `pi` times that density.
///
/// **Assumptions.** `s` depends on the path alone, whichever technique found it: the estimators stay unbiased for each of these
/// forms and any `t`. Coincident points (`G` infinite or NaN) are always left to the scattered ray. `t = 0` is path tracing,
/// `t = inf` instant radiosity, for all forms.
///
/// **Source.** Kollig and Keller 2004, section 2 and figure 2, where the four are a) soft without the scattered ray, b) balance, c) distance, d) hard;
/// soft: Kollig and Keller, "Illumination in the Presence of Weak Singularities", 2006.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Named", into = "Named"))]
pub struct Partition {
    form: Form,
    threshold: f32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    Geometry(GeometryPartition<f32>),
    Balance,
    Distance,
}

/// As it is in a file: the name of the constructor, and its threshold.
#[cfg(feature = "serde")]
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
enum Named {
    Hard(f32),
    Soft(f32),
    Balance(f32),
    Distance(f32),
}

#[cfg(feature = "serde")]
impl TryFrom<Named> for Partition {
    type Error = PartitionError;
    fn try_from(named: Named) -> Result<Self, PartitionError> {
        match named {
            Named::Hard(threshold) => Self::hard(threshold),
            Named::Soft(threshold) => Self::soft(threshold),
            Named::Balance(threshold) => Self::balance(threshold),
            Named::Distance(threshold) => Self::distance(threshold),
        }
    }
}

#[cfg(feature = "serde")]
impl From<Partition> for Named {
    fn from(partition: Partition) -> Self {
        match partition.form {
            Form::Geometry(geometry) if geometry.is_soft() => Self::Soft(partition.threshold),
            Form::Geometry(_) => Self::Hard(partition.threshold),
            Form::Balance => Self::Balance(partition.threshold),
            Form::Distance => Self::Distance(partition.threshold),
        }
    }
}

impl Partition {
    /// All of the edge to the connection where `G < threshold`.
    ///
    /// # Errors
    /// If the threshold, in 1/length^2, is negative or NaN; so do all constructors.
    pub fn hard(threshold: f32) -> Result<Self, PartitionError> {
        Ok(Self { form: Form::Geometry(GeometryPartition::hard(threshold)?), threshold })
    }

    /// The part of `G` up to the threshold to the connection.
    ///
    /// # Errors
    /// As [`hard`](Self::hard).
    pub fn soft(threshold: f32) -> Result<Self, PartitionError> {
        Ok(Self { form: Form::Geometry(GeometryPartition::soft(threshold)?), threshold })
    }

    /// The share `t / (t + G)` to the connection.
    ///
    /// # Errors
    /// As [`hard`](Self::hard).
    pub fn balance(threshold: f32) -> Result<Self, PartitionError> {
        Self::hard(threshold)?;
        Ok(Self { form: Form::Balance, threshold })
    }

    /// All of the edge to the connection where `1 / distance^2 < threshold`.
    ///
    /// # Errors
    /// As [`hard`](Self::hard).
    pub fn distance(threshold: f32) -> Result<Self, PartitionError> {
        Self::hard(threshold)?;
        Ok(Self { form: Form::Distance, threshold })
    }

    /// The threshold, in 1/length^2.
    pub fn threshold(&self) -> f32 {
        self.threshold
    }

    /// The connection's share of an edge with geometry term `g` and squared distance `d2`, in `[0, 1]`.
    #[inline]
    pub fn share(&self, g: f32, d2: f32) -> f32 {
        self.share_with(g, || d2)
    }

    /// [`share`](Self::share) with the distance computed only where it is asked for.
    #[inline]
    pub(crate) fn share_with(&self, g: f32, d2: impl FnOnce() -> f32) -> f32 {
        match self.form {
            Form::Geometry(partition) => partition.share(g),
            Form::Balance => {
                if self.threshold == f32::INFINITY && g < f32::INFINITY {
                    return 1.0;
                }
                let share = self.threshold / (self.threshold + g);
                // 0 / 0, and NaN of coincident points.
                if share > 0.0 { share } else { 0.0 }
            }
            Form::Distance => {
                let d2 = d2();
                if d2 > 0.0 && 1.0 / d2 < self.threshold { 1.0 } else { 0.0 }
            }
        }
    }

    /// `g` times its share, without branches: for forms of the geometry term alone.
    #[inline]
    pub(crate) fn bounded(&self, g: f32) -> f32 {
        match self.form {
            Form::Geometry(partition) => partition.bounded(g),
            Form::Balance | Form::Distance => {
                let share = self.share_with(g, || 0.0);
                if share > 0.0 { g * share } else { 0.0 }
            }
        }
    }

    /// Whether the share depends on the geometry term alone.
    #[inline]
    pub(crate) fn is_of_geometry_term(&self) -> bool {
        self.form != Form::Distance
    }

    /// The share of connections to what is infinitely far away, where `G = 0`: 1, unless the threshold is zero.
    #[inline]
    pub fn share_at_infinity(&self) -> f32 {
        if self.threshold > 0.0 { 1.0 } else { 0.0 }
    }

    /// The distance beyond which connections take all, for a ray that leaves at this cosine (not negative): infinite if there is
    /// none. The bound holds up to rounding.
    #[inline]
    pub fn reach(&self, cos: f32) -> f32 {
        match self.form {
            Form::Geometry(partition) => partition.reach(cos),
            Form::Balance if self.threshold == f32::INFINITY => 0.0,
            Form::Balance => f32::INFINITY,
            Form::Distance => 1.0 / self.threshold.sqrt(),
        }
    }
}

/// How much more than a diffuse surface's the density is with which a surface scatters in a direction: `max(1, pi p / |cos|)`.
///
/// **Symbols.** `p`: density by solid angle; `cos`: with the geometric normal.
#[inline]
pub(crate) fn peak(pdf_solid_angle: f32, cos: f32) -> f32 {
    let ratio = core::f32::consts::PI * pdf_solid_angle / cos.abs();
    // NaN is none.
    if ratio > 1.0 { ratio } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diffuse_surfaces_have_no_peak() {
        for cos in [1.0, 0.3, 1e-4] {
            assert!((peak(cos / core::f32::consts::PI, cos) - 1.0).abs() < 1e-6);
        }
        assert_eq!((peak(0.0, 0.0), peak(0.0, 1.0), peak(f32::NAN, 1.0)), (1.0, 1.0, 1.0));
        assert!(peak(10.0, -0.5) > 60.0);
    }

    fn all(t: f32) -> [Partition; 4] {
        [Partition::hard(t), Partition::soft(t), Partition::balance(t), Partition::distance(t)].map(Result::unwrap)
    }

    #[test]
    fn limits_are_path_tracing_and_instant_radiosity() {
        for g in [0.0, 1e-30, 1.0, 1e30] {
            for partition in all(0.0) {
                assert_eq!((partition.share(g, 1.0), partition.reach(1.0)), (0.0, f32::INFINITY), "{partition:?}");
                assert_eq!(partition.share_at_infinity(), 0.0);
            }
            for partition in all(f32::INFINITY) {
                assert_eq!((partition.share(g, 1.0), partition.reach(1.0)), (1.0, 0.0), "{partition:?}");
                assert_eq!(partition.share_at_infinity(), 1.0);
            }
        }
    }

    #[test]
    fn coincident_points_are_scattered() {
        for t in [0.0, 0.3, f32::INFINITY] {
            for partition in all(t) {
                for g in [f32::INFINITY, f32::NAN] {
                    assert_eq!(partition.share(g, 0.0), 0.0, "{partition:?} {g}");
                }
            }
        }
        for t in [-1.0, f32::NAN] {
            assert!(Partition::hard(t).is_err() && Partition::soft(t).is_err());
            assert!(Partition::balance(t).is_err() && Partition::distance(t).is_err());
        }
    }

    /// Beyond the reach the connection takes all, before it the scattered ray has a part; connected terms are bounded.
    #[test]
    fn reach_and_bound() {
        for t in [0.05_f32, 1.0, 40.0] {
            for partition in all(t) {
                for cos in [0.01_f32, 0.5, 1.0] {
                    let reach = partition.reach(cos);
                    if reach.is_finite() {
                        let beyond = reach * 1.001;
                        assert_eq!(partition.share(cos / (beyond * beyond), beyond * beyond), 1.0, "{partition:?}");
                    }
                    // Nearer the scattered ray has a part (up to rounding, where the share comes close to one).
                    let within = reach.min(10.0) * 0.999;
                    assert!(partition.share(cos / (within * within), within * within) < 1.0, "{partition:?}");
                }
                for exponent in -20_i32..20 {
                    let g = 2f32.powi(exponent);
                    assert!(g * partition.share(g, 1.0 / g) <= t * 1.0001, "{partition:?}");
                }
            }
        }
    }

    #[test]
    fn normalised_thresholds_scale() {
        assert_eq!(Threshold::normalised(2.0).resolve(0.5), 8.0);
        assert_eq!(Threshold::Absolute(2.0).resolve(0.5), 2.0);
        for t in [0.0, f32::INFINITY] {
            assert_eq!(Threshold::normalised(t).resolve(f32::MAX), t);
        }
    }
}
