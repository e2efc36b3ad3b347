//! The laws of `PathHeuristic`.

use std::sync::{Mutex, PoisonError};

use mis_heuristics::{Densities, Lazy};
use scene_core::glam::Vec3A;
use vpl_gi::{PathHeuristic, PathTechniques};

use super::random_path::RandomPath;
use super::techniques::{is_possible, path_laws};
use crate::laws::{Law, hold};
use crate::outcome::Outcome;
use crate::seed::{Uniforms, seed};
use crate::verdict::{Undecided, Verdict, Violation};

/// Paths that are tried.
const PATHS: usize = 6000;
/// Segments of the longest.
const SEGMENTS: usize = 6;
/// What a sum of weights may be off by: partitions work in `f32`.
const ROUND_OFF: f64 = 1e-6;

/// Checks the laws of a heuristic of paths (the trait `PathHeuristic` of crate `vpl-gi`).
///
/// ```text
/// (1)  weights are finite
/// (2)  w_i = 0              if technique i cannot generate the path: its density is zero, or it cannot hit, or connect
/// (3)  sum_i w_i = 1
/// (4)  w_i is the same whichever technique generated the path: densities have a common factor that means nothing
/// ```
///
/// Of 6000 paths of up to six segments that some technique can generate: with and without the lens among the techniques, lights
/// that cannot be hit or are at infinity, specular vertices, densities of all sizes, edges as long as a thousandth of a unit to a thousand units (thresholds much beyond these are not looked at). They obey no scattering function and no
/// scene; for those of an estimator see [`CheckedHeuristic`].
///
/// No chance is involved: the paths follow from the name. (3) and (4) hold within 1e-6. A heuristic of densities (`Classical`) is looked at
/// more closely by [`check_heuristic`](crate::check_heuristic).
///
/// ```
/// use estimator_checks::laws::paths::check_path_heuristic;
/// use mis_heuristics::Densities;
/// use vpl_gi::{Classical, PathHeuristic, PathTechniques};
///
/// check_path_heuristic("balance", &Classical(mis_heuristics::Balance)).expect_pass();
///
/// /// The balance heuristic of those who divide by the number of techniques instead of adding densities.
/// struct Equal;
/// impl PathHeuristic for Equal {
///     fn weight(&self, _: usize, path: &impl PathTechniques) -> f64 {
///         1.0 / path.densities().len() as f64
///     }
/// }
/// check_path_heuristic("equal", &Equal).expect_reject();
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_path_heuristic(test: &str, heuristic: &impl PathHeuristic) -> Outcome {
    let mut uniforms = Uniforms::named(test);
    let mut laws = || {
        for index in 0..PATHS {
            let path = RandomPath::new(1 + index % SEGMENTS, &mut uniforms);
            if let Some(technique) = path.possible().next() {
                weight_laws(heuristic, &path.generated_by(technique))?;
            }
        }
        Ok(())
    };
    Outcome::of_laws(test, laws() as Law)
}

/// (1) to (4), for a path that some technique can generate.
fn weight_laws(heuristic: &impl PathHeuristic, path: &impl PathTechniques) -> Law {
    let all = path.densities();
    let densities: Vec<f64> = (0..all.len()).map(|i| all.density(i)).collect();
    let weights: Vec<f64> = (0..densities.len()).map(|i| heuristic.weight(i, path)).collect();
    for (i, weight) in weights.iter().enumerate() {
        let possible = densities[i] > 0.0 && is_possible(path, i);
        let shown = || format!("the weights are {weights:?}, the densities {densities:?}, technique {i}");
        hold("weights of a path are finite", weight.is_finite(), shown)?;
        hold("a technique that cannot generate the path has weight zero", possible || *weight == 0.0, shown)?;
    }
    let (sum, size) = weights.iter().fold((0.0, 1.0_f64), |(sum, size), w| (sum + w, size.max(w.abs())));
    let allowance = ROUND_OFF * size;
    let shown = || format!("the sum is {sum} of {weights:?}, the densities are {densities:?}");
    hold("weights of a path sum to one", (sum - 1.0).abs() <= allowance, shown)?;
    for &density in densities.iter().filter(|&&density| density > 0.0) {
        // A power of two changes no digit, so it moves nothing across a threshold of ratios.
        let factor = (-density.log2().round()).exp2();
        let rescaled = Rescaled { path, factor };
        for (i, &weight) in weights.iter().enumerate() {
            let other = heuristic.weight(i, &rescaled);
            let shown = || format!("technique {i}: {weight}, and {other} with densities {densities:?} times {factor}");
            let same = (other - weight).abs() <= allowance;
            hold("weights do not depend on the technique that generated the path", same, shown)?;
        }
    }
    Ok(())
}

/// A path whose densities are over those of another technique.
struct Rescaled<'a, P> {
    path: &'a P,
    factor: f64,
}

impl<P: PathTechniques> PathTechniques for Rescaled<'_, P> {
    fn segments(&self) -> usize {
        self.path.segments()
    }
    fn densities(&self) -> impl Densities<f64> {
        let densities = self.path.densities();
        Lazy::new(densities.len(), move |i| densities.density(i) * self.factor)
    }
    fn geometry_term(&self, k: usize) -> f32 {
        self.path.geometry_term(k)
    }
    fn position(&self, k: usize) -> Option<Vec3A> {
        self.path.position(k)
    }
    fn direction(&self, k: usize) -> Vec3A {
        self.path.direction(k)
    }
    fn is_specular(&self, k: usize) -> bool {
        self.path.is_specular(k)
    }
    fn can_connect(&self, k: usize) -> bool {
        self.path.can_connect(k)
    }
    fn can_hit(&self) -> bool {
        self.path.can_hit()
    }
    fn distance_squared(&self, k: usize) -> f32 {
        self.path.distance_squared(k)
    }
}

/// A heuristic that checks every path it is asked about, and its own weights of it, on the way: the laws of
/// [`check_path`](super::check_path) and of [`check_path_heuristic`], for the paths of a real estimator in a real scene.
///
/// Put it in the place of the heuristic, render a few pixels, ask for the [`outcome`](Self::outcome); the module's docs have an example.
/// Weights are those of the heuristic in it. It may be shared by threads.
///
/// **Assumes** that the weight of the technique that generated the path is asked for, as estimators do. **Cost.** A few hundred
/// times that of a weight.
#[derive(Debug)]
pub struct CheckedHeuristic<H> {
    heuristic: H,
    seen: Mutex<Seen>,
}

#[derive(Debug, Default)]
struct Seen {
    paths: u64,
    broken: Option<Violation>,
}

impl<H: PathHeuristic> CheckedHeuristic<H> {
    /// Of this heuristic.
    #[must_use]
    pub fn new(heuristic: H) -> Self {
        Self { heuristic, seen: Mutex::default() }
    }

    /// What was found so far: the first law that was broken, if any was. Undecided if there was no path.
    #[must_use = "it decides nothing until it is expected to pass or to reject"]
    pub fn outcome(&self, test: &str) -> Outcome {
        let seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        if seen.paths == 0 {
            let reason = Undecided::TooFew { what: "paths", count: 0, needed: 1 };
            return Outcome::exact(test, seed(test), "laws", 0.0, Verdict::Undecided(reason));
        }
        let result = seen.broken.clone().map_or(Ok(()), Err);
        Outcome::of_laws(test, result).with_detail(format!("{} paths", seen.paths))
    }
}

impl<H: PathHeuristic> PathHeuristic for CheckedHeuristic<H> {
    fn weight(&self, technique: usize, path: &impl PathTechniques) -> f64 {
        let result = path_laws(technique, path).and_then(|()| weight_laws(&self.heuristic, path));
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        seen.paths += 1;
        if let Err(violation) = result {
            seen.broken.get_or_insert(violation);
        }
        drop(seen);
        self.heuristic.weight(technique, path)
    }

    fn weighs_first(&self) -> bool {
        self.heuristic.weighs_first()
    }
}
