//! Evaluation and sampling of every scattering model. Throughput is in pairs of directions, or in samples.

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use lichtwerk_benches::directions;
use qmc_sampling::{Independent, Sampler, SamplerFamily};
use scene_core::glam::Vec3A;
use scene_core::material::{Bsdf, CompiledMaterial, Distribution, Material, conductors};
use scene_core::{Rgb, TransportMode};

/// Directions per iteration.
const DIRECTIONS: usize = 256;
const MODE: TransportMode = TransportMode::Radiance;

/// One material of each kind, and of each distribution where there are two.
fn materials() -> Vec<(&'static str, CompiledMaterial)> {
    let (eta, k) = conductors::named("Cu").expect("a name in the table");
    let one = || Rgb::ONE.into();
    let half = || Rgb::splat(0.5).into();
    let rough_conductor =
        |distribution, alpha| Material::RoughConductor { eta, k, specular_reflectance: one(), distribution, alpha };
    let rough_dielectric = |distribution| Material::RoughDielectric {
        int_ior: 1.5,
        ext_ior: 1.0,
        specular_reflectance: one(),
        specular_transmittance: one(),
        distribution,
        alpha: [0.2; 2],
    };
    let list = [
        ("diffuse", Material::diffuse(0.5)),
        ("diffuse, two-sided", Material::diffuse(0.5).two_sided()),
        ("conductor", Material::Conductor { eta, k, specular_reflectance: one() }),
        ("rough conductor, GGX", rough_conductor(Distribution::Ggx, [0.2; 2])),
        ("rough conductor, Beckmann", rough_conductor(Distribution::Beckmann, [0.2; 2])),
        ("rough conductor, GGX, anisotropic", rough_conductor(Distribution::Ggx, [0.1, 0.3])),
        (
            "dielectric",
            Material::Dielectric {
                int_ior: 1.5,
                ext_ior: 1.0,
                specular_reflectance: one(),
                specular_transmittance: one(),
            },
        ),
        ("rough dielectric, GGX", rough_dielectric(Distribution::Ggx)),
        ("rough dielectric, Beckmann", rough_dielectric(Distribution::Beckmann)),
        (
            "plastic",
            Material::Plastic {
                int_ior: 1.5,
                ext_ior: 1.0,
                diffuse_reflectance: half(),
                specular_reflectance: one(),
                nonlinear: true,
            },
        ),
        (
            "rough plastic, GGX",
            Material::RoughPlastic {
                int_ior: 1.5,
                ext_ior: 1.0,
                diffuse_reflectance: half(),
                specular_reflectance: one(),
                nonlinear: true,
                distribution: Distribution::Ggx,
                alpha: 0.2,
            },
        ),
        (
            "phong",
            Material::Phong {
                diffuse_reflectance: half(),
                specular_reflectance: Rgb::splat(0.3).into(),
                exponent: 50.0,
            },
        ),
        (
            "cook-torrance",
            Material::CookTorrance {
                diffuse_reflectance: half(),
                specular_reflectance: Rgb::splat(0.3).into(),
                ior: 1.5,
                alpha: 0.3,
            },
        ),
        ("mask", Material::Mask { opacity: Rgb::splat(0.5).into(), inner: Box::new(Material::diffuse(0.5)) }),
        ("evaluate only", Material::EvaluateOnly(Box::new(Material::diffuse(0.5)))),
    ];
    list.map(|(name, material)| (name, material.compile().expect("a valid material"))).into()
}

fn evaluate(criterion: &mut Criterion) {
    let directions = directions(DIRECTIONS);
    let mut group = criterion.benchmark_group("eval_pdf");
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1)).sample_size(20);
    group.throughput(Throughput::Elements(DIRECTIONS as u64));
    for (name, material) in materials().iter().filter(|(_, material)| material.is_connectible()) {
        let bsdf = material.resolve([0.0; 2]);
        group.bench_function(*name, |bencher| {
            bencher.iter(|| {
                let pairs = directions.iter().zip(directions.iter().rev());
                pairs.map(|(&wo, &wi)| black_box(&bsdf).eval_pdf(wo, wi, MODE).1).sum::<f32>()
            });
        });
    }
    group.finish();
}

fn sample(criterion: &mut Criterion) {
    let directions = directions(DIRECTIONS);
    let mut numbers = Independent::new(3).sampler(0, 0);
    let numbers: Vec<[f32; 3]> = directions
        .iter()
        .map(|_| {
            let [u, v] = numbers.next_2d();
            [numbers.next_1d(), u, v]
        })
        .collect();
    let height = |bsdf: &Bsdf<'_>, wo: Vec3A, u: [f32; 3]| bsdf.sample(wo, u, MODE).map_or(0.0, |s| s.wi.z);
    let mut group = criterion.benchmark_group("sample");
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1)).sample_size(20);
    group.throughput(Throughput::Elements(DIRECTIONS as u64));
    for (name, material) in &materials() {
        let bsdf = material.resolve([0.0; 2]);
        group.bench_function(*name, |bencher| {
            bencher.iter(|| {
                let inputs = directions.iter().zip(&numbers);
                inputs.map(|(&wo, &u)| height(black_box(&bsdf), wo, u)).sum::<f32>()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, evaluate, sample);
criterion_main!(benches);
