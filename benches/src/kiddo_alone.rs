//! What a renderer would write over kiddo, without any of our crates: the peer of range searches and filters.

use std::hint::black_box;

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use path_space_filter::Vertex;
use rayon::prelude::*;

use crate::surface_points;

/// A vertex of a path of RGB.
pub type RgbVertex = Vertex<[f32; 3]>;

/// The tree over points.
///
/// # Panics
/// If kiddo refuses them.
pub fn kiddo_tree(points: &[[f32; 3]]) -> ImmutableKdTree<f32, 3> {
    ImmutableKdTree::new_from_slice(points).expect("a tree")
}

/// The squared distances of all neighbours of all queries, summed up.
pub fn kiddo_within(tree: &ImmutableKdTree<f32, 3>, queries: &[[f32; 3]], radius: f32) -> f32 {
    let mut sum = 0.0;
    for query in queries {
        for found in tree.query(query).within::<SquaredEuclidean<f32>>(radius * radius).unsorted().execute() {
            black_box(found.item);
            sum += found.distance;
        }
    }
    sum
}

/// The squared distances of the `count` nearest neighbours' farthest, summed up.
///
/// # Panics
/// If `count` is zero.
pub fn kiddo_nearest(tree: &ImmutableKdTree<f32, 3>, queries: &[[f32; 3]], count: usize) -> f32 {
    let count = count.try_into().expect("not zero");
    let farthest = |query: &[f32; 3]| {
        tree.query(query).nearest_n::<SquaredEuclidean<f32>>(count).execute().last().map(|last| last.distance)
    };
    queries.iter().filter_map(farthest).sum()
}

/// Vertices of an image, about: surface points in rows along the surfaces. The normals of the sphere and of the square, a texture of 16
/// colours, contributions that are anything. With the radius at which there are about 50 in the neighbourhood of each.
pub fn vertices(count: usize) -> (Vec<RgbVertex>, f32) {
    let (mut points, radius) = surface_points(count);
    let row = |x: f32| (x / (4.0 * radius)) as i32;
    points.sort_by(|a, b| (row(a[0]), row(a[1])).cmp(&(row(b[0]), row(b[1]))).then(a[2].total_cmp(&b[2])));
    let vertex = |(i, p): (usize, &[f32; 3])| {
        let length = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt().max(1e-6);
        let shade = (((p[0] * 8.0).floor() + (p[1] * 8.0).floor()) as i32).rem_euclid(16) as f32 / 16.0;
        Vertex {
            position: *p,
            normal: if p[2] == -1.0 { [0.0, 0.0, 1.0] } else { p.map(|x| x / length) },
            albedo: [shade, 0.5, 1.0 - shade],
            path_length: 1.0,
            contribution: [(i % 17) as f32, (i % 5) as f32, (i % 3) as f32],
            ..Vertex::default()
        }
    };
    (points.iter().enumerate().map(vertex).collect(), radius)
}

/// The averages that path space filtering takes with equal normals and albedo, on all threads of rayon's pool.
pub fn filter_over_kiddo(vertices: &[RgbVertex], radius: f32) -> Vec<[f32; 3]> {
    let points: Vec<[f32; 3]> = vertices.iter().map(|vertex| vertex.position).collect();
    let tree = kiddo_tree(&points);
    let mean = |i: &RgbVertex| {
        let (mut sum, mut count) = ([0.0_f64; 3], 0.0);
        for found in tree.query(&i.position).within::<SquaredEuclidean<f32>>(radius * radius).unsorted().execute() {
            let j = &vertices[found.item as usize];
            let cosine: f32 = (0..3).map(|k| i.normal[k] * j.normal[k]).sum();
            let difference: f32 = (0..3).map(|k| (i.albedo[k] - j.albedo[k]).powi(2)).sum();
            if cosine >= 0.95 && difference <= 0.05 * 0.05 {
                count += 1.0;
                (0..3).for_each(|k| sum[k] += f64::from(j.contribution[k]));
            }
        }
        sum.map(|s| (s / count) as f32)
    };
    vertices.par_iter().map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use path_space_filter::{AlbedoDifference, NormalCone, PathFilter, PathSpaceFilter, Radius, SimilarityExt};
    use range_search::{BruteForce, RangeIndex};

    /// A peer that does less would win.
    #[test]
    fn the_peers_find_what_ours_finds() {
        let (points, radius) = surface_points(2_000);
        let tree = kiddo_tree(&points);
        let plain = BruteForce::build(&points, |p| *p).unwrap();
        let (queries, mut sum, mut farthest) = (&points[..50], 0.0, 0.0);
        let mut found = Vec::new();
        for query in queries {
            plain.for_each_within(*query, radius, |_, d2| sum += d2);
            plain.k_nearest(*query, 20, f32::INFINITY, &mut found);
            farthest += found[19].distance_squared();
        }
        assert!((kiddo_within(&tree, queries, radius) / sum - 1.0).abs() < 1e-4);
        assert!((kiddo_nearest(&tree, queries, 20) / farthest - 1.0).abs() < 1e-4);

        let (vertices, radius) = vertices(2_000);
        let filter = PathSpaceFilter::new(Radius::absolute(radius).unwrap())
            .similarity(NormalCone::PAPER.and(AlbedoDifference::PAPER));
        let ours = filter.average(&vertices, 1);
        for (ours, theirs) in ours.values().iter().zip(filter_over_kiddo(&vertices, radius)) {
            for k in 0..3 {
                assert!((ours[k] - theirs[k]).abs() < 1e-4, "{ours:?} {theirs:?}");
            }
        }
    }
}
