//! Tests of connections for occlusion.

use estimator_checks::laws::paths::check_connection_tests;
use estimator_checks::{Report, Uniforms};
use scene_core::{Ray, Rgb, Spectrum};
use vpl_gi::{ConnectionTests, EveryConnection};

use crate::{SUITE, broken_exactly, rejects};

const VALUES: [Rgb; 5] =
    [Rgb::new(1.0, 0.5, 0.25), Rgb::new(0.0, 3.0, 0.1), Rgb::new(0.2, 0.0, 0.0), Rgb::ZERO, Rgb::new(4.0, 0.7, 5.0)];

/// One ray for all connections of an eye path, chosen by luminance; with room for bugs.
struct OneOfAll {
    bug: Bug,
    uniforms: Uniforms,
    kept: Option<(Rgb, Ray)>,
    sum: f32,
    count: f32,
    eye_paths: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Bug {
    None,
    /// The mean of the connections instead of their sum.
    Mean,
    /// No shadow ray.
    SeesThroughEverything,
    /// The next eye path gets what this one has chosen.
    Keeps,
    /// Every second eye path gets no shadow ray, and nothing for it.
    EverySecond,
    /// Divides by a luminance that may be zero.
    DividesByZero,
    /// The shadow ray starts elsewhere.
    OtherRay,
    /// The shadow ray ends elsewhere.
    LongerRay,
    /// What is brighter than all before it is left out, unless it is the first.
    ForgetsTheBright,
}

impl OneOfAll {
    fn new(bug: Bug) -> Self {
        Self { bug, uniforms: Uniforms::named("one of all"), kept: None, sum: 0.0, count: 0.0, eye_paths: 0 }
    }
}

impl ConnectionTests<Rgb> for OneOfAll {
    fn connect(&mut self, value: Rgb, ray: Ray, _: impl FnOnce(&Ray) -> bool) -> Rgb {
        let score = value.luminance();
        if self.bug == Bug::ForgetsTheBright && score > self.sum && self.sum > 0.0 {
            return Rgb::ZERO;
        }
        self.sum += score;
        self.count += 1.0;
        if self.uniforms.next_f32() * self.sum < score {
            self.kept = Some((value, ray));
        }
        Rgb::ZERO
    }

    fn finish(&mut self, mut is_occluded: impl FnMut(&Ray) -> bool) -> Rgb {
        let (sum, count) = (self.sum, self.count);
        (self.sum, self.count) = (0.0, 0.0);
        self.eye_paths += 1;
        let kept = if self.bug == Bug::Keeps { self.kept } else { self.kept.take() };
        let Some((value, mut ray)) = kept else {
            return if self.bug == Bug::DividesByZero { Rgb::ZERO / sum } else { Rgb::ZERO };
        };
        if self.bug == Bug::EverySecond && self.eye_paths.is_multiple_of(2) {
            return Rgb::ZERO;
        }
        if self.bug == Bug::OtherRay {
            ray.origin += ray.direction;
        }
        if self.bug == Bug::LongerRay {
            ray.max_distance *= 2.0;
        }
        if self.bug != Bug::SeesThroughEverything && is_occluded(&ray) {
            return Rgb::ZERO;
        }
        let all = value * (sum / value.luminance());
        if self.bug == Bug::Mean { all / count } else { all }
    }
}

#[test]
fn tests_of_connections_keep_their_laws() {
    check_connection_tests(SUITE.check("every connection"), &mut EveryConnection, &VALUES).expect_pass();
    let numbers = [1.0_f32, 0.25, 7.0, 1e-3];
    check_connection_tests(SUITE.check("every connection, of numbers"), &mut EveryConnection, &numbers).expect_pass();
    check_connection_tests(SUITE.check("one of all"), &mut OneOfAll::new(Bug::None), &VALUES).expect_pass();
    // Nothing to connect, nothing to decide.
    let nothing = check_connection_tests(SUITE.twin("black"), &mut EveryConnection, &[Rgb::ZERO]);
    assert!(!nothing.passed() && !nothing.rejected(), "{nothing}");
}

fn one_of_all(bug: Bug) -> Report {
    check_connection_tests(SUITE.twin(&format!("connections: {bug:?}")), &mut OneOfAll::new(bug), &VALUES)
}

#[test]
fn tests_of_connections_that_lie_are_rejected() {
    rejects(one_of_all(Bug::Mean), "all are seen: component 0");
    rejects(one_of_all(Bug::SeesThroughEverything), "half are occluded: component 1");
    rejects(one_of_all(Bug::EverySecond), "one connection: component 0");
    rejects(one_of_all(Bug::ForgetsTheBright), "all are seen: component 2");
    assert_eq!(broken_exactly(one_of_all(Bug::Keeps)), "finish leaves nothing behind");
    assert_eq!(broken_exactly(one_of_all(Bug::DividesByZero)), "finish leaves nothing behind");
    for bug in [Bug::OtherRay, Bug::LongerRay] {
        assert_eq!(broken_exactly(one_of_all(bug)), "only rays of the eye path's own connections are asked for");
    }
}

/// Says that it tests all.
struct TestsAll(fn(Rgb, bool) -> Rgb, bool);

impl ConnectionTests<Rgb> for TestsAll {
    const TESTS_ALL: bool = true;
    fn connect(&mut self, value: Rgb, ray: Ray, is_occluded: impl FnOnce(&Ray) -> bool) -> Rgb {
        let occluded = self.1 && is_occluded(&ray);
        (self.0)(value, occluded)
    }
    fn finish(&mut self, _: impl FnMut(&Ray) -> bool) -> Rgb {
        Rgb::ZERO
    }
}

#[test]
fn who_says_to_test_all_does() {
    let run = |name: &str, mut tests: TestsAll| {
        check_connection_tests(SUITE.twin(&format!("tests all: {name}")), &mut tests, &VALUES)
    };
    let seen = |value, occluded| if occluded { Rgb::ZERO } else { value };
    run("honest", TestsAll(seen, true)).expect_pass();
    let asks = "who tests all asks for the ray of each connection";
    assert_eq!(broken_exactly(run("asks for nothing", TestsAll(seen, false))), asks);
    let adds = "who tests all adds what is seen at once";
    assert_eq!(broken_exactly(run("sees through everything", TestsAll(|value, _| value, true))), adds);
    let half = |value, occluded| if occluded { Rgb::ZERO } else { value * 0.5 };
    assert_eq!(broken_exactly(run("half", TestsAll(half, true))), adds);
    // What is not finite.
    let nan = |value: Rgb, _| value * f32::NAN;
    assert_eq!(broken_exactly(run("NaN", TestsAll(nan, true))), adds);
}

/// Not finite, and does not say to test all.
struct NotFinite;

impl ConnectionTests<Rgb> for NotFinite {
    fn connect(&mut self, value: Rgb, ray: Ray, is_occluded: impl FnOnce(&Ray) -> bool) -> Rgb {
        if is_occluded(&ray) { value * f32::INFINITY } else { value }
    }
    fn finish(&mut self, _: impl FnMut(&Ray) -> bool) -> Rgb {
        Rgb::ZERO
    }
}

#[test]
fn what_is_added_is_finite() {
    let report = check_connection_tests(SUITE.twin("not finite"), &mut NotFinite, &VALUES);
    assert_eq!(broken_exactly(report), "what is added is finite");
}
