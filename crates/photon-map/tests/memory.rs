//! What photons need: the table in the README, and the 50 million that have to fit.
#![allow(clippy::unwrap_used)]

use estimator_checks::Uniforms;
use photon_map::{
    CausticRule, DensityEstimation, Gather, GatherPoint, Kernel, LastBounce, LightTable, PackedPhoton, Photon,
    PhotonMap, Photons, PrimaryPhotonMap, PrimaryPhotons, Scratch,
};

const UP: [f32; 3] = [0.0, 0.0, 1.0];

/// On the faces of a cube, one watt each.
fn fill(count: u32) -> Photons<[f32; 3]> {
    let mut uniforms = Uniforms::named("memory");
    let mut photons = Photons::with_capacity(count as usize);
    for index in 0..count {
        let [x, y] = uniforms.array::<2>().map(|u| u as f32);
        let side = (index / 3 % 2) as f32;
        let position = [[x, y, side], [side, x, y], [y, side, x]][index as usize % 3];
        photons.store(Photon::new(position, [0.1, 0.1, 1.0], [1.0; 3]));
    }
    photons.add_paths(1);
    photons
}

/// Builds a map and looks into it; returns its bytes per photon.
fn load(count: u32) -> f64 {
    let photons = fill(count);
    assert_eq!(size_of_val(photons.as_slice()), 32 * count as usize);
    // About 50 photons in the disk: a sixth of them lie on the floor.
    let radius = (50.0 * 6.0 / (std::f32::consts::PI * count as f32)).sqrt();
    let map = PhotonMap::build(photons, radius).unwrap();
    assert_eq!(map.photons().len(), count as usize);
    let estimation = DensityEstimation { gather: Gather::within(20.0 * radius).unwrap(), kernel: Kernel::Constant };
    let found = map.irradiance(&estimation, &GatherPoint::on([0.5, 0.5, 0.0], UP), &mut Scratch::default());
    let truth = f64::from(count) / 6.0;
    // 20,000 photons: five standard errors are 3.5 percent.
    assert!((f64::from(found.value[0]) / truth - 1.0).abs() < 0.035, "{found:?}, not {truth}");
    map.bytes() as f64 / f64::from(count)
}

#[test]
fn photons_need_what_the_table_says() {
    assert_eq!(size_of::<PackedPhoton<[f32; 3]>>(), 32);
    assert_eq!(size_of::<PackedPhoton<f32>>(), 24);
    let bytes = load(300_000);
    assert!((48.0..=64.5).contains(&bytes), "{bytes}");

    let mut primary = PrimaryPhotons::new();
    for photon in fill(100_000).as_slice() {
        let photon = photon.unpack().from_light(1);
        primary.offer(&CausticRule::SPECULAR.label(photon, LastBounce::Emission));
    }
    let map = PrimaryPhotonMap::build(primary, 0.02).unwrap();
    let bytes = map.bytes() as f64 / 100_000.0;
    assert!((20.0..=36.5).contains(&bytes), "{bytes}");
    assert_eq!(LightTable::uniform(1000).unwrap().len(), 1000);
}

/// Peak resident memory of this process, in GiB; `None` where the system does not tell.
fn peak_gib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / (1 << 20) as f64)
}

#[test]
#[ignore = "takes half a minute and 6 GiB"]
fn fifty_million_photons_fit_into_24_gib() {
    let bytes = load(50_000_000);
    let peak = peak_gib();
    println!("{bytes:.1} bytes per photon, peak {peak:?} GiB");
    assert!(bytes <= 64.5);
    assert!(peak.is_none_or(|peak| peak < 24.0));
}
