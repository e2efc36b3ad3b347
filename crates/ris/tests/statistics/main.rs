//! What sampling shows: means, variances and distributions of the real estimators, and bugs that have to be found.
//!
//! The integrand is `f(x) = x^3 + 0.2` on `[0, 1]`, of integral 0.45.

#![allow(clippy::unwrap_used)]

use estimator_checks::{Moments, Suite, Uniforms};
use ris::{Mixture, Proposal, Source, Uniform, from_fn};

mod distribution;
mod reuse;
mod unbiased;
mod variance;

static SUITE: Suite = Suite::with_share("ris", 124, 5e-8);

const TRUTH: f64 = 0.45;

fn f(x: &f64) -> f64 {
    x * x * x + 0.2
}

type Score = fn(&f64) -> f64;

/// From a perfect target to one that promises most where there is least.
const TARGETS: [(&str, Score); 4] =
    [("linear", |x| x + 0.1), ("constant", |_| 3.0), ("perfect", |x| 2.0 * f(x)), ("adverse", |x| 1.3 - x)];

fn uniform() -> impl Source<f64, f64> {
    from_fn(|u: &mut dyn FnMut() -> f64| (u(), 1.0), |_: &f64| 1.0)
}

/// Density `2 (1 - x) 0.8 + 0.2`, by its two parts.
fn falling() -> impl Source<f64, f64> {
    let linear = from_fn(
        |u: &mut dyn FnMut() -> f64| {
            let x = 1.0 - (1.0 - u()).sqrt();
            (x, 2.0 * (1.0 - x))
        },
        |x: &f64| 2.0 * (1.0 - x),
    );
    Mixture::new(uniform(), linear, 0.8)
}

/// Density `1.6 x + 0.1`, and nothing with probability 0.1.
struct Rising;

impl Source<f64, f64> for Rising {
    fn propose(&self, uniform: &mut impl Uniform<f64>) -> Option<Proposal<f64, f64>> {
        let lobe = uniform.next_uniform();
        let u = uniform.next_uniform();
        let sample = if lobe < 0.8 { u.sqrt() } else { u };
        (lobe < 0.9).then(|| Proposal { sample, density: self.density(&sample) })
    }
    fn density(&self, x: &f64) -> f64 {
        1.6 * x + 0.1
    }
}

fn moments(uniforms: &mut Uniforms, count: usize, mut estimate: impl FnMut(&mut Uniforms) -> f64) -> Moments {
    (0..count).map(|_| estimate(uniforms)).collect()
}

/// A candidate of a source, with density zero where it failed.
fn proposal(source: &impl Source<f64, f64>, uniforms: &mut Uniforms) -> Proposal<f64, f64> {
    source.propose(&mut || uniforms.next_f64()).unwrap_or(Proposal { sample: 0.0, density: 0.0 })
}
