//! What holds for every direction and every sample.

use scene_core::glam::Vec3A;
use scene_core::{ScatterSample, Spectrum, TransportMode, Vertex};

use super::super::{alike, components, is_amount, is_unit, on_sphere};
use super::MODES;
use crate::laws::{Law, hold, near};
use crate::seed::Uniforms;

/// Cosines below lose digits in `f32`.
const GRAZING: f32 = 0.01;

pub(super) struct Exact<'v, V> {
    pub vertex: &'v V,
    pub tolerance: f64,
    pub adjoint: bool,
}

impl<V: Vertex> Exact<'_, V> {
    pub(super) fn check(&self, uniforms: &mut Uniforms, count: usize) -> Law {
        self.itself()?;
        for wi in self.special_directions() {
            self.direction(wi)?;
        }
        for _ in 0..count {
            self.direction(on_sphere(uniforms))?;
            let u = uniforms.array().map(|u| u as f32);
            for mode in MODES {
                self.sample(u, mode)?;
            }
        }
        // The ends of the interval, where inversions divide by zero.
        for u in [[0.0; 3], [1.0_f32.next_down(); 3], [0.0, 1.0_f32.next_down(), 0.0], [0.999, 0.0, 0.5]] {
            for mode in MODES {
                self.sample(u, mode)?;
            }
        }
        Ok(())
    }

    /// (5), without a direction.
    fn itself(&self) -> Law {
        let (vertex, point) = (self.vertex, self.vertex.point());
        let (normal, shading, wo) = (point.normal, vertex.shading_normal(), vertex.wo());
        hold("the position is finite", point.position.is_finite() && point.error >= 0.0, || format!("{point:?}"))?;
        let is_normal = |n: Vec3A| is_unit(n) || n == Vec3A::ZERO && normal == Vec3A::ZERO;
        let shown = || format!("geometric {normal}, shading {shading}");
        hold("normals have unit length", is_normal(normal) && is_normal(shading), shown)?;
        hold("wo has unit length", is_unit(wo), || format!("{wo}"))?;
        let albedo = components(&vertex.albedo());
        let in_range = albedo.iter().all(|c| (0.0..=1.0 + self.tolerance).contains(c));
        hold("albedo lies in [0, 1]", in_range, || format!("{albedo:?}"))?;
        let emitted = vertex.emitted();
        hold("emitted radiance is finite and not negative", is_amount(&emitted), || format!("{emitted:?}"))
    }

    /// Along and across what a vertex knows of, grazing, and below.
    fn special_directions(&self) -> impl Iterator<Item = Vec3A> {
        let (normal, shading, wo) = (self.vertex.point().normal, self.vertex.shading_normal(), self.vertex.wo());
        let known = [normal, shading, wo, 2.0 * shading.dot(wo) * shading - wo];
        let known = known.into_iter().filter_map(|w| w.try_normalize());
        known.flat_map(|w| {
            let across = w.any_orthonormal_vector();
            let grazing = [1e-7, 1e-4, 1e-2].map(|z: f32| (across + z * w).normalize());
            [w, across].into_iter().chain(grazing).flat_map(|w| [w, -w]).collect::<Vec<_>>()
        })
    }

    fn direction(&self, wi: Vec3A) -> Law {
        let vertex = self.vertex;
        for mode in MODES {
            let (value, pdf) = (vertex.eval(wi, mode), vertex.pdf_solid_angle(wi, mode));
            let at = || format!("eval {value:?}, pdf {pdf} for wi {wi}, {mode:?}, {}", self.shown());
            hold("eval is finite and not negative", is_amount(&value), at)?;
            hold("pdf is finite and not negative", pdf >= 0.0 && pdf.is_finite(), at)?;
            hold("where eval is positive, so is pdf", value.is_black() || pdf > 0.0, at)?;
            let connectible = vertex.is_connectible() || value.is_black();
            hold("eval is zero where a vertex is not connectible", connectible, at)?;
            let both = vertex.eval_pdf(wi, mode);
            let shown = || format!("eval_pdf is {both:?}, {}", at());
            hold(
                "eval_pdf is eval and pdf",
                alike(&both.0, &value, 1e-5) && near(both.1.into(), pdf.into(), 1e-5),
                shown,
            )?;
            let again = (vertex.eval(wi, mode), vertex.pdf_solid_angle(wi, mode));
            hold("the same direction gives the same values", again == (value, pdf), || {
                format!("{again:?}, then {}", at())
            })?;
        }
        self.lambertian(wi)?;
        let reversed = vertex.reversed(wi);
        let same = reversed.wo() == wi && reversed.point().position == vertex.point().position;
        let shown = || format!("wo {}, point {:?} for wi {wi}", reversed.wo(), reversed.point());
        hold("reversed is the same point seen from wi", same, shown)?;
        let ray = vertex.spawn_ray(wi);
        let near = ray.origin.distance(vertex.point().position) <= 4.0 * vertex.point().error;
        let shown = || format!("{ray:?} for wi {wi}, {:?}", vertex.point());
        hold("a ray leaves the point in its direction", near && ray.direction == wi, shown)?;
        if self.adjoint { self.adjoint(wi, &reversed) } else { Ok(()) }
    }

    /// (4)
    fn adjoint(&self, wi: Vec3A, reversed: &V) -> Law {
        let (vertex, wo) = (self.vertex, self.vertex.wo());
        let cosines = [wi, wo].map(|w| self.cosine(w));
        let shading = [wi, wo].map(|w| w.dot(vertex.shading_normal()).abs());
        if cosines.iter().chain(&shading).any(|&cosine| cosine < GRAZING) && vertex.point().normal != Vec3A::ZERO {
            return Ok(());
        }
        let radiance = vertex.eval(wi, TransportMode::Radiance) * (1.0 / cosines[0]);
        let importance = reversed.eval(wo, TransportMode::Importance) * (1.0 / cosines[1]);
        let shown = || format!("{radiance:?} and {importance:?} for wi {wi}, {}", self.shown());
        let tiny = components(&(radiance - importance)).iter().all(|c| c.abs() <= 1e-5);
        let law = "adjoint: radiance from wi to wo is what importance sees from wo to wi";
        hold(law, tiny || alike(&radiance, &importance, self.tolerance), shown)
    }

    fn lambertian(&self, wi: Vec3A) -> Law {
        let (vertex, normal) = (self.vertex, self.vertex.point().normal);
        let Some(constant) = vertex.lambertian() else { return Ok(()) };
        // Which side a grazing direction is on is a matter of round-off.
        if self.cosine(wi) < 1e-4 || self.cosine(vertex.wo()) < 1e-4 {
            return Ok(());
        }
        let same_side = wi.dot(normal) * vertex.wo().dot(normal) > 0.0;
        let expected = if same_side { constant * self.cosine(wi) } else { V::Spectrum::ZERO };
        for mode in MODES {
            let value = vertex.eval(wi, mode);
            let shown = || format!("{value:?}, not {expected:?}, for wi {wi}, {mode:?}, {}", self.shown());
            hold("lambertian is the constant that eval is made of", alike(&value, &expected, self.tolerance), shown)?;
        }
        Ok(())
    }

    /// (3)
    fn sample(&self, u: [f32; 3], mode: TransportMode) -> Law {
        let vertex = self.vertex;
        let Some(sample) = vertex.sample(u, mode) else { return Ok(()) };
        let at = || format!("{sample:?} of {u:?}, {mode:?}, {}", self.shown());
        let again = vertex.sample(u, mode);
        hold("the same numbers give the same sample", again.as_ref() == Some(&sample), || {
            format!("{again:?}, then {}", at())
        })?;
        let ScatterSample { wi, ref throughput, pdf_solid_angle, is_specular, eta } = sample;
        hold("samples have unit length", is_unit(wi), at)?;
        hold("throughput is finite and not negative", is_amount(throughput), at)?;
        hold("eta is finite and positive", eta.is_finite() && eta > 0.0, at)?;
        if is_specular {
            return self.direction(wi);
        }
        hold(
            "the density of a sample is finite and positive",
            pdf_solid_angle.is_finite() && pdf_solid_angle > 0.0,
            at,
        )?;
        hold("what is not connectible has specular samples only", vertex.is_connectible(), at)?;
        self.direction(wi)?;
        let grazing = [wi, vertex.wo()]
            .iter()
            .any(|w| self.cosine(*w) < GRAZING || w.dot(vertex.shading_normal()).abs() < GRAZING);
        if grazing && vertex.point().normal != Vec3A::ZERO {
            return Ok(());
        }
        let (value, pdf) = vertex.eval_pdf(wi, mode);
        let shown = || format!("pdf {pdf} for {}", at());
        hold("pdf is the density of the sample", near(pdf.into(), pdf_solid_angle.into(), self.tolerance), shown)?;
        let product = *throughput * pdf_solid_angle;
        let shown = || format!("{product:?} and {value:?} for {}", at());
        hold("throughput times density is eval", alike(&product, &value, self.tolerance), shown)
    }

    /// With the geometric normal; 1 for points in space.
    fn cosine(&self, w: Vec3A) -> f32 {
        let normal = self.vertex.point().normal;
        if normal == Vec3A::ZERO { 1.0 } else { w.dot(normal).abs() }
    }

    fn shown(&self) -> String {
        let (vertex, point) = (self.vertex, self.vertex.point());
        format!("wo {}, normal {}, shading normal {}", vertex.wo(), point.normal, vertex.shading_normal())
    }
}
