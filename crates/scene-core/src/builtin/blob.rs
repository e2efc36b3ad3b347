//! A rugged object of many triangles under two lights, with and without a sky.

use core::f32::consts::FRAC_PI_4;
use std::collections::HashMap;
use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3A};

use super::SceneBuilder;
use super::finish::{lacquer, metal, tiles};
use super::form::v;
use super::noise::{fractal_noise, noise};
use super::sky::sky_image;
use crate::material::Material;
use crate::reference::{Light, MaterialId, SceneDescription, Shape, TriangleMesh};
use crate::texture::Image;
use crate::traits::Rgb;

/// Squares along each edge of the cube that is blown up to the blob: `6 * 2 * 112^2 = 150528` triangles.
const DIVISIONS: u32 = 112;
/// Directions, lengths and sharpness of its fingers.
const FINGERS: [([f32; 3], f32, f32); 9] = [
    ([0.15, 1.0, 0.1], 0.62, 26.0),
    ([-0.75, 0.75, 0.15], 0.70, 32.0),
    ([0.85, 0.55, 0.35], 0.72, 34.0),
    ([0.1, 0.6, 0.95], 0.50, 30.0),
    ([0.95, -0.1, -0.25], 0.62, 36.0),
    ([-0.95, 0.0, 0.45], 0.58, 30.0),
    ([-0.25, 0.55, -0.85], 0.62, 30.0),
    ([0.5, -0.25, 0.85], 0.48, 34.0),
    ([-0.5, -0.3, 0.8], 0.42, 40.0),
];

/// A rugged object of 150 thousand triangles on a ground plane, under a large and a small rectangular light, without an
/// environment: in metres.
///
/// Fingers, folds and pits shadow each other, as those of the dragon of Talbot, Cline and Egbert 2005, "Importance Resampling
/// for Global Illumination", figure 3, which this stands in for. A third of it is rough gold and a third lacquer, both
/// with a roughness of 0.2; the rest is diffuse.
pub fn blob() -> SceneDescription {
    scene("blob", None)
}

/// [`blob`] under a sky with a small sun ([`sky_image`]) in addition to its two lights, as in figure 4 of that paper.
pub fn blob_environment() -> SceneDescription {
    let light = Light::Environment { image: sky_image(), scale: 1.0, to_world: Affine3A::IDENTITY };
    scene("blob-environment", Some(light))
}

/// [`blob`] under any environment image in equirectangular projection, times `scale`, turned by `degrees` about the
/// vertical, in addition to its two lights. Its name is `blob-hdr`.
pub fn blob_under(image: Arc<Image>, scale: f32, degrees: f32) -> SceneDescription {
    let to_world = Affine3A::from_quat(Quat::from_rotation_y(degrees.to_radians()));
    scene("blob-hdr", Some(Light::Environment { image, scale, to_world }))
}

fn scene(name: &str, environment: Option<Light>) -> SceneDescription {
    let mut b = SceneBuilder::new(name);
    let tiles = tiles(Rgb::new(0.42, 0.40, 0.37), Rgb::new(0.36, 0.345, 0.32), 7.0, 7.0);
    let ground = b.material(Material::diffuse(tiles).two_sided());
    b.quad(ground, v(-3.5, 0.0, -3.5), v(0.0, 0.0, 7.0), v(7.0, 0.0, 0.0));
    let finishes = [
        b.material(metal("Au", 0.2)),
        b.material(lacquer(Rgb::new(0.10, 0.30, 0.34), 0.2)),
        b.diffuse(0.62, 0.36, 0.26),
    ];
    place_blob(&mut b, finishes);
    let dark = b.diffuse(0.0, 0.0, 0.0);
    // A large one over the left shoulder of the viewer, and a small and intense one at the right.
    b.quad(dark, v(-2.3, 2.5, 0.4), v(1.4, 0.5, 0.0), v(0.0, -0.7, 1.0)).emit(Rgb::new(14.0, 12.6, 10.8));
    b.quad(dark, v(1.9, 1.7, 0.1), v(0.0, 0.0, 0.3), v(0.12, 0.27, 0.0)).emit(Rgb::new(125.0, 141.0, 170.0));
    if let Some(light) = environment {
        b.light(light);
    }
    b.look(v(0.55, 1.25, 2.85), v(0.02, 0.62, 0.0), 42.0, 640, 480);
    b.finish()
}

/// The point of the blob in direction `d`, before it is moved to where it stands.
fn surface(d: Vec3A) -> Vec3A {
    let mut radius = 0.78 + 0.42 * fractal_noise(1.9 * d, 2, 11);
    // Folds: the noise has kinks where it changes sign, rounded so that they keep a normal.
    let folds = noise(3.1 * d + 0.4 * noise(2.0 * d, 5), 7);
    radius -= 0.20 * (1.0 - (folds * folds + 0.003).sqrt() / 0.35).max(0.0).powi(2);
    radius += 0.09 * fractal_noise(9.0 * d, 4, 23);
    for (axis, length, sharpness) in FINGERS {
        let along = Vec3A::from(axis).normalize().dot(d);
        radius += length * (sharpness * (along - 1.0)).exp();
    }
    let p = radius * d;
    // Bent and twisted, so that parts hang over others.
    let bend = Vec3A::new(noise(1.3 * p, 41), noise(1.3 * p, 42), noise(1.3 * p, 43));
    let p = p + 0.30 * bend;
    Quat::from_rotation_y(0.55 * p.y) * p
}

/// Which of the three finishes the direction `d` shows.
fn finish(d: Vec3A) -> usize {
    let bands = d.x + 0.35 * d.y + 0.5 * noise(1.7 * d, 61);
    if bands < -0.28 { 0 } else { 1 + usize::from(bands < 0.30) }
}

/// The blob as it stands on the ground: its vertices, with the directions that they were blown up along.
struct Blob {
    directions: Vec<Vec3A>,
    positions: Vec<Vec3A>,
    normals: Vec<Vec3A>,
    triangles: Vec<[u32; 3]>,
}

fn make_blob() -> Blob {
    let (directions, triangles) = sphere(DIVISIONS);
    let mut positions: Vec<Vec3A> = directions.iter().map(|&d| surface(d)).collect();
    // It has sunk into the ground by a hundredth of its size.
    let lowest = positions.iter().fold(f32::INFINITY, |y, p| y.min(p.y));
    let scale = 0.62;
    for p in &mut positions {
        *p = scale * (*p - v(0.0, lowest + 0.02, 0.0));
    }
    let mut normals = vec![Vec3A::ZERO; positions.len()];
    for &[i, j, k] in &triangles {
        let [p, q, r] = [i, j, k].map(|i| positions[i as usize]);
        for i in [i, j, k] {
            normals[i as usize] += (q - p).cross(r - p);
        }
    }
    Blob { directions, positions, normals, triangles }
}

/// The whole blob as one closed mesh. Its lowest part is below the ground at y = 0.
pub(super) fn whole_blob() -> TriangleMesh {
    let Blob { positions, normals, triangles, .. } = make_blob();
    part_mesh(&positions, &normals, triangles.iter())
}

fn place_blob(b: &mut SceneBuilder, finishes: [MaterialId; 3]) {
    let Blob { directions, positions, normals, triangles } = make_blob();
    for (index, &material) in finishes.iter().enumerate() {
        let part = |triangle: &&[u32; 3]| finish(directions[triangle[0] as usize]) == index;
        let mesh = part_mesh(&positions, &normals, triangles.iter().filter(part));
        b.place(Shape::Mesh(Arc::new(mesh)), material, Affine3A::IDENTITY);
    }
}

/// The mesh of some of the triangles, with the vertices that they use.
fn part_mesh<'t>(
    positions: &[Vec3A],
    normals: &[Vec3A],
    triangles: impl Iterator<Item = &'t [u32; 3]>,
) -> TriangleMesh {
    let mut used = Vec::new();
    let mut indices = HashMap::new();
    let mut index = |i: u32| {
        *indices.entry(i).or_insert_with(|| {
            used.push(i as usize);
            used.len() as u32 - 1
        })
    };
    let triangles = triangles.map(|triangle| triangle.map(&mut index)).collect();
    let positions = used.iter().map(|&i| positions[i].to_array()).collect();
    let normals = used.iter().map(|&i| normals[i].normalize_or(Vec3A::Y).to_array()).collect();
    // Indices are below the number of vertices by construction.
    TriangleMesh::new(positions, normals, Vec::new(), triangles).unwrap_or_default()
}

/// Directions and triangles of a sphere: a cube with `n` squares along its edges, blown up. Vertices on its edges
/// are shared.
fn sphere(n: u32) -> (Vec<Vec3A>, Vec<[u32; 3]>) {
    let mut directions = Vec::new();
    let mut indices: HashMap<[u32; 3], u32> = HashMap::new();
    // Equal angles make the squares about equally large.
    let stop = |i: u32| (FRAC_PI_4 * (2.0 * i as f32 / n as f32 - 1.0)).tan();
    let mut vertex = |point: [u32; 3]| {
        *indices.entry(point).or_insert_with(|| {
            directions.push(Vec3A::from(point.map(stop)).normalize());
            directions.len() as u32 - 1
        })
    };
    let mut triangles = Vec::new();
    for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, n)]) {
        // The first of the other axes turns into the second about the outside.
        let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
        let (a, b) = if side == 0 { (b, a) } else { (a, b) };
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let corner = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(di, dj)| {
                let mut point = [side; 3];
                (point[a], point[b]) = (i + di, j + dj);
                vertex(point)
            });
            triangles.extend([[corner[0], corner[1], corner[2]], [corner[0], corner[2], corner[3]]]);
        }
    }
    (directions, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sphere_is_closed_and_faces_outwards() {
        let (directions, triangles) = sphere(6);
        // Euler: as many vertices as half the triangles, plus two.
        assert_eq!((triangles.len(), directions.len()), (12 * 36, 6 * 36 + 2));
        let mut edges = HashMap::new();
        for &[i, j, k] in &triangles {
            let [p, q, r] = [i, j, k].map(|i| directions[i as usize]);
            assert!((q - p).cross(r - p).dot(p) > 0.0);
            for edge in [(i, j), (j, k), (k, i)] {
                *edges.entry(edge).or_insert(0) += 1;
            }
        }
        assert!(edges.iter().all(|(&(i, j), &count)| count == 1 && edges.get(&(j, i)) == Some(&1)));
    }
}
