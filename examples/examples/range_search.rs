//! Neighbours of a hundred thousand points on a sphere: an index of `range-search` beside brute force.
//!
//! Each point carries a noisy value; the mean over its neighbours is less noisy. Whatever the index, the neighbours are the same.
//!
//! Run with `cargo run --release --example range_search`.
#![allow(clippy::print_stdout)]

use qmc_sampling::{Independent, Sampler, SamplerFamily};
use range_search::{BruteForce, HashGrid, Neighbour, RangeIndex};

/// Points on the sphere.
const POINTS: u64 = 100_000;
/// About 50 neighbours: the share of the sphere in a ball of radius `r` around one of its points is `r^2 / 4`.
const RADIUS: f32 = 0.045;
/// Points compared with brute force.
const COMPARED: usize = 200;

/// What a renderer would have here: a photon, or the vertex of a path.
struct Vertex {
    position: [f32; 3],
    value: f32,
}

/// A vertex on the unit sphere, whose value is its height and noise.
fn vertex(index: u64) -> Vertex {
    let mut numbers = Independent::new(3).sampler(0, index);
    let height = 2.0 * numbers.next_1d() - 1.0;
    let angle = 2.0 * std::f32::consts::PI * numbers.next_1d();
    let radius = (1.0 - height * height).max(0.0).sqrt();
    let value = height + 2.0 * numbers.next_1d() - 1.0;
    Vertex { position: [radius * angle.cos(), radius * angle.sin(), height], value }
}

/// Root of the mean squared difference of values from heights.
fn error(vertices: &[Vertex], values: &[f32]) -> f64 {
    let squares = vertices.iter().zip(values).map(|(vertex, value)| f64::from(vertex.position[2] - value).powi(2));
    (squares.sum::<f64>() / vertices.len() as f64).sqrt()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let vertices: Vec<Vertex> = (0..POINTS).map(vertex).collect();
    let grid = HashGrid::build(&vertices, |vertex| vertex.position, RADIUS)?;
    let brute_force = BruteForce::build(&vertices, |vertex| vertex.position)?;

    // 1. Ask around some of the points, and compare.
    let (mut within, mut nearest, mut differ) = (0, 0, 0);
    let (mut ours, mut theirs): (Vec<Neighbour>, Vec<Neighbour>) = (Vec::new(), Vec::new());
    for vertex in vertices.iter().take(COMPARED) {
        let found = grid.within(vertex.position, RADIUS);
        within += found.len();
        differ += usize::from(found != brute_force.within(vertex.position, RADIUS));

        grid.k_nearest(vertex.position, 10, f32::INFINITY, &mut ours);
        brute_force.k_nearest(vertex.position, 10, f32::INFINITY, &mut theirs);
        nearest += ours.len();
        differ += usize::from(ours != theirs);
    }
    println!("{COMPARED} points: {:.1} neighbours each, of the nearest ten {nearest}", within as f64 / COMPARED as f64);
    println!("answers that differ from brute force: {differ}");

    // 2. Ask around all points at once, with what they carry in the grid's order.
    let values: Vec<f32> = vertices.iter().map(|vertex| vertex.value).collect();
    let sorted = grid.reorder(&values);
    let means = grid.self_query(RADIUS).map(|neighbourhood| {
        let sum: f32 = neighbourhood.slots().iter().map(|&slot| sorted[slot as usize]).sum();
        sum / neighbourhood.len() as f32
    });
    let mut filtered = values.clone();
    grid.restore(&means, &mut filtered);

    // 3. The same by brute force, for some of them.
    let mut farthest = 0.0_f32;
    for (vertex, filtered) in vertices.iter().zip(&filtered).take(COMPARED) {
        let (mut sum, mut count) = (0.0, 0);
        brute_force.for_each_within(vertex.position, RADIUS, |id, _| {
            sum += vertices[id].value;
            count += 1;
        });
        farthest = farthest.max((filtered - sum / count as f32).abs());
    }
    println!("error of the values {:.4}, of the means {:.4}", error(&vertices, &values), error(&vertices, &filtered));
    println!("means differ from those of brute force by {farthest:.1e}, for the order of summation");
    if differ > 0 || farthest > 1e-5 {
        return Err("the grid and brute force do not agree".into());
    }
    Ok(())
}
