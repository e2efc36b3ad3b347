//! The crates in a renderer that is not Lichtwerk's: its own vectors, scene, scattering functions and path tracer, from
//! which it takes the truth, an image of 32 x 24 pixels.
//!
//! Each crate is called directly and its image compared with that truth; the lines that it takes to do so are counted in the
//! source. At last the checkers look at the renderer's own types.
//!
//! Run with `cargo run --release --example foreign_renderer`.
#![allow(clippy::print_stdout, missing_docs, unreachable_pub)]

mod glue;
mod laws;
mod renderer;
mod traits;
mod vector;

use std::error::Error;

use glue::Seen;
use mis_heuristics::RunningVariance;
use renderer::{HEIGHT, Hit, Numbers, Scene, WIDTH};
use vector::{V, random};

/// Lines of code between the markers of each crate, by its name.
const GLUE: [&str; 2] = [include_str!("glue.rs"), include_str!("traits.rs")];
const PIXELS: usize = WIDTH * HEIGHT;
/// Independent images of each estimator: standard errors come from them.
const IMAGES: u64 = 12;
/// Samples per pixel of an image, and of one of the truth.
const SAMPLES: u64 = 64;
const TRUTH_SAMPLES: u64 = 320;
/// Paths from the lamp for a photon map.
const LIGHT_PATHS: u64 = 60_000;
/// What a deviation may be, beside the bias.
const STANDARD_ERRORS: f64 = 6.0;

type Image = Vec<V>;

fn glue_lines(name: &str) -> usize {
    let is_code = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with("//");
    let begin = format!("// glue: {name}");
    let after = GLUE.iter().flat_map(|source| {
        source.lines().skip_while(|line| line.trim() != begin).skip(1).take_while(|line| line.trim() != "// end")
    });
    after.filter(is_code).count()
}

/// The means of independent images, and their mean image.
struct Estimate {
    mean: f64,
    standard_error: f64,
    image: Image,
}

fn repeat<E>(image: impl Fn(u64) -> Result<Image, E>) -> Result<Estimate, E> {
    let (mut means, mut sum) = (RunningVariance::new(), vec![V::default(); PIXELS]);
    for seed in 1..=IMAGES {
        let image = image(seed)?;
        means.push(image.iter().map(|pixel| pixel.mean()).sum::<f64>() / PIXELS as f64);
        sum.iter_mut().zip(&image).for_each(|(sum, pixel)| *sum += *pixel * (1.0 / IMAGES as f64));
    }
    let standard_error = means.variance_of_mean().map_or(f64::NAN, f64::sqrt);
    Ok(Estimate { mean: means.mean().unwrap_or(f64::NAN), standard_error, image: sum })
}

/// The mean over samples of each pixel: `radiance(ray, pixel, index, numbers)`.
fn render<E>(
    scene: &Scene,
    seed: u64,
    samples: u64,
    mut radiance: impl FnMut((V, V), usize, u64, &mut Numbers<'_>) -> Result<V, E>,
) -> Result<Image, E> {
    let mut u = random(seed);
    let mut image = vec![V::default(); PIXELS];
    for (pixel, sum) in image.iter_mut().enumerate() {
        let [left, top, shift_x, shift_y] = [(pixel % WIDTH) as f64, (pixel / WIDTH) as f64, u(), u()];
        for index in 0..samples {
            // A shifted lattice of places: little noise at edges.
            let place = |shift: f64, step: f64| (shift + index as f64 * step).fract();
            let ray = scene.camera.ray(left + place(shift_x, 0.754_877_67), top + place(shift_y, 0.569_840_29));
            *sum += radiance(ray, pixel, index, &mut u)? * (1.0 / samples as f64);
        }
    }
    Ok(image)
}

/// What the first hit reflects. What it emits is known, and would only hide errors.
fn shade<E>(scene: &Scene, ray: (V, V), reflected: impl FnOnce(Hit<'_>) -> Result<V, E>) -> Result<V, E> {
    scene.hit(ray, f64::INFINITY).map_or(Ok(V::default()), reflected)
}

/// Vertices seen through the pixels, each with what it reflects. The box fills the image: every ray hits.
fn vertices(scene: &Scene, seed: u64) -> Result<Vec<Seen<'_>>, Box<dyn Error>> {
    let mut seen = Vec::new();
    render(scene, seed, SAMPLES, |ray, _, _, u| {
        let x = scene.hit(ray, f64::INFINITY).ok_or("a ray missed the box")?;
        seen.push(Seen(x, glue::combined(scene, x, u)));
        Ok::<V, Box<dyn Error>>(V::default())
    })?;
    Ok(seen)
}

fn filter(scene: &Scene, seed: u64) -> Result<Image, Box<dyn Error>> {
    let seen = vertices(scene, seed)?;
    let averages = glue::filtered(&seen)?;
    let mean = |pixel: &[V]| pixel.iter().fold(V::default(), |sum, value| sum + *value) * (1.0 / SAMPLES as f64);
    Ok(averages.chunks(SAMPLES as usize).map(mean).collect())
}

fn photon_map(scene: &Scene, seed: u64) -> Result<Image, Box<dyn Error>> {
    let map = glue::photons(scene, LIGHT_PATHS, &mut random(1000 + seed))?;
    render(scene, seed, SAMPLES / 4, |ray, _, _, _| shade(scene, ray, |x| Ok(glue::density(&map, &x)?)))
}

/// Direct light alone, and all light, by the renderer's own path tracer.
fn truths(scene: &Scene) -> Result<[Estimate; 2], Box<dyn Error>> {
    let mut more = Vec::new();
    for seed in 1..=IMAGES {
        let mut indirect = vec![V::default(); PIXELS];
        let direct = render(scene, 77 + seed, TRUTH_SAMPLES, |ray, pixel, _, u| {
            let [_, direct, rest] = scene.brute_force(ray, u);
            indirect[pixel] += rest * (1.0 / TRUTH_SAMPLES as f64);
            Ok::<V, Box<dyn Error>>(direct)
        })?;
        let all: Image = direct.iter().zip(&indirect).map(|(a, b)| *a + *b).collect();
        more.push([direct, all]);
    }
    let of = |k: usize| repeat(|seed| Ok::<Image, Box<dyn Error>>(more[seed as usize - 1][k].clone()));
    Ok([of(0)?, of(1)?])
}

type Estimator<'a> = &'a dyn Fn(u64) -> Result<Image, Box<dyn Error>>;

fn main() -> Result<(), Box<dyn Error>> {
    let scene = &renderer::cornell();
    let truths = truths(scene)?;

    let ris: Estimator<'_> =
        &|seed| render(scene, seed, SAMPLES, |ray, _, _, u| shade(scene, ray, |x| Ok(glue::resampled(scene, &x, u))));
    let qmc: Estimator<'_> = &|seed| {
        render(scene, seed, SAMPLES, |ray, pixel, index, _| {
            shade(scene, ray, |x| Ok(glue::stratified(scene, &x, pixel, index, seed)))
        })
    };
    let mis: Estimator<'_> =
        &|seed| render(scene, seed, SAMPLES, |ray, _, _, u| shade(scene, ray, |x| Ok(glue::combined(scene, x, u))));
    let vpl: Estimator<'_> = &|seed| {
        render(scene, seed, SAMPLES / 4, |ray, pixel, index, _| {
            let all = traits::virtual_lights(scene, ray, seed, pixel as u64 * SAMPLES + index)?;
            shade(scene, ray, |x| Ok(all - x.emitted()))
        })
    };
    let photons: Estimator<'_> = &|seed| photon_map(scene, seed);
    let filtered: Estimator<'_> = &|seed| filter(scene, seed);

    // Name, what is estimated, whether all of the light, and the bias that is allowed.
    let rows = [
        ("ris", "direct light, 8 candidates, 1 shadow ray", false, 0.0, ris),
        ("qmc-sampling", "direct light, solid angle, Owen-Sobol", false, 0.0, qmc),
        ("mis-heuristics", "path tracing, next event estimation", true, 0.0, mis),
        ("path-space-filter", "averages of its first vertices", true, 0.01, filtered),
        ("photon-map", "density of all photons", true, 0.03, photons),
        ("vpl-gi", "robust instant global illumination", true, 0.0, vpl),
    ];
    println!(
        "{:<18} {:<42} {:>8} {:>10} {:>8} {:>9} {:>6}",
        "crate", "computed", "error, %", "std. error", "allowed", "pixels, %", "glue"
    );
    let mut is_good = true;
    for (name, what, is_all, bias, estimator) in rows {
        let (truth, estimate) = (&truths[usize::from(is_all)], repeat(estimator)?);
        let error = estimate.mean / truth.mean - 1.0;
        let standard_error = estimate.standard_error.hypot(truth.standard_error) / truth.mean;
        let allowed = bias + STANDARD_ERRORS * standard_error;
        let squares = estimate.image.iter().zip(&truth.image).map(|(a, b)| (a.mean() - b.mean()).powi(2));
        let pixels = (squares.sum::<f64>() / PIXELS as f64).sqrt() / truth.mean;
        println!(
            "{name:<18} {what:<42} {:>+8.2} {:>10.2} {:>8.2} {:>9.1} {:>6}",
            100.0 * error,
            100.0 * standard_error,
            100.0 * allowed,
            100.0 * pixels,
            glue_lines(name)
        );
        // NaN is off; and no lines are no marker.
        is_good &= error.abs() <= allowed && glue_lines(name) > 0;
    }
    println!(
        "{:<18} {:<42} {:>48}\n",
        "(arrays, shared)",
        "own vectors to arrays and back",
        glue_lines("(arrays, shared)")
    );

    is_good &= laws::laws(scene, &vertices(scene, 5)?)?;
    if is_good { Ok(()) } else { Err("an estimate is off, or a law is broken".into()) }
}
