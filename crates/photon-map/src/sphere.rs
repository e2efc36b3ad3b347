//! The unit square on the sphere, with equal areas.

use std::f64::consts::TAU;

/// The direction of a point of the unit square: `z = 1 - 2 v`, azimuth `2 pi u`.
///
/// Lambert's cylindrical projection: equal areas of the square are equal solid angles, `4 pi` in all. This is the
/// parametrisation of [`DirectionalHistogram`](crate::DirectionalHistogram), and one for the
/// [`ProjectionMap`](crate::ProjectionMap) of a light that emits into all directions alike.
///
/// # Example
/// ```
/// assert_eq!(photon_map::sphere_direction([0.25, 0.0]), [0.0, 0.0, 1.0]);
/// ```
#[must_use]
pub fn direction([u, v]: [f64; 2]) -> [f32; 3] {
    let z = 1.0 - 2.0 * v;
    let radius = (4.0 * v * (1.0 - v)).max(0.0).sqrt();
    let (sine, cosine) = (TAU * u).sin_cos();
    [(radius * cosine) as f32, (radius * sine) as f32, z as f32]
}

/// The point of the unit square `[0, 1)^2` of a direction of any length; the inverse of [`direction`].
///
/// `None` for zero, infinite and NaN vectors.
#[must_use]
pub fn square(direction: [f32; 3]) -> Option<[f64; 2]> {
    let [x, y, z] = direction.map(f64::from);
    let length = (x * x + y * y + z * z).sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return None;
    }
    let turn = y.atan2(x) / TAU;
    let u = if turn < 0.0 { turn + 1.0 } else { turn };
    Some([below_one(u), below_one(0.5 - 0.5 * z / length)])
}

/// The nearest number of `[0, 1)`; zero for NaN.
#[inline]
pub(crate) fn below_one(u: f64) -> f64 {
    if u > 0.0 { u.min(1.0 - f64::EPSILON / 2.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn square_inverts_direction() {
        for i in 0..50 {
            for j in 0..50 {
                let point = [(f64::from(i) + 0.5) / 50.0, (f64::from(j) + 0.5) / 50.0];
                let back = square(direction(point)).unwrap();
                // Near the poles one unit in the last place of z is a larger angle.
                assert!((back[0] - point[0]).abs() < 1e-6 && (back[1] - point[1]).abs() < 1e-6, "{point:?} {back:?}");
            }
        }
        assert_eq!(square([0.0; 3]), None);
        assert_eq!(square([f32::NAN; 3]), None);
        assert!(square([1.0, -1e-30, 0.0]).unwrap()[0] < 1.0);
    }
}
