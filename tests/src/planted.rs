//! Bugs that renderers have had, put on purpose where the tests must find them.

use mis_heuristics::{Balance, Densities, Heuristic};
use qmc_sampling::{Sampler, SamplerFamily};
use scene_core::glam::Vec3A;
use scene_core::{
    ChosenEmitter, EmitterChoice, EmitterId, Ray, ScatterSample, Scene, Sharpness, SurfacePoint, TransportMode, Vertex,
};

/// A scene whose vertices scatter importance as if it were radiance: light paths know neither the correction for
/// shading normals nor that refraction leaves importance as it is.
#[derive(Clone, Debug)]
pub struct OneMode<S>(pub S);

/// A vertex of [`OneMode`].
#[derive(Clone, Debug)]
pub struct OneModeVertex<V>(V);

impl<S: Scene> Scene for OneMode<S> {
    type Spectrum = S::Spectrum;
    type Vertex<'s>
        = OneModeVertex<S::Vertex<'s>>
    where
        Self: 's;
    type Emitter = S::Emitter;
    type Sensor = S::Sensor;

    fn intersect(&self, ray: &Ray) -> Option<Self::Vertex<'_>> {
        self.0.intersect(ray).map(OneModeVertex)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.0.occluded(ray)
    }

    fn emitters(&self) -> &[Self::Emitter] {
        self.0.emitters()
    }

    fn environment(&self) -> Option<EmitterId> {
        self.0.environment()
    }

    fn sensor(&self) -> &Self::Sensor {
        self.0.sensor()
    }

    fn bounding_sphere(&self) -> (Vec3A, f32) {
        self.0.bounding_sphere()
    }
}

impl<V: Vertex> Vertex for OneModeVertex<V> {
    type Spectrum = V::Spectrum;

    fn point(&self) -> &SurfacePoint {
        self.0.point()
    }

    fn shading_normal(&self) -> Vec3A {
        self.0.shading_normal()
    }

    fn wo(&self) -> Vec3A {
        self.0.wo()
    }

    fn emitter(&self) -> Option<EmitterId> {
        self.0.emitter()
    }

    fn emitted(&self) -> V::Spectrum {
        self.0.emitted()
    }

    fn is_connectible(&self) -> bool {
        self.0.is_connectible()
    }

    fn eval(&self, wi: Vec3A, _: TransportMode) -> V::Spectrum {
        self.0.eval(wi, TransportMode::Radiance)
    }

    fn pdf_solid_angle(&self, wi: Vec3A, _: TransportMode) -> f32 {
        self.0.pdf_solid_angle(wi, TransportMode::Radiance)
    }

    fn sample(&self, u: [f32; 3], _: TransportMode) -> Option<ScatterSample<V::Spectrum>> {
        self.0.sample(u, TransportMode::Radiance)
    }

    fn albedo(&self) -> V::Spectrum {
        self.0.albedo()
    }

    fn reversed(&self, wi: Vec3A) -> Self {
        Self(self.0.reversed(wi))
    }
}

/// Gives both techniques weights that sum to this instead of one.
#[derive(Clone, Copy, Debug)]
pub struct Unnormalised(pub f32);

impl Heuristic<f32> for Unnormalised {
    fn weight(&self, technique: usize, densities: &(impl Densities<f32> + ?Sized)) -> f32 {
        self.0 * Balance.weight(technique, densities)
    }
}

/// Chooses by one choice and claims the probabilities of another.
#[derive(Clone, Copy, Debug)]
pub struct Liar<A, B> {
    /// Chooses.
    pub chooses: A,
    /// Whose probabilities are claimed.
    pub claims: B,
}

impl<A: EmitterChoice, B: EmitterChoice> EmitterChoice for Liar<A, B> {
    fn choose(&self, from: Option<&SurfacePoint>, u: f32) -> Option<ChosenEmitter> {
        let id = self.chooses.choose(from, u)?.id;
        Some(ChosenEmitter { id, probability: self.claims.probability(from, id) })
    }

    fn probability(&self, from: Option<&SurfacePoint>, id: EmitterId) -> f32 {
        self.claims.probability(from, id)
    }
}

/// Samplers for an image of this size that forget to remove the pixel from the first pair of numbers: it is the place in the image.
#[derive(Clone, Copy, Debug)]
pub struct PlaceInImage<F> {
    /// The samplers.
    pub family: F,
    /// Width and height.
    pub size: [u32; 2],
}

/// A sampler of [`PlaceInImage`].
#[derive(Clone, Debug)]
pub struct PlaceInImageSampler<S> {
    sampler: S,
    /// The pixel and the size, until the first pair was taken.
    pixel: Option<[[u32; 2]; 2]>,
}

impl<F: SamplerFamily> SamplerFamily for PlaceInImage<F> {
    type Sampler = PlaceInImageSampler<F::Sampler>;

    fn sampler(&self, stream: u64, index: u64) -> Self::Sampler {
        let width = u64::from(self.size[0]);
        let pixel = [(stream % width) as u32, (stream / width) as u32];
        PlaceInImageSampler { sampler: self.family.sampler(stream, index), pixel: Some([pixel, self.size]) }
    }
}

impl<S: Sampler> Sampler for PlaceInImageSampler<S> {
    fn next_1d(&mut self) -> f32 {
        self.sampler.next_1d()
    }

    fn next_2d(&mut self) -> [f32; 2] {
        let place = self.sampler.next_2d();
        self.pixel.take().map_or(place, |[pixel, size]| {
            std::array::from_fn(|k| ((pixel[k] as f32 + place[k]) / size[k] as f32).min(1.0 - 0.5 * f32::EPSILON))
        })
    }

    fn fork(&self, domain: u32) -> Self {
        Self { sampler: self.sampler.fork(domain), pixel: None }
    }
}

/// Samplers that hand out the same few numbers again and again: every bounce of a path is alike.
#[derive(Clone, Copy, Debug)]
pub struct FewDimensions<F>(pub F);

/// A sampler of [`FewDimensions`].
#[derive(Clone, Debug)]
pub struct FewDimensionsSampler<S> {
    first: S,
    sampler: S,
    taken: u32,
}

impl<F: SamplerFamily> SamplerFamily for FewDimensions<F> {
    type Sampler = FewDimensionsSampler<F::Sampler>;

    fn sampler(&self, stream: u64, index: u64) -> Self::Sampler {
        let first = self.0.sampler(stream, index);
        FewDimensionsSampler { sampler: first.clone(), first, taken: 0 }
    }
}

impl<S: Sampler> FewDimensionsSampler<S> {
    fn count(&mut self) {
        self.taken += 1;
        if self.taken.is_multiple_of(4) {
            self.sampler = self.first.clone();
        }
    }
}

impl<S: Sampler> Sampler for FewDimensionsSampler<S> {
    fn next_1d(&mut self) -> f32 {
        self.count();
        self.sampler.next_1d()
    }

    fn next_2d(&mut self) -> [f32; 2] {
        self.count();
        self.sampler.next_2d()
    }

    fn fork(&self, domain: u32) -> Self {
        let first = self.first.fork(domain);
        Self { sampler: first.clone(), first, taken: 0 }
    }
}

/// A scene that claims to be diffuse.
#[derive(Clone, Debug)]
pub struct AllDiffuse<S>(pub S);

impl<S: Scene> Scene for AllDiffuse<S> {
    type Spectrum = S::Spectrum;
    type Vertex<'s>
        = S::Vertex<'s>
    where
        Self: 's;
    type Emitter = S::Emitter;
    type Sensor = S::Sensor;

    fn intersect(&self, ray: &Ray) -> Option<Self::Vertex<'_>> {
        self.0.intersect(ray)
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.0.occluded(ray)
    }

    fn emitters(&self) -> &[Self::Emitter] {
        self.0.emitters()
    }

    fn environment(&self) -> Option<EmitterId> {
        self.0.environment()
    }

    fn sensor(&self) -> &Self::Sensor {
        self.0.sensor()
    }

    fn bounding_sphere(&self) -> (Vec3A, f32) {
        self.0.bounding_sphere()
    }

    fn sharpness(&self) -> Sharpness {
        Sharpness::Diffuse
    }
}
