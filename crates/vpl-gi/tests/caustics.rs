//! A caustic map takes exactly what connections cannot reach.
#![allow(clippy::unwrap_used)]

use std::cell::Cell;

use estimator_checks::{Moments, Suite, same_mean};
use qmc_sampling::{Independent, Sampler, SamplerFamily};
use scene_core::builtin::SceneBuilder;
use scene_core::glam::Vec3A;
use scene_core::material::Material;
use scene_core::reference::SceneVertex;
use scene_core::{PowerChoice, ReferenceScene, Rgb, RussianRoulette, Scene, Sensor, Spectrum, TransportMode, Vertex};
use vpl_gi::{CausticMap, LightTracing, NoCaustics, Partition, RobustIgi, VirtualPointLights};

static SUITE: Suite = Suite::with_share("vpl-gi caustics", 1, 1e-9);

/// A glass ball between a large lamp and the floor, and a coated block.
fn scene() -> ReferenceScene {
    let mut b = SceneBuilder::new("caustic");
    let ground = b.diffuse(0.6, 0.6, 0.6);
    b.quad(ground, Vec3A::new(-3.0, 0.0, -3.0), Vec3A::Z * 6.0, Vec3A::X * 6.0);
    let glass = b.material(Material::glass(1.5));
    b.sphere(glass, Vec3A::new(0.0, 0.8, 0.0), 0.6);
    let coated = b.material(Material::Plastic {
        int_ior: 1.5,
        ext_ior: 1.0,
        diffuse_reflectance: Rgb::new(0.2, 0.3, 0.7).into(),
        specular_reflectance: 1.0.into(),
        nonlinear: false,
    });
    b.cuboid(coated, Vec3A::new(1.0, 0.3, 0.6), Vec3A::splat(0.3), 0.4);
    let lamp = b.diffuse(0.0, 0.0, 0.0);
    b.sphere(lamp, Vec3A::new(0.2, 3.2, 0.0), 0.8).emit(Rgb::splat(8.0));
    b.look(Vec3A::new(0.0, 2.0, 3.5), Vec3A::new(0.0, 0.0, 0.2), 45.0, 8, 8);
    ReferenceScene::new(b.finish()).unwrap()
}

fn path_tracing() -> RobustIgi {
    RobustIgi::new(Partition::hard(0.0).unwrap())
}

/// What a perfect caustic map would say, by one random ray.
struct BruteForce<'s> {
    scene: &'s ReferenceScene,
    numbers: Independent,
    next: Cell<u64>,
}

impl CausticMap<SceneVertex<'_>> for BruteForce<'_> {
    fn radiance(&self, x: &SceneVertex<'_>) -> Rgb {
        self.next.set(self.next.get() + 1);
        let mut sampler = self.numbers.sampler(9, self.next.get());
        let mut scatter = |vertex: &SceneVertex<'_>| {
            let (lobe, [u, v]) = (sampler.next_1d(), sampler.next_2d());
            vertex.sample([lobe, u, v], TransportMode::Radiance)
        };
        // By the part of x without Dirac deltas, to a vertex that scatters by one.
        let Some(first) = scatter(x).filter(|sample| !sample.is_specular) else { return Rgb::ZERO };
        let Some(vertex) = self.scene.intersect(&x.spawn_ray(first.wi)) else { return Rgb::ZERO };
        let Some(second) = scatter(&vertex).filter(|sample| sample.is_specular) else { return Rgb::ZERO };
        let nothing = VirtualPointLights::<SceneVertex<'_>>::new(1);
        let arriving = path_tracing().radiance(self.scene, &nothing, vertex.spawn_ray(second.wi), &mut sampler);
        first.throughput * second.throughput * arriving
    }
}

/// Means of images, each with light paths of its own.
fn images<'s>(
    name: &str,
    scene: &'s ReferenceScene,
    robust: RobustIgi,
    caustics: Option<&dyn CausticMap<SceneVertex<'s>>>,
) -> Moments {
    let numbers = Independent::new(estimator_checks::seed(name));
    let choice = PowerChoice::new(scene.emitters());
    let tracing =
        LightTracing { choice, max_length: u32::MAX, roulette: RussianRoulette::LocalAlbedo { from_length: 0 } };
    let mut means = Moments::new();
    for image in 0..60u64 {
        let mut sum = 0.0;
        for sample in 0..400u64 {
            let index = image * 400 + sample;
            let lights =
                VirtualPointLights::trace(scene, &tracing, 2, |path| numbers.sampler(1 + u64::from(path), index));
            let mut sampler = numbers.sampler(0, index);
            let raster = sampler.next_2d().map(|u| 8.0 * u);
            let ray = scene.sensor().sample_ray(raster, [0.5; 2]).ray;
            sum += f64::from(robust.trace(scene, &lights, caustics, ray, &mut sampler, &mut ()).luminance());
        }
        means.push(sum / 400.0);
    }
    means
}

#[test]
fn caustics_by_a_map_are_those_that_rays_find() {
    let scene = scene();
    let robust = RobustIgi::new(Partition::hard(10.0 / scene.bounding_sphere().1.powi(2)).unwrap());
    let truth = images("path tracing", &scene, path_tracing(), None);
    let map = BruteForce {
        scene: &scene,
        numbers: Independent::new(estimator_checks::seed("caustic map")),
        next: Cell::new(0),
    };
    let mapped = images("with a map", &scene, robust, Some(&map));
    same_mean(SUITE.check("caustic map"), &truth, &mapped).expect_pass();
    // Without them light is missing; with a map and rays that look for them too it would be there twice.
    let without = images("without", &scene, robust, Some(&NoCaustics));
    same_mean(SUITE.twin("caustics left out"), &mapped, &without).expect_reject();
}
