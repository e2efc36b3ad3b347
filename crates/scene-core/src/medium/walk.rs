//! A ray's way through a medium.

use glam::Vec3A;
use qmc_sampling::Sampler;

use super::Medium;
use super::homogeneous::total;
use crate::ray::Ray;
use crate::traits::{Scene, Spectrum, Vertex};

/// Where a walk through a medium ended.
#[derive(Clone, Copy, Debug)]
pub struct MediumExit<V, S> {
    /// The surface that it reached, seen from inside; nothing if there was none (see [`Medium::walk`]).
    pub vertex: Option<V>,
    /// The last segment.
    pub ray: Ray,
    /// The throughput of the path with all that happened in the medium.
    pub throughput: S,
    /// How often it scattered.
    pub scatterings: u32,
}

/// A walk whose throughput has fallen below this share of what it entered with plays Russian roulette.
const LITTLE: f32 = 0.25;
/// The probability with which it survives, at each scattering.
const SURVIVES: f32 = 0.5;
/// After so many scatterings each further one ends the walk with the probability of one over this number.
const MANY: u32 = 4096;

impl<S: Spectrum> Medium<S> {
    /// Follows `ray`, which runs through this medium, to the next surface: free flight and scattering in turn.
    ///
    /// ```text
    /// beta <- beta * (weight of free flight) / q      at each event; directions by the phase function, of weight one
    /// ```
    ///
    /// **Symbols.** `beta`: `throughput`, that of the path; the components sample distances in proportion to it. `q`:
    /// the probability of surviving Russian roulette, which is played where the sum of `beta` has fallen below a
    /// quarter of what it was (`q = 1/2`), and from scattering number 4096 on (`q = 1 - 1/4096`), which bounds the
    /// expected time in the densest medium. Nothing if the walk did not survive.
    ///
    /// **Assumes** that the medium's surface is closed. Where it is not, the medium ends at the scene's bounding
    /// sphere, and the walk without a vertex. Light sources inside are found only by running into them; the caller
    /// must not look for them. A point that scatters within the round-off of the surface may come to lie outside of
    /// it, with a probability of the order of 1e-7 sigma_t per unit of length; it finds the surface from there, or
    /// the bounding sphere.
    ///
    /// **Unbiased.** A medium that only absorbs takes no numbers, and has no variance.
    ///
    /// Cost: one closest-hit ray of bounded length per event.
    ///
    /// ```
    /// use qmc_sampling::{Independent, SamplerFamily};
    /// use scene_core::glam::Vec3A;
    /// use scene_core::material::Material;
    /// use scene_core::{Ray, ReferenceScene, Rgb, builtin::furnace, medium::Medium};
    ///
    /// // A ball of radius 1 of tinted glass, and a ray from its centre.
    /// let tint = Medium::new(Rgb::new(0.1, 0.2, 0.9), Rgb::ZERO, 0.0)?;
    /// let glass = Material::glass(1.5);
    /// let scene = ReferenceScene::new(furnace(glass.filled_with(tint)))?;
    /// let mut sampler = Independent::new(1).sampler(0, 0);
    /// let exit = tint.walk(&scene, Ray::new(Vec3A::ZERO, Vec3A::X), Rgb::ONE, &mut sampler).expect("nothing ends it");
    /// assert!(exit.vertex.is_some());
    /// assert!((exit.throughput[2] - (-0.9f32).exp()).abs() < 1e-5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn walk<'s, C: Scene<Spectrum = S>>(
        &self,
        scene: &'s C,
        mut ray: Ray,
        mut throughput: S,
        sampler: &mut impl Sampler,
    ) -> Option<MediumExit<C::Vertex<'s>, S>> {
        if self.sigma_s().is_black() {
            return Some(self.straight(scene, ray, throughput));
        }
        let little = LITTLE * total(&throughput);
        for scatterings in 0..u32::MAX {
            // Fly.
            let channels = self.channels(throughput);
            let distance = self.sample_distance(channels, [sampler.next_1d(), sampler.next_1d()]);
            let vertex = scene.intersect(&ray.up_to(distance));
            if let Some(passed) = passed(scene, &ray, distance, vertex.as_ref()) {
                throughput *= self.passing_weight(channels, passed);
                return Some(MediumExit { vertex, ray, throughput, scatterings });
            }
            // Survive.
            throughput *= self.scattering_weight(channels, distance);
            let survival = survival_probability(total(&throughput), little, scatterings);
            if survival < 1.0 {
                if sampler.next_1d() >= survival {
                    return None;
                }
                throughput *= S::splat(1.0 / survival);
            }
            // Scatter.
            ray = Ray::new(ray.at(distance), self.phase().sample(ray.direction, sampler.next_2d()));
        }
        None
    }

    /// Through a medium that only absorbs.
    fn straight<'s, C: Scene<Spectrum = S>>(
        &self,
        scene: &'s C,
        ray: Ray,
        throughput: S,
    ) -> MediumExit<C::Vertex<'s>, S> {
        let vertex = scene.intersect(&ray.up_to(f32::INFINITY));
        let passed = passed(scene, &ray, f32::INFINITY, vertex.as_ref()).unwrap_or(0.0);
        MediumExit { vertex, ray, throughput: throughput * self.transmittance(passed), scatterings: 0 }
    }
}

/// The way to the surface that was hit, or to the end of the medium at the scene's bounding sphere if that is closer
/// than the event at `distance`; nothing if the event happens.
#[inline]
fn passed<C: Scene>(scene: &C, ray: &Ray, distance: f32, hit: Option<&C::Vertex<'_>>) -> Option<f32> {
    if let Some(vertex) = hit {
        return Some((vertex.point().position - ray.origin).length());
    }
    let (center, radius) = scene.bounding_sphere();
    if (ray.at(distance) - center).length_squared() <= radius * radius {
        return None;
    }
    Some(way_out(ray, center, radius).min(distance))
}

/// The distance to where `ray` leaves a sphere for good; 0 if it starts outside and misses it.
fn way_out(ray: &Ray, center: Vec3A, radius: f32) -> f32 {
    let from = ray.origin - center;
    let along = -from.dot(ray.direction);
    let out = along + (along * along - from.length_squared() + radius * radius).sqrt();
    // NaN is less than nothing.
    if out > 0.0 { out } else { 0.0 }
}

/// The probability of going on after a scattering.
#[inline]
fn survival_probability(total: f32, little: f32, scatterings: u32) -> f32 {
    if !(total > 0.0 && total.is_finite()) {
        return 0.0;
    }
    let by_throughput = if total < little { SURVIVES } else { 1.0 };
    let by_number = if scatterings >= MANY { 1.0 - 1.0 / MANY as f32 } else { 1.0 };
    by_throughput * by_number
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spheres_are_left_once() {
        let out = |origin, direction| way_out(&Ray::new(origin, direction), Vec3A::X, 2.0);
        assert_eq!(out(Vec3A::X, Vec3A::Y), 2.0);
        assert_eq!(out(Vec3A::new(-3.0, 0.0, 0.0), Vec3A::X), 6.0);
        assert_eq!(out(Vec3A::new(-3.0, 0.0, 0.0), -Vec3A::X), 0.0);
        assert_eq!(out(Vec3A::new(0.0, 5.0, 0.0), Vec3A::X), 0.0);
    }

    #[test]
    fn roulette_is_for_the_weak_and_the_long() {
        assert_eq!(survival_probability(1.0, 0.25, 0), 1.0);
        assert_eq!(survival_probability(0.2, 0.25, 0), 0.5);
        assert_eq!(survival_probability(1.0, 0.25, 5000), 1.0 - 1.0 / 4096.0);
        for total in [0.0, f32::NAN, f32::INFINITY, -1.0] {
            assert_eq!(survival_probability(total, 0.25, 0), 0.0);
        }
    }
}
