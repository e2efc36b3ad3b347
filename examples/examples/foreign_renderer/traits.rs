//! What it takes to use `vpl-gi`: `scene-core`'s traits, implemented for the renderer's own types.

use std::f64::consts::PI;
use std::ops::Mul;

use qmc_sampling::{Independent, SamplerFamily};
use scene_core::glam::Vec3A;
use scene_core::{
    ChosenEmitter, DirectSample, EmissionSample, Emitter, EmitterChoice, EmitterId, Ray, RussianRoulette,
    ScatterSample, SensorConnection, SensorRay, Spectrum, SurfacePoint, TransportMode,
};
use vpl_gi::{LightTracing, Partition, PartitionError, RobustIgi, VirtualPointLights};

use crate::renderer::{Bsdf, Camera, HEIGHT, Hit, Object, Scene, WIDTH};
use crate::vector::V;

/// Robust instant global illumination with eight light paths per sample.
// glue: vpl-gi
pub fn virtual_lights(scene: &Scene, (o, d): (V, V), seed: u64, index: u64) -> Result<V, PartitionError> {
    let roulette = RussianRoulette::LocalAlbedo { from_length: 0 };
    let tracing = LightTracing { choice: OneLamp, max_length: u32::MAX, roulette };
    let numbers = |stream: u32| Independent::new(seed).sampler(u64::from(stream), index);
    let lights = VirtualPointLights::trace(scene, &tracing, 8, |path| numbers(1 + path));
    let robust = RobustIgi::new(Partition::soft(10.0)?);
    Ok(robust.radiance(scene, &lights, Ray::new(o.into(), d.into()), &mut numbers(0)))
}

pub struct OneLamp;
impl EmitterChoice for OneLamp {
    fn choose(&self, _: Option<&SurfacePoint>, _: f32) -> Option<ChosenEmitter> {
        Some(ChosenEmitter { id: EmitterId(0), probability: 1.0 })
    }
    fn probability(&self, _: Option<&SurfacePoint>, _: EmitterId) -> f32 {
        1.0
    }
}

impl From<V> for Vec3A {
    fn from(v: V) -> Self {
        <[f32; 3]>::from(v).into()
    }
}
impl From<Vec3A> for V {
    fn from(v: Vec3A) -> Self {
        v.to_array().into()
    }
}
impl Mul<f32> for V {
    type Output = Self;
    fn mul(self, s: f32) -> Self {
        self * f64::from(s)
    }
}
impl Spectrum for V {
    const ZERO: Self = Self(0.0, 0.0, 0.0);
    fn splat(value: f32) -> Self {
        Self::splat(value.into())
    }
    fn luminance(&self) -> f32 {
        self.mean() as f32
    }
    fn max_component(&self) -> f32 {
        self.largest() as f32
    }
    fn is_finite(&self) -> bool {
        photon_map::Flux::is_finite(*self)
    }
    fn to_rgb(&self) -> [f32; 3] {
        (*self).into()
    }
    fn from_rgb(rgb: [f32; 3]) -> Self {
        rgb.into()
    }
}

/// A hit with its point in the form that the trait hands out by reference.
#[derive(Clone)]
pub struct Vertex<'s>(pub Hit<'s>, SurfacePoint);

impl<'s> From<Hit<'s>> for Vertex<'s> {
    fn from(x: Hit<'s>) -> Self {
        Self(x, SurfacePoint::new(x.p.into(), x.n.into()))
    }
}
impl scene_core::Scene for Scene {
    type Spectrum = V;
    type Vertex<'s> = Vertex<'s>;
    type Emitter = Object;
    type Sensor = Camera;
    fn intersect(&self, ray: &Ray) -> Option<Vertex<'_>> {
        self.hit((ray.origin.into(), ray.direction.into()), ray.max_distance.into()).map(Vertex::from)
    }
    fn occluded(&self, ray: &Ray) -> bool {
        !self.is_free((ray.origin.into(), ray.direction.into()), ray.max_distance.into())
    }
    fn emitters(&self) -> &[Object] {
        &self.objects[..1]
    }
    fn environment(&self) -> Option<EmitterId> {
        None
    }
    fn sensor(&self) -> &Camera {
        &self.camera
    }
    fn bounding_sphere(&self) -> (Vec3A, f32) {
        (Vec3A::new(2.0 / 3.0, 0.5, 0.5), 1.0)
    }
}
impl scene_core::Vertex for Vertex<'_> {
    type Spectrum = V;
    fn point(&self) -> &SurfacePoint {
        &self.1
    }
    fn shading_normal(&self) -> Vec3A {
        self.1.normal
    }
    fn wo(&self) -> Vec3A {
        self.0.wo.into()
    }
    fn emitter(&self) -> Option<EmitterId> {
        (self.0.object.emission != V::default()).then_some(EmitterId(0))
    }
    fn emitted(&self) -> V {
        self.0.emitted()
    }
    fn is_connectible(&self) -> bool {
        true
    }
    fn eval(&self, wi: Vec3A, _: TransportMode) -> V {
        self.0.value(wi.into()) * self.0.n.dot(wi.into()).max(0.0)
    }
    fn pdf_solid_angle(&self, wi: Vec3A, _: TransportMode) -> f32 {
        self.0.pdf(wi.into()) as f32
    }
    fn sample(&self, u: [f32; 3], _: TransportMode) -> Option<ScatterSample<V>> {
        let (wi, throughput, pdf) = self.0.sample(u.map(f64::from))?;
        let pdf_solid_angle = pdf as f32;
        Some(ScatterSample { wi: wi.into(), throughput, pdf_solid_angle, is_specular: false, eta: 1.0 })
    }
    fn albedo(&self) -> V {
        let Bsdf { diffuse, gloss, .. } = self.0.object.bsdf;
        diffuse + V::splat(gloss)
    }
    fn reversed(&self, wi: Vec3A) -> Self {
        Self(Hit { wo: wi.into(), ..self.0 }, self.1)
    }
}
impl Emitter for Object {
    type Spectrum = V;
    fn power(&self) -> V {
        self.emission * (PI * self.point(0.0, 0.0).2)
    }
    fn is_delta(&self) -> bool {
        false
    }
    fn is_infinite(&self) -> bool {
        false
    }
    fn sample_direct(&self, from: Vec3A, [u, v]: [f32; 2]) -> Option<DirectSample<V>> {
        let (y, n, _) = self.point(u.into(), v.into());
        let at = SurfacePoint::new(y.into(), n.into());
        let (wi, distance) = ((y - from.into()).unit().into(), (y - from.into()).length() as f32);
        let pdf_solid_angle = self.pdf_direct(from, wi, Some(&at));
        let (radiance, at) = (self.radiance(None, -wi), Some((at, distance)));
        (pdf_solid_angle > 0.0).then_some(DirectSample { wi, at, radiance, pdf_solid_angle, is_delta: false })
    }
    fn pdf_direct(&self, from: Vec3A, wi: Vec3A, at: Option<&SurfacePoint>) -> f32 {
        let (_, n, area) = self.point(0.0, 0.0);
        let cosine = -n.dot(wi.into()) as f32;
        let pdf = |y: &SurfacePoint| y.position.distance_squared(from) / (cosine * area as f32);
        at.filter(|_| cosine > 0.0).map_or(0.0, pdf)
    }
    fn sample_emission(&self, [u, v]: [f32; 2], direction: [f32; 2]) -> Option<EmissionSample<V>> {
        let (y, n, area) = self.point(u.into(), v.into());
        let lambert = Bsdf { diffuse: V::default(), gloss: 0.0, exponent: 1.0 };
        let (wi, _, pdf) = lambert.sample(n, n, [1.0, direction[0].into(), direction[1].into()])?;
        let (point, pdf_area) = (SurfacePoint::new(y.into(), n.into()), 1.0 / area as f32);
        let (direction, pdf_solid_angle) = (wi.into(), pdf as f32);
        Some(EmissionSample { point, direction, flux: self.power(), pdf_area, pdf_solid_angle })
    }
    fn pdf_emission(&self, _: Option<&SurfacePoint>, direction: Vec3A) -> (f32, f32) {
        let (_, n, area) = self.point(0.0, 0.0);
        (1.0 / area as f32, (n.dot(direction.into()).max(0.0) / PI) as f32)
    }
    fn radiance(&self, _: Option<&SurfacePoint>, direction: Vec3A) -> V {
        if self.point(0.0, 0.0).1.dot(direction.into()) > 0.0 { self.emission } else { V::default() }
    }
}
impl scene_core::Sensor for Camera {
    fn resolution(&self) -> [u32; 2] {
        [WIDTH as u32, HEIGHT as u32]
    }
    fn sample_ray(&self, [x, y]: [f32; 2], _: [f32; 2]) -> SensorRay {
        let (o, d) = self.ray(x.into(), y.into());
        SensorRay { ray: Ray::new(o.into(), d.into()), weight: 1.0 }
    }
    // Virtual point lights are never connected to the camera.
    fn connect(&self, _: Vec3A, _: [f32; 2]) -> Option<SensorConnection> {
        None
    }
    fn pdf_ray(&self, _: Vec3A, _: Vec3A) -> (f32, f32) {
        (0.0, 0.0)
    }
}
// end
