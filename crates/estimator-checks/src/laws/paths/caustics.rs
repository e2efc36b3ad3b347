//! The laws of `CausticMap`.

use scene_core::glam::Vec3A;
use scene_core::medium::Medium;
use scene_core::{EmitterId, Ray, ScatterSample, Scene, Spectrum, SurfacePoint, TransportMode, Vertex};
use vpl_gi::CausticMap;

use crate::laws::scene::{components, is_amount};
use crate::laws::{Law, hold};
use crate::mean::{Truth, mean_is, same_mean_within};
use crate::moments::Moments;
use crate::outcome::{Outcome, Report};
use crate::seed::{Uniforms, seed};
use crate::suite::Check;

/// Of values in `f32`.
const ROUND_OFF: f64 = 1e-5;

/// Checks the laws of a map of caustics (the trait `CausticMap` of crate `vpl-gi`) at a vertex `x`.
///
/// ```text
/// (1)  radiance(x) is finite and not negative
/// (2)  radiance(x) = 0 if x has nothing but Dirac deltas
/// (3)  E[radiance(x)] = E[brute force]                                               Welch's t, each component
/// (4)  E[radiance(x)] is the same if x has its Dirac deltas taken away               t-test, each component
/// ```
///
/// The map is itself random, so an estimate: `map` makes one of several, with the seed that it is told, which follows from the check's name. A brute
/// force estimate of the radiance that `x` scatters towards `wo`, by the part of its BSDF without Dirac deltas, of light whose last scattering before `x` was a
/// Dirac delta, is the caller's, one sample from each stream of numbers; [`caustic_by_brute_force`] is one.
///
/// (1) and (2) are exact, for each map; the others share the level of the check, those of one run the components as well. A vertex that is
/// not connectible is asked for (1) and (2) alone, and (4) is a run of its own, [`without_deltas`](Self::without_deltas), because not every
/// map can be asked about vertices of another type. Means may differ by `bias`, relative to the brute force: none unless set, but density
/// estimation has one.
///
/// Assumes that there are enough maps and samples for normal means. An estimate that is nearly always zero has to be sampled
/// more often than the default.
///
/// ```
/// use estimator_checks::{Check, laws::paths::{CausticLaws, caustic_by_brute_force}};
/// use scene_core::{ReferenceScene, Scene, Sensor, builtin};
/// use vpl_gi::NoCaustics;
///
/// // There are no caustics where nothing is specular.
/// let scene = ReferenceScene::new(builtin::furnace_box(0.5, 1.0))?;
/// let x = scene.intersect(&scene.sensor().sample_ray([10.0; 2], [0.5; 2]).ray).expect("a wall");
/// let brute_force = |numbers: &mut _| caustic_by_brute_force(&scene, &x, 4, numbers);
/// let laws = CausticLaws::new().samples(1000);
/// laws.run(Check::new("no caustics", 1e-6)?, &x, |_| NoCaustics, brute_force).expect_pass();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct CausticLaws {
    maps: u64,
    samples: usize,
    bias: f64,
}

impl Default for CausticLaws {
    fn default() -> Self {
        Self::new()
    }
}

impl CausticLaws {
    /// 64 maps, 100 000 samples of the brute force estimate, no bias.
    #[must_use]
    pub fn new() -> Self {
        Self { maps: 64, samples: 100_000, bias: 0.0 }
    }

    /// How many maps.
    #[must_use]
    pub fn maps(self, maps: u64) -> Self {
        Self { maps, ..self }
    }

    /// How many samples of the brute force estimate.
    #[must_use]
    pub fn samples(self, samples: usize) -> Self {
        Self { samples, ..self }
    }

    /// By how much the mean of the maps may be off, relative to the brute force estimate.
    #[must_use]
    pub fn bias(self, bias: f64) -> Self {
        Self { bias, ..self }
    }

    /// One for each map.
    fn seeds(&self, check: &Check) -> impl Iterator<Item = u64> + use<> {
        let first = seed(&format!("{}: maps", check.test()));
        (0..self.maps).map(move |n| first.wrapping_add(n))
    }

    /// Checks (1) to (3).
    #[must_use = "it decides nothing until it is expected to pass or to reject"]
    pub fn run<X: Vertex, M: CausticMap<X>>(
        &self,
        check: Check,
        x: &X,
        mut map: impl FnMut(u64) -> M,
        mut brute_force: impl FnMut(&mut Uniforms) -> X::Spectrum,
    ) -> Report {
        let mut found = of_components::<X::Spectrum>();
        let laws = self.seeds(&check).try_for_each(|seed| {
            let radiance = map(seed).radiance(x);
            amount(x, seed, &radiance)?;
            push(&mut found, &radiance);
            Ok(())
        });
        let mut report = Report::from(Outcome::of_laws(check.test(), laws as Law));
        if !report.passed() || !x.is_connectible() {
            return report;
        }
        let (mut uniforms, mut truth) = (check.uniforms(), of_components::<X::Spectrum>());
        (0..self.samples).for_each(|_| push(&mut truth, &brute_force(&mut uniforms)));
        for ((check, found), truth) in by_component::<X::Spectrum>(&check).into_iter().zip(&found).zip(&truth) {
            let allowance = (self.bias + ROUND_OFF) * truth.mean().abs();
            report.outcomes.push(same_mean_within(check, found, truth, allowance));
        }
        report
    }

    /// Checks (1), (2) and (4): what the map says of `x` is what it says of `x` without its Dirac deltas.
    #[must_use = "it decides nothing until it is expected to pass or to reject"]
    pub fn without_deltas<X: Vertex, M: CausticMap<X> + CausticMap<WithoutDeltas<X>>>(
        &self,
        check: Check,
        x: &X,
        mut map: impl FnMut(u64) -> M,
    ) -> Report {
        let bare = WithoutDeltas(x.clone());
        let (mut differences, mut sizes) = (of_components::<X::Spectrum>(), of_components::<X::Spectrum>());
        let laws = self.seeds(&check).try_for_each(|seed| {
            let map = map(seed);
            let (whole, without) = (map.radiance(x), map.radiance(&bare));
            amount(x, seed, &whole)?;
            amount(&bare, seed, &without)?;
            push(&mut differences, &(whole - without));
            push(&mut sizes, &whole);
            Ok(())
        });
        let mut report = Report::from(Outcome::of_laws(check.test(), laws as Law));
        if report.passed() {
            let parts = by_component::<X::Spectrum>(&check).into_iter();
            for ((check, difference), size) in parts.zip(&differences).zip(&sizes) {
                let truth = Truth { value: 0.0, error: ROUND_OFF * size.mean() };
                report.outcomes.push(mean_is(check, difference, truth));
            }
        }
        report
    }
}

/// (1) and (2)
fn amount<X: Vertex>(x: &X, map: u64, radiance: &X::Spectrum) -> Law {
    let shown = || format!("the map with seed {map} says {radiance:?} at {}", x.point().position);
    hold("the radiance of caustics is finite and not negative", is_amount(radiance), shown)?;
    let dark = x.is_connectible() || radiance.is_black();
    hold("there are no caustics where there is nothing but Dirac deltas", dark, shown)
}

fn of_components<S: Spectrum>() -> Vec<Moments> {
    vec![Moments::new(); S::COMPONENTS]
}

fn push<S: Spectrum>(moments: &mut [Moments], value: &S) {
    moments.iter_mut().zip(components(value)).for_each(|(moments, c)| moments.push(c));
}

fn by_component<S: Spectrum>(check: &Check) -> Vec<Check> {
    check.parts((0..S::COMPONENTS).map(|c| format!("component {c}")))
}

/// One sample of the radiance that `x` scatters towards `wo`, by the part of its BSDF without Dirac deltas, of light whose last
/// scattering before `x` was a Dirac delta: what a `CausticMap` says.
///
/// ```text
/// L = f g / p  of x, not specular  *  throughput of the next vertex, specular  *  radiance that arrives there, by path tracing
/// ```
///
/// **Unbiased** for paths of at most `max_depth` segments beyond `x`, but for light of Dirac emitters: rays do not hit them. **Cost.** One path;
/// the variance is that of hitting the specular surface, and then the light, by chance.
pub fn caustic_by_brute_force<S: Scene>(
    scene: &S,
    x: &impl Vertex<Spectrum = S::Spectrum>,
    max_depth: u32,
    uniforms: &mut Uniforms,
) -> S::Spectrum {
    let mut radiance = S::Spectrum::ZERO;
    let Some((mut ray, first)) = scatter(x, uniforms).filter(|(_, sample)| !sample.is_specular) else {
        return radiance;
    };
    let mut throughput = first.throughput;
    for segment in 1..=max_depth {
        // Light that comes straight is none of a caustic.
        let counts = segment > 1;
        let Some(vertex) = scene.intersect(&ray) else {
            let outside = if counts { scene.environment_radiance(ray.direction) } else { S::Spectrum::ZERO };
            return radiance + throughput * outside;
        };
        if counts {
            radiance += throughput * vertex.emitted();
        }
        let Some((next, sample)) = scatter(&vertex, uniforms) else { return radiance };
        if segment == 1 && !sample.is_specular {
            return radiance;
        }
        throughput *= sample.throughput;
        ray = next;
    }
    radiance
}

fn scatter<X: Vertex>(vertex: &X, uniforms: &mut Uniforms) -> Option<(Ray, ScatterSample<X::Spectrum>)> {
    let sample = vertex.sample(uniforms.array().map(|u| u as f32), TransportMode::Radiance)?;
    Some((vertex.spawn_ray(sample.wi), sample))
}

/// A vertex that has lost the Dirac deltas of its scattering function: they are absorbed.
#[derive(Clone, Debug)]
pub struct WithoutDeltas<X>(pub X);

impl<X: Vertex> Vertex for WithoutDeltas<X> {
    type Spectrum = X::Spectrum;

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
    fn emitted(&self) -> Self::Spectrum {
        self.0.emitted()
    }
    fn is_connectible(&self) -> bool {
        self.0.is_connectible()
    }
    fn eval(&self, wi: Vec3A, mode: TransportMode) -> Self::Spectrum {
        self.0.eval(wi, mode)
    }
    fn pdf_solid_angle(&self, wi: Vec3A, mode: TransportMode) -> f32 {
        self.0.pdf_solid_angle(wi, mode)
    }
    fn sample(&self, u: [f32; 3], mode: TransportMode) -> Option<ScatterSample<Self::Spectrum>> {
        self.0.sample(u, mode).filter(|sample| !sample.is_specular)
    }
    fn albedo(&self) -> Self::Spectrum {
        self.0.albedo()
    }
    fn reversed(&self, wi: Vec3A) -> Self {
        Self(self.0.reversed(wi))
    }
    fn lambertian(&self) -> Option<Self::Spectrum> {
        self.0.lambertian()
    }
    fn medium(&self, wi: Vec3A, current: Option<Medium<Self::Spectrum>>) -> Option<Medium<Self::Spectrum>> {
        self.0.medium(wi, current)
    }
    fn eval_pdf(&self, wi: Vec3A, mode: TransportMode) -> (Self::Spectrum, f32) {
        self.0.eval_pdf(wi, mode)
    }
    fn spawn_ray(&self, wi: Vec3A) -> Ray {
        self.0.spawn_ray(wi)
    }
}
