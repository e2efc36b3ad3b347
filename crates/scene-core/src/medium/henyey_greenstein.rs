//! The phase function of Henyey and Greenstein.

use core::f32::consts::{FRAC_1_PI, TAU};

use glam::Vec3A;

use super::MediumError;
use crate::frame::Frame;

/// The phase function of Henyey and Greenstein, of mean cosine `g`:
///
/// ```text
/// p(cos) = (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2))
/// ```
///
/// **Symbols.** `p`, in 1/sr, is the density by solid angle of the direction in which light goes on; `cos` that of
/// the angle between the directions of travel before and after, so that `cos = 1` is straight on. `g` is the mean of
/// `cos`: 0 is isotropic, positive scatters forwards, negative back.
///
/// It integrates to one over the sphere, so that samples need no weight, and is symmetric in the two directions, so
/// that both [modes of transport](crate::TransportMode) agree.
///
/// Source: Henyey and Greenstein 1941, "Diffuse radiation in the galaxy".
///
/// ```
/// use scene_core::glam::Vec3A;
/// use scene_core::medium::HenyeyGreenstein;
///
/// let phase = HenyeyGreenstein::new(0.5)?;
/// assert!(phase.eval(1.0) > phase.eval(-1.0));
/// let direction = phase.sample(Vec3A::X, [0.9, 0.2]);
/// assert!(direction.dot(Vec3A::X) > 0.9);
/// assert!(HenyeyGreenstein::new(1.0).is_err());
/// # Ok::<(), scene_core::medium::MediumError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HenyeyGreenstein {
    g: f32,
}

impl HenyeyGreenstein {
    /// The same in all directions.
    pub const ISOTROPIC: Self = Self { g: 0.0 };

    /// With the mean cosine `g`.
    ///
    /// # Errors
    /// [`MediumError::MeanCosine`] unless `g` lies in `(-1, 1)`.
    pub fn new(g: f32) -> Result<Self, MediumError> {
        if g.abs() < 1.0 { Ok(Self { g }) } else { Err(MediumError::MeanCosine(g)) }
    }

    /// The mean cosine.
    #[inline]
    pub fn mean_cosine(&self) -> f32 {
        self.g
    }

    /// The value for the cosine of the angle between the directions of travel, in 1/sr; it is the
    /// [density](Self::pdf), too.
    #[inline]
    pub fn eval(&self, cos: f32) -> f32 {
        // In f64: near straight on the base is the difference of numbers that are nearly equal.
        let (g, cos) = (f64::from(self.g), f64::from(cos.clamp(-1.0, 1.0)));
        let base = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cos);
        let value = (1.0 - g * g) / (base * base.sqrt());
        0.25 * FRAC_1_PI * value as f32
    }

    /// The density by solid angle with which [`sample`](Self::sample) goes on in `after`, in 1/sr.
    #[inline]
    pub fn pdf(&self, before: Vec3A, after: Vec3A) -> f32 {
        self.eval(before.dot(after))
    }

    /// The cosine whose distribution function has the value `u`: by inversion.
    #[inline]
    pub fn sample_cosine(&self, u: f32) -> f32 {
        // (1 + g^2 - s^2) / (2 g) with s = (1 - g^2) / (1 + g x), multiplied out: g = 0 needs no case of its own.
        let (g, x) = (f64::from(self.g), 2.0 * f64::from(u) - 1.0);
        let numerator = x + g * (0.5 * (x * x + 3.0) + g * (x + 0.5 * g * (x * x - 1.0)));
        let root = 1.0 + g * x;
        ((numerator / (root * root)) as f32).clamp(-1.0, 1.0)
    }

    /// A unit direction to go on in, for light that travelled along the unit vector `before`.
    #[inline]
    pub fn sample(&self, before: Vec3A, u: [f32; 2]) -> Vec3A {
        let cos = self.sample_cosine(u[0]);
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
        let (sin_phi, cos_phi) = (TAU * u[1]).sin_cos();
        // Round-off of the frame would otherwise accumulate along the walk.
        Frame::from_z(before).to_world(Vec3A::new(sin * cos_phi, sin * sin_phi, cos)).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const G: [f32; 9] = [0.0, 1e-6, -1e-3, 0.3, -0.3, 0.9, -0.9, 0.999, -0.999];

    /// `2 pi integral_{-1}^{cos} p`, in closed form.
    fn distribution(g: f64, cos: f64) -> f64 {
        if g.abs() < 1e-5 {
            return 0.5 * (1.0 + cos) - 0.75 * g * (1.0 - cos * cos);
        }
        (1.0 - g * g) / (2.0 * g) * (1.0 / (1.0 + g * g - 2.0 * g * cos).sqrt() - 1.0 / (1.0 + g))
    }

    #[test]
    fn cosines_invert_the_distribution_function() {
        for g in G {
            let phase = HenyeyGreenstein::new(g).unwrap();
            assert_eq!((phase.sample_cosine(0.0), phase.mean_cosine()), (-1.0, g));
            for i in 1..200 {
                let u = i as f32 / 200.0;
                let cos = phase.sample_cosine(u);
                // Where the density is high the rounding of the cosine shows in its distribution function.
                let rounding = f64::from(std::f32::consts::TAU * phase.eval(cos)) * 1.2e-7;
                let back = distribution(f64::from(g), f64::from(cos));
                assert!((back - f64::from(u)).abs() < 1e-6 + rounding, "{g} {u}: {cos} {back}");
            }
        }
    }

    #[test]
    fn the_value_is_the_derivative_of_the_distribution_function() {
        for g in G {
            let phase = HenyeyGreenstein::new(g).unwrap();
            for i in -9..10 {
                let cos = 0.1 * f64::from(i);
                let h = 1e-5;
                let slope = (distribution(g.into(), cos + h) - distribution(g.into(), cos - h)) / (2.0 * h);
                let value = std::f64::consts::TAU * f64::from(phase.eval(cos as f32));
                assert!((value - slope).abs() < 1e-4 * slope + 1e-6, "{g} {cos}: {value} {slope}");
            }
        }
    }

    #[test]
    fn directions_have_unit_length_and_the_sampled_angle() {
        for g in G {
            let phase = HenyeyGreenstein::new(g).unwrap();
            for before in [Vec3A::X, -Vec3A::Z, Vec3A::new(0.6, -0.8, 0.0), Vec3A::new(1.0, 2.0, -3.0).normalize()] {
                for u in [[0.0, 0.0], [0.3, 0.9], [0.999, 0.4], [1.0 - f32::EPSILON / 2.0, 0.5]] {
                    let after = phase.sample(before, u);
                    assert!((after.length() - 1.0).abs() < 1e-6);
                    assert!((after.dot(before) - phase.sample_cosine(u[0])).abs() < 1e-5, "{g} {before} {u:?}");
                    assert!(phase.pdf(before, after).is_finite() && phase.pdf(before, after) > 0.0);
                }
            }
        }
    }

    #[test]
    fn other_mean_cosines_are_refused() {
        for g in [1.0, -1.0, 1.5, f32::NAN, f32::INFINITY] {
            let message = HenyeyGreenstein::new(g).unwrap_err().to_string();
            assert!(message.contains(&format!("is {g},")), "{message}");
        }
    }
}
