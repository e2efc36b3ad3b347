//! The laws of the traits of `path-space-filter`: `Contribution`, `Attenuate`, `Kernel`, `Modulation` and `Similarity`.

use path_space_filter::{Attenuate, Contribution, Kernel, Modulation, PathVertex};

pub use path_space_filter::check_similarity;

use super::{Law, hold, near};
use crate::outcome::Outcome;

/// Weights that contributions are added with.
const WEIGHTS: [f32; 6] = [1.0, 0.5, 4.0, 0.3, 1e-3, 7.0];
/// How often the same contribution is added.
const TIMES: [u32; 6] = [1, 2, 3, 7, 100, 1000];
/// Of the law on equal contributions: what is at least as coarse as `f32` has fewer digits than its sum.
const SINGLE_PRECISION: f64 = f32::EPSILON as f64 / 2.0;

/// Checks the laws of a [`Contribution`] on samples, which had better differ in all components.
///
/// ```text
/// (1)  c(mean(u a + v b, u + v)) = (u c(a) + v c(b)) / (u + v)        for weights u, v > 0, in either order
/// (2)  mean(u a + 0 b, u) = mean(u a, u)
/// (3)  mean(a + a + .. + a, sum of the weights) = a, bit for bit      for weights that are powers of two
/// (4)  a.is_finite()  <=>  all c(a) are finite
/// ```
///
/// `c`: `components`, the amounts that a contribution carries. (1) holds within `round_off` times the largest
/// component that takes part: 1e-6 for `f32`, 1e-14 for `f64`. (3) is asked of contributions with a `round_off` of `f32` or
/// coarser; others are compared within it, because their sums have no more digits than they.
///
/// No chance is involved. Cost: the square of the number of samples.
///
/// ```
/// use estimator_checks::laws::path_space::check_contribution;
///
/// check_contribution("rgb", &[[1.0_f32, 0.5, 0.25], [0.0, 3e4, 1e-5]], |c| c.map(f64::from), 1e-6).expect_pass();
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_contribution<C: Contribution, A: AsRef<[f64]>>(
    test: &str,
    samples: &[C],
    components: impl Fn(C) -> A,
    round_off: f64,
) -> Outcome {
    let amounts = |contribution: C| components(contribution).as_ref().to_vec();
    Outcome::of_laws(test, contribution_laws(samples, amounts, round_off))
}

fn contribution_laws<C: Contribution>(samples: &[C], amounts: impl Fn(C) -> Vec<f64>, round_off: f64) -> Law {
    let mean = |terms: &[(C, f32)]| {
        let mut sum = C::NOTHING;
        terms.iter().for_each(|(contribution, weight)| contribution.add(*weight, &mut sum));
        C::mean(&sum, terms.iter().map(|term| f64::from(term.1)).sum())
    };
    let finite: Vec<C> = samples.iter().copied().filter(|&a| amounts(a).iter().all(|c| c.is_finite())).collect();
    for &a in samples {
        let of_a = amounts(a);
        let all = of_a.iter().all(|c| c.is_finite());
        let shown = || format!("is_finite is {} for {of_a:?}", !all);
        hold("a contribution is finite if all components are, and only then", a.is_finite() == all, shown)?;
    }
    for &a in &finite {
        for (&b, (u, v)) in finite.iter().flat_map(|b| pairs().map(move |pair| (b, pair))) {
            let (of_a, of_b) = (amounts(a), amounts(b));
            let (wide_u, wide_v) = (f64::from(u), f64::from(v));
            let expected = of_a.iter().zip(&of_b).map(|(a, b)| (wide_u * a + wide_v * b) / (wide_u + wide_v));
            let expected: Vec<f64> = expected.collect();
            let allowance = round_off * largest(&of_a).max(largest(&of_b));
            for (found, order) in [(mean(&[(a, u), (b, v)]), "a, b"), (mean(&[(b, v), (a, u)]), "b, a")] {
                let found = amounts(found);
                let shown = || format!("{found:?} of {order} = {of_a:?}, {of_b:?} with weights {u}, {v}");
                hold("the mean is linear in contributions and weights", is_near(&found, &expected, allowance), shown)?;
            }
            let (alone, beside) = (amounts(mean(&[(a, u)])), amounts(mean(&[(a, u), (b, 0.0)])));
            let shown = || format!("{alone:?} became {beside:?} by {of_b:?} of weight 0");
            hold("a contribution of weight zero changes nothing", alone == beside, shown)?;
        }
        equal_terms(a, &amounts, mean, round_off)?;
    }
    Ok(())
}

fn pairs() -> impl Iterator<Item = (f32, f32)> {
    WEIGHTS.into_iter().flat_map(|u| WEIGHTS.map(|v| (u, v)))
}

fn equal_terms<C: Contribution>(
    a: C,
    amounts: impl Fn(C) -> Vec<f64>,
    mean: impl Fn(&[(C, f32)]) -> C,
    round_off: f64,
) -> Law {
    for times in TIMES {
        let terms: Vec<(C, f32)> = [1.0, 0.5, 4.0].into_iter().cycle().take(times as usize).map(|w| (a, w)).collect();
        let (found, of_a) = (amounts(mean(&terms)), amounts(a));
        let same = if round_off >= SINGLE_PRECISION {
            found == of_a
        } else {
            is_near(&found, &of_a, round_off * largest(&of_a))
        };
        let shown = || format!("{found:?} of {times} times {of_a:?}");
        hold("the mean of equal contributions is one of them, bit for bit", same, shown)?;
    }
    Ok(())
}

/// Checks the laws of [`Attenuate`]: product and sum of each component alone, within `round_off` of their size.
///
/// ```text
/// c(a.times(b)) = c(a) c(b),     c(a.plus(b)) = c(a) + c(b)
/// ```
///
/// Samples are finite; products beyond the largest number are not compared. No chance is involved.
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_attenuate<C: Attenuate, A: AsRef<[f64]>>(
    test: &str,
    samples: &[C],
    components: impl Fn(C) -> A,
    round_off: f64,
) -> Outcome {
    let amounts = |contribution: C| components(contribution).as_ref().to_vec();
    let laws = || {
        for (&a, &b) in samples.iter().flat_map(|a| samples.iter().map(move |b| (a, b))) {
            let (of_a, of_b) = (amounts(a), amounts(b));
            let both = |f: fn(f64, f64) -> f64| of_a.iter().zip(&of_b).map(|(a, b)| f(*a, *b)).collect::<Vec<f64>>();
            for (law, found, expected) in [
                ("times multiplies all components", amounts(a.times(b)), both(|a, b| a * b)),
                ("plus adds all components", amounts(a.plus(b)), both(|a, b| a + b)),
            ] {
                let allowance = round_off * largest(&expected);
                let shown = || format!("{found:?} of {of_a:?} and {of_b:?}");
                hold(law, is_near(&found, &expected, allowance), shown)?;
            }
        }
        Ok(())
    };
    Outcome::of_laws(test, laws() as Law)
}

/// Checks the laws of a [`Kernel`]: finite and not negative within the radius (and a little beyond, by round-off), 1 in the
/// centre, the same when asked again. No chance is involved.
///
/// ```
/// use estimator_checks::laws::path_space::check_kernel;
///
/// check_kernel("poly6", &path_space_filter::Poly6).expect_pass();
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_kernel(test: &str, kernel: &impl Kernel) -> Outcome {
    const STEPS: u16 = 1000;
    let laws = || {
        let center = kernel.weight(0.0);
        hold("the weight in the centre is one", center == 1.0, || format!("it is {center}"))?;
        let inside = (0..=STEPS).map(|i| f32::from(i) / f32::from(STEPS));
        for t_squared in inside.chain([f32::MIN_POSITIVE, 1.0_f32.next_down(), 1.0 + 4.0 * f32::EPSILON]) {
            let weight = kernel.weight(t_squared);
            let shown = || format!("it is {weight} at t^2 = {t_squared}");
            hold("the weight is finite and not negative", weight.is_finite() && weight >= 0.0, shown)?;
            let again = kernel.weight(t_squared);
            let shown = || format!("{weight}, then {again} at t^2 = {t_squared}");
            hold("the same distance gives the same weight", weight.to_bits() == again.to_bits(), shown)?;
        }
        Ok(())
    };
    Outcome::of_laws(test, laws() as Law)
}

/// Checks the law of a [`Modulation`] on vertices with finite contributions: `remodulate(v, demodulate(v))` is
/// `v.contribution()`, in each component within `round_off` of its size. No chance is involved.
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_modulation<V: PathVertex, A: AsRef<[f64]>>(
    test: &str,
    modulation: &impl Modulation<V>,
    vertices: &[V],
    components: impl Fn(V::Contribution) -> A,
    round_off: f64,
) -> Outcome {
    let amounts = |contribution| components(contribution).as_ref().to_vec();
    let laws = || {
        for (i, vertex) in vertices.iter().enumerate() {
            let expected = amounts(vertex.contribution());
            let found = amounts(modulation.remodulate(vertex, modulation.demodulate(vertex)));
            let same =
                expected.len() == found.len() && found.iter().zip(&expected).all(|(a, b)| near(*a, *b, round_off));
            let shown = || format!("{expected:?} became {found:?} at vertex {i}");
            hold("what is demodulated and remodulated is the contribution", same, shown)?;
        }
        Ok(())
    };
    Outcome::of_laws(test, laws() as Law)
}

/// The largest magnitude; NaN is none.
fn largest(amounts: &[f64]) -> f64 {
    amounts.iter().fold(0.0, |largest, c| largest.max(c.abs()))
}

/// Whether numbers are as near as that. What is beyond the largest `f32` may have become infinite.
fn is_near(found: &[f64], expected: &[f64], distance: f64) -> bool {
    let near = |(x, y): (&f64, &f64)| (x - y).abs() <= distance || y.abs() > f64::from(f32::MAX);
    found.len() == expected.len() && found.iter().zip(expected).all(near)
}
