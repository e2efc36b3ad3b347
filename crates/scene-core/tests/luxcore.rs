//! The importer for LuxCore's format: what files mean, and what becomes of bad ones.
#![cfg(feature = "luxcore")]
#![allow(clippy::unwrap_used)]

use std::f32::consts::PI;
use std::path::Path;

use proptest::prelude::*;
use scene_core::glam::Vec3A;
use scene_core::luxcore::{self, ImportError};
use scene_core::material::Material;
use scene_core::reference::Light;
use scene_core::{Emitter, Ray, ReferenceScene, Rgb, Scene, SceneDescription, Sensor, Vertex};

/// Two triangles, the unit square at z = 0 with normal +z; without normals of its own.
const SQUARE: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    element face 2\nproperty list uchar uint vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

const SCENE: &str = r#"# A comment.
scene.camera.type = "perspective"
scene.camera.lookat.orig = 0.5 0.5 5
scene.camera.lookat.target = 0.5 0.5 0
scene.camera.up = 0 1 0
scene.camera.fieldofview = 60
scene.camera.screenwindow = -1 1 -0.5 0.5
scene.materials.lamp.type = "matte"
scene.materials.lamp.kd = "0.25 0.5 0.75"
scene.materials.lamp.emission = "1 2 3"
scene.materials.lamp.emission.gain = 2 2 0.5

scene.materials.wall.type = "matte"
scene.objects.a.ply = "square.ply"
scene.objects.a.material = "lamp"
scene.objects.b.ply = "square.ply"
scene.objects.b.material = "wall"
scene.objects.b.transformation = 2 0 0 0 0 3 0 0 0 0 1 0 10 20 30 1
"#;

/// A folder with the mesh.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("square.ply"), SQUARE).unwrap();
    folder
}

fn import(text: &str) -> Result<SceneDescription, ImportError> {
    luxcore::load_str(text, folder().path())
}

fn message(text: &str) -> String {
    import(text).unwrap_err().to_string()
}

/// The radiance of the lamp with additional properties of its emission.
fn radiance(additional: &[&str]) -> Rgb {
    let lines: String = additional.iter().map(|line| format!("scene.materials.lamp.emission.{line}\n")).collect();
    let scene = import(&format!("{SCENE}{lines}")).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    scene.instances[0].radiance.unwrap()
}

fn near(a: Rgb, b: [f32; 3]) {
    assert!((0..3).all(|c| (a[c] - b[c]).abs() <= 1e-5 * b[c].abs()), "{a:?} {b:?}");
}

#[test]
fn a_scene_is_read() {
    let description = import(SCENE).unwrap();
    assert!(description.warnings.is_empty(), "{:?}", description.warnings);
    // One mesh for both.
    assert_eq!((description.shapes.len(), description.instances.len(), description.materials.len()), (1, 2, 2));
    let camera = &description.camera;
    assert_eq!((camera.width, camera.height), (640, 320));
    assert!((camera.fov_x.to_degrees() - 60.0).abs() < 1e-4);
    assert_eq!(description.instances[1].radiance, None);
    assert_eq!(description.instances[1].to_world.transform_point3a(Vec3A::ONE), Vec3A::new(12.0, 23.0, 31.0));
    let Material::TwoSided { front, .. } = &description.materials[0] else { panic!("one-sided") };
    let Material::Diffuse { reflectance } = &**front else { panic!("{front:?}") };
    assert_eq!(reflectance.eval([0.0; 2]), Rgb::new(0.25, 0.5, 0.75));

    let scene = ReferenceScene::new(description).unwrap();
    near(scene.emitters()[0].power(), [2.0 * PI, 4.0 * PI, 1.5 * PI]);
    // x grows to the right, and y upwards: the square covers the middle of the image.
    let corner = scene.sensor().sample_ray([0.0, 0.0], [0.0; 2]).ray;
    assert!(corner.direction.x < -0.1 && corner.direction.y > 0.1 && corner.direction.z < 0.0);
    let middle = scene.sensor().sample_ray([320.0, 160.0], [0.0; 2]).ray;
    assert_eq!(scene.intersect(&middle).unwrap().emitted(), Rgb::new(2.0, 4.0, 1.5));
    // It emits to the side of its normal only.
    let from_behind = scene.intersect(&Ray::new(Vec3A::new(0.5, 0.5, -1.0), Vec3A::Z)).unwrap();
    assert_eq!(from_behind.emitted(), Rgb::ZERO);
}

#[test]
fn emission_follows_its_formula() {
    near(radiance(&[]), [2.0, 4.0, 1.5]);
    let y = 0.212_671 + 2.0 * 0.715_160 + 3.0 * 0.072_169;
    near(radiance(&["gain.normalizebycolor = 1"]), [2.0 / y, 4.0 / y, 1.5 / y]);
    // Power alone, or efficiency alone, is nothing.
    near(radiance(&["power = 100"]), [2.0, 4.0, 1.5]);
    // 100 W at 17 lm/W over an area of one.
    let watts = 1700.0 / PI;
    let lamp = ["power = 100", "efficency = 17"];
    near(radiance(&lamp), [2.0, 4.0, 1.5].map(|c| c * watts / y));
    near(radiance(&["power = 100", "efficiency = 17"]), [2.0, 4.0, 1.5].map(|c| c * watts / y));
    near(radiance(&[lamp[0], lamp[1], "normalizebycolor = 0"]), [2.0, 4.0, 1.5].map(|c| c * watts));
    // Six times the area.
    let scaled = SCENE.replace("objects.b.material = \"wall\"", "objects.b.material = \"lamp\"")
        + "scene.materials.lamp.emission.power = 100\nscene.materials.lamp.emission.efficency = 17\n";
    let scene = import(&scaled).unwrap();
    let radiances = [0, 1].map(|i| scene.instances[i].radiance.unwrap()[0]);
    assert!((radiances[0] / radiances[1] - 6.0).abs() < 1e-4, "{radiances:?}");
    // Black in one way or the other.
    for (from, to) in [("\"1 2 3\"", "0"), ("gain = 2 2 0.5", "gain = 0 0 0")] {
        assert_eq!(import(&SCENE.replace(from, to)).unwrap().instances[0].radiance, None);
    }
}

#[test]
fn mirrored_meshes_keep_their_outside() {
    let mirrored = format!("{SCENE}scene.objects.a.transformation = -1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 1\n");
    let scene = ReferenceScene::new(import(&mirrored).unwrap()).unwrap();
    let from_above = scene.intersect(&Ray::new(Vec3A::new(0.5, 0.5, 1.0), -Vec3A::Z)).unwrap();
    assert_eq!(from_above.emitted(), Rgb::new(2.0, 4.0, 1.5));
}

#[test]
fn cameras_follow_lens_and_window() {
    let tall = SCENE.replace("-1 1 -0.5 0.5", "-0.5 0.5 -1 1") + "scene.camera.lensradius = 0.1\n";
    let camera = import(&tall).unwrap().camera;
    assert_eq!((camera.width, camera.height, camera.aperture_radius, camera.focus_distance), (640, 1280, 0.1, 10.0));
    assert!((camera.fov_x - 2.0 * (0.5 * (PI / 6.0).tan()).atan()).abs() < 1e-6);
    let without = SCENE.replace("scene.camera.screenwindow = -1 1 -0.5 0.5\n", "");
    assert_eq!(import(&without).unwrap().camera.height, 480);
}

#[test]
fn other_materials_and_lights() {
    let more = SCENE.replace("wall.type = \"matte\"", "wall.type = \"glass\"")
        + "scene.materials.wall.interiorior = 1.33\nscene.lights.sky.type = \"constantinfinite\"\n\
           scene.lights.sky.gain = 2 2 2\nscene.lights.sky.color = 0.5 1 1\n";
    let scene = import(&more).unwrap();
    assert!(matches!(scene.materials[1], Material::Dielectric { int_ior: 1.33, .. }));
    assert!(matches!(scene.lights[..], [Light::Constant { radiance }] if radiance == Rgb::new(1.0, 2.0, 2.0)));
    let mirror = import(&SCENE.replace("wall.type = \"matte\"", "wall.type = \"mirror\"")).unwrap();
    assert!(matches!(&mirror.materials[1], Material::TwoSided { front, .. } if front.name() == "conductor"));
}

#[test]
fn what_is_unknown_is_warned_of_once_with_its_place() {
    let text = format!(
        "{SCENE}scene.objects.a.sparkle = 1\nscene.objects.b.sparkle = 2\nfilm.width = 3\n\
         scene.textures.t.type = \"constant1\"\nscene.materials.unused.type = \"velvet\"\nscene.camera.type = \"perspective\"\n"
    );
    let warnings = import(&text).unwrap().warnings;
    assert_eq!(warnings.len(), 4, "{warnings:#?}");
    assert!(warnings[0].ends_with(":19: unknown property `sparkle` of the object (2 times)"), "{}", warnings[0]);
    assert!(warnings.iter().any(|w| w.ends_with(":21: unknown property `film.width`")));
    assert!(warnings.iter().any(|w| w.ends_with(":22: ignored: the texture `t`")));
    assert!(warnings.iter().any(|w| w.ends_with(":23: no object has the material `unused`")));
}

#[test]
fn bad_input_is_an_error_with_file_and_line() {
    let replace = |from: &str, to: &str| {
        assert!(SCENE.contains(from));
        message(&SCENE.replace(from, to))
    };
    for (from, to, expected) in [
        ("fieldofview = 60", "fieldofview 60", ":6: a line must be `name = value`"),
        ("fieldofview = 60", "fieldofview = ", ":6: a line must be `name = value`"),
        ("fieldofview = 60", "fieldofview = 180", "a `fieldofview` of 180 degrees"),
        ("fieldofview = 60", "fieldofview = NaN", ":6: `fieldofview`: `NaN` is no finite number"),
        ("fieldofview = 60", "fieldofview = 1 2", ":6: `fieldofview` needs 1 numbers and has 2"),
        ("fieldofview = 60", "lensradius = -1", "make no lens"),
        ("0.5 0.5 5", "0.5 0.5 0", "gives no direction"),
        ("up = 0 1 0", "up = 0 0 1", "gives no direction"),
        ("up = 0 1 0", "up = 0 1 1e300", "is no finite number"),
        ("-1 1 -0.5 0.5", "1 -1 -0.5 0.5", ":7: the `screenwindow` is empty"),
        ("-1 1 -0.5 0.5", "-1 2 -0.5 0.5", ":7: a `screenwindow` that is not around the middle is not supported"),
        ("\"perspective\"", "\"environment\"", ":2: unknown type of camera `environment`"),
        ("lamp.type = \"matte\"", "lamp.type = \"velvet\"", ":8: unknown type of material `velvet`"),
        ("lamp.type = \"matte\"", "lamp.id = 1", ":8: the material `lamp` has no `type`"),
        ("\"0.25 0.5 0.75\"", "\"wood\"", ":9: the texture `wood` is not supported"),
        ("\"0.25 0.5 0.75\"", "\"0.25 0.5\"", ":9: `kd` needs one number or three and has 2"),
        ("\"1 2 3\"", "\"glow\"", ":10: the texture `glow` as emission is not supported"),
        ("\"1 2 3\"", "\"1 -2 3\"", ":10: emission must not be negative"),
        ("emission.gain = 2 2 0.5", "emission.theta = 20", ":10: an `emission.theta` below 90 is not supported"),
        ("emission.gain = 2 2 0.5", "emission.temperature = 6500", "`emission.temperature` is not supported"),
        ("a.material = \"lamp\"", "a.material = \"lump\"", ":15: there is no material `lump`"),
        ("scene.objects.a.material = \"lamp\"\n", "", ":14: the object `a` has no `material`"),
        ("a.ply = \"square.ply\"", "a.ply = \"round.ply\"", "(named at "),
        ("a.ply", "a.shape", ":14: an object with a `shape` is not supported"),
        ("30 1\n", "30 1 1\n", ":18: `transformation` needs 16 numbers and has 17"),
        ("30 1\n", "30 2\n", ":18: the transformation is not affine"),
        ("= 2 0 0 0 0 3", "= 2 0 0 0 0 0", ":18: the transformation has no inverse"),
    ] {
        let message = replace(from, to);
        assert!(message.contains(expected), "{to}: {message}");
    }
    assert!(message("scene.materials.m.type = \"matte\"").contains("has no camera"));
    assert!(matches!(luxcore::load(Path::new("nowhere.scn")), Err(ImportError::Read { .. })));
}

#[test]
fn bad_meshes_name_file_and_line() {
    let folder = folder();
    let path = folder.path().join("square.ply");
    for bad in
        ["", "ply\nformat ascii 1.0\nend_header\n", &SQUARE[..SQUARE.len() - 4], &SQUARE.replace("3 0 2 3", "3 0 2 9")]
    {
        std::fs::write(&path, bad).unwrap();
        let message = luxcore::load_str(SCENE, folder.path()).unwrap_err().to_string();
        assert!(message.starts_with(&path.display().to_string()) && message.contains("<text>:14)"), "{message}");
    }
    // What can be used remains.
    std::fs::write(&path, SQUARE.replace("1 1 0\n", "1 1e39 0\n")).unwrap();
    let description = luxcore::load_str(SCENE, folder.path()).unwrap();
    assert!(description.warnings[0].contains("2 triangles are dropped, 2 with"), "{:?}", description.warnings);
    assert_eq!(ReferenceScene::new(description).err(), Some(scene_core::SceneError::Empty));
}

proptest! {
    /// Any change of a file gives a scene or an error.
    #[test]
    fn no_text_makes_it_panic(cut in 0..SCENE.len(), at in 0..SCENE.len(), inserted in "[-0-9a-z.\"'= \n#]{0,8}") {
        let mut text = SCENE[..cut].to_owned();
        let at = at.min(text.len());
        text.insert_str(at, &inserted);
        drop(import(&text));
        let mut text = SCENE.to_owned();
        text.insert_str(at, &inserted);
        if let Ok(description) = import(&text) {
            drop(ReferenceScene::new(description));
        }
    }
}
