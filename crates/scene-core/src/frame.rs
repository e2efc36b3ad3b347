//! Orthonormal frames.

use glam::Vec3A;

/// A right-handed orthonormal frame whose z axis is a normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// First tangent.
    pub x: Vec3A,
    /// Second tangent.
    pub y: Vec3A,
    /// The normal.
    pub z: Vec3A,
}

impl Frame {
    /// A frame around the unit vector `z`, without branches at its singularity.
    ///
    /// Source: Duff et al. 2017, "Building an Orthonormal Basis, Revisited", JCGT 6(1).
    #[inline]
    pub fn from_z(z: Vec3A) -> Self {
        let sign = 1.0f32.copysign(z.z);
        let a = -1.0 / (sign + z.z);
        let b = z.x * z.y * a;
        Self {
            x: Vec3A::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x),
            y: Vec3A::new(b, sign + z.y * z.y * a, -z.y),
            z,
        }
    }

    /// A frame around `z` whose x axis is the part of `tangent` orthogonal to it, or any if there is none.
    #[inline]
    pub fn from_z_and_tangent(z: Vec3A, tangent: Vec3A) -> Self {
        match (tangent - z * z.dot(tangent)).try_normalize() {
            Some(x) => Self { x, y: z.cross(x), z },
            None => Self::from_z(z),
        }
    }

    /// World to local coordinates.
    #[inline]
    pub fn to_local(&self, v: Vec3A) -> Vec3A {
        Vec3A::new(v.dot(self.x), v.dot(self.y), v.dot(self.z))
    }

    /// Local to world coordinates.
    #[inline]
    pub fn to_world(&self, v: Vec3A) -> Vec3A {
        self.x * v.x + self.y * v.y + self.z * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        for i in 0..1000 {
            let (a, b) = (i as f32 * 0.37, i as f32 * 1.91);
            let z = Vec3A::new(a.sin() * b.cos(), a.sin() * b.sin(), a.cos()).normalize();
            for frame in [Frame::from_z(z), Frame::from_z_and_tangent(z, Vec3A::new(b, a, 1.0))] {
                assert!(frame.x.dot(frame.y).abs() < 1e-5 && frame.x.dot(frame.z).abs() < 1e-5);
                assert!((frame.x.cross(frame.y) - frame.z).length() < 1e-5);
                let v = Vec3A::new(0.3, -0.2, 0.7);
                assert!((frame.to_world(frame.to_local(v)) - v).length() < 1e-5);
            }
        }
        assert!((Frame::from_z(-Vec3A::Z).x.length() - 1.0).abs() < 1e-6);
        assert_eq!(Frame::from_z_and_tangent(Vec3A::Z, Vec3A::Z), Frame::from_z(Vec3A::Z));
    }
}
