//! The importer for glTF: materials and textures.
#![cfg(feature = "gltf")]
#![allow(clippy::unwrap_used)]

mod gltf_support;

use gltf_support::{Data, base64, material, mesh, square, with_material};
use scene_core::glam::Vec3A;
use scene_core::material::Material;
use scene_core::reference::{ReferenceEmitter, SceneDescription};
use scene_core::texture::{Interpolation, Texture, Wrap};
use scene_core::{Emitter, Ray, ReferenceScene, Rgb, Scene, Vertex};

/// A PNG of 2 x 2 pixels: red, green above blue, white; the alphas are 255, 153, 51 and 0.
fn png() -> Vec<u8> {
    let pixels = [[255, 0, 0, 255], [0, 255, 0, 153], [0, 0, 255, 51], [255, 255, 255, 0u8]];
    encoded(2, 2, &pixels.concat())
}

/// Uncompressed PNG: zlib with one stored block. The test has no other encoder at hand.
fn encoded(width: u32, height: u32, rgba: &[u8]) -> Vec<u8> {
    let crc = |bytes: &[u8]| {
        !bytes.iter().fold(!0u32, |crc, byte| {
            (0..8).fold(crc ^ u32::from(*byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 })
        })
    };
    let rows: Vec<u8> = rgba.chunks(4 * width as usize).flat_map(|row| [&[0], row].concat()).collect();
    let (a, b) = rows.iter().fold((1u32, 0u32), |(a, b), byte| {
        let a = (a + u32::from(*byte)) % 65_521;
        (a, (a + b) % 65_521)
    });
    let length = rows.len() as u16;
    let mut stream = vec![0x78, 1, 1];
    stream.extend(length.to_le_bytes());
    stream.extend((!length).to_le_bytes());
    stream.extend(&rows);
    stream.extend((b << 16 | a).to_be_bytes());
    let mut header = [width.to_be_bytes(), height.to_be_bytes()].concat();
    header.extend([8, 6, 0, 0, 0]);
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    for (kind, content) in [(b"IHDR", &header), (b"IDAT", &stream), (b"IEND", &Vec::new())] {
        let chunk = [&kind[..], content].concat();
        file.extend((content.len() as u32).to_be_bytes());
        file.extend(&chunk);
        file.extend(crc(&chunk).to_be_bytes());
    }
    file
}

/// Images and textures of [`png`]: texture 0 has the default sampler, 1 is mirrored and nearest, 2 is clamped along u only.
fn textures() -> String {
    format!(
        r#""images":[{{"uri":"data:image/png;base64,{}"}}],"samplers":[{{"wrapS":33648,"wrapT":33648,"magFilter":9728}},{{"wrapS":33071}}],
        "textures":[{{"source":0}},{{"source":0,"sampler":0}},{{"source":0,"sampler":1}}]"#,
        base64(&png())
    )
}

fn textured(fields: &str) -> SceneDescription {
    square().load(&with_material(fields, &textures()))
}

/// What is on both sides of a surface.
fn front(material: &Material) -> &Material {
    let Material::TwoSided { front, back: None } = material else { panic!("{material:?}") };
    front
}

/// The base colour and the texture of roughness and metalness.
fn parts(material: &Material) -> (&Texture, &Texture) {
    let Material::MetallicRoughness { base_color, metallic_roughness, .. } = front(material) else {
        panic!("{material:?}")
    };
    (base_color, metallic_roughness)
}

#[test]
fn factors_are_kept_and_sides_are_two() {
    let plain = material(
        r#""pbrMetallicRoughness":{"baseColorFactor":[0.1,0.2,0.3,1],"metallicFactor":0.25,"roughnessFactor":0.5},
        "extensions":{"KHR_materials_ior":{"ior":1.7},
        "KHR_materials_specular":{"specularFactor":0.5,"specularColorFactor":[1,2,3]}}"#,
    );
    let Material::MetallicRoughness { base_color, metallic, roughness, ior, specular, specular_color, .. } =
        front(&plain)
    else {
        panic!("{plain:?}")
    };
    assert_eq!(base_color.constant(), Some(Rgb::new(0.1, 0.2, 0.3)));
    assert_eq!((*metallic, *roughness, *ior, *specular), (0.25, 0.5, 1.7, 0.5));
    assert_eq!(specular_color.to_array(), [1.0, 2.0, 3.0]);
    assert!(plain.compile().unwrap().is_two_sided());
    assert!(material(r#""doubleSided":true"#).compile().unwrap().is_two_sided());
    // An index of zero reflects everything.
    let mirror = material(r#""extensions":{"KHR_materials_ior":{"ior":0}}"#);
    assert!(matches!(front(&mirror), Material::MetallicRoughness { ior: 1e4, .. }));
}

#[test]
fn textures_show_up_the_right_way_round() {
    let scene = textured(r#""pbrMetallicRoughness":{"baseColorTexture":{"index":0}}"#);
    let (base, _) = parts(&scene.materials[0]);
    let Texture::Image(image) = base else { panic!() };
    assert_eq!((image.wrap, image.interpolation), (Wrap::Repeat, Interpolation::Bilinear));
    let base = base.clone();
    let scene = ReferenceScene::new(scene).unwrap();
    // The image's first row is up.
    for (at, color) in [
        ([0.25, 0.75], [1.0, 0.0, 0.0]),
        ([0.75, 0.75], [0.0, 1.0, 0.0]),
        ([0.25, 0.25], [0.0, 0.0, 1.0]),
        ([0.75, 0.25], [1.0; 3]),
    ] {
        let vertex = scene.intersect(&Ray::new(Vec3A::new(at[0], at[1], 1.0), Vec3A::NEG_Z)).unwrap();
        let shown = base.eval(vertex.point().uv).0;
        assert!((shown - Vec3A::from(color)).abs().max_element() < 1e-4, "{at:?}: {shown}");
    }
}

#[test]
fn samplers_transforms_and_colour_spaces() {
    let scene = textured(
        r#""pbrMetallicRoughness":{
            "baseColorTexture":{"index":1,"extensions":{"KHR_texture_transform":{"offset":[0.5,0],"scale":[2,1]}}},
            "baseColorFactor":[0.5,0.5,0.5,1],"metallicRoughnessTexture":{"index":0}}"#,
    );
    let (base, surface) = parts(&scene.materials[0]);
    let Texture::Image(image) = base else { panic!() };
    assert_eq!((image.wrap, image.interpolation, image.scale), (Wrap::Mirror, Interpolation::Nearest, 0.5));
    assert_eq!(image.uv_transform, [2.0, 0.0, 0.5, 0.0, 1.0, 0.0]);
    assert_eq!(base.eval([0.125, 0.25]).to_array(), [0.0, 0.5, 0.0]);
    assert!(matches!(surface, Texture::Image(image) if image.wrap == Wrap::Repeat));
    // Coloured factors are in the pixels.
    let tinted =
        textured(r#""pbrMetallicRoughness":{"baseColorTexture":{"index":0},"baseColorFactor":[0.5,0.25,1,1]}"#);
    assert_eq!(parts(&tinted.materials[0]).0.eval([0.75, 0.75]).to_array(), [0.5, 0.25, 1.0]);
    let warnings =
        square().warnings(&with_material(r#""pbrMetallicRoughness":{"baseColorTexture":{"index":2}}"#, &textures()));
    assert_eq!(warnings, ["materials[0], textures[2]: wraps by ClampToEdge along v too, not by Repeat"]);
    // A grey of 188 is a linear half where it is a colour, and 188 / 255 where it is not.
    let grey = base64(&encoded(1, 1, &[188, 188, 188, 255]));
    let more = format!(r#""images":[{{"uri":"data:image/png;base64,{grey}"}}],"textures":[{{"source":0}}]"#);
    let fields = r#""pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicRoughnessTexture":{"index":0}}"#;
    let scene = square().load(&with_material(fields, &more));
    let (base, surface) = parts(&scene.materials[0]);
    assert!((base.eval([0.5; 2])[0] - 0.5029).abs() < 1e-3 && (surface.eval([0.5; 2])[1] - 188.0 / 255.0).abs() < 1e-5);
}

#[test]
fn images_may_be_in_views() {
    let mut data = square();
    let view = data.view(&png());
    let more = format!(r#""images":[{{"bufferView":{view},"mimeType":"image/png"}}],"textures":[{{"source":0}}]"#);
    let scene = data.load(&with_material(r#""pbrMetallicRoughness":{"baseColorTexture":{"index":0}}"#, &more));
    assert_eq!(parts(&scene.materials[0]).0.eval([0.25, 0.25]).to_array(), [1.0, 0.0, 0.0]);
}

#[test]
fn alpha_is_opacity() {
    let opacity = |mode: &str| {
        let fields = format!(r#"{mode},"pbrMetallicRoughness":{{"baseColorTexture":{{"index":1}}}}"#);
        let scene = textured(&fields);
        let Material::Mask { opacity, .. } = &scene.materials[0] else { panic!("{mode}") };
        [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]].map(|uv| opacity.eval(uv)[0])
    };
    let blended = opacity(r#""alphaMode":"BLEND""#);
    assert!(blended.iter().zip([1.0, 0.6, 0.2, 0.0]).all(|(a, b)| (a - b).abs() < 1e-6), "{blended:?}");
    assert_eq!(opacity(r#""alphaMode":"MASK""#), [1.0, 1.0, 0.0, 0.0]);
    assert_eq!(opacity(r#""alphaMode":"MASK","alphaCutoff":0.1"#), [1.0, 1.0, 1.0, 0.0]);
    // Opaque materials have no alpha, and opaque alpha needs no mask.
    let plain = |fields: &str| matches!(front(&material(fields)), Material::MetallicRoughness { .. });
    assert!(plain(r#""pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.5]}"#));
    assert!(plain(r#""alphaMode":"BLEND""#));
    let glassy = material(r#""alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.25]}"#);
    let Material::Mask { opacity, .. } = glassy else { panic!() };
    assert_eq!(opacity.constant(), Some(Rgb::splat(0.25)));
}

#[test]
fn normal_textures_are_linear_and_scaled() {
    let scene =
        textured(r#""normalTexture":{"index":1,"scale":0.5,"extensions":{"KHR_texture_transform":{"scale":[3,3]}}}"#);
    let Material::TangentNormalMap { normals: Texture::Image(image), scale, .. } = &scene.materials[0] else {
        panic!()
    };
    assert_eq!((*scale, image.uv_transform[0], image.uv_transform[4]), (0.5, 3.0, 3.0));
    assert!(ReferenceScene::new(scene).is_ok());
}

#[test]
fn glass_is_a_pane_or_solid() {
    let glass = |roughness: f32, more: &str| {
        material(&format!(
            r#""pbrMetallicRoughness":{{"baseColorFactor":[0.9,0.8,0.7,1],"metallicFactor":0,"roughnessFactor":{roughness}}},
            "extensions":{{"KHR_materials_transmission":{{"transmissionFactor":1}}{more}}}"#
        ))
    };
    let Material::ThinDielectric { int_ior, specular_transmittance, .. } = glass(0.0, "") else { panic!() };
    assert_eq!((int_ior, specular_transmittance.constant()), (1.5, Some(Rgb::new(0.9, 0.8, 0.7))));
    let volume = r#","KHR_materials_ior":{"ior":1.33},"KHR_materials_volume":{"thicknessFactor":1}"#;
    assert!(matches!(glass(0.0, volume), Material::Dielectric { int_ior: 1.33, .. }));
    let Material::RoughDielectric { alpha, .. } = glass(0.5, volume) else { panic!() };
    assert_eq!(alpha, [0.25; 2]);
    // After the distance d the colour c is left.
    let absorbing =
        r#","KHR_materials_volume":{"thicknessFactor":1,"attenuationDistance":2,"attenuationColor":[1,0.5,0.25]}"#;
    let Material::Filled { medium, .. } = glass(0.0, absorbing) else { panic!() };
    let left = medium.transmittance(2.0).0;
    assert!((left - Vec3A::new(1.0, 0.5, 0.25)).abs().max_element() < 1e-6, "{left}");
    assert_eq!(medium.sigma_s(), Rgb::ZERO);
    // Metals transmit nothing, and what is said twice is not both.
    let metal = material(r#""extensions":{"KHR_materials_transmission":{"transmissionFactor":1}}"#);
    assert!(matches!(front(&metal), Material::MetallicRoughness { .. }));
    let partly = r#""pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0.5},"extensions":{"KHR_materials_transmission":{"transmissionFactor":0.7}}"#;
    assert_eq!(
        square().warnings(&with_material(partly, "")),
        [
            "materials[0]: transmits only a part of the light, and is taken as clear",
            "materials[0]: its roughness is ignored: without thickness it is a smooth pane"
        ]
    );
}

/// Roughness of glass is one number: the mean over the surface that shows the texture, here a corner of it.
#[test]
fn textured_roughness_of_glass_is_that_of_its_surface() {
    let fields = r#""pbrMetallicRoughness":{"metallicFactor":0,"metallicRoughnessTexture":
        {"index":1,"extensions":{"KHR_texture_transform":{"scale":[0.4,0.4],"offset":[0.55,0.05]}}}},
        "extensions":{"KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_volume":{"thicknessFactor":1}}"#;
    let scene = square().import(&with_material(fields, &textures())).unwrap();
    let Material::RoughDielectric { alpha, .. } = scene.materials[0] else { panic!("{:?}", scene.materials) };
    assert!((alpha[0] - 1.0).abs() < 1e-5, "{alpha:?}");
    assert!(scene.warnings[0].ends_with("materials[0]: the texture of its roughness and metalness becomes its mean"));
}

#[test]
fn emission_has_factor_and_strength() {
    let fields =
        r#""emissiveFactor":[1,0.5,0.25],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":8}}"#;
    let scene = square().load(&with_material(fields, ""));
    assert_eq!(scene.instances[0].radiance, Some(Rgb::new(8.0, 4.0, 2.0)));
    // Emissive surfaces are light: no environment.
    assert!(scene.lights.is_empty());
    let warnings = square().warnings(&with_material(&format!(r#"{fields},"doubleSided":true"#), ""));
    assert_eq!(warnings, ["materials[0]: emits on its front only, although it has two sides"]);
}

/// The power of a textured emitter is that of the texture; what is black does not emit.
#[test]
fn emissive_textures_are_constant_for_each_triangle() {
    let mut data = Data::default();
    // Two squares beside each other, over the red and the green pixel, each of two triangles, and one over the lower half.
    let mut positions = Vec::new();
    let mut uvs = Vec::new();
    for (x, u, v) in [(0.0, 0.0, 0.0), (1.0, 0.5, 0.0), (2.0, 0.0, 0.5)] {
        for [dx, dy] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [1.0, 1.0], [0.0, 1.0f32]] {
            positions.push([x + dx, dy, 0.0]);
            uvs.push([u + 0.05 + 0.4 * dx, v + 0.45 - 0.4 * dy]);
        }
    }
    data.floats(&positions);
    data.floats(&uvs);
    let rest = format!(
        r#""meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"material":0}}]}}],"nodes":[{{"mesh":0}}],
        "materials":[{{"emissiveFactor":[2,4,0],"emissiveTexture":{{"index":1}}}}],{}"#,
        textures()
    );
    let scene = data.import(&rest).unwrap();
    // They do not count as light.
    assert_eq!((scene.warnings.len(), scene.lights.len()), (3, 1), "{:?}", scene.warnings);
    assert!(scene.warnings[0].ends_with("materials[0]: its emissive texture becomes a constant for each triangle"));
    let found: Vec<_> = scene.instances.iter().map(|i| (mesh(&scene, i.shape.0 as usize).len(), i.radiance)).collect();
    let [red, green] = [Rgb::new(2.0, 0.0, 0.0), Rgb::new(0.0, 4.0, 0.0)];
    assert_eq!(found, [(2, None), (2, Some(green)), (2, Some(red))]);
    let scene = ReferenceScene::new(scene).unwrap();
    let lamps = scene.emitters().iter().filter(|emitter| matches!(emitter, ReferenceEmitter::Mesh(_)));
    let power = lamps.fold(Rgb::ZERO, |sum, emitter| sum + emitter.power());
    assert!((power.0 / std::f32::consts::PI - Vec3A::new(2.0, 4.0, 0.0)).abs().max_element() < 1e-4, "{power:?}");
}

#[test]
fn other_sets_of_coordinates_are_taken_whole() {
    let mut data = square();
    data.floats(&[[0.25, 0.5]; 4]);
    let fields = r#""pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":1}},"normalTexture":{"index":0}"#;
    let primitive = r#""TEXCOORD_0":3"#;
    let rest = with_material(fields, &textures()).replace(primitive, r#""TEXCOORD_0":3,"TEXCOORD_1":4"#);
    let scene = data.import(&rest).unwrap();
    assert_eq!(mesh(&scene, 0).uvs()[0], [0.25, 0.5]);
    assert!(scene.warnings[0].ends_with("materials[0]: TEXCOORD_1 is taken for all textures, for TEXCOORD_0 too"));
    let warnings = data.warnings(&with_material(fields, &textures()));
    assert!(warnings[0].contains("no TEXCOORD_1: (0, 0) is taken"), "{warnings:?}");
}
