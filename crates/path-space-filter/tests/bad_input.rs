//! Nothing that a renderer may hand over makes the filter panic, or spread what is not a number.
#![allow(clippy::unwrap_used)]

mod support;

use path_space_filter::{
    AlbedoDifference, Demodulated, HitDistance, JitteredHash, NormalCone, PathFilter, PathSpaceFilter, Radius, Screen,
    Search, SimilarityExt, Vertex, ViewCone,
};
use support::{Rgb, vertices};

const SEARCHES: [Search; 5] =
    [Search::Grid, Search::DivideAndConquer, Search::KdTree, Search::Hierarchy, Search::BruteForce];

/// Vertices of which every tenth is damaged in some way.
fn damaged() -> Vec<Rgb> {
    let mut all = vertices(500, 11);
    for (i, vertex) in all.iter_mut().enumerate() {
        match i {
            10 => vertex.position[1] = f32::NAN,
            20 => vertex.position[2] = f32::INFINITY,
            30 => vertex.contribution[0] = f32::NAN,
            40 => vertex.contribution[2] = f32::INFINITY,
            50 => vertex.normal = [f32::NAN; 3],
            60 => vertex.normal = [0.0; 3],
            70 => vertex.albedo = [f32::NAN, 0.0, -1.0],
            80 => vertex.path_length = f32::NAN,
            90 => vertex.path_length = -1.0,
            100 => vertex.path_length = f32::INFINITY,
            110 => vertex.position = [1e30, -1e38, 3e38],
            120 => vertex.contribution = [f32::MAX; 3],
            130 => vertex.pixel = [u32::MAX; 2],
            _ => {}
        }
    }
    all
}

/// Checks what any filter must do with them.
fn check(filter: &impl PathFilter<Rgb>, what: &str) {
    let all = damaged();
    let found = filter.average(&all, 1).into_values();
    for (i, (mean, vertex)) in found.iter().zip(&all).enumerate() {
        if [10, 20, 30, 40].contains(&i) {
            assert_eq!(mean.map(f32::to_bits), vertex.contribution.map(f32::to_bits), "{what}, {i}");
        } else {
            assert!(mean.iter().all(|c| c.is_finite()), "{what}, {i}: {mean:?}");
        }
    }
    let at = filter.average_at(&all, &all, 1);
    assert_eq!((at[10], at[20]), (None, None), "{what}");
    assert!(at.iter().flatten().flatten().all(|c| c.is_finite()), "{what}");
    assert_eq!(filter.average(&[], 1).values().len(), 0);
    assert_eq!((filter.average(&[], 1).max_count(), filter.average(&[], 1).mean_count()), (0, 0.0));
    assert_eq!(filter.average_at(&all[..3], &[], 1), vec![None; 3]);
    assert!(filter.average_at(&[], &all, 1).is_empty());
}

#[test]
fn damaged_vertices_keep_to_themselves() {
    let alike = NormalCone::PAPER
        .and(AlbedoDifference::PAPER)
        .and(ViewCone::new(0.0).unwrap())
        .and(HitDistance::new(0.5).unwrap());
    for radius in [Radius::absolute(0.2), Radius::of_distance(0.1), Radius::absolute(0.0), Radius::absolute(f32::MAX)] {
        let radius = radius.unwrap();
        for search in SEARCHES {
            let filter = PathSpaceFilter::new(radius).search(search);
            check(&filter, &format!("{radius:?}, {search:?}"));
            check(&filter.similarity(alike).iterations(2), &format!("{radius:?}, {search:?}, weights"));
            check(&filter.modulation(Demodulated::default()), &format!("{radius:?}, {search:?}, demodulated"));
        }
        check(&JitteredHash::new(radius), &format!("{radius:?}, hash"));
        check(&JitteredHash::new(radius).modulation(Demodulated::default()).iterations(3), "hash, demodulated");
        // An index of the caller's knows nothing of contributions.
        let all = damaged();
        let index = range_search::KdTree::build(&all, |vertex| vertex.position).unwrap();
        let found = PathSpaceFilter::new(radius).average_with(&index, &all, 1);
        assert!(
            found.values().iter().enumerate().all(|(i, c)| [30, 40].contains(&i) || c.iter().all(|c| c.is_finite()))
        );
        let screen = Screen::new(16, 16, 20).unwrap();
        let found = PathSpaceFilter::new(radius).average_on_screen(&screen, &damaged(), 1);
        assert!(
            found.values().iter().enumerate().all(|(i, c)| [30, 40].contains(&i) || c.iter().all(|c| c.is_finite()))
        );
    }
}

#[test]
fn weights_that_break_their_laws_break_nothing_else() {
    let all = vertices(300, 2);
    for bad in [0.0, f32::NAN, f32::INFINITY, -1.0] {
        let filter = PathSpaceFilter::new(Radius::absolute(0.3).unwrap()).similarity(|_: &Rgb, _: &Rgb| bad);
        for search in SEARCHES {
            let found = filter.search(search).average(&all, 1);
            // The centre is included all the same, and it is alone.
            assert_eq!(found.max_count(), 1);
            assert!(found.into_iter().zip(&all).all(|(mean, vertex)| mean == vertex.contribution));
        }
    }
}

#[test]
fn coincident_vertices_are_all_averaged() {
    let vertex = |i: usize| Vertex { contribution: i as f32, normal: [0.0, 0.0, 1.0], ..Vertex::<f32>::default() };
    let all: Vec<Vertex<f32>> = (0..1001).map(vertex).collect();
    for radius in [0.0, 1.0] {
        let radius = Radius::absolute(radius).unwrap();
        for search in SEARCHES {
            let found = PathSpaceFilter::new(radius).search(search).average(&all, 1);
            assert!(found.values().iter().all(|c| *c == 500.0));
            assert_eq!(found.max_count(), 1001);
        }
    }
}

#[test]
fn thresholds_and_screens_are_checked() {
    for bad in [1.0, 1.5, f32::NAN] {
        assert!(NormalCone::new(bad).unwrap_err().to_string().contains(&bad.to_string()));
        assert!(ViewCone::new(bad).is_err());
    }
    for bad in [-0.1, f32::NAN] {
        assert!(AlbedoDifference::new(bad).unwrap_err().to_string().contains(&bad.to_string()));
        assert!(HitDistance::new(bad).is_err());
        assert!(path_space_filter::SimilarTime::new(bad).is_err());
    }
    for bad in [0.0, -1.0, f32::INFINITY, f32::NAN] {
        assert!(path_space_filter::CosinePower::new(bad).is_err());
        assert!(path_space_filter::AlbedoFalloff::new(bad).is_err());
    }
    assert!(Screen::new(0, 7, 1).unwrap_err().to_string().contains("0 x 7"));
    assert!(Screen::new(1 << 20, 1 << 20, 1).is_err());
    assert!(Screen::new(1, 1, u32::MAX).is_ok());
}
