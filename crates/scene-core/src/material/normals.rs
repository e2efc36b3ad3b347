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
        }
    }
}
