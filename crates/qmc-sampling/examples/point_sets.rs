//! Draws the pictures of the documentation: point sets, periodograms and convergence, as PNG files.
//!
//! `cargo run --release -p qmc-sampling --example point_sets -- docs/qmc-sampling`
use image::{GrayImage, Luma, Rgb, RgbImage};
use qmc_sampling::measure::Periodogram;
use qmc_sampling::sampler::{GlobalSobol, PaddedLattice, ZSobol};
use qmc_sampling::sequences::{DigitScramble, Halton, Lattice, MultiJittered, Random, Stratified};
use qmc_sampling::sobol::{Randomisation, Sobol};
use qmc_sampling::{Independent, OwenSobol, Replications, Sampler, SamplerFamily, Sequence};
use std::path::Path;

type AnyError = Box<dyn std::error::Error>;

fn main() -> Result<(), AnyError> {
    let out = std::env::args().nth(1).unwrap_or_else(|| "docs/qmc-sampling".into());
    let out = Path::new(&out);
    std::fs::create_dir_all(out)?;
    draw_sets(out)?;
    draw_convergence(out)?;
    draw_error_diffusion(out)
}

/// 256 points of each set, and the mean periodogram of 64 randomisations.
fn draw_sets(out: &Path) -> Result<(), AnyError> {
    draw_set(out, "random", Random::new)?;
    draw_set(out, "jittered", |seed| Stratified::jittered(16, 16, seed).expect("a grid"))?;
    draw_set(out, "multi-jittered", |seed| MultiJittered::new(16, 16, seed).expect("a grid"))?;
    draw_set(out, "halton-owen", |seed| Halton::new(DigitScramble::Owen(seed)))?;
    draw_set(out, "sobol-plain", |_| Sobol::default())?;
    draw_set(out, "sobol-owen", |seed| Sobol::new(Randomisation::Owen(seed)))?;
    draw_set(out, "lattice", |seed| Lattice::default().shifted(seed))
}

fn draw_set<S: Sequence>(out: &Path, name: &str, sequence: impl Fn(u64) -> S) -> Result<(), AnyError> {
    let set = |seed| -> Vec<f64> { (0..256).flat_map(|i| sequence(seed).sample_2d(i)).collect() };
    let side = 385;
    let mut picture = GrayImage::from_pixel(side, side, Luma([255]));
    for point in set(1).chunks_exact(2) {
        let [x, y] = [point[0], point[1]].map(|c| (c * f64::from(side)) as i64);
        for (dx, dy) in
            (-2..=2).flat_map(|dx| (-2..=2).map(move |dy| (dx, dy))).filter(|(dx, dy)| dx * dx + dy * dy < 6)
        {
            let [px, py] = [x + dx, y + dy];
            if (0..i64::from(side)).contains(&px) && (0..i64::from(side)).contains(&py) {
                picture.put_pixel(px as u32, py as u32, Luma([0]));
            }
        }
    }
    picture.save(out.join(format!("points-{name}.png")))?;
    let mut periodogram = Periodogram::new(64);
    for seed in 0..64 {
        periodogram.add(&set(seed))?;
    }
    let width = periodogram.side() as u32;
    let pixels: Vec<u8> = periodogram.picture().iter().map(|p| (100.0 * p).min(255.0) as u8).collect();
    let picture = GrayImage::from_raw(width, width, pixels).ok_or("a picture of the wrong size")?;
    image::imageops::resize(&picture, 3 * width, 3 * width, image::imageops::Nearest)
        .save(out.join(format!("spectrum-{name}.png")))?;
    Ok(())
}

/// A point set of `n` points in some randomisation, for an integrand of two dimensions.
type Estimator = fn(seed: u64, n: u64, f: Integrand) -> f64;

type Integrand = fn([f64; 2]) -> f64;

fn mean(sequence: impl Sequence, n: u64, f: Integrand) -> f64 {
    (0..n).map(|i| f(sequence.sample_2d(i))).sum::<f64>() / n as f64
}

const ESTIMATORS: [(&str, [u8; 3], Estimator); 6] = [
    ("random", [120, 120, 120], |seed, n, f| mean(Random::new(seed), n, f)),
    ("jittered", [230, 160, 0], |seed, n, f| {
        let side = (n as f64).sqrt() as u32;
        mean(Stratified::jittered(side, n as u32 / side, seed).expect("a grid"), n, f)
    }),
    ("halton, owen", [0, 120, 200], |seed, n, f| mean(Halton::new(DigitScramble::Owen(seed)), n, f)),
    ("sobol, digit shift", [0, 160, 110], |seed, n, f| mean(Sobol::new(Randomisation::DigitShift(seed)), n, f)),
    ("sobol, owen", [210, 60, 30], |seed, n, f| mean(Sobol::new(Randomisation::Owen(seed)), n, f)),
    ("lattice, shifted", [160, 80, 180], |seed, n, f| mean(Lattice::default().shifted(seed), n, f)),
];

const INTEGRANDS: [(&str, Integrand); 3] = [
    ("smooth", |[x, y]| (x + y).exp()),
    ("disk", |[x, y]| if x * x + y * y < 0.8 { 1.0 } else { 0.0 }),
    ("singular", |[x, y]| (1.0 + y) / x.max(1e-12).powf(0.25)),
];

/// Variance over numbers of points, both logarithmic, with error bars of one standard error; and as a table.
fn draw_convergence(out: &Path) -> Result<(), AnyError> {
    let mut table =
        String::from("| integrand | points | n | variance | relative error of it |\n|---|---|---|---|---|\n");
    for (name, f) in INTEGRANDS {
        let mut picture = RgbImage::from_pixel(480, 400, Rgb([255, 255, 255]));
        let replications = 400;
        let curves = ESTIMATORS.map(|(set, colour, estimator)| {
            let curve = (1..=6).map(|k| {
                let n = 1_u64 << (2 * k);
                let variance = Replications::run(replications, n, |seed| estimator(seed, n, f)).variance();
                (n, variance)
            });
            (set, colour, curve.collect::<Vec<_>>())
        });
        let logs = curves.iter().flat_map(|c| &c.2).map(|&(_, v)| v.log10());
        let [low, high] = logs.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
        let error = (2.0 / (replications - 1) as f64).sqrt();
        let place = |n: u64, v: f64| {
            let x = 20.0 + 440.0 * ((n as f64).log2() - 2.0) / 10.0;
            (x, 380.0 - 360.0 * (v.log10() - low) / (high - low))
        };
        for (set, colour, curve) in &curves {
            for pair in curve.windows(2) {
                line(&mut picture, place(pair[0].0, pair[0].1), place(pair[1].0, pair[1].1), *colour);
            }
            for &(n, v) in curve {
                line(&mut picture, place(n, v * (1.0 - error)), place(n, v * (1.0 + error)), *colour);
                table.push_str(&format!("| {name} | {set} | {n} | {v:.3e} | {error:.2} |\n"));
            }
        }
        picture.save(out.join(format!("convergence-{name}.png")))?;
    }
    std::fs::write(out.join("convergence.md"), table)?;
    Ok(())
}

fn line(picture: &mut RgbImage, from: (f64, f64), to: (f64, f64), colour: [u8; 3]) {
    for step in 0..=500 {
        let t = f64::from(step) / 500.0;
        let (x, y) = (from.0 + t * (to.0 - from.0), from.1 + t * (to.1 - from.1));
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)] {
            let (px, py) = ((x + dx) as u32, (y + dy) as u32);
            if px < picture.width() && py < picture.height() {
                picture.put_pixel(px, py, Rgb(colour));
            }
        }
    }
}

/// How errors spread over an image: the same integral in each pixel, with 4 paths.
fn draw_error_diffusion(out: &Path) -> Result<(), AnyError> {
    const SIDE: u32 = 128;
    draw_errors(out, "independent", &Independent::new(1))?;
    draw_errors(out, "owen-sobol", &OwenSobol::new(1))?;
    draw_errors(out, "global-sobol", &GlobalSobol::new(SIDE, SIDE, 1)?)?;
    draw_errors(out, "z-sobol", &ZSobol::new(SIDE, SIDE, 4, 1)?)?;
    draw_errors(out, "lattice", &PaddedLattice::new(1))
}

fn draw_errors(out: &Path, name: &str, family: &impl SamplerFamily) -> Result<(), AnyError> {
    let side = 128;
    let picture = GrayImage::from_fn(side, side, |x, y| {
        let paths = (0..4).map(|index| {
            let mut sampler = family.sampler(u64::from(y * side + x), index);
            sampler.next_2d();
            let [u, v] = sampler.next_2d();
            if u * u + v * v < 1.0 { 1.0 } else { 0.0 }
        });
        let error = paths.sum::<f32>() / 4.0 - std::f32::consts::FRAC_PI_4;
        Luma([(128.0 + 160.0 * error).clamp(0.0, 255.0) as u8])
    });
    image::imageops::resize(&picture, 3 * side, 3 * side, image::imageops::Nearest)
        .save(out.join(format!("errors-{name}.png")))?;
    Ok(())
}
