//! Square to spherical triangle.
use crate::Real;
use core::fmt;

/// A triangle on the unit sphere, sampled uniformly over solid angle: a triangle light seen from a point.
///
/// Density `1 / solid_angle`. Everything is computed in double precision whatever the interface.
/// Source: Arvo, "Stratified sampling of spherical triangles" (1995); the inverse as in pbrt-v4.
///
/// ```
/// use qmc_sampling::warp::SphericalTriangle;
/// # fn main() -> Result<(), qmc_sampling::warp::SphericalError> {
/// let octant = SphericalTriangle::new([[1.0_f32, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])?;
/// assert!((octant.solid_angle() - core::f64::consts::FRAC_PI_2).abs() < 1e-6);
/// let w = octant.sample([0.3_f32, 0.9]);
/// assert!(octant.pdf(w) > 0.0 && (octant.invert(w)[1] - 0.9_f32).abs() < 1e-5);
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalTriangle {
    vertices: [[f64; 3]; 3],
    /// The angle at the first vertex.
    alpha: f64,
    /// The cosine of the side opposite of the third vertex.
    cos_c: f64,
    solid_angle: f64,
}

/// Why a shape on the sphere was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SphericalError {
    /// A coordinate is infinite or NaN, or a vertex is the origin.
    InvalidVertex([f64; 3]),
    /// The solid angle is zero, or too small to be told from it.
    Degenerate,
}

impl fmt::Display for SphericalError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InvalidVertex(v) => write!(f, "vertex {v:?} gives no direction"),
            Self::Degenerate => write!(f, "the solid angle is zero"),
        }
    }
}

impl core::error::Error for SphericalError {}

impl SphericalTriangle {
    /// The triangle that three points make, seen from the origin.
    ///
    /// # Errors
    /// If a point is the origin or not finite, or the points are in a plane with the origin.
    pub fn new<F: Real>(vertices: [[F; 3]; 3]) -> Result<Self, SphericalError> {
        let mut unit = [[0.0; 3]; 3];
        for (to, from) in unit.iter_mut().zip(vertices) {
            let from = from.map(Real::to_f64);
            *to = normalize(from);
            if !to.iter().all(|x| Real::is_finite(*x)) {
                return Err(SphericalError::InvalidVertex(from));
            }
        }
        let [a, b, c] = unit;
        // Van Oosterom and Strackee: precise for small triangles too, where the excess of the angles cancels.
        let [ab, bc, ca] = [dot(a, b), dot(b, c), dot(c, a)];
        let volume = Real::abs(dot(a, cross(b, c)));
        let solid_angle = 2.0 * Real::atan2(volume, 1.0 + ab + bc + ca);
        if !(volume > 0.0 && solid_angle > 1e-14) {
            return Err(SphericalError::Degenerate);
        }
        let alpha = angle(reject(b, a), reject(c, a));
        Ok(Self { vertices: unit, alpha, cos_c: ab, solid_angle })
    }

    /// The solid angle, at most `2 pi`.
    #[must_use]
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// A direction uniform over the triangle.
    #[must_use]
    pub fn sample<F: Real>(&self, u: [F; 2]) -> [F; 3] {
        let [u, v] = u.map(|u| u.clamp_unit().to_f64());
        let [a, b, c] = self.vertices;
        // Cut the triangle from b to the opposite side, at c', such that the part has the area u.
        let (sin_alpha, cos_alpha) = Real::sin_cos(self.alpha);
        let (s, t) = Real::sin_cos(u * self.solid_angle - self.alpha);
        let (p, q) = (t - cos_alpha, s + sin_alpha * self.cos_c);
        let numerator = (q * t - p * s) * cos_alpha - q;
        let denominator = (q * s + p * t) * sin_alpha;
        let cos_b = if denominator == 0.0 { 1.0 } else { (numerator / denominator).clamp(-1.0, 1.0) };
        let along = normalize(reject(c, a));
        let sin_b = root(1.0 - cos_b * cos_b);
        let cut = [0, 1, 2].map(|k| cos_b * a[k] + sin_b * along[k]);
        // A point on the arc from b to c', uniform by area.
        let one_minus_z = v * (1.0 - dot(cut, b));
        let z = 1.0 - one_minus_z;
        let radius = root(one_minus_z * (1.0 + z));
        let toward = normalize(reject(cut, b));
        let w = [0, 1, 2].map(|k| z * b[k] + radius * if toward[k].is_nan() { 0.0 } else { toward[k] });
        w.map(F::of)
    }

    /// The density of [`sample`](Self::sample) with respect to solid angle; zero outside of the triangle.
    #[must_use]
    pub fn pdf<F: Real>(&self, direction: [F; 3]) -> F {
        let w = direction.map(Real::to_f64);
        let [a, b, c] = self.vertices;
        let side = if dot(a, cross(b, c)) > 0.0 { 1.0 } else { -1.0 };
        // Rounding must not lead outside: that of the direction, and in flat triangles that of the cut.
        let slack = -Real::max(4.0 * F::EPSILON.to_f64(), 1e-9);
        let inside = [(a, b), (b, c), (c, a)].into_iter().all(|(p, q)| side * dot(w, cross(p, q)) >= slack);
        if inside { F::of(1.0 / self.solid_angle) } else { F::ZERO }
    }

    /// The point of the square that [`sample`](Self::sample) maps to `direction`.
    #[must_use]
    pub fn invert<F: Real>(&self, direction: [F; 3]) -> [F; 2] {
        let w = normalize(direction.map(Real::to_f64));
        let [a, b, c] = self.vertices;
        // The arc from b through the direction meets the side from a to c in c'.
        let mut cut = normalize(cross(cross(b, w), cross(c, a)));
        if dot(cut, a) + dot(cut, c) < 0.0 {
            cut = cut.map(|x| -x);
        }
        if cut[0].is_nan() {
            return [F::ZERO; 2];
        }
        // The area of the part over the whole, and the place on the arc.
        let part = Real::abs(dot(a, cross(b, cut)));
        let area = 2.0 * Real::atan2(part, 1.0 + dot(a, b) + dot(b, cut) + dot(cut, a));
        let v = squared_distance(w, b) / squared_distance(cut, b);
        [area / self.solid_angle, v].map(|u| F::of(u).clamp_unit())
    }
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn normalize(a: [f64; 3]) -> [f64; 3] {
    let length = Real::sqrt(dot(a, a));
    a.map(|x| x / length)
}

/// The root, of zero if rounding made a number negative.
pub(super) fn root(x: f64) -> f64 {
    Real::sqrt(Real::max(x, 0.0))
}

/// The part of `v` perpendicular to the unit vector `axis`.
fn reject(v: [f64; 3], axis: [f64; 3]) -> [f64; 3] {
    cross(axis, cross(v, axis))
}

fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    let c = cross(a, b);
    Real::atan2(Real::sqrt(dot(c, c)), dot(a, b))
}

fn squared_distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let d = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    dot(d, d)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing::{assert_close, mean, square};
    use crate::warp::{pdf_uniform_sphere, sample_uniform_sphere};

    const TRIANGLES: [[[f64; 3]; 3]; 4] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[1.0, 0.0, 0.1], [0.0, 0.0, 1.0], [0.0, 1.0, 0.1]],
        [[3.0, 0.0, 1.0], [3.0, 0.02, 1.0], [3.0, 0.0, 1.01]],
        [[1.0, -0.5, -0.1], [-0.8, -0.6, 0.1], [0.1, 1.0, 0.0]],
    ];

    #[test]
    fn inverts() {
        for vertices in TRIANGLES {
            let triangle = SphericalTriangle::new(vertices).unwrap();
            for u in square::<f64>() {
                let w = triangle.sample(u);
                assert!(triangle.pdf(w) > 0.0, "{vertices:?} {u:?} {w:?}");
                assert_close(&[dot(w, w)], &[1.0], 1e-12);
                // At a vertex, only one of the numbers is defined.
                if u[1] > 1e-8 {
                    assert_close(&triangle.invert(w), &u, 1e-6);
                }
            }
            for u in square::<f32>() {
                let w = triangle.sample(u);
                assert!(triangle.pdf(w) > 0.0, "{vertices:?} {u:?} {w:?}");
            }
        }
    }

    #[test]
    fn density_integrates_to_one() {
        for vertices in [TRIANGLES[0], TRIANGLES[1], TRIANGLES[3]] {
            let triangle = SphericalTriangle::new(vertices).unwrap();
            let total = mean(400, |u| triangle.pdf(sample_uniform_sphere(u)) / pdf_uniform_sphere::<f64>());
            assert!((total - 1.0).abs() < 0.01, "{total}");
        }
    }

    /// The mean direction of an octant is known: each coordinate a half (its flux is pi / 4, over pi / 2).
    #[test]
    fn samples_are_uniform() {
        let triangle = SphericalTriangle::new(TRIANGLES[0]).unwrap();
        for k in 0..3 {
            let first = mean(256, |u| triangle.sample(u)[k]);
            let second = mean(256, |u| triangle.sample(u)[k].powi(2));
            assert!((first - 0.5).abs() < 1e-4 && (second - 1.0 / 3.0).abs() < 1e-4, "{first} {second}");
        }
    }

    #[test]
    fn refuses_what_is_no_triangle() {
        let refused = |v: [[f32; 3]; 3]| SphericalTriangle::new(v).unwrap_err();
        assert!(matches!(refused([[0.0; 3], [1.0; 3], [1.0, 0.0, 0.0]]), SphericalError::InvalidVertex(_)));
        assert!(matches!(refused([[f32::NAN; 3], [1.0; 3], [1.0, 0.0, 0.0]]), SphericalError::InvalidVertex(_)));
        assert_eq!(refused([[1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), SphericalError::Degenerate);
    }
}
