//! Plane layers, whose reflectance is known: with Fresnel's interfaces, for a single scattering, and for all of them.

use std::f64::consts::PI;

use estimator_checks::{Check, Moments, Truth, mean_is};
use scene_core::Rgb;
use scene_core::medium::{HenyeyGreenstein, Medium};

use super::{SUITE, down, moments, slab};

/// A pane of tinted glass: all orders of reflection between its sides,
/// `t = (1 - R)^2 T / (1 - R^2 T^2)` and `r = R + R T t`.
#[test]
fn panes_of_tinted_glass_reflect_between_their_sides() {
    let medium = Medium::new(Rgb::splat(0.1), Rgb::ZERO, 0.0).unwrap();
    let scene = slab(4.0, 1.5, medium);
    let (reflectance, inside) = ((3.0f64 / 5.0).powi(2), (-0.1f64 * 1.5).exp());
    let through = (1.0 - reflectance).powi(2) * inside / (1.0 - (reflectance * inside).powi(2));
    let back = reflectance + reflectance * inside * through;
    for (name, sign, truth) in [("through", -1.0, through), ("back", 1.0, back)] {
        let check = SUITE.check(&format!("tinted pane, {name}"));
        let values = moments(&check, &scene, down(1.0), 20_000, |end| {
            if end.direction.z * sign > 0.0 { end.throughput[0] } else { 0.0 }
        });
        mean_is(check, &values, Truth::relative(truth, 1e-3)).expect_pass();
        let twin = SUITE.twin(&format!("tinted pane, {name}: one order"));
        let one_order = if sign < 0.0 { (1.0 - reflectance).powi(2) * inside } else { reflectance };
        mean_is(twin, &values, one_order).expect_reject();
    }
}

const THICKNESS: f64 = 1.3;
const ALBEDO: f64 = 0.9;

/// The shares of light at normal incidence that a layer of optical thickness `b` and extinction 1 reflects and
/// transmits with exactly one scattering, by midpoints over the cosine `m`:
///
/// ```text
/// r_1 = 2 pi a integral p(-m) (1 - exp(-b (1 + 1/m))) / (1 + 1/m) dm
/// t_1 = 2 pi a integral p(m) (exp(-b) - exp(-b/m)) / (1/m - 1) dm
/// ```
/// (Chandrasekhar 1960, section 30, integrated over the hemisphere.)
fn single_scattering(g: f32) -> [f64; 2] {
    let (n, b) = (20_000, THICKNESS);
    let phase = HenyeyGreenstein::new(g).unwrap();
    let (mut r, mut t) = (0.0, 0.0);
    for k in 0..n {
        let m = (f64::from(k) + 0.5) / f64::from(n);
        let p = |cos: f64| f64::from(phase.eval(cos as f32));
        r += p(-m) * (1.0 - (-b * (1.0 + 1.0 / m)).exp()) / (1.0 + 1.0 / m);
        t += p(m) * ((-b).exp() - (-b / m).exp()) / (1.0 / m - 1.0);
    }
    [r, t].map(|sum| 2.0 * PI * ALBEDO * sum / f64::from(n))
}

#[test]
fn single_scattering_has_its_closed_form() {
    for g in [0.6f32, -0.3] {
        let medium = Medium::from_albedo(Rgb::ONE, Rgb::splat(ALBEDO as f32), g).unwrap();
        let scene = slab(1.0, THICKNESS as f32, medium);
        for (k, (name, sign)) in [("reflected", 1.0), ("transmitted", -1.0)].into_iter().enumerate() {
            let once = |check: &Check| -> Moments {
                moments(check, &scene, down(1.0), 40_000, |end| {
                    if end.scatterings == 1 && end.direction.z * sign > 0.0 { end.throughput[0] } else { 0.0 }
                })
            };
            let check = SUITE.check(&format!("single scattering, {name}, {g}"));
            let values = once(&check);
            mean_is(check, &values, Truth::relative(single_scattering(g)[k], 1e-3)).expect_pass();
            let twin = SUITE.twin(&format!("single scattering, {name}, {g}: sign of g"));
            mean_is(twin, &values, Truth::relative(single_scattering(-g)[k], 1e-3)).expect_reject();
            let twin = SUITE.twin(&format!("single scattering, {name}, {g}: isotropic"));
            mean_is(twin, &values, Truth::relative(single_scattering(0.0)[k], 1e-3)).expect_reject();
        }
    }
}

/// Chandrasekhar's `H` for isotropic scattering, at the midpoints of `n` intervals of the cosine and at 1:
/// `1 / H(m) = sqrt(1 - a) + a/2 integral m' H(m') / (m + m') dm'` (Radiative Transfer, 1960, section 37).
fn h_function(albedo: f64, at: f64) -> f64 {
    let n = 400;
    let nodes: Vec<f64> = (0..n).map(|k| (f64::from(k) + 0.5) / f64::from(n)).collect();
    let next = |h: &[f64], m: f64| {
        let sum: f64 = nodes.iter().zip(h).map(|(x, h)| x * h / (m + x)).sum();
        1.0 / ((1.0 - albedo).sqrt() + 0.5 * albedo * sum / f64::from(n))
    };
    let mut h = vec![1.0; nodes.len()];
    for _ in 0..300 {
        // The mean of two iterates converges in the conservative case, too.
        h = nodes.iter().zip(&h).map(|(&m, old)| 0.5 * (next(&h, m) + old)).collect();
    }
    next(&h, at)
}

#[test]
fn the_h_function_has_its_tabulated_value() {
    // Chandrasekhar's table: without absorption, H(1) = 2.9078.
    assert!((h_function(1.0, 1.0) - 2.9078).abs() < 2e-3, "{}", h_function(1.0, 1.0));
    assert!((h_function(0.0, 0.7) - 1.0).abs() < 1e-12);
}

/// A half-space that scatters isotropically reflects `1 - H(m) sqrt(1 - a)` of the light that arrives at the cosine
/// `m` (Chandrasekhar, section 38).
#[test]
fn half_spaces_reflect_as_chandrasekhar_says() {
    for (albedo, cos) in [(0.5, 1.0f32), (0.9, 0.3), (0.95, 1.0)] {
        let medium = Medium::from_albedo(Rgb::ONE, Rgb::splat(albedo as f32), 0.0).unwrap();
        let scene = slab(1.0, 25.0, medium);
        let truth = 1.0 - h_function(albedo, f64::from(cos)) * (1.0 - albedo).sqrt();
        let check = SUITE.check(&format!("half-space, {albedo} {cos}"));
        let values = moments(&check, &scene, down(cos), 20_000, |end| end.throughput[0]);
        mean_is(check, &values, Truth::relative(truth, 2e-3)).expect_pass();
        let twin = SUITE.twin(&format!("half-space, {albedo} {cos}: one scattering too few"));
        mean_is(twin, &values, Truth::relative(truth / albedo, 2e-3)).expect_reject();
    }
}
