//! Fresnel reflection of unpolarised light.

use glam::Vec3A;

use crate::traits::Rgb;

/// Reflection and refraction at an interface of dielectrics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Refraction {
    /// Reflected share of the power.
    pub(super) reflectance: f32,
    /// Cosine of the refracted direction with the normal on its own side; zero under total internal reflection.
    pub(super) cos_transmitted: f32,
}

/// The Fresnel equations for two dielectrics.
///
/// `R = (r_s^2 + r_p^2) / 2`, `r_s = (cos_i - eta cos_t) / (cos_i + eta cos_t)`,
/// `r_p = (cos_t - eta cos_i) / (cos_t + eta cos_i)`, with `cos_t` from Snell's law.
///
/// - `cos`: cosine of the incident direction with the normal, in `[0, 1]`.
/// - `eta`: index of refraction of the other side over that of the incident side.
///
/// Source: Born and Wolf, "Principles of Optics", section 1.5.2.
#[inline]
pub(super) fn refraction(cos: f32, eta: f32) -> Refraction {
    let sin2_transmitted = (1.0 - cos * cos).max(0.0) / (eta * eta);
    if sin2_transmitted >= 1.0 {
        let matched = eta == 1.0;
        return Refraction { reflectance: if matched { 0.0 } else { 1.0 }, cos_transmitted: 0.0 };
    }
    let cos_transmitted = (1.0 - sin2_transmitted).sqrt();
    let s = (cos - eta * cos_transmitted) / (cos + eta * cos_transmitted);
    let p = (cos_transmitted - eta * cos) / (cos_transmitted + eta * cos);
    Refraction { reflectance: 0.5 * (s * s + p * p), cos_transmitted }
}

/// The Fresnel equations for a conductor in vacuum, in each channel, with what does not depend on the angle precomputed.
///
/// `R` for the complex index `eta + i k`.
/// Source: Möller 1988, "Optics", in the form that Lagarde 2013, "Memo on Fresnel equations", derives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ConductorFresnel {
    /// `eta^2 - k^2`.
    difference: Vec3A,
    /// `4 eta^2 k^2`.
    product: Vec3A,
    /// `eta = 0`: reflects everything.
    perfect: bool,
}

impl ConductorFresnel {
    pub(super) fn new(eta: Rgb, k: Rgb) -> Self {
        let (eta2, k2) = (eta.0 * eta.0, k.0 * k.0);
        Self { difference: eta2 - k2, product: 4.0 * eta2 * k2, perfect: eta == Rgb::ZERO }
    }

    #[inline]
    pub(super) fn reflectance(&self, cos: f32) -> Rgb {
        if self.perfect {
            return Rgb::ONE;
        }
        let cos = cos.clamp(0.0, 1.0);
        let cos2 = cos * cos;
        let sin2 = 1.0 - cos2;
        let tiny = Vec3A::splat(f32::MIN_POSITIVE);
        let t = self.difference - sin2;
        let a2b2 = (t * t + self.product).sqrt();
        let a = (0.5 * (a2b2 + t)).max(Vec3A::ZERO).sqrt();
        let (t1, t2) = (a2b2 + cos2, 2.0 * cos * a);
        let s = (t1 - t2) / (t1 + t2).max(tiny);
        let (t3, t4) = (a2b2 * cos2 + sin2 * sin2, t2 * sin2);
        let p = s * (t3 - t4) / (t3 + t4).max(tiny);
        Rgb(0.5 * (s + p))
    }
}

/// The Fresnel reflectance under diffuse illumination, `2 integral R(mu) mu dmu`, from the side for which `eta` is the
/// index of the other side over its own.
///
/// Two fits, accurate to 0.6 % for indices up to 2, the ones that Mitsuba 3 takes: below 1 that of Egan and Hilgeman
/// 1973, "Spectral reflectance of particulate materials", above that of d'Eon and Irving 2011, "A quantized-diffusion
/// model for rendering translucent materials".
pub(super) fn diffuse_reflectance(eta: f32) -> f32 {
    let inverse = 1.0 / eta;
    if eta < 1.0 {
        0.0636 * inverse + 0.6681 + eta * (0.7099 - 1.4399 * eta)
    } else {
        let coefficients = [-1.368_81, 4.985_54, -7.809_89, 6.753_35, -3.4793, 0.919_317];
        coefficients.iter().fold(0.0, |sum, c| sum * inverse + c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence_has_the_closed_form() {
        for eta in [0.5f32, 0.75, 1.0, 1.33, 1.5, 2.4] {
            let r = (eta - 1.0) / (eta + 1.0);
            assert!((refraction(1.0, eta).reflectance - r * r).abs() < 1e-6);
        }
        let fresnel = ConductorFresnel::new(Rgb::new(0.2, 1.0, 2.0), Rgb::new(3.9, 0.0, 1.0));
        for (i, (n, k)) in [(0.2f32, 3.9f32), (1.0, 0.0), (2.0, 1.0)].into_iter().enumerate() {
            let expected = ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k);
            assert!((fresnel.reflectance(1.0)[i] - expected).abs() < 1e-5);
        }
    }

    #[test]
    fn a_conductor_without_absorption_is_a_dielectric() {
        let fresnel = ConductorFresnel::new(Rgb::new(1.5, 1.33, 2.0), Rgb::ZERO);
        for i in 0..=20 {
            let cos = i as f32 / 20.0;
            for (channel, eta) in [1.5, 1.33, 2.0].into_iter().enumerate() {
                let difference = fresnel.reflectance(cos)[channel] - refraction(cos, eta).reflectance;
                assert!(difference.abs() < 1e-4, "{cos} {eta}");
            }
        }
    }

    #[test]
    fn total_internal_reflection_and_grazing_angles() {
        assert_eq!(refraction(0.1, 1.0 / 1.5), Refraction { reflectance: 1.0, cos_transmitted: 0.0 });
        assert_eq!(refraction(0.0, 1.5).reflectance, 1.0);
        assert_eq!(refraction(0.0, 1.0).reflectance, 0.0);
        assert!(ConductorFresnel::new(Rgb::ZERO, Rgb::ONE).reflectance(0.3) == Rgb::ONE);
        assert!(ConductorFresnel::new(Rgb::new(0.0, 1.0, 1.0), Rgb::ZERO).reflectance(1.0).0.is_finite());
    }

    #[test]
    fn diffuse_reflectance_is_close_to_the_integral() {
        for eta in [1.0 / 1.49, 1.0 / 1.33, 1.3, 1.49, 1.9] {
            let n = 20_000;
            let mean: f64 = (0..n)
                .map(|i| (f64::from(i) + 0.5) / f64::from(n))
                .map(|mu| 2.0 * mu * f64::from(refraction(mu as f32, eta).reflectance))
                .sum::<f64>()
                / f64::from(n);
            assert!((f64::from(diffuse_reflectance(eta)) / mean - 1.0).abs() < 0.01, "{eta} {mean}");
        }
    }
}
