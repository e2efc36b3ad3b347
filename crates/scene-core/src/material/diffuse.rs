//! Ideal diffuse reflection.

use core::f32::consts::FRAC_1_PI;

use glam::Vec3A;

use super::BsdfSample;
use super::warp::cosine_hemisphere;
use crate::traits::Rgb;

/// `f |cos| = rho cos / pi` and its density `cos / pi`, on the front side.
///
/// Source: Lambert 1760. Agrees with Mitsuba's `diffuse`.
#[inline]
pub(super) fn eval_pdf(reflectance: Rgb, wo: Vec3A, wi: Vec3A) -> (Rgb, f32) {
    if wo.z <= 0.0 || wi.z <= 0.0 {
        return (Rgb::ZERO, 0.0);
    }
    let pdf = wi.z * FRAC_1_PI;
    (reflectance * pdf, pdf)
}

#[inline]
pub(super) fn sample(reflectance: Rgb, wo: Vec3A, u: [f32; 2]) -> Option<BsdfSample> {
    if wo.z <= 0.0 {
        return None;
    }
    let wi = cosine_hemisphere(u);
    Some(BsdfSample { wi, throughput: reflectance, pdf: wi.z * FRAC_1_PI, is_specular: false, eta: 1.0 })
}
