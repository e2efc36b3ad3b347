//! The laws of `Vertex`.

mod exact;

use scene_core::glam::Vec3A;
use scene_core::{Frame, Spectrum, TransportMode, Vertex};

use super::direction;
use crate::domain::Sphere;
use crate::mean::{Truth, mean_is};
use crate::moments::Moments;
use crate::outcome::{Outcome, Report};
use crate::sampling::{Sampled, SamplingCheck};
use crate::suite::Check;
use exact::Exact;

const MODES: [TransportMode; 2] = [TransportMode::Radiance, TransportMode::Importance];

/// Checks the laws of a [`Vertex`] with the default [`VertexLaws`].
///
/// ```
/// # fn first_hit<S: scene_core::Scene>(scene: &S) -> Result<(), estimator_checks::SuiteError> {
/// use estimator_checks::{Check, laws::scene::check_vertex};
/// use scene_core::Sensor;
///
/// if let Some(vertex) = scene.intersect(&scene.sensor().sample_ray([0.5; 2], [0.5; 2]).ray) {
///     check_vertex(Check::new("first hit", 1e-6)?, &vertex).expect_pass();
/// }
/// # Ok(())
/// # }
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_vertex<V: Vertex>(check: Check, vertex: &V) -> Report {
    VertexLaws::new().run(check, vertex)
}

/// Checks the laws of a [`Vertex`], in both modes.
///
/// ```text
/// (1)  eval and pdf are finite and not negative for all directions; eval > 0 implies pdf > 0; eval = 0 if not connectible
/// (2)  eval_pdf is eval and pdf; the same question has the same answer
/// (3)  a sample has a unit direction, positive density and eta, and, if it is not specular,
///      pdf(wi) is its density and throughput * density = eval(wi)
/// (4)  eval(wi, Radiance) / g(wi) = reversed(wi).eval(wo, Importance) / g(wo)                   the adjoint law
/// (5)  normals, wo and wi have unit length; albedo lies in [0, 1]; reversed(wi) is the same point seen from wi;
///      lambertian() is eval / g on the side of wo, and zero on the other; rays leave the point in their direction
/// (6)  samples are distributed like pdf                                                         chi-square, each mode
/// (7)  E[throughput] = integral eval(wi) dwi, for what is not specular                          t-test, each mode
/// (8)  E[throughput eta^2] <= 1 for radiance, in each component: no light is made               t-test
/// ```
///
/// `g`: the cosine with the geometric normal, in magnitude; 1 for points in space, whose normal is zero. Of (7) the luminance is
/// looked at.
///
/// (1) to (5) are exact, but for round-off, for directions at random, samples, and such as have broken scattering
/// functions: along and across the normals and `wo`, grazing, below. Values of (3) and (4) are compared within `tolerance`, 1 %
/// unless set, where all cosines are above 1/100: the others lose digits in `f32`. (6) to (8) share the level of the check;
/// they are left out if the vertex has nothing to scatter but Dirac deltas. (8) forgives a `gain` of 2 %, for fits.
///
/// Cost: some 100 000 samples, and the quadratures of `pdf` and `eval`. Uniform numbers are independent.
///
/// Sources: Veach 1997, sections 3.7.5 and 5.3; the white furnace and chi-square tests of Mitsuba and pbrt.
#[derive(Clone, Debug)]
pub struct VertexLaws {
    samples: usize,
    directions: usize,
    tolerance: f64,
    gain: f64,
    adjoint: bool,
}

impl Default for VertexLaws {
    fn default() -> Self {
        Self::new()
    }
}

impl VertexLaws {
    /// 40 000 samples for each statistical law, 400 directions for the exact ones, a tolerance of 1 %, a gain of 2 %.
    pub fn new() -> Self {
        Self { samples: 40_000, directions: 400, tolerance: 0.01, gain: 0.02, adjoint: true }
    }

    /// The number of samples of each statistical law.
    #[must_use]
    pub fn samples(self, samples: usize) -> Self {
        Self { samples, ..self }
    }

    /// The number of random directions and samples of the exact laws.
    #[must_use]
    pub fn directions(self, directions: usize) -> Self {
        Self { directions, ..self }
    }

    /// The relative tolerance of what must be equal.
    #[must_use]
    pub fn tolerance(self, tolerance: f64) -> Self {
        Self { tolerance, ..self }
    }

    /// By how much what is scattered may exceed what arrives: for fits and tables that err.
    #[must_use]
    pub fn gain(self, gain: f64) -> Self {
        Self { gain, ..self }
    }

    /// Leaves out the adjoint law: for implementations whose shading frame, or material, depends on `wo`.
    #[must_use]
    pub fn without_adjoint(self) -> Self {
        Self { adjoint: false, ..self }
    }

    /// Checks the laws.
    #[must_use = "it decides nothing until it is expected to pass or to reject"]
    pub fn run<V: Vertex>(&self, check: Check, vertex: &V) -> Report {
        let mut uniforms = check.uniforms();
        let laws = Exact { vertex, tolerance: self.tolerance, adjoint: self.adjoint };
        let exact = Outcome::of_laws(check.test(), laws.check(&mut uniforms, self.directions));
        if !exact.passed() {
            return Report { outcomes: vec![exact] };
        }
        let mut outcomes = vec![exact];
        let [radiance, importance, energy] = check.split(["radiance", "importance", "energy"]);
        for (check, mode) in [radiance, importance].into_iter().zip(MODES) {
            if scatters(&check, vertex, mode, self.samples) {
                // The equalities of samples have passed already; a violation that prevents the rest stands in their place.
                let sampling = self.sampling(check, vertex, mode).outcomes.into_iter().enumerate();
                outcomes
                    .extend(sampling.filter(|(i, outcome)| *i > 0 || !outcome.passed()).map(|(_, outcome)| outcome));
            }
        }
        outcomes.extend(self.energy(energy, vertex));
        Report { outcomes }
    }

    /// (6) and (7), around the shading normal: so the horizon is an edge of cells.
    fn sampling<V: Vertex>(&self, check: Check, vertex: &V, mode: TransportMode) -> Report {
        let frame = Frame::from_z(axis(vertex));
        let sample = |u: [f64; 3]| {
            let sample = vertex.sample(u.map(|u| u as f32), mode).filter(|sample| !sample.is_specular)?;
            let (point, pdf) = (frame.to_local(sample.wi).to_array(), f64::from(sample.pdf_solid_angle));
            Some(Sampled { point, weight: sample.throughput.luminance().into(), pdf })
        };
        let towards = |w: [f64; 3]| frame.to_world(direction(w)).normalize();
        SamplingCheck::on(Sphere).samples(self.samples).outliers(1.0).albedo_tolerance(1e-3).run(
            check,
            sample,
            |w| vertex.pdf_solid_angle(towards(w), mode).into(),
            |w| vertex.eval(towards(w), mode).luminance().into(),
        )
    }

    /// (8), for each component.
    fn energy<V: Vertex>(&self, check: Check, vertex: &V) -> Vec<Outcome> {
        let count = V::Spectrum::COMPONENTS;
        let mut moments = vec![Moments::new(); count];
        let mut uniforms = check.uniforms();
        for _ in 0..self.samples {
            let sample = vertex.sample(uniforms.array().map(|u| u as f32), TransportMode::Radiance);
            for (i, moments) in moments.iter_mut().enumerate() {
                moments.push(
                    sample.as_ref().map_or(0.0, |sample| {
                        f64::from(sample.throughput.component(i)) * f64::from(sample.eta).powi(2)
                    }),
                );
            }
        }
        let limit = 1.0 + self.gain;
        let parts = check.parts((0..count).map(|i| format!("component {i}")));
        let judge = |(moments, check): (Moments, Check)| {
            // What is below the limit is as good as at it.
            let slack = (limit - moments.mean()).max(0.0);
            mean_is(check, &moments, Truth { value: limit, error: slack })
        };
        moments.into_iter().zip(parts).map(judge).collect()
    }
}

/// The shading normal, or any axis for points in space.
fn axis<V: Vertex>(vertex: &V) -> Vec3A {
    vertex.shading_normal().try_normalize().unwrap_or(Vec3A::Z)
}

/// Whether there is anything to find by statistics: a sample that is not specular, or a density.
fn scatters<V: Vertex>(check: &Check, vertex: &V, mode: TransportMode, samples: usize) -> bool {
    let mut uniforms = check.uniforms();
    (0..samples.min(4000)).any(|_| {
        let sample = vertex.sample(uniforms.array().map(|u| u as f32), mode);
        let density = vertex.pdf_solid_angle(super::on_sphere(&mut uniforms), mode);
        density > 0.0 || sample.is_some_and(|sample| !sample.is_specular)
    })
}
