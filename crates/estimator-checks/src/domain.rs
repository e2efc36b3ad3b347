//! The domains that samplers and densities live on, each with an area-preserving map from the unit square.

use std::f64::consts::TAU;
use std::fmt;

/// How far a point computed in `f32` may stray from its domain.
const SLACK: f64 = 1e-4;

/// A point as plain numbers.
pub trait Coordinates: Copy + fmt::Debug {
    /// Whether no coordinate is NaN or infinite.
    fn is_finite(&self) -> bool;
}

impl Coordinates for f64 {
    fn is_finite(&self) -> bool {
        f64::is_finite(*self)
    }
}

impl<const N: usize> Coordinates for [f64; N] {
    fn is_finite(&self) -> bool {
        self.iter().all(|x| x.is_finite())
    }
}

/// What a sampler may return for a point: the same array in `f32` or `f64`.
pub trait IntoPoint<P> {
    /// The point in `f64`.
    fn into_point(self) -> P;
}

impl<const N: usize> IntoPoint<[f64; N]> for [f64; N] {
    fn into_point(self) -> [f64; N] {
        self
    }
}

impl<const N: usize> IntoPoint<[f64; N]> for [f32; N] {
    fn into_point(self) -> [f64; N] {
        self.map(f64::from)
    }
}

impl IntoPoint<f64> for f64 {
    fn into_point(self) -> f64 {
        self
    }
}

impl IntoPoint<f64> for f32 {
    fn into_point(self) -> f64 {
        self.into()
    }
}

/// A domain with a measure, parametrised over the unit square.
///
/// Laws:
/// - `point` preserves area up to the constant `measure()`: `integral f dm = measure() * integral f(point(u, v)) du dv`,
///   so that the cells of a grid in `(u, v)` have equal measure,
/// - `parameters` inverts `point`, but for round-off and sets of measure zero, and returns values in `[0, 1]`,
/// - `parameters` is `None` for what is not a point of the domain; points that `f32` arithmetic has moved out of it by
///   1e-4 or less are moved back.
///
/// One-dimensional domains ignore `v`.
///
/// Not dyn compatible: the number of dimensions is a constant.
pub trait Domain {
    /// A point.
    type Point: Coordinates;
    /// 1 or 2.
    const DIMENSIONS: usize;
    /// The measure of the whole domain: length, area or solid angle.
    fn measure(&self) -> f64;
    /// The point at parameters in the unit square.
    fn point(&self, parameters: [f64; 2]) -> Self::Point;
    /// The parameters of a point, if it lies in the domain.
    fn parameters(&self, point: Self::Point) -> Option<[f64; 2]>;
}

fn turn(x: f64, y: f64) -> f64 {
    (y.atan2(x) / TAU).rem_euclid(1.0)
}

fn circle(radius: f64, turns: f64) -> [f64; 2] {
    let (sin, cos) = (turns * TAU).sin_cos();
    [radius * cos, radius * sin]
}

fn is_unit([x, y, z]: [f64; 3]) -> bool {
    (x * x + y * y + z * z - 1.0).abs() <= 2.0 * SLACK
}

/// The unit sphere; measure: solid angle, `4 pi`.
///
/// ```text
/// z = 1 - 2u,   phi = 2 pi v        (Archimedes)
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Sphere;

impl Domain for Sphere {
    type Point = [f64; 3];
    const DIMENSIONS: usize = 2;

    fn measure(&self) -> f64 {
        2.0 * TAU
    }

    fn point(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        // sin^2 = 1 - z^2 = 4 u (1 - u), without cancellation at the poles
        let [x, y] = circle(2.0 * (u * (1.0 - u)).max(0.0).sqrt(), v);
        [x, y, 1.0 - 2.0 * u]
    }

    fn parameters(&self, point: [f64; 3]) -> Option<[f64; 2]> {
        let [x, y, z] = point;
        is_unit(point).then(|| [(0.5 - 0.5 * z).clamp(0.0, 1.0), turn(x, y)])
    }
}

/// The unit hemisphere around `+z`; measure: solid angle, `2 pi`.
///
/// ```text
/// z = 1 - u,   phi = 2 pi v
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Hemisphere;

impl Domain for Hemisphere {
    type Point = [f64; 3];
    const DIMENSIONS: usize = 2;

    fn measure(&self) -> f64 {
        TAU
    }

    fn point(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let [x, y] = circle((u * (2.0 - u)).max(0.0).sqrt(), v);
        [x, y, 1.0 - u]
    }

    fn parameters(&self, point: [f64; 3]) -> Option<[f64; 2]> {
        let [x, y, z] = point;
        (is_unit(point) && z >= -SLACK).then(|| [(1.0 - z).clamp(0.0, 1.0), turn(x, y)])
    }
}

/// The unit disk; measure: area, `pi`.
///
/// ```text
/// r = sqrt(u),   phi = 2 pi v
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Domain for Disk {
    type Point = [f64; 2];
    const DIMENSIONS: usize = 2;

    fn measure(&self) -> f64 {
        0.5 * TAU
    }

    fn point(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        circle(u.sqrt(), v)
    }

    fn parameters(&self, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let squared = x * x + y * y;
        (squared <= 1.0 + 2.0 * SLACK).then(|| [squared.min(1.0), turn(x, y)])
    }
}

/// The unit square `[0, 1]^2`; measure: area, 1.
#[derive(Clone, Copy, Debug, Default)]
pub struct Square;

impl Domain for Square {
    type Point = [f64; 2];
    const DIMENSIONS: usize = 2;

    fn measure(&self) -> f64 {
        1.0
    }

    fn point(&self, parameters: [f64; 2]) -> [f64; 2] {
        parameters
    }

    fn parameters(&self, point: [f64; 2]) -> Option<[f64; 2]> {
        point.iter().all(|x| (-SLACK..=1.0 + SLACK).contains(x)).then(|| point.map(|x| x.clamp(0.0, 1.0)))
    }
}

/// Why an interval was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum DomainError {
    /// The ends are not finite, or not in order.
    InvalidInterval {
        /// The lower end.
        low: f64,
        /// The upper end.
        high: f64,
    },
}

impl fmt::Display for DomainError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InvalidInterval { low, high } => write!(f, "[{low}, {high}] is not an interval of positive length"),
        }
    }
}

impl std::error::Error for DomainError {}

/// An interval `[low, high]`; measure: length.
#[derive(Clone, Copy, Debug)]
pub struct Interval {
    low: f64,
    length: f64,
}

impl Interval {
    /// The unit interval.
    pub const UNIT: Self = Self { low: 0.0, length: 1.0 };

    /// The interval between two numbers.
    ///
    /// # Errors
    /// [`DomainError::InvalidInterval`] unless both are finite and `low < high`.
    pub fn new(low: f64, high: f64) -> Result<Self, DomainError> {
        let length = high - low;
        if length.is_finite() && length > 0.0 {
            Ok(Self { low, length })
        } else {
            Err(DomainError::InvalidInterval { low, high })
        }
    }
}

impl Domain for Interval {
    type Point = f64;
    const DIMENSIONS: usize = 1;

    fn measure(&self) -> f64 {
        self.length
    }

    fn point(&self, [u, _]: [f64; 2]) -> f64 {
        self.low + u * self.length
    }

    fn parameters(&self, point: f64) -> Option<[f64; 2]> {
        let u = (point - self.low) / self.length;
        (-SLACK..=1.0 + SLACK).contains(&u).then(|| [u.clamp(0.0, 1.0), 0.5])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn round_trip<D: Domain>(domain: &D, uv: [f64; 2]) -> [f64; 2] {
        domain.parameters(domain.point(uv)).unwrap()
    }

    proptest! {
        #[test]
        fn parameters_invert_points(u in 1e-6..1.0_f64, v in 0.0..0.999_f64) {
            for [s, t] in [round_trip(&Sphere, [u.min(0.999), v]), round_trip(&Hemisphere, [u, v]), round_trip(&Disk, [u, v]), round_trip(&Square, [u, v])] {
                prop_assert!((s - u.min(0.999)).abs() < 2e-3 && (t - v).abs() < 1e-9, "{s} {t}");
            }
            let interval = Interval::new(-3.0, 5.0).unwrap();
            prop_assert!((round_trip(&interval, [u, v])[0] - u).abs() < 1e-12);
        }
    }

    #[test]
    fn foreign_points_are_refused() {
        assert_eq!(Sphere.parameters([0.0, 0.0, 1.1]), None);
        assert_eq!(Hemisphere.parameters([0.0, 0.0, -1.0]), None);
        assert!(Hemisphere.parameters([1.0, 0.0, -1e-7]).is_some());
        assert_eq!(Disk.parameters([0.8, 0.8]), None);
        assert_eq!(Square.parameters([0.5, f64::NAN]), None);
        assert_eq!(Interval::UNIT.parameters(1.5), None);
        assert_eq!(Sphere.parameters([f64::NAN; 3]), None);
        assert!(Interval::new(1.0, 1.0).is_err() && Interval::new(0.0, f64::INFINITY).is_err());
        assert!(Interval::new(f64::NAN, 1.0).unwrap_err().to_string().contains("NaN"));
    }
}
