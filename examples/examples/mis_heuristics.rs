//! Two techniques, each bad at half of an integral, combined by the heuristics of `mis-heuristics`.
//!
//! ```text
//! I = integral from 0 to 1 of f(x) dx = 1,   f(x) = 0.3 + 0.6 x + 4 x^9
//! p_0(x) = 1,  p_1(x) = 10 x^9,              I ~ sum over techniques i of w_i(x_i) f(x_i) / p_i(x_i)
//! ```
//! The uniform technique misses the peak at 1; the one made for the peak hardly ever looks elsewhere.
//!
//! Run with `cargo run --release --example mis_heuristics`.
#![allow(clippy::print_stdout)]

use mis_heuristics::{Balance, Counting, Cutoff, Heuristic, Lazy, Maximum, Power, RunningVariance, Stratification};
use qmc_sampling::{Independent, Sampler, SamplerFamily};

/// The integral.
const TRUTH: f64 = 1.0;
/// Samples of each technique.
const SAMPLES: u64 = 1_000_000;

fn integrand(x: f64) -> f64 {
    0.3 + 0.6 * x + 4.0 * x.powi(9)
}

/// Draws from technique 0 or 1.
fn sample(technique: usize, u: f64) -> f64 {
    if technique == 0 { u } else { u.powf(0.1) }
}

fn density(technique: usize, x: f64) -> f64 {
    if technique == 0 { 1.0 } else { 10.0 * x.powi(9) }
}

/// Mean, standard error and densities asked for per weight.
fn estimate(weight: impl Fn(usize, f64, &Counting<Lazy<&dyn Fn(usize) -> f64>>) -> f64) -> (f64, f64, f64) {
    let mut estimates = RunningVariance::new();
    let mut asked = 0;
    for index in 0..SAMPLES {
        let mut numbers = Independent::new(7).sampler(0, index);
        let mut sum = 0.0;
        for technique in [0, 1] {
            // The density of what was drawn is never zero.
            let x = sample(technique, 1.0 - f64::from(numbers.next_1d()));
            let compute = |i: usize| density(i, x);
            let densities = Counting::new(Lazy::new(2, &compute as &dyn Fn(usize) -> f64));
            sum += weight(technique, x, &densities) * integrand(x) / density(technique, x);
            asked += densities.take();
        }
        estimates.push(sum);
    }
    let standard_error = estimates.variance_of_mean().map_or(f64::NAN, f64::sqrt);
    (estimates.mean().unwrap_or(f64::NAN), standard_error, asked as f64 / (2 * SAMPLES) as f64)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let cutoff = Cutoff::new(0.1)?;
    let rows = [
        ("uniform alone", estimate(|technique, _, _| if technique == 0 { 1.0 } else { 0.0 })),
        ("balance", estimate(|technique, _, d| Balance.weight(technique, d))),
        ("power", estimate(|technique, _, d| Power::TWO.weight(technique, d))),
        ("maximum", estimate(|technique, _, d| Maximum.weight(technique, d))),
        ("cutoff", estimate(|technique, _, d| cutoff.weight(technique, d))),
        // Decides by the sample: uniform below 0.8, the other one above. No density is computed.
        ("stratification", estimate(|technique, x, d| Stratification::new(|k| k == 0 && x < 0.8).weight(technique, d))),
    ];
    println!("{:<16} {:>9} {:>11} {:>11} {:>18}", "heuristic", "mean", "error", "std. error", "densities / weight");
    for (name, (mean, standard_error, asked)) in rows {
        let error = mean - TRUTH;
        println!("{name:<16} {mean:>9.5} {error:>+11.5} {standard_error:>11.5} {asked:>18.2}");
        assert!(error.abs() < 5.0 * standard_error, "{name} is biased");
    }
    let alone = rows[0].1.1;
    assert!(rows[1..].iter().all(|(_, (_, standard_error, _))| *standard_error < 0.5 * alone));
    Ok(())
}
