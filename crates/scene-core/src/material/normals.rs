//! Bump and normal maps.

use glam::Vec3A;

use crate::frame::Frame;
use crate::texture::Texture;

/// The geometry of a hit, as far as shading frames depend on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadingInput {
    /// Surface parameters.
    pub uv: [f32; 2],
    /// Derivative of the position by `u`; may be zero.
    pub dpdu: Vec3A,
    /// Derivative of the position by `v`; may be zero.
    pub dpdv: Vec3A,
    /// Unit interpolated normal.
    pub shading_normal: Vec3A,
    /// Unit geometric normal.
    pub geometric_normal: Vec3A,
}

/// One change of the shading normal.
#[derive(Clone, Debug)]
pub(super) enum NormalModifier {
    /// The surface is displaced by `scale * height` along its normal `n`, whose derivatives are neglected:
    /// `p_u' = p_u + n (h_u - n.p_u)`, likewise for `v`, and `n' = p_u' x p_v'`, on the side of the geometric normal.
    ///
    /// Source: Blinn 1978, "Simulation of Wrinkled Surfaces"; agrees with Mitsuba's `bumpmap` without its shadowing function.
    Bump { height: Texture, scale: f32 },
    /// `n' = 2 c - 1` in the shading frame with x along `p_u`, on the side of the shading normal.
    ///
    /// Source: Cohen, Olano, Manocha 1998; agrees with Mitsuba's `normalmap` without its shadowing function.
    Map { normals: Texture },
    /// `n' = 2 c - 1`, x and y scaled, in a frame with x along `p_u` and y on the side of `-p_v`: glTF's pictures have +y up, and `v` down.
    ///
    /// Source: Khronos 2021, "glTF 2.0 Specification", sections 3.7.2.1 and 3.9.3. Of a mesh's tangents only those that its texture
    /// coordinates define are known here.
    TangentMap { normals: Texture, scale: f32 },
}

impl NormalModifier {
    /// The new normal in place of `normal`; that one if the new one is not defined.
    pub(super) fn perturb(&self, normal: Vec3A, input: &ShadingInput) -> Vec3A {
        match self {
            Self::Bump { height, scale } => {
                let [by_u, by_v] = height.gradient(input.uv).map(|d| d * scale);
                let dpdu = input.dpdu + normal * (by_u - normal.dot(input.dpdu));
                let dpdv = input.dpdv + normal * (by_v - normal.dot(input.dpdv));
                let perturbed = dpdu.cross(dpdv).try_normalize().unwrap_or(normal);
                if perturbed.dot(input.geometric_normal) < 0.0 { -perturbed } else { perturbed }
            }
            Self::Map { normals } => {
                let local = (normals.eval(input.uv).0 * 2.0 - Vec3A::ONE).try_normalize();
                let local = local.filter(|n| n.z > 0.0).unwrap_or(Vec3A::Z);
                Frame::from_z_and_tangent(normal, input.dpdu).to_world(local).try_normalize().unwrap_or(normal)
            }
            Self::TangentMap { normals, scale } => {
                let mapped = normals.eval(input.uv).0 * 2.0 - Vec3A::ONE;
                let local = Vec3A::new(mapped.x * scale, mapped.y * scale, mapped.z).try_normalize();
                let local = local.filter(|n| n.z > 0.0).unwrap_or(Vec3A::Z);
                let mut frame = Frame::from_z_and_tangent(normal, input.dpdu);
                if frame.y.dot(input.dpdv) > 0.0 {
                    frame.y = -frame.y;
                }
                frame.to_world(local).try_normalize().unwrap_or(normal)
            }
        }
    }
}
