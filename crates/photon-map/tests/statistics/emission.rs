//! Projection maps and guidance: where photons are sent.

use std::f64::consts::PI;

use estimator_checks::{Moments, Sampled, SamplingCheck, Sphere, Uniforms, chi_square_counts, mean_is};
use photon_map::{
    Bound, DepositionExt, DirectionalHistogram, GatherPoint, Guide, ImportanceScale, ImportonDeposition, LightTable,
    Photon, ProjectionMap, Scratch, sphere_direction,
};

use crate::{SUITE, deposition::importance};

const AXIS: [f32; 3] = [0.6, 0.0, 0.8];

fn cosine(direction: [f32; 3]) -> f64 {
    direction.iter().zip(AXIS).map(|(&a, b)| f64::from(a) * f64::from(b)).sum()
}

/// A glass sphere takes the light of a cone; its flux is that of the cone's solid angle, times what passes.
#[test]
fn a_projection_map_brings_the_flux_of_direct_caustics() {
    let half_angle = 0.35_f64;
    let caustic = |direction: [f32; 3]| if cosine(direction) > half_angle.cos() { cosine(direction) } else { 0.0 };
    // 10 W into all directions: 10 / 4 pi W/sr times 2 pi times the integral of the cosine.
    let truth = 10.0 / 2.0 * 0.5 * half_angle.sin().powi(2);
    let check = SUITE.check("projection map");
    let mut uniforms = check.uniforms();
    let projection = ProjectionMap::for_cones(32, 16, &[(AXIS, half_angle as f32)]).unwrap();
    assert!(projection.share() < 0.15, "{}", projection.share());
    let value = |u: [f64; 2], share: f64| 10.0 * share * caustic(sphere_direction(u));
    let numbers: Vec<[f64; 2]> = (0..200_000).map(|_| uniforms.array()).collect();
    let everywhere: Moments = numbers.iter().map(|&u| value(u, 1.0)).collect();
    let restricted =
        |share: f64| -> Moments { numbers.iter().map(|&u| value(projection.sample(u).unwrap(), share)).collect() };
    let found = restricted(projection.share());
    assert!(found.variance() < 0.2 * everywhere.variance());
    mean_is(check, &found, truth).expect_pass();
    mean_is(SUITE.twin("the share is forgotten"), &restricted(1.0), truth).expect_reject();
    // A generator that is not marked in full.
    let narrow = ProjectionMap::for_cones(64, 64, &[(AXIS, 0.1)]).unwrap();
    let lost: Moments = numbers.iter().map(|&u| value(narrow.sample(u).unwrap(), narrow.share())).collect();
    mean_is(SUITE.twin("marks are too narrow"), &lost, truth).expect_reject();
}

fn histogram() -> DirectionalHistogram {
    let mut histogram = DirectionalHistogram::new(8, 4).unwrap();
    let mut uniforms = Uniforms::named("importance of directions");
    while histogram.is_empty() || uniforms.next_f64() > 0.005 {
        let direction = sphere_direction(uniforms.array());
        if cosine(direction) > 0.5 {
            histogram.add(direction, uniforms.next_f32());
        }
    }
    histogram
}

/// Laws of sampling: the mixture reports its density, and is distributed by it. The function is a lobe, part of it
/// unguided.
#[test]
fn guided_directions_are_distributed_by_the_density_that_they_report() {
    let check = SUITE.check("guided directions");
    let (histogram, guide) = (histogram(), Guide::new(0.6).unwrap());
    let uniform = 1.0 / (4.0 * PI);
    let lobe = |direction: [f64; 3]| (0.2 + cosine(direction.map(|c| c as f32))).max(0.0);
    let pdf = |direction: [f64; 3]| guide.pdf_solid_angle(&histogram, direction.map(|c| c as f32), uniform);
    let run = |check, pdf_of: &dyn Fn(f64, [f32; 3]) -> f64| {
        let sample = |u: [f64; 3]| {
            let guided = guide.sample(&histogram, u, |u| Some(sphere_direction(u)), |_| uniform)?;
            let reported = pdf_of(guided.pdf_solid_angle, guided.direction);
            let weight = lobe(guided.direction.map(f64::from)) / reported;
            Some(Sampled { point: guided.direction, weight, pdf: reported })
        };
        // The density is constant in these cells; at their rims f32 rounds across.
        SamplingCheck::on(Sphere).cells(32, 32).outliers(1e-3).run(check, sample, pdf, lobe)
    };
    run(check, &|pdf, _| pdf).expect_pass();
    run(SUITE.twin("the histogram's density alone"), &|_, direction| histogram.pdf_solid_angle(direction))
        .expect_reject();
    run(SUITE.twin("the original density alone"), &|_, _| uniform).expect_reject();
}

/// A light above the unit square, guided to where importons are, and what it emits is deposited by importance: flux
/// arrives in full.
#[test]
fn guidance_and_deposition_go_together() {
    const HEIGHT: f32 = 0.5;
    let importance = importance();
    let scale = ImportanceScale::from_queries([importance.at([0.2, 0.5, 0.0])], 0.0).unwrap();
    let deposition = ImportonDeposition::new(&importance, scale, Bound::Floor(0.05)).unwrap();
    // Where importons are, seen from the light.
    let light = [0.5, 0.5, HEIGHT];
    let mut histogram = DirectionalHistogram::new(16, 16).unwrap();
    for importon in importance.importons().photons() {
        let [x, y, z] = importon.position();
        histogram.add([x - light[0], y - light[1], z - light[2]], importon.flux());
    }
    let guide = Guide::new(0.8).unwrap();
    let uniform = 1.0 / (4.0 * PI);
    let total = |uniforms: &mut Uniforms, pdf_of: &dyn Fn(f64) -> f64, decided: bool| {
        let mut flux = 0.0;
        for _ in 0..200 {
            let sample =
                guide.sample(&histogram, uniforms.array(), |u| Some(sphere_direction(u)), |_| uniform).unwrap();
            let [x, y, z] = sample.direction;
            let u = uniforms.next_f64();
            let t = -HEIGHT / z;
            let place = [light[0] + t * x, light[1] + t * y, 0.0];
            if z < 0.0 && (0.0..1.0).contains(&place[0]) && (0.0..1.0).contains(&place[1]) {
                let emitted = Photon::new(place, [-x, -y, -z], uniform / pdf_of(sample.pdf_solid_angle));
                let kept = deposition.decide(emitted, u).map(|kept| if decided { kept } else { emitted });
                flux += kept.map_or(0.0, |photon| photon.flux) / 200.0;
            }
        }
        flux
    };
    // The solid angle of a square of side 2 a at distance h is 4 asin(a^2 / (a^2 + h^2)): a cube's face for a = h.
    let truth = 1.0 / 6.0;
    let check = SUITE.check("guided emission with deposition");
    let mut uniforms = check.uniforms();
    let found: Moments = (0..1500).map(|_| total(&mut uniforms, &|pdf| pdf, true)).collect();
    mean_is(check, &found, truth).expect_pass();
    let unweighted: Moments = (0..1500).map(|_| total(&mut uniforms, &|_| uniform, true)).collect();
    mean_is(SUITE.twin("guided photons keep their flux"), &unweighted, truth).expect_reject();
    let forgotten: Moments = (0..1500).map(|_| total(&mut uniforms, &|pdf| pdf, false)).collect();
    mean_is(SUITE.twin("guided, 1/p forgotten"), &forgotten, truth).expect_reject();
}

/// The directions of the importance map are those that its importons came from.
#[test]
fn directions_of_importance_are_those_of_the_importons() {
    let (importance, mut histogram) = (importance(), DirectionalHistogram::new(4, 2).unwrap());
    importance.directions(&GatherPoint::on([0.2, 0.5, 0.0], [0.0, 0.0, 1.0]), &mut histogram, &mut Scratch::default());
    assert!(histogram.pdf_solid_angle([0.3, 0.1, 1.0]) > 0.0);
    assert_eq!(histogram.pdf_solid_angle([0.3, 0.1, -1.0]), 0.0);
    importance.directions(&GatherPoint::on([0.2, 0.5, 0.0], [0.0, 0.0, -1.0]), &mut histogram, &mut Scratch::default());
    assert!(histogram.is_empty());
}

#[test]
fn guided_lights_are_drawn_with_their_probabilities() {
    let check = SUITE.check("guided lights");
    let mut uniforms = check.uniforms();
    let (powers, importance) = ([1.0, 5.0, 2.0, 2.0], [0.0, 1.0, 9.0, 0.0]);
    let table = LightTable::guided(&powers, &importance, 0.5).unwrap();
    let mut counts = [0_u64; 4];
    let mut power = Moments::new();
    for _ in 0..100_000 {
        let (light, probability) = table.sample(uniforms.next_f64());
        counts[light as usize] += 1;
        power.push(powers[light as usize] / probability);
    }
    let [a, b] = check.split(["frequencies", "power"]);
    chi_square_counts(a, &counts, &[0.05, 0.3, 0.55, 0.1]).expect_pass();
    mean_is(b, &power, 10.0).expect_pass();
    chi_square_counts(SUITE.twin("importance alone"), &counts, &[0.0, 0.1, 0.9, 0.0]).expect_reject();
}
