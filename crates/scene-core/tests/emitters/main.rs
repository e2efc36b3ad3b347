//! Every emitter of the reference scene keeps the laws of the trait `Emitter`: samplers follow their densities, densities agree
//! with each other, radiance and power with what is sampled.

#![cfg(feature = "reference")]
// Helper functions of tests may unwrap.
#![allow(clippy::unwrap_used)]

mod area;
mod delta;
mod environment;

use estimator_checks::{Check, ChiSquare, Moments, Outcome, Sphere, Suite, Uniforms};
use scene_core::glam::{Mat3A, Vec3A};
use scene_core::reference::ReferenceEmitter;
use scene_core::{EmissionSample, Emitter, EmitterId, Ray, ReferenceScene, Rgb, Scene, Vertex};

pub(crate) static SUITE: Suite = Suite::with_share("scene-core emitters", 48, 1e-7);

/// What a test needs of an emitter: its scene, and a point that it shines on.
pub(crate) struct Lit {
    pub name: &'static str,
    pub scene: ReferenceScene,
    pub id: EmitterId,
    pub from: Vec3A,
}

impl Lit {
    pub(crate) fn emitter(&self) -> &ReferenceEmitter {
        &self.scene.emitters()[self.id.index()]
    }

    /// The density of `wi` at the lit point, with the point of the emitter that a ray finds there.
    pub(crate) fn density(&self, wi: Vec3A) -> f32 {
        let hit = self.scene.intersect(&Ray::new(self.from, wi));
        let at = hit.filter(|vertex| vertex.emitter() == Some(self.id)).map(|vertex| *vertex.point());
        self.emitter().pdf_direct(self.from, wi, at.as_ref())
    }

    /// Chi-square of `sample_direct` against `pdf_direct`, which `bug` may spoil.
    pub(crate) fn direct(&self, check: Check, bug: impl Fn(Vec3A, f64) -> f64) -> Outcome {
        let sample = |[u, v, _]: [f64; 3]| {
            self.emitter().sample_direct(self.from, [u as f32, v as f32]).map(|sample| sample.wi.to_array())
        };
        let density = |w: [f64; 3]| {
            let wi = to_direction(w);
            bug(wi, f64::from(self.density(wi)))
        };
        // Emitters end at sharp edges, which a quadrature resolves slowly: few samples allow it large errors.
        ChiSquare::on(Sphere).cells(12, 24).samples(20_000).min_expected(40.0).run(check, sample, density)
    }
}

pub(crate) fn to_direction(w: [f64; 3]) -> Vec3A {
    Vec3A::from(w.map(|x| x as f32))
}

pub(crate) fn close(a: f32, b: f32, tolerance: f32) -> bool {
    (a - b).abs() <= tolerance * a.abs().max(b.abs())
}

/// A rotation without symmetry.
pub(crate) fn tilt() -> Mat3A {
    Mat3A::from_rotation_x(0.7) * Mat3A::from_rotation_y(-1.1) * Mat3A::from_rotation_z(0.4)
}

/// `sample_direct` and what else the emitter says of the same direction agree, sample by sample.
pub(crate) fn direct_samples_agree(lit: &Lit) {
    let (name, emitter) = (lit.name, lit.emitter());
    let mut uniforms = Uniforms::named(name);
    let mut found = 0;
    for _ in 0..4000 {
        let u = [uniforms.next_f32(), uniforms.next_f32()];
        let Some(sample) = emitter.sample_direct(lit.from, u) else { continue };
        assert!((sample.wi.length() - 1.0).abs() < 1e-5 && !sample.is_delta, "{name}");
        let point = sample.at.as_ref().map(|(point, _)| point);
        let pdf = emitter.pdf_direct(lit.from, sample.wi, point);
        assert!(close(pdf, sample.pdf_solid_angle, 1e-3), "{name}: density {pdf}, sampled {}", sample.pdf_solid_angle);
        let looking = if point.is_some() { -sample.wi } else { sample.wi };
        let radiance = emitter.radiance(point, looking);
        assert!((0..3).all(|c| close(radiance[c], sample.radiance[c], 2e-3)), "{name}: {radiance:?} {sample:?}");
        match sample.at {
            None => assert_eq!(lit.scene.environment_radiance(sample.wi), radiance, "{name}"),
            Some((point, distance)) => {
                assert!((lit.from + sample.wi * distance - point.position).length() < 1e-3 * distance, "{name}");
                // The ray in this direction finds the emitter there; only those through its edge may miss it.
                let Some(vertex) = lit.scene.intersect(&Ray::new(lit.from, sample.wi)) else { continue };
                let away = (vertex.point().position - point.position).length();
                let cos = point.normal.dot(sample.wi).abs();
                assert!(away * cos < 1e-3 * distance, "{name}: {away}");
                assert_eq!((vertex.emitter(), vertex.emitted()), (Some(lit.id), radiance), "{name}");
            }
        }
        found += 1;
    }
    assert!(found > 1000, "{name}: {found}");
}

/// Densities and flux of light paths: `flux = L cos / (pdf_area pdf_solid_angle)`, and `pdf_emission` knows them.
pub(crate) fn emission_agrees(name: &str, emitter: &ReferenceEmitter, is_at_infinity: bool) {
    let mut uniforms = Uniforms::named(name);
    for _ in 0..4000 {
        let u = uniforms.array::<4>().map(|x| x as f32);
        let Some(sample) = emitter.sample_emission([u[0], u[1]], [u[2], u[3]]) else { continue };
        let EmissionSample { point, direction, flux, pdf_area, pdf_solid_angle } = sample;
        let at = (!is_at_infinity).then_some(&point);
        let (area, angle) = emitter.pdf_emission(at, direction);
        assert!(close(area, pdf_area, 1e-4), "{name}: {area} {pdf_area}");
        assert!(
            close(angle, pdf_solid_angle, 2e-3) || point.normal.dot(direction).abs() < 1e-3,
            "{name}: {sample:?} {angle}"
        );
        let (radiance, cos) = match at {
            Some(point) => (emitter.radiance(Some(point), direction), point.normal.dot(direction)),
            None => (emitter.radiance(None, -direction), 1.0),
        };
        let expected = radiance * (cos / (pdf_area * pdf_solid_angle));
        assert!((0..3).all(|c| close(expected[c], flux[c], 5e-3)) || cos < 1e-3, "{name}: {flux:?} {expected:?}");
    }
}

/// The luminance-like mean of the flux of `n` light paths.
pub(crate) fn mean_flux(emitter: &ReferenceEmitter, uniforms: &mut Uniforms, n: usize) -> Moments {
    (0..n)
        .map(|_| {
            let u = uniforms.array::<4>().map(|x| x as f32);
            emitter.sample_emission([u[0], u[1]], [u[2], u[3]]).map_or(0.0, |sample| f64::from(sample.flux.mean()))
        })
        .collect()
}

/// Chi-square of the directions of light paths that start at one place, against `pdf_emission`.
pub(crate) fn emission_directions(
    check: Check,
    emitter: &ReferenceEmitter,
    is_at_infinity: bool,
    bug: impl Fn(f64) -> f64,
) -> Outcome {
    let u_position = [0.37, 0.61];
    let at = emitter.sample_emission(u_position, [0.5, 0.5]).map(|sample| sample.point).filter(|_| !is_at_infinity);
    let sample = |[u, v, _]: [f64; 3]| {
        emitter.sample_emission(u_position, [u as f32, v as f32]).map(|sample| sample.direction.to_array())
    };
    let density = |w: [f64; 3]| bug(f64::from(emitter.pdf_emission(at.as_ref(), to_direction(w)).1));
    ChiSquare::on(Sphere).cells(12, 24).samples(20_000).min_expected(40.0).run(check, sample, density)
}

pub(crate) const RADIANCE: Rgb = Rgb::new(3.0, 2.0, 1.0);
