//! The laws of the crates' traits, asked of the renderer's own types: one call for each trait, and one for all of `scene-core`.

use estimator_checks::laws::path_space::{check_contribution, check_similarity};
use estimator_checks::laws::paths::check_path_heuristic;
use estimator_checks::laws::photons::{check_deposition, check_flux, check_positive};
use estimator_checks::laws::ranges::check_index;
use estimator_checks::laws::resampling::check_target;
use estimator_checks::laws::sampler::check_sampler;
use estimator_checks::laws::scene::{RendererLaws, SensorLaws, check_emitter_choice};
use estimator_checks::{Check, Hemisphere, Outcome, Report, Sampled, SamplingCheck, Square, SuiteError};
use estimator_checks::{check_heuristic, check_resampling_weights, check_source};
use mis_heuristics::Heuristic;
use path_space_filter::{NormalCone, PathVertex};
use qmc_sampling::OwenSobol;
use range_search::{BuildError, HashGrid};
use vpl_gi::Classical;

use crate::glue::{Seen, ThreeHalves};
use crate::renderer::{Bsdf, Hit, Scene};
use crate::traits::OneLamp;
use crate::vector::V;

/// False-positive rate of each statistical check.
const LEVEL: f64 = 1e-6;

/// Prints the verdicts; whether all laws hold.
pub fn laws(scene: &Scene, vertices: &[Seen<'_>]) -> Result<bool, Box<dyn std::error::Error>> {
    let mut all = true;
    let mut show = |crate_: &str, name: &str, report: Report| {
        let text = if report.passed() { "holds".into() } else { report.to_string() };
        println!("{crate_:<18} {name:<42} {text}");
        all &= report.passed();
    };
    show("mis-heuristics", "own heuristic", check_heuristic("heuristic", &ThreeHalves).into());
    let weights = check_resampling_weights("weights", |i, d: &[f64]| ThreeHalves.weight(i, &d));
    show("ris", "own heuristic as resampling weights", weights.into());
    show("ris", "points of the lamp", lamp(scene)?);
    show("ris", "own target: unshadowed light of the lamp", target(scene, vertices).into());
    for (name, object) in [("diffuse", &scene.objects[6]), ("glossy", &scene.objects[7])] {
        show("estimator-checks", &format!("own {name} BSDF"), bsdf(name, object.bsdf)?);
    }
    show("qmc-sampling", "Owen-Sobol points by seed", check_sampler(Check::new("points", LEVEL)?, OwenSobol::new));

    // The camera is never connected; six colours of surfaces, of the balls and of the lamp among them.
    let renderer = RendererLaws::new().vertices(6).sensor(SensorLaws::new().without_connections());
    show(
        "scene-core",
        "own colours, scene, camera, vertices, lamp",
        renderer.run(Check::new("renderer", LEVEL)?, scene),
    );
    let emitters = scene_core::Scene::emitters(scene);
    let choice = check_emitter_choice(Check::new("choice", LEVEL)?, &OneLamp, None, emitters);
    show("scene-core", "own choice of the lamp", choice);
    let paths = check_path_heuristic("paths", &Classical(ThreeHalves));
    show("vpl-gi", "own heuristic of whole paths", paths.into());

    let colours = [V(1.0, 0.5, 0.0), V(3.0, 2.0, 1e-3), V::splat(f64::INFINITY)];
    let flux = check_flux(&colours, |c| [c.0, c.1, c.2], 1e-12);
    show("photon-map", "own colour as flux", Outcome::of_laws("flux", flux).into());
    let places: Vec<_> = vertices.iter().map(|x| (x.position(), <[f32; 3]>::from(x.0.wo))).collect();
    let near = |x: [f32; 3], _: [f32; 3]| if x[2] < 0.5 { 1.0 } else { 0.25 };
    let both = check_deposition(&near, places.clone()).and_then(|()| check_positive(&near, places.clone()));
    show("photon-map", "own rule of deposition", Outcome::of_laws("deposition", both).into());

    let few = &vertices[..vertices.len().min(200)];
    let contributions: Vec<[f64; 3]> = few.iter().take(20).map(PathVertex::contribution).collect();
    let kept = check_contribution("contributions", &contributions, |c| c, 1e-12);
    show("path-space-filter", "own colours as contributions", kept.into());
    let cone = Outcome::of_laws("cone", check_similarity(&NormalCone::PAPER, few));
    show("path-space-filter", "cone of normals on own vertices", cone.into());
    let same = |a: &Seen<'_>, b: &Seen<'_>| if std::ptr::eq(a.0.object, b.0.object) { 1.0 } else { 0.0 };
    let object = Outcome::of_laws("object", check_similarity(&same, few));
    show("path-space-filter", "own similarity: the same object", object.into());

    show("range-search", "hash grid over own vertices", grid(few)?.into());
    Ok(all)
}

/// The lamp's own parameters are its measure.
fn lamp(scene: &Scene) -> Result<Report, SuiteError> {
    let lamp = scene.lamp();
    let corner = lamp.point(0.0, 0.0).0;
    let [x, y] = [lamp.point(1.0, 0.0).0 - corner, lamp.point(0.0, 1.0).0 - corner];
    let propose = |[u, v, _]: [f64; 3]| {
        let q = lamp.point(u, v).0 - corner;
        Some(([q.dot(x) / x.dot(x), q.dot(y) / y.dot(y)], 1.0))
    };
    Ok(check_source(Check::new("lamp", LEVEL)?, Square, propose, |_| 1.0))
}

/// Light that the lamp's points send to the vertices, shadows left out, is a target for light with shadows.
fn target(scene: &Scene, vertices: &[Seen<'_>]) -> Outcome {
    let lamp = scene.lamp();
    let grid = (0..16).map(|k| [f64::from(k % 4) / 4.0 + 0.1, f64::from(k / 4) / 4.0 + 0.1]);
    let points: Vec<V> = grid.map(|[u, v]| lamp.point(u, v).0).collect();
    let samples: Vec<_> = vertices.iter().take(200).flat_map(|x| points.iter().map(move |y| (&x.0, *y))).collect();
    let unshadowed = |(x, y): &(&Hit<'_>, V)| scene.unshadowed(x, *y).0.mean();
    check_target("target", &samples, unshadowed, |(x, y)| if scene.sees(x, *y) { unshadowed(&(*x, *y)) } else { 0.0 })
}

/// A scattering function in `f64`, called directly.
fn bsdf(name: &str, bsdf: Bsdf) -> Result<Report, SuiteError> {
    let (n, wo) = (V(0.0, 0.0, 1.0), V(0.6, 0.0, 0.8));
    let sample = |u| {
        let (wi, weight, pdf) = bsdf.sample(n, wo, u)?;
        Some(Sampled { point: <[f64; 3]>::from(wi), weight: weight.mean(), pdf })
    };
    let cosine = |wi: [f64; 3]| bsdf.value(n, wo, wi.into()).mean() * wi[2].max(0.0);
    let check = SamplingCheck::on(Hemisphere).samples(100_000);
    Ok(check.run(Check::new(name, LEVEL)?, sample, |wi| bsdf.pdf(n, wo, wi.into()), cosine))
}

fn grid(vertices: &[Seen<'_>]) -> Result<Outcome, BuildError> {
    let points: Vec<[f32; 3]> = vertices.iter().map(PathVertex::position).collect();
    let grid = HashGrid::build(vertices, PathVertex::position, 0.1)?;
    Ok(Outcome::of_laws("grid", check_index(&grid, &points)))
}
