//! Vertices that lie.

use std::cell::Cell;

use scene_core::glam::Vec3A;
use scene_core::reference::SceneVertex;
use scene_core::{EmitterId, Ray, Rgb, ScatterSample, SurfacePoint, TransportMode, Vertex};

/// What a vertex says wrongly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum VertexLie {
    Nothing,
    NegativeBelow,
    NanAlongTheNormal,
    NegativeDensity,
    NoDensityAtSomeDirections,
    DeltasOnly,
    EvalPdfDiffers,
    Dice,
    DensityOfSamples,
    ThroughputOfSamples,
    LongDirections,
    NegativeThroughput,
    NoEta,
    NotAdjoint,
    LongNormal,
    LongWo,
    BrightAlbedo,
    NegativeEmission,
    ReversedForgets,
    OtherConstant,
    RaysGoBack,
    OtherDistribution,
    Absorbs,
    MakesLight,
    EmitsMore,
    ForgetsItsEmitter,
    OtherEmitter,
    WoGoesOn,
    HoversOverTheSurface,
}

use VertexLie as Lie;

thread_local! {
    static CALLS: Cell<u32> = const { Cell::new(0) };
}

#[derive(Clone)]
pub(crate) struct LiarVertex<'s> {
    inner: SceneVertex<'s>,
    lie: Lie,
    point: SurfacePoint,
}

impl<'s> LiarVertex<'s> {
    pub(crate) fn new(inner: SceneVertex<'s>, lie: Lie) -> Self {
        let mut point = *inner.point();
        match lie {
            Lie::LongNormal => point.normal *= 1.01,
            Lie::HoversOverTheSurface => {
                let tangent = point.normal.any_orthonormal_vector();
                point.position += 0.05 * (point.normal + tangent);
            }
            _ => {}
        }
        Self { inner, lie, point }
    }

    /// On the other side than `wo`.
    fn is_far_below(&self, wi: Vec3A) -> bool {
        wi.dot(self.point.normal) * self.inner.wo().dot(self.point.normal) < -0.25
    }
}

impl Vertex for LiarVertex<'_> {
    type Spectrum = Rgb;

    fn point(&self) -> &SurfacePoint {
        &self.point
    }

    fn shading_normal(&self) -> Vec3A {
        self.inner.shading_normal()
    }

    fn wo(&self) -> Vec3A {
        match self.lie {
            Lie::LongWo => 1.01 * self.inner.wo(),
            Lie::WoGoesOn => -self.inner.wo(),
            _ => self.inner.wo(),
        }
    }

    fn emitter(&self) -> Option<EmitterId> {
        match self.lie {
            Lie::ForgetsItsEmitter => None,
            Lie::OtherEmitter => self.inner.emitter().map(|id| EmitterId(id.0 + 9)),
            _ => self.inner.emitter(),
        }
    }

    fn emitted(&self) -> Rgb {
        match self.lie {
            Lie::NegativeEmission => Rgb::splat(-1.0),
            Lie::EmitsMore => self.inner.emitted() * 1.1,
            _ => self.inner.emitted(),
        }
    }

    fn is_connectible(&self) -> bool {
        self.lie != Lie::DeltasOnly && self.inner.is_connectible()
    }

    fn eval(&self, wi: Vec3A, mode: TransportMode) -> Rgb {
        let value = self.inner.eval(wi, mode);
        let call = CALLS.replace(CALLS.get() + 1);
        match self.lie {
            Lie::NegativeBelow if self.is_far_below(wi) => Rgb::splat(-0.1),
            Lie::NanAlongTheNormal if wi.dot(self.point.normal).abs() > 0.999_999 => Rgb::splat(f32::NAN),
            Lie::NotAdjoint if mode == TransportMode::Importance => value * (1.0 + 0.3 * wi.z),
            Lie::MakesLight => value * 1.6,
            Lie::Dice if call.is_multiple_of(7) => value * 1.001,
            _ => value,
        }
    }

    fn pdf_solid_angle(&self, wi: Vec3A, mode: TransportMode) -> f32 {
        let pdf = self.inner.pdf_solid_angle(wi, mode);
        match self.lie {
            Lie::NegativeDensity if self.is_far_below(wi) => -0.1,
            Lie::NoDensityAtSomeDirections if wi.x > 0.9 => 0.0,
            _ => pdf,
        }
    }

    fn sample(&self, mut u: [f32; 3], mode: TransportMode) -> Option<ScatterSample<Rgb>> {
        match self.lie {
            Lie::OtherDistribution => u[1] = u[1].powf(1.2).min(0.999_999),
            Lie::Absorbs if u[2] < 0.1 => return None,
            _ => {}
        }
        let mut sample = self.inner.sample(u, mode)?;
        match self.lie {
            Lie::DensityOfSamples => {
                sample.pdf_solid_angle *= 1.05;
                sample.throughput = sample.throughput * (1.0 / 1.05);
            }
            Lie::ThroughputOfSamples => sample.throughput = sample.throughput * 1.05,
            Lie::LongDirections => sample.wi *= 1.01,
            Lie::NegativeThroughput if u[2] > 0.99 => sample.throughput = sample.throughput * -1.0,
            Lie::NoEta => sample.eta = 0.0,
            Lie::NotAdjoint if mode == TransportMode::Importance => {
                sample.throughput = sample.throughput * (1.0 + 0.3 * sample.wi.z);
            }
            Lie::MakesLight => sample.throughput = sample.throughput * 1.6,
            _ => {}
        }
        Some(sample)
    }

    fn albedo(&self) -> Rgb {
        if self.lie == Lie::BrightAlbedo { self.inner.albedo() + Rgb::splat(0.6) } else { self.inner.albedo() }
    }

    fn reversed(&self, wi: Vec3A) -> Self {
        if self.lie == Lie::ReversedForgets {
            return self.clone();
        }
        Self { inner: self.inner.reversed(wi), ..self.clone() }
    }

    fn lambertian(&self) -> Option<Rgb> {
        match self.lie {
            Lie::Nothing => self.inner.lambertian(),
            Lie::OtherConstant => self.inner.lambertian().map(|constant| constant * 1.05),
            _ => None,
        }
    }

    fn eval_pdf(&self, wi: Vec3A, mode: TransportMode) -> (Rgb, f32) {
        let (value, pdf) = (self.eval(wi, mode), self.pdf_solid_angle(wi, mode));
        if self.lie == Lie::EvalPdfDiffers { (value, 1.001 * pdf) } else { (value, pdf) }
    }

    fn spawn_ray(&self, wi: Vec3A) -> Ray {
        self.point().ray_along(if self.lie == Lie::RaysGoBack { -wi } else { wi })
    }
}
