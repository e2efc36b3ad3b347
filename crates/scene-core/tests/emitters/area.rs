//! Surfaces that emit: meshes (placed once, several times, scaled, mirrored), spheres, disks.

use std::f64::consts::PI;
use std::sync::Arc;

use estimator_checks::{ChiSquare, Disk, Sphere, Square};
use scene_core::builtin::SceneBuilder;
use scene_core::glam::{Affine3A, Mat3A, Vec3, Vec3A};
use scene_core::reference::{Shape, TriangleMesh};
use scene_core::{Emitter, EmitterId, ReferenceScene, Scene};

use crate::{Lit, RADIANCE, SUITE, direct_samples_agree, emission_agrees, emission_directions, tilt};

/// A double pyramid over an irregular triangle: convex, so that every direction meets one emitting triangle. Each face is cut
/// into `cuts^2` triangles.
fn gem(cuts: u32) -> Shape {
    let corners = [[1.0, 0.0, 0.1], [-0.6, 0.8, 0.0], [-0.3, -0.9, -0.1], [0.1, 0.1, 0.9], [0.0, -0.1, -0.5]];
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for face in [[0, 1, 3], [1, 2, 3], [2, 0, 3], [1, 0, 4], [2, 1, 4], [0, 2, 4]] {
        let [a, b, c] = face.map(|i: usize| Vec3A::from(corners[i]));
        for i in 0..cuts {
            for j in 0..cuts - i {
                let at = |i: u32, j: u32| a + ((b - a) * i as f32 + (c - a) * j as f32) / cuts as f32;
                let first = positions.len() as u32;
                positions.extend([at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)].map(|p| p.to_array()));
                triangles.push([first, first + 1, first + 2]);
                if j + 1 < cuts - i {
                    triangles.push([first + 1, first + 3, first + 2]);
                }
            }
        }
    }
    Shape::Mesh(Arc::new(TriangleMesh::new(positions, vec![], vec![], triangles).unwrap()))
}

/// So many triangles that instances share them.
const MANY: u32 = 80;

fn placed(matrix: Mat3A, translation: Vec3A) -> Affine3A {
    Affine3A { matrix3: matrix, translation }
}

/// A scene of one shape, or of two: then the second one is looked at.
fn lit(name: &'static str, shape: Shape, places: &[Affine3A], from: Vec3A) -> Lit {
    let mut b = SceneBuilder::new(name);
    let black = b.diffuse(0.0, 0.0, 0.0);
    b.place(shape, black, places[0]).emit(RADIANCE);
    for &place in &places[1..] {
        b.place_again(black, place).emit(RADIANCE);
    }
    let scene = ReferenceScene::new(b.finish()).unwrap();
    assert_eq!(scene.emitters().len(), places.len());
    let id = EmitterId(places.len() as u32 - 1);
    Lit { name, scene, id, from }
}

fn sphere(flip_normals: bool) -> Shape {
    Shape::Sphere { center: Vec3A::new(0.2, -0.1, 0.3), radius: 0.8, flip_normals }
}

fn all() -> Vec<Lit> {
    let there = Vec3A::new(2.0, -1.0, 0.5);
    let elsewhere = Affine3A::from_translation(Vec3::new(-30.0, 0.0, 0.0));
    let stretch = Mat3A::from_diagonal(Vec3::new(1.5, 0.5, 0.8));
    let mirror = Mat3A::from_diagonal(Vec3::new(-1.0, 1.0, 1.0));
    let near = there + Vec3A::new(0.4, 1.5, 0.6);
    // In front of the tilted disk.
    let above_disk = there + tilt() * Vec3A::new(0.5, 0.3, 0.7);
    vec![
        lit("mesh", gem(1), &[placed(tilt(), there)], near),
        lit("mesh from afar", gem(1), &[placed(tilt(), there)], there + Vec3A::new(-3.0, 1.0, 1.5)),
        lit("mesh stretched", gem(1), &[placed(tilt() * stretch, there)], near),
        lit("mesh instanced", gem(MANY), &[elsewhere, placed(tilt() * 0.5, there)], near),
        lit(
            "mesh instanced, stretched and mirrored",
            gem(MANY),
            &[elsewhere, placed(tilt() * stretch * mirror, there)],
            near,
        ),
        lit("sphere", sphere(false), &[placed(tilt() * 1.25, there)], there + Vec3A::new(-1.5, 1.0, 1.0)),
        lit("sphere close by", sphere(false), &[Affine3A::IDENTITY], Vec3A::new(0.2, -0.1, 1.15)),
        lit("sphere from inside", sphere(true), &[placed(tilt() * 2.0, there)], there + Vec3A::new(0.3, 0.5, 0.2)),
        lit(
            "sphere instanced",
            sphere(false),
            &[elsewhere, placed(mirror * 0.7, there)],
            there + Vec3A::new(0.0, 1.5, 0.0),
        ),
        lit("disk", Shape::Disk, &[placed(tilt(), there)], above_disk),
        lit("ellipse", Shape::Disk, &[placed(tilt() * stretch, there)], above_disk),
        lit("ellipse, mirrored", Shape::Disk, &[elsewhere, placed(tilt() * stretch * mirror, there)], above_disk),
    ]
}

#[test]
fn direct_samples_follow_their_densities() {
    for lit in all() {
        lit.direct(SUITE.check(&format!("direct: {}", lit.name)), |_, pdf| pdf).expect_pass();
    }
}

#[test]
fn planted_bugs_are_noticed() {
    for lit in all() {
        let twin = |bug: &str| SUITE.twin(&format!("{}: {bug}", lit.name));
        // Where most samples are on the far side, and so missing, fewer are left to tell by.
        let bug = if lit.name.starts_with("mesh") { 0.15 } else { 0.02 };
        lit.direct(twin("too much"), |_, pdf| (1.0 + bug) * pdf).expect_reject();
        lit.direct(twin("too little"), |_, pdf| (1.0 - bug) * pdf).expect_reject();
    }
    let disk = all().pop().unwrap();
    let normal = disk.emitter().sample_direct(disk.from, [0.5; 2]).unwrap().at.unwrap().0.normal;
    let forgotten = |wi: Vec3A, pdf: f64| pdf * f64::from(normal.dot(wi).abs());
    disk.direct(SUITE.twin("ellipse: cosine forgotten"), forgotten).expect_reject();
}

#[test]
fn directions_points_and_radiance_agree() {
    for lit in all() {
        direct_samples_agree(&lit);
        emission_agrees(lit.name, lit.emitter(), false);
    }
}

/// The cosine cancels: every light path carries the same flux, `pi A L`.
#[test]
fn flux_is_power() {
    let areas = [("sphere", 4.0 * PI), ("sphere from inside", 4.0 * PI * 2.56), ("disk", PI), ("ellipse", PI * 0.75)];
    for lit in all() {
        let power = lit.emitter().power();
        for u in [[0.1, 0.9], [0.6, 0.3]] {
            let flux = lit.emitter().sample_emission(u, u).unwrap().flux;
            assert!((flux - power).0.abs().max_element() < 1e-4 * power[0], "{}", lit.name);
        }
        if let Some((_, area)) = areas.iter().find(|(name, _)| *name == lit.name) {
            let expected = PI * area * 3.0;
            assert!((f64::from(power[0]) / expected - 1.0).abs() < 1e-4, "{}: {power:?} {expected}", lit.name);
        }
    }
}

#[test]
fn light_paths_leave_with_their_density() {
    for lit in all()
        .iter()
        .filter(|lit| ["mesh", "sphere", "disk", "mesh instanced, stretched and mirrored"].contains(&lit.name))
    {
        let check = SUITE.check(&format!("emission: {}", lit.name));
        emission_directions(check, lit.emitter(), false, |pdf| pdf).expect_pass();
        let twin = SUITE.twin(&format!("emission: {}, 2 %", lit.name));
        emission_directions(twin, lit.emitter(), false, |pdf| 0.98 * pdf).expect_reject();
    }
}

/// Positions of light paths are uniform by area.
#[test]
fn light_paths_start_everywhere_alike() {
    let find = |name: &str| all().into_iter().find(|lit| lit.name == name).unwrap();
    let position = |lit: &Lit, [u, v, _]: [f64; 3]| {
        lit.emitter().sample_emission([u as f32, v as f32], [0.3, 0.4]).unwrap().point.position
    };
    let chi_square = |n: usize| n * 10_000;

    let sphere = find("sphere from inside");
    let center = Vec3A::new(2.0, -1.0, 0.5) + tilt() * Vec3A::new(0.2, -0.1, 0.3) * 2.0;
    let on_sphere = |u| Some(((position(&sphere, u) - center) / 1.6).to_array());
    let uniform = |_| 1.0 / (4.0 * PI);
    ChiSquare::on(Sphere)
        .samples(chi_square(5))
        .run(SUITE.check("positions: sphere"), on_sphere, uniform)
        .expect_pass();

    let ellipse = find("ellipse");
    let to_disk = placed(tilt() * Mat3A::from_diagonal(Vec3::new(1.5, 0.5, 0.8)), Vec3A::new(2.0, -1.0, 0.5)).inverse();
    let on_disk = |u| {
        let local = to_disk.transform_point3a(position(&ellipse, u));
        // Round-off must not move a point out of the disk.
        Some([local.x * 0.999_999, local.y * 0.999_999])
    };
    ChiSquare::on(Disk)
        .samples(chi_square(5))
        .run(SUITE.check("positions: ellipse"), on_disk, |_| 1.0 / PI)
        .expect_pass();

    // A strip of unequal triangles.
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.2, 0.7, 0.0]];
    let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    let mesh = TriangleMesh::new(positions, vec![], vec![], triangles).unwrap();
    let square = lit("square", Shape::Mesh(Arc::new(mesh)), &[Affine3A::IDENTITY], Vec3A::Z);
    let on_square = |u| Some(position(&square, u).truncate().to_array().map(|x| x.clamp(0.0, 0.999_999)));
    let check = SUITE.check("positions: mesh");
    ChiSquare::on(Square).samples(chi_square(5)).run(check, on_square, |_| 1.0).expect_pass();
}

/// Behind the surface, on it, inside the sphere: nothing, and never a NaN.
#[test]
fn dark_and_degenerate_points_see_nothing() {
    for lit in all() {
        let emitter = lit.emitter();
        for u in [[0.0, 0.0], [0.3, 0.8], [0.999_999_94, 0.999_999_94]] {
            let on = emitter.sample_emission(u, u).unwrap().point;
            for from in [on.position, on.position - on.normal * 1e-4, Vec3A::splat(1e20), Vec3A::NAN] {
                if let Some(sample) = emitter.sample_direct(from, u) {
                    let finite = sample.pdf_solid_angle.is_finite() && sample.wi.is_finite();
                    assert!(finite && sample.pdf_solid_angle > 0.0, "{} {from} {sample:?}", lit.name);
                }
            }
            let behind = emitter.pdf_direct(on.position - on.normal, on.normal, Some(&on));
            assert_eq!(behind, 0.0, "{}", lit.name);
            assert!(emitter.pdf_direct(on.position, on.normal, Some(&on)).is_finite());
            // Along the surface: the cosine is nearly zero.
            let along = on.normal.any_orthonormal_vector();
            let pdf = emitter.pdf_direct(on.position - along * 1e18, along - on.normal * 1e-30, Some(&on));
            assert!(pdf.is_finite(), "{} {pdf}", lit.name);
        }
    }
}

/// Two triangles that look like a parallelogram but face opposite sides, and one with vertex normals that turn it around.
#[test]
fn halves_may_face_opposite_sides() {
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    for (normals, triangles) in [
        (vec![], vec![[0, 1, 2], [0, 3, 2]]),
        (vec![], vec![[0, 1, 2], [0, 2, 3]]),
        (vec![[0.0, 0.0, -1.0]; 4], vec![[0, 1, 2], [0, 2, 3]]),
    ] {
        let mesh = TriangleMesh::new(positions.clone(), normals, vec![], triangles).unwrap();
        let lit = lit("halves", Shape::Mesh(Arc::new(mesh)), &[Affine3A::IDENTITY], Vec3A::Z);
        for k in 0..100 {
            let u = [(0.213 + k as f32 * 0.371).fract(), (0.123 + k as f32 * 0.617).fract()];
            let point = lit.emitter().sample_emission(u, [0.3, 0.4]).unwrap().point;
            let hit = lit
                .scene
                .intersect(&scene_core::Ray::new(point.position + point.normal, -point.normal))
                .unwrap_or_else(|| panic!("{point:?} {u:?}"));
            use scene_core::Vertex;
            assert_eq!((hit.point().normal, hit.emitted()), (point.normal, RADIANCE), "{point:?}");
        }
    }
}
