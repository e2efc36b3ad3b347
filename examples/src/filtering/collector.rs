//! Takes paths apart while they are traced.

use glam::Vec3A;
use scene_core::{Ray, ScatterSample, Spectrum, Vertex};
use smallvec::SmallVec;
use vpl_gi::{Found, Observer};

use super::{FilterVertex, Selection};

/// A vertex of a path that is to be filtered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Collected {
    /// The vertex, with what arrives there.
    pub vertex: FilterVertex,
    /// Throughput from there to the camera.
    pub attenuation: [f32; 3],
}

/// Looks on while a path is traced, and takes its radiance apart:
///
/// ```text
/// L = u + sum over selected vertices k of a_k c_k
/// ```
/// `c_k` is what was found from vertex `k` on, up to the next one that is selected, over the attenuation `a_k`. Out of the average stay: what was found before the first one,
/// what a vertex emits itself (it belongs to the vertex before), density estimates of photon maps at the vertex, and what lies beyond a sharp bounce.
#[derive(Clone, Debug)]
pub struct Collector {
    selection: Selection,
    /// Vertices with what was found there, not divided by their attenuation yet.
    vertices: SmallVec<[(u32, Collected); 2]>,
    /// The one to which contributions belong now.
    current: Option<usize>,
    /// The one before it, unless there was a sharp bounce in between.
    before: Option<usize>,
    unfiltered: [f32; 3],
    /// How many more may be selected.
    left: u32,
    /// Throughput up to the last vertex.
    throughput: [f32; 3],
    last: Vec3A,
    distance: f32,
}

impl Collector {
    /// For a path that begins with this ray.
    pub fn new(selection: Selection, ray: &Ray) -> Self {
        Self {
            selection,
            vertices: SmallVec::new(),
            current: None,
            before: None,
            unfiltered: [0.0; 3],
            left: selection.vertices(),
            throughput: [1.0; 3],
            last: ray.origin,
            distance: 0.0,
        }
    }

    /// The vertices, and what stays out of the average. `factor` multiplies all that the camera sees.
    pub fn finish(self, factor: f32) -> ([f32; 3], impl Iterator<Item = Collected>) {
        let collected = move |(_, mut collected): (u32, Collected)| {
            let (found, attenuation) = (collected.vertex.contribution, collected.attenuation);
            collected.vertex.contribution =
                std::array::from_fn(|k| if attenuation[k] > 0.0 { found[k] / attenuation[k] } else { 0.0 });
            collected.attenuation = attenuation.map(|a| a * factor);
            collected
        };
        (self.unfiltered.map(|u| u * factor), self.vertices.into_iter().map(collected))
    }

    /// Makes a vertex of the path the one to which contributions belong.
    fn select<X: Vertex>(&mut self, length: u32, vertex: &X) {
        self.left -= 1;
        let (wo, normal) = (vertex.wo(), vertex.shading_normal());
        let vertex = FilterVertex {
            position: vertex.point().position.to_array(),
            // On the side that is seen: both sides of a leaf are two surfaces.
            normal: (normal * 1.0_f32.copysign(normal.dot(wo))).to_array(),
            albedo: vertex.albedo().to_rgb(),
            view_direction: wo.to_array(),
            path_length: self.distance,
            hit_distance: f32::INFINITY,
            ..FilterVertex::default()
        };
        self.before = self.current;
        self.current = Some(self.vertices.len());
        self.vertices.push((length, Collected { vertex, attenuation: self.throughput }));
    }

    /// Where a contribution belongs that was found at the end of so many segments.
    fn target(&mut self, eye: u32, found: Found) -> &mut [f32; 3] {
        let target = match self.current {
            Some(k) if self.vertices[k].0 == eye => match found {
                // What the vertex emits arrives at the one before.
                Found::Hit => self.before,
                Found::Photons => None,
                Found::Connection { .. } | Found::Connections => Some(k),
            },
            current => current,
        };
        match target {
            Some(k) => &mut self.vertices[k].1.vertex.contribution,
            None => &mut self.unfiltered,
        }
    }
}

impl<X: Vertex> Observer<X> for Collector {
    fn vertex(&mut self, length: u32, vertex: &X, throughput: X::Spectrum) {
        let position = vertex.point().position;
        let step = (position - self.last).length();
        (self.last, self.distance) = (position, self.distance + step);
        // How far the ray from the last one went.
        if let Some((at, collected)) = self.vertices.last_mut()
            && *at + 1 == length
            && collected.vertex.hit_distance == f32::INFINITY
        {
            collected.vertex.hit_distance = step;
        }
        self.throughput = throughput.to_rgb();
        if self.left > 0 && self.selection.selects(vertex) {
            self.select(length, vertex);
        }
    }

    fn scattered(&mut self, length: u32, vertex: &X, sample: &ScatterSample<X::Spectrum>) {
        if self.current.is_some_and(|k| self.vertices[k].0 == length) && self.selection.is_left_sharply(vertex, sample)
        {
            self.current = None;
            self.left += 1;
        }
        // What comes out of a medium varies slowly along its boundary, however smooth that is.
        if self.current.is_none() && self.left > 0 && vertex.medium(sample.wi, None).is_some() {
            self.select(length, vertex);
        }
    }

    fn contribution(&mut self, eye: u32, found: Found, value: X::Spectrum) {
        let (target, value) = (self.target(eye, found), value.to_rgb());
        (0..3).for_each(|k| target[k] += value[k]);
    }
}
