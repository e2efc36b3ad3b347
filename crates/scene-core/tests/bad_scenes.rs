//! Bad input: every error with its message, what is dropped with a warning, and what is merely odd.

#![cfg(feature = "reference")]
// Helper functions of tests may unwrap.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;
use std::time::Instant;

use estimator_checks::Uniforms;
use scene_core::builtin::SceneBuilder;
use scene_core::glam::{Affine3A, Mat3A, Vec3, Vec3A};
use scene_core::material::Material;
use scene_core::reference::{Instance, Light, MaterialId, MeshError, SceneDescription, Shape, ShapeId, TriangleMesh};
use scene_core::texture::Image;
use scene_core::{PowerChoice, Ray, ReferenceScene, Rgb, Scene, SceneError, UniformChoice};

fn mesh(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Shape {
    Shape::Mesh(Arc::new(TriangleMesh::new(positions, vec![], vec![], triangles).unwrap()))
}

fn triangle() -> Shape {
    mesh(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])
}

/// One triangle, changed.
fn with(change: impl FnOnce(&mut SceneDescription)) -> Result<ReferenceScene, SceneError> {
    let mut b = SceneBuilder::new("bad");
    let grey = b.diffuse(0.5, 0.5, 0.5);
    b.place(triangle(), grey, Affine3A::IDENTITY);
    change(b.description());
    ReferenceScene::new(b.finish())
}

/// The scene is refused, in one line that says all of `words`.
fn refused(words: &[&str], change: impl FnOnce(&mut SceneDescription)) {
    let message = with(change).expect_err(words[0]).to_string();
    assert!(words.iter().all(|word| message.contains(word)), "{message:?} lacks one of {words:?}");
    assert!(!message.contains('\n'));
}

fn place(shape: Shape, to_world: Affine3A) -> impl FnOnce(&mut SceneDescription) {
    move |d| {
        d.shapes = vec![shape];
        d.instances[0].to_world = to_world;
    }
}

fn light(light: Light) -> impl FnOnce(&mut SceneDescription) {
    move |d| d.lights.push(light)
}

fn matrix(matrix3: Mat3A) -> Affine3A {
    Affine3A { matrix3, translation: Vec3A::ZERO }
}

fn sphere(radius: f32) -> Shape {
    Shape::Sphere { center: Vec3A::ZERO, radius, flip_normals: false }
}

fn down(x: f32, y: f32) -> Ray {
    Ray::new(Vec3A::new(x, y, 5.0), -Vec3A::Z)
}

#[test]
fn empty_scenes_are_refused_and_dark_ones_are_not() {
    refused(&["empty", "no surface and no environment"], |d| d.instances.clear());
    refused(&["empty"], |d| {
        d.instances.clear();
        d.lights.push(Light::Point { position: Vec3A::ZERO, intensity: Rgb::ONE });
    });
    let only_sky = with(|d| {
        d.instances.clear();
        d.lights.push(Light::Constant { radiance: Rgb::ONE });
    });
    let only_sky = only_sky.unwrap();
    assert!(only_sky.intersect(&down(0.0, 0.0)).is_none() && !only_sky.occluded(&down(0.0, 0.0)));
    assert!(only_sky.bounding_sphere().1 > 0.0);

    let dark = with(|_| {}).unwrap();
    assert!(dark.emitters().is_empty() && dark.environment().is_none());
    assert_eq!(dark.environment_radiance(Vec3A::Z), Rgb::ZERO);
    use scene_core::EmitterChoice;
    assert!(PowerChoice::new(dark.emitters()).choose(None, 0.5).is_none());
    assert!(UniformChoice::new(dark.emitters().len()).choose(None, 0.5).is_none());
}

#[test]
fn references_must_exist() {
    refused(&["instance 0", "shape 7", "only 1"], |d| d.instances[0].shape = ShapeId(7));
    refused(&["instance 0", "material 3", "only 1"], |d| d.instances[0].material = MaterialId(3));
    let lost =
        |d: &mut SceneDescription| d.instances.push(Instance { shape: ShapeId(u32::MAX), ..d.instances[0].clone() });
    refused(&["instance 1", "shape 4294967295"], lost);
}

#[test]
fn transforms_must_have_an_inverse() {
    let flat = matrix(Mat3A::from_diagonal(Vec3::new(1.0, 1.0, 0.0)));
    let nan = Affine3A::from_translation(Vec3::new(f32::NAN, 0.0, 0.0));
    let stretched = matrix(Mat3A::from_diagonal(Vec3::new(1.0, 2.0, 1.0)));
    refused(&["instance 0", "no inverse"], place(Shape::Disk, flat));
    refused(&["instance 0", "no inverse"], place(Shape::Disk, nan));
    refused(&["instance 0", "not finite"], place(triangle(), nan));
    refused(&["instance 0", "positive radius"], place(sphere(1.0), stretched));
    refused(&["instance 0", "positive radius"], place(sphere(1.0), nan));
    refused(&["instance 0", "positive radius"], place(sphere(1.0), matrix(Mat3A::ZERO)));
    for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        refused(&["instance 0", "positive radius"], place(sphere(radius), Affine3A::IDENTITY));
    }
    let nowhere = Shape::Sphere { center: Vec3A::NAN, radius: 1.0, flip_normals: false };
    refused(&["instance 0"], place(nowhere, Affine3A::IDENTITY));
}

#[test]
fn a_flattened_mesh_loses_its_triangles_with_a_warning() {
    let flat = matrix(Mat3A::from_diagonal(Vec3::new(0.0, 1.0, 1.0)));
    let scene = with(|d| {
        d.instances.push(d.instances[0].clone());
        d.shapes.push(triangle());
        d.instances[1].shape = ShapeId(1);
        d.instances[1].to_world = flat;
        d.instances[1].radiance = Some(Rgb::ONE);
    });
    let scene = scene.unwrap();
    let all = scene.warnings().join("\n");
    assert!(all.contains("instance 1: its transform leaves 1 triangles without area"), "{all}");
    assert!(all.contains("instance 1: emits, but has no area"), "{all}");
    assert!(scene.emitters().is_empty() && scene.triangle_count() == 1);
}

#[test]
fn light_must_be_finite_and_somewhere() {
    let one = Rgb::ONE;
    for bad in [Rgb::splat(-1.0), Rgb::new(0.0, f32::NAN, 0.0), Rgb::new(f32::INFINITY, 0.0, 0.0)] {
        refused(&["radiance of instance 0", "finite and not negative"], |d| d.instances[0].radiance = Some(bad));
        refused(&["point light 0"], light(Light::Point { position: Vec3A::ZERO, intensity: bad }));
        refused(&["constant light 0"], light(Light::Constant { radiance: bad }));
        refused(&["directional light 0"], light(Light::Directional { direction: Vec3A::X, irradiance: bad }));
    }
    let spot = |direction, beam_width, cutoff| Light::Spot {
        position: Vec3A::ZERO,
        direction,
        intensity: one,
        beam_width,
        cutoff,
    };
    refused(&["spot light 0", "direction [0, 0, 0]"], light(spot(Vec3A::ZERO, 0.1, 0.2)));
    refused(&["spot light 0", "cutoff of NaN"], light(spot(Vec3A::X, 0.1, f32::NAN)));
    refused(&["spot light 0", "beam width of NaN"], light(spot(Vec3A::X, f32::NAN, 0.2)));
    refused(&["spot light 0", "cutoff of 0"], light(spot(Vec3A::X, 0.0, 0.0)));
    refused(&["point light 0", "NaN"], light(Light::Point { position: Vec3A::NAN, intensity: one }));
    refused(&["directional light 0", "NaN"], light(Light::Directional { direction: Vec3A::NAN, irradiance: one }));
    assert!(with(light(spot(Vec3A::X, 9.0, 0.2))).is_ok(), "a beam wider than the cutoff is cut off");
}

fn environment(value: f32, scale: f32, to_world: Affine3A) -> Light {
    let image = Image::from_rgb(4, 2, vec![[value; 3]; 8]).unwrap();
    Light::Environment { image: Arc::new(image), scale, to_world }
}

#[test]
fn there_is_one_environment_without_distortion() {
    refused(&["2 environments"], |d| {
        d.lights = vec![Light::Constant { radiance: Rgb::ONE }, environment(1.0, 1.0, Affine3A::IDENTITY)];
    });
    for scale in [f32::NAN, -1.0] {
        refused(&["environment light 0"], light(environment(1.0, scale, Affine3A::IDENTITY)));
    }
    for bad in [Mat3A::ZERO, Mat3A::NAN, Mat3A::from_diagonal(Vec3::new(1.0, 2.0, 1.0))] {
        refused(&["environment light 0", "no rotation"], light(environment(1.0, 1.0, matrix(bad))));
    }
    let black = with(light(environment(0.0, 1.0, Affine3A::IDENTITY))).unwrap();
    assert!(black.environment().is_none() && black.warnings()[0].contains("environment light 0 is black"));
    let too_bright = with(light(environment(1e38, 100.0, Affine3A::IDENTITY))).unwrap();
    assert_eq!(too_bright.environment_radiance(Vec3A::Y), Rgb::ZERO, "infinite pixels are black");
}

#[test]
fn cameras_must_make_sense() {
    for size in [0, 65_537, u32::MAX] {
        refused(&[&format!("{size} x 512"), "between 1 and 65536"], |d| d.camera.width = size);
    }
    for fov in [0.0, -1.0, 3.2, f32::NAN] {
        refused(&["angle of view", "between 0 and 180"], |d| d.camera.fov_x = fov);
    }
    refused(&["aperture radius -1"], |d| d.camera.aperture_radius = -1.0);
    refused(&["focus distance 0"], |d| (d.camera.aperture_radius, d.camera.focus_distance) = (0.1, 0.0));
    for bad in [Mat3A::ZERO, Mat3A::NAN, Mat3A::from_cols(Vec3A::X, Vec3A::X, Vec3A::Z)] {
        refused(&["camera transform", "no inverse"], |d| d.camera.to_world.matrix3 = bad);
    }
    refused(&["camera transform"], |d| d.camera.to_world.translation = Vec3A::NAN);
}

#[test]
fn materials_are_named_by_their_index() {
    refused(&["material 1", "diffuse"], |d| d.materials.push(Material::diffuse(f32::NAN)));
}

#[test]
fn meshes_report_what_does_not_fit() {
    let positions = vec![[0.0; 3]; 3];
    let error = |normals, uvs, triangles| TriangleMesh::new(positions.clone(), normals, uvs, triangles).unwrap_err();
    let out = error(vec![], vec![], vec![[0, 1, 3]]);
    assert_eq!(out, MeshError::IndexOutOfRange { triangle: 0, vertex: 3, count: 3 });
    assert!(out.to_string().contains("triangle 0 refers to vertex 3, but there are only 3"));
    assert!(error(vec![[0.0; 3]; 2], vec![], vec![]).to_string().contains("2 normals for 3 vertices"));
    assert!(error(vec![], vec![[0.0; 2]; 4], vec![]).to_string().contains("4 texture coordinates for 3 vertices"));
}

#[test]
fn nan_vertices_and_degenerate_triangles_are_dropped() {
    let bad = [[f32::NAN, 0.0, 0.0], [0.0, f32::INFINITY, 0.0], [3e38, -3e38, 3e38]];
    let mut positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]];
    positions.extend(bad);
    let triangles = vec![[0, 1, 4], [0, 1, 5], [0, 1, 2], [0, 1, 3], [1, 1, 2], [0, 4, 6]];
    let mesh = TriangleMesh::new(positions, vec![], vec![], triangles).unwrap();
    assert_eq!((mesh.len(), mesh.dropped()), (1, 5));
    let scene = with(place(Shape::Mesh(Arc::new(mesh)), Affine3A::IDENTITY)).unwrap();
    assert!(scene.intersect(&down(0.2, 0.2)).is_some());
    assert!(scene.bounding_sphere().1 < 2.0);

    // Nothing but degenerate triangles is an empty scene, with or without instances.
    let point = || mesh_of_points(1000);
    refused(&["empty"], place(point(), Affine3A::IDENTITY));
    let twice = with(|d| {
        d.shapes = vec![point(), triangle()];
        d.instances.extend([d.instances[0].clone(), d.instances[0].clone()]);
        d.instances[2].shape = ShapeId(1);
    });
    let twice = twice.unwrap();
    assert!(twice.intersect(&down(0.2, 0.2)).is_some() && twice.intersect(&down(-0.2, 0.2)).is_none());
    let (center, radius) = twice.bounding_sphere();
    assert!(center.is_finite() && radius.is_finite(), "{center} {radius}");
}

fn mesh_of_points(n: u32) -> Shape {
    mesh(vec![[0.3, 0.1, 0.7]; 3 * n as usize], (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// Normals and texture coordinates that are zero or NaN do not reach the shading.
#[test]
fn bad_attributes_are_replaced() {
    use scene_core::Vertex;
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for normal in [[0.0; 3], [f32::NAN; 3], [f32::INFINITY, 0.0, 0.0]] {
        let mesh =
            TriangleMesh::new(positions.clone(), vec![normal; 3], vec![[f32::NAN; 2]; 3], vec![[0, 1, 2]]).unwrap();
        let scene = with(place(Shape::Mesh(Arc::new(mesh)), Affine3A::IDENTITY)).unwrap();
        let vertex = scene.intersect(&down(0.2, 0.2)).unwrap();
        assert_eq!(vertex.shading_normal(), Vec3A::Z);
        assert_eq!(vertex.point().uv, [0.0; 2]);
    }
}

/// Building must not take quadratic time where boxes or centres coincide. The limit is generous: seconds, not minutes.
fn builds_quickly(what: &str, change: impl FnOnce(&mut SceneDescription)) -> ReferenceScene {
    let start = Instant::now();
    let scene = with(change).unwrap();
    let seconds = start.elapsed().as_secs_f64();
    assert!(seconds < 20.0, "{what}: {seconds} s");
    scene
}

const MANY: usize = 100_000;

/// Triangles whose corners are chosen by number.
fn heap(count: usize, corner: impl Fn(usize, u32) -> [f32; 3]) -> Shape {
    let positions = (0..count).flat_map(|i| [0, 1, 2].map(|k| corner(i, k))).collect();
    mesh(positions, (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

#[test]
fn heaps_of_coincident_triangles_build_quickly() {
    const CORNERS: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let same = heap(MANY, |_, k| CORNERS[k as usize]);
    let scene = builds_quickly("the same triangle", place(same, Affine3A::IDENTITY));
    assert!(scene.intersect(&down(0.2, 0.2)).is_some() && !scene.occluded(&down(0.8, 0.8)));

    let turned = heap(MANY, |i, k| CORNERS[(k as usize + i) % 3]);
    let scene = builds_quickly("the same triangle, turned", place(turned, Affine3A::IDENTITY));
    assert!(scene.intersect(&down(0.2, 0.2)).is_some());

    // Different triangles in one box: from corner to corner, over any third point.
    let uniforms: Vec<f32> = {
        let mut uniforms = Uniforms::named("third corners");
        (0..3 * MANY).map(|_| uniforms.next_f32()).collect()
    };
    let one_box = heap(MANY, |i, k| match k {
        0 => [0.0; 3],
        1 => [1.0; 3],
        _ => [uniforms[3 * i], uniforms[3 * i + 1], uniforms[3 * i + 2]],
    });
    let scene = builds_quickly("one box", place(one_box, Affine3A::IDENTITY));
    assert!(scene.occluded(&down(0.5, 0.4)));

    // Boxes one in another, with different centres: the builder is quadratic here, so these are fewer.
    let nested = heap(4_000, |i, k| CORNERS[k as usize].map(|x| (x - 1.0 / 3.0) * (1.0 + i as f32 * 1e-5)));
    let scene = builds_quickly("nested boxes", place(nested, Affine3A::IDENTITY));
    assert!(scene.occluded(&down(0.0, 0.0)));
}

#[test]
fn heaps_of_coincident_instances_build_quickly() {
    for shape in [sphere(1.0), Shape::Disk] {
        let scene = builds_quickly("instances in one place", |d| {
            place(shape, Affine3A::IDENTITY)(d);
            d.instances = vec![d.instances[0].clone(); 50_000];
        });
        assert!(scene.intersect(&down(0.2, 0.2)).is_some() && !scene.occluded(&down(2.0, 0.2)));
    }
}

#[test]
fn rays_that_make_no_sense_hit_nothing() {
    let scene = with(|d| {
        let [triangle, sphere, disk] = [triangle(), sphere(1.0), Shape::Disk];
        d.shapes = vec![triangle, sphere, disk];
        d.instances = (0..3).map(|i| Instance { shape: ShapeId(i), ..d.instances[0].clone() }).collect();
    });
    let scene = scene.unwrap();
    assert!(scene.occluded(&down(0.2, 0.2)));
    let values = [0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for bad in values.into_iter().flat_map(|x| [Vec3A::splat(x), Vec3A::new(x, 0.3, -1.0)]) {
        let rays = [Ray::new(bad, -Vec3A::Z), Ray::new(Vec3A::new(0.2, 0.2, 5.0), bad)];
        for ray in rays {
            let sound = ray.origin.is_finite() && ray.direction.is_finite() && ray.direction != Vec3A::ZERO;
            assert!(sound || (scene.intersect(&ray).is_none() && !scene.occluded(&ray)), "{ray:?}");
        }
    }
    for end in [0.0, -1.0, f32::NAN] {
        let ray = down(0.2, 0.2).up_to(end);
        assert!(scene.intersect(&ray).is_none() && !scene.occluded(&ray), "{end}");
    }
    // Numbers near the limits of f32, but in order.
    for origin in [1e30, 3e38] {
        let ray = Ray::new(Vec3A::new(0.2, 0.2, origin), -Vec3A::Z);
        if let Some(vertex) = scene.intersect(&ray) {
            use scene_core::Vertex;
            assert!(vertex.point().position.is_finite() && vertex.shading_normal().is_finite());
        }
    }
}
