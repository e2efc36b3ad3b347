//! Samples, densities and values against quadrature over the sphere.

use scene_core::TransportMode;
use scene_core::glam::Vec3A;
use scene_core::material::Bsdf;

use crate::cases::{self, compiled};
use crate::laws::{cube, direction};

/// Cells of the sphere, in equal steps of the cosine and of the azimuth.
const ROWS: usize = 12;
const COLUMNS: usize = 16;

fn cell(w: Vec3A) -> usize {
    let row = ((0.5 * (w.z + 1.0) * ROWS as f32) as usize).min(ROWS - 1);
    let turn = w.y.atan2(w.x) / std::f32::consts::TAU;
    let column = (((turn - turn.floor()) * COLUMNS as f32) as usize).min(COLUMNS - 1);
    row * COLUMNS + column
}

struct Measured {
    /// Per cell: integral of the density, of the red value.
    pdf: Vec<f64>,
    value: Vec<f64>,
}

/// Midpoint rule inside of the cells, twice as fine in the cosine near the horizon through a square root.
fn integrate(bsdf: &Bsdf<'_>, wo: Vec3A, mode: TransportMode) -> Measured {
    let (n_cos, n_phi) = (ROWS * 40, COLUMNS * 30);
    let mut measured = Measured { pdf: vec![0.0; ROWS * COLUMNS], value: vec![0.0; ROWS * COLUMNS] };
    for i in 0..n_cos {
        let z = 2.0 * (i as f32 + 0.5) / n_cos as f32 - 1.0;
        for j in 0..n_phi {
            let wi = direction(z, (j as f32 + 0.5) / n_phi as f32);
            let (value, pdf) = bsdf.eval_pdf(wo, wi, mode);
            let at = cell(wi);
            measured.pdf[at] += f64::from(pdf);
            measured.value[at] += f64::from(value[0]);
        }
    }
    let area = 2.0 / n_cos as f64 * std::f64::consts::TAU / n_phi as f64;
    measured.pdf.iter_mut().chain(&mut measured.value).for_each(|x| *x *= area);
    measured
}

#[test]
fn samples_follow_the_density_and_estimate_the_value() {
    for name in cases::SCATTERING {
        // Too peaked for these cells: `microfacet` tests their distributions.
        if ["0.05", "-0.1", "aniso"].iter().any(|s| name.ends_with(s)) && name != "roughconductor-beckmann-aniso" {
            continue;
        }
        let material = compiled(name);
        let bsdf = material.resolve([0.3, 0.4]);
        for (cos, mode) in [(0.9, 0), (0.4, 1), (-0.6, 0), (-0.15, 1)] {
            let mode = [TransportMode::Radiance, TransportMode::Importance][mode];
            let wo = direction(cos, 0.2);
            let expected = integrate(&bsdf, wo, mode);
            let n = 100_000;
            let mut found = Measured { pdf: vec![0.0; ROWS * COLUMNS], value: vec![0.0; ROWS * COLUMNS] };
            for sample in (0..n).filter_map(|i| bsdf.sample(wo, cube(i), mode)).filter(|s| !s.is_specular) {
                found.pdf[cell(sample.wi)] += 1.0 / n as f64;
                found.value[cell(sample.wi)] += f64::from(sample.throughput[0]) / n as f64;
            }
            let total: f64 = expected.pdf.iter().sum();
            assert!(total <= 1.003, "{name} {cos}: the density integrates to {total}");
            for (what, found, expected) in
                [("pdf", &found.pdf, &expected.pdf), ("value", &found.value, &expected.value)]
            {
                let total: (f64, f64) = (found.iter().sum(), expected.iter().sum());
                assert!((total.0 - total.1).abs() < 2e-3, "{name} {cos} {what}: {total:?}");
                for at in 0..ROWS * COLUMNS {
                    let error = (found[at] - expected[at]).abs();
                    assert!(error < 2.5e-3, "{name} {cos} {what} in {at}: {} {}", found[at], expected[at]);
                }
            }
        }
    }
}
