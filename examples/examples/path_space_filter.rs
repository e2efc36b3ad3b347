//! Shadows of a lamp on a floor with tiles, at one shadow ray per vertex: `path-space-filter` beside the input, batch by batch.
//!
//! Run with `cargo run --release --example path_space_filter`.
#![allow(clippy::print_stdout)]

use path_space_filter::{Batches, Demodulated, JitteredHash, NormalCone, PathFilter, PathSpaceFilter, Radius, Vertex};
use qmc_sampling::{OwenSobol, Sampler, SamplerFamily};

/// Pixels of a side of the image, which shows a floor of 1 x 1 m from above.
const SIDE: usize = 64;
/// Samples per pixel of a batch, and batches.
const SAMPLES: u64 = 4;
const BATCHES: u64 = 16;

/// Tiles of two colours.
fn albedo(x: f32, y: f32) -> [f32; 3] {
    let odd = ((x * 8.0) as i32 + (y * 8.0) as i32) % 2 == 1;
    if odd { [0.8, 0.6, 0.4] } else { [0.2, 0.2, 0.3] }
}

/// Which part of a lamp, 0.4 m long, a place sees past the edge of a table in between; a shadow ray goes to `lamp`.
fn sees(x: f32, lamp: f32) -> bool {
    0.5 * (x + 0.3 + 0.4 * lamp) > 0.5
}

/// The truth in a pixel: the mean over places and over the lamp.
fn truth(pixel: usize) -> [f64; 3] {
    const FINE: usize = 24;
    let (mut sum, per_pixel) = ([0.0; 3], FINE * FINE * FINE);
    for i in 0..per_pixel {
        let at = |k: usize| (k as f32 + 0.5) / FINE as f32;
        let x = ((pixel % SIDE) as f32 + at(i % FINE)) / SIDE as f32;
        let y = ((pixel / SIDE) as f32 + at(i / FINE % FINE)) / SIDE as f32;
        if sees(x, at(i / FINE / FINE)) {
            (0..3).for_each(|k| sum[k] += f64::from(albedo(x, y)[k]) / per_pixel as f64);
        }
    }
    sum
}

/// The vertices of sample number `index` of all pixels.
fn vertices(index: u64) -> impl Iterator<Item = Vertex<[f32; 3]>> {
    let samplers = OwenSobol::new(5);
    (0..SIDE * SIDE).map(move |pixel| {
        let mut numbers = samplers.sampler(pixel as u64, index);
        let [u, v] = numbers.next_2d();
        let (x, y) = (((pixel % SIDE) as f32 + u) / SIDE as f32, ((pixel / SIDE) as f32 + v) / SIDE as f32);
        let (albedo, lit) = (albedo(x, y), sees(x, numbers.next_1d()));
        Vertex {
            position: [x, y, 0.0],
            normal: [0.0, 0.0, 1.0],
            albedo,
            contribution: if lit { albedo } else { [0.0; 3] },
            path_length: 1.0,
            ..Vertex::default()
        }
    })
}

/// An image: sums over the samples of each pixel.
struct Image(Vec<[f64; 3]>);

impl Image {
    fn add(&mut self, contributions: impl IntoIterator<Item = [f32; 3]>) {
        for (i, contribution) in contributions.into_iter().enumerate() {
            let pixel = &mut self.0[i % (SIDE * SIDE)];
            (0..3).for_each(|k| pixel[k] += f64::from(contribution[k]));
        }
    }

    /// Mean squared error after so many samples per pixel.
    fn error(&self, truth: &[[f64; 3]], samples: u64) -> f64 {
        let of = |(pixel, truth): (&[f64; 3], &[f64; 3])| {
            (0..3).map(|k| (pixel[k] / samples as f64 - truth[k]).powi(2)).sum::<f64>() / 3.0
        };
        self.0.iter().zip(truth).map(of).sum::<f64>() / truth.len() as f64
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let truth: Vec<[f64; 3]> = (0..SIDE * SIDE).map(truth).collect();
    // A disk as large as 5 x 5 pixels, in the first batch.
    let radius = Radius::absolute(5.0 / SIDE as f32 / std::f32::consts::PI.sqrt())?;
    let search = PathSpaceFilter::new(radius).similarity(NormalCone::PAPER).modulation(Demodulated::default());
    let hash = JitteredHash::new(radius).modulation(Demodulated::default());

    let mut images = [0, 1, 2].map(|_| Image(vec![[0.0; 3]; SIDE * SIDE]));
    let mut batches = Batches::new(2, ((SIDE * SIDE) as u64 * SAMPLES).ilog2())?;
    println!(
        "{:>9} {:>10} {:>12} {:>10} {:>10} {:>10}",
        "samples", "averaged", "error: input", "search", "hash", "gain"
    );
    for _ in 0..BATCHES {
        let batch = batches.next_batch();
        let first = (batch.number - 1) * SAMPLES;
        let vertices: Vec<_> = (first..first + SAMPLES).flat_map(vertices).collect();
        let averages = search.average(&vertices, batch.number);
        let averaged = averages.mean_count();
        images[0].add(vertices.iter().map(|vertex| vertex.contribution));
        images[1].add(averages);
        images[2].add(hash.average(&vertices, batch.number));

        let samples = batch.number * SAMPLES;
        if samples.is_power_of_two() {
            let [input, search, hash] = [0, 1, 2].map(|i| images[i].error(&truth, samples));
            let gain = input / search;
            println!("{samples:>9} {averaged:>10.1} {input:>12.2e} {search:>10.2e} {hash:>10.2e} {gain:>10.1}");
        }
    }
    Ok(())
}
