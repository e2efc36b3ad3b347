//! A foreign renderer: a few diffuse or mirroring balls, a sky and a point light, light measured as one `f32`. It shares
//! nothing with the reference scene but the traits, and takes 120 lines of code, uses and types included.

use scene_core::glam::Vec3A;
use scene_core::{
    DirectSample, EmissionSample, Emitter, EmitterId, Frame, Ray, ScatterSample, Scene, Sensor, SensorConnection, SensorRay,
    SurfacePoint, TransportMode, Vertex,
};
use std::f32::consts::{FRAC_1_PI, PI, TAU};

pub(crate) struct Ball { pub center: Vec3A, pub radius: f32, pub albedo: f32, pub is_mirror: bool }
pub(crate) enum Lamp { Sky { radiance: f32, radius: f32 }, Point { position: Vec3A, intensity: f32 } }
pub(crate) struct Camera { pub eye: Vec3A, pub size: u32 }
/// The first lamp is the sky; all balls lie within its radius around the origin.
pub(crate) struct Balls { pub balls: Vec<Ball>, pub lamps: Vec<Lamp>, pub camera: Camera }
#[derive(Clone)]
pub(crate) struct Hit<'s> { ball: &'s Ball, point: SurfacePoint, wo: Vec3A }

fn on_sphere([u, v]: [f32; 2]) -> Vec3A {
    let (z, (sin, cos)) = (1.0 - 2.0 * u, (TAU * v).sin_cos());
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3A::new(r * cos, r * sin, z)
}

impl Ball {
    fn distance(&self, ray: &Ray) -> Option<f32> {
        let to_center = self.center - ray.origin;
        let along = to_center.dot(ray.direction);
        let root = (along * along - to_center.length_squared() + self.radius * self.radius).sqrt();
        [along - root, along + root].into_iter().find(|t| *t > 0.0 && *t < ray.max_distance)
    }
}

impl Scene for Balls {
    type Spectrum = f32;
    type Vertex<'s> = Hit<'s>;
    type Emitter = Lamp;
    type Sensor = Camera;
    fn intersect(&self, ray: &Ray) -> Option<Hit<'_>> {
        let hits = self.balls.iter().filter_map(|ball| Some((ball, ball.distance(ray)?)));
        let (ball, distance) = hits.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let normal = (ray.at(distance) - ball.center).normalize();
        Some(Hit { ball, point: SurfacePoint::new(ball.center + normal * ball.radius, normal), wo: -ray.direction })
    }
    fn occluded(&self, ray: &Ray) -> bool { self.balls.iter().any(|ball| ball.distance(ray).is_some()) }
    fn emitters(&self) -> &[Lamp] { &self.lamps }
    fn environment(&self) -> Option<EmitterId> { Some(EmitterId(0)) }
    fn sensor(&self) -> &Camera { &self.camera }
    fn bounding_sphere(&self) -> (Vec3A, f32) {
        (Vec3A::ZERO, self.balls.iter().map(|ball| ball.center.length() + ball.radius).fold(0.0, f32::max))
    }
}

impl Vertex for Hit<'_> {
    type Spectrum = f32;
    fn point(&self) -> &SurfacePoint { &self.point }
    fn shading_normal(&self) -> Vec3A { self.point.normal }
    fn wo(&self) -> Vec3A { self.wo }
    fn emitter(&self) -> Option<EmitterId> { None }
    fn emitted(&self) -> f32 { 0.0 }
    fn is_connectible(&self) -> bool { !self.ball.is_mirror }
    fn eval(&self, wi: Vec3A, mode: TransportMode) -> f32 { self.ball.albedo * self.pdf_solid_angle(wi, mode) }
    fn pdf_solid_angle(&self, wi: Vec3A, _: TransportMode) -> f32 {
        if self.ball.is_mirror { 0.0 } else { self.point.normal.dot(wi).max(0.0) * FRAC_1_PI }
    }
    fn sample(&self, [_, u, v]: [f32; 3], mode: TransportMode) -> Option<ScatterSample<f32>> {
        let (normal, is_specular) = (self.point.normal, self.ball.is_mirror);
        let reflected = 2.0 * normal.dot(self.wo) * normal - self.wo;
        let wi = if is_specular { reflected } else { (normal + on_sphere([u, v])).try_normalize()? };
        let pdf_solid_angle = self.pdf_solid_angle(wi, mode);
        Some(ScatterSample { wi, throughput: self.ball.albedo, pdf_solid_angle, is_specular, eta: 1.0 })
    }
    fn albedo(&self) -> f32 { self.ball.albedo }
    fn reversed(&self, wi: Vec3A) -> Self { Self { wo: wi, ..self.clone() } }
}

impl Emitter for Lamp {
    type Spectrum = f32;
    fn power(&self) -> f32 {
        match self { Self::Sky { radiance, radius } => 4.0 * PI * PI * radius * radius * radiance, Self::Point { intensity, .. } => 4.0 * PI * intensity }
    }
    fn is_delta(&self) -> bool { matches!(self, Self::Point { .. }) }
    fn is_infinite(&self) -> bool { matches!(self, Self::Sky { .. }) }
    fn sample_direct(&self, from: Vec3A, u: [f32; 2]) -> Option<DirectSample<f32>> {
        Some(match *self {
            Self::Sky { radiance, .. } => DirectSample { wi: on_sphere(u), at: None, radiance, pdf_solid_angle: 0.25 * FRAC_1_PI, is_delta: false },
            Self::Point { position, intensity } => {
                let distance = (position - from).length();
                let (at, radiance) = (Some((SurfacePoint::in_space(position), distance)), intensity / (distance * distance));
                DirectSample { wi: (position - from) / distance, at, radiance, pdf_solid_angle: 1.0, is_delta: true }
            }
        })
    }
    fn pdf_direct(&self, _: Vec3A, _: Vec3A, _: Option<&SurfacePoint>) -> f32 { if self.is_delta() { 0.0 } else { 0.25 * FRAC_1_PI } }
    fn sample_emission(&self, [u, v]: [f32; 2], u_direction: [f32; 2]) -> Option<EmissionSample<f32>> {
        let direction = on_sphere(u_direction);
        let (position, pdf_area) = match *self {
            Self::Sky { radius, .. } => {
                let (r, (sin, cos)) = (u.sqrt(), (TAU * v).sin_cos());
                (Frame::from_z(direction).to_world(Vec3A::new(r * cos, r * sin, -1.0)) * radius, FRAC_1_PI / (radius * radius))
            }
            Self::Point { position, .. } => (position, 1.0),
        };
        let point = SurfacePoint::in_space(position);
        Some(EmissionSample { point, direction, flux: self.power(), pdf_area, pdf_solid_angle: 0.25 * FRAC_1_PI })
    }
    fn pdf_emission(&self, _: Option<&SurfacePoint>, _: Vec3A) -> (f32, f32) {
        (match self { Self::Sky { radius, .. } => FRAC_1_PI / (radius * radius), Self::Point { .. } => 1.0 }, 0.25 * FRAC_1_PI)
    }
    fn radiance(&self, _: Option<&SurfacePoint>, _: Vec3A) -> f32 { match self { Self::Sky { radiance, .. } => *radiance, Self::Point { .. } => 0.0 } }
}

impl Sensor for Camera {
    fn resolution(&self) -> [u32; 2] { [self.size; 2] }
    fn sample_ray(&self, raster: [f32; 2], _: [f32; 2]) -> SensorRay {
        let [x, y] = raster.map(|x| 2.0 * x / self.size as f32 - 1.0);
        SensorRay { ray: Ray::new(self.eye, Vec3A::new(x, -y, -1.0).normalize()), weight: 1.0 }
    }
    fn connect(&self, from: Vec3A, _: [f32; 2]) -> Option<SensorConnection> {
        let distance = (self.eye - from).length();
        let wi = (self.eye - from) / distance;
        let raster = [wi.x, -wi.y].map(|x| 0.5 * (1.0 - x / wi.z) * self.size as f32);
        let weight = self.pdf_ray(self.eye, -wi).1 * (self.size as f32 / distance).powi(2);
        let lens = SurfacePoint { normal: -Vec3A::Z, ..SurfacePoint::in_space(self.eye) };
        (weight > 0.0).then_some(SensorConnection { lens, wi, distance, raster, weight })
    }
    fn pdf_ray(&self, _: Vec3A, direction: Vec3A) -> (f32, f32) {
        let is_seen = direction.z < 0.0 && direction.x.abs().max(direction.y.abs()) < -direction.z;
        if is_seen { (1.0, -0.25 / direction.z.powi(3)) } else { (0.0, 0.0) }
    }
}
