//! Media of constant density: free flight.

use super::{HenyeyGreenstein, MediumError};
use crate::traits::Spectrum;

/// A homogeneous medium. Along a ray of direction `w` the radiance `L` changes by
///
/// ```text
/// dL/dx = -sigma_t L(x, w) + sigma_s integral over the sphere of p(w, w') L(x, w') dw',    sigma_t = sigma_a + sigma_s
/// ```
///
/// **Symbols.** `sigma_a`, `sigma_s`, `sigma_t`: coefficients of absorption, scattering and extinction per component,
/// in 1/length: the share of light that is lost per length. `1 / sigma_t` is the mean free path, `sigma_s / sigma_t`
/// the albedo. `p`: the [phase function](HenyeyGreenstein).
///
/// # Free flight
/// A component's free flight ends at distance `t` with density `sigma_t exp(-sigma_t t)`. Where the components
/// differ, one of them is chosen to sample the distance, with probability `q_i`, and all are weighed by the density
/// of the mixture (single-sample multiple importance sampling with the balance heuristic):
///
/// ```text
/// scatters at t:                sigma_s T(t) / sum_i q_i sigma_t,i T_i(t),      T(t) = exp(-sigma_t t)
/// reaches a surface at d < t:         T(d) / sum_i q_i T_i(d)
/// ```
///
/// With `q_i` in proportion to the throughput ([`channels`](Self::channels)) the sum of the throughput's components
/// stays what it was where a surface is reached, and is multiplied by a mean of the albedos where it scatters:
/// weights are bounded by the number of components.
///
/// Unbiased. Sources: Chandrasekhar 1960, "Radiative Transfer"; Veach and Guibas 1995; Chiang, Kutz and Burley 2016,
/// "Practical and Controllable Subsurface Scattering for Production Path Tracing", for probabilities in proportion to
/// throughput.
///
/// ```
/// use scene_core::{Rgb, Spectrum, medium::Medium};
///
/// let milk = Medium::new(Rgb::new(0.1, 0.2, 0.4), Rgb::new(40.0, 50.0, 60.0), 0.7)?;
/// let channels = milk.channels(Rgb::ONE);
/// let distance = milk.sample_distance(channels, [0.4, 0.5]);
/// // Green was chosen, and half of its flights are shorter.
/// assert!((distance - 0.5f32.ln() / -50.2).abs() < 1e-6);
/// let weight = milk.scattering_weight(channels, distance);
/// assert!((weight.mean() - 1.0).abs() < 0.01, "albedos are nearly one");
/// # Ok::<(), scene_core::medium::MediumError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium<S> {
    sigma_a: S,
    sigma_s: S,
    phase: HenyeyGreenstein,
}

impl<S: Spectrum> Medium<S> {
    /// With coefficients of absorption and of scattering, in 1/length, and the mean cosine `g` of Henyey and
    /// Greenstein's phase function.
    ///
    /// # Errors
    /// [`MediumError`] for coefficients that are negative or not finite, nor is their sum; and unless `g` lies in
    /// `(-1, 1)`.
    pub fn new(sigma_a: S, sigma_s: S, g: f32) -> Result<Self, MediumError> {
        for (name, coefficient) in [("sigma_a", sigma_a), ("sigma_s", sigma_s), ("sigma_t", sigma_a + sigma_s)] {
            for value in components(&coefficient) {
                if !(value >= 0.0 && value.is_finite()) {
                    return Err(MediumError::Coefficient { name, value });
                }
            }
        }
        Ok(Self { sigma_a, sigma_s, phase: HenyeyGreenstein::new(g)? })
    }

    /// With the coefficient of extinction, in 1/length, and the share of it that scatters.
    ///
    /// # Errors
    /// As for [`new`](Self::new); and for an albedo outside of `[0, 1]`.
    pub fn from_albedo(sigma_t: S, albedo: S, g: f32) -> Result<Self, MediumError> {
        if let Some(value) = components(&albedo).find(|value| !(0.0..=1.0).contains(value)) {
            return Err(MediumError::Albedo(value));
        }
        if let Some(value) = components(&sigma_t).find(|value| !(*value >= 0.0 && value.is_finite())) {
            return Err(MediumError::Coefficient { name: "sigma_t", value });
        }
        Self::new(sigma_t * (S::splat(1.0) - albedo), sigma_t * albedo, g)
    }

    /// Coefficient of absorption, in 1/length.
    #[inline]
    pub fn sigma_a(&self) -> S {
        self.sigma_a
    }

    /// Coefficient of scattering, in 1/length.
    #[inline]
    pub fn sigma_s(&self) -> S {
        self.sigma_s
    }

    /// Coefficient of extinction, in 1/length.
    #[inline]
    pub fn sigma_t(&self) -> S {
        self.sigma_a + self.sigma_s
    }

    /// How it scatters.
    #[inline]
    pub fn phase(&self) -> &HenyeyGreenstein {
        &self.phase
    }

    /// `exp(-sigma_t distance)`, Beer and Lambert's law: the share of light that gets as far without an event.
    #[inline]
    pub fn transmittance(&self, distance: f32) -> S {
        let sigma_t = self.sigma_t();
        S::from_components(|i| (-depth(sigma_t.component(i), distance)).exp())
    }

    /// Probabilities of the components to sample a distance by, in proportion to `throughput`; all the same if that
    /// is black.
    #[inline]
    pub fn channels(&self, throughput: S) -> S {
        let total = total(&throughput);
        if total > 0.0 { throughput * (1.0 / total) } else { S::splat(1.0 / S::COMPONENTS as f32) }
    }

    /// The distance of the next event, sampled by one component of `channels`, which the first number chooses.
    /// Infinite if that component's light is never absorbed nor scattered.
    #[inline]
    pub fn sample_distance(&self, channels: S, [mut choose, u]: [f32; 2]) -> f32 {
        let mut chosen = 0;
        for i in 0..S::COMPONENTS {
            let probability = channels.component(i);
            if probability > 0.0 {
                chosen = i;
                if choose < probability {
                    break;
                }
                choose -= probability;
            }
        }
        let sigma = self.sigma_t().component(chosen);
        if sigma > 0.0 { -(-u).ln_1p() / sigma } else { f32::INFINITY }
    }

    /// Density of [`sample_distance`](Self::sample_distance): `sum_i q_i sigma_t,i T_i(t)`, in 1/length.
    pub fn pdf_distance(&self, channels: S, distance: f32) -> f32 {
        total(&(channels * self.sigma_t() * self.transmittance(distance)))
    }

    /// The factor of the throughput for scattering at the sampled `distance`: `sigma_s T / sum_i q_i sigma_t,i T_i`.
    /// Zero where no component would have sampled it.
    #[inline]
    pub fn scattering_weight(&self, channels: S, distance: f32) -> S {
        let transmitted = self.relative_transmittance(distance);
        quotient(self.sigma_s * transmitted, total(&(channels * self.sigma_t() * transmitted)))
    }

    /// The factor of the throughput for a surface at `distance`, closer than the one that was sampled:
    /// `T / sum_i q_i T_i`.
    #[inline]
    pub fn passing_weight(&self, channels: S, distance: f32) -> S {
        let transmitted = self.relative_transmittance(distance);
        quotient(transmitted, total(&(channels * transmitted)))
    }

    /// Transmittance over that of the most transparent component: it does not underflow in all of them.
    #[inline]
    fn relative_transmittance(&self, distance: f32) -> S {
        let sigma_t = self.sigma_t();
        let least = (1..S::COMPONENTS).fold(sigma_t.component(0), |least, i| least.min(sigma_t.component(i)));
        S::from_components(|i| (-depth(sigma_t.component(i) - least, distance)).exp())
    }
}

/// All components.
#[inline]
pub(super) fn components<S: Spectrum>(spectrum: &S) -> impl Iterator<Item = f32> {
    (0..S::COMPONENTS).map(|i| spectrum.component(i))
}

/// The sum of all components.
#[inline]
pub(super) fn total<S: Spectrum>(spectrum: &S) -> f32 {
    components(spectrum).sum()
}

/// Optical depth; no coefficient makes none, however far.
#[inline]
fn depth(sigma: f32, distance: f32) -> f32 {
    if sigma > 0.0 { sigma * distance } else { 0.0 }
}

#[inline]
fn quotient<S: Spectrum>(value: S, density: f32) -> S {
    if density > 0.0 { value * (1.0 / density) } else { S::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::traits::Rgb;

    fn close(a: Rgb, b: Rgb) -> bool {
        (a.0 - b.0).abs().max_element() < 1e-5
    }

    #[test]
    fn weights_are_exact_for_one_component() {
        let medium = Medium::new(0.5, 1.5, 0.0).unwrap();
        let channels = medium.channels(0.3);
        assert_eq!(channels, 1.0);
        assert_eq!(medium.passing_weight(channels, 7.0), 1.0);
        assert!((medium.scattering_weight(channels, 7.0) - 0.75).abs() < 1e-6);
        assert!((medium.transmittance(0.7) - (-1.4f32).exp()).abs() < 1e-6);
        assert!((medium.pdf_distance(channels, 0.7) - 2.0 * (-1.4f32).exp()).abs() < 1e-6);
        assert!((medium.sample_distance(channels, [0.9, 0.5]) - 0.5 * core::f32::consts::LN_2).abs() < 1e-6);
    }

    #[test]
    fn the_sum_of_the_throughput_is_kept() {
        let medium = Medium::new(Rgb::new(0.1, 0.0, 3.0), Rgb::new(1.0, 20.0, 0.5), 0.3).unwrap();
        for throughput in [Rgb::ONE, Rgb::new(1.0, 0.0, 0.0), Rgb::new(1e-6, 3.0, 1e3)] {
            let channels = medium.channels(throughput);
            assert!((total(&channels) - 1.0).abs() < 1e-6);
            for distance in [0.0, 1e-3, 0.4, 5.0, 1e4] {
                let passed = throughput * medium.passing_weight(channels, distance);
                assert!((total(&passed) / total(&throughput) - 1.0).abs() < 1e-5 || passed.is_black());
                let scattered = throughput * medium.scattering_weight(channels, distance);
                assert!(total(&scattered) <= total(&throughput) * (1.0 + 1e-5), "{throughput:?} {distance}");
            }
        }
    }

    #[test]
    fn the_mixture_integrates_to_the_events() {
        let medium = Medium::new(Rgb::new(0.1, 0.0, 3.0), Rgb::new(1.0, 20.0, 0.5), 0.3).unwrap();
        let channels = Rgb::new(0.2, 0.5, 0.3);
        // Scattering up to distance d, plus passing d times its probability, by midpoints.
        let (n, far) = (20_000, 0.8);
        let mut scattered = Rgb::ZERO;
        for i in 0..n {
            let t = far * (i as f32 + 0.5) / n as f32;
            let weight = medium.scattering_weight(channels, t);
            scattered += weight * (medium.pdf_distance(channels, t) * far / n as f32);
        }
        let probability = total(&(channels * medium.transmittance(far)));
        assert!(close(medium.passing_weight(channels, far) * probability, medium.transmittance(far)));
        let expected = Rgb::from_components(|i| {
            let (s, t) = (medium.sigma_s()[i], medium.sigma_t()[i]);
            s / t * (1.0 - (-t * far).exp())
        });
        assert!((scattered.0 - expected.0).abs().max_element() < 1e-4, "{scattered:?} {expected:?}");
    }

    #[test]
    fn nothing_and_much_are_no_special_cases() {
        let vacuum = Medium::new(Rgb::ZERO, Rgb::ZERO, 0.0).unwrap();
        let channels = vacuum.channels(Rgb::ZERO);
        assert_eq!(vacuum.sample_distance(channels, [0.99, 0.99]), f32::INFINITY);
        for distance in [0.0, 3.0, f32::INFINITY] {
            assert_eq!(vacuum.transmittance(distance), Rgb::ONE);
            assert!(close(vacuum.passing_weight(channels, distance), Rgb::ONE));
        }
        assert_eq!(vacuum.scattering_weight(channels, 1.0), Rgb::ZERO);
        let dense = Medium::from_albedo(Rgb::splat(1e30), Rgb::splat(0.5), 0.0).unwrap();
        let channels = dense.channels(Rgb::ONE);
        let distance = dense.sample_distance(channels, [0.5, 0.5]);
        assert!(distance > 0.0 && close(dense.scattering_weight(channels, distance), Rgb::splat(0.5)));
        // The number that chooses may lie beyond the rounded sum of the probabilities.
        assert!(dense.sample_distance(Rgb::new(0.3, 0.3, 0.0), [0.999, 0.5]).is_finite());
    }

    #[test]
    fn bad_coefficients_are_named() {
        let message =
            |a: f32, s: f32, g: f32| Medium::new(Rgb::new(0.0, a, 0.0), Rgb::splat(s), g).unwrap_err().to_string();
        assert_eq!(message(-1.0, 1.0, 0.0), "sigma_a of a medium is -1, but must be finite and at least 0");
        assert!(message(f32::NAN, 1.0, 0.0).contains("sigma_a of a medium is NaN"));
        assert!(message(1.0, f32::INFINITY, 0.0).contains("sigma_s of a medium is inf"));
        assert!(message(f32::MAX, f32::MAX, 0.0).contains("sigma_t of a medium is inf"));
        assert!(message(1.0, 1.0, -1.0).contains("g of a phase function is -1"));
        assert_eq!(Medium::from_albedo(1.0, 1.5, 0.0), Err(MediumError::Albedo(1.5)));
        assert!(matches!(Medium::from_albedo(1.0, f32::NAN, 0.0), Err(MediumError::Albedo(_))));
        assert_eq!(
            Medium::from_albedo(f32::INFINITY, 1.0, 0.0),
            Err(MediumError::Coefficient { name: "sigma_t", value: f32::INFINITY })
        );
        let half = Medium::from_albedo(4.0, 0.25, 0.0).unwrap();
        assert_eq!((half.sigma_a(), half.sigma_s()), (3.0, 1.0));
    }
}
