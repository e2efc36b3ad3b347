//! Expectations of density estimates.

use estimator_checks::{Moments, Truth, Uniforms, mean_is};
use photon_map::{
    DensityEstimation, Flux, Gather, GatherPoint, Kernel, Photon, PhotonMap, Photons, ProgressivePoint,
    ProgressiveRadius, Scratch,
};

use crate::SUITE;

const CENTRE: [f32; 3] = [0.5, 0.5, 0.0];
const UP: [f32; 3] = [0.0, 0.0, 1.0];

/// `n` independent photons on the unit square; `flux` of a place, one watt on average for an irradiance of one.
pub(crate) fn square(uniforms: &mut Uniforms, n: u32, flux: impl Fn([f64; 2]) -> f64) -> Photons<f64> {
    let mut photons = Photons::new();
    for _ in 0..n {
        let place: [f64; 2] = uniforms.array();
        photons.store(Photon::new([place[0] as f32, place[1] as f32, 0.0], UP, flux(place)));
    }
    photons.add_paths(u64::from(n));
    photons
}

#[test]
fn nearest_photons_are_unbiased_on_a_uniform_sheet() {
    const K: usize = 10;
    for (name, kernel) in
        [("constant", Kernel::Constant), ("cone", Kernel::CONE), ("Epanechnikov", Kernel::Epanechnikov)]
    {
        // With a radius that is hardly ever reached, and with one that often ends the search before the tenth photon.
        for (reach, max_radius) in [("far", 0.5), ("near", 0.09)] {
            let check = SUITE.check(&format!("{K} nearest photons, {name}, {reach}"));
            let mut uniforms = check.uniforms();
            let estimation = DensityEstimation { gather: Gather::nearest(K, max_radius).unwrap(), kernel };
            let mut scratch = Scratch::default();
            let mut estimates = Moments::new();
            for _ in 0..10_000 {
                let map = PhotonMap::build(square(&mut uniforms, 400, |_| 1.0), 0.1).unwrap();
                estimates.push(map.irradiance(&estimation, &GatherPoint::on(CENTRE, UP), &mut scratch).value);
            }
            // Planted bug: the tenth photon counts as well.
            let jensen = estimates.scaled(K as f64 / (K as f64 - 1.0));
            mean_is(check, &estimates, 1.0).expect_pass();
            mean_is(SUITE.twin("the radius' photon counts"), &jensen, 1.0).expect_reject();
        }
    }
}

/// What must be uniform is irradiance, not the density of photons: those that deposition left are dense on one side,
/// with less flux.
#[test]
fn nearest_photons_of_unequal_density_are_unbiased_for_uniform_irradiance() {
    let check = SUITE.check("nearest photons of unequal density");
    let mut uniforms = check.uniforms();
    let estimation = DensityEstimation { gather: Gather::nearest(12, 0.2).unwrap(), kernel: Kernel::Epanechnikov };
    let (mut estimates, mut equal) = (Moments::new(), Moments::new());
    for _ in 0..20_000 {
        let (mut photons, mut forgotten) = (Photons::new(), Photons::new());
        for _ in 0..2000 {
            let [x, y, u] = uniforms.array();
            let p = if x < 0.5 { 0.5 } else { 0.03 };
            let photon = Photon::new([x as f32, y as f32, 0.0], UP, 1.0_f64);
            if u < p {
                photons.store(photon.scaled(1.0 / p));
                forgotten.store(photon);
            }
        }
        let irradiance = |mut photons: Photons<f64>, moments: &mut Moments| {
            photons.add_paths(2000);
            let map = PhotonMap::build(photons, 0.1).unwrap();
            // Near the step.
            let at = GatherPoint::on([0.51, 0.5, 0.0], UP);
            moments.push(map.irradiance(&estimation, &at, &mut Scratch::default()).value);
        };
        irradiance(photons, &mut estimates);
        irradiance(forgotten, &mut equal);
    }
    mean_is(check, &estimates, 1.0).expect_pass();
    mean_is(SUITE.twin("nearest, 1/p forgotten"), &equal, 1.0).expect_reject();
}

/// Photons of the other side take part in finding the radius, and are then left out.
#[test]
fn photons_of_the_other_side_do_not_disturb_nearest_photons() {
    let check = SUITE.check("nearest photons of two sides");
    let mut uniforms = check.uniforms();
    let estimation = DensityEstimation { gather: Gather::nearest(12, 0.5).unwrap(), kernel: Kernel::Epanechnikov };
    let (mut estimates, mut untested) = (Moments::new(), Moments::new());
    for _ in 0..10_000 {
        let mut photons = Photons::new();
        for _ in 0..400 {
            let [x, y, side] = uniforms.array::<3>().map(|u| u as f32);
            photons.store(Photon::new([x, y, 0.0], if side < 0.3 { UP } else { UP.map(|c| -c) }, 1.0_f64));
        }
        photons.add_paths(400);
        let map = PhotonMap::build(photons, 0.1).unwrap();
        let irradiance = |at| map.irradiance(&estimation, &at, &mut Scratch::default()).value;
        estimates.push(irradiance(GatherPoint::on(CENTRE, UP)));
        untested.push(irradiance(GatherPoint::at(CENTRE)));
    }
    mean_is(check, &estimates, 0.3).expect_pass();
    mean_is(SUITE.twin("no normal test"), &untested, 0.3).expect_reject();
}

/// With irradiance `1 + 8 rho^2` around the centre the Laplacian is 32, and the bias `1/2 mu_2 r^2 32` is exact.
#[test]
fn progressive_radii_have_the_bias_that_the_kernel_predicts() {
    const ITERATIONS: u32 = 32;
    let bias = |kernel: Kernel, mean_radius_squared: f64| 0.5 * kernel.second_moment() * mean_radius_squared * 32.0;
    let paraboloid = |[x, y]: [f64; 2]| 1.0 + 8.0 * ((x - 0.5).powi(2) + (y - 0.5).powi(2));
    for (name, kernel) in
        [("constant", Kernel::Constant), ("cone", Kernel::CONE), ("Epanechnikov", Kernel::Epanechnikov)]
    {
        let check = SUITE.check(&format!("progressive radius, {name}"));
        let mut uniforms = check.uniforms();
        let (mut estimates, mut fixed) = (Moments::new(), Moments::new());
        let mut mean_radius_squared = 0.0;
        for _ in 0..1000 {
            let mut radius = ProgressiveRadius::new(0.4, 2.0 / 3.0).unwrap();
            let (mut sum, mut sum_fixed) = (0.0, 0.0);
            mean_radius_squared = 0.0;
            for _ in 0..ITERATIONS {
                let map = PhotonMap::build(square(&mut uniforms, 60, paraboloid), 0.4).unwrap();
                let estimate = |radius| {
                    let estimation = DensityEstimation { gather: Gather::within(radius).unwrap(), kernel };
                    map.irradiance(&estimation, &GatherPoint::on(CENTRE, UP), &mut Scratch::default()).value
                };
                sum += estimate(radius.radius());
                sum_fixed += estimate(0.4);
                mean_radius_squared += radius.radius_squared() / f64::from(ITERATIONS);
                radius.advance();
            }
            estimates.push(sum / f64::from(ITERATIONS));
            fixed.push(sum_fixed / f64::from(ITERATIONS));
        }
        // Radii are rounded to f32.
        let truth = Truth::relative(1.0 + bias(kernel, mean_radius_squared), 1e-6);
        mean_is(check, &estimates, truth).expect_pass();
        mean_is(SUITE.twin("the radius does not shrink"), &fixed, truth).expect_reject();
    }
}

#[test]
fn progressive_points_converge() {
    let check = SUITE.check("progressive points");
    let mut uniforms = check.uniforms();
    let paraboloid = |[x, y]: [f64; 2]| 1.0 + 8.0 * ((x - 0.5).powi(2) + (y - 0.5).powi(2));
    let (mut shrinking, mut fixed) = (Moments::new(), Moments::new());
    let at = GatherPoint::on(CENTRE, UP);
    for _ in 0..60 {
        let mut point = ProgressivePoint::new(0.4, 0.5).unwrap();
        let (mut paths, mut sum) = (0, 0.0);
        for _ in 0..800 {
            let map = PhotonMap::build(square(&mut uniforms, 100, paraboloid), 0.2).unwrap();
            let (found, flux) = map.collect(point.radius(), &at, |photon| photon.flux());
            point.add(found, flux);
            sum = sum.add(map.collect(0.4, &at, |photon| photon.flux()).1);
            paths += map.paths();
        }
        assert!(point.radius() < 0.11, "{}", point.radius());
        shrinking.push(point.radiance(paths));
        fixed.push(sum / (std::f64::consts::PI * 0.16 * paths as f64));
    }
    // What is left of the bias is that of the last radii: they fell to a quarter.
    let truth = Truth { value: 1.0, error: 0.1 };
    mean_is(check, &shrinking, truth).expect_pass();
    mean_is(SUITE.twin("a radius that does not shrink"), &fixed, truth).expect_reject();
}
