//! Nothing is infinite or no number, whatever the directions; samples agree with values.

use std::sync::LazyLock;

use proptest::prelude::*;
use scene_core::glam::Vec3A;
use scene_core::material::{CompiledMaterial, Distribution, Material};
use scene_core::{Spectrum, TransportMode};

use crate::cases;

fn unit() -> impl Strategy<Value = Vec3A> {
    let special = prop_oneof![
        Just(Vec3A::X),
        Just(-Vec3A::Y),
        Just(Vec3A::Z),
        Just(-Vec3A::Z),
        Just(Vec3A::new(1.0, 0.0, 1e-20)),
        Just(Vec3A::new(0.0, -1.0, 1e-7)),
        Just(Vec3A::new(-1.0, 0.0, -1e-38)),
        Just(Vec3A::new(0.6, 0.8, 1e-4)),
    ];
    let any = (-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0)
        .prop_map(|(x, y, z)| Vec3A::new(x, y, z).try_normalize().unwrap_or(Vec3A::Z));
    let grazing = (-1.0f32..1.0, -1.0f32..1.0, -1e-3f32..1e-3)
        .prop_map(|(x, y, z)| Vec3A::new(x, y, z).try_normalize().unwrap_or(Vec3A::X));
    prop_oneof![2 => any, 1 => grazing, 1 => special]
}

fn pair() -> impl Strategy<Value = (Vec3A, Vec3A)> {
    (unit(), unit(), 0..4).prop_map(|(wo, wi, relation)| match relation {
        0 => (wo, -wo),
        1 => (wo, Vec3A::new(-wo.x, -wo.y, wo.z)),
        _ => (wo, wi),
    })
}

fn number() -> impl Strategy<Value = f32> {
    prop_oneof![4 => 0.0f32..1.0, 1 => Just(0.0), 1 => Just(0.5), 1 => Just(1.0 - f32::EPSILON / 2.0)]
}

/// The cases, and smoother and rougher ones.
static MATERIALS: LazyLock<Vec<(String, CompiledMaterial)>> = LazyLock::new(|| {
    let named = cases::SCATTERING.iter().chain(&cases::DELTA).map(|name| ((*name).to_owned(), cases::material(name)));
    let mut all: Vec<(String, Material)> = named.collect();
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        for alpha in [[0.0, 0.0], [1e-3, 1e-3], [0.0, 1.0], [2.0, 2.0]] {
            let name = format!("{distribution:?} {alpha:?}");
            all.push((format!("conductor {name}"), cases::rough_conductor("Cu", distribution, alpha)));
            all.push((format!("dielectric {name}"), cases::rough_dielectric(1.5, 1.0, distribution, alpha)));
        }
    }
    all.into_iter().map(|(name, material)| (name, material.compile().unwrap())).collect()
});

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn everything_is_finite((wo, wi) in pair(), u in [number(), number(), number()]) {
        for (name, material) in MATERIALS.iter() {
            let bsdf = material.resolve([0.3, 0.4]);
            for mode in [TransportMode::Radiance, TransportMode::Importance] {
                let (value, pdf) = bsdf.eval_pdf(wo, wi, mode);
                prop_assert!(value.is_finite() && value.0.min_element() >= 0.0, "{name} {wo} {wi}: {value:?}");
                prop_assert!(pdf.is_finite() && pdf >= 0.0, "{name} {wo} {wi}: {pdf}");
                prop_assert!(value.is_black() || pdf > 0.0, "{name} {wo} {wi}: {value:?} {pdf}");
                prop_assert!(bsdf.albedo(wo).is_finite());
                let Some(sample) = bsdf.sample(wo, u, mode) else { continue };
                prop_assert!((sample.wi.length() - 1.0).abs() < 1e-3, "{name} {wo} {u:?}: {sample:?}");
                prop_assert!(sample.throughput.is_finite() && sample.throughput.0.min_element() >= 0.0);
                let bounded = name.contains("evaluateonly") || sample.throughput.max_component() < 10.0;
                prop_assert!(bounded, "{name} {wo} {u:?}: {sample:?}");
                prop_assert!(sample.pdf.is_finite() && sample.eta > 0.0, "{name} {wo} {u:?}: {sample:?}");
                prop_assert_eq!(sample.is_specular, sample.pdf == 0.0, "{} {} {:?}: {:?}", name, wo, u, sample);
            }
        }
    }

    #[test]
    fn samples_agree_with_values(wo in unit(), u in [1e-3f32..0.999, 1e-3f32..0.999, 1e-3f32..0.999]) {
        // Half vectors of grazing directions lose their digits.
        if wo.z.abs() < 1e-2 { return Ok(()) }
        for (name, material) in MATERIALS.iter().take(cases::SCATTERING.len()) {
            let bsdf = material.resolve([0.3, 0.4]);
            for mode in [TransportMode::Radiance, TransportMode::Importance] {
                let Some(sample) = bsdf.sample(wo, u, mode) else { continue };
                if sample.is_specular || sample.wi.z.abs() < 1e-2 { continue }
                let (value, pdf) = bsdf.eval_pdf(wo, sample.wi, mode);
                prop_assert!((pdf - sample.pdf).abs() <= 5e-3 * pdf + 1e-7, "{name} {wo} {u:?}: {pdf} {sample:?}");
                let product = sample.throughput * sample.pdf;
                let error = (value.0 - product.0).abs().max_element();
                prop_assert!(error <= 5e-3 * value.max_component() + 1e-7, "{name} {wo} {u:?}: {value:?} {product:?}");
            }
        }
    }
}
