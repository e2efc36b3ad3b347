//! Density estimates of uniform sheets and walls against closed forms, without chance.
#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;

use photon_map::{DensityEstimation, Gather, GatherPoint, Kernel, MapError, Photon, PhotonMap, Photons, Scratch};
use range_search::BruteForce;

/// A right-handed frame: two tangents and a normal.
type Frame = [[f32; 3]; 3];

const UPRIGHT: Frame = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// Rotated, so that no axis is special.
const TILTED: Frame =
    [[2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0], [2.0 / 3.0, 2.0 / 3.0, -1.0 / 3.0], [-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0]];

fn place(frame: &Frame, centre: [f32; 3], [x, y, z]: [f64; 3]) -> [f32; 3] {
    let along = |axis: usize| {
        centre[axis]
            + (x * f64::from(frame[0][axis]) + y * f64::from(frame[1][axis]) + z * f64::from(frame[2][axis])) as f32
    };
    [along(0), along(1), along(2)]
}

/// `n` photons of flux 1 around the origin whose squared distances are `(j + 1/2) / n`: a uniform disk of radius 1
/// and density `n / pi`.
fn disk(frame: &Frame, centre: [f32; 3], n: u32) -> Photons<f64> {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let mut photons = Photons::new();
    for j in 0..n {
        let (radius, angle) = (((f64::from(j) + 0.5) / f64::from(n)).sqrt(), f64::from(j) * GOLDEN_ANGLE);
        let position = place(frame, centre, [radius * angle.cos(), radius * angle.sin(), 0.0]);
        photons.store(Photon::new(position, place(frame, [0.0; 3], [0.3, 0.2, 1.0]), 1.0));
    }
    photons.add_paths(u64::from(n));
    photons
}

fn kernels() -> [Kernel; 4] {
    [Kernel::Constant, Kernel::CONE, Kernel::cone(1.5).unwrap(), Kernel::Epanechnikov]
}

#[test]
fn a_uniform_sheet_has_its_irradiance_with_every_kernel_and_compression() {
    const N: u32 = 20_000;
    for (frame, centre) in [(UPRIGHT, [0.0; 3]), (TILTED, [3.0, -2.0, 1.0])] {
        let map = PhotonMap::build(disk(&frame, centre, N), 0.3).unwrap();
        for kernel in kernels() {
            for radius in [0.3_f32, 0.77, 1.0] {
                for compression in [1.0, 4.0, 100.0] {
                    let at = GatherPoint::on(centre, frame[2]).with_compression(compression);
                    let estimation = DensityEstimation { gather: Gather::within(radius).unwrap(), kernel };
                    let found = map.irradiance(&estimation, &at, &mut Scratch::default());
                    // Total flux per path is 1, on the area pi. Allowed: one photon more or less at the rim.
                    let allowed = 1.5 / (f64::from(N) * f64::from(radius).powi(2));
                    assert!((found.value * PI - 1.0).abs() < allowed, "{kernel:?} {radius} {compression}: {found:?}");
                    let inside = f64::from(N) * f64::from(radius).powi(2);
                    assert!((found.photons as f64 - inside).abs() <= 1.0);
                }
            }
        }
    }
}

#[test]
fn the_kth_nearest_photon_gives_the_radius_and_does_not_count() {
    const N: u32 = 5000;
    let map = PhotonMap::build(disk(&UPRIGHT, [0.0; 3], N), 0.1).unwrap();
    for k in [2, 10, 50, 1000] {
        let estimation = DensityEstimation { gather: Gather::nearest(k, 1.0).unwrap(), kernel: Kernel::Constant };
        let found = map.irradiance(&estimation, &GatherPoint::at([0.0; 3]), &mut Scratch::default());
        // Photon k is at squared distance (k - 1/2) / N.
        let radius_squared = (k as f64 - 0.5) / f64::from(N);
        assert!((f64::from(found.radius).powi(2) / radius_squared - 1.0).abs() < 1e-5);
        assert_eq!(found.photons, k - 1);
        let exact = (k as f64 - 1.0) / (PI * radius_squared * f64::from(N));
        assert!((found.value / exact - 1.0).abs() < 1e-5, "{k}: {found:?}");
        // Counting it as well would add one part in k - 1: the documented bias of that estimate.
        let jensen = k as f64 / (PI * radius_squared * f64::from(N));
        assert!((jensen / found.value - k as f64 / (k as f64 - 1.0)).abs() < 1e-4);
    }
}

/// The expectation over the Gamma distribution of the squared radius, by quadrature: `k - 1` is unbiased, `k` is not.
#[test]
fn the_bias_of_nearest_photons_is_as_derived() {
    for k in [2_u32, 5, 50] {
        let log_factorial: f64 = (1..k).map(|i| f64::from(i).ln()).sum();
        let density = |a: f64| (f64::from(k - 1) * a.ln() - a - log_factorial).exp();
        let steps = 2_000_000;
        let h = 300.0 / f64::from(steps);
        let inverse: f64 = (0..steps).map(|i| (f64::from(i) + 0.5) * h).map(|a| h * density(a) / a).sum();
        assert!((f64::from(k - 1) * inverse - 1.0).abs() < 1e-3, "{k}: {}", f64::from(k - 1) * inverse);
        assert!((f64::from(k) * inverse - f64::from(k) / f64::from(k - 1)).abs() < 3e-3);
    }
}

/// A wall beside the point: of its photons those in a half ellipse of area `pi (r^2 - a^2) / (2 s)` leak onto the
/// floor.
#[test]
fn compression_divides_what_a_wall_leaks() {
    const SPACING: f64 = 0.002;
    let (distance, radius) = (0.3, 0.5_f32);
    let mut photons = Photons::new();
    for (i, j) in (0..700).flat_map(|i| (0..400).map(move |j| (i, j))) {
        let position = [distance, (f64::from(i) - 349.5) * SPACING, (f64::from(j) + 0.5) * SPACING].map(|x| x as f32);
        photons.store(Photon::new(position, [-1.0, 0.0, 1.0], 1.0_f64));
    }
    photons.add_paths(1);
    let map = PhotonMap::build(photons, radius).unwrap();
    for compression in [1.0_f32, 2.0, 10.0] {
        let at = GatherPoint::on([0.0; 3], [0.0, 0.0, 1.0]).with_compression(compression);
        let (count, _) = map.collect(radius, &at, |photon| photon.flux());
        let area = PI * (f64::from(radius).powi(2) - distance.powi(2)) / (2.0 * f64::from(compression));
        assert!((count as f64 * SPACING * SPACING / area - 1.0).abs() < 0.02, "{compression}: {count}");
    }
}

#[test]
fn the_normal_test_keeps_the_other_side_out() {
    let mut photons = Photons::new();
    for wi in [[0.0, 0.1, 1.0], [0.0, 0.1, -1.0], [1.0, 0.0, 0.0]] {
        photons.store(Photon::new([0.0; 3], wi, 1.0_f64));
    }
    photons.add_paths(1);
    let map = PhotonMap::build(photons, 1.0).unwrap();
    let count = |at: GatherPoint| map.collect(1.0, &at, |photon| photon.flux()).0;
    let up = GatherPoint::on([0.0; 3], [0.0, 0.0, 2.0]);
    assert_eq!(count(up), 1);
    assert_eq!(count(GatherPoint::on([0.0; 3], [0.0, 0.0, -2.0])), 1);
    assert_eq!(count(up.with_least_cosine(-0.5)), 2);
    assert_eq!(count(up.with_least_cosine(-1.0)), 3);
    assert_eq!(count(up.with_least_cosine(f32::NAN)), 3);
    assert_eq!(count(GatherPoint::at([0.0; 3])), 3);
    assert_eq!(count(GatherPoint::on([0.0; 3], [f32::NAN; 3])), 3);
}

#[cfg(feature = "rayon")]
#[test]
fn all_threads_build_the_same_map() {
    let photons = || disk(&TILTED, [1.0, 2.0, 3.0], 100_000);
    let [one, all] = [PhotonMap::build(photons(), 0.05).unwrap(), PhotonMap::par_build(photons(), 0.05).unwrap()];
    assert!(one.photons() == all.photons() && one.paths() == all.paths());
    let estimation = DensityEstimation { gather: Gather::within(0.1).unwrap(), kernel: Kernel::CONE };
    let irradiance =
        |map: &PhotonMap<f64>| map.irradiance(&estimation, &GatherPoint::at([1.0, 2.0, 3.0]), &mut Scratch::default());
    assert_eq!(irradiance(&one), irradiance(&all));
}

#[test]
fn every_index_gives_the_same_estimate() {
    let photons = || disk(&TILTED, [1.0, 2.0, 3.0], 3000);
    let grid = PhotonMap::build(photons(), 0.1).unwrap();
    let brute =
        PhotonMap::with_index(photons(), |photons| BruteForce::build(photons, |photon| photon.position())).unwrap();
    assert_eq!((grid.photons().len(), grid.paths()), (brute.photons().len(), brute.paths()));
    let mut scratch = Scratch::default();
    for gather in [Gather::within(0.2).unwrap(), Gather::nearest(40, 0.5).unwrap()] {
        for kernel in kernels() {
            let (estimation, at) = (
                DensityEstimation { gather, kernel },
                GatherPoint::on(place(&TILTED, [1.0, 2.0, 3.0], [0.1, 0.05, 0.0]), TILTED[2]),
            );
            let [a, b] =
                [grid.irradiance(&estimation, &at, &mut scratch), brute.irradiance(&estimation, &at, &mut scratch)];
            assert_eq!((a.photons, a.radius), (b.photons, b.radius));
            assert!(a.photons > 0 && (a.value - b.value).abs() < 1e-12 * a.value);
        }
    }
    let points = || (0..9).map(|i| [1.0 + 0.01 * i as f32, 2.0, 3.0]);
    let radius = grid.typical_radius(points(), 30, 0.5).unwrap();
    assert_eq!(Some(radius), brute.typical_radius(points(), 30, 0.5));
    assert!((f64::from(radius) - (30.0_f64 / 3000.0).sqrt()).abs() < 0.02, "{radius}");
    assert_eq!(grid.typical_radius([[9.0; 3]], 30, 0.5), Some(0.5));
    assert_eq!(grid.typical_radius([], 30, 0.5), None);
    assert_eq!(grid.typical_radius(points(), 0, 0.5), None);
}

#[test]
fn nonsense_is_answered_as_documented() {
    let map = PhotonMap::build(disk(&UPRIGHT, [0.0; 3], 10), 1.0).unwrap();
    let mut scratch = Scratch::default();
    for gather in [Gather::within(1.0).unwrap(), Gather::nearest(3, 1.0).unwrap()] {
        let estimation = DensityEstimation { gather, kernel: Kernel::Epanechnikov };
        for position in [[f32::NAN, 0.0, 0.0], [f32::INFINITY, 0.0, 0.0], [1e30; 3]] {
            let found = map.irradiance(&estimation, &GatherPoint::at(position), &mut scratch);
            assert_eq!((found.value, found.photons), (0.0, 0));
        }
    }
    assert_eq!(map.collect(f32::NAN, &GatherPoint::at([0.0; 3]), |photon| photon.flux()), (0, 0.0));
    assert_eq!(PhotonMap::build(Photons::<f32>::new(), 1.0).err(), Some(MapError::NoPaths));
    let mut nothing = Photons::<f32>::new();
    nothing.add_paths(1);
    assert!(matches!(PhotonMap::build(nothing.clone(), f32::NAN), Err(MapError::Index(_))));
    let empty = PhotonMap::build(nothing, 1.0).unwrap();
    let estimation = DensityEstimation { gather: Gather::nearest(3, 1.0).unwrap(), kernel: Kernel::Constant };
    assert_eq!(empty.irradiance(&estimation, &GatherPoint::at([0.0; 3]), &mut scratch).value, 0.0);

    // A thousand photons in one point have a finite density.
    let mut coincident = Photons::new();
    (0..1000).for_each(|_| coincident.store(Photon::new([0.0; 3], [0.0, 0.0, 1.0], 1.0_f32)));
    coincident.add_paths(1);
    let map = PhotonMap::build(coincident, 1.0).unwrap();
    let found = map.irradiance(&estimation, &GatherPoint::at([0.0; 3]), &mut scratch);
    assert!(found.value.is_finite() && found.photons == 1000);
}
