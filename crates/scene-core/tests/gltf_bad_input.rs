//! The importer for glTF: what becomes of broken assets. Nothing panics.
#![cfg(feature = "gltf")]
#![allow(clippy::unwrap_used)]

mod gltf_support;

use std::path::Path;

use gltf_support::{Data, container, mesh, square, with_material};
use proptest::prelude::*;
use scene_core::{ReferenceScene, gltf};

fn message(bytes: &[u8]) -> String {
    let text = gltf::load_slice(bytes, Path::new("folder")).map(|_| ()).unwrap_err().to_string();
    text.strip_prefix("folder/<bytes>: ").map_or(text.clone(), str::to_owned)
}

#[test]
fn containers_are_checked() {
    let glb = square().glb(&with_material("", ""));
    assert!(gltf::load_slice(&glb, Path::new("")).is_ok());
    let size = glb.len();
    for length in [4, 8, 11] {
        assert_eq!(message(&glb[..length]), format!("the container ends after {length} bytes"));
    }
    for length in [12, 13, 19, 40, size / 2, size - 1] {
        assert_eq!(message(&glb[..length]), format!("the container promises {size} bytes and has {length}"));
    }
    let changed = |at: usize, value: u32| {
        let mut glb = glb.clone();
        glb[at..at + 4].copy_from_slice(&value.to_le_bytes());
        message(&glb)
    };
    assert_eq!(changed(4, 1), "a container of version 1 cannot be read, only 2");
    assert_eq!(changed(12, 1 << 30), format!("a chunk of 1073741824 bytes at byte 12 exceeds the container of {size}"));
    assert_eq!(
        changed(12, u32::MAX),
        format!("a chunk of 4294967295 bytes at byte 12 exceeds the container of {size}")
    );
    assert_eq!(changed(16, 0), "the container has no JSON");
    assert_eq!(changed(8, 12), "the container has no JSON");
}

#[test]
fn json_and_versions_are_checked() {
    assert!(message(b"").starts_with("the JSON is broken"));
    assert!(message(b"\x00\xff").starts_with("the JSON is broken"));
    assert!(message(br#"{"asset":{"version":"2.0"}"#).contains("EOF"));
    assert_eq!(message(b"[1]"), "no glTF: there is no asset.version");
    assert_eq!(message(br#"{"asset":{"version":"1.0"}}"#), "glTF of version `1.0` cannot be read, only 2.0");
    assert!(message(br#"{"asset":{"version":"2.0"},"nodes":7}"#).contains("expected a sequence"));
    let deep = format!(r#"{{"asset":{{"version":"2.0"}},"extras":{}1{}}}"#, "[".repeat(10_000), "]".repeat(10_000));
    assert!(message(deep.as_bytes()).contains("recursion limit"));
    let missing = gltf::load(Path::new("no/such.glb")).unwrap_err().to_string();
    assert!(missing.starts_with("cannot read no/such.glb: "), "{missing}");
}

#[test]
fn required_extensions_must_be_known() {
    let rest = r#""extensionsUsed":["KHR_draco_mesh_compression"],"extensionsRequired":["KHR_draco_mesh_compression"]"#;
    assert_eq!(
        Data::default().error(rest),
        "requires the extension `KHR_draco_mesh_compression`, which is not supported"
    );
    // Images of extensions are named, too.
    let webp = with_material(
        r#""pbrMetallicRoughness":{"baseColorTexture":{"index":0}}"#,
        r#""extensionsUsed":["EXT_texture_webp"],"textures":[{"extensions":{"EXT_texture_webp":{"source":0}}}]"#,
    );
    assert!(square().error(&webp).contains("textures[0]: a texture without `source`"));
}

#[test]
fn indices_of_the_document_are_checked() {
    let rest = with_material("", "");
    assert_eq!(square().error(&rest.replace(r#"{"mesh":0}"#, r#"{"mesh":5}"#)), "nodes[0].mesh: index out of bounds");
    let accessor = rest.replace(r#""indices":0"#, r#""indices":77"#);
    assert_eq!(square().error(&accessor), "meshes[0].primitives[0].indices: index out of bounds");
    assert!(Data::default().error(r#""scene":3"#).contains("scene"));
    let position = rest.replace(r#""POSITION":1"#, r#""POSITION":9"#);
    assert_eq!(square().error(&position), "meshes[0].primitives[0].attributes: index out of bounds");
    // What is of the wrong kind.
    let swapped = rest.replace(r#""indices":0"#, r#""indices":1"#);
    assert_eq!(square().error(&swapped), "accessors[1]: its type is Vec3, where 1 components are needed");
    let mut data = square();
    let view = data.view(&[0; 12]);
    let index = data.accessor(&format!(r#""bufferView":{view},"componentType":5126,"count":3,"type":"SCALAR""#));
    let floats = rest.replace(r#""indices":0"#, &format!(r#""indices":{index}"#));
    assert_eq!(data.error(&floats), "accessors[4]: components of type F32 are no indices");
}

#[test]
fn nodes_form_trees() {
    let twice = "the node is in the hierarchy twice: nodes must not share children or form a cycle";
    let scene = r#""scenes":[{"nodes":[0]}],"#;
    for (nodes, at) in [
        (r#"{"children":[0]}"#, 0),
        (r#"{"children":[1]},{"children":[0]}"#, 0),
        (r#"{"children":[1,2]},{"children":[2]},{}"#, 2),
    ] {
        assert_eq!(Data::default().error(&format!(r#"{scene}"nodes":[{nodes}]"#)), format!("nodes[{at}]: {twice}"));
    }
    // A chain of any length needs no stack.
    let count = 100_000;
    let nodes: Vec<String> = (1..count).map(|i| format!(r#"{{"children":[{i}]}}"#)).collect();
    Data::default().load(&format!(r#"{scene}"nodes":[{},{{}}]"#, nodes.join(",")));

    let node = |fields: &str| Data::default().error(&format!(r#""nodes":[{{{fields}}}]"#));
    assert!(node(r#""rotation":[0,0,0,0]"#).contains("make no transform"));
    assert!(node(r#""translation":[0,1e39,0]"#).starts_with("nodes[0]"));
    assert!(node(r#""matrix":[1,0,0,1, 0,1,0,0, 0,0,1,0, 0,0,0,1]"#).contains("not affine"));
    let far = r#"{"children":[1],"scale":[1e30,1,1]},{"scale":[1e30,1,1]}"#;
    let far = Data::default().error(&format!(r#"{scene}"nodes":[{far}]"#));
    assert_eq!(far, "nodes[1]: its place in the world exceeds single precision");
}

#[test]
fn buffers_and_accessors_are_checked() {
    let rest = with_material("", "");
    let data = square();
    let with = |from: &str, to: &str| {
        let json = data.json(None, &rest);
        assert!(json.contains(from), "{json}");
        message(&container(&json.replacen(from, to, 1), &data.bytes))
    };
    let size = data.bytes.len();
    assert_eq!(
        with(&format!(r#""byteLength":{size}"#), r#""byteLength":1000"#),
        format!("buffers[0]: it promises 1000 bytes and has {size}")
    );
    let outside = format!("bufferViews[0]: 4000 bytes from 0 on are not within its buffer of {size}");
    assert_eq!(with(r#""byteOffset":0,"byteLength":12"#, r#""byteOffset":0,"byteLength":4000"#), outside);
    let huge = r#""byteOffset":18446744073709551615,"byteLength":12"#;
    assert!(with(r#""byteOffset":0,"byteLength":12"#, huge).contains("are not within its buffer"));
    // Counts beyond all bytes, and beyond all numbers.
    for count in ["7", "4294967296", "18446744073709551615"] {
        let error = with(r#""count":6"#, &format!(r#""count":{count}"#));
        assert_eq!(
            error,
            format!(
                "accessors[0]: {count} elements of 2 bytes, 2 apart, from 0 on are not within its view of 12 bytes"
            )
        );
    }
    let without_view =
        with(r#""bufferView":0,"componentType":5123,"count":6"#, r#""componentType":5123,"count":99999999999"#);
    assert_eq!(without_view, "accessors[0]: 99999999999 elements without a view are too many");
    let offset = with(r#""bufferView":0,"#, r#""bufferView":0,"byteOffset":18446744073709551615,"#);
    assert!(offset.starts_with("accessors[0]: 6 elements"), "{offset}");
    let sparse = r#""sparse":{"count":1,"indices":{"bufferView":1,"byteOffset":12,"componentType":5125},"values":{"bufferView":1}},"bufferView":0,"#;
    let sparse = with(r#""bufferView":0,"#, sparse);
    assert_eq!(sparse, "accessors[0]: sparse element 1065353216 is not below 6");

    // Where the bytes are not there.
    let uri = |uri: &str| message(data.json(Some(uri), &rest).as_bytes());
    assert!(
        uri("gone.bin").starts_with("folder/gone.bin: ")
            && uri("gone.bin").ends_with("(named at folder/<bytes>: buffers[0])")
    );
    assert_eq!(uri("data:;base64,AAAA"), format!("buffers[0]: it promises {size} bytes and has 3"));
    assert_eq!(uri("data:;base64,AA$A"), "buffers[0]: the data URI: `$` at 2 is no base64 digit");
    assert!(uri("data:;base64,AAAAA").contains("5 base64 digits"));
    assert!(uri("data:text/plain,AAAA").contains("not base64") && uri("data:nothing").contains("no comma"));
    assert_eq!(uri("https://example.org/a.bin"), "buffers[0]: the URI `https://example.org/a.bin` is not supported");
    assert!(message(data.json(None, &rest).as_bytes()).contains("no binary chunk"));
}

#[test]
fn vertices_are_checked() {
    let rest = r#""nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}]"#;
    let triangles = |z: f32, last: u16| {
        let mut data = Data::default();
        data.floats(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, z]]);
        data.indices(&[0, 1, 2, 1, 3, last]);
        data
    };
    assert_eq!(mesh(&triangles(0.0, 2).load(rest), 0).len(), 2);
    for last in [4, 0xffff] {
        let error = triangles(0.0, last).error(rest);
        let expected = format!("an index names vertex {last}, and there are not that many");
        assert_eq!(error, format!("meshes[0], primitives[0]: {expected}"));
    }
    for z in [f32::NAN, f32::INFINITY] {
        let data = triangles(z, 2);
        let scene = data.import(rest).unwrap();
        assert_eq!((mesh(&scene, 0).len(), mesh(&scene, 0).dropped()), (1, 1));
        assert!(data.warnings(rest)[0].contains("1 triangles are dropped"));
        assert!(ReferenceScene::new(scene).is_ok());
    }
    let fewer = with_material("", "").replace(r#""NORMAL":2"#, r#""NORMAL":4"#);
    let mut data = square();
    data.floats(&[[0.0; 3]; 3]);
    assert_eq!(data.error(&fewer), "meshes[0], primitives[0]: there are 3 normals for 4 vertices");
}

#[test]
fn materials_cameras_and_lights_are_checked() {
    let material = |fields: &str| square().error(&with_material(fields, ""));
    assert_eq!(
        material(r#""name":"Red","pbrMetallicRoughness":{"roughnessFactor":1.5}"#),
        "materials[0] `Red`: its roughnessFactor is 1.5, but must be in [0, 1]"
    );
    assert!(material(r#""pbrMetallicRoughness":{"baseColorFactor":[-1,0,0,1]}"#).contains("baseColorFactor is -1"));
    assert!(
        material(
            r#""emissiveFactor":[1e30,1,1],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":1e30}}"#
        )
        .contains("it emits")
    );
    assert!(material(r#""extensions":{"KHR_materials_ior":{"ior":0.5}}"#).contains("ior is 0.5"));
    let glass = |volume: &str| {
        material(&format!(
            r#""pbrMetallicRoughness":{{"metallicFactor":0}},"extensions":{{"KHR_materials_transmission":{{"transmissionFactor":1}},"KHR_materials_volume":{{"thicknessFactor":1,{volume}}}}}"#
        ))
    };
    assert!(glass(r#""attenuationDistance":-1"#).contains("over a distance of -1"));
    assert!(glass(r#""attenuationDistance":1,"attenuationColor":[2,0,0]"#).contains("attenuation to [2.0"));
    let spot = |spot: &str| {
        Data::default().error(&format!(
            r#""extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"spot"{spot}}}]}}}},"nodes":[{{"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}}]"#
        ))
    };
    assert!(spot(r#","spot":{"innerConeAngle":0.6,"outerConeAngle":0.5}"#).starts_with("lights[0]: a spot from 0.6"));
    assert!(spot(r#","spot":{},"intensity":-1"#).contains("negative or not finite"));
    // A type and what it is about need not agree.
    let camera =
        |camera: &str| Data::default().import(&format!(r#""nodes":[{{"camera":0}}],"cameras":[{{{camera}}}]"#));
    assert!(camera(r#""type":"perspective","orthographic":{"xmag":1,"ymag":1,"znear":0,"zfar":1}"#).is_ok());
    assert!(camera(r#""type":"perspective""#).is_err());
    assert!(camera(r#""type":"perspective","perspective":{"yfov":4,"znear":1}"#).is_err());
    // Images that are none, and one that promises too much.
    let image = |uri: &str| {
        let texture = r#""pbrMetallicRoughness":{"baseColorTexture":{"index":0}}"#;
        let more = format!(r#""images":[{{"uri":"{uri}","name":"Wood"}}],"textures":[{{"source":0}}]"#);
        square().error(&with_material(texture, &more))
    };
    assert!(image("data:image/png;base64,AAAA").starts_with("images[0] `Wood`: cannot decode the image"));
    assert!(image("gone.png").starts_with("folder/gone.png: "));
    let mut huge = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\x7f\xff\xff\xff\x7f\xff\xff\xff\x08\x06\0\0\0".to_vec();
    huge.extend([0; 4]);
    assert!(image(&format!("data:image/png;base64,{}", gltf_support::base64(&huge))).starts_with("images[0]"));
}

/// A valid asset with everything that the importer knows.
fn everything() -> Vec<u8> {
    let mut data = square();
    data.floats(&[[0.5; 4]; 4]);
    let material = r#""doubleSided":true,"emissiveFactor":[1,1,1],"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.5],
        "metallicFactor":0,"roughnessFactor":0.5},"extensions":{"KHR_materials_ior":{"ior":1.4},"KHR_materials_transmission":{"transmissionFactor":0.9},
        "KHR_materials_volume":{"thicknessFactor":1,"attenuationDistance":1,"attenuationColor":[1,0.5,1]}}"#;
    let more = r#""cameras":[{"type":"perspective","perspective":{"yfov":0.8,"znear":0.1}}],
        "extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","spot":{}}]}},
        "scenes":[{"nodes":[0,1]}],"scene":0"#;
    let rest = with_material(material, more).replace(
        r#""nodes":[{"mesh":0}]"#,
        r#""nodes":[{"mesh":0,"children":[2],"rotation":[0,0,0,1]},{"camera":0},
            {"mesh":0,"extensions":{"KHR_lights_punctual":{"light":0}},"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}]"#,
    );
    data.glb(&rest)
}

#[test]
fn everything_is_valid() {
    let scene = gltf::load_slice(&everything(), Path::new("")).unwrap();
    assert_eq!((scene.instances.len(), scene.lights.len()), (2, 1));
    ReferenceScene::new(scene).unwrap();
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Broken bytes are an error or another scene.
    #[test]
    fn mutations_do_not_panic(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6), cut in any::<prop::sample::Index>(), cuts in any::<bool>()) {
        let mut glb = everything();
        for (at, value) in changes {
            let at = at.index(glb.len());
            glb[at] = value;
        }
        if cuts {
            glb.truncate(cut.index(glb.len()));
        }
        if let Ok(scene) = gltf::load_slice(&glb, Path::new("no such folder")) {
            let _ = ReferenceScene::new(scene);
        }
    }

    /// Digits changed into others keep the JSON valid and its numbers wrong.
    #[test]
    fn other_digits_do_not_panic(changes in prop::collection::vec((any::<prop::sample::Index>(), 0u8..10), 1..8)) {
        let mut glb = everything();
        let digits: Vec<usize> = (20..glb.len()).filter(|&i| glb[i].is_ascii_digit()).collect();
        for (at, digit) in changes {
            glb[*at.get(&digits)] = b'0' + digit;
        }
        if let Ok(scene) = gltf::load_slice(&glb, Path::new("no such folder")) {
            let _ = ReferenceScene::new(scene);
        }
    }
}
