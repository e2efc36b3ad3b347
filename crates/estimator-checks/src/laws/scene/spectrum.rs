//! The laws of `Spectrum`.

use scene_core::Spectrum;

use super::components;
use crate::laws::{Law, hold};
use crate::outcome::Outcome;

/// Relative round-off of one operation, on numbers of up to the size that takes part.
const ROUND_OFF: f64 = 1e-5;
/// Factors of spectra.
const FACTORS: [f32; 7] = [0.0, 1.0, -1.0, 0.5, 3.7, 1e-3, 1e3];

/// Checks the laws of a [`Spectrum`] on samples of one's own, and on some made of components.
///
/// ```text
/// (1)  c(ZERO) = 0,  c(splat(x)) = x,  c(a + b) = c(a) + c(b),  c(a - b) = c(a) - c(b),  c(k a) = k c(a),  c(a b) = c(a) c(b)
/// (2)  a += b is a + b,  a *= b is a * b,  1 a is a
/// (3)  luminance is linear, and not negative on spectra that are not
/// (4)  max_component is the largest component,  is_black  <=>  all are zero,  is_finite  <=>  all are finite
/// (5)  from_components(component) is the spectrum itself
/// ```
///
/// `c`: any `component`. Since numbers form a ring, (1) makes spectra one: sums and products commute and associate, but for
/// round-off. All equalities hold within 1e-5 of the largest number that takes part.
///
/// No chance is involved. Samples that are not finite are asked about (4) alone. Cost: the square of the number of samples.
///
/// ```
/// use estimator_checks::laws::scene::check_spectrum;
/// use scene_core::Rgb;
///
/// check_spectrum("rgb", &[Rgb::new(0.2, 3.0, 1e-4)]).expect_pass();
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_spectrum<S: Spectrum>(test: &str, samples: &[S]) -> Outcome {
    Outcome::of_laws(test, laws(samples))
}

fn laws<S: Spectrum>(own: &[S]) -> Law {
    let zero = components(&S::ZERO);
    hold("ZERO has no component", zero.iter().all(|&c| c == 0.0), || format!("{zero:?}"))?;
    hold("a spectrum has components", S::COMPONENTS > 0, || "there are none".into())?;
    let mut samples = own.to_vec();
    samples.extend([S::ZERO, S::splat(1.0), S::splat(0.3)]);
    samples.extend((0..S::COMPONENTS).map(|one| S::from_components(|i| if i == one { 2.0 } else { 0.0 })));
    samples.push(S::from_components(|i| 0.25 + 0.7 * i as f32));
    for value in [0.0, 1.0, 0.3, 1e4] {
        same(
            "splat has the same value in every component",
            &S::splat(value),
            |_| value.into(),
            value.into(),
            &[value],
        )?;
    }
    for &a in &samples {
        predicates(a)?;
        for extreme in [f32::INFINITY, f32::NAN] {
            predicates(a * extreme)?;
        }
    }
    samples.retain(|a| components(a).iter().all(|c| c.is_finite()));
    for &a in &samples {
        alone(a)?;
        for &b in &samples {
            together(a, b)?;
        }
    }
    Ok(())
}

/// Compares the components of a spectrum with what they must be, within round-off of `size`.
fn same<S: Spectrum>(
    law: &'static str,
    found: &S,
    expected: impl Fn(usize) -> f64,
    size: f64,
    of: &[impl std::fmt::Debug],
) -> Law {
    let found = components(found);
    let expected: Vec<f64> = (0..S::COMPONENTS).map(expected).collect();
    let is_near = found.iter().zip(&expected).all(|(x, y)| (x - y).abs() <= ROUND_OFF * size);
    hold(law, is_near, || format!("{found:?} should be {expected:?} for {of:?}"))
}

fn predicates<S: Spectrum>(a: S) -> Law {
    let of_a = components(&a);
    let finite = of_a.iter().all(|c| c.is_finite());
    hold("is_finite holds if all components are, and only then", a.is_finite() == finite, || {
        format!("{a:?}: {of_a:?}")
    })?;
    let black = of_a.iter().all(|&c| c == 0.0);
    hold("is_black holds if all components are zero, and only then", a.is_black() == black, || {
        format!("{a:?}: {of_a:?}")
    })
}

fn alone<S: Spectrum>(a: S) -> Law {
    let of_a = components(&a);
    let largest = of_a.iter().fold(f64::NEG_INFINITY, |largest, &c| largest.max(c));
    let found = f64::from(a.max_component());
    hold("max_component is the largest component", found == largest, || format!("{found} of {of_a:?}"))?;
    let size = size(&of_a);
    let again = S::from_components(|i| a.component(i));
    same("from_components takes what component says", &again, |i| of_a[i], size, &[a])?;
    same("splat(1.0) is one", &(S::splat(1.0) * a), |i| of_a[i], size, &[a])?;
    let luminance = f64::from(a.luminance());
    if of_a.iter().all(|&c| c >= 0.0) {
        hold("luminance is not negative", luminance >= 0.0, || format!("{luminance} of {of_a:?}"))?;
    }
    for k in FACTORS {
        let (scaled, wide) = (a * k, f64::from(k));
        same("numbers scale every component", &scaled, |i| wide * of_a[i], size * wide.abs(), &[a, S::splat(k)])?;
        let (found, expected) = (f64::from(scaled.luminance()), wide * luminance);
        let near = (found - expected).abs() <= ROUND_OFF * size.max(luminance.abs()) * wide.abs();
        hold("luminance is linear", near, || format!("{found} of {k} times {of_a:?}, {luminance} of that alone"))?;
    }
    Ok(())
}

fn together<S: Spectrum>(a: S, b: S) -> Law {
    let (of_a, of_b, of) = (components(&a), components(&b), [a, b]);
    let sum = size(&of_a) + size(&of_b);
    same("+ adds every component", &(a + b), |i| of_a[i] + of_b[i], sum, &of)?;
    same("- subtracts every component", &(a - b), |i| of_a[i] - of_b[i], sum, &of)?;
    let product = size(&of_a) * size(&of_b);
    same("* multiplies every component", &(a * b), |i| of_a[i] * of_b[i], product, &of)?;
    let [mut added, mut multiplied] = [a; 2];
    added += b;
    multiplied *= b;
    same("+= is +", &added, |i| f64::from((a + b).component(i)), sum, &of)?;
    same("*= is *", &multiplied, |i| f64::from((a * b).component(i)), product, &of)?;
    let [left, right, both] = [a, b, a + b].map(|x| f64::from(x.luminance()));
    let near = (both - (left + right)).abs() <= ROUND_OFF * sum.max(left.abs() + right.abs());
    hold("luminance is linear", near, || format!("{both} of the sum, {left} and {right} of {of_a:?} and {of_b:?}"))
}

fn size(of: &[f64]) -> f64 {
    of.iter().fold(0.0, |largest, c| largest.max(c.abs()))
}
