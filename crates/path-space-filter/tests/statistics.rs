//! Noise and consistency.
#![allow(clippy::unwrap_used)]

use estimator_checks::{Moments, Suite, Uniforms, slope_at_most, variance_ratio_is};
use path_space_filter::{JitteredHash, PathFilter, PathSpaceFilter, Poly6, Radius, Vertex};

static SUITE: Suite = Suite::with_share("path-space-filter", 4, 2e-8);

/// Vertices of a ball, the first one in the centre.
const K: usize = 8;

fn places() -> [f32; K] {
    [0.0, 0.1, -0.2, 0.3, 0.45, -0.5, 0.6, -0.8]
}

/// Independent contributions of equal mean and variance, from different distributions.
fn contributions(uniforms: &mut Uniforms) -> [f32; K] {
    let root = 3_f64.sqrt();
    std::array::from_fn(|i| {
        let u = uniforms.next_f64();
        let deviation = match i % 3 {
            0 => root * (2.0 * u - 1.0),
            1 => (u - 0.5).signum(),
            _ => [2.0, -0.5][usize::from(u >= 0.2)],
        };
        (2.0 + deviation) as f32
    })
}

/// Variances of what `filter` makes of the centre, batch by batch; without one of the contributions as they are.
fn variances(uniforms: &mut Uniforms, filter: Option<&dyn PathFilter<Vertex<f32>>>) -> Vec<f64> {
    let mut sample = || {
        let values = contributions(uniforms);
        let vertices: Vec<_> = (places().into_iter().zip(values))
            .map(|(x, contribution)| Vertex { position: [x, 0.0, 0.0], contribution, ..Vertex::default() })
            .collect();
        f64::from(filter.map_or(values[0], |filter| filter.average(&vertices, 1).values()[0]))
    };
    (0..100).map(|_| (0..400).map(|_| sample()).collect::<Moments>().variance()).collect()
}

#[test]
fn binary_weights_divide_the_variance_by_the_number_and_others_do_not() {
    let radius = Radius::absolute(1.0).unwrap();
    let (ball, poly6) = (PathSpaceFilter::new(radius), PathSpaceFilter::new(radius).kernel(Poly6));
    let check = SUITE.check("variance of the average of eight");
    let mut uniforms = check.uniforms();
    let input = variances(&mut uniforms, None);
    let averaged = variances(&mut uniforms, Some(&ball));
    variance_ratio_is(check, &averaged, &input, 1.0 / K as f64).expect_pass();
    variance_ratio_is(SUITE.twin("variance of the average of seven"), &averaged, &input, 1.0 / 7.0).expect_reject();

    // sum w^2 / (sum w)^2, which is no less than 1 / K.
    let weights = places().map(|x| (1.0 - f64::from(x).powi(2)).powi(3));
    let sum = |power: i32| weights.iter().map(|w| w.powi(power)).sum::<f64>();
    let ratio = sum(2) / sum(1).powi(2);
    assert!(ratio > 1.25 / K as f64);
    let check = SUITE.check("variance of the weighted average");
    let weighted = variances(&mut check.uniforms(), Some(&poly6));
    variance_ratio_is(check, &weighted, &input, ratio).expect_pass();
    variance_ratio_is(SUITE.twin("weights as good as a ball"), &weighted, &input, 1.0 / K as f64).expect_reject();
}

/// Pixels of a side of the image.
const SIDE: usize = 8;
/// Vertices of a batch.
const BATCH: usize = 1 << 10;

/// What a surface of unit size reflects: a shadow's edge, and a gradient.
fn radiance(x: f32, y: f32) -> f32 {
    (if x + 0.3 * y < 0.5 { 1.0 } else { 0.2 }) + 0.5 * x * y
}

/// Error of the image after so many batches, relative to nothing: mean over pixels of the squared difference from the truth.
fn squared_error(uniforms: &mut Uniforms, filter: &dyn PathFilter<Vertex<f32>>, batches: u64) -> f64 {
    let (mut image, mut truth) = (vec![0.0; SIDE * SIDE], vec![0.0; SIDE * SIDE]);
    for batch in 1..=batches {
        // Stratified like a net, so that pixels have as many vertices each.
        let side = (BATCH as f64).sqrt();
        let mut vertex = |i: usize| {
            let (column, row) = (i % side as usize, i / side as usize);
            let x = ((column as f64 + uniforms.next_f64()) / side) as f32;
            let y = ((row as f64 + uniforms.next_f64()) / side) as f32;
            let contribution = radiance(x, y) * if uniforms.next_f64() < 0.5 { 0.0 } else { 2.0 };
            Vertex {
                position: [x, y, 0.0],
                normal: [0.0, 0.0, 1.0],
                path_length: 1.0,
                contribution,
                ..Vertex::default()
            }
        };
        let vertices: Vec<Vertex<f32>> = (0..BATCH).map(&mut vertex).collect();
        for (vertex, mean) in vertices.iter().zip(filter.average(&vertices, batch)) {
            let cell = |t: f32| ((t * SIDE as f32) as usize).min(SIDE - 1);
            let pixel = cell(vertex.position[1]) * SIDE + cell(vertex.position[0]);
            image[pixel] += f64::from(mean);
        }
    }
    let per_pixel = (BATCH as u64 * batches) as f64 / (SIDE * SIDE) as f64;
    // Midpoints of 32 x 32 places per pixel.
    const FINE: usize = 32 * SIDE;
    for i in 0..FINE * FINE {
        let at = |k: usize| (k as f32 + 0.5) / FINE as f32;
        truth[i / FINE / 32 * SIDE + i % FINE / 32] += f64::from(radiance(at(i % FINE), at(i / FINE))) / 1024.0;
    }
    let error = |(image, truth): (&f64, &f64)| (image / per_pixel - truth).powi(2);
    image.iter().zip(&truth).map(error).sum::<f64>() / (SIDE * SIDE) as f64
}

/// Points of error over number of batches that share no samples.
fn errors(uniforms: &mut Uniforms, filter: &dyn PathFilter<Vertex<f32>>) -> Vec<(f64, f64)> {
    let mut error = |batches: u64| {
        let runs = 4.max(32 / batches);
        (0..runs).map(|_| squared_error(uniforms, filter, batches)).sum::<f64>() / runs as f64
    };
    [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128].map(|batches| (batches as f64, error(batches))).to_vec()
}

#[test]
fn the_error_falls_with_every_batch_unless_the_radius_is_held() {
    let radius = Radius::absolute(0.2).unwrap();
    // Along an edge the bias falls with the radius, as n^(-1/4), and the squared error as n^(-1/2); cells begin with more noise and are slower.
    let check = SUITE.check("ball");
    let ball = errors(&mut check.uniforms(), &PathSpaceFilter::new(radius));
    println!("{}", slope_at_most(check, &ball, -0.3).expect_pass());
    let check = SUITE.check("cells");
    let cells = errors(&mut check.uniforms(), &JitteredHash::new(radius));
    println!("{}", slope_at_most(check, &cells, -0.3).expect_pass());

    let held = SUITE.twin("ball, held");
    let ball = errors(&mut held.uniforms(), &PathSpaceFilter::new(radius.held()));
    println!("{}", slope_at_most(held, &ball, -0.3).expect_reject());
    let held = SUITE.twin("cells, held");
    let cells = errors(&mut held.uniforms(), &JitteredHash::new(radius.held()));
    println!("{}", slope_at_most(held, &cells, -0.3).expect_reject());
}
