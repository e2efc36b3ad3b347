//! Domains, choices by weight, uniform numbers: what needs no feature.

use estimator_checks::laws::domain::check_domain;
use estimator_checks::laws::resampling::{check_selection, check_uniform};
use estimator_checks::{Disk, Domain, Hemisphere, Interval, Sphere, Square, Uniforms};

use crate::{SUITE, broken, broken_exactly, rejects};

#[test]
fn domains_keep_their_laws() {
    check_domain("sphere", &Sphere, |w| w, [[0.0; 3], [1.0, 1.0, 0.0], [f64::NAN; 3]]).expect_pass();
    check_domain("hemisphere", &Hemisphere, |w| w, [[0.0, 0.0, -1.0], [0.0; 3]]).expect_pass();
    check_domain("disk", &Disk, |x| x, [[1.0, 0.5], [f64::INFINITY, 0.0]]).expect_pass();
    check_domain("square", &Square, |x| x, [[1.5, 0.5], [0.5, -1.0]]).expect_pass();
    check_domain("interval", &Interval::new(1.0, 3.0).unwrap(), |x| [x], [0.0, 4.0, f64::NAN]).expect_pass();
}

/// The disk, as a map of one's own.
struct Map {
    measure: f64,
    radius: fn(f64) -> f64,
    inverse: fn(f64) -> f64,
    accepts: fn([f64; 2]) -> bool,
}

impl Domain for Map {
    type Point = [f64; 2];
    const DIMENSIONS: usize = 2;
    fn measure(&self) -> f64 {
        self.measure
    }
    fn point(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = (std::f64::consts::TAU * v).sin_cos();
        [cos, sin].map(|x| (self.radius)(u) * x)
    }
    fn parameters(&self, x: [f64; 2]) -> Option<[f64; 2]> {
        (self.accepts)(x).then(|| {
            let turn = x[1].atan2(x[0]) / std::f64::consts::TAU;
            [(self.inverse)(x[0].hypot(x[1])), turn.rem_euclid(1.0)]
        })
    }
}

const DISK: Map =
    Map { measure: std::f64::consts::PI, radius: f64::sqrt, inverse: |r| r * r, accepts: |x| x[0].hypot(x[1]) < 1.0 };

#[test]
fn domains_that_lie_are_rejected() {
    let run = |map: &Map| check_domain("map", map, |x| x, [[2.0, 0.0]]);
    run(&DISK).expect_pass();
    assert_eq!(broken(run(&Map { measure: f64::NAN, ..DISK })), "the measure is positive and finite");
    assert_eq!(broken(run(&Map { measure: 3.0, ..DISK })), "point preserves area");
    // The classic: the radius is uniform, and its square is not.
    assert_eq!(broken(run(&Map { radius: |u| u, inverse: |r| r, ..DISK })), "point preserves area");
    assert_eq!(broken(run(&Map { inverse: |r| r, ..DISK })), "parameters inverts point");
    assert_eq!(broken(run(&Map { radius: |u| (u - 0.5).sqrt(), ..DISK })), "points are finite");
    assert_eq!(broken(run(&Map { accepts: |_| true, ..DISK })), "what is no point has no parameters");
}

#[test]
fn selections() {
    let weights = [1.0, 0.0, 3.0];
    let good = |u: f64| Some(if u < 0.25 { 0 } else { 2 });
    check_selection(SUITE.check("selection"), &weights, good).expect_pass();
    check_selection(SUITE.twin("selection: no weights"), &[0.0; 3], |_| None).expect_pass();
    let run = |name: &str, select: &dyn Fn(f64) -> Option<usize>| {
        check_selection(SUITE.twin(&format!("selection: {name}")), &weights, select)
    };
    let positive = "what is chosen has a positive weight";
    assert_eq!(broken_exactly(run("zero", &|u| Some(if u == 0.0 { 1 } else { 2 }))), positive);
    assert_eq!(broken_exactly(run("beyond", &|u| Some(if u > 0.999_99 { 3 } else { 2 }))), positive);
    let something = "something is chosen unless all weights are zero";
    assert_eq!(broken_exactly(run("nothing", &|u| (u > 0.0).then_some(2))), something);
    rejects(run("uneven", &|u| Some(if u < 0.26 { 0 } else { 2 })), "");
}

#[test]
fn streams_of_numbers() {
    let mut uniforms = Uniforms::named("stream");
    check_uniform(SUITE.check("uniform"), || uniforms.next_f64()).expect_pass();
    let twin = |name: &str| SUITE.twin(&format!("uniform: {name}"));
    let one = check_uniform(twin("one"), || (uniforms.next_f64() * 1e4).ceil() / 1e4);
    assert_eq!(broken_exactly(one), "numbers lie in [0, 1)");
    rejects(check_uniform(twin("bent"), || uniforms.next_f64().powf(1.05)), "uniform");
    let mut last = 0.0;
    let smooth = check_uniform(twin("neighbours"), || {
        last = if uniforms.next_f64() < 0.1 { last } else { uniforms.next_f64() };
        last
    });
    rejects(smooth, "neighbours");
}
