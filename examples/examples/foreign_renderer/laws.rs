//! The laws of the crates' traits, asked of the renderer's own types: one call each.

use std::fmt::{Debug, Display};

use estimator_checks::{Check, Hemisphere, Sampled, SamplingCheck, Square, SuiteError};
use estimator_checks::{check_heuristic, check_resampling_weights, check_source};
use mis_heuristics::Heuristic;
use path_space_filter::{NormalCone, PathVertex, check_similarity};
use photon_map::check::{check_deposition, check_flux, check_positive};
use range_search::{HashGrid, check::check_index};
use scene_core::glam::Vec3A;
use scene_core::{TransportMode, Vertex as _};

use crate::glue::{Seen, ThreeHalves};
use crate::renderer::{Bsdf, Hit, Object, Scene};
use crate::traits::Vertex;
use crate::vector::V;

/// False-positive rate of each statistical check.
const LEVEL: f64 = 1e-6;

fn verdict<E: Debug>(result: Result<(), E>) -> (bool, String) {
    (result.is_ok(), result.map_or_else(|law| format!("broken: {law:?}"), |()| "holds".into()))
}

/// Prints the verdicts; whether all laws hold.
pub fn laws(scene: &Scene, vertices: &[Seen<'_>]) -> Result<bool, SuiteError> {
    let mut all = true;
    let mut show = |crate_: &str, name: &str, (passed, text): (bool, String)| {
        println!("{crate_:<18} {name:<42} {text}");
        all &= passed;
    };
    let said = |passed: bool, text: &dyn Display| (passed, if passed { "holds".into() } else { text.to_string() });

    let outcome = check_heuristic("own heuristic", &ThreeHalves);
    show("mis-heuristics", "own heuristic", said(outcome.passed(), &outcome));
    let outcome = check_resampling_weights("own weights", |i, d: &[f64]| ThreeHalves.weight(i, &d));
    show("ris", "own heuristic as resampling weights", said(outcome.passed(), &outcome));

    // The lamp's own parameters are its measure.
    let lamp = scene.lamp();
    let corner = lamp.point(0.0, 0.0).0;
    let [x, y] = [lamp.point(1.0, 0.0).0 - corner, lamp.point(0.0, 1.0).0 - corner];
    let propose = |[u, v, _]: [f64; 3]| {
        let q = lamp.point(u, v).0 - corner;
        Some(([q.dot(x) / x.dot(x), q.dot(y) / y.dot(y)], 1.0))
    };
    let report = check_source(Check::new("lamp", LEVEL)?, Square, propose, |_| 1.0);
    show("ris", "points of the lamp", said(report.passed(), &report));

    let (n, wo) = (V(0.0, 0.0, 1.0), V(0.6, 0.0, 0.8));
    for (name, object) in [("diffuse", &scene.objects[6]), ("glossy", &scene.objects[7])] {
        let bsdf: Bsdf = object.bsdf;
        let sample = |u| {
            let (wi, weight, pdf) = bsdf.sample(n, wo, u)?;
            Some(Sampled { point: <[f64; 3]>::from(wi), weight: weight.mean(), pdf })
        };
        let cosine = |wi: [f64; 3]| bsdf.value(n, wo, wi.into()).mean() * wi[2].max(0.0);
        let check = SamplingCheck::on(Hemisphere).samples(100_000);
        let report = check.run(Check::new(name, LEVEL)?, sample, |wi| bsdf.pdf(n, wo, wi.into()), cosine);
        show("estimator-checks", &format!("own {name} BSDF"), said(report.passed(), &report));
    }

    // Not the diffuse one: its weights do not vary at all, so that round-off of `f32` directions counts as a deviation.
    let glossy = vertex_laws(&scene.objects[7], n, wo)?;
    show("scene-core", "vertex of the glossy BSDF, in f32", glossy);

    let colours = [V(1.0, 0.5, 0.0), V(3.0, 2.0, 1e-3), V::splat(f64::INFINITY)];
    show("photon-map", "own colour as flux", verdict(check_flux(&colours, |c| [c.0, c.1, c.2], 1e-12)));
    let places: Vec<_> = vertices.iter().map(|x| (x.position(), <[f32; 3]>::from(x.0.wo))).collect();
    let near = |x: [f32; 3], _: [f32; 3]| if x[2] < 0.5 { 1.0 } else { 0.25 };
    let both = check_deposition(&near, places.clone()).and_then(|()| check_positive(&near, places.clone()));
    show("photon-map", "own rule of deposition", verdict(both));

    let few = &vertices[..vertices.len().min(200)];
    show("path-space-filter", "cone of normals on own vertices", verdict(check_similarity(&NormalCone::PAPER, few)));
    let same = |a: &Seen<'_>, b: &Seen<'_>| if std::ptr::eq(a.0.object, b.0.object) { 1.0 } else { 0.0 };
    show("path-space-filter", "own similarity: the same object", verdict(check_similarity(&same, few)));

    let points: Vec<[f32; 3]> = few.iter().map(PathVertex::position).collect();
    let checked = HashGrid::build(few, PathVertex::position, 0.1).map_err(|error| format!("{error:?}"));
    let checked = checked.and_then(|grid| check_index(&grid, &points).map_err(|law| format!("{law:?}")));
    show("range-search", "hash grid over own vertices", verdict(checked));
    Ok(all)
}

/// The laws that tie `eval`, `pdf_solid_angle` and `sample` together, through the trait and in its `f32`.
fn vertex_laws(object: &Object, n: V, wo: V) -> Result<(bool, String), SuiteError> {
    let vertex = Vertex::from(Hit { object, p: V::default(), n, wo, is_front: true });
    let mode = TransportMode::Radiance;
    let sample = |u: [f64; 3]| {
        let sample = vertex.sample(u.map(|u| (u as f32).min(1.0 - f32::EPSILON)), mode)?;
        let (point, pdf) = (sample.wi.to_array(), f64::from(sample.pdf_solid_angle));
        Some(Sampled { point, weight: sample.throughput.mean(), pdf })
    };
    let direction = |wi: [f64; 3]| Vec3A::from(V::from(wi));
    let report = SamplingCheck::on(Hemisphere).samples(100_000).outliers(1e-3).run(
        Check::new("glossy vertex", LEVEL)?,
        sample,
        |wi| vertex.pdf_solid_angle(direction(wi), mode).into(),
        |wi| vertex.eval(direction(wi), mode).mean(),
    );
    let passed = report.passed();
    Ok((passed, if passed { "holds".into() } else { report.to_string() }))
}
