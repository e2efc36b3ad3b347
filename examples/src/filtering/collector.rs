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
        if self.left > 0 && !throughput.is_black() && self.selection.selects(vertex) {
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

#[cfg(test)]
mod tests {
    use scene_core::{ReferenceScene, Rgb, Scene, TransportMode, builtin};

    use super::*;

    type V<'s> = <ReferenceScene as Scene>::Vertex<'s>;

    /// A collector for so many vertices, and events at vertices of the floor of the Cornell box, told by hand.
    fn collect(vertices: u32, tell: impl FnOnce(&mut Collector, &V<'_>)) -> ([f32; 3], Vec<Collected>) {
        let scene = ReferenceScene::new(builtin::cornell_box()).unwrap();
        let ray = Ray::new(Vec3A::new(0.28, 0.3, 0.1), Vec3A::NEG_Y);
        let vertex = scene.intersect(&ray).unwrap();
        let mut collector = Collector::new(Selection::new(0.05, vertices).unwrap(), &ray);
        tell(&mut collector, &vertex);
        let (unfiltered, collected) = collector.finish(2.0);
        (unfiltered, collected.collect())
    }

    fn found(collector: &mut Collector, eye: u32, what: Found, value: f32) {
        Observer::<V<'_>>::contribution(collector, eye, what, Rgb::splat(value));
    }

    #[test]
    fn contributions_belong_to_the_vertex_where_they_arrive() {
        let (unfiltered, collected) = collect(1, |collector, vertex| {
            collector.vertex(1, vertex, Rgb::splat(0.5));
            found(collector, 1, Found::Hit, 100.0); // what it emits itself
            found(collector, 1, Found::Photons, 10.0); // a density estimate there
            found(collector, 1, Found::Connection { light: 0 }, 1.0);
            collector.vertex(2, vertex, Rgb::splat(0.25));
            found(collector, 2, Found::Hit, 2.0); // light that scattering found
            found(collector, 2, Found::Photons, 4.0); // a density estimate further on is a contribution like any other
            found(collector, 3, Found::Hit, 8.0); // the surroundings
        });
        assert_eq!(unfiltered, [220.0; 3]);
        assert_eq!(collected.len(), 1);
        assert_eq!((collected[0].attenuation, collected[0].vertex.contribution), ([1.0; 3], [30.0; 3]));
        assert!((collected[0].vertex.path_length - 0.3).abs() < 1e-6 && collected[0].vertex.hit_distance == 0.0);
    }

    #[test]
    fn of_two_vertices_each_has_its_own() {
        let (unfiltered, collected) = collect(2, |collector, vertex| {
            collector.vertex(1, vertex, Rgb::splat(1.0));
            found(collector, 1, Found::Connections, 1.0);
            collector.vertex(2, vertex, Rgb::splat(0.5));
            found(collector, 2, Found::Hit, 2.0); // arrives at the first one
            found(collector, 2, Found::Connections, 4.0);
            found(collector, 3, Found::Hit, 8.0); // arrives at the second one
        });
        assert_eq!(unfiltered, [0.0; 3]);
        let contributions: Vec<_> = collected.iter().map(|found| found.vertex.contribution[0]).collect();
        assert_eq!(contributions, [3.0, 24.0]);
    }

    #[test]
    fn beyond_a_sharp_bounce_the_next_vertex_takes_over() {
        let (unfiltered, collected) = collect(1, |collector, vertex| {
            collector.vertex(1, vertex, Rgb::splat(1.0));
            found(collector, 1, Found::Connections, 1.0);
            let sample = vertex.sample([0.5; 3], TransportMode::Radiance).unwrap();
            collector.scattered(1, vertex, &ScatterSample { is_specular: true, ..sample });
            found(collector, 2, Found::Hit, 32.0); // seen in the mirror
            collector.vertex(2, vertex, Rgb::splat(0.5));
            found(collector, 2, Found::Hit, 64.0); // so is what the next one emits
            found(collector, 2, Found::Connections, 2.0);
        });
        assert_eq!(unfiltered, [192.0; 3]);
        let contributions: Vec<_> = collected.iter().map(|found| found.vertex.contribution[0]).collect();
        assert_eq!(contributions, [1.0, 4.0]);
    }

    #[test]
    fn black_vertices_are_nobodys() {
        let (unfiltered, collected) = collect(2, |collector, vertex| {
            collector.vertex(1, vertex, Rgb::splat(1.0));
            found(collector, 1, Found::Connections, 1.0);
            collector.vertex(2, vertex, Rgb::ZERO);
        });
        assert_eq!((unfiltered, collected.len()), ([0.0; 3], 1));
    }
}
