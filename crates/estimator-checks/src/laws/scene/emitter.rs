//! The laws of `Emitter`.

use scene_core::glam::Vec3A;
use scene_core::{DirectSample, EmissionSample, Emitter, EmitterId, Frame, Ray, Scene, Spectrum, SurfacePoint, Vertex};

use super::{alike, direction, is_amount, is_unit, on_sphere};
use crate::chi_square::ChiSquare;
use crate::domain::Sphere;
use crate::laws::{Law, hold, near};
use crate::mean::{Truth, mean_is, same_mean_within};
use crate::moments::Moments;
use crate::outcome::{Outcome, Report};
use crate::seed::Uniforms;
use crate::suite::Check;

/// Samples of each exact law.
const EXACT: usize = 2000;
/// Samples of each chi-square test. Emitters end at sharp edges, which a quadrature resolves slowly: few samples allow it large errors.
const CHI_SQUARE: usize = 20_000;
/// Samples of each mean.
const MEAN: usize = 40_000;
/// Relative tolerance of values that must be equal.
const TOLERANCE: f64 = 5e-3;
/// Cosines below lose digits in `f32`.
const GRAZING: f32 = 1e-2;
/// Surfaces that a ray is followed through.
const SURFACES: usize = 64;

/// Checks the laws of the [`Emitter`] number `id` of a scene, with light that arrives at the point `from`.
///
/// ```text
/// (1)  sample_direct: wi has unit length and leads to `at`; density and radiance are finite and not negative; they are what
///      pdf_direct and radiance say of it; `at`, and whether it is a Dirac delta, fit is_infinite and is_delta
/// (2)  sample_emission: the same; flux = L |cos| / (pdf_area pdf_solid_angle)
/// (3)  where light arrives from the emitter, pdf_direct is positive; Dirac deltas have no density and no radiance
/// (4)  power is finite and not negative; is_lambertian: one radiance on the side of the normal, none on the other
/// (5)  wi is distributed like the sum of pdf_direct over the emitter's points in this direction                chi-square
/// (6)  directions of emission are distributed like pdf_emission                                                chi-square
/// (7)  E[flux] = power                                                                                         t-test
/// (8)  E[L / pdf_direct] = E[L |cos| / (pdf_area distance^2)]: the fluence at `from`, by both samplers         t-test
/// ```
///
/// (1) to (4) are exact, but for round-off. (5) to (8) share the level of the check; an emitter of Dirac deltas has (7)
/// alone, one at infinity no (8), which needs positions. Of (7) and (8) the luminance is looked at.
///
/// The scene says where rays meet the emitter; what else is in the way is looked through. If `from` is not lit, (5) is
/// undecided: choose another point. A point much closer to the emitter than its size makes (8) heavy-tailed.
/// Cost: 100 000 samples, and rays by the quadrature of the density, some 50 000 for a smooth one.
///
/// ```
/// # fn lamp<S: scene_core::Scene>(scene: &S, from: scene_core::glam::Vec3A) -> Result<(), estimator_checks::SuiteError> {
/// use estimator_checks::{Check, laws::scene::check_emitter};
/// use scene_core::EmitterId;
///
/// check_emitter(Check::new("lamp", 1e-6)?, scene, EmitterId(0), from).expect_pass();
/// # Ok(())
/// # }
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_emitter<S: Scene>(check: Check, scene: &S, id: EmitterId, from: Vec3A) -> Report {
    let Some(emitter) = scene.emitters().get(id.index()) else {
        let exists = hold("an emitter is one of the scene", false, || format!("{id:?} of {}", scene.emitters().len()));
        return Report { outcomes: vec![Outcome::of_laws(check.test(), exists)] };
    };
    let lit = Lit { scene, emitter, id, from };
    let exact = Outcome::of_laws(check.test(), lit.laws(&mut check.uniforms()));
    if !exact.passed() {
        return Report { outcomes: vec![exact] };
    }
    let [directions, emission, power, fluence] = check.split(["direct light", "emission", "power", "fluence"]);
    let mut outcomes = vec![exact, lit.power(power)];
    if !emitter.is_delta() {
        outcomes.extend([lit.directions(directions), lit.emission(emission)]);
        outcomes.extend((!emitter.is_infinite()).then(|| lit.fluence(fluence)));
    }
    Report { outcomes }
}

/// An emitter, and a point that it shines on.
struct Lit<'s, S: Scene> {
    scene: &'s S,
    emitter: &'s S::Emitter,
    id: EmitterId,
    from: Vec3A,
}

impl<S: Scene> Lit<'_, S> {
    fn laws(&self, uniforms: &mut Uniforms) -> Law {
        let power = self.emitter.power();
        hold("power is finite and not negative", is_amount(&power), || format!("{power:?}"))?;
        for _ in 0..EXACT {
            let u = uniforms.array::<4>().map(|u| u as f32);
            self.direct_sample([u[0], u[1]])?;
            self.emission_sample([u[0], u[1]], [u[2], u[3]])?;
            self.arriving(on_sphere(uniforms))?;
        }
        for u in [[0.0; 2], [1.0_f32.next_down(); 2], [0.0, 1.0_f32.next_down()]] {
            self.direct_sample(u)?;
            self.emission_sample(u, u)?;
        }
        Ok(())
    }

    /// (1)
    fn direct_sample(&self, u: [f32; 2]) -> Law {
        let (emitter, from) = (self.emitter, self.from);
        let Some(sample) = emitter.sample_direct(from, u) else { return Ok(()) };
        let shown = || format!("{sample:?} of {u:?} from {from}");
        let again = emitter.sample_direct(from, u);
        hold("the same numbers give the same sample", again.as_ref() == Some(&sample), shown)?;
        let DirectSample { wi, ref at, ref radiance, pdf_solid_angle, is_delta } = sample;
        hold("directions have unit length", is_unit(wi), shown)?;
        hold("radiance is finite and not negative", is_amount(radiance), shown)?;
        hold(
            "the density of a sample is finite and positive",
            pdf_solid_angle.is_finite() && pdf_solid_angle > 0.0,
            shown,
        )?;
        hold("samples are Dirac deltas if the emitter is", is_delta == emitter.is_delta(), shown)?;
        let infinite = at.is_none() == emitter.is_infinite();
        hold("light from infinity, and no other, starts nowhere", infinite, shown)?;
        let point = at.as_ref().map(|(point, _)| point);
        if let Some((point, distance)) = at {
            let away = (from + wi * *distance - point.position).length();
            hold("wi leads to the point at its distance", away <= 1e-3 * distance, shown)?;
        }
        if is_delta {
            return hold("a Dirac delta has density 1", pdf_solid_angle == 1.0, shown);
        }
        let is_grazing = point.is_some_and(|point| point.normal.dot(wi).abs() < GRAZING);
        let (density, leaving) = (emitter.pdf_direct(from, wi, point), self.leaving(point, wi));
        let near = is_grazing || near(density.into(), pdf_solid_angle.into(), TOLERANCE);
        hold("pdf_direct is the density of the sample", near, || format!("{density} for {}", shown()))?;
        let same = is_grazing || alike(&leaving, radiance, TOLERANCE);
        hold("radiance is that of the sample", same, || format!("{leaving:?} for {}", shown()))
    }

    /// Radiance from the emitter's point that is seen in direction `wi`.
    fn leaving(&self, point: Option<&SurfacePoint>, wi: Vec3A) -> S::Spectrum {
        self.emitter.radiance(point, if point.is_some() { -wi } else { wi })
    }

    /// (2) and (4)
    fn emission_sample(&self, u_position: [f32; 2], u_direction: [f32; 2]) -> Law {
        let emitter = self.emitter;
        let Some(sample) = emitter.sample_emission(u_position, u_direction) else { return Ok(()) };
        let shown = || format!("{sample:?} of {u_position:?}, {u_direction:?}");
        let again = emitter.sample_emission(u_position, u_direction);
        hold("the same numbers give the same ray of light", again.as_ref() == Some(&sample), shown)?;
        let EmissionSample { ref point, direction, ref flux, pdf_area, pdf_solid_angle } = sample;
        hold("directions have unit length", is_unit(direction), shown)?;
        hold("flux is finite and not negative", is_amount(flux), shown)?;
        let positive = [pdf_area, pdf_solid_angle].iter().all(|pdf| pdf.is_finite() && *pdf > 0.0);
        hold("the densities of a ray of light are finite and positive", positive, shown)?;
        if emitter.is_delta() {
            return Ok(());
        }
        let at = (!emitter.is_infinite()).then_some(point);
        let cosine = at.map_or(1.0, |point| point.normal.dot(direction).abs());
        self.lambertian(at, direction)?;
        if let Some(point) = at {
            // A ray towards every point that may shine on `from`.
            self.arriving((point.position - self.from).normalize_or_zero())?;
        }
        if cosine < GRAZING {
            return Ok(());
        }
        let (area, angle) = emitter.pdf_emission(at, direction);
        let near =
            near(area.into(), pdf_area.into(), TOLERANCE) && near(angle.into(), pdf_solid_angle.into(), TOLERANCE);
        hold("pdf_emission is the densities of the ray of light", near, || format!("{area}, {angle} for {}", shown()))?;
        let radiance = emitter.radiance(at, if at.is_some() { direction } else { -direction });
        let expected = radiance * (cosine / (pdf_area * pdf_solid_angle));
        hold("flux is radiance over densities", alike(&expected, flux, TOLERANCE), || {
            format!("{expected:?} for {}", shown())
        })
    }

    /// (4)
    fn lambertian(&self, at: Option<&SurfacePoint>, direction: Vec3A) -> Law {
        let Some(point) = at.filter(|_| self.emitter.is_lambertian()) else { return Ok(()) };
        let front = point.normal;
        let [along, front_, back] = [direction, front, -front].map(|w| self.emitter.radiance(at, w));
        let same = alike(&along, &front_, TOLERANCE) && back.is_black();
        let shown =
            || format!("{along:?} along {direction}, {front_:?} along the normal, {back:?} behind, at {point:?}");
        hold("is_lambertian: one radiance in front, none behind", same, shown)
    }

    /// (3)
    fn arriving(&self, wi: Vec3A) -> Law {
        if !is_unit(wi) {
            return Ok(());
        }
        let emitter = self.emitter;
        if emitter.is_infinite() || emitter.is_delta() {
            let (pdf, radiance) = (emitter.pdf_direct(self.from, wi, None), self.leaving(None, wi));
            return self.covered(pdf, &radiance, wi);
        }
        self.meetings(wi).iter().try_for_each(|point| {
            let (pdf, radiance) = (emitter.pdf_direct(self.from, wi, Some(point)), self.leaving(Some(point), wi));
            let is_grazing = point.normal.dot(wi).abs() < GRAZING;
            if is_grazing { Ok(()) } else { self.covered(pdf, &radiance, wi) }
        })
    }

    fn covered(&self, pdf: f32, radiance: &S::Spectrum, wi: Vec3A) -> Law {
        let shown = || format!("density {pdf}, radiance {radiance:?} from {} along {wi}", self.from);
        hold("densities are finite and not negative", pdf.is_finite() && pdf >= 0.0, shown)?;
        hold("radiance is finite and not negative", is_amount(radiance), shown)?;
        if self.emitter.is_delta() {
            return hold("no ray finds a Dirac delta", pdf == 0.0 && radiance.is_black(), shown);
        }
        hold("where light arrives, its density is positive", radiance.is_black() || pdf > 0.0, shown)
    }

    /// The points of the emitter that a ray from the lit point meets, behind each other.
    fn meetings(&self, wi: Vec3A) -> Vec<SurfacePoint> {
        let (mut points, mut ray) = (Vec::new(), Ray::new(self.from, wi));
        for _ in 0..SURFACES {
            let Some(vertex) = self.scene.intersect(&ray) else { break };
            points.extend((vertex.emitter() == Some(self.id)).then(|| *vertex.point()));
            ray = vertex.point().ray_along(wi);
        }
        points
    }

    /// (5)
    fn directions(&self, check: Check) -> Outcome {
        // An area light's edges follow the cells if its direction is the pole: as well as they can.
        let frame = Frame::from_z(self.towards());
        let sample = |[u, v, _]: [f64; 3]| {
            let sample = self.emitter.sample_direct(self.from, [u as f32, v as f32])?;
            Some(frame.to_local(sample.wi).to_array())
        };
        let density = |w: [f64; 3]| {
            let wi = frame.to_world(direction(w)).normalize();
            if self.emitter.is_infinite() {
                return self.emitter.pdf_direct(self.from, wi, None).into();
            }
            self.meetings(wi).iter().map(|point| f64::from(self.emitter.pdf_direct(self.from, wi, Some(point)))).sum()
        };
        ChiSquare::on(Sphere).cells(12, 24).samples(CHI_SQUARE).min_expected(40.0).run(check, sample, density)
    }

    /// Where most of the light comes from.
    fn towards(&self) -> Vec3A {
        let grid = (0..64).map(|k| [(k % 8) as f32 / 8.0, (k / 8) as f32 / 8.0]);
        let sum: Vec3A = grid.filter_map(|u| self.emitter.sample_direct(self.from, u)).map(|sample| sample.wi).sum();
        sum.try_normalize().unwrap_or(Vec3A::Z)
    }

    /// (6), from one position.
    fn emission(&self, check: Check) -> Outcome {
        let u_position = [0.37, 0.61];
        let start = self.emitter.sample_emission(u_position, [0.3, 0.6]).map(|sample| sample.point);
        let at = start.filter(|_| !self.emitter.is_infinite());
        let frame = Frame::from_z(at.and_then(|point| point.normal.try_normalize()).unwrap_or(Vec3A::Z));
        let sample = |[u, v, _]: [f64; 3]| {
            let sample = self.emitter.sample_emission(u_position, [u as f32, v as f32])?;
            Some(frame.to_local(sample.direction).to_array())
        };
        let density =
            |w: [f64; 3]| self.emitter.pdf_emission(at.as_ref(), frame.to_world(direction(w)).normalize()).1.into();
        ChiSquare::on(Sphere).cells(12, 24).samples(CHI_SQUARE).min_expected(40.0).run(check, sample, density)
    }

    /// (7)
    fn power(&self, check: Check) -> Outcome {
        let mut uniforms = check.uniforms();
        let flux: Moments = (0..MEAN)
            .map(|_| {
                let u = uniforms.array::<4>().map(|u| u as f32);
                let sample = self.emitter.sample_emission([u[0], u[1]], [u[2], u[3]]);
                sample.map_or(0.0, |sample| sample.flux.luminance().into())
            })
            .collect();
        mean_is(check, &flux, Truth::relative(self.emitter.power().luminance().into(), 2e-3))
    }

    /// (8)
    fn fluence(&self, check: Check) -> Outcome {
        let (emitter, from) = (self.emitter, self.from);
        let mut uniforms = check.uniforms();
        let (mut by_direction, mut by_position) = (Moments::new(), Moments::new());
        for _ in 0..MEAN {
            let u = uniforms.array::<4>().map(|u| u as f32);
            let direct = emitter.sample_direct(from, [u[0], u[1]]);
            by_direction
                .push(direct.map_or(0.0, |sample| f64::from(sample.radiance.luminance() / sample.pdf_solid_angle)));
            let emission = emitter.sample_emission([u[2], u[3]], [0.3, 0.6]);
            by_position.push(emission.map_or(0.0, |EmissionSample { point, pdf_area, .. }| {
                let between = from - point.position;
                let leaving = between.normalize_or_zero();
                let radiance = emitter.radiance(Some(&point), leaving).luminance();
                f64::from(radiance * point.normal.dot(leaving).abs() / (pdf_area * between.length_squared()))
            }));
        }
        let allowance = 2e-3 * by_direction.mean().abs();
        same_mean_within(check, &by_direction, &by_position, allowance)
    }
}
