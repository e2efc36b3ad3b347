//! The filter against equation 1 by its definition, on random sets.
#![allow(clippy::unwrap_used)]

mod support;

use path_space_filter::{
    AlbedoDifference, AlbedoFalloff, CosinePower, Demodulated, Epanechnikov, Everything, Gaussian, HitDistance, Kernel,
    Modulation, NormalCone, PathFilter, PathSpaceFilter, Poly6, Radius, SameObject, SameVisibility, Search,
    SimilarTime, Similarity, SimilarityExt, ViewCone, check_similarity,
};
use proptest::prelude::*;
use support::{Rgb, assert_close, distance_squared, equation_1, vertices};

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn norm_squared(a: [f32; 3], b: [f32; 3]) -> f32 {
    let d: [f32; 3] = std::array::from_fn(|k| a[k] - b[k]);
    dot(d, d)
}

fn one(included: bool) -> f64 {
    if included { 1.0 } else { 0.0 }
}

/// Every search there is.
const SEARCHES: [Search; 5] =
    [Search::Grid, Search::DivideAndConquer, Search::KdTree, Search::Hierarchy, Search::BruteForce];

/// Compares a weight with what it should be, written down once more, over all searches and two kinds of radii.
fn compare<S>(name: &str, similarity: S, weight: impl Fn(&Rgb, &Rgb) -> f64 + Copy)
where
    S: Similarity<Rgb> + Copy + Sync,
    S::Features: Send + Sync,
{
    let all = vertices(600, 7);
    check_similarity(&similarity, &all[..60]).unwrap();
    let expected = equation_1(&all, |_| 0.25, |i, j, _| weight(i, j));
    let filter = PathSpaceFilter::new(Radius::absolute(0.25).unwrap()).similarity(similarity);
    for search in SEARCHES {
        let found = filter.search(search).average(&all, 1);
        assert_close(&found, &expected, &format!("{name}, {search:?}"));
    }
    let expected = equation_1(&all, |v| 0.1 * v.path_length / 2.0, |i, j, _| weight(i, j));
    let filter = PathSpaceFilter::new(Radius::of_distance(0.1).unwrap()).similarity(similarity);
    for search in SEARCHES {
        let found = filter.search(search).average(&all, 16);
        assert_close(&found, &expected, &format!("{name}, of the distance, {search:?}"));
    }
}

#[test]
fn every_weight_is_as_written() {
    compare("everything", Everything, |_, _| 1.0);
    compare("normals", NormalCone::PAPER, |i, j| one(dot(i.normal, j.normal) >= 0.95));
    compare("albedo", AlbedoDifference::PAPER, |i, j| one(norm_squared(i.albedo, j.albedo) <= 0.0025));
    compare("view", ViewCone::new(0.9).unwrap(), |i, j| one(dot(i.view_direction, j.view_direction) >= 0.9));
    compare("visibility", SameVisibility, |i, j| one(i.visibility == j.visibility));
    compare("object", SameObject, |i, j| one(i.object == j.object));
    compare("time", SimilarTime::new(0.3).unwrap(), |i, j| one((i.time - j.time).abs() <= 0.3));
    compare("hit distance", HitDistance::new(0.2).unwrap(), |i, j| {
        let (a, b) = (i.hit_distance, j.hit_distance);
        one(a == b || (a - b).abs() <= 0.2)
    });
    compare("cosine", CosinePower::new(8.0).unwrap(), |i, j| f64::from(dot(i.normal, j.normal).max(0.0)).powi(8));
    compare("falloff", AlbedoFalloff::new(20.0).unwrap(), |i, j| {
        (-20.0 * f64::from(norm_squared(i.albedo, j.albedo))).exp()
    });
    compare("two", NormalCone::new(0.5).unwrap().and(SameObject), |i, j| {
        one(dot(i.normal, j.normal) >= 0.5 && i.object == j.object)
    });
    compare(
        "closure",
        |i: &Rgb, j: &Rgb| 1.0 / (1.0 + (i.time - j.time).abs()),
        |i, j| 1.0 / (1.0 + f64::from((i.time - j.time).abs())),
    );
}

#[test]
fn every_kernel_is_as_written() {
    fn compare(name: &str, kernel: impl Kernel + Copy + Sync, weight: impl Fn(f64) -> f64) {
        let all = vertices(600, 9);
        let expected = equation_1(&all, |_| 0.3, |_, _, t_squared| weight(f64::from(t_squared)));
        let filter = PathSpaceFilter::new(Radius::absolute(0.3).unwrap()).kernel(kernel);
        for search in SEARCHES {
            assert_close(&filter.search(search).average(&all, 1), &expected, name);
        }
        assert_eq!(kernel.weight(0.0), 1.0);
    }
    compare("Epanechnikov", Epanechnikov, |t2| 1.0 - t2);
    compare("poly6", Poly6, |t2| (1.0 - t2).powi(3));
    compare("Gaussian", Gaussian, |t2| (-4.5 * t2).exp());
}

#[test]
fn an_index_of_the_callers_will_do() {
    let all = vertices(500, 3);
    let expected = equation_1(&all, |_| 0.2, |i, j, _| one(i.object == j.object));
    let filter = PathSpaceFilter::new(Radius::absolute(0.2).unwrap()).similarity(SameObject);
    let index = range_search::KdTree::build(&all, |vertex| vertex.position).unwrap();
    assert_close(&filter.average_with(&index, &all, 1), &expected, "k-d tree");
}

#[test]
fn colours_are_taken_out_and_put_back() {
    let all = vertices(500, 4);
    let floor = |a: [f32; 3]| a.map(|a| f64::from(a.max(0.01)));
    let over: Vec<Rgb> = all
        .iter()
        .map(|v| {
            let a = floor(v.albedo);
            Rgb { contribution: std::array::from_fn(|k| (f64::from(v.contribution[k]) / a[k]) as f32), ..*v }
        })
        .collect();
    let expected: Vec<[f64; 3]> = equation_1(&over, |_| 0.2, |_, _, _| 1.0)
        .into_iter()
        .zip(&all)
        .map(|(mean, v)| {
            let a = floor(v.albedo);
            std::array::from_fn(|k| mean[k] * a[k])
        })
        .collect();
    let filter = PathSpaceFilter::new(Radius::absolute(0.2).unwrap()).modulation(Demodulated::default());
    assert_close(&filter.average(&all, 1), &expected, "demodulated");
    // The law of modulations.
    for vertex in &all {
        let back = Demodulated::default().remodulate(vertex, Demodulated::default().demodulate(vertex));
        assert!((0..3).all(|k| (back[k] - vertex.contribution[k]).abs() <= 1e-6 * vertex.contribution[k].abs()));
    }
}

#[test]
fn without_a_radius_or_an_iteration_contributions_stay_bit_for_bit() {
    let all = vertices(2000, 5);
    let bits = |c: [f32; 3]| c.map(f32::to_bits);
    for search in SEARCHES {
        for (radius, iterations) in [(0.0, 1), (1e-6, 3), (0.5, 0)] {
            let filter = PathSpaceFilter::new(Radius::absolute(radius).unwrap())
                .modulation(Demodulated::default())
                .iterations(iterations)
                .search(search);
            let found = filter.average(&all, 1);
            assert_eq!(found.max_count(), 1);
            for (found, vertex) in found.into_iter().zip(&all) {
                assert_eq!(bits(found), bits(vertex.contribution));
            }
        }
    }
}

#[test]
fn iterations_average_averages() {
    let all = vertices(400, 6);
    let filter = PathSpaceFilter::new(Radius::absolute(0.3).unwrap()).similarity(NormalCone::new(0.5).unwrap());
    let mut step = all.clone();
    for _ in 0..3 {
        let means = filter.average(&step, 1);
        step.iter_mut().zip(means).for_each(|(vertex, mean)| vertex.contribution = mean);
    }
    let expected: Vec<_> = step.iter().map(|vertex| vertex.contribution.map(f64::from)).collect();
    assert_close(&filter.iterations(3).average(&all, 1), &expected, "three iterations");

    // Of a constant they are the constant, bit for bit.
    let constant: Vec<Rgb> = all.iter().map(|v| Rgb { contribution: [0.1, 0.7, 1e-12], ..*v }).collect();
    for iterations in [1, 2, 9] {
        let found = filter.iterations(iterations).average(&constant, 1);
        assert!(found.values().iter().all(|c| *c == [0.1, 0.7, 1e-12]));
    }
}

#[test]
fn counts_say_how_many_were_averaged() {
    let all = vertices(700, 8);
    let count = |i: &Rgb| all.iter().filter(|j| distance_squared(i, j) <= 0.2 * 0.2).count();
    let counts: Vec<usize> = all.iter().map(count).collect();
    let found = PathSpaceFilter::new(Radius::absolute(0.2).unwrap()).average(&all, 1);
    assert_eq!(found.max_count() as usize, *counts.iter().max().unwrap());
    let mean = counts.iter().sum::<usize>() as f64 / counts.len() as f64;
    assert!((found.mean_count() - mean).abs() < 1e-9);
}

#[test]
fn radii_of_all_orders_of_magnitude_find_what_they_should() {
    let mut all = vertices(900, 12);
    for (i, vertex) in all.iter_mut().enumerate() {
        vertex.path_length = 10_f32.powi(i as i32 % 12 - 9);
    }
    let expected = equation_1(&all, |v| 0.3 * v.path_length, |_, _, _| 1.0);
    let filter = PathSpaceFilter::new(Radius::of_distance(0.3).unwrap());
    for search in SEARCHES {
        assert_close(&filter.search(search).average(&all, 1), &expected, &format!("{search:?}"));
    }
}

proptest! {
    #[test]
    fn averages_are_linear_bounded_and_do_not_depend_on_the_order(
        seed in any::<u64>(),
        count in 1_usize..200,
        radius in 0.01_f32..1.0,
        factor in -3.0_f32..3.0,
    ) {
        let a = vertices(count, seed);
        let mut b = a.clone();
        b.iter_mut().zip(vertices(count, seed ^ 1)).for_each(|(b, other)| b.contribution = other.contribution);
        let sum: Vec<Rgb> = a.iter().zip(&b).map(|(a, b)| {
            Rgb { contribution: std::array::from_fn(|k| a.contribution[k] + factor * b.contribution[k]), ..*a }
        }).collect();
        let filter = PathSpaceFilter::new(Radius::absolute(radius).unwrap()).similarity(SameObject).iterations(2);
        let (of_a, of_b, of_sum) = (filter.average(&a, 1), filter.average(&b, 1), filter.average(&sum, 1));
        for i in 0..count {
            for k in 0..3 {
                let expected = of_a.values()[i][k] + factor * of_b.values()[i][k];
                prop_assert!((of_sum.values()[i][k] - expected).abs() < 1e-4);
            }
            // Weights sum to one: no average is beyond what was averaged.
            let largest = a.iter().map(|v| v.contribution[1]).fold(0.0, f32::max);
            prop_assert!((0.0..=largest).contains(&of_a.values()[i][1]));
        }
        let reversed: Vec<Rgb> = a.iter().rev().copied().collect();
        for (x, y) in filter.average(&reversed, 1).into_iter().rev().zip(of_a) {
            prop_assert!((0..3).all(|k| (x[k] - y[k]).abs() <= 1e-5));
        }
    }
}
