//! Microfacet distributions with Smith's masking function, and sampling of their visible normals.

use core::f32::consts::PI;

use glam::Vec3A;

use super::Distribution;
use super::erf::{FRAC_1_SQRT_PI, erf_and_gaussian, erf_inverse};
use super::warp::sin_cos_turn;

/// Smaller roughness is clamped to this, as in Mitsuba 3.
const MIN_ALPHA: f32 = 1e-4;

/// A distribution of microfacet normals over the surface.
///
/// With `t^2 = (m_x/a_x)^2 + (m_y/a_y)^2`, per area and solid angle:
/// - GGX: `D(m) = 1 / (pi a_x a_y (t^2 + m_z^2)^2)`,
/// - Beckmann: `D(m) = exp(-t^2/m_z^2) / (pi a_x a_y m_z^4)`.
///
/// `G1(v)` is Smith's masking function; visible normals have the density `D(m) G1(v) (v.m)+ / v_z`.
///
/// For Beckmann, the model's `G1` is the rational approximation of Walter et al. (relative error up to 0.35 %, which
/// Mitsuba 3 and others render with), while the density of the samples needs the exact one:
/// [`masking_over_cos`](Self::masking_over_cos) and [`sampling_over_cos`](Self::sampling_over_cos).
///
/// Sources: Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces"; Heitz 2014,
/// "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs" (anisotropic forms).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Microfacet {
    distribution: Distribution,
    alpha: [f32; 2],
    /// `1 / a^2`.
    inverse2: [f32; 2],
    /// `1 / (pi a_x a_y)`.
    norm: f32,
}

impl Microfacet {
    /// Whether the roughness differs along the tangents.
    pub(super) fn is_anisotropic(&self) -> bool {
        self.alpha[0] != self.alpha[1]
    }

    pub(super) fn new(distribution: Distribution, alpha: [f32; 2]) -> Self {
        let alpha = alpha.map(|a| a.max(MIN_ALPHA));
        let inverse2 = alpha.map(|a| 1.0 / (a * a));
        Self { distribution, alpha, inverse2, norm: 1.0 / (PI * alpha[0] * alpha[1]) }
    }

    /// The larger roughness, for [`Bsdf::roughness`](super::Bsdf::roughness).
    #[inline]
    pub(super) fn roughness(&self) -> f32 {
        self.alpha[0].max(self.alpha[1]).min(1.0)
    }

    #[inline]
    pub(super) fn is_beckmann(&self) -> bool {
        self.distribution == Distribution::Beckmann
    }

    /// `D` of the direction of `h`, which may have any length. Only for `h_z >= 0`.
    #[inline]
    pub(super) fn density(&self, h: Vec3A) -> f32 {
        let h2 = h * h;
        let slope2 = h2.x * self.inverse2[0] + h2.y * self.inverse2[1];
        let length2 = h2.x + h2.y + h2.z;
        match self.distribution {
            Distribution::Ggx => {
                let r = length2 / (slope2 + h2.z).max(f32::MIN_POSITIVE);
                self.norm * r * r
            }
            Distribution::Beckmann => {
                let inverse = 1.0 / h2.z.max(f32::MIN_POSITIVE);
                let (exponent, r) = (slope2 * inverse, length2 * inverse);
                if exponent < 80.0 { self.norm * r * r * (-exponent).exp() } else { 0.0 }
            }
        }
    }

    /// `(a_x v_x)^2 + (a_y v_y)^2`.
    #[inline]
    fn stretched2(&self, v: Vec3A) -> f32 {
        let (x, y) = (self.alpha[0] * v.x, self.alpha[1] * v.y);
        x * x + y * y
    }

    /// `G1(v) / v_z` of the model; finite at grazing angles. Only for `v_z >= 0`.
    #[inline]
    pub(super) fn masking_over_cos(&self, v: Vec3A) -> f32 {
        let s2 = self.stretched2(v);
        match self.distribution {
            Distribution::Ggx => 2.0 / (v.z + (v.z * v.z + s2).sqrt()),
            Distribution::Beckmann => {
                let s = s2.sqrt();
                if v.z >= 1.6 * s {
                    return 1.0 / v.z;
                }
                let a = v.z / s;
                (3.535 + 2.181 * a) / (s * (1.0 + a * (2.276 + a * 2.577)))
            }
        }
    }

    /// `G1(v) / v_z` such that the density of visible normals integrates to one. Only for `v_z >= 0`.
    #[inline]
    pub(super) fn sampling_over_cos(&self, v: Vec3A) -> f32 {
        match self.distribution {
            Distribution::Ggx => self.masking_over_cos(v),
            Distribution::Beckmann => {
                let s = self.stretched2(v).sqrt();
                // Beyond, the exact value differs from one by less than 1e-6.
                if v.z >= 3.0 * s {
                    return 1.0 / v.z;
                }
                let (erf, gaussian) = erf_and_gaussian(v.z / s);
                2.0 / (v.z * (1.0 + erf) + s * gaussian * FRAC_1_SQRT_PI)
            }
        }
    }

    /// A normal that is visible from `wo` (`wo_z > 0`), of density `D(m) G1(wo) (wo.m)+ / wo_z`.
    ///
    /// If `wo_y = 0`, replacing `u[1]` by `1 - u[1]` mirrors the normal at the plane `y = 0`.
    #[inline]
    pub(super) fn sample_visible(&self, wo: Vec3A, u: [f32; 2]) -> Vec3A {
        match self.distribution {
            Distribution::Ggx => self.sample_visible_ggx(wo, u),
            Distribution::Beckmann => self.sample_visible_beckmann(wo, u),
        }
    }

    /// Source: Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps", listing 3.
    #[inline]
    fn sample_visible_ggx(&self, wo: Vec3A, u: [f32; 2]) -> Vec3A {
        // Warp to the configuration of a hemisphere.
        let stretched = Vec3A::new(wo.x * self.alpha[0], wo.y * self.alpha[1], wo.z).normalize();
        // Sample a spherical cap.
        let z = (1.0 - u[0]) * (1.0 + stretched.z) - stretched.z;
        let r = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = sin_cos_turn(u[1]);
        // The half vector is the normal of the hemisphere; unwarp it.
        let h = Vec3A::new(r * cos, r * sin, z) + stretched;
        Vec3A::new(h.x * self.alpha[0], h.y * self.alpha[1], h.z.max(0.0)).try_normalize().unwrap_or(Vec3A::Z)
    }

    /// Sources: Heitz and d'Eon 2014, "Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible
    /// Normals"; Jakob 2014, "An Improved Visible Normal Sampling Routine for the Beckmann Distribution".
    fn sample_visible_beckmann(&self, wo: Vec3A, u: [f32; 2]) -> Vec3A {
        let stretched = Vec3A::new(wo.x * self.alpha[0], wo.y * self.alpha[1], wo.z).normalize();
        let azimuth = azimuth(stretched);
        let slope = [visible_slope(stretched.z.min(1.0), u[0]), erf_inverse(2.0 * u[1] - 1.0)];
        let x = (azimuth[0] * slope[0] - azimuth[1] * slope[1]) * self.alpha[0];
        let y = (azimuth[1] * slope[0] + azimuth[0] * slope[1]) * self.alpha[1];
        Vec3A::new(-x, -y, 1.0).normalize()
    }
}

/// Cosine and sine of the azimuth.
#[inline]
fn azimuth(v: Vec3A) -> [f32; 2] {
    let r2 = v.x * v.x + v.y * v.y;
    if r2 > 1e-30 {
        let inverse = 1.0 / r2.sqrt();
        [v.x * inverse, v.y * inverse]
    } else {
        [1.0, 0.0]
    }
}

/// A slope of density proportional to `(cos - x sin)+ exp(-x^2)`: inverts the distribution function
/// `F(x) = cos (1 + erf x) + sin exp(-x^2) / sqrt(pi)`, with `y = erf x` as the unknown, by Newton's method in a bracket.
fn visible_slope(cos: f32, u: f32) -> f32 {
    let u = u.clamp(1e-6, 1.0 - 1e-6);
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let (limit, gaussian) = if sin > 1e-6 * cos { erf_and_gaussian(cos / sin) } else { (1.0, 0.0) };
    let target = u * (cos * (1.0 + limit) + sin * gaussian * FRAC_1_SQRT_PI);
    let (mut low, mut high) = (-1.0f32, limit);
    // The solution at grazing angles, where the function is the least linear.
    let mut y = limit - (limit + 1.0) * erf_and_gaussian((-u.ln()).sqrt()).0;
    for _ in 0..8 {
        let slope = erf_inverse(y);
        let error = cos * (1.0 + y) + sin * FRAC_1_SQRT_PI * (-slope * slope).exp() - target;
        if error > 0.0 {
            high = y
        } else {
            low = y
        }
        let step = error / (cos - slope * sin).max(1e-6);
        let next = y - step;
        // Convergence is quadratic: after a step of this size in proportion to the tail, it is done.
        if step.abs() < 1e-3 * (1.0 - y.abs()) + 1e-7 {
            y = next.clamp(low, high);
            break;
        }
        y = if next > low && next < high { next } else { 0.5 * (low + high) };
    }
    erf_inverse(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DISTRIBUTIONS: [Distribution; 2] = [Distribution::Ggx, Distribution::Beckmann];

    fn direction(cos: f32, phi: f32) -> Vec3A {
        let sin = (1.0 - cos * cos).sqrt();
        Vec3A::new(sin * phi.cos(), sin * phi.sin(), cos)
    }

    /// Integrates over slopes: `d omega = m_z^3 dx dy`.
    fn integrate(f: impl Fn(Vec3A) -> f64, alpha: [f32; 2]) -> f64 {
        let n = 400;
        let mut sum = 0.0;
        for i in 0..n {
            for j in 0..n {
                // Polar slope coordinates, r = tan(t) / ..; t up to pi/2.
                let t = (i as f64 + 0.5) / n as f64 * std::f64::consts::FRAC_PI_2;
                let phi = (j as f64 + 0.5) / n as f64 * std::f64::consts::TAU;
                let r = t.tan();
                let (x, y) = (r * phi.cos() * f64::from(alpha[0]), r * phi.sin() * f64::from(alpha[1]));
                let m = glam::DVec3::new(-x, -y, 1.0).normalize();
                let jacobian = r * (1.0 + r * r) * f64::from(alpha[0] * alpha[1]) * m.z.powi(3);
                sum += f(m.as_vec3a()) * jacobian;
            }
        }
        sum * std::f64::consts::FRAC_PI_2 / n as f64 * std::f64::consts::TAU / n as f64
    }

    #[test]
    fn normals_and_visible_normals_are_normalised() {
        for distribution in DISTRIBUTIONS {
            for alpha in [[0.05, 0.05], [0.3, 0.1], [0.9, 0.9]] {
                let microfacet = Microfacet::new(distribution, alpha);
                let projected = integrate(|m| f64::from(microfacet.density(m) * m.z), alpha);
                assert!((projected - 1.0).abs() < 2e-3, "{distribution:?} {alpha:?}: {projected}");
                for cos in [1.0, 0.7, 0.2, 0.05] {
                    let wo = direction(cos, 0.6);
                    let g = microfacet.sampling_over_cos(wo);
                    let visible = integrate(|m| f64::from(microfacet.density(m) * g * wo.dot(m).max(0.0)), alpha);
                    assert!((visible - 1.0).abs() < 3e-3, "{distribution:?} {alpha:?} {cos}: {visible}");
                    let model = microfacet.masking_over_cos(wo);
                    assert!((model / g - 1.0).abs() < 5e-3, "{distribution:?} {alpha:?} {cos}: {model} {g}");
                }
            }
        }
    }

    /// The mean of test functions over stratified samples against their integral.
    #[test]
    fn samples_have_the_density_of_visible_normals() {
        for distribution in DISTRIBUTIONS {
            for (alpha, cos) in [([0.3, 0.1], 0.8), ([0.5, 0.5], 0.2), ([0.1, 0.4], 0.02), ([0.2, 0.2], 1.0)] {
                let microfacet = Microfacet::new(distribution, alpha);
                let wo = direction(cos, 0.6);
                let n = 500;
                for (name, f) in [
                    ("x", (|m: Vec3A| m.x) as fn(Vec3A) -> f32),
                    ("y2", |m| m.y * m.y),
                    ("z", |m| m.z),
                    ("quadrant", |m| if m.x > 0.1 && m.y < 0.05 { 1.0 } else { 0.0 }),
                ] {
                    let mut mean = 0.0;
                    for i in 0..n * n {
                        let u = [(i % n) as f32 + 0.5, (i / n) as f32 + 0.5].map(|x| x / n as f32);
                        let m = microfacet.sample_visible(wo, u);
                        assert!(wo.dot(m) > -1e-5 && (m.length() - 1.0).abs() < 1e-5);
                        mean += f64::from(f(m)) / f64::from(n * n);
                    }
                    let g = microfacet.sampling_over_cos(wo);
                    let expected = integrate(
                        |m| f64::from(f(m)) * f64::from(microfacet.density(m) * g * wo.dot(m).max(0.0)),
                        alpha,
                    );
                    assert!(
                        (mean - expected).abs() < 4e-3,
                        "{distribution:?} {alpha:?} {cos} {name}: {mean} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn grazing_angles_stay_finite() {
        for distribution in DISTRIBUTIONS {
            let microfacet = Microfacet::new(distribution, [0.0, 0.2]);
            for wo in [direction(1e-6, 0.3), direction(1e-20, 0.0), Vec3A::X, Vec3A::Z] {
                assert!(microfacet.masking_over_cos(wo).is_finite() && microfacet.sampling_over_cos(wo).is_finite());
                for u in [[0.0, 0.0], [0.999_999_94, 0.999_999_94], [0.5, 0.5]] {
                    let m = microfacet.sample_visible(wo, u);
                    assert!(m.is_finite() && microfacet.density(m).is_finite(), "{distribution:?} {wo} {u:?}");
                }
            }
            assert!(microfacet.density(Vec3A::X).is_finite() && microfacet.density(Vec3A::ZERO).is_finite());
        }
    }
}
