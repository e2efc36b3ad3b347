//! Free flight: distances against the exponential density, weights against Beer and Lambert's law.

use estimator_checks::{Check, Moments, Outcome, Truth, kolmogorov_smirnov, mean_is};
use scene_core::medium::Medium;
use scene_core::{Rgb, Spectrum};

use super::SUITE;

fn chromatic() -> Medium<Rgb> {
    Medium::new(Rgb::new(0.2, 0.5, 1.0), Rgb::new(0.6, 3.0, 9.0), 0.0).unwrap()
}

const THROUGHPUT: Rgb = Rgb::new(0.9, 0.3, 0.6);

fn distances(check: &Check, medium: &Medium<Rgb>, channels: Rgb) -> Vec<f64> {
    let mut uniforms = check.uniforms();
    (0..20_000).map(|_| f64::from(medium.sample_distance(channels, uniforms.array::<2>().map(|x| x as f32)))).collect()
}

#[test]
fn distances_are_exponential() {
    let grey = Medium::new(Rgb::splat(0.5), Rgb::splat(2.0), 0.0).unwrap();
    let run = |check: Check, sigma: f64| -> Outcome {
        let samples = distances(&check, &grey, grey.channels(Rgb::ONE));
        kolmogorov_smirnov(check, &samples, |t| 1.0 - (-sigma * t).exp())
    };
    run(SUITE.check("free flight, grey"), 2.5).expect_pass();
    run(SUITE.twin("free flight, grey: absorption forgotten"), 2.0).expect_reject();
}

#[test]
fn distances_follow_the_mixture() {
    let medium = chromatic();
    let channels = medium.channels(THROUGHPUT);
    let run = |check: Check, assumed: Rgb| -> Outcome {
        let samples = distances(&check, &medium, channels);
        let sigma = medium.sigma_t();
        let cdf = |t: f64| 1.0 - (0..3).map(|i| f64::from(assumed[i]) * (-f64::from(sigma[i]) * t).exp()).sum::<f64>();
        kolmogorov_smirnov(check, &samples, |t| cdf(t).clamp(0.0, 1.0))
    };
    run(SUITE.check("free flight, mixture"), channels).expect_pass();
    run(SUITE.twin("free flight, mixture: uniform channels"), Rgb::splat(1.0 / 3.0)).expect_reject();
}

/// Estimates of what passes a layer of thickness 0.3, and of what scatters in it, in component `i`: distances sampled
/// by `sampled`, weighed for `weighed`.
fn layer(check: &Check, i: usize, passes: bool, sampled: Rgb, weighed: Rgb) -> Moments {
    let medium = chromatic();
    let mut uniforms = check.uniforms();
    let estimate = |distance: f32| match (distance > 0.3, passes) {
        (true, true) => medium.passing_weight(weighed, 0.3)[i],
        (false, false) => medium.scattering_weight(weighed, distance)[i],
        _ => 0.0,
    };
    (0..30_000)
        .map(|_| medium.sample_distance(sampled, uniforms.array::<2>().map(|x| x as f32)))
        .map(|distance| f64::from(estimate(distance)))
        .collect()
}

#[test]
fn all_components_keep_beer_and_lambert_s_law() {
    let medium = chromatic();
    let channels = medium.channels(THROUGHPUT);
    for i in 0..3 {
        let transmitted = f64::from(medium.transmittance(0.3)[i]);
        let albedo = f64::from(medium.sigma_s()[i] / medium.sigma_t()[i]);
        for (passes, truth) in [(true, transmitted), (false, albedo * (1.0 - transmitted))] {
            let name = format!("component {i}, passes: {passes}");
            let check = SUITE.check(&name);
            let estimates = layer(&check, i, passes, channels, channels);
            mean_is(check, &estimates, Truth::relative(truth, 1e-5)).expect_pass();
            let twin = SUITE.twin(&format!("{name}: weights of uniform channels"));
            let estimates = layer(&twin, i, passes, channels, Rgb::splat(1.0 / 3.0));
            mean_is(twin, &estimates, Truth::relative(truth, 1e-5)).expect_reject();
        }
    }
    // The component that sampled, weighed as if it were alone, is the estimator without the mixture.
    let twin = SUITE.twin("component 2: all weighed by the first");
    let estimates = layer(&twin, 2, true, channels, Rgb::new(1.0, 0.0, 0.0));
    mean_is(twin, &estimates, f64::from(medium.transmittance(0.3)[2])).expect_reject();
}

#[test]
fn weights_are_bounded_by_the_number_of_components() {
    let medium = chromatic();
    for throughput in [THROUGHPUT, Rgb::new(1.0, 1e-4, 1e-4), Rgb::new(1e-4, 1e-4, 1.0)] {
        let channels = medium.channels(throughput);
        for k in 0..400 {
            let distance = 0.02 * k as f32;
            for weight in [medium.passing_weight(channels, distance), medium.scattering_weight(channels, distance)] {
                let after = throughput * weight;
                assert!(after.max_component() <= 3.0 * throughput.max_component() * (1.0 + 1e-5), "{distance}");
            }
        }
    }
}
