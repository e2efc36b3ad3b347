//! Square to the rectangle seen from a point.
use super::SphericalError;
use super::spherical_triangle::{cross, dot, normalize, root};
use crate::Real;
use core::f64::consts::PI;

/// A rectangle, sampled uniformly over the solid angle under which a point sees it: a rectangular light.
///
/// Density `1 / solid_angle`. Everything is computed in double precision whatever the interface.
/// Source: Ureña, Fajardo and King, "An area-preserving parametrization for spherical rectangles" (2013).
///
/// ```
/// use qmc_sampling::warp::SphericalRectangle;
/// # fn main() -> Result<(), qmc_sampling::warp::SphericalError> {
/// // A side of a cube seen from its centre: a sixth of the sphere.
/// let light = SphericalRectangle::new([0.0_f32; 3], [-1.0, -1.0, 1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0])?;
/// assert!((light.solid_angle() - 4.0 * core::f64::consts::PI / 6.0).abs() < 1e-5);
/// let w = light.sample([0.2_f32, 0.6]);
/// assert!(light.pdf(w) > 0.0 && (light.invert(w)[0] - 0.2).abs() < 1e-5);
/// # Ok(()) }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalRectangle {
    /// A frame with the sides as axes, the rectangle on its negative z side.
    frame: [[f64; 3]; 3],
    /// The rectangle in the frame: `x0`, `x1`, `y0`, `y1`, `z0 < 0`.
    x: [f64; 2],
    y: [f64; 2],
    z: f64,
    b0: f64,
    b1: f64,
    k: f64,
    solid_angle: f64,
}

impl SphericalRectangle {
    /// The rectangle with a corner and two edges, which are taken to be perpendicular, seen from `point`.
    ///
    /// # Errors
    /// If a number is not finite, an edge has no length, or the point lies in the plane of the rectangle.
    pub fn new<F: Real>(point: [F; 3], corner: [F; 3], edge_x: [F; 3], edge_y: [F; 3]) -> Result<Self, SphericalError> {
        let [point, corner, edge_x, edge_y] = [point, corner, edge_x, edge_y].map(|v| v.map(Real::to_f64));
        for v in [point, corner, edge_x, edge_y] {
            if !v.iter().all(|x| Real::is_finite(*x)) {
                return Err(SphericalError::InvalidVertex(v));
            }
        }
        let [width, height] = [edge_x, edge_y].map(|e| Real::sqrt(dot(e, e)));
        if !(width > 0.0 && height > 0.0) {
            return Err(SphericalError::Degenerate);
        }
        let (ex, ey) = (normalize(edge_x), normalize(edge_y));
        let mut ez = normalize(cross(ex, ey));
        let to_corner = [0, 1, 2].map(|k| corner[k] - point[k]);
        let mut z = dot(to_corner, ez);
        if z > 0.0 {
            ez = ez.map(|c| -c);
            z = -z;
        }
        let (x0, y0) = (dot(to_corner, ex), dot(to_corner, ey));
        let (x, y) = ([x0, x0 + width], [y0, y0 + height]);
        // The z components of the normals of the four sides, and the angles between neighbouring ones.
        let n = [y[0], x[1], y[1], x[0]];
        let nz = [-y[0], x[1], y[1], -x[0]].map(|d| d / Real::sqrt(z * z + d * d));
        let g = [0, 1, 2, 3].map(|i| Real::acos(-nz[i] * nz[(i + 1) % 4]));
        let k = 2.0 * PI - g[2] - g[3];
        let solid_angle = g[0] + g[1] - k;
        if !(z < 0.0 && solid_angle > 1e-12 && n.iter().all(|c| Real::is_finite(*c))) {
            return Err(SphericalError::Degenerate);
        }
        Ok(Self { frame: [ex, ey, ez], x, y, z, b0: nz[0], b1: nz[2], k, solid_angle })
    }

    /// The solid angle, at most `2 pi`.
    #[must_use]
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// The direction from the point to a place on the rectangle, uniform over solid angle.
    #[must_use]
    pub fn sample<F: Real>(&self, u: [F; 2]) -> [F; 3] {
        let [u, v] = u.map(|u| u.clamp_unit().to_f64());
        // Cut at x such that the part has the solid angle u (equations 15 to 18).
        let (sin, cos) = Real::sin_cos(u * self.solid_angle + self.k);
        let f = (cos * self.b0 - self.b1) / sin;
        let sign = if f > 0.0 { 1.0 } else { -1.0 };
        let c = (sign / Real::sqrt(f * f + self.b0 * self.b0)).clamp(-1.0, 1.0);
        let x = (-c * self.z / Real::max(root(1.0 - c * c), 1e-300)).clamp(self.x[0], self.x[1]);
        // Along the cut, the sine of the elevation is uniform (equations 19 to 21).
        let d = Real::sqrt(x * x + self.z * self.z);
        let [h0, h1] = self.y.map(|y| y / Real::sqrt(d * d + y * y));
        let h = h0 + v * (h1 - h0);
        let y = if h * h < 1.0 - 1e-12 { h * d / root(1.0 - h * h) } else { self.y[1] };
        let y = y.clamp(self.y[0], self.y[1]);
        let [ex, ey, ez] = self.frame;
        normalize([0, 1, 2].map(|k| x * ex[k] + y * ey[k] + self.z * ez[k])).map(F::of)
    }

    /// Where the direction meets the plane of the rectangle, in the frame.
    fn project(&self, w: [f64; 3]) -> Option<[f64; 2]> {
        let [ex, ey, ez] = self.frame;
        let t = self.z / dot(w, ez);
        (t > 0.0 && Real::is_finite(t)).then(|| [t * dot(w, ex), t * dot(w, ey)])
    }

    /// The density of [`sample`](Self::sample) with respect to solid angle; zero for directions that miss the rectangle.
    #[must_use]
    pub fn pdf<F: Real>(&self, direction: [F; 3]) -> F {
        let w = direction.map(Real::to_f64);
        let Some([x, y]) = self.project(w) else { return F::ZERO };
        // Rounding of the direction must not lead outside; it moves the point by more the flatter the view.
        let reach = (x * x + y * y + self.z * self.z) / -self.z;
        let slack = 4.0 * F::EPSILON.to_f64() * reach;
        let within = |c: f64, [low, high]: [f64; 2]| c >= low - slack && c <= high + slack;
        if within(x, self.x) && within(y, self.y) { F::of(1.0 / self.solid_angle) } else { F::ZERO }
    }

    /// The point of the square that [`sample`](Self::sample) maps to `direction`.
    #[must_use]
    pub fn invert<F: Real>(&self, direction: [F; 3]) -> [F; 2] {
        let Some([x, y]) = self.project(direction.map(Real::to_f64)) else { return [F::ZERO; 2] };
        let x = x.clamp(self.x[0], self.x[1]);
        let y = y.clamp(self.y[0], self.y[1]);
        // The solid angle of the part from x0 to x: as in the constructor, with one side moved.
        let nz = [-self.y[0], x, self.y[1], -self.x[0]].map(|d| d / Real::sqrt(self.z * self.z + d * d));
        let g = [0, 1, 2, 3].map(|i| Real::acos(-nz[i] * nz[(i + 1) % 4]));
        let u = (g[0] + g[1] + g[2] + g[3] - 2.0 * PI) / self.solid_angle;
        let d = Real::sqrt(x * x + self.z * self.z);
        let [h0, h, h1] = [self.y[0], y, self.y[1]].map(|y| y / Real::sqrt(d * d + y * y));
        [u, (h - h0) / (h1 - h0)].map(|u| F::of(u).clamp_unit())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::warp::testing::{assert_close, mean, square};
    use crate::warp::{pdf_uniform_sphere, sample_uniform_sphere};

    fn rectangles() -> [SphericalRectangle; 4] {
        let new = |p: [f64; 3], c, x, y| SphericalRectangle::new(p, c, x, y).unwrap();
        [
            new([0.0; 3], [-1.0, -1.0, 1.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]),
            new([0.3, 2.0, 0.1], [-1.0, -1.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.5, 0.0]),
            new([5.0, 3.0, 0.4], [1.0, 2.0, 0.0], [0.0, 0.0, 3.0], [1.0, 1.0, 0.0]),
            new([0.0; 3], [-0.01, 0.0, -1.0], [0.02, 0.0, 0.0], [0.0, 0.03, 0.0]),
        ]
    }

    #[test]
    fn inverts() {
        for rectangle in rectangles() {
            for u in square::<f64>() {
                let w = rectangle.sample(u);
                assert!(rectangle.pdf(w) > 0.0, "{rectangle:?} {u:?} {w:?}");
                assert_close(&rectangle.invert(w), &u, 1e-9);
            }
            for u in square::<f32>() {
                let w = rectangle.sample(u);
                assert!(rectangle.pdf(w) > 0.0, "{rectangle:?} {u:?} {w:?}");
                assert_close(&rectangle.invert(w), &u, 3e-4);
            }
        }
    }

    #[test]
    fn density_integrates_to_one() {
        for rectangle in &rectangles()[..3] {
            let total = mean(1000, |u| rectangle.pdf(sample_uniform_sphere(u)) / pdf_uniform_sphere::<f64>());
            assert!((total - 1.0).abs() < 0.02, "{total}");
        }
    }

    /// Over the side of a cube the mean of z is its flux over its solid angle, both known.
    #[test]
    fn samples_are_uniform() {
        let rectangle = rectangles()[0];
        let z = mean(256, |u| rectangle.sample(u)[2]);
        // form factor of a square of side 2 at distance 1, times pi
        let flux = 4.0 / 2.0_f64.sqrt() * (1.0 / 2.0_f64.sqrt()).atan();
        assert!((z - flux / rectangle.solid_angle()).abs() < 1e-4, "{z}");
    }

    #[test]
    fn refuses_what_is_no_rectangle() {
        let refused = |p: [f32; 3], c, x, y| SphericalRectangle::new(p, c, x, y).unwrap_err();
        let (x, y) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        assert_eq!(refused([0.0; 3], [3.0, 0.0, 0.0], x, y), SphericalError::Degenerate);
        assert_eq!(refused([0.0; 3], [0.0, 0.0, 1.0], [0.0; 3], y), SphericalError::Degenerate);
        assert!(matches!(refused([f32::NAN; 3], [0.0; 3], x, y), SphericalError::InvalidVertex(_)));
    }
}
