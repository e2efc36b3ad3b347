//! The laws of `ConnectionTests`.

use std::cell::Cell;

use scene_core::glam::Vec3A;
use scene_core::{Ray, Spectrum};
use vpl_gi::ConnectionTests;

use crate::laws::{Law, hold};
use crate::mean::{Truth, mean_is};
use crate::moments::Moments;
use crate::outcome::{Outcome, Report};
use crate::suite::Check;
use crate::verdict::{Undecided, Verdict};

/// Eye paths for each set of connections.
const EYE_PATHS: u32 = 20_000;
/// After so many of them, one without any connection.
const PERIOD: u32 = 8;
/// Of sums in `f32`.
const ROUND_OFF: f64 = 1e-5;

/// Checks the laws of what decides which connections get a shadow ray (the trait `ConnectionTests` of crate `vpl-gi`).
///
/// ```text
/// (1)  what is returned is finite; only rays of the eye path's own connections are asked for
/// (2)  finish leaves nothing behind: an eye path without connections returns zero and asks for no ray
/// (3)  if TESTS_ALL, connect asks for its ray, and returns the value, or zero if it is occluded; finish returns zero
/// (4)  E[all that connect and finish return] = sum of the values that are not occluded      t-test, each component
/// ```
///
/// Values are those of `values`, which are finite and not negative, and had better differ in size and in colour. Eye paths
/// have one of these connections, all of them, or all of them twice with every second one occluded, 20 000 eye paths each, with an
/// empty one after every eighth. They share `tests`, which brings its own random numbers: the law is
/// of their expectation, so numbers have to be independent from one eye path to the next. The t-test takes means of 20 000 for normally
/// distributed: a value of less than a hundredth of the others' luminance, chosen in proportion to it, would be too rare for that.
///
/// (1) to (3) are exact. The report has one outcome for them, and one for each set of connections and component: these share the level of the check.
/// Undecided if there is no value that is not black.
///
/// ```
/// use estimator_checks::{Check, laws::paths::check_connection_tests};
/// use scene_core::Rgb;
/// use vpl_gi::EveryConnection;
///
/// let values = [Rgb::new(1.0, 0.5, 0.1), Rgb::new(0.0, 0.2, 4.0), Rgb::ZERO];
/// check_connection_tests(Check::new("every connection", 1e-6)?, &mut EveryConnection, &values).expect_pass();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_connection_tests<P: Spectrum, T: ConnectionTests<P>>(check: Check, tests: &mut T, values: &[P]) -> Report {
    let Some(&seen) = values.iter().find(|value| !value.is_black()) else {
        let reason = Undecided::TooFew { what: "values that are not black", count: 0, needed: 1 };
        return Outcome::exact(check.test(), check.seed(), "laws", 0.0, Verdict::Undecided(reason)).into();
    };
    let all: Vec<(P, bool)> = values.iter().map(|&value| (value, false)).collect();
    let half = values.iter().chain(values).enumerate().map(|(i, &value)| (value, i % 2 == 1)).collect();
    let sets: [(&str, Vec<(P, bool)>); 3] =
        [("one connection", vec![(seen, false)]), ("all are seen", all), ("half are occluded", half)];

    let mut moments = vec![Moments::new(); sets.len() * P::COMPONENTS];
    let mut laws = || {
        for ((name, connections), moments) in sets.iter().zip(moments.chunks_mut(P::COMPONENTS)) {
            for number in 0..EYE_PATHS {
                let sum = eye_path(tests, name, number, connections)?;
                moments.iter_mut().zip(sum).for_each(|(moments, x)| moments.push(x));
                if number % PERIOD == 0 {
                    eye_path(tests, "nothing after them", number, &[])?;
                }
            }
        }
        Ok(())
    };
    let mut report = Report::from(Outcome::of_laws(check.test(), laws() as Law));
    if report.passed() {
        let parts = sets.iter().flat_map(|(name, _)| (0..P::COMPONENTS).map(move |c| format!("{name}: component {c}")));
        let checks = check.parts(parts.collect::<Vec<_>>().into_iter());
        for (i, (check, moments)) in checks.into_iter().zip(&moments).enumerate() {
            let connections = &sets[i / P::COMPONENTS].1;
            let seen = connections.iter().filter(|(_, occluded)| !occluded);
            let truth = seen.map(|(value, _)| f64::from(value.component(i % P::COMPONENTS))).sum();
            report.outcomes.push(mean_is(check, moments, Truth::relative(truth, ROUND_OFF)));
        }
    }
    report
}

/// All that one eye path returns, component by component. Rays say by their origin whose they are.
fn eye_path<P: Spectrum, T: ConnectionTests<P>>(
    tests: &mut T,
    name: &str,
    number: u32,
    connections: &[(P, bool)],
) -> Result<Vec<f64>, crate::Violation> {
    // No two are of the same length.
    let of = |i: usize| {
        let origin = Vec3A::new(i as f32, number as f32, connections.len() as f32);
        Ray::new(origin, Vec3A::Z).up_to(1.0 + i as f32)
    };
    let same = |a: &Ray, b: &Ray| (a.origin, a.direction, a.max_distance) == (b.origin, b.direction, b.max_distance);
    let (asked, asked_for) = (Cell::new(0_usize), Cell::new(None));
    let stranger = Cell::new(None);
    let is_occluded = |ray: &Ray| {
        asked.set(asked.get() + 1);
        let index = ray.origin.x as usize;
        let own = connections.get(index).filter(|_| same(ray, &of(index)));
        match own {
            Some(_) => asked_for.set(Some(index)),
            None => stranger.set(Some(*ray)),
        }
        own.is_some_and(|(_, occluded)| *occluded)
    };
    let mut sum = vec![0.0; P::COMPONENTS];
    let mut add = |part: P| sum.iter_mut().enumerate().for_each(|(c, sum)| *sum += f64::from(part.component(c)));
    for (i, &(value, occluded)) in connections.iter().enumerate() {
        let before = asked.get();
        let added = tests.connect(value, of(i), is_occluded);
        if T::TESTS_ALL {
            let shown = || format!("{added:?} of {value:?}, occluded: {occluded}");
            let expected = if occluded { P::ZERO } else { value };
            let its_own = asked.get() == before + 1 && asked_for.get() == Some(i);
            hold("who tests all asks for the ray of each connection", its_own, shown)?;
            hold("who tests all adds what is seen at once", added == expected, shown)?;
        }
        add(added);
    }
    let before = asked.get();
    let put_off = tests.finish(is_occluded);
    let shown = || format!("finish returned {put_off:?} and asked for {} rays", asked.get() - before);
    if connections.is_empty() {
        let nothing = put_off == P::ZERO && asked.get() == before;
        hold("finish leaves nothing behind", nothing, shown)?;
    }
    if T::TESTS_ALL {
        hold("who tests all puts off nothing", put_off == P::ZERO, shown)?;
    }
    add(put_off);
    let shown = || format!("{:?} was, among {name}, {} connections", stranger.get(), connections.len());
    hold("only rays of the eye path's own connections are asked for", stranger.get().is_none(), shown)?;
    hold("what is added is finite", sum.iter().all(|x| x.is_finite()), || format!("{sum:?} for {name}"))?;
    Ok(sum)
}
