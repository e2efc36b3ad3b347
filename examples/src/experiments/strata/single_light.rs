//! Figure 2: the weight of one point light over a plane, in four variants.

use scene_core::film::LayeredImage;
use scene_core::glam::Vec3A;
use vpl_gi::{Partition, geometry_term};

use crate::experiments::claims::at_most;
use crate::experiments::{Context, Ratio, Report, Row};
use crate::light_paths::PartitionName;
use crate::program::Failure;

/// The paper's threshold, in 1/length^2.
const THRESHOLD: f32 = 0.5;
/// Height of the light over the plane, and half the side of the square that is shown.
const HEIGHT: f32 = 0.7;
const HALF_SIDE: f32 = 4.0;

/// The geometry term of a point light that faces a plane, times its share, over the plane.
struct Variant {
    values: Vec<f32>,
    /// What is left of the integral.
    kept: f64,
    largest: f32,
}

impl Variant {
    fn new(side: usize, partition: Partition) -> Self {
        let light = Vec3A::new(0.0, HEIGHT, 0.0);
        let (mut all, mut kept) = (0.0, 0.0);
        let values: Vec<f32> = (0..side * side)
            .map(|pixel| {
                let at = |k: usize| HALF_SIDE * (2.0 * (k as f32 + 0.5) / side as f32 - 1.0);
                let x = Vec3A::new(at(pixel % side), 0.0, at(pixel / side));
                let g = geometry_term(x, Vec3A::Y, light, -Vec3A::Y);
                let value = g * partition.share(g, x.distance_squared(light));
                all += f64::from(g);
                kept += f64::from(value);
                value
            })
            .collect();
        let largest = values.iter().copied().fold(0.0, f32::max);
        Self { values, kept: kept / all, largest }
    }
}

/// Pictures `figure-2-VARIANT.png`, the part of the integral that point lights keep, and the largest value.
pub(super) fn measure(context: &Context, report: &mut Report) -> Result<(), Failure> {
    let side = 160;
    for (name, label) in [
        (PartitionName::Soft, "a-clipped"),
        (PartitionName::Balance, "b-balance"),
        (PartitionName::Distance, "c-distance"),
        (PartitionName::Hard, "d-geometry-term"),
    ] {
        let variant = Variant::new(side, name.partition(THRESHOLD)?);
        let mut image = LayeredImage::new(side as u32, side as u32)?;
        image.set_rgb(&variant.values.iter().map(|&value| [value / THRESHOLD; 3]).collect::<Vec<_>>())?;
        context.save_picture(&format!("figure-2-{label}"), &image, 0.0)?;
        let params =
            [("figure", 2.into()), ("kept", variant.kept.into()), ("largest", f64::from(variant.largest).into())];
        report.rows.push(Row::new("point light over a plane", label, params));
        // The weak singularity is gone: whatever the form, no light contributes more than the threshold, except that a
        // distance alone says nothing about the cosines, which only make it less.
        let largest = f64::from(variant.largest);
        let largest = Ratio { value: largest, ci95: [largest; 2] };
        report.claims.push(at_most(format!("figure-2-{label}-is-bounded"), largest, f64::from(THRESHOLD)));
    }
    Ok(())
}
