//! How fast the error falls: independent random numbers beside Owen-scrambled Sobol points of `qmc-sampling`.
//!
//! ```text
//! I = integral over [0, 1)^3 of exp(-x - y - z) = (1 - 1/e)^3
//! ```
//! The error is the root mean square over independent randomisations: for quasi-Monte Carlo that is the only honest one.
//!
//! Run with `cargo run --release --example qmc_sampling`.
#![allow(clippy::print_stdout)]

use qmc_sampling::{Independent, OwenSobol, Sampler, SamplerFamily};

/// Independent randomisations.
const RANDOMISATIONS: u64 = 64;
/// Numbers of points: 4, 16, .., 4096.
const LOG2_POINTS: [u32; 6] = [2, 4, 6, 8, 10, 12];

/// The mean of the integrand over the first `points` points of stream `stream`.
fn estimate(family: &impl SamplerFamily, stream: u64, points: u64) -> f64 {
    let value = |index| {
        let mut sampler = family.sampler(stream, index);
        let ([x, y], z) = (sampler.next_2d(), sampler.next_1d());
        f64::from(-x - y - z).exp()
    };
    (0..points).map(value).sum::<f64>() / points as f64
}

/// Root mean square error over all randomisations. Streams of one family are independent, as the pixels of an image are.
fn error(family: &impl SamplerFamily, points: u64) -> f64 {
    let truth = (1.0 - (-1.0f64).exp()).powi(3);
    let squares = (0..RANDOMISATIONS).map(|stream| (estimate(family, stream, points) - truth).powi(2));
    (squares.sum::<f64>() / RANDOMISATIONS as f64).sqrt()
}

/// The exponent `a` of `error ~ points^a`, between the first and the last number of points.
fn exponent(errors: &[f64]) -> f64 {
    let span = f64::from(LOG2_POINTS[LOG2_POINTS.len() - 1] - LOG2_POINTS[0]);
    (errors[errors.len() - 1] / errors[0]).log2() / span
}

fn main() {
    let (random, sobol) = (Independent::new(1), OwenSobol::new(1));
    let (mut random_errors, mut sobol_errors) = (Vec::new(), Vec::new());
    println!("{:>7} {:>12} {:>12} {:>8}", "points", "random", "Owen-Sobol", "ratio");
    for log2 in LOG2_POINTS {
        let points = 1 << log2;
        let (a, b) = (error(&random, points), error(&sobol, points));
        println!("{points:>7} {a:>12.3e} {b:>12.3e} {:>8.1}", a / b);
        random_errors.push(a);
        sobol_errors.push(b);
    }
    let (a, b) = (exponent(&random_errors), exponent(&sobol_errors));
    println!("error ~ points^{a:.2} with random numbers, points^{b:.2} with Owen-Sobol points");
    assert!((a + 0.5).abs() < 0.1, "random numbers converge like the square root");
    // Owen 1997: n^-3/2, up to logarithms, for smooth integrands.
    assert!(b < -1.2, "scrambled nets converge faster");
}
