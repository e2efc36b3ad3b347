//! The metallic-roughness model against the formulas of glTF's appendix B, written down once more in f64; its energy.

use std::f64::consts::PI;

use scene_core::glam::{DVec3, Vec3A};
use scene_core::material::{Material, MaterialError};
use scene_core::{Rgb, TransportMode};

use crate::cases::{BLUE, RED, metallic_roughness};
use crate::laws::{cube, direction};

/// Sections B.3.2 to B.3.4, with the visibility `V = G / (4 N.L N.V)`, and the mixture of B.2.
fn appendix_b(base: Rgb, metallic: f64, roughness: f64, v: Vec3A, l: Vec3A) -> [f64; 3] {
    let (v, l) = (v.as_dvec3(), l.as_dvec3());
    let h = (v + l).normalize();
    let alpha2 = roughness.powi(4);
    let d = alpha2 / (PI * (h.z * h.z * (alpha2 - 1.0) + 1.0).powi(2));
    let visibility = |w: DVec3| 1.0 / (w.z + (alpha2 + (1.0 - alpha2) * w.z * w.z).sqrt());
    let specular = visibility(l) * visibility(v) * d;
    let fresnel = |f0: f64| f0 + (1.0 - f0) * (1.0 - v.dot(h)).powi(5);
    base.to_array().map(f64::from).map(|base| {
        let dielectric = (1.0 - fresnel(0.04)) * base / PI + fresnel(0.04) * specular;
        metallic * fresnel(base) * specular + (1.0 - metallic) * dielectric
    })
}

#[test]
fn values_are_those_of_the_specification() {
    for (base, metallic, roughness) in [(RED, 0.0, 0.5), (BLUE, 1.0, 0.3), (RED, 0.4, 0.8), (BLUE, 0.7, 1.0)] {
        let material = metallic_roughness(base, metallic, roughness).compile().unwrap();
        let bsdf = material.resolve([0.0; 2]);
        for i in 0..500 {
            let ([a, b, c], [d, _, _]) = (cube(2 * i), cube(2 * i + 1));
            let (wo, wi) = (direction(0.01 + 0.99 * a, b), direction(0.01 + 0.99 * c, d));
            let value = bsdf.eval(wo, wi, TransportMode::Radiance);
            let expected = appendix_b(base, f64::from(metallic), f64::from(roughness), wo, wi);
            for k in 0..3 {
                let expected = expected[k] * f64::from(wi.z);
                let error = (f64::from(value[k]) - expected).abs();
                assert!(error < 1e-4 * expected + 1e-6, "{base:?} {metallic} {roughness} {wo} {wi}: {value:?}");
            }
        }
    }
}

/// Textures give roughness in green and metalness in blue.
#[test]
fn components_of_the_texture_have_their_meaning() {
    let textured = Material::MetallicRoughness {
        base_color: RED.into(),
        metallic_roughness: Rgb::new(0.9, 0.5, 0.25).into(),
        metallic: 0.8,
        roughness: 0.6,
        ior: 1.5,
        specular: 1.0,
        specular_color: Rgb::ONE,
    };
    let [textured, plain] = [textured, metallic_roughness(RED, 0.2, 0.3)].map(|m| m.compile().unwrap());
    let (wo, wi) = (direction(0.7, 0.1), direction(0.6, 0.55));
    let [a, b] = [&textured, &plain].map(|m| m.resolve([0.0; 2]).eval(wo, wi, TransportMode::Radiance));
    assert!((a.0 - b.0).abs().max_element() < 1e-5, "{a:?} {b:?}");
    // Without the dielectric's reflection only the base is left.
    let mut base = metallic_roughness(RED, 0.0, 0.3);
    if let Material::MetallicRoughness { specular, .. } = &mut base {
        *specular = 0.0;
    }
    let (base, diffuse) = (base.compile().unwrap(), Material::diffuse(RED).compile().unwrap());
    let [a, b] = [&base, &diffuse].map(|m| m.resolve([0.0; 2]).eval_pdf(wo, wi, TransportMode::Radiance));
    assert!((a.0.0 - b.0.0).abs().max_element() < 1e-6 && (a.1 - b.1).abs() < 1e-6, "{a:?} {b:?}");
}

/// Mean throughput of samples.
fn furnace(material: &Material, cos: f32) -> f64 {
    let material = material.clone().compile().unwrap();
    let bsdf = material.resolve([0.0; 2]);
    let (n, wo) = (20_000, direction(cos, 0.1));
    let samples = (0..n).filter_map(|i| bsdf.sample(wo, cube(i), TransportMode::Importance));
    samples.map(|s| f64::from(s.throughput.0.max_element())).sum::<f64>() / n as f64
}

#[test]
fn metals_conserve_energy_and_white_dielectrics_gain_where_documented() {
    for roughness in [0.0, 0.1, 0.5, 1.0] {
        for cos in [1.0, 0.5, 0.1, 0.01] {
            let metal = furnace(&metallic_roughness(Rgb::ONE, 1.0, roughness), cos);
            assert!(metal <= 1.002 && (roughness > 0.0 || metal > 0.97), "{roughness} {cos}: {metal}");
            let dielectric = furnace(&metallic_roughness(Rgb::ONE, 0.0, roughness), cos);
            let limit = if cos >= 0.5 { 1.03 } else { 1.95 };
            assert!(dielectric > 0.8 && dielectric < limit, "{roughness} {cos}: {dielectric}");
        }
    }
}

#[test]
fn bad_parameters_are_named() {
    let refused = |change: fn(&mut Material)| {
        let mut material = metallic_roughness(RED, 0.5, 0.5);
        change(&mut material);
        match material.compile().unwrap_err() {
            MaterialError::Parameter { material: "metallicroughness", parameter, .. } => parameter,
            other => panic!("{other}"),
        }
    };
    macro_rules! with {
        ($field:ident = $value:expr) => {
            refused(|m| {
                if let Material::MetallicRoughness { $field, .. } = m {
                    *$field = $value
                }
            })
        };
    }
    assert_eq!(with!(metallic = f32::NAN), "metallic");
    assert_eq!(with!(roughness = -0.1), "roughness");
    assert_eq!(with!(ior = 0.5), "ior");
    assert_eq!(with!(specular = 2.0), "specular");
    assert_eq!(with!(specular_color = Rgb::splat(-1.0)), "specular_color");
    assert_eq!(with!(base_color = 1.5.into()), "base_color");
}
