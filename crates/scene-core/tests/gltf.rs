//! The importer for glTF: nodes, meshes, cameras, lights, and where the data come from.
#![cfg(feature = "gltf")]
#![allow(clippy::unwrap_used)]

mod gltf_support;

use gltf_support::{Data, PRIMITIVE, base64, mesh, square, with_material};
use scene_core::glam::Vec3A;
use scene_core::gltf;
use scene_core::material::Material;
use scene_core::reference::Light;
use scene_core::{Ray, ReferenceScene, Rgb, Scene, SceneError, Sensor, Vertex};

fn near(a: Vec3A, b: [f32; 3]) {
    assert!((a - Vec3A::from(b)).length() < 1e-5, "{a} is not {b:?}");
}

#[test]
fn transforms_multiply_down_the_hierarchy() {
    // A turn by 90 degrees about y, which takes +x to -z, as rotation and as matrix.
    let turn = r#""rotation":[0,0.70710678,0,0.70710678]"#;
    let matrix = r#""matrix":[0,0,-1,0, 0,1,0,0, 1,0,0,0, 0,0,0,1]"#;
    for turn in [turn, matrix] {
        let nodes = format!(
            r#""meshes":[{{"primitives":[{PRIMITIVE}]}}],"materials":[{{}}],"scenes":[{{"nodes":[0]}}],"scene":0,"nodes":[
                {{"children":[2,1],"translation":[10,0,0],"scale":[2,2,2]}},
                {{"mesh":0}},
                {{"children":[3],{turn}}},
                {{"mesh":0,"translation":[1,0,0]}},
                {{"mesh":0,"name":"not in the scene"}}]"#
        );
        let scene = square().load(&nodes);
        // Both nodes show one mesh; depth first, in the order of the children.
        assert_eq!((scene.shapes.len(), scene.instances.len(), scene.materials.len()), (1, 2, 1));
        near(scene.instances[0].to_world.transform_point3a(Vec3A::ZERO), [10.0, 0.0, -2.0]);
        near(scene.instances[0].to_world.transform_point3a(Vec3A::X), [10.0, 0.0, -4.0]);
        near(scene.instances[1].to_world.transform_point3a(Vec3A::ONE), [12.0, 2.0, 2.0]);
    }
}

#[test]
fn surfaces_face_where_they_should() {
    let place = |scale: &str| {
        let nodes = format!(r#""nodes":[{{"mesh":0,"scale":{scale}}}],"meshes":[{{"primitives":[{PRIMITIVE}]}}]"#);
        ReferenceScene::new(square().load(&format!(r#"{nodes},"materials":[{{}}]"#))).unwrap()
    };
    for (scale, x) in [("[1,1,1]", 0.5), ("[-1,1,1]", -0.5)] {
        let scene = place(scale);
        let vertex = scene.intersect(&Ray::new(Vec3A::new(x, 0.25, 2.0), Vec3A::NEG_Z)).unwrap();
        assert_eq!(vertex.point().normal, Vec3A::Z);
        assert!((vertex.point().uv[0] - 0.5).abs() < 1e-6 && (vertex.point().uv[1] - 0.75).abs() < 1e-6);
    }
}

#[test]
fn every_kind_of_triangles_is_read() {
    let corners: Vec<[f32; 3]> =
        [[0, 0], [1, 0], [0, 1], [1, 1], [0, 2]].iter().map(|&[x, y]| [x as f32, y as f32, 0.0]).collect();
    let mut data = Data::default();
    data.floats(&corners);
    data.floats(&corners[..3]);
    data.indices(&[0, 1, 2, 3]);
    let scene = data.load(
        r#""nodes":[{"mesh":0}],"meshes":[{"primitives":[
            {"attributes":{"POSITION":0},"mode":5},
            {"attributes":{"POSITION":0},"indices":2,"mode":6},
            {"attributes":{"POSITION":1}}]}]"#,
    );
    assert_eq!([0, 1, 2].map(|shape| mesh(&scene, shape).len()), [3, 2, 1]);
    // Without normals a mesh is flat. All of the strip's triangles have the same side.
    let strip = mesh(&scene, 0);
    assert!(strip.normals().is_empty());
    for triangle in 0..3 {
        let [a, b, c] = strip.corners(triangle);
        assert!((b - a).cross(c - a).z > 0.0, "{triangle}");
    }
    // The default material is a rough white metal.
    let Material::TwoSided { front, .. } = &scene.materials[0] else { panic!() };
    let Material::MetallicRoughness { metallic, roughness, .. } = &**front else { panic!() };
    assert_eq!((scene.materials.len(), *metallic, *roughness), (1, 1.0, 1.0));
}

#[test]
fn accessors_may_be_strided_sparse_quantised_or_empty() {
    let mut data = Data::default();
    // Three positions of normalised bytes, four bytes apart; the last one is replaced.
    let view = data.view(&[0, 0, 0, 9, 127, 0, 0, 9, 0, 0, 0]);
    let at = data.view(&[2]);
    let values = data.view(&[0, 127, 0]);
    let bounds = r#""min":[0,0,0],"max":[1,1,1]"#;
    data.accessor(&format!(
        r#"{bounds},"bufferView":{view},"componentType":5120,"normalized":true,"count":3,"type":"VEC3","sparse":{{"count":1,
            "indices":{{"bufferView":{at},"componentType":5121}},"values":{{"bufferView":{values}}}}}"#
    ));
    // Normals without data are zero, and so those of the triangle are taken.
    data.accessor(r#""componentType":5126,"count":3,"type":"VEC3""#);
    let rest = r#""nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1}}]}],
        "extensionsUsed":["KHR_mesh_quantization"],"extensionsRequired":["KHR_mesh_quantization"]"#;
    let json = data.json(None, rest).replacen(r#""byteLength":11}"#, r#""byteLength":11,"byteStride":4}"#, 1);
    let scene = gltf::load_slice(&gltf_support::container(&json, &data.bytes), "".as_ref()).unwrap();
    let mesh = mesh(&scene, 0);
    assert_eq!(mesh.positions(), [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(mesh.normals(), [[0.0; 3]; 3]);
}

#[test]
fn buffers_may_be_anywhere() {
    let rest = with_material("", "");
    let data = square();
    let expected = mesh(&data.load(&rest), 0).clone();
    // Base64, with and without a media type.
    for media in ["application/octet-stream", ""] {
        let json = data.json(Some(&format!("data:{media};base64,{}", base64(&data.bytes))), &rest);
        let scene = gltf::load_slice(json.as_bytes(), "".as_ref()).unwrap();
        assert_eq!(mesh(&scene, 0), &expected);
    }
    // A file whose name has to be decoded.
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a b.bin"), &data.bytes).unwrap();
    let path = folder.path().join("scene.gltf");
    std::fs::write(&path, data.json(Some("a%20b.bin"), &rest)).unwrap();
    let scene = gltf::load(&path).unwrap();
    assert_eq!((mesh(&scene, 0), scene.name.as_str()), (&expected, "scene"));
    assert_eq!(scene.source.as_deref(), Some(path.as_path()));
}

#[test]
fn cameras_look_along_minus_z() {
    let camera = r#"{"type":"perspective","perspective":{"yfov":0.8,"aspectRatio":2,"znear":0.1}}"#;
    let rest = format!(
        r#"{},"cameras":[{camera},{{"type":"orthographic","orthographic":{{"xmag":1,"ymag":1,"znear":0,"zfar":1}}}}]"#,
        with_material("", "")
    );
    let at = r#""translation":[0.5,0.5,3]"#;
    let nodes = |nodes: &str| rest.replace(r#""nodes":[{"mesh":0}]"#, &format!(r#""nodes":[{{"mesh":0}},{nodes}]"#));
    let scene = square().load(&nodes(&format!(r#"{{"camera":0,{at}}}"#)));
    assert_eq!((scene.camera.width, scene.camera.height), (640, 320));
    assert!((scene.camera.fov_x - 2.0 * (2.0 * 0.4f32.tan()).atan()).abs() < 1e-6);
    let scene = ReferenceScene::new(scene).unwrap();
    let ray = scene.sensor().sample_ray([320.0, 160.0], [0.0; 2]).ray;
    near(ray.origin, [0.5, 0.5, 3.0]);
    near(ray.direction, [0.0, 0.0, -1.0]);
    // Right and down in the picture are right and down in the world.
    let corner = scene.sensor().sample_ray([640.0, 320.0], [0.0; 2]).ray.direction;
    assert!(corner.x > 0.1 && corner.y < -0.1, "{corner}");

    let warnings = square().warnings(&nodes(&format!(r#"{{"camera":1,{at}}},{{"camera":0}},{{"camera":0}}"#)));
    assert_eq!(
        warnings,
        ["cameras[1]: left out: a camera that is not perspective", "cameras[0]: of 2 cameras this one is taken"]
    );
}

#[test]
fn the_default_camera_holds_the_scene_and_the_default_light_is_white() {
    let rest = with_material("", "").replace(r#"{"mesh":0}"#, r#"{"mesh":0,"scale":[30,2,1],"translation":[5,6,7]}"#);
    let description = square().import(&rest).unwrap();
    assert_eq!(
        description.warnings,
        [
            "folder/<bytes>: asset: there is no light: a constant environment of radiance 1 is added",
            "folder/<bytes>: asset: there is no camera: a default one shows the whole scene"
        ]
    );
    assert!(matches!(description.lights[..], [Light::Constant { radiance }] if radiance == Rgb::ONE));
    let scene = ReferenceScene::new(description).unwrap();
    for corner in [[5.0, 6.0, 7.0], [35.0, 6.0, 7.0], [35.0, 8.0, 7.0], [5.0, 8.0, 7.0]] {
        let seen = scene.sensor().connect(Vec3A::from(corner), [0.0; 2]).unwrap().raster;
        assert!(seen[0] > 0.0 && seen[0] < 640.0 && seen[1] > 0.0 && seen[1] < 480.0, "{corner:?}: {seen:?}");
    }
    // From in front, above and to the right.
    let direction = scene.sensor().sample_ray([320.0, 240.0], [0.0; 2]).ray.direction;
    near(direction, (Vec3A::new(-0.5, -0.4, -1.0).normalize()).to_array());
    // An asset without surfaces is an empty, lit world.
    assert!(ReferenceScene::new(Data::default().load("")).is_ok());
}

#[test]
fn punctual_lights_keep_their_values() {
    let lights = r#""extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[
        {"type":"point","color":[1,0.5,0.25],"intensity":8},
        {"type":"directional","intensity":3},
        {"type":"spot","spot":{"innerConeAngle":0.2,"outerConeAngle":0.5}},
        {"type":"spot","spot":{},"range":5,"name":"Lamp"}]}}"#;
    // A quarter turn about x takes -z to +y.
    let node = |i: usize| {
        format!(
            r#"{{"translation":[1,2,3],"rotation":[0.70710678,0,0,0.70710678],"scale":[2,2,2],"extensions":{{"KHR_lights_punctual":{{"light":{i}}}}}}}"#
        )
    };
    let nodes: Vec<String> = (0..3).map(node).collect();
    let scene = Data::default().load(&format!(r#"{lights},"nodes":[{}]"#, nodes.join(",")));
    let [Light::Point { position, intensity }, Light::Directional { direction, irradiance }, Light::Spot { .. }] =
        &scene.lights[..]
    else {
        panic!("{:?}", scene.lights)
    };
    near(*position, [1.0, 2.0, 3.0]);
    near(*direction, [0.0, 1.0, 0.0]);
    assert_eq!((intensity.to_array(), irradiance.to_array()), ([8.0, 4.0, 2.0], [3.0; 3]));
    let Light::Spot { direction, intensity, beam_width, cutoff, .. } = &scene.lights[2] else { panic!() };
    near(*direction, [0.0, 1.0, 0.0]);
    assert_eq!((intensity.to_array(), *beam_width, *cutoff), ([1.0; 3], 0.2, 0.5));
    // Lights are checked before that.
    assert_eq!(ReferenceScene::new(scene).unwrap_err(), SceneError::Empty);
    let warnings = Data::default().warnings(&format!(r#"{lights},"nodes":[{}]"#, node(3)));
    assert_eq!(warnings, ["lights[3] `Lamp`: ignored: the range, beyond which it would not shine"]);
}

#[test]
fn what_is_passed_over_is_counted() {
    let mut data = square();
    data.floats(&[[1.0; 3]; 4]);
    let primitive = r#"{"indices":0,"attributes":{"POSITION":1,"COLOR_0":4}}"#;
    let warnings = data.warnings(&format!(
        r#""extensionsUsed":["EXT_nothing","KHR_materials_ior"],
        "meshes":[{{"primitives":[{primitive},{primitive},{{"mode":1,"attributes":{{"POSITION":1}}}}],"name":"Box"}}],
        "nodes":[{{"mesh":0}},{{"mesh":0,"scale":[0,1,1],"name":"Hidden"}}],"scenes":[{{"nodes":[0,1]}},{{"nodes":[]}}]"#
    ));
    assert_eq!(
        warnings,
        [
            "asset: ignored: the extension `EXT_nothing`",
            "scenes[0]: of 2 scenes this one is taken",
            "meshes[0] `Box`, primitives[0]: ignored: COLOR_0 (2 times)",
            "meshes[0] `Box`, primitives[2]: left out: a primitive of Lines",
            "nodes[1] `Hidden`: its mesh is scaled to nothing, and left out",
        ]
    );
}
