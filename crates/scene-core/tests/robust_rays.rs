//! Rays neither hit the surface that they leave, nor slip through edges and corners: counted over many rays, far from the
//! origin, at small and large scales, for triangles, instances, spheres and disks.

#![cfg(feature = "reference")]
// Helper functions of tests may unwrap.
#![allow(clippy::unwrap_used)]

use std::f32::consts::TAU;
use std::sync::Arc;

use estimator_checks::Uniforms;
use scene_core::builtin::SceneBuilder;
use scene_core::glam::{Affine3A, Mat3A, Vec3A};
use scene_core::reference::{Shape, TriangleMesh};
use scene_core::{Frame, Ray, ReferenceScene, Scene, SurfacePoint, Vertex};

/// An icosahedron, each face cut in four twice, with shared vertices on the unit sphere.
fn icosphere() -> TriangleMesh {
    let g = 0.5 * (1.0 + 5.0f32.sqrt());
    let mut positions: Vec<Vec3A> = [-1.0f32, 1.0]
        .iter()
        .flat_map(|&a| [-g, g].map(|b| [Vec3A::new(0.0, a, b), Vec3A::new(a, b, 0.0), Vec3A::new(b, 0.0, a)]))
        .flatten()
        .map(Vec3A::normalize)
        .collect();
    // Faces are the triples of corners that are one edge apart, outside out.
    let edge = 4.0 / (1.0 + g * g) * 1.01;
    let near = |p: &Vec<Vec3A>, i: usize, j: usize| p[i].distance_squared(p[j]) < edge;
    let mut faces = Vec::new();
    for (i, j, k) in (0..12).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| (i, j, k)))) {
        let p = &positions;
        if near(p, i, j) && near(p, j, k) && near(p, k, i) {
            let outside = (p[j] - p[i]).cross(p[k] - p[i]).dot(p[i]) > 0.0;
            faces.push(if outside { [i, j, k] } else { [i, k, j] });
        }
    }
    assert_eq!(faces.len(), 20);
    for _ in 0..2 {
        let mut middles = std::collections::HashMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in faces {
            let mut middle = |i: usize, j: usize| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    positions.push((positions[i] + positions[j]).normalize());
                    positions.len() - 1
                })
            };
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        faces = finer;
    }
    let triangles = faces.into_iter().map(|face| face.map(|i| i as u32)).collect();
    TriangleMesh::new(positions.into_iter().map(|p| p.to_array()).collect(), vec![], vec![], triangles).unwrap()
}

/// A mesh that `SceneBuilder` makes, taken out.
fn built(make: impl FnOnce(&mut SceneBuilder)) -> Shape {
    let mut b = SceneBuilder::new("shape");
    b.diffuse(0.5, 0.5, 0.5);
    make(&mut b);
    b.finish().shapes.remove(0)
}

/// Convex shapes around the origin of about unit size: name, shape, whether it is closed.
fn shapes() -> Vec<(&'static str, Shape, bool)> {
    use scene_core::reference::MaterialId;
    let grey = MaterialId(0);
    let cuboid = built(|b| _ = b.cuboid(grey, Vec3A::ZERO, Vec3A::new(0.4, 0.9, 0.6), 0.3));
    let spindle = [[0.0, -1.0], [0.6, -0.5], [0.8, 0.1], [0.5, 0.6], [0.0, 0.9]];
    let lathe = built(|b| _ = b.lathe(grey, Vec3A::ZERO, &spindle, 17));
    vec![
        ("icosphere", Shape::Mesh(Arc::new(icosphere())), true),
        ("cuboid", cuboid, true),
        ("lathe", lathe, true),
        ("sphere", Shape::Sphere { center: Vec3A::new(0.1, 0.0, 0.0), radius: 0.8, flip_normals: false }, true),
        ("disk", Shape::Disk, false),
    ]
}

/// Scale and offset.
const PLACES: [(f32, f32); 6] = [(1.0, 0.0), (1.0, 1e3), (1e-3, 0.0), (1e-3, 1.0), (1e4, 0.0), (1e4, 1e6)];

/// Where the shape's centre is, its size, and the scene, placed once or as one of several instances.
fn scenes(shape: &Shape) -> Vec<(Vec3A, f32, ReferenceScene)> {
    let turn = Mat3A::from_rotation_x(0.7) * Mat3A::from_rotation_y(-1.1) * Mat3A::from_rotation_z(0.4);
    let mut scenes = Vec::new();
    for (scale, offset) in PLACES {
        let center = Vec3A::new(0.6, -0.7, 0.4) * offset;
        for instances in [1, 2] {
            let mut b = SceneBuilder::new("rays");
            let grey = b.diffuse(0.5, 0.5, 0.5);
            b.place(shape.clone(), grey, Affine3A { matrix3: turn * scale, translation: center });
            if instances == 2 {
                let away = center + Vec3A::splat(1e3 * scale);
                b.place_again(grey, Affine3A { matrix3: turn * scale, translation: away });
            }
            scenes.push((center, scale, ReferenceScene::new(b.finish()).unwrap()));
        }
    }
    scenes
}

fn on_sphere(uniforms: &mut Uniforms) -> Vec3A {
    let (z, phi) = (2.0 * uniforms.next_f32() - 1.0, TAU * uniforms.next_f32());
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3A::new(r * phi.cos(), r * phi.sin(), z)
}

/// A direction above the surface; half of them graze it, down to a cosine of 1e-4.
fn above(point: &SurfacePoint, uniforms: &mut Uniforms) -> Vec3A {
    let cos = if uniforms.next_f32() < 0.5 { uniforms.next_f32() } else { 10f32.powf(-4.0 * uniforms.next_f32()) };
    let (sin, phi) = ((1.0 - cos * cos).max(0.0).sqrt(), TAU * uniforms.next_f32());
    Frame::from_z(point.normal).to_world(Vec3A::new(sin * phi.cos(), sin * phi.sin(), cos)).normalize()
}

fn self_hits(rays: usize) {
    for (name, shape, _) in shapes() {
        for (center, scale, scene) in scenes(&shape) {
            let mut uniforms = Uniforms::named(name);
            let (mut hits, mut tried) = (0, 0);
            for _ in 0..rays {
                let origin = center + on_sphere(&mut uniforms) * 3.0 * scale;
                let target = center + on_sphere(&mut uniforms) * 0.7 * scale;
                let Some(vertex) = scene.intersect(&Ray::new(origin, (target - origin).normalize())) else { continue };
                let wi = above(vertex.point(), &mut uniforms);
                // Nothing of a convex shape is above its surface. The other instance is 1000 sizes away.
                let ray = vertex.spawn_ray(wi).up_to(100.0 * scale);
                tried += 1;
                hits += u32::from(scene.occluded(&ray) || scene.intersect(&ray).is_some());
            }
            assert_eq!(hits, 0, "{name} of size {scale} at {center}: {hits} of {tried} rays hit what they left");
            assert!(tried as usize > rays / 10, "{name} {scale} {center}: {tried}");
        }
    }
}

/// Rays inside go from wall to wall; a third of the first ones aim at corners and edges.
fn leaks(walks: usize) {
    for (name, shape, _) in shapes().into_iter().filter(|(_, _, is_closed)| *is_closed) {
        for (center, scale, scene) in scenes(&shape) {
            let mut uniforms = Uniforms::named(name);
            let placed = scene_points(&shape, center, scale);
            let (mut bounces, mut outside) = (0, 0);
            for walk in 0..walks {
                let origin = center + on_sphere(&mut uniforms) * 0.3 * scale * uniforms.next_f32();
                let towards = match walk % 3 {
                    0 if !placed.is_empty() => placed[walk % placed.len()] - origin,
                    _ => on_sphere(&mut uniforms),
                };
                let mut ray = Ray::new(origin, towards.normalize());
                for bounce in 0..8 {
                    assert!(scene.occluded(&ray), "{name} of size {scale} at {center}: {bounce}: {ray:?}");
                    let Some(vertex) = scene.intersect(&ray) else {
                        panic!("{name} of size {scale} at {center}: {bounce}: {ray:?} leaks")
                    };
                    let away = (vertex.point().position - center).length();
                    assert!(
                        away < 2.0 * scale,
                        "{name} of size {scale} at {center}: {ray:?} leaks to the next instance"
                    );
                    let inside = SurfacePoint { normal: -vertex.point().normal, ..*vertex.point() };
                    ray = inside.ray_along(above(&inside, &mut uniforms));
                    bounces += 1;
                    let deeper = ray.origin + inside.normal * (8.0 * inside.error);
                    if is_outside(&scene, ray.origin, center, 0.0)
                        || is_outside(&scene, deeper, center, 4.0 * inside.error)
                    {
                        outside += 1;
                        break;
                    }
                }
            }
            // Far from the origin the offset is some hundredths of the size: the more starts lie beside corners.
            assert!(
                bounces - outside > walks,
                "{name} of size {scale} at {center}: {outside} of {bounces} start outside"
            );
        }
    }
}

/// Corners, and middles of edges, in world coordinates.
fn scene_points(shape: &Shape, center: Vec3A, scale: f32) -> Vec<Vec3A> {
    let Shape::Mesh(mesh) = shape else { return Vec::new() };
    let turn = Mat3A::from_rotation_x(0.7) * Mat3A::from_rotation_y(-1.1) * Mat3A::from_rotation_z(0.4);
    let to_world = Affine3A { matrix3: turn * scale, translation: center };
    let corners = (0..mesh.len()).flat_map(|i| {
        let [a, b, c] = mesh.corners(i);
        [a, 0.5 * (a + b), 0.5 * (b + c), 0.3 * a + 0.7 * c]
    });
    corners.map(|p| to_world.transform_point3a(p)).collect()
}

/// Whether the offset has put the start of a ray near or through the wall beside the one that it left: no offset along one normal
/// can keep a ray inside of a corner narrower than itself.
fn is_outside(scene: &ReferenceScene, start: Vec3A, center: Vec3A, margin: f32) -> bool {
    let between = start - center;
    scene.occluded(&Ray::new(center, between.normalize()).up_to(between.length() + margin))
}

#[test]
fn rays_do_not_hit_what_they_leave() {
    self_hits(3_000);
}

#[test]
fn closed_shapes_do_not_leak() {
    leaks(1_500);
}

/// As above, with millions of rays.
#[test]
#[ignore = "long"]
fn millions_of_rays_neither_stick_nor_leak() {
    self_hits(200_000);
    leaks(50_000);
}

/// Segments between surfaces see neither of their ends, at any scale.
#[test]
fn segments_are_free_at_both_ends() {
    let mut uniforms = Uniforms::named("segments");
    for (scale, offset) in PLACES {
        let base = Vec3A::splat(offset);
        let mut b = SceneBuilder::new("two planes");
        let grey = b.diffuse(0.5, 0.5, 0.5);
        let (x, y, z) = (Vec3A::X * scale, Vec3A::Y * scale, Vec3A::Z * scale);
        b.quad(grey, base, z, x).quad(grey, base + y, x, z);
        let scene = ReferenceScene::new(b.finish()).unwrap();
        for _ in 0..3_000 {
            let [u, v, s, t] = uniforms.array::<4>().map(|x| 0.05 + 0.9 * x as f32);
            let from = base + 0.5 * y + x * u + z * v;
            let down = scene.intersect(&Ray::new(from, -Vec3A::Y)).unwrap();
            let up = scene.intersect(&Ray::new(from + (x * (s - u) + z * (t - v)), Vec3A::Y)).unwrap();
            assert!(
                scene.visible(down.point(), up.point()) && scene.visible(up.point(), down.point()),
                "{scale} {offset}"
            );
            assert!(!scene.visible(&SurfacePoint::in_space(base - y), up.point()));
        }
    }
}

/// Offsets are small: rays start within a few 1e-5 of the size of the coordinates.
#[test]
fn offsets_are_small() {
    for (name, shape, _) in shapes() {
        for (center, scale, scene) in scenes(&shape) {
            let origin = center + Vec3A::new(0.1, 0.2, 3.0) * scale;
            let Some(vertex) = scene.intersect(&Ray::new(origin, (center - origin).normalize())) else { continue };
            let point = vertex.point();
            let moved = (vertex.spawn_ray(point.normal).origin - point.position).length();
            let magnitude = center.abs().max_element() + 2.0 * scale;
            assert!(point.error > 0.0 && moved < 1e-4 * magnitude, "{name} {scale} {center}: {moved}");
        }
    }
}

/// Rays that lie exactly in the planes of axis-aligned edges, where boxes and triangles end. (On the outermost edges they may
/// hit or miss.)
#[test]
fn axis_aligned_rays_hit_axis_aligned_edges() {
    let mut b = SceneBuilder::new("tiles");
    let grey = b.diffuse(0.5, 0.5, 0.5);
    let tiles = (0..64).map(|k| Vec3A::new((k % 8) as f32 - 4.0, (k / 8) as f32 - 4.0, 0.0));
    let quads: Vec<[Vec3A; 4]> = tiles.map(|p| [p, p + Vec3A::X, p + Vec3A::X + Vec3A::Y, p + Vec3A::Y]).collect();
    b.quads(grey, &quads);
    let scene = ReferenceScene::new(b.finish()).unwrap();
    for k in 1..64 {
        for l in 1..64 {
            let at = |i: i32| -4.0 + i as f32 / 8.0;
            for z in [-1.0f32, 1.0] {
                let origin = Vec3A::new(at(k), at(l), z);
                for direction in [Vec3A::new(0.0, 0.0, -z), Vec3A::new(-0.0, 0.0, -z), Vec3A::new(-0.0, -0.0, -z)] {
                    let ray = Ray::new(origin, direction);
                    let is_hit = scene.intersect(&ray).is_some();
                    assert_eq!(is_hit, scene.occluded(&ray));
                    assert!(is_hit, "{ray:?}");
                }
            }
        }
    }
}
