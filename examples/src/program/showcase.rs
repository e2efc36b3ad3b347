//! `lichtwerk` without a subcommand.

use std::ops::ControlFlow;

use scene_core::builtin;
use scene_core::film::LayeredImage;
use scene_core::{ReferenceScene, Scene, Sensor};

use super::render::{EstimatorName, RenderSettings, render_to_image};
use super::{Failure, ShowcaseArguments, print};
use crate::output::{Progress, check_writable, save_image};
use crate::render::{Budget, Rendering};

/// How many samples of path tracing take as long as one of robust instant global illumination, about.
const ROBUST_SAMPLE_COST: u64 = 12;

/// Renders the builtin office by path tracing and by robust instant global illumination, in about the same time, and prints what each cost.
pub(super) fn run(arguments: &ShowcaseArguments) -> Result<(), Failure> {
    let mut description = builtin::office();
    if let Some([width, height]) = arguments.size {
        (description.camera.width, description.camera.height) = (width, height);
    }
    let scene = ReferenceScene::new(description)?;
    std::fs::create_dir_all(&arguments.out)
        .map_err(|error| format!("cannot create {}: {error}", arguments.out.display()))?;
    // A sample that is connected to many light paths costs as much as several of path tracing.
    let fewer = arguments.spp.div_ceil(ROBUST_SAMPLE_COST);
    let runs = [
        ("path", EstimatorName::Path, arguments.spp),
        ("robust-igi", EstimatorName::RobustIgi, fewer.max(2).min(arguments.spp)),
    ];
    let file = |name: &str, extension: &str| arguments.out.join(format!("{}-{name}.{extension}", scene.name()));
    for (name, ..) in runs {
        check_writable(&file(name, "exr"))?;
    }

    let [width, height] = scene.sensor().resolution();
    let mut table = format!(
        "{}: {} triangles, {} emitters, {width} x {height} pixels\n\n\
         estimator    samples    seconds       rays  Mrays/s  error %  efficiency\n",
        scene.name(),
        scene.triangle_count(),
        scene.emitters().len(),
    );
    for (name, estimator, samples) in runs {
        let settings =
            RenderSettings { estimator, threads: arguments.threads, ..RenderSettings::new(Budget::Samples(samples)) };
        let progress = Progress::counting(samples, "samples per pixel");
        let (image, rendering) = render_to_image(&scene, &settings, |pass| {
            progress.add(pass.samples - progress.done());
            ControlFlow::Continue(())
        })?;
        progress.finish();
        save_image(&file(name, "exr"), &image, 0.0)?;
        save_image(&file(name, "png"), &image, 0.0)?;
        table += &row(name, &image, &rendering);
    }
    table += &format!(
        "\nerror: relative standard error of a pixel, root mean square over the image, from its own samples\n\
         efficiency: 1 / (error^2 * seconds), with the error as a fraction\n\
         images: {} and the same names with .exr",
        runs.map(|(name, ..)| file(name, "png").display().to_string()).join(", "),
    );
    print(&table)
}

fn row(name: &str, image: &LayeredImage, rendering: &Rendering) -> String {
    let error = relative_standard_error(image);
    let rays = rendering.rays.total() as f64;
    format!(
        "{name:<11} {:>8} {:>10.2} {:>10.3e} {:>8.2} {:>8.2} {:>11.3}\n",
        rendering.samples,
        rendering.seconds,
        rays,
        rays / rendering.seconds / 1e6,
        100.0 * error,
        1.0 / (error * error * rendering.seconds),
    )
}

/// Root mean square over pixels and channels of the standard error of the mean over the value, with the usual
/// regularisation: `sqrt(mean(variance / (value^2 + 0.01)))`.
pub(super) fn relative_standard_error(image: &LayeredImage) -> f64 {
    let channels = [("R", "Variance.R"), ("G", "Variance.G"), ("B", "Variance.B")];
    let (mut sum, mut count) = (0.0, 0u64);
    for (value, variance) in channels {
        let (Some(values), Some(variances)) = (image.channel(value), image.channel(variance)) else { continue };
        for (&x, &v) in values.iter().zip(variances).filter(|(_, v)| v.is_finite()) {
            sum += f64::from(v) / (f64::from(x) * f64::from(x) + 0.01);
            count += 1;
        }
    }
    if count > 0 { (sum / count as f64).sqrt() } else { f64::NAN }
}
