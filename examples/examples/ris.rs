//! Light of a square lamp on a floor, half of it hidden: many candidates, one shadow ray.
//!
//! ```text
//! f(y) = cos cos / d^2 * V(y),   g = cos cos / d^2,   p = 1 / area,   V = 1 where y_x > 0
//! ```
//! The lamp lies parallel to the floor, the point below its middle, so that the hidden half takes half of the light. The program
//! prints the error against the closed form of the form factor, and the variance that the model predicts beside what is measured.
//!
//! Run with `cargo run --release --example ris`.
#![allow(clippy::print_stdout)]

use std::f64::consts::PI;

use qmc_sampling::{Independent, IndependentSampler, Sampler, SamplerFamily};
use ris::{Budget, CostModel, Objective, Pairwise, Reservoir, Ris, VarianceModel, from_fn};

/// Half of the lamp's side, its height.
const HALF: f64 = 4.0;
const HEIGHT: f64 = 1.0;
const ESTIMATES: u64 = 100_000;
/// Of a candidate, and of a sample: a shadow ray costs as much as twenty candidates.
const COSTS: [f64; 2] = [1.0, 20.0];
/// Time per estimate, in candidates.
const TIME: f64 = 60.0;

type Point = [f64; 2];

/// The target: what light would arrive from there if nothing were in between.
fn unshadowed(y: &Point) -> f64 {
    let distance_squared = y[0] * y[0] + y[1] * y[1] + HEIGHT * HEIGHT;
    (HEIGHT / distance_squared).powi(2)
}

/// The integrand.
fn light(y: &Point) -> f64 {
    if y[0] > 0.0 { unshadowed(y) } else { 0.0 }
}

/// The form factor of four rectangles with a corner above the point, times pi; half of them are hidden.
fn truth() -> f64 {
    let root = HALF.hypot(HEIGHT);
    2.0 * (HALF / root) * (HALF / root).atan()
}

/// A stream of numbers for each estimate.
fn numbers(index: u64) -> impl FnMut() -> f64 {
    let mut sampler: IndependentSampler = Independent::new(3).sampler(0, index);
    move || f64::from(sampler.next_1d())
}

/// Mean and variance of a single estimate.
fn measure(estimate: impl Fn(&mut dyn FnMut() -> f64) -> f64) -> (f64, f64) {
    let (mut sum, mut square) = (0.0, 0.0);
    for index in 0..ESTIMATES {
        let value = estimate(&mut numbers(index));
        sum += value;
        square += value * value;
    }
    let mean = sum / ESTIMATES as f64;
    (mean, square / ESTIMATES as f64 - mean * mean)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let density = 1.0 / (4.0 * HALF * HALF);
    let lamp = from_fn(
        |u: &mut dyn FnMut() -> f64| ([(2.0 * u() - 1.0) * HALF, (2.0 * u() - 1.0) * HALF], density),
        |_: &Point| density,
    );

    // What would more candidates bring? Other numbers than the estimates take.
    let mut model = VarianceModel::<1>::new();
    let mut pilot = numbers(u64::MAX);
    for _ in 0..10_000 {
        let y = [(2.0 * pilot() - 1.0) * HALF, (2.0 * pilot() - 1.0) * HALF];
        model.add([light(&y)], unshadowed(&y), density);
    }
    let cost = CostModel::new(COSTS[0], COSTS[1])?;
    let time_of = |candidates: f64| Budget::within(candidates, cost, TIME);
    let budgets = [
        ("importance sampling", time_of(1.0)),
        ("robust, M = T_Y/T_X", time_of(cost.robust().candidates())),
        ("optimal, equation 3", model.optimal(cost, TIME, Objective::NormOfParts)),
        ("one sample", time_of(f64::INFINITY)),
    ];

    println!("{:<20} {:>6} {:>6} {:>10} {:>10} {:>10}", "", "M", "N", "error", "variance", "predicted");
    let mut variances = Vec::new();
    for (name, budget) in budgets {
        let ris = Ris::new(budget);
        let (mean, variance) = measure(|mut u| ris.estimate(&lamp, &unshadowed, &mut u, light));
        let (error, predicted) = (mean - truth(), model.predict(budget)[0]);
        let (candidates, samples) = (budget.candidates(), budget.samples());
        println!("{name:<20} {candidates:>6.2} {samples:>6.2} {error:>+10.5} {variance:>10.5} {predicted:>10.5}");
        assert!(error.abs() < 5.0 * (variance / ESTIMATES as f64).sqrt(), "{name} is biased");
        assert!((predicted / variance - 1.0).abs() < 0.15, "{name}: predicted {predicted}");
        variances.push(variance);
    }
    assert!(variances[2] < 0.8 * variances[0]);

    // Reuse: a neighbour that sees the visible half only has selected with its own target, visibility included.
    let select = |u: &mut dyn FnMut() -> f64, target: &dyn Fn(&Point) -> f64| {
        let mut reservoir = Reservoir::new();
        for _ in 0..8 {
            let sample = [(2.0 * u() - 1.0) * HALF, (2.0 * u() - 1.0) * HALF];
            reservoir.update(sample, target(&sample), 1.0 / density, u());
        }
        reservoir.finish()
    };
    let (alone, reused) = (
        measure(|u| select(u, &unshadowed).estimate(light)),
        measure(|u| {
            let (mine, theirs) = (select(u, &unshadowed), select(u, &light));
            let mut pairwise = Pairwise::new(mine, theirs.confidence);
            pairwise.add(theirs, &unshadowed, &light, u());
            pairwise.finish(u()).estimate(light)
        }),
    );
    println!("\n{:<28} {:>10} {:>10}", "eight candidates", "error", "variance");
    for (name, (mean, variance)) in [("alone", alone), ("with a neighbour's, pairwise", reused)] {
        let error = mean - truth();
        println!("{name:<28} {error:>+10.5} {variance:>10.5}");
        assert!(error.abs() < 5.0 * (variance / ESTIMATES as f64).sqrt(), "{name} is biased");
    }
    assert!(reused.1 < alone.1);
    println!("\nThe lamp, seen whole, would give {:.5} of {PI:.5}.", 2.0 * truth());
    Ok(())
}
