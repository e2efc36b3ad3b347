//! The reference scene's vertices keep the laws of the trait `Vertex`, where shading and geometric normals differ too.

#![cfg(feature = "reference")]
// Helper functions of tests may unwrap.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use estimator_checks::{ChiSquare, Sphere, Suite, Uniforms};
use proptest::prelude::*;
use scene_core::builtin::SceneBuilder;
use scene_core::glam::{Affine3A, Vec3A};
use scene_core::material::{Distribution, Material, conductors};
use scene_core::reference::SceneVertex;
use scene_core::texture::{Image, ImageTexture, Texture};
use scene_core::{Ray, ReferenceScene, Rgb, Scene, Spectrum, TransportMode, Vertex};

static SUITE: Suite = Suite::with_share("scene-core vertices", NAMES.len() * 2, 1e-8);

const MODES: [TransportMode; 2] = [TransportMode::Radiance, TransportMode::Importance];

const NAMES: [&str; 10] = [
    "diffuse",
    "bump-mapped diffuse",
    "strongly normal-mapped diffuse",
    "rough conductor",
    "normal-mapped rough conductor",
    "rough dielectric",
    "bump-mapped rough dielectric",
    "rough plastic",
    "two different sides",
    "mask",
];

fn texture(pixel: impl Fn(u32, u32) -> [f32; 3]) -> Texture {
    let pixels = (0..64).map(|k| pixel(k % 8, k / 8)).collect();
    ImageTexture::new(Arc::new(Image::from_rgb(8, 8, pixels).unwrap())).into()
}

fn material(name: &str) -> Material {
    let (eta, k) = conductors::named("Au").unwrap();
    let height = || texture(|x, y| [((5 * x + 3 * y) % 7) as f32 / 7.0; 3]);
    let conductor = Material::RoughConductor {
        eta,
        k,
        specular_reflectance: 1.0.into(),
        distribution: Distribution::Ggx,
        alpha: [0.3; 2],
    };
    let glass = Material::RoughDielectric {
        int_ior: 1.5,
        ext_ior: 1.0,
        specular_reflectance: 1.0.into(),
        specular_transmittance: 1.0.into(),
        distribution: Distribution::Ggx,
        alpha: [0.4; 2],
    };
    let diffuse = Material::diffuse(Rgb::new(0.7, 0.5, 0.2));
    let bump = |inner, scale| Material::BumpMap { height: height(), scale, inner: Box::new(inner) };
    let map = |inner, tilt: f32| Material::NormalMap {
        normals: texture(move |x, y| [0.5 + tilt * ((x % 3) as f32 - 1.0), 0.5 + tilt * ((y % 3) as f32 - 1.0), 0.8]),
        inner: Box::new(inner),
    };
    match name {
        "diffuse" => diffuse.two_sided(),
        "bump-mapped diffuse" => bump(diffuse.two_sided(), 0.05),
        "strongly normal-mapped diffuse" => map(diffuse.two_sided(), 0.5),
        "rough conductor" => conductor,
        "normal-mapped rough conductor" => map(conductor, 0.2),
        "rough dielectric" => glass,
        "bump-mapped rough dielectric" => bump(glass, 0.05),
        "rough plastic" => Material::RoughPlastic {
            int_ior: 1.5,
            ext_ior: 1.0,
            diffuse_reflectance: 0.6.into(),
            specular_reflectance: 1.0.into(),
            nonlinear: true,
            distribution: Distribution::Beckmann,
            alpha: 0.2,
        },
        "two different sides" => Material::TwoSided { front: Box::new(diffuse), back: Some(Box::new(conductor)) },
        _ => Material::Mask { opacity: height(), inner: Box::new(diffuse.two_sided()) },
    }
}

/// A coarse vase: its interpolated normals are up to 30 degrees from the triangles'.
fn vase(name: &str) -> ReferenceScene {
    let mut b = SceneBuilder::new(name);
    let material = b.material(material(name));
    b.lathe(material, Vec3A::ZERO, &[[0.3, 0.0], [0.8, 0.5], [0.7, 1.0], [0.3, 1.4], [0.5, 1.8]], 9);
    ReferenceScene::new(b.finish()).unwrap()
}

fn direction([x, y]: [f32; 2]) -> Vec3A {
    let z = 1.0 - 2.0 * x;
    let (sin, cos) = (std::f32::consts::TAU * y).sin_cos();
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3A::new(r * cos, r * sin, z)
}

/// Hits of the vase from all around, from outside and from inside.
fn hit<'s>(scene: &'s ReferenceScene, from: [f32; 2], to: [f32; 3]) -> Option<SceneVertex<'s>> {
    let target = Vec3A::new(to[0] - 0.5, 1.8 * to[1], to[2] - 0.5);
    let origin = Vec3A::Y + direction(from) * if to[0] < 0.3 { 0.2 } else { 4.0 };
    scene.intersect(&Ray::new(origin, (target - origin).normalize()))
}

fn valid(value: Rgb, pdf: f32) -> bool {
    value.is_finite() && value.0.min_element() >= 0.0 && pdf.is_finite() && pdf >= 0.0
}

fn unit() -> impl Strategy<Value = f32> {
    (0u32..1 << 24).prop_map(|x| x as f32 / (1u32 << 24) as f32)
}

fn square() -> impl Strategy<Value = [f32; 2]> {
    [unit(), unit()]
}

fn cube() -> impl Strategy<Value = [f32; 3]> {
    [unit(), unit(), unit()]
}

fn check_pair(name: &str, vertex: &SceneVertex<'_>, wi: Vec3A) -> Result<(), TestCaseError> {
    let normal = vertex.point().normal;
    for mode in MODES {
        let (value, pdf) = vertex.eval_pdf(wi, mode);
        prop_assert!(valid(value, pdf), "{} {:?} {}", name, value, pdf);
        prop_assert!(value.is_black() || pdf > 0.0, "{}: eval {:?} without density", name, value);
        prop_assert_eq!((value, pdf), (vertex.eval(wi, mode), vertex.pdf_solid_angle(wi, mode)));
    }
    // The adjoint law, but where a cosine with the geometric normal has lost its digits.
    let (cos_i, cos_o) = (wi.dot(normal).abs(), vertex.wo().dot(normal).abs());
    let reversed = vertex.reversed(wi);
    prop_assert_eq!((reversed.wo(), *reversed.point()), (wi, *vertex.point()));
    let opposite = wi.dot(vertex.shading_normal()) * vertex.wo().dot(vertex.shading_normal()) < 0.0;
    if cos_i > 1e-2 && cos_o > 1e-2 && !(name == "two different sides" && opposite) {
        let radiance = vertex.eval(wi, TransportMode::Radiance) * (1.0 / cos_i);
        let importance = reversed.eval(vertex.wo(), TransportMode::Importance) * (1.0 / cos_o);
        for c in 0..3 {
            let error = (radiance[c] - importance[c]).abs();
            prop_assert!(
                error <= 2e-3 * radiance[c].max(importance[c]) + 1e-4,
                "{} {:?} {:?}",
                name,
                radiance,
                importance
            );
        }
    }
    Ok(())
}

fn check_sample(name: &str, vertex: &SceneVertex<'_>, u: [f32; 3]) -> Result<(), TestCaseError> {
    for mode in MODES {
        let Some(sample) = vertex.sample(u, mode) else { continue };
        prop_assert!((sample.wi.length() - 1.0).abs() < 1e-5 && valid(sample.throughput, sample.pdf_solid_angle));
        prop_assert!(sample.eta > 0.0 && sample.eta.is_finite());
        if sample.is_specular {
            continue;
        }
        let (value, pdf) = vertex.eval_pdf(sample.wi, mode);
        // Grazing directions lose digits of the cosine on the way through the frame.
        if sample.wi.dot(vertex.shading_normal()).abs() < 1e-2 || vertex.wo().dot(vertex.shading_normal()).abs() < 1e-2
        {
            continue;
        }
        prop_assert!((pdf / sample.pdf_solid_angle - 1.0).abs() < 1e-2, "{} {} {:?}", name, pdf, sample);
        for c in 0..3 {
            let product = sample.throughput[c] * sample.pdf_solid_angle;
            let error = (product - value[c]).abs();
            prop_assert!(error <= 1e-2 * value[c] + 1e-5, "{} {:?} {:?}", name, sample, value);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]
    #[test]
    fn sampling_evaluation_and_adjoint_agree(which in 0..NAMES.len(), from in square(), to in cube(), w in square(), u in cube()) {
        thread_local! {
            static SCENES: Vec<ReferenceScene> = NAMES.iter().map(|name| vase(name)).collect();
        }
        SCENES.with(|scenes| {
            let Some(vertex) = hit(&scenes[which], from, to) else { return Ok(()) };
            let name = NAMES[which];
            prop_assert!((vertex.shading_normal().length() - 1.0).abs() < 1e-5);
            prop_assert!((vertex.point().normal.length() - 1.0).abs() < 1e-5);
            prop_assert!(vertex.albedo().0.min_element() >= 0.0 && vertex.albedo().0.max_element() <= 1.0);
            check_pair(name, &vertex, direction(w))?;
            check_sample(name, &vertex, u)?;
            if let Some(sample) = vertex.sample(u, TransportMode::Radiance) {
                check_pair(name, &vertex, sample.wi)?;
            }
            // Exactly along normals and tangents.
            for wi in [vertex.point().normal, vertex.shading_normal(), vertex.wo(), vertex.point().normal.any_orthonormal_vector()] {
                check_pair(name, &vertex, wi)?;
                check_pair(name, &vertex, -wi)?;
            }
            Ok(())
        })?;
    }
}

/// What the proptest assumes: the normals differ, and pairs of directions between them occur.
#[test]
fn interpolated_normals_stay_on_the_geometric_side() {
    let mut uniforms = Uniforms::named("normals");
    for name in NAMES {
        let scene = vase(name);
        let (mut between, mut hits) = (0, 0);
        for _ in 0..4000 {
            let u = uniforms.array::<7>().map(|x| x as f32);
            let Some(vertex) = hit(&scene, [u[0], u[1]], [u[2], u[3], u[4]]) else { continue };
            let wi = direction([u[5], u[6]]);
            let (geometric, shading) = (vertex.point().normal, vertex.shading_normal());
            assert!(geometric.dot(shading) > 0.0 || name.contains("strongly"), "{name}: {geometric} {shading}");
            between += u32::from(wi.dot(geometric) * wi.dot(shading) < 0.0);
            hits += 1;
        }
        assert!(hits > 1000 && between > 20, "{name}: {hits} {between}");
    }
}

#[test]
fn samples_follow_their_density() {
    for name in NAMES {
        let scene = vase(name);
        for (k, mode) in MODES.into_iter().enumerate() {
            let ray = Ray::new(Vec3A::new(2.0, 1.9, 0.7), Vec3A::new(-2.0, -1.0, -0.35).normalize());
            let vertex = scene.intersect(&ray).unwrap();
            assert_ne!(vertex.point().normal, vertex.shading_normal());
            let sample = |u: [f64; 3]| {
                let sample = vertex.sample(u.map(|x| x as f32), mode);
                sample.filter(|sample| !sample.is_specular).map(|sample| sample.wi.to_array())
            };
            let density = |w: [f64; 3]| f64::from(vertex.pdf_solid_angle(Vec3A::from(w.map(|x| x as f32)), mode));
            let test = ChiSquare::on(Sphere).samples(30_000);
            test.run(SUITE.check(&format!("{name} {k}")), sample, density).expect_pass();
            if k == 0 {
                // Where many samples pass through, fewer are left to tell by.
                let factor = if name == "mask" { 0.9 } else { 0.97 };
                let lighter = |w: [f64; 3]| factor * density(w);
                test.run(SUITE.twin(&format!("{name}: too little")), sample, lighter).expect_reject();
                // The density of another point.
                let other = vertex.reversed((vertex.wo() + Vec3A::new(0.2, -0.2, 0.2)).normalize());
                let shifted = |w: [f64; 3]| f64::from(other.pdf_solid_angle(Vec3A::from(w.map(|x| x as f32)), mode));
                if name.contains("conductor") {
                    test.run(SUITE.twin(&format!("{name}: another wo")), sample, shifted).expect_reject();
                }
            }
        }
    }
}

/// Emission depends on the geometric side alone.
#[test]
fn emission_is_one_sided() {
    let mut b = SceneBuilder::new("lamp");
    let grey = b.diffuse(0.5, 0.5, 0.5);
    b.quad(grey, Vec3A::ZERO, Vec3A::X, Vec3A::Y).emit(Rgb::splat(2.0));
    b.place_again(grey, Affine3A::from_translation(scene_core::glam::Vec3::new(5.0, 0.0, 0.0)));
    let scene = ReferenceScene::new(b.finish()).unwrap();
    let at = |x: f32, z: f32| scene.intersect(&Ray::new(Vec3A::new(x, 0.5, z), Vec3A::new(0.0, 0.0, -z))).unwrap();
    assert_eq!(at(0.5, 1.0).emitted(), Rgb::splat(2.0));
    assert_eq!((at(0.5, -1.0).emitted(), at(0.5, -1.0).emitter().is_some()), (Rgb::ZERO, true));
    assert_eq!((at(5.5, 1.0).emitted(), at(5.5, 1.0).emitter()), (Rgb::ZERO, None));
    assert_eq!(at(0.5, 1.0).reversed(-Vec3A::Z).emitted(), Rgb::ZERO);
}
