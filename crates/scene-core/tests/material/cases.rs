//! Materials by name; those that Mitsuba has too carry the names of `data/bsdf_reference.py`.

use std::sync::Arc;

use scene_core::Rgb;
use scene_core::material::{CompiledMaterial, Distribution, Material, conductors, dielectrics};
use scene_core::texture::{Image, ImageTexture, Texture};

use Distribution::{Beckmann, Ggx};

pub(crate) const RED: Rgb = Rgb::new(0.7, 0.3, 0.2);
pub(crate) const BLUE: Rgb = Rgb::new(0.1, 0.27, 0.36);

/// All materials with components that are not Dirac deltas and without perturbed normals.
pub(crate) const SCATTERING: [&str; 32] = [
    "diffuse",
    "roughconductor-ggx-0.05",
    "roughconductor-ggx-0.3",
    "roughconductor-ggx-aniso",
    "roughconductor-beckmann-0.1",
    "roughconductor-beckmann-0.5",
    "roughconductor-beckmann-aniso",
    "roughdielectric-ggx-0.1",
    "roughdielectric-ggx-0.5",
    "roughdielectric-ggx-aniso",
    "roughdielectric-beckmann-0.3",
    "plastic",
    "plastic-nonlinear",
    "roughplastic-ggx-0.05",
    "roughplastic-ggx-0.2",
    "roughplastic-beckmann-0.1",
    "roughplastic-beckmann-0.4",
    "twosided-diffuse",
    "twosided-roughplastic",
    "twosided-different",
    "mask",
    "phong-5",
    "phong-80",
    "cooktorrance-0.1",
    "cooktorrance-0.4",
    "metallicroughness-dielectric",
    "metallicroughness-metal",
    "metallicroughness-mixed",
    "metallicroughness-specular",
    "evaluateonly",
    "evaluateonly-twosided",
    "mask-evaluateonly",
];

/// All materials that consist of Dirac deltas alone.
pub(crate) const DELTA: [&str; 4] = ["conductor", "conductor-none", "dielectric", "thindielectric"];

pub(crate) fn compiled(name: &str) -> CompiledMaterial {
    material(name).compile().unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// A small image without symmetry, in `[0, 1)`.
pub(crate) fn height(x: usize, y: usize) -> f32 {
    ((x * 5 + y * 3) % 7) as f32 / 7.0
}

pub(crate) fn image(width: usize, height: usize, pixel: impl Fn(usize, usize) -> [f32; 3]) -> Texture {
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect();
    ImageTexture::new(Arc::new(Image::from_rgb(width as u32, height as u32, pixels).unwrap())).into()
}

pub(crate) fn rough_conductor(metal: &str, distribution: Distribution, alpha: [f32; 2]) -> Material {
    let (eta, k) = conductors::named(metal).unwrap();
    Material::RoughConductor { eta, k, specular_reflectance: 1.0.into(), distribution, alpha }
}

pub(crate) fn rough_dielectric(int_ior: f32, ext_ior: f32, distribution: Distribution, alpha: [f32; 2]) -> Material {
    Material::RoughDielectric {
        int_ior,
        ext_ior,
        specular_reflectance: 1.0.into(),
        specular_transmittance: 1.0.into(),
        distribution,
        alpha,
    }
}

/// With the extensions' defaults.
pub(crate) fn metallic_roughness(base_color: Rgb, metallic: f32, roughness: f32) -> Material {
    Material::MetallicRoughness {
        base_color: base_color.into(),
        metallic_roughness: 1.0.into(),
        metallic,
        roughness,
        ior: 1.5,
        specular: 1.0,
        specular_color: Rgb::ONE,
    }
}

fn default_iors() -> (f32, f32) {
    (dielectrics::named("polypropylene").unwrap(), dielectrics::named("air").unwrap())
}

pub(crate) fn rough_plastic(
    iors: (f32, f32),
    diffuse: Rgb,
    specular: f32,
    nonlinear: bool,
    distribution: Distribution,
    alpha: f32,
) -> Material {
    Material::RoughPlastic {
        int_ior: iors.0,
        ext_ior: iors.1,
        diffuse_reflectance: diffuse.into(),
        specular_reflectance: specular.into(),
        nonlinear,
        distribution,
        alpha,
    }
}

pub(crate) fn material(name: &str) -> Material {
    let air = dielectrics::named("air").unwrap();
    let tinted = |material: Material, reflectance: Rgb, transmittance: Rgb| match material {
        Material::RoughDielectric { int_ior, ext_ior, distribution, alpha, .. } => Material::RoughDielectric {
            int_ior,
            ext_ior,
            specular_reflectance: reflectance.into(),
            specular_transmittance: transmittance.into(),
            distribution,
            alpha,
        },
        Material::RoughConductor { eta, k, distribution, alpha, .. } => {
            Material::RoughConductor { eta, k, specular_reflectance: reflectance.into(), distribution, alpha }
        }
        other => other,
    };
    let plastic = |iors: (f32, f32), diffuse: Rgb, specular: f32, nonlinear| Material::Plastic {
        int_ior: iors.0,
        ext_ior: iors.1,
        diffuse_reflectance: diffuse.into(),
        specular_reflectance: specular.into(),
        nonlinear,
    };
    let glass = (1.5, 1.0);
    match name {
        "diffuse" => Material::diffuse(RED),
        "roughconductor-ggx-0.05" => rough_conductor("Au", Ggx, [0.05; 2]),
        "roughconductor-ggx-0.3" => rough_conductor("Cu", Ggx, [0.3; 2]),
        "roughconductor-ggx-aniso" => rough_conductor("Al", Ggx, [0.1, 0.4]),
        "roughconductor-beckmann-0.1" => rough_conductor("Cr", Beckmann, [0.1; 2]),
        "roughconductor-beckmann-0.5" => rough_conductor("W", Beckmann, [0.5; 2]),
        "roughconductor-beckmann-aniso" => tinted(rough_conductor("Ag", Beckmann, [0.4, 0.2]), RED, RED),
        "roughdielectric-ggx-0.1" => rough_dielectric(1.5, 1.0, Ggx, [0.1; 2]),
        "roughdielectric-ggx-0.5" => tinted(rough_dielectric(1.5, 1.0, Ggx, [0.5; 2]), RED, BLUE),
        "roughdielectric-ggx-aniso" => rough_dielectric(1.33, 1.1, Ggx, [0.2, 0.5]),
        "roughdielectric-beckmann-0.3" => rough_dielectric(1.5, 1.0, Beckmann, [0.3; 2]),
        "plastic" | "plastic-delta" => plastic(default_iors(), RED, 1.0, false),
        "plastic-nonlinear" => plastic((1.9, air), BLUE, 0.5, true),
        "roughplastic-ggx-0.05" => rough_plastic(default_iors(), RED, 1.0, false, Ggx, 0.05),
        "roughplastic-ggx-0.2" => rough_plastic(glass, BLUE, 1.0, true, Ggx, 0.2),
        "roughplastic-beckmann-0.1" => rough_plastic(glass, RED, 1.0, true, Beckmann, 0.1),
        "roughplastic-beckmann-0.4" => rough_plastic((1.9, air), BLUE, 0.7, false, Beckmann, 0.4),
        "twosided-diffuse" => Material::diffuse(RED).two_sided(),
        "twosided-roughplastic" => rough_plastic(default_iors(), RED, 1.0, false, Ggx, 0.3).two_sided(),
        "twosided-different" => Material::TwoSided {
            front: Box::new(Material::diffuse(RED)),
            back: Some(Box::new(rough_conductor("Cu", Ggx, [0.4; 2]))),
        },
        "mask" => Material::Mask { opacity: 0.3.into(), inner: Box::new(Material::diffuse(BLUE).two_sided()) },
        "bumpmap" => Material::BumpMap {
            height: image(8, 8, |x, y| [height(x, y); 3]),
            scale: 0.25,
            inner: Box::new(Material::diffuse(RED)),
        },
        "normalmap" => Material::NormalMap {
            normals: image(4, 4, |_, _| [0.7, 0.4, 0.9]),
            inner: Box::new(rough_conductor("Cu", Ggx, [0.2, 0.5])),
        },
        "phong-5" => {
            Material::Phong { diffuse_reflectance: RED.into(), specular_reflectance: 0.3.into(), exponent: 5.0 }
        }
        "phong-80" => {
            Material::Phong { diffuse_reflectance: 0.0.into(), specular_reflectance: BLUE.into(), exponent: 80.0 }
        }
        "cooktorrance-0.1" => Material::CookTorrance {
            diffuse_reflectance: 0.2.into(),
            specular_reflectance: 0.8.into(),
            ior: 1.5,
            alpha: 0.1,
        },
        "cooktorrance-0.4" => Material::CookTorrance {
            diffuse_reflectance: 0.0.into(),
            specular_reflectance: RED.into(),
            ior: 2.5,
            alpha: 0.4,
        },
        "metallicroughness-dielectric" => metallic_roughness(RED, 0.0, 0.6),
        "metallicroughness-metal" => metallic_roughness(RED, 1.0, 0.5),
        "metallicroughness-mixed" => Material::MetallicRoughness {
            base_color: image(4, 4, |x, y| [height(x, y), 0.5, 0.2]),
            metallic_roughness: image(3, 5, |x, y| [0.9, 0.6 + 0.4 * height(x, y), height(y, x)]),
            metallic: 0.8,
            roughness: 0.9,
            ior: 1.5,
            specular: 1.0,
            specular_color: Rgb::ONE,
        },
        "metallicroughness-specular" => Material::MetallicRoughness {
            base_color: BLUE.into(),
            metallic_roughness: Rgb::new(0.0, 0.7, 1.0).into(),
            metallic: 0.1,
            roughness: 1.0,
            ior: 2.0,
            specular: 0.7,
            specular_color: Rgb::new(0.9, 3.0, 0.2),
        },
        "evaluateonly" => Material::EvaluateOnly(Box::new(material("cooktorrance-0.4"))),
        "evaluateonly-twosided" => Material::EvaluateOnly(Box::new(material("twosided-roughplastic"))),
        "mask-evaluateonly" => Material::Mask {
            opacity: 0.6.into(),
            inner: Box::new(Material::EvaluateOnly(Box::new(material("diffuse")))),
        },
        "conductor" => {
            let (eta, k) = conductors::named("Cu").unwrap();
            Material::Conductor { eta, k, specular_reflectance: 1.0.into() }
        }
        "conductor-none" => {
            let (eta, k) = conductors::named("none").unwrap();
            Material::Conductor { eta, k, specular_reflectance: RED.into() }
        }
        "dielectric" => Material::Dielectric {
            int_ior: 1.5,
            ext_ior: 1.0,
            specular_reflectance: RED.into(),
            specular_transmittance: BLUE.into(),
        },
        "thindielectric" => Material::ThinDielectric {
            int_ior: 1.5,
            ext_ior: 1.0,
            specular_reflectance: 1.0.into(),
            specular_transmittance: 1.0.into(),
        },
        _ => panic!("no material {name}"),
    }
}
