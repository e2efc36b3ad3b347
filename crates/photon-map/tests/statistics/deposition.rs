//! Deposition by importance keeps the expectation, if it has a floor.

use estimator_checks::{Moments, Uniforms, mean_is};
use photon_map::{
    Bound, DensityEstimation, DepositionExt, Gather, GatherPoint, ImportanceMap, ImportanceScale, ImportonDeposition,
    Kernel, Photon, PhotonMap, Photons, Scratch,
};

use crate::SUITE;

const UP: [f32; 3] = [0.0, 0.0, 1.0];
const SEEN: [f32; 3] = [0.2, 0.5, 0.0];
const UNSEEN: [f32; 3] = [0.8, 0.5, 0.0];
/// At the edge of what is seen, where the probability falls from one to the floor.
const EDGE: [f32; 3] = [0.4, 0.5, 0.0];

/// The camera sees the unit square up to `x = 0.4`.
pub(crate) fn importance() -> ImportanceMap {
    let mut uniforms = Uniforms::named("importons");
    let mut importons = Photons::new();
    for _ in 0..800 {
        let [x, y] = uniforms.array::<2>().map(|u| u as f32);
        importons.store(Photon::new([0.4 * x, y, 0.0], [0.3, 0.1, 1.0], 1.0));
    }
    importons.add_paths(800);
    let estimation = DensityEstimation { gather: Gather::within(0.08).unwrap(), kernel: Kernel::Epanechnikov };
    ImportanceMap::new(PhotonMap::build(importons, 0.08).unwrap(), estimation)
}

fn scale(importance: &ImportanceMap) -> ImportanceScale {
    let test_rays =
        (0..100).map(|i| [0.35 * (f32::from(i % 10_u8) + 0.5) / 10.0, (f32::from(i / 10) + 0.5) / 10.0, 0.0]);
    let scale = ImportanceScale::from_queries(test_rays.map(|x| importance.at(x)), 0.05).unwrap();
    assert_eq!(scale.empty_share(), 0.0);
    scale
}

/// How the flux of kept photons is treated.
#[derive(Clone, Copy)]
enum Kept {
    Divided,
    /// Planted bug: one over the probability is forgotten.
    AsItWas,
}

/// Irradiance at the three places, over many maps; the truth is one everywhere.
fn irradiance(mut uniforms: Uniforms, bound: Bound, kept: Kept) -> [Moments; 3] {
    let importance = importance();
    let deposition = ImportonDeposition::new(&importance, scale(&importance), bound).unwrap();
    let estimation = DensityEstimation { gather: Gather::within(0.1).unwrap(), kernel: Kernel::Constant };
    let mut moments = [Moments::new(); 3];
    let mut largest = 0;
    for _ in 0..800 {
        let mut photons = Photons::new();
        for _ in 0..2000 {
            let [x, y, u] = uniforms.array();
            let photon = Photon::new([x as f32, y as f32, 0.0], UP, 1.0_f64);
            if let Some(decided) = deposition.decide(photon, u) {
                photons.store(if matches!(kept, Kept::Divided) { decided } else { photon });
            }
        }
        photons.add_paths(2000);
        largest = largest.max(photons.len());
        let map = PhotonMap::build(photons, 0.1).unwrap();
        for (moments, place) in moments.iter_mut().zip([SEEN, UNSEEN, EDGE]) {
            moments.push(map.irradiance(&estimation, &GatherPoint::on(place, UP), &mut Scratch::default()).value);
        }
    }
    assert!(largest < 1200, "{largest} of 2000 photons were kept");
    moments
}

#[test]
fn a_floor_is_unbiased_everywhere() {
    let checks = ["seen", "unseen", "edge"].map(|place| SUITE.check(&format!("deposition with a floor: {place}")));
    let uniforms = checks[0].uniforms();
    let floor = irradiance(uniforms, Bound::Floor(0.03), Kept::Divided);
    // Where the camera looks photons are kept as they are: far less noise than elsewhere.
    assert!(floor[0].variance() < 0.1 * floor[1].variance());
    for (check, moments) in checks.into_iter().zip(&floor) {
        mean_is(check, moments, 1.0).expect_pass();
    }

    let forgotten = irradiance(Uniforms::named("forgotten"), Bound::Floor(0.03), Kept::AsItWas);
    mean_is(SUITE.twin("1/p forgotten, unseen"), &forgotten[1], 1.0).expect_reject();
    mean_is(SUITE.twin("1/p forgotten, edge"), &forgotten[2], 1.0).expect_reject();
}

#[test]
fn a_cutoff_is_unbiased_where_importance_is_and_loses_the_rest() {
    let check = SUITE.check("deposition with a cutoff: seen");
    let cutoff = irradiance(check.uniforms(), Bound::Cutoff(0.03), Kept::Divided);
    mean_is(check, &cutoff[0], 1.0).expect_pass();
    mean_is(SUITE.twin("cutoff, unseen"), &cutoff[1], 1.0).expect_reject();
    mean_is(SUITE.twin("cutoff, edge"), &cutoff[2], 1.0).expect_reject();
}

/// With a probability that depends on the direction as well: light from behind the observer's side hardly matters.
#[test]
fn directions_may_decide() {
    let check = SUITE.check("deposition by directions");
    let mut uniforms = check.uniforms();
    let importance = importance();
    let same_side = |photon: [f32; 3], importon: [f32; 3]| if photon[2] * importon[2] > 0.0 { 1.0 } else { 0.05 };
    let bound = Bound::Floor(0.02);
    let deposition = ImportonDeposition::with_directions(&importance, scale(&importance), bound, same_side).unwrap();
    let (mut divided, mut as_it_was) = (Moments::new(), Moments::new());
    let mut kept = [0; 2];
    for _ in 0..400 {
        let (mut flux, mut wrong) = (0.0, 0.0);
        for _ in 0..2000 {
            let [x, y, side, u] = uniforms.array();
            let wi = if side < 0.5 { UP } else { UP.map(|c| -c) };
            let photon = Photon::new([x as f32 * 0.4, y as f32, 0.0], wi, 1.0_f64);
            if let Some(decided) = deposition.decide(photon, u) {
                flux += decided.flux / 2000.0;
                wrong += 1.0 / 2000.0;
                kept[usize::from(side < 0.5)] += 1;
            }
        }
        divided.push(flux);
        as_it_was.push(wrong);
    }
    assert!(kept[1] > 10 * kept[0], "{kept:?}");
    mean_is(check, &divided, 1.0).expect_pass();
    mean_is(SUITE.twin("directions, 1/p forgotten"), &as_it_was, 1.0).expect_reject();
}
