//! Emission of surfaces: uniform, or by a texture, which becomes a constant for each triangle.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Vec3A;

use super::meshes::Primitive;
use crate::reference::TriangleMesh;
use crate::texture::Texture;
use crate::traits::{Rgb, Spectrum};

/// What a material emits, in W/(m^2 sr): glTF's nit without its photometric weight.
#[derive(Clone, Debug)]
pub(super) struct Emission {
    /// `emissiveFactor` times the strength.
    pub(super) factor: Rgb,
    pub(super) texture: Option<Texture>,
}

/// Steps of each component between black and the brightest triangle of a primitive.
const LEVELS: f32 = 16.0;

/// Corners of the smaller triangles that a triangle is cut into, along one side.
const CUTS: usize = 4;

/// The parts of a primitive by what they emit.
///
/// Emitters have one radiance each. Where a texture says it, triangles take their mean of it, and triangles of similar means become
/// one part, whose radiance is their mean by area: total power is kept, exact boundaries are not.
pub(super) fn split(primitive: &Primitive, emission: Option<&Emission>) -> Vec<(Arc<TriangleMesh>, Option<Rgb>)> {
    let mesh = &primitive.mesh;
    let Some(emission) = emission else { return vec![(mesh.clone(), None)] };
    let Some(texture) = &emission.texture else { return vec![(mesh.clone(), Some(emission.factor))] };
    let radiance: Vec<Rgb> = (0..mesh.len()).map(|i| triangle_mean(mesh, i, texture) * emission.factor).collect();
    let brightest = radiance.iter().map(|radiance| radiance.max_component()).fold(0.0, f32::max);
    let mut parts: BTreeMap<[u8; 3], Vec<usize>> = BTreeMap::new();
    for (triangle, radiance) in radiance.iter().enumerate() {
        let level = |x: f32| (x / brightest * LEVELS).round() as u8;
        let key = if brightest > 0.0 { radiance.to_array().map(level) } else { [0; 3] };
        parts.entry(key).or_default().push(triangle);
    }
    if parts.len() == 1 && parts.contains_key(&[0; 3]) {
        return vec![(mesh.clone(), None)];
    }
    let part = |(key, triangles): (&[u8; 3], &Vec<usize>)| {
        let weighted = triangles.iter().map(|&i| (radiance[i], area(mesh, i)));
        let (sum, total) = weighted.fold((Rgb::ZERO, 0.0), |(sum, total), (l, area)| (sum + l * area, total + area));
        let mean = (*key != [0; 3] && total > 0.0).then(|| sum / total);
        selected(mesh, triangles).map(|mesh| (Arc::new(mesh), mean))
    };
    parts.iter().filter_map(part).collect()
}

/// The mean of a texture over the surfaces that show it, by area.
pub(super) fn mean(primitives: &[&Primitive], texture: &Texture) -> Rgb {
    if let Some(constant) = texture.constant() {
        return constant;
    }
    let all = primitives.iter().flat_map(|primitive| (0..primitive.mesh.len()).map(|i| (&*primitive.mesh, i)));
    let (mut sum, mut total) = ([0.0f64; 3], 0.0f64);
    for (mesh, triangle) in all {
        let (value, area) = (triangle_mean(mesh, triangle, texture), f64::from(area(mesh, triangle)));
        sum.iter_mut().zip(value.to_array()).for_each(|(sum, x)| *sum += f64::from(x) * area);
        total += area;
    }
    if total > 0.0 { Rgb::from(sum.map(|sum| (sum / total) as f32)) } else { texture.mean() }
}

/// The mean over a triangle: by the midpoints of smaller ones.
fn triangle_mean(mesh: &TriangleMesh, triangle: usize, texture: &Texture) -> Rgb {
    let uv = |i: u32| mesh.uvs().get(i as usize).copied().unwrap_or_default();
    let [a, b, c] = mesh.triangles()[triangle].map(uv);
    let mut sum = Rgb::ZERO;
    let mut add = |u: f32, v: f32| {
        let at = |k: usize| a[k] + (b[k] - a[k]) * u + (c[k] - a[k]) * v;
        sum += texture.eval([at(0), at(1)]);
    };
    let step = 1.0 / CUTS as f32;
    for i in 0..CUTS {
        for j in 0..CUTS - i {
            let (u, v) = (i as f32 * step, j as f32 * step);
            add(u + step / 3.0, v + step / 3.0);
            if i + j + 1 < CUTS {
                add(u + step * 2.0 / 3.0, v + step * 2.0 / 3.0);
            }
        }
    }
    sum / (CUTS * CUTS) as f32
}

fn area(mesh: &TriangleMesh, triangle: usize) -> f32 {
    let [a, b, c] = mesh.corners(triangle);
    let double: Vec3A = (b - a).cross(c - a);
    0.5 * double.length()
}

/// Some of the triangles, with all vertices. Nothing if that is no mesh, which the checks of the whole one exclude.
fn selected(mesh: &TriangleMesh, triangles: &[usize]) -> Option<TriangleMesh> {
    let mut new_index = vec![u32::MAX; mesh.positions().len()];
    let mut kept = Vec::new();
    let mut indices = Vec::with_capacity(triangles.len());
    for &triangle in triangles {
        indices.push(mesh.triangles()[triangle].map(|vertex| {
            let new = &mut new_index[vertex as usize];
            if *new == u32::MAX {
                *new = kept.len() as u32;
                kept.push(vertex as usize);
            }
            *new
        }));
    }
    fn pick<T: Copy>(all: &[T], kept: &[usize]) -> Vec<T> {
        if all.is_empty() { Vec::new() } else { kept.iter().map(|&i| all[i]).collect() }
    }
    let (positions, normals) = (pick(mesh.positions(), &kept), pick(mesh.normals(), &kept));
    TriangleMesh::new(positions, normals, pick(mesh.uvs(), &kept), indices).ok()
}
