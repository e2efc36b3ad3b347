//! Directions in 32 bits.

/// Largest code of a coordinate; an even number of steps, so that the axes are exact.
const HALF: f32 = 32767.0;

/// A direction in 32 bits: the octahedral mapping, 16 bits per coordinate.
///
/// ```text
/// (x, y) / (|x| + |y| + |z|),   the lower half folded over the diagonals,   each rounded to k / 32767
/// ```
///
/// **Round-off.** The angle between a direction and what it unpacks to is at most 6.5e-5 rad (0.0037 degrees); axes
/// are exact. What is unpacked has unit length up to `f32` round-off.
///
/// **Source.** Z. Cigolle, S. Donow, D. Evangelakos, M. Mara, M. McGuire, Q. Meyer, "A Survey of Efficient
/// Representations for Independent Unit Vectors", JCGT 3(2), 2014: "oct32" with rounding to the nearest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct PackedDirection(u32);

impl PackedDirection {
    /// Packs a direction of any length; `None` for zero, infinite and NaN vectors.
    pub(crate) fn pack(direction: [f32; 3]) -> Option<Self> {
        // In f64, so that no length overflows or vanishes.
        let [x, y, z] = direction.map(f64::from);
        let length = x.abs() + y.abs() + z.abs();
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        let scale = 1.0 / length;
        let (mut u, mut v) = ((x * scale) as f32, (y * scale) as f32);
        if z < 0.0 {
            (u, v) = ((1.0 - v.abs()).copysign(u), (1.0 - u.abs()).copysign(v));
        }
        // Rounds to the nearest by truncating what is positive, without a call of `round`.
        let code = |t: f32| (t * HALF + 32768.5) as u32;
        Some(Self(code(u) | code(v) << 16))
    }

    /// The 32 bits.
    pub(crate) const fn code(self) -> u32 {
        self.0
    }

    /// The direction of 32 bits; `None` if [`pack`](Self::pack) never gives them.
    pub(crate) const fn from_code(code: u32) -> Option<Self> {
        if code & 0xffff == 0 || code >> 16 == 0 { None } else { Some(Self(code)) }
    }

    /// The direction, of unit length.
    #[inline]
    pub(crate) fn unpack(self) -> [f32; 3] {
        let [x, y, z] = self.unnormalised();
        let scale = 1.0 / (x * x + y * y + z * z).sqrt();
        [x * scale, y * scale, z * scale]
    }

    /// The direction, of a length between 0.57 and 1: on the octahedron.
    #[inline]
    pub(crate) fn unnormalised(self) -> [f32; 3] {
        let decode = |code: u32| (code as i32 - 32768) as f32 / HALF;
        let (mut x, mut y) = (decode(self.0 & 0xffff), decode(self.0 >> 16));
        let z = 1.0 - x.abs() - y.abs();
        let fold = (-z).max(0.0);
        x -= fold.copysign(x);
        y -= fold.copysign(y);
        [x, y, z]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angle(a: [f32; 3], b: [f32; 3]) -> f64 {
        let [a, b] = [a, b].map(|v| v.map(f64::from));
        let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let sine = (cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]).sqrt();
        sine.atan2(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
    }

    #[test]
    fn the_round_off_is_as_stated() {
        let mut worst = 0.0_f64;
        let mut uniforms = estimator_checks::Uniforms::named("directions");
        for _ in 0..1_000_000 {
            let direction = crate::sphere::direction(uniforms.array());
            let back = PackedDirection::pack(direction).unwrap().unpack();
            let length = back.iter().map(|c| c * c).sum::<f32>().sqrt();
            assert!((length - 1.0).abs() < 4.0 * f32::EPSILON);
            worst = worst.max(angle(direction, back));
        }
        assert!((5e-5..6.5e-5).contains(&worst), "{worst:e}");
    }

    #[test]
    fn axes_are_exact_and_lengths_do_not_matter() {
        for axis in [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]] {
            for length in [1e-30_f32, 1.0, 1e30] {
                let back = PackedDirection::pack(axis.map(|c| c * length)).unwrap().unpack();
                assert!(angle(back, axis) == 0.0, "{axis:?} {back:?}");
            }
        }
        for bad in [[0.0; 3], [f32::NAN, 0.0, 1.0], [f32::INFINITY, 0.0, 0.0]] {
            assert_eq!(PackedDirection::pack(bad), None);
        }
    }
}
