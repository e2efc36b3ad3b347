//! Choosing the direction in which a path goes on.

use core::f32::consts::FRAC_1_PI;

use glam::Vec3A;
use qmc_sampling::Sampler;
use qmc_sampling::warp::{
    pdf_cosine_hemisphere, pdf_power_cosine_hemisphere, pdf_uniform_hemisphere, sample_cosine_hemisphere,
    sample_power_cosine_hemisphere, sample_uniform_hemisphere, sample_uniform_sphere,
};
use ris::{Budget, Reservoir};
use scene_core::{Frame, ScatterSample, Spectrum, TransportMode, Vertex};

/// A way to choose directions.
///
/// # Laws
/// Those of [`Vertex::sample`], but for two numbers of directions that are not specular: the density may be zero, unknown, and `eta` one, which makes
/// Russian roulette less apt behind rough glass.
pub trait ScatterSampling: Sync {
    /// A direction for a path from the sensor that has `length` segments so far, or nothing if the path is absorbed.
    fn scatter<V: Vertex>(
        &self,
        vertex: &V,
        length: u32,
        sampler: &mut impl Sampler,
    ) -> Option<ScatterSample<V::Spectrum>>;
}

/// Each material's own sampling.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OwnSampling;

impl ScatterSampling for OwnSampling {
    #[inline]
    fn scatter<V: Vertex>(&self, vertex: &V, _: u32, sampler: &mut impl Sampler) -> Option<ScatterSample<V::Spectrum>> {
        let (lobe, [u, v]) = (sampler.next_1d(), sampler.next_2d());
        vertex.sample([lobe, u, v], TransportMode::Radiance)
    }
}

/// Where candidates for directions come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Directions {
    /// Uniform over the hemisphere of `wo`: Talbot, Cline and Egbert's figure 5. Misses what is transmitted.
    Hemisphere,
    /// Half of them cosine-distributed around the normal on the side of `wo`, a quarter each in a lobe around the mirror direction and uniform
    /// over the sphere: Talbot, Cline and Egbert's "better default density", for any material.
    #[default]
    General,
}

/// Exponent of the cosine lobe around the mirror direction.
const LOBE: f32 = 30.0;

impl Directions {
    fn propose(self, wo: Vec3A, u: [f32; 3]) -> (Vec3A, f32) {
        let wi = match self {
            Self::Hemisphere => Vec3A::from(sample_uniform_hemisphere([u[1], u[2]])) * side(wo),
            Self::General if u[0] < 0.5 => Vec3A::from(sample_cosine_hemisphere([u[1], u[2]])) * side(wo),
            Self::General if u[0] < 0.75 => {
                Frame::from_z(mirrored(wo)).to_world(sample_power_cosine_hemisphere([u[1], u[2]], LOBE).into())
            }
            Self::General => sample_uniform_sphere([u[1], u[2]]).into(),
        };
        (wi, self.pdf(wo, wi))
    }

    /// Density by solid angle.
    fn pdf(self, wo: Vec3A, wi: Vec3A) -> f32 {
        let upper = (wi * side(wo)).to_array();
        match self {
            Self::Hemisphere => pdf_uniform_hemisphere(upper),
            Self::General => {
                let lobe = Frame::from_z(mirrored(wo)).to_local(wi).to_array();
                0.5 * pdf_cosine_hemisphere(upper)
                    + 0.25 * pdf_power_cosine_hemisphere(lobe, LOBE)
                    + 0.25 * 0.25 * FRAC_1_PI
            }
        }
    }
}

/// One above the surface, minus one below.
fn side(wo: Vec3A) -> f32 {
    1.0_f32.copysign(wo.z)
}

/// The mirror direction of `wo`, in the frame of the normal.
fn mirrored(wo: Vec3A) -> Vec3A {
    Vec3A::new(-wo.x, -wo.y, wo.z)
}

/// Resampling for any scattering function that can be evaluated: candidates from a fixed distribution, selected in proportion to
/// `f cos`.
///
/// ```text
/// f cos W,    W = 1/g(Y) * 1/M sum_j g(X_j)/p(X_j),    g = luminance(f cos)                                (Talbot, Cline and Egbert 2005, section 5.2)
/// ```
///
/// **Symbols.** `X_j`: directions of density `p` by solid angle; `M`: their number, real, rounded at random.
///
/// **Unbiased** with any [`Directions`] that reach what the material scatters to. The density of the result is unknown (the sample
/// says zero), so light has to be found either by scattering alone or not by scattering at all.
///
/// Dirac components cannot be evaluated. Where there may be one the material's own sample is asked in one of two cases, and counts twice if it
/// is specular; otherwise the resampled direction counts twice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResampledScattering {
    /// `M`.
    pub candidates: f32,
    /// Where they come from.
    pub directions: Directions,
    /// Whether any material of the scene has Dirac components.
    pub has_specular: bool,
}

/// The sub-streams of the candidates' numbers, one per length.
const CANDIDATES_DOMAIN: u32 = 0x6273_6466;

impl ResampledScattering {
    /// A direction by resampling, with `f cos W`.
    fn resample<V: Vertex>(&self, vertex: &V, sampler: &mut impl Sampler) -> Option<ScatterSample<V::Spectrum>> {
        let frame = Frame::from_z(vertex.shading_normal());
        let wo = frame.to_local(vertex.wo());
        let count = Budget::round(self.candidates.into(), &mut || sampler.next_1d());
        let mut reservoir = Reservoir::new();
        for _ in 0..count {
            let (lobe, [u, v], select) = (sampler.next_1d(), sampler.next_2d(), sampler.next_1d());
            let (local, density) = self.directions.propose(wo, [lobe, u, v]);
            let wi = frame.to_world(local);
            let value = vertex.eval(wi, TransportMode::Radiance);
            reservoir.update((wi, value), value.luminance(), 1.0 / density, select);
        }
        let selected = reservoir.finish().selected?;
        let (wi, value) = selected.sample;
        let throughput = value * selected.contribution_weight;
        Some(ScatterSample { wi, throughput, pdf_solid_angle: 0.0, is_specular: false, eta: 1.0 })
    }
}

impl ScatterSampling for ResampledScattering {
    fn scatter<V: Vertex>(
        &self,
        vertex: &V,
        length: u32,
        sampler: &mut impl Sampler,
    ) -> Option<ScatterSample<V::Spectrum>> {
        // The same numbers as the material's own sampling takes.
        let (lobe, [u, v]) = (sampler.next_1d(), sampler.next_2d());
        if !vertex.is_connectible() {
            return vertex.sample([lobe, u, v], TransportMode::Radiance);
        }
        let mut numbers = sampler.fork(CANDIDATES_DOMAIN.wrapping_add(length));
        if !self.has_specular || vertex.lambertian().is_some() {
            return self.resample(vertex, &mut numbers);
        }
        let twice =
            |sample: ScatterSample<V::Spectrum>| ScatterSample { throughput: sample.throughput * 2.0, ..sample };
        if numbers.next_1d() < 0.5 {
            let own = vertex.sample([lobe, u, v], TransportMode::Radiance)?;
            own.is_specular.then(|| twice(own))
        } else {
            self.resample(vertex, &mut numbers).map(twice)
        }
    }
}
