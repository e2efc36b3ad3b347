//! Figure 6: ambient occlusion, shadows, indirect light, thin geometry, translucency, several cameras.

use std::ops::ControlFlow;

use qmc_sampling::{Independent, Replications};
use scene_core::builtin::Builtin;
use scene_core::film::LayeredImage;
use scene_core::{Scene, SceneDescription};

use super::{Report, Variant, at_least, gain, run};
use crate::experiments::{Context, Setup, ratio_of_means};
use crate::filtering::{View, render_views};
use crate::filters::{FilterSettings, PathFilterName};
use crate::metrics::{ImagePair, relative_mse};
use crate::program::{EstimatorName, Failure};
use crate::render::thread_pool;

/// What is filtered, in which scene, by which estimator.
const APPLICATIONS: [(&str, &str, EstimatorName); 6] = [
    ("ambient-occlusion", "interior", EstimatorName::Ao),
    ("shadows", "lantern-field", EstimatorName::Direct),
    ("indirect-light", "office", EstimatorName::Path),
    ("virtual-lights", "office", EstimatorName::RobustIgi),
    ("thin-geometry", "foliage", EstimatorName::Path),
    ("translucency", "translucent-blob", EstimatorName::Path),
];

/// Samples per pixel.
const SAMPLES: u64 = 8;

/// Renderings with many samples, one for each scene and estimator. Of the error of filtered images at [`SAMPLES`] their noise is a twentieth or less.
#[derive(Default)]
struct References(Vec<(String, EstimatorName, LayeredImage)>);

impl References {
    fn of(&mut self, context: &Context, setup: &Setup) -> Result<LayeredImage, Failure> {
        let (scene, estimator) = (setup.scene.name(), setup.settings.estimator);
        if let Some((_, _, image)) = self.0.iter().find(|(of, by, _)| of == scene && *by == estimator) {
            return Ok(image.clone());
        }
        let image = setup.reference(context, context.effort(512, 1024))?;
        self.0.push((scene.to_owned(), estimator, image.clone()));
        Ok(image)
    }
}

fn size(context: &Context) -> [u32; 2] {
    context.effort([96, 72], [240, 180])
}

/// Error of the input over that of the filtered image for each application; for several cameras error of each on its own over that of all together.
pub(in crate::experiments) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    let mut references = References::default();
    for (application, scene, estimator) in APPLICATIONS {
        let mut setup = Setup::builtin(context, scene, size(context))?;
        setup.settings.estimator = match estimator {
            // Light paths are no part of the truth.
            EstimatorName::RobustIgi => EstimatorName::Path,
            estimator => estimator,
        };
        let reference = references.of(context, &setup)?;
        setup.settings.estimator = estimator;
        let mut variants = [
            Variant::new("input", setup.settings.clone()),
            Variant::filtered("psf", &setup, FilterSettings::default()),
        ];
        run(context, &setup, &reference, &mut variants, SAMPLES, context.effort(2, 6))?;
        report.rows.extend(variants.iter().map(|variant| variant.row(&setup, SAMPLES)));
        let [input, psf] = &variants;
        report.claims.push(at_least(format!("gain-{application}"), gain(&psf.trials, &input.trials), 1.0));
    }
    cameras(context, &mut references, &mut report)?;
    Ok(report)
}

/// Cameras side by side.
const CAMERAS: usize = 4;

/// Four cameras that move to the side: the first on its own, and with all together.
fn cameras(context: &Context, references: &mut References, report: &mut Report) -> Result<(), Failure> {
    let description = Builtin::named("office").ok_or("no office")?.description();
    let mut setups = Vec::new();
    for number in 0..CAMERAS {
        // 6.5 cm to the right each, as two eyes are; the first is the office's own.
        let camera = description.camera.moved_right(0.065 * number as f32);
        let moved = SceneDescription { camera, ..description.clone() };
        setups.push(Setup::of(context, moved, size(context))?);
    }
    let [first, ..] = &setups[..] else { return Err("no cameras".into()) };
    let reference = references.of(context, first)?;
    let tracers: Vec<_> = setups.iter().map(|setup| setup.settings.path_tracer(&setup.scene)).collect();
    let pairs = setups.iter().zip(&tracers);
    let views: Vec<_> = pairs.map(|(setup, estimator)| View { scene: &setup.scene, estimator, time: 0.0 }).collect();
    let settings = FilterSettings::default();
    let filter = settings.filter(PathFilterName::Psf, first.scene.sensor())?;
    let selection = settings.selection()?;
    let error = |views: &[View<'_, _, _>], seed: u64| {
        let samplers = Independent::new(seed);
        let goes_on = &mut |_| ControlFlow::Continue(());
        let (films, _) = render_views(views, &samplers, &filter, selection, 0..1, SAMPLES, goes_on)?;
        Ok::<f64, Failure>(relative_mse(&ImagePair::of_images(&films[0].develop(0), &reference)?))
    };
    let (mut alone, mut together) = (Replications::new(), Replications::new());
    thread_pool(context.threads)?.install(|| {
        for trial in 0..context.effort(3, 6) {
            alone.push(error(&views[..1], context.seed_of("one camera", trial))?);
            together.push(error(&views, context.seed_of("all cameras", trial))?);
        }
        Ok::<(), Failure>(())
    })?;
    report.claims.push(at_least("gain-of-four-cameras-over-one", ratio_of_means(&alone, &together), 1.0));
    Ok(())
}
