//! Positions and normals as structure of arrays, and the loop over geometry terms.

use glam::Vec3A;

/// Lights that are handled at once.
pub(crate) const LANES: usize = 8;

/// Positions and normals of [`LANES`] lights. What is no light (padding, lights at infinity, specular vertices) has a normal of
/// zero, and so a geometry term of zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes {
    position: [[f32; LANES]; 3],
    normal: [[f32; LANES]; 3],
}

impl Lanes {
    /// Padding lies far away, but near enough that no square overflows.
    pub(crate) const EMPTY: Self = Self { position: [[1e18; LANES]; 3], normal: [[0.0; LANES]; 3] };

    #[inline]
    pub(crate) fn set(&mut self, lane: usize, position: Vec3A, normal: Vec3A) {
        for axis in 0..3 {
            self.position[axis][lane] = position[axis];
            self.normal[axis][lane] = normal[axis];
        }
    }

    /// Signed geometry terms `cos_x cos_y / d^2` of all lights with the point `x` of normal `nx`: each factor is positive in
    /// front of its surface. `FRONT` leaves zero of what is behind either.
    ///
    /// The loops over lanes have no branches and become vector instructions: 25 floating point operations and 24 bytes
    /// read per light. The plain form is [`geometry_term`].
    #[inline(always)]
    pub(crate) fn geometry_terms<const FRONT: bool>(&self, x: Vec3A, nx: Vec3A) -> [f32; LANES] {
        let (x, nx) = (x.to_array(), nx.to_array());
        let mut g = [0.0; LANES];
        for (lane, g) in g.iter_mut().enumerate() {
            let d: [f32; 3] = core::array::from_fn(|axis| self.position[axis][lane] - x[axis]);
            let inverse = 1.0 / (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            let mut cos_x = d[0] * nx[0] + d[1] * nx[1] + d[2] * nx[2];
            let mut cos_y = -(d[0] * self.normal[0][lane] + d[1] * self.normal[1][lane] + d[2] * self.normal[2][lane]);
            if FRONT {
                cos_x = cos_x.max(0.0);
                cos_y = cos_y.max(0.0);
            }
            // Two divisions by d^2 rather than one by d^4, which leaves the range of f32 for distances of 1e10 or 1e-12.
            *g = (cos_x * inverse) * (cos_y * inverse);
        }
        g
    }
}

/// The geometry term `|cos_x cos_y| / d^2`, in 1/length^2; infinite or NaN for coincident points.
#[inline]
pub fn geometry_term(x: Vec3A, nx: Vec3A, y: Vec3A, ny: Vec3A) -> f32 {
    let between = y - x;
    let inverse = 1.0 / between.length_squared();
    ((between.dot(nx) * inverse) * (between.dot(ny) * inverse)).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_equal_the_plain_form() {
        let at = |k: usize| {
            let t = k as f32;
            (Vec3A::new(t.sin() * 3.0, t.cos() * 2.0, 0.3 * t), Vec3A::new(0.2, t.sin(), t.cos()).normalize())
        };
        let mut lanes = Lanes::EMPTY;
        (0..LANES - 1).for_each(|lane| lanes.set(lane, at(lane).0, at(lane).1));
        let (x, nx) = (Vec3A::new(0.1, 0.2, -1.0), Vec3A::new(0.6, 0.0, 0.8));
        let (signed, front) = (lanes.geometry_terms::<false>(x, nx), lanes.geometry_terms::<true>(x, nx));
        for lane in 0..LANES - 1 {
            let (y, ny) = at(lane);
            let g = geometry_term(x, nx, y, ny);
            assert!((signed[lane].abs() - g).abs() <= 1e-6 * g, "{lane}");
            let is_front = (y - x).dot(nx) > 0.0 && (y - x).dot(ny) < 0.0;
            assert_eq!(front[lane], if is_front { signed[lane] } else { 0.0 });
        }
        assert_eq!((signed[LANES - 1], front[LANES - 1]), (0.0, 0.0));
    }

    #[test]
    fn far_and_near_and_coincident() {
        for distance in [1e-12, 1e12] {
            let g = geometry_term(Vec3A::ZERO, Vec3A::Z, Vec3A::Z * distance, -Vec3A::Z);
            assert!((g * distance * distance - 1.0).abs() < 1e-5, "{g}");
        }
        let g = geometry_term(Vec3A::ONE, Vec3A::Z, Vec3A::ONE, Vec3A::Z);
        assert!(!g.is_finite());
    }
}
