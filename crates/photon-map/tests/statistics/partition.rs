//! The three partitions into caustic and global map have equal expectations.

use estimator_checks::{Moments, Uniforms, mean_is};
use photon_map::{CausticRule, DepositionExt, LastBounce, MapPartition, Photon, PhotonMaps};

use crate::SUITE;

const PATHS: u64 = 500;
const RATIO: f64 = 0.2;

/// A path that leaves up to three photons: direct light, then diffuse or specular bounces.
fn path(uniforms: &mut Uniforms) -> Vec<Photon<f64>> {
    let rule = CausticRule::new(0.1).unwrap();
    let mut last = LastBounce::Emission;
    let mut flux = 1.0;
    let mut photons = Vec::new();
    for _ in 0..3 {
        let [x, bounce, survives] = uniforms.array();
        photons.push(rule.label(Photon::new([x as f32, 0.0, 0.0], [0.0, 0.0, 1.0], flux), last));
        last = if bounce < 0.3 { LastBounce::Specular } else { LastBounce::Diffuse };
        flux *= 0.9;
        if survives > 0.7 {
            break;
        }
    }
    photons
}

/// Expected flux per path in the caustic and the global map.
fn truth() -> [f64; 2] {
    let bounced = 0.7 * 0.9 + 0.7 * 0.7 * 0.9 * 0.9;
    [0.3 * bounced, 1.0 + 0.7 * bounced]
}

/// A probability to store photons that depends on the place.
fn probability([x, ..]: [f32; 3], _wi: [f32; 3]) -> f64 {
    0.2 + 0.8 * f64::from(x)
}

/// Flux in both maps over many maps, with `decide` in place of the partition.
fn fluxes(
    mut uniforms: Uniforms,
    partition: &MapPartition,
    decide: impl Fn(Photon<f64>, u64, [f64; 2]) -> Option<Photon<f64>>,
) -> [Moments; 2] {
    let mut moments = [Moments::new(); 2];
    for _ in 0..3000 {
        let mut maps = PhotonMaps::new();
        for index in 0..PATHS {
            for photon in path(&mut uniforms) {
                if let Some(photon) = decide(photon, index, uniforms.array()) {
                    maps.store(photon);
                }
            }
        }
        maps.add_paths(partition, PATHS);
        moments[0].push(maps.caustic.total_flux());
        moments[1].push(maps.global.total_flux());
    }
    moments
}

#[test]
fn all_variants_have_the_same_expectation() {
    let variants = [
        ("one number", MapPartition::one_number(RATIO)),
        ("two numbers", MapPartition::two_numbers(RATIO)),
        ("trajectories", MapPartition::trajectories(RATIO, PATHS)),
    ];
    for (name, partition) in variants {
        let partition = partition.unwrap();
        let check = SUITE.check(&format!("partition by {name}"));
        let found =
            fluxes(check.uniforms(), &partition, |photon, path, u| partition.decide(photon, path, &probability, u));
        for (check, (moments, truth)) in check.split(["caustic", "global"]).into_iter().zip(found.iter().zip(truth())) {
            mean_is(check, moments, truth).expect_pass();
        }
    }
}

/// Misreadings of the paper, as they could be made: each shifts one of the maps.
#[test]
fn misreadings_are_found() {
    let [two_numbers, trajectories] =
        [MapPartition::two_numbers(RATIO), MapPartition::trajectories(RATIO, PATHS)].map(Result::unwrap);

    // As printed: the first test is against p as well, the flux still divided by q p.
    let as_printed = |photon: Photon<f64>, _, u: [f64; 2]| {
        let p = probability(photon.position, photon.wi);
        if photon.caustic {
            return probability.decide(photon, u[1]);
        }
        (u[0] < p && u[1] < p).then(|| photon.scaled(1.0 / (RATIO * p)))
    };
    let found = fluxes(Uniforms::named("as printed"), &two_numbers, as_printed);
    mean_is(SUITE.twin("p in both tests"), &found[1], truth()[1]).expect_reject();

    // The split by paths with a further 1/q.
    let twice = |photon: Photon<f64>, path, u| {
        let kept = trajectories.decide(photon, path, &probability, u)?;
        Some(if kept.caustic { kept } else { kept.scaled(1.0 / RATIO) })
    };
    let found = fluxes(Uniforms::named("q twice"), &trajectories, twice);
    mean_is(SUITE.twin("a further 1/q"), &found[1], truth()[1]).expect_reject();

    // The split by paths, but the global map divided by all paths.
    let by_all = fluxes(Uniforms::named("by all"), &two_numbers, |photon, path, u| {
        trajectories.decide(photon, path, &probability, u)
    });
    mean_is(SUITE.twin("global map over N"), &by_all[1], truth()[1]).expect_reject();

    // Any specular bounce makes a photon caustic for the rest of its path.
    let found = fluxes(Uniforms::named("never"), &two_numbers, |mut photon, path, u| {
        photon.caustic = !photon.primary;
        two_numbers.decide(photon, path, &probability, u)
    });
    mean_is(SUITE.twin("every scattered photon is caustic"), &found[0], truth()[0]).expect_reject();
}
