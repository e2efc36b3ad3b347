//! Batches of vertices, and equation 1 by its definition.

#![allow(dead_code, unreachable_pub, reason = "each test uses its part of it")]

use path_space_filter::{Averages, Vertex};

/// Vertices with RGB contributions.
pub type Rgb = Vertex<[f32; 3]>;

/// Numbers in [0, 1) for tests that need no statistics.
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u64 << 24) as f32
    }

    pub fn direction(&mut self) -> [f32; 3] {
        let (z, angle) = (2.0 * self.next() - 1.0, std::f32::consts::TAU * self.next());
        let r = (1.0 - z * z).max(0.0).sqrt();
        [r * angle.cos(), r * angle.sin(), z]
    }
}

/// Vertices in the unit cube, with few different normals, colours, and so on, so that every weight includes some of them and not all.
pub fn vertices(count: usize, seed: u64) -> Vec<Rgb> {
    let mut numbers = Numbers(seed);
    let directions: Vec<_> = (0..5).map(|_| numbers.direction()).collect();
    let mut vertex = || {
        let pick = |n: usize, u: f32| ((u * n as f32) as usize).min(n - 1);
        let tilt = |d: [f32; 3], e: [f32; 3]| {
            let v: [f32; 3] = std::array::from_fn(|k| d[k] + 0.2 * e[k]);
            let length = v.iter().map(|x| x * x).sum::<f32>().sqrt();
            v.map(|x| x / length)
        };
        Vertex {
            position: [numbers.next(), numbers.next(), numbers.next()],
            normal: tilt(directions[pick(5, numbers.next())], numbers.direction()),
            albedo: [0.2 + 0.1 * numbers.next(), 0.5, 0.7 * numbers.next()],
            view_direction: tilt(directions[pick(5, numbers.next())], numbers.direction()),
            pixel: [pick(16, numbers.next()) as u32, pick(16, numbers.next()) as u32],
            path_length: 0.5 + 4.0 * numbers.next() * numbers.next(),
            hit_distance: if numbers.next() < 0.3 { f32::INFINITY } else { numbers.next() },
            time: numbers.next(),
            object: pick(3, numbers.next()) as u32,
            visibility: pick(4, numbers.next()) as u32,
            contribution: [numbers.next(), 10.0 * numbers.next().powi(8), 0.0],
        }
    };
    (0..count).map(|_| vertex()).collect()
}

pub fn distance_squared(a: &Rgb, b: &Rgb) -> f32 {
    range_search::distance_squared(b.position, a.position)
}

/// Equation 1: all pairs, in `f64`.
pub fn equation_1(
    vertices: &[Rgb],
    radius: impl Fn(&Rgb) -> f32,
    weight: impl Fn(&Rgb, &Rgb, f32) -> f64,
) -> Vec<[f64; 3]> {
    let mean = |i: &Rgb| {
        let (mut sum, mut total) = ([0.0; 3], 0.0);
        let r = radius(i);
        for j in vertices {
            let d2 = distance_squared(i, j);
            if d2 <= r * r {
                let w = weight(i, j, d2 / (r * r));
                total += w;
                (0..3).for_each(|k| sum[k] += w * f64::from(j.contribution[k]));
            }
        }
        sum.map(|s| s / total)
    };
    vertices.iter().map(mean).collect()
}

pub fn assert_close(found: &Averages<[f32; 3]>, expected: &[[f64; 3]], what: &str) {
    assert_eq!(found.values().len(), expected.len());
    for (i, (found, expected)) in found.values().iter().zip(expected).enumerate() {
        for k in 0..3 {
            let difference = (f64::from(found[k]) - expected[k]).abs();
            assert!(difference <= 2e-5 * (1e-3 + expected[k].abs()), "{what}, {i}: {found:?}, not {expected:?}");
        }
    }
}
