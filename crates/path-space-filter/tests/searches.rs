//! Neighbours on the screen, in cells, and around queries of others.
#![allow(clippy::unwrap_used)]

mod support;

use path_space_filter::{
    Demodulated, JitteredHash, NormalCone, PathFilter, PathSpaceFilter, Radius, SameObject, Screen, Search,
    SimilarityExt, Vertex,
};
use support::{Numbers, Rgb, assert_close, distance_squared, equation_1, vertices};

const SEARCHES: [Search; 5] =
    [Search::Grid, Search::DivideAndConquer, Search::KdTree, Search::Hierarchy, Search::BruteForce];

#[test]
fn the_screen_finds_what_lies_in_the_window_and_in_the_ball() {
    let all = vertices(800, 21);
    for (reach, radius) in [(0, 10.0), (1, 0.5), (3, 0.3), (50, 0.3)] {
        let near = |i: &Rgb, j: &Rgb| (0..2).all(|k| i.pixel[k].abs_diff(j.pixel[k]) <= reach);
        let alike = |i: &Rgb, j: &Rgb| if near(i, j) && i.object == j.object { 1.0 } else { 0.0 };
        let expected = equation_1(&all, |_| radius, |i, j, _| alike(i, j));
        let filter = PathSpaceFilter::new(Radius::absolute(radius).unwrap()).similarity(SameObject);
        let found = filter.average_on_screen(&Screen::new(16, 16, reach).unwrap(), &all, 1);
        assert_close(&found, &expected, &format!("reach {reach}"));
    }
    // A window over all the screen is no window, and who is outside of the screen keeps what they have.
    let filter = PathSpaceFilter::new(Radius::absolute(0.3).unwrap());
    let expected: Vec<_> = filter.average(&all, 1).into_iter().map(|c| c.map(f64::from)).collect();
    assert_close(&filter.average_on_screen(&Screen::new(16, 16, 16).unwrap(), &all, 1), &expected, "everything");
    let small = filter.average_on_screen(&Screen::new(8, 16, 16).unwrap(), &all, 1);
    for (mean, vertex) in small.into_iter().zip(&all).filter(|(_, vertex)| vertex.pixel[0] >= 8) {
        assert_eq!(mean, vertex.contribution);
    }
}

#[test]
fn queries_average_what_others_contribute() {
    let (all, mut queries) = (vertices(600, 22), vertices(200, 23));
    queries[3].position = [50.0; 3];
    for (radius, batch) in [(Radius::absolute(0.2), 1), (Radius::of_distance(0.1), 16)] {
        let radius = radius.unwrap();
        let alike = NormalCone::new(0.5).unwrap().and(SameObject);
        let filter = PathSpaceFilter::new(radius).similarity(alike).modulation(Demodulated::default());
        for search in SEARCHES {
            let found = filter.search(search).average_at(&queries, &all, batch);
            assert_eq!(found.len(), queries.len());
            let (mut empty, mut full) = (0, 0);
            for (query, found) in queries.iter().zip(found) {
                let (mut sum, mut count) = ([0.0; 3], 0.0);
                let r = radius.at(batch, query.path_length);
                let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
                for j in all.iter().filter(|j| distance_squared(query, j) <= r * r) {
                    if dot(query.normal, j.normal) >= 0.5 && query.object == j.object {
                        count += 1.0;
                        (0..3).for_each(|k| sum[k] += f64::from(j.contribution[k] / j.albedo[k].max(0.01)));
                    }
                }
                match found {
                    None => assert_eq!(count, 0.0),
                    Some(mean) => {
                        for k in 0..3 {
                            let expected = sum[k] / count * f64::from(query.albedo[k].max(0.01));
                            assert!((f64::from(mean[k]) - expected).abs() <= 1e-4 * (1e-3 + expected), "{search:?}");
                        }
                    }
                }
                *(if found.is_none() { &mut empty } else { &mut full }) += 1;
            }
            // Both kinds were there.
            assert!(empty > 5 && full > 5, "{empty} empty, {full} not");
        }
    }
    // What queries say that they contribute is nobody's business.
    let filter = PathSpaceFilter::new(Radius::absolute(0.2).unwrap()).iterations(2);
    let before = filter.average_at(&queries, &all, 1);
    queries.iter_mut().for_each(|query| query.contribution = [f32::NAN; 3]);
    assert_eq!(filter.average_at(&queries, &all, 1), before);
}

#[test]
fn several_iterations_end_at_the_queries() {
    let all = vertices(500, 24);
    let filter = PathSpaceFilter::new(Radius::absolute(0.25).unwrap());
    let mut step = all.clone();
    step.iter_mut().zip(filter.average(&all, 1)).for_each(|(vertex, mean)| vertex.contribution = mean);
    let expected = filter.average_at(&all, &step, 1);
    for (found, expected) in filter.iterations(2).average_at(&all, &all, 1).into_iter().zip(expected) {
        let (found, expected) = (found.unwrap(), expected.unwrap());
        assert!((0..3).all(|k| (found[k] - expected[k]).abs() <= 1e-5));
    }
    assert_eq!(filter.iterations(0).average_at(&all, &all, 1), vec![None; all.len()]);
}

/// A plane of vertices, all alike.
fn plane(count: usize, seed: u64) -> Vec<Vertex<f32>> {
    let mut numbers = Numbers(seed);
    let mut vertex = || Vertex {
        position: [numbers.next(), numbers.next(), 0.5],
        normal: [0.0, 0.0, 1.0],
        path_length: 1.0,
        contribution: numbers.next(),
        ..Vertex::default()
    };
    (0..count).map(|_| vertex()).collect()
}

#[test]
fn cells_average_their_own_and_nobody_else() {
    let mut all = plane(20_000, 31);
    // Objects and normals keep apart, whatever the place.
    for (i, vertex) in all.iter_mut().enumerate() {
        vertex.object = i as u32 % 3;
        vertex.normal[2] = if i % 2 == 0 { 1.0 } else { -1.0 };
        vertex.contribution = [1.0, 10.0, 100.0, 1000.0, 1e4, 1e5][i % 6];
    }
    let filter = JitteredHash::new(Radius::absolute(0.1).unwrap()).key(|vertex: &Vertex<f32>| vertex.object);
    let found = filter.average(&all, 1);
    assert!(found.mean_count() > 50.0);
    assert!(found.into_iter().zip(&all).all(|(mean, vertex)| mean == vertex.contribution));
    // Without the key they mix.
    let mixed = JitteredHash::new(Radius::absolute(0.1).unwrap()).average(&all, 1);
    assert!(mixed.into_iter().zip(&all).filter(|(mean, vertex)| *mean == vertex.contribution).count() < 100);
}

#[test]
fn a_cell_holds_about_as_many_as_a_ball_and_sums_are_kept() {
    let all = plane(50_000, 32);
    for radius in [Radius::absolute(0.05), Radius::of_distance(0.0443)] {
        let radius = radius.unwrap();
        let (ball, cell) = (PathSpaceFilter::new(radius).average(&all, 1), JitteredHash::new(radius).average(&all, 1));
        // The mean number of a cell's vertices counts large cells more often; levels are off by a half at most.
        let ratio = cell.mean_count() / ball.mean_count();
        assert!((0.5..2.0).contains(&ratio), "{ratio}");
        // Cells are symmetric: the mean of the averages is the mean.
        let mean = |values: &[f32]| values.iter().map(|c| f64::from(*c)).sum::<f64>() / values.len() as f64;
        let truth = mean(&all.iter().map(|vertex| vertex.contribution).collect::<Vec<_>>());
        assert!((mean(cell.values()) - truth).abs() < 1e-6);
    }
}

#[test]
fn jitter_differs_between_batches_and_iterations_and_is_repeatable() {
    let all = plane(5000, 33);
    let filter = JitteredHash::new(Radius::absolute(0.05).unwrap().held());
    let first = filter.average(&all, 1);
    assert_eq!(first, filter.average(&all, 1));
    assert_ne!(first.values(), filter.average(&all, 2).values());
    // Twice in the same cells would change nothing.
    let twice = filter.iterations(2).average(&all, 1);
    assert_ne!(first.values(), twice.values());
    let spread = |values: &[f32]| values.iter().map(|c| (c - 0.5).powi(2)).sum::<f32>();
    assert!(spread(twice.values()) < 0.7 * spread(first.values()));
}

#[test]
fn cells_answer_queries() {
    let (all, mut queries) = (plane(20_000, 34), plane(500, 35));
    queries[7].position = [9.0; 3];
    let filter = JitteredHash::new(Radius::absolute(0.05).unwrap());
    let found = filter.average_at(&queries, &all, 1);
    assert_eq!(found[7], None);
    let close = |mean: &Option<f32>| mean.is_some_and(|mean| (mean - 0.5).abs() < 0.15);
    assert!(found.iter().filter(|mean| close(mean)).count() > 480);
    // At the vertices they say what averages say.
    let at: Vec<f32> = filter.average_at(&all, &all, 1).into_iter().flatten().collect();
    let averages = filter.average(&all, 1);
    assert!(at.iter().zip(&averages).all(|(a, b)| (a - b).abs() < 1e-6));
}

#[test]
fn vanishing_cells_return_the_input_bit_for_bit() {
    let all = plane(3000, 36);
    for radius in [0.0, 1e-7] {
        let found = JitteredHash::new(Radius::absolute(radius).unwrap()).iterations(2).average(&all, 1);
        assert!(found.into_iter().zip(&all).all(|(mean, vertex)| mean.to_bits() == vertex.contribution.to_bits()));
    }
}

#[test]
fn threads_change_nothing() {
    let all = vertices(30_000, 40);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let radius = Radius::of_distance(0.03).unwrap();
        pool.install(|| {
            let filter = PathSpaceFilter::new(radius).similarity(NormalCone::PAPER).iterations(2);
            let searched: Vec<_> = SEARCHES[..4].iter().map(|search| filter.search(*search).average(&all, 1)).collect();
            let screen = filter.average_on_screen(&Screen::new(16, 16, 2).unwrap(), &all[..2000], 1);
            (searched, screen, JitteredHash::new(radius).average(&all, 1), filter.average_at(&all[..500], &all, 1))
        })
    };
    assert_eq!(run(1), run(4));
}
