//! Bugs that bidirectional path tracers have had.

use mis_heuristics::Densities;
use scene_core::glam::Vec3A;
use vpl_gi::{PathHeuristic, PathTechniques};

/// Forgets to divide by the number `M` of light paths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NotDivided<H>(pub(crate) H, pub(crate) f64);

impl<H: PathHeuristic> PathHeuristic for NotDivided<H> {
    fn weight(&self, technique: usize, path: &impl PathTechniques) -> f64 {
        let forgotten = if (1..path.segments()).contains(&technique) { self.1 } else { 1.0 };
        forgotten * self.0.weight(technique, path)
    }
}

/// Believes that specular vertices can be connected, although nothing comes of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ConnectsSpecular<H>(pub(crate) H);

impl<H: PathHeuristic> PathHeuristic for ConnectsSpecular<H> {
    fn weight(&self, technique: usize, path: &impl PathTechniques) -> f64 {
        self.0.weight(technique, &Connectible(path))
    }
}

struct Connectible<'a, P>(&'a P);

impl<P: PathTechniques> PathTechniques for Connectible<'_, P> {
    fn segments(&self) -> usize {
        self.0.segments()
    }
    fn densities(&self) -> impl Densities<f64> {
        self.0.densities()
    }
    fn geometry_term(&self, k: usize) -> f32 {
        self.0.geometry_term(k)
    }
    fn position(&self, k: usize) -> Option<Vec3A> {
        self.0.position(k)
    }
    fn direction(&self, k: usize) -> Vec3A {
        self.0.direction(k)
    }
    fn is_specular(&self, _: usize) -> bool {
        false
    }
    fn can_connect(&self, _: usize) -> bool {
        true
    }
    fn can_hit(&self) -> bool {
        self.0.can_hit()
    }
}
