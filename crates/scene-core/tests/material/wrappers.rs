//! Flattening, wrappers and validation.

use scene_core::glam::Vec3A;
use scene_core::material::{Bsdf, Material, MaterialError, ShadingInput};
use scene_core::texture::{Texture, UV_IDENTITY};
use scene_core::{Rgb, TransportMode};

use crate::cases::{self, BLUE, RED, compiled};
use crate::laws::direction;

const MODE: TransportMode = TransportMode::Radiance;

#[test]
fn scattering_functions_are_small() {
    assert!(size_of::<Bsdf<'_>>() <= 96, "{}", size_of::<Bsdf<'_>>());
}

#[test]
fn one_sided_materials_are_black_from_behind() {
    for name in ["diffuse", "roughconductor-ggx-0.3", "plastic", "roughplastic-ggx-0.2", "phong-5", "conductor"] {
        let material = compiled(name);
        let bsdf = material.resolve([0.0; 2]);
        let wo = direction(-0.6, 0.1);
        assert_eq!(bsdf.eval_pdf(wo, direction(-0.4, 0.5), MODE), (Rgb::ZERO, 0.0), "{name}");
        assert!(bsdf.sample(wo, [0.2, 0.3, 0.4], MODE).is_none(), "{name}");
        assert_eq!(bsdf.albedo(wo), Rgb::ZERO, "{name}");
        assert!(!material.is_two_sided());
    }
}

#[test]
fn two_sided_materials_mirror_their_front() {
    let flip = |w: Vec3A| w.with_z(-w.z);
    for name in ["diffuse", "roughconductor-ggx-aniso", "plastic", "roughplastic-ggx-0.2", "conductor"] {
        let (one, two) = (compiled(name), cases::material(name).two_sided().compile().unwrap());
        let (one, two) = (one.resolve([0.0; 2]), two.resolve([0.0; 2]));
        let (wo, wi) = (direction(0.6, 0.1), direction(0.4, 0.5));
        assert_eq!(two.eval_pdf(wo, wi, MODE), one.eval_pdf(wo, wi, MODE), "{name}");
        assert_eq!(two.eval_pdf(flip(wo), flip(wi), MODE), one.eval_pdf(wo, wi, MODE), "{name}");
        assert_eq!(two.eval_pdf(wo, flip(wi), MODE), (Rgb::ZERO, 0.0));
        for u in [[0.05, 0.3, 0.4], [0.95, 0.6, 0.1]] {
            let front = one.sample(wo, u, MODE).unwrap();
            let back = two.sample(flip(wo), u, MODE).unwrap();
            assert_eq!((front.throughput, front.pdf, flip(front.wi)), (back.throughput, back.pdf, back.wi), "{name}");
        }
    }
}

#[test]
fn different_sides_are_seen_from_their_sides() {
    let material = compiled("twosided-different");
    let bsdf = material.resolve([0.0; 2]);
    assert_eq!(bsdf.albedo(Vec3A::Z), RED);
    assert_ne!(bsdf.albedo(-Vec3A::Z), RED);
    let wi = direction(0.4, 0.5);
    assert_eq!(bsdf.eval(Vec3A::Z, wi, MODE), compiled("diffuse").resolve([0.0; 2]).eval(Vec3A::Z, wi, MODE));
}

#[test]
fn masks_pass_what_they_do_not_stop() {
    let material = compiled("mask");
    let bsdf = material.resolve([0.0; 2]);
    let wo = direction(0.6, 0.1);
    let passed = bsdf.sample(wo, [0.31, 0.5, 0.5], MODE).unwrap();
    assert!(passed.is_specular && passed.wi == -wo && passed.throughput == Rgb::ONE);
    let stopped = bsdf.sample(wo, [0.29, 0.5, 0.5], MODE).unwrap();
    assert!(!stopped.is_specular && stopped.throughput == BLUE);
    let twice = Material::Mask { opacity: 0.5.into(), inner: Box::new(cases::material("mask")) }.compile().unwrap();
    for (u, passes) in [(0.149, false), (0.151, true)] {
        let sample = twice.resolve([0.0; 2]).sample(wo, [u, 0.5, 0.5], MODE).unwrap();
        assert_eq!(sample.is_specular && sample.wi == -wo, passes, "{u}");
    }
    for opacity in [0.0, 1.0] {
        let all =
            Material::Mask { opacity: opacity.into(), inner: Box::new(Material::diffuse(BLUE)) }.compile().unwrap();
        let all = all.resolve([0.0; 2]);
        for u in [0.0, 0.5, 0.999_999_94] {
            assert_eq!(all.sample(wo, [u, 0.2, 0.2], MODE).unwrap().is_specular, opacity == 0.0);
        }
    }
}

#[test]
fn evaluate_only_keeps_values_and_forgets_densities() {
    for (name, inner) in [("evaluateonly", "cooktorrance-0.4"), ("evaluateonly-twosided", "twosided-roughplastic")] {
        let (outer, inner) = (compiled(name), compiled(inner));
        let (outer, inner) = (outer.resolve([0.0; 2]), inner.resolve([0.0; 2]));
        for (wo, wi) in [(direction(0.6, 0.1), direction(0.4, 0.5)), (direction(-0.6, 0.1), direction(-0.4, 0.5))] {
            let (value, pdf) = outer.eval_pdf(wo, wi, MODE);
            assert_eq!(value, inner.eval(wo, wi, MODE));
            assert!(pdf == 0.0 && value == Rgb::ZERO || (pdf * std::f32::consts::TAU - 1.0).abs() < 1e-6);
        }
    }
    let glass = Material::EvaluateOnly(Box::new(cases::material("roughdielectric-ggx-0.5"))).compile().unwrap();
    let through = glass.resolve([0.0; 2]).eval_pdf(direction(0.6, 0.1), direction(-0.6, 0.6), MODE);
    assert_eq!(through, (Rgb::ZERO, 0.0));
}

#[test]
fn textures_are_looked_up_once() {
    let checkers = |a, b| Texture::Checkerboard { color0: a, color1: b, uv_transform: UV_IDENTITY };
    let material = Material::Mask {
        opacity: checkers(Rgb::ONE, Rgb::ZERO),
        inner: Box::new(Material::diffuse(checkers(RED, BLUE)).two_sided()),
    };
    let material = material.compile().unwrap();
    assert_eq!(material.resolve([0.1, 0.1]).albedo(-Vec3A::Z), RED);
    assert_eq!(material.resolve([0.6, 0.1]).albedo(-Vec3A::Z), Rgb::ONE);
}

#[test]
fn frames_follow_the_maps() {
    let input = ShadingInput {
        uv: [0.3, 0.4],
        dpdu: Vec3A::new(2.0, 0.0, 0.0),
        dpdv: Vec3A::new(0.0, 0.0, -3.0),
        shading_normal: Vec3A::Y,
        geometric_normal: Vec3A::Y,
    };
    let plain = compiled("diffuse");
    assert!(!plain.needs_tangents());
    assert_eq!(plain.shading_frame(&input).z, Vec3A::Y);
    assert_eq!(plain.shading_frame(&input).x, Vec3A::X);
    // A ramp of slope one half of `scale` per unit of u; p_u has length two.
    let ramp = cases::image(2, 2, |x, _| [x as f32; 3]);
    let bump =
        Material::BumpMap { height: ramp, scale: 0.5, inner: Box::new(Material::diffuse(RED)) }.compile().unwrap();
    let normal = bump.shading_frame(&ShadingInput { uv: [0.5, 0.5], ..input }).z;
    assert!(bump.needs_tangents() && (normal - Vec3A::new(-0.5, 1.0, 0.0).normalize()).length() < 1e-5, "{normal}");
    // Without derivatives there is nothing to displace.
    let flat = ShadingInput { dpdu: Vec3A::ZERO, dpdv: Vec3A::ZERO, ..input };
    assert_eq!(bump.shading_frame(&flat).z, Vec3A::Y);
    let map = |rgb: [f32; 3]| {
        Material::NormalMap { normals: Rgb::from(rgb).into(), inner: Box::new(Material::diffuse(RED)) }
            .compile()
            .unwrap()
    };
    assert!((map([0.5, 0.5, 1.0]).shading_frame(&input).z - Vec3A::Y).length() < 1e-6);
    let tilted = map([1.0, 0.5, 1.0]).shading_frame(&input).z;
    assert!((tilted - Vec3A::new(1.0, 1.0, 0.0).normalize()).length() < 1e-5, "{tilted}");
    assert_eq!(map([0.5, 0.5, 0.5]).shading_frame(&input).z, Vec3A::Y);
}

/// In glTF y points against the derivative by `v`, whichever way that runs.
#[test]
fn tangent_normal_maps_know_mirrored_coordinates() {
    let input = ShadingInput {
        uv: [0.0; 2],
        dpdu: Vec3A::X * 2.0,
        dpdv: -Vec3A::Y,
        shading_normal: Vec3A::Z,
        geometric_normal: Vec3A::Z,
    };
    let map = |scale: f32| {
        let inner = Box::new(Material::diffuse(RED));
        Material::TangentNormalMap { normals: Rgb::new(0.5, 1.0, 1.0).into(), scale, inner }.compile().unwrap()
    };
    let tilted = |scale: f32, dpdv: Vec3A| map(scale).shading_frame(&ShadingInput { dpdv, ..input }).z;
    assert!((tilted(1.0, -Vec3A::Y) - Vec3A::new(0.0, 1.0, 1.0).normalize()).length() < 1e-5);
    assert!((tilted(1.0, Vec3A::Y) - Vec3A::new(0.0, -1.0, 1.0).normalize()).length() < 1e-5);
    assert!((tilted(0.5, -Vec3A::Y) - Vec3A::new(0.0, 0.5, 1.0).normalize()).length() < 1e-5);
    assert!(map(1.0).needs_tangents() && tilted(0.0, Vec3A::Y) == Vec3A::Z);
    // Without derivatives the frame is any, and the tilt the same.
    assert!((tilted(1.0, Vec3A::ZERO).z - 0.5f32.sqrt()).abs() < 1e-5);
}

#[test]
fn invalid_parameters_are_named() {
    let message = |material: Material| material.compile().unwrap_err().to_string();
    assert!(message(Material::diffuse(f32::NAN)).contains("reflectance of a diffuse material is NaN"));
    assert!(message(Material::diffuse(1.5)).contains("1.5"));
    assert!(message(cases::rough_conductor("Cu", Default::default(), [-0.1, 0.1])).contains("alpha"));
    assert!(message(cases::rough_dielectric(f32::INFINITY, 1.0, Default::default(), [0.1; 2])).contains("int_ior"));
    let equal = cases::rough_dielectric(1.5, 1.5, Default::default(), [0.1; 2]).compile().unwrap_err();
    assert_eq!(equal, MaterialError::EqualIndices { material: "roughdielectric", value: 1.5 });
    let phong = Material::Phong { diffuse_reflectance: 0.7.into(), specular_reflectance: 0.7.into(), exponent: 3.0 };
    assert!(matches!(phong.compile(), Err(MaterialError::Energy { .. })));
    let nested = Material::Mask { opacity: 0.5.into(), inner: Box::new(Material::diffuse(-1.0)) };
    assert!(matches!(nested.validate(), Err(MaterialError::Parameter { value: -1.0, .. })));
}

#[test]
fn impossible_nestings_are_refused() {
    assert!(matches!(cases::material("dielectric").two_sided().compile(), Err(MaterialError::Nesting { .. })));
    let back = Some(Box::new(cases::material("mask")));
    let sides = Material::TwoSided { front: Box::new(Material::diffuse(0.5)), back };
    assert!(sides.compile().unwrap_err().to_string().contains("mask"));
    // Wrappers inside of a second side that is the same commute with it.
    let inside = Material::Mask { opacity: 0.3.into(), inner: Box::new(Material::diffuse(BLUE)) }.two_sided();
    let inside = inside.compile().unwrap();
    assert_eq!(inside.resolve([0.0; 2]).albedo(-Vec3A::Z), compiled("mask").resolve([0.0; 2]).albedo(-Vec3A::Z));
}
