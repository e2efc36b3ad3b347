//! Figure 4: what each similarity weight gains.

use scene_core::reference::Light;
use scene_core::{Rgb, builtin};

use super::{Report, Row, Variant, at_least, gain, reported, run};
use crate::experiments::{Context, Setup};
use crate::filters::FilterSettings;
use crate::program::Failure;

/// In the interior with its textures, and in a Cornell box with a point light, whose shadows are sharp: weights one after the other, as in the figure.
pub(in crate::experiments) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    let trials = context.effort(3, 8);
    for name in ["interior", "cornell-box-point"] {
        let setup = match name {
            "interior" => Setup::builtin(context, name, context.effort([120, 90], [320, 240]))?,
            _ => point_light(context, context.effort([96, 96], [256, 256]))?,
        };
        let reference = setup.reference(context, context.effort(768, 4096))?;
        // A large radius, so that there is something to keep apart.
        let uniform = FilterSettings {
            filter_radius: 8.0,
            filter_normals: -1.0,
            filter_as_stored: true,
            filter_batch: Some(16),
            ..FilterSettings::default()
        };
        let normals = FilterSettings { filter_normals: 0.95, ..uniform.clone() };
        let albedo = FilterSettings { filter_albedo: Some(0.05), ..normals.clone() };
        let demodulated = FilterSettings { filter_as_stored: false, ..normals.clone() };
        let visibility = FilterSettings { filter_visibility: true, ..albedo.clone() };
        let mut variants = [
            Variant::new("input", setup.settings.clone()),
            Variant::filtered("uniform", &setup, uniform),
            Variant::filtered("normals", &setup, normals),
            Variant::filtered("normals-albedo", &setup, albedo),
            Variant::filtered("normals-demodulated", &setup, demodulated),
            Variant::filtered("normals-albedo-visibility", &setup, visibility),
        ];
        run(context, &setup, &reference, &mut variants, 16, trials)?;
        let rows: Vec<Row> = variants.iter().map(|variant| variant.row(&setup, 16)).collect();
        report.rows.extend(rows);
        let [input, uniform, normals, albedo, demodulated, visibility] = &variants;
        let gained = |better: &Variant, worse: &Variant| gain(&better.trials, &worse.trials);
        let id = |what: &str| format!("{name}-gain-of-{what}");
        report.claims.push(at_least(id("normals"), gained(normals, uniform), 1.0));
        if name == "interior" {
            report.claims.push(at_least(id("albedo"), gained(albedo, normals), 1.0));
            report.claims.push(at_least(id("demodulation"), gained(demodulated, normals), 1.0));
        } else {
            // Walls of one colour: nothing to be gained there.
            report.claims.push(reported(id("albedo"), gained(albedo, normals)));
            report.claims.push(at_least(id("visibility"), gained(visibility, albedo), 1.0));
        }
        report.claims.push(at_least(format!("{name}-gain-over-the-input"), gained(visibility, input), 1.0));
    }
    Ok(report)
}

/// The Cornell box with a point light beside its lamp.
fn point_light(context: &Context, size: [u32; 2]) -> Result<Setup, Failure> {
    let mut description = builtin::cornell_box();
    description.name = "cornell-box-point".to_owned();
    let position = glam::Vec3A::new(0.12, 0.45, 0.12);
    description.lights.push(Light::Point { position, intensity: Rgb::splat(0.5) });
    Setup::of(context, description, size)
}
