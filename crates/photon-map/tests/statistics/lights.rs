//! Light selection is unbiased, whatever it takes for contributing.

use estimator_checks::{Moments, Uniforms, chi_square_counts, mean_is};
use photon_map::{
    Allocation, CausticRule, ContributingLights, Gather, LastBounce, LightSelection, LightTable, Photon,
    PrimaryPhotonMap, PrimaryPhotons, ShadowRays,
};

use crate::SUITE;

const LIGHTS: u32 = 200;

/// What a light contributes: much from a few, a little from some that are not found, nothing from most.
fn contribution(light: u32) -> f64 {
    match light {
        light if light % 7 == 3 => 0.5 + f64::from(light % 10),
        light if light % 50 == 1 => 0.3,
        _ => 0.0,
    }
}

fn areas() -> Vec<f64> {
    (0..LIGHTS).map(|light| 1.0 + f64::from(light % 4)).collect()
}

/// A noisy shadow ray: visible with probability one half.
fn ray(uniforms: &mut Uniforms, light: u32) -> f64 {
    if uniforms.next_f64() < 0.5 { 2.0 * contribution(light) } else { 0.0 }
}

fn estimates(mut uniforms: Uniforms, selection: &LightSelection, by_contribution: bool) -> Moments {
    // What is found: most of what contributes, and some that does not.
    let found = (0..LIGHTS).filter(|&light| light % 7 == 3 && light != 10 || light % 31 == 0);
    let contributing = ContributingLights::from_lights(LIGHTS as usize, found);
    let mut rays = ShadowRays::default();
    let mut moments = Moments::new();
    for _ in 0..60_000 {
        let u = uniforms.array();
        if by_contribution {
            selection.select(&contributing, |light, _| contribution(light) * f64::from(1 + light % 3), u, &mut rays);
        } else {
            selection.select_by_weight(&contributing, u, &mut rays);
        }
        moments.push(rays.as_slice().iter().map(|shadow| shadow.weight * ray(&mut uniforms, shadow.light)).sum());
    }
    moments
}

#[test]
fn the_mean_is_the_sum_over_all_lights() {
    let truth: f64 = (0..LIGHTS).map(contribution).sum();
    let table = || LightTable::new(&areas()).unwrap();
    for (name, allocation) in
        [("in proportion", Allocation::Proportional), ("brightest first", Allocation::BrightestFirst)]
    {
        for rays in [8, 64] {
            for by_contribution in [false, true] {
                let kind = if by_contribution { "contribution" } else { "area" };
                let check = SUITE.check(&format!("{rays} shadow rays by {kind}, {name}"));
                let selection = LightSelection::new(table(), rays, 4, allocation).unwrap();
                mean_is(
                    check.split(["mean"]).into_iter().next().unwrap(),
                    &estimates(Uniforms::named(name), &selection, by_contribution),
                    truth,
                )
                .expect_pass();
            }
        }
    }
    // What it is for: as many rays to lights that are drawn from all of them.
    let blind = LightSelection::new(table(), 1, 12, Allocation::Proportional).unwrap();
    let nothing = ContributingLights::new(LIGHTS as usize);
    let (mut uniforms, mut rays, mut by_chance) = (Uniforms::named("blind"), ShadowRays::default(), Moments::new());
    for _ in 0..20_000 {
        blind.select_by_weight(&nothing, uniforms.array(), &mut rays);
        by_chance.push(rays.as_slice().iter().map(|shadow| shadow.weight * ray(&mut uniforms, shadow.light)).sum());
    }
    let selection = LightSelection::new(table(), 8, 4, Allocation::BrightestFirst).unwrap();
    let selected = estimates(Uniforms::named("selected"), &selection, false);
    assert!(selected.variance() < 0.5 * by_chance.variance(), "{} {}", selected.variance(), by_chance.variance());

    let none = LightSelection::new(table(), 64, 0, Allocation::BrightestFirst).unwrap();
    mean_is(SUITE.twin("no ray to the others"), &estimates(Uniforms::named("none"), &none, false), truth)
        .expect_reject();
}

/// Planted bugs in how expected counts become counts.
#[test]
fn roundings_that_drop_lights_are_found() {
    let found: Vec<u32> = (0..LIGHTS).filter(|&light| light % 7 == 3).collect();
    let truth: f64 = found.iter().map(|&light| contribution(light)).sum();
    let area = |light: u32| areas()[light as usize];
    let sum: f64 = found.iter().map(|&light| area(light)).sum();
    let mut uniforms = Uniforms::named("roundings");
    let mut moments = [Moments::new(), Moments::new()];
    for _ in 0..20_000 {
        let (mut down, mut nearest) = (0.0, 0.0);
        for &light in &found {
            let expected = 32.0 * area(light) / sum;
            for (total, count) in [(&mut down, expected.floor()), (&mut nearest, expected.round())] {
                *total += (0..count as u32).map(|_| ray(&mut uniforms, light) / expected).sum::<f64>();
            }
        }
        moments[0].push(down);
        moments[1].push(nearest);
    }
    mean_is(SUITE.twin("counts rounded down"), &moments[0], truth).expect_reject();
    mean_is(SUITE.twin("counts rounded to the nearest"), &moments[1], truth).expect_reject();
}

#[test]
fn others_are_drawn_with_the_probabilities_that_are_reported() {
    let check = SUITE.check("others by the table");
    let mut uniforms = check.uniforms();
    let table = LightTable::new(&areas()).unwrap();
    let contributing = ContributingLights::from_lights(LIGHTS as usize, (0..LIGHTS).filter(|light| light % 3 == 0));
    let others = table.others(&contributing);
    let mut counts = vec![0_u64; LIGHTS as usize];
    let mut probabilities = vec![0.0; LIGHTS as usize];
    for _ in 0..400_000 {
        let (light, probability) = others.sample(uniforms.next_f64()).unwrap();
        counts[light as usize] += 1;
        probabilities[light as usize] = probability;
    }
    chi_square_counts(check, &counts, &probabilities).expect_pass();
    // Planted bug: the probabilities of the whole table, scaled up, without its areas.
    let uniform: Vec<f64> = probabilities.iter().map(|&p| if p > 0.0 { 1.0 / 133.0 } else { 0.0 }).collect();
    chi_square_counts(SUITE.twin("equal probabilities"), &counts, &uniform).expect_reject();
}

/// A corridor of 100 rooms with a light each; a light also reaches a little into the next rooms. Few primary photons
/// find the contributing lights.
#[test]
fn selection_from_primary_photons_is_unbiased_from_end_to_end() {
    const ROOMS: u32 = 100;
    /// Where light is asked for: in room 40, near the door to room 41.
    const X: f32 = 40.8;
    let irradiance = |light: u32| match light {
        40 => 2.0,
        41 => 0.8,
        39 => 0.15,
        _ => 0.0,
    };
    let check = SUITE.check("shadow rays to lights that primary photons found");
    let mut uniforms = check.uniforms();
    let selection = |others| {
        LightSelection::new(LightTable::uniform(ROOMS as usize).unwrap(), 2, others, Allocation::BrightestFirst)
            .unwrap()
    };
    let (unbiased, biased) = (selection(2), selection(0));
    let mut contributing = ContributingLights::new(ROOMS as usize);
    let (mut rays, mut moments) = (ShadowRays::default(), [Moments::new(), Moments::new()]);
    let mut missed = 0;
    for _ in 0..6000 {
        let mut primary = PrimaryPhotons::new();
        for light in 0..ROOMS {
            // Six photons on the floor of the room, one or none in each of the next.
            for _ in 0..8 {
                let [room, x] = uniforms.array();
                let room = if room < 0.75 {
                    0.0
                } else if room < 0.875 {
                    1.0
                } else {
                    -1.0
                };
                let photon = Photon::new([light as f32 + (room + x) as f32, 0.0, 0.0], [0.0, 0.0, 1.0], 1.0_f32);
                primary.offer(&CausticRule::SPECULAR.label(photon.from_light(light), LastBounce::Emission));
            }
        }
        let map = PrimaryPhotonMap::build(primary, 0.4).unwrap();
        map.contributing([X, 0.0, 0.0], &Gather::within(0.4).unwrap(), &mut contributing);
        missed += u32::from(!contributing.contains(41));
        let u = uniforms.array();
        for (moments, selection) in moments.iter_mut().zip([&unbiased, &biased]) {
            selection.select(&contributing, |_, photons| f64::from(photons), u, &mut rays);
            moments.push(rays.as_slice().iter().map(|shadow| shadow.weight * irradiance(shadow.light)).sum());
        }
    }
    assert!(missed > 100, "the test should miss contributing lights now and then, not {missed} times");
    mean_is(check, &moments[0], 2.95).expect_pass();
    mean_is(SUITE.twin("lights that primary photons missed are left out"), &moments[1], 2.95).expect_reject();
}
