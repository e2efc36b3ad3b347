//! Virtual point lights against plain sums and closed forms.
#![allow(clippy::unwrap_used)]

use estimator_checks::{Moments, Suite, mean_is};
use proptest::prelude::*;
use qmc_sampling::{Independent, SamplerFamily};
use scene_core::builtin::{self, SceneBuilder};
use scene_core::glam::Vec3A;
use scene_core::material::Material;
use scene_core::reference::SceneVertex;
use scene_core::{
    Emitter, PowerChoice, Ray, ReferenceScene, Rgb, RussianRoulette, Scene, Sensor, Spectrum, TransportMode, Vertex,
};
use vpl_gi::{
    LightKind, LightTracing, Partition, VirtualPointLights, geometry_term, openness, photon_cloud, unshadowed,
};

static SUITE: Suite = Suite::with_share("vpl-gi", 3, 4e-9);

/// The Cornell box, as it is or with glossy blocks and coated walls, so that no light path is diffuse throughout.
fn scenes() -> Vec<ReferenceScene> {
    let mut glossy = builtin::cornell_box();
    let plastic = Material::RoughPlastic {
        int_ior: 1.5,
        ext_ior: 1.0,
        diffuse_reflectance: Rgb::new(0.6, 0.3, 0.2).into(),
        specular_reflectance: 1.0.into(),
        nonlinear: false,
        distribution: scene_core::material::Distribution::Ggx,
        alpha: 0.2,
    };
    if let Some(material) = glossy.materials.first_mut() {
        *material = plastic;
    }
    [builtin::cornell_box(), glossy].map(|description| ReferenceScene::new(description).unwrap()).into()
}

fn tracing(scene: &ReferenceScene) -> LightTracing<PowerChoice> {
    let choice = PowerChoice::new(scene.emitters());
    LightTracing { choice, max_length: 8, roulette: RussianRoulette::LocalAlbedo { from_length: 0 } }
}

fn lights<'s>(scene: &'s ReferenceScene, paths: u32) -> VirtualPointLights<SceneVertex<'s>> {
    let numbers = Independent::new(11);
    VirtualPointLights::trace(scene, &tracing(scene), paths, |path| numbers.sampler(0, u64::from(path)))
}

fn seen(scene: &ReferenceScene, [u, v]: [f32; 2]) -> Option<SceneVertex<'_>> {
    let [width, height] = scene.sensor().resolution();
    scene.intersect(&scene.sensor().sample_ray([u * width as f32, v * height as f32], [0.5; 2]).ray)
}

/// Equation 1 with what it lacks, light by light.
fn plain(
    scene: &ReferenceScene,
    x: &SceneVertex<'_>,
    lights: &VirtualPointLights<SceneVertex<'_>>,
    partition: &Partition,
) -> Rgb {
    let mut sum = Rgb::ZERO;
    for light in lights.as_slice() {
        let y = light.point().unwrap();
        let between = y.position - x.point().position;
        let (d2, wi) = (between.length_squared(), between.normalize());
        let g = geometry_term(x.point().position, x.point().normal, y.position, y.normal);
        let intensity = match &light.kind {
            LightKind::Emission { emitter, point } => {
                scene.emitters()[emitter.index()].radiance(Some(point), -wi) * point.normal.dot(wi).abs()
            }
            LightKind::Surface(vertex) => vertex.eval(-wi, TransportMode::Importance),
            LightKind::Delta { .. } | LightKind::Distant { .. } => unreachable!("the box has one lamp"),
        };
        sum += x.eval(wi, TransportMode::Radiance) * intensity * light.scale * (partition.share(g, d2) / d2);
    }
    sum
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn the_shading_loop_is_the_plain_sum(u in 0.0f32..1.0, v in 0.0f32..1.0, exponent in -24i32..0) {
        let threshold = 2f32.powi(exponent);
        for scene in scenes() {
            let lights = lights(&scene, 40);
            let Some(x) = seen(&scene, [u, v]) else { continue };
            for partition in [
                Partition::hard(threshold),
                Partition::soft(threshold),
                Partition::balance(threshold),
                Partition::distance(threshold),
                Partition::hard(f32::INFINITY),
            ] {
                let partition = partition.unwrap();
                let (fast, slow) = (unshadowed(&scene, &x, &lights, &partition), plain(&scene, &x, &lights, &partition));
                let difference = (fast - slow).0.abs().max_element();
                // A light whose geometry term is the threshold's up to round-off may be on either side of it.
                let close = |light: &vpl_gi::VirtualPointLight<SceneVertex<'_>>| {
                    let y = light.point().unwrap();
                    let g = geometry_term(x.point().position, x.point().normal, y.position, y.normal);
                    let inverse = 1.0 / y.position.distance_squared(x.point().position);
                    [g, inverse].iter().any(|value| (value / threshold - 1.0).abs() < 1e-5)
                };
                if !lights.as_slice().iter().any(close) {
                    prop_assert!(difference <= 2e-5 * slow.0.max_element().max(1e-6), "{partition:?} {fast:?} {slow:?}");
                }
            }
        }
    }
}

/// Photons of the same light paths make the same lights.
#[test]
fn a_cloud_of_all_photons_is_the_light_paths() {
    for scene in scenes() {
        let (paths, tracing) = (60, tracing(&scene));
        let traced = lights(&scene, paths);
        let photons = traced.as_slice().iter().filter_map(|light| match &light.kind {
            LightKind::Surface(vertex) => Some((*vertex, light.scale * paths as f32, light.length)),
            _ => None,
        });
        let numbers = Independent::new(11);
        let sampler = |path: u32| numbers.sampler(0, u64::from(path));
        let cloud = photon_cloud(&scene, &tracing, paths, photons, paths, sampler);
        assert_eq!((cloud.len(), cloud.paths()), (traced.len(), paths));
        let partition = Partition::hard(f32::INFINITY).unwrap();
        for k in 0..20 {
            let Some(x) = seen(&scene, [0.05 * k as f32, 0.37]) else { continue };
            let (a, b) = (unshadowed(&scene, &x, &cloud, &partition), unshadowed(&scene, &x, &traced, &partition));
            assert!((a - b).0.abs().max_element() <= 1e-4 * b.0.max_element().max(1e-6), "{a:?} {b:?}");
        }
    }
}

/// Half of the photons at twice the flux light as much, in the mean; at the same flux they do not.
#[test]
fn a_sparse_cloud_is_unbiased() {
    let scene = ReferenceScene::new(builtin::cornell_box()).unwrap();
    let x = seen(&scene, [0.5, 0.8]).unwrap();
    let partition = Partition::soft(1e-5).unwrap();
    let tracing = tracing(&scene);
    let (mut right, mut wrong) = (Moments::new(), Moments::new());
    for batch in 0..4000u64 {
        let numbers = Independent::new(estimator_checks::seed("sparse cloud").wrapping_add(batch));
        let sampler = |path: u32| numbers.sampler(0, u64::from(path));
        let all = VirtualPointLights::trace(&scene, &tracing, 4, sampler);
        let kept = |light: &&vpl_gi::VirtualPointLight<SceneVertex<'_>>| light.length > 0;
        let thinned: Vec<_> = all
            .as_slice()
            .iter()
            .filter(kept)
            .enumerate()
            .filter(|(k, _)| (k + batch as usize).is_multiple_of(2))
            .collect();
        for (moments, gain) in [(&mut right, 2.0), (&mut wrong, 1.0)] {
            let photons = thinned.iter().filter_map(|(_, light)| match &light.kind {
                LightKind::Surface(vertex) => Some((*vertex, light.scale * (4.0 * gain), light.length)),
                _ => None,
            });
            let cloud = photon_cloud(&scene, &tracing, 4, photons, 4, sampler);
            let lit = |lights: &VirtualPointLights<SceneVertex<'_>>| {
                f64::from(unshadowed(&scene, &x, lights, &partition).luminance())
            };
            moments.push(lit(&cloud) - lit(&all));
        }
    }
    mean_is(SUITE.check("sparse cloud"), &right, 0.0).expect_pass();
    mean_is(SUITE.twin("sparse cloud at half the flux"), &wrong, 0.0).expect_reject();
}

/// Below a large ceiling at height `h`, `G = cos^4 / h^2 < t` where `cos < sqrt(h sqrt(t))`: the open part is `h sqrt(t)`.
#[test]
fn openness_below_a_ceiling() {
    let mut b = SceneBuilder::new("ceiling");
    let grey = b.diffuse(0.5, 0.5, 0.5);
    b.quad(grey, Vec3A::new(-1e3, 0.0, -1e3), Vec3A::Z * 2e3, Vec3A::X * 2e3);
    b.quad(grey, Vec3A::new(-1e3, 2.0, -1e3), Vec3A::X * 2e3, Vec3A::Z * 2e3);
    let scene = ReferenceScene::new(b.finish()).unwrap();
    let floor = scene.intersect(&Ray::new(Vec3A::Y, -Vec3A::Y)).unwrap();
    let open = |threshold: f32| {
        let partition = Partition::hard(threshold).unwrap();
        let numbers = Independent::new(estimator_checks::seed("openness"));
        let mut moments = Moments::new();
        for index in 0..20_000 {
            moments.push(f64::from(openness(&scene, &floor, &partition, &mut numbers.sampler(0, index))));
        }
        moments
    };
    for (name, threshold, truth) in [("openness 0.3", 0.0225, 0.3), ("openness 0.8", 0.16, 0.8)] {
        mean_is(SUITE.check(name), &open(threshold), truth).expect_pass();
    }
    mean_is(SUITE.twin("openness of twice the threshold"), &open(0.045), 0.3).expect_reject();
    assert_eq!((open(1.0).mean(), open(0.0).mean()), (1.0, 0.0));
}

#[test]
fn nothing_to_light_with() {
    let mut b = SceneBuilder::new("dark");
    let grey = b.diffuse(0.5, 0.5, 0.5);
    b.sphere(grey, Vec3A::ZERO, 1.0);
    let scene = ReferenceScene::new(b.finish()).unwrap();
    let lights = lights(&scene, 8);
    assert!(lights.is_empty() && lights.paths() == 8);
    let x = scene.intersect(&Ray::new(Vec3A::Z * 3.0, -Vec3A::Z)).unwrap();
    assert_eq!(unshadowed(&scene, &x, &lights, &Partition::hard(1.0).unwrap()), Rgb::ZERO);
    // A light at the lit point itself contributes nothing, and no NaN.
    let mut lights = VirtualPointLights::new(1);
    let own = vpl_gi::VirtualPointLight::start(LightKind::Surface(x), Rgb::ONE);
    lights.push(&scene, own);
    for partition in
        [Partition::hard(1.0), Partition::soft(1.0), Partition::balance(1.0), Partition::hard(f32::INFINITY)]
    {
        assert_eq!(unshadowed(&scene, &x, &lights, &partition.unwrap()), Rgb::ZERO);
    }
    assert!(lights.bytes() > 0);
}
