//! A photon map of a floor under a lamp, against the closed form: `photon-map` with the photons it keeps where the
//! camera looks.
//!
//! ```text
//! E(x) = I h / d^3        lamp of intensity I at height h, distance d from x
//! ```
//! The camera sees a corner of the floor. With the same number of photons in memory, deposition by importance has
//! them there.
//!
//! Run with `cargo run --release --example photon_map`.
#![allow(clippy::print_stdout)]

use std::f64::consts::TAU;

use photon_map::{
    Bound, DensityEstimation, Deposition, DepositionExt, Gather, GatherPoint, ImportanceMap, ImportanceScale,
    ImportonDeposition, KeepAll, Kernel, Photon, PhotonMap, Photons, ProgressiveRadius, Scratch,
};
use qmc_sampling::{Independent, Sampler, SamplerFamily};

/// Intensity of the lamp, W/sr.
const INTENSITY: f64 = 100.0;
/// Where it hangs above the floor of 10 x 10 m.
const LAMP: [f64; 3] = [5.0, 5.0, 2.0];
const FLOOR: f64 = 10.0;
/// The camera sees the floor up to here in x and y.
const SEEN: f64 = 2.0;
/// Photons in memory.
const STORED: usize = 50_000;
const UP: [f32; 3] = [0.0, 0.0, 1.0];

type Error = Box<dyn std::error::Error>;

/// The closed form.
fn irradiance(x: f64, y: f64) -> f64 {
    let d2 = (x - LAMP[0]).powi(2) + (y - LAMP[1]).powi(2) + LAMP[2].powi(2);
    INTENSITY * LAMP[2] / (d2 * d2.sqrt())
}

/// Traces paths from the lamp, evenly over the lower hemisphere, until enough photons are stored.
fn trace(deposition: &impl Deposition, photons: usize, seed: u64) -> Photons<f64> {
    let numbers = Independent::new(seed);
    let mut stored = Photons::with_capacity(photons);
    // Stopping at a number of stored photons is biased by one in that number.
    while stored.len() < photons {
        let mut sampler = numbers.sampler(0, stored.paths());
        let [u, v] = sampler.next_2d().map(f64::from);
        let (cosine, (sin, cos)) = (1.0 - u, (TAU * v).sin_cos());
        let sine = (1.0 - cosine * cosine).sqrt();
        let (w, t) = ([sine * cos, sine * sin, -cosine], LAMP[2] / cosine);
        let [x, y] = [LAMP[0] + t * w[0], LAMP[1] + t * w[1]];
        stored.add_paths(1);
        if (0.0..FLOOR).contains(&x) && (0.0..FLOOR).contains(&y) {
            let photon = Photon::new([x as f32, y as f32, 0.0], w.map(|c| -c as f32), INTENSITY * TAU);
            if let Some(photon) = deposition.decide(photon, f64::from(sampler.next_1d())) {
                stored.store(photon);
            }
        }
    }
    stored
}

/// What the camera sees of the floor, as importons.
fn importance() -> Result<ImportanceMap, Error> {
    let mut importons = Photons::new();
    for index in 0..5000 {
        let [x, y] = Independent::new(1).sampler(0, index).next_2d();
        importons.store(Photon::new([x * SEEN as f32, y * SEEN as f32, 0.0], UP, 1.0));
    }
    importons.add_paths(5000);
    let estimation = DensityEstimation { gather: Gather::within(0.2)?, kernel: Kernel::Constant };
    Ok(ImportanceMap::new(PhotonMap::build(importons, 0.2)?, estimation))
}

/// Points that the camera sees, away from the rim of the floor.
fn points() -> impl Iterator<Item = [f64; 2]> {
    (0..400).map(|i| [0.4 + 1.4 * f64::from(i % 20) / 19.0, 0.4 + 1.4 * f64::from(i / 20) / 19.0])
}

/// The root mean square of the relative error over the points, in percent.
fn error(estimate: impl Fn(&GatherPoint) -> f64) -> f64 {
    let squares = points().map(|[x, y]| {
        let at = GatherPoint::on([x as f32, y as f32, 0.0], UP);
        (estimate(&at) / irradiance(x, y) - 1.0).powi(2)
    });
    100.0 * (squares.sum::<f64>() / points().count() as f64).sqrt()
}

fn map_error(map: &PhotonMap<f64>, gather: Gather, kernel: Kernel) -> f64 {
    let estimation = DensityEstimation { gather, kernel };
    error(|at| map.irradiance(&estimation, at, &mut Scratch::default()).value)
}

fn main() -> Result<(), Error> {
    let importance = importance()?;
    let test_rays = points().map(|[x, y]| importance.at([x as f32, y as f32, 0.0]));
    let scale = ImportanceScale::from_queries(test_rays, 0.05)?;
    let deposition = ImportonDeposition::new(&importance, scale, Bound::Floor(0.005))?;

    println!("{:<28} {:>9} {:>8} {:>25} {:>12}", "map", "traced", "stored", "estimate", "rms error, %");
    let plain = trace(&KeepAll, STORED, 2);
    let important = trace(&deposition, STORED, 3);
    let mut errors = Vec::new();
    for (name, photons) in [("plain", plain), ("deposition by importance", important)] {
        let (traced, stored) = (photons.paths(), photons.len());
        let map = PhotonMap::build(photons, 0.2)?;
        let estimates = [
            ("radius 0.2, constant", Gather::within(0.2)?, Kernel::Constant),
            ("radius 0.2, cone", Gather::within(0.2)?, Kernel::CONE),
            ("radius 0.2, Epanechnikov", Gather::within(0.2)?, Kernel::Epanechnikov),
            ("500 nearest, Epanechnikov", Gather::nearest(500, 2.0)?, Kernel::Epanechnikov),
        ];
        for (kind, gather, kernel) in estimates {
            let error = map_error(&map, gather, kernel);
            println!("{name:<28} {traced:>9} {stored:>8} {kind:>25} {error:>12.2}");
            errors.push(error);
        }
    }
    assert!((0..4).all(|row| errors[row + 4] < 0.5 * errors[row]), "importance should halve the error at least");

    // Progressive: each iteration has photons of its own and a smaller radius.
    let mut radius = ProgressiveRadius::new(0.3, 2.0 / 3.0)?;
    let mut sums = vec![0.0; points().count()];
    while radius.iteration() <= 64 {
        let map = PhotonMap::build(trace(&deposition, 10_000, 3 + radius.iteration()), radius.radius())?;
        let estimation = DensityEstimation { gather: Gather::within(radius.radius())?, kernel: Kernel::Epanechnikov };
        for (sum, [x, y]) in sums.iter_mut().zip(points()) {
            *sum += map
                .irradiance(&estimation, &GatherPoint::on([x as f32, y as f32, 0.0], UP), &mut Scratch::default())
                .value;
        }
        if radius.iteration().is_power_of_two() {
            let n = radius.iteration() as f64;
            let squares = sums.iter().zip(points()).map(|(sum, [x, y])| (sum / n / irradiance(x, y) - 1.0).powi(2));
            let error = 100.0 * (squares.sum::<f64>() / sums.len() as f64).sqrt();
            println!("progressive, {:>3} iterations, last radius {:.3}: rms error {error:.2} %", n, radius.radius());
        }
        radius.advance();
    }
    Ok(())
}
