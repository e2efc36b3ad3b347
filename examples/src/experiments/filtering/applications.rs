//! Figure 6: ambient occlusion, shadows, indirect light, thin geometry, translucency, several cameras.

use glam::Vec3A;
use qmc_sampling::{Independent, Replications};
use scene_core::builtin::Builtin;
use scene_core::film::LayeredImage;
use scene_core::{ReferenceScene, RussianRoulette, Scene};

use super::{Report, Variant, at_least, gain, run};
use crate::choices::{AnyChoice, AnyHeuristic, LightSelection};
use crate::estimators::{FirstEvent, NextEvent, OwnSampling, PathTracer};
use crate::experiments::{Context, Setup, ratio_of_means};
use crate::filtering::{View, render_views};
use crate::filters::{FilterSettings, PathFilterName};
use crate::metrics::{ImagePair, relative_mse};
use crate::program::{EstimatorName, Failure};

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

/// Error of the input over that of the filtered image for each application; for several cameras error of each on its own over that of all together.
pub(in crate::experiments) fn measure(context: &Context) -> Result<Report, Failure> {
    let mut report = context.report();
    for (application, scene, estimator) in APPLICATIONS {
        let mut setup = Setup::builtin(context, scene, context.effort([96, 72], [320, 240]))?;
        setup.settings.estimator = match estimator {
            // Light paths are no part of the truth.
            EstimatorName::RobustIgi => EstimatorName::Path,
            estimator => estimator,
        };
        let reference = setup.reference(context, context.effort(512, 2048))?;
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
    cameras(context, &mut report)?;
    Ok(report)
}

/// Cameras side by side.
const CAMERAS: usize = 4;

/// Four cameras that move to the side: each on its own, and all together.
fn cameras(context: &Context, report: &mut Report) -> Result<(), Failure> {
    let [width, height] = context.effort([96, 72], [320, 240]);
    let builtin = Builtin::named("office").ok_or("no office")?;
    let mut setups = Vec::new();
    for number in 0..CAMERAS {
        let mut description = builtin.description();
        (description.camera.width, description.camera.height) = (width, height);
        // 6.5 cm to the right each, as two eyes are.
        let right = description.camera.to_world.matrix3.x_axis;
        description.camera.to_world.translation += right.normalize_or(Vec3A::X) * (0.065 * number as f32);
        setups.push(ReferenceScene::new(description)?);
    }
    let path = |scene: &ReferenceScene| PathTracer {
        direct: NextEvent {
            heuristic: AnyHeuristic::Power,
            choice: AnyChoice::new(LightSelection::Power, scene.emitters()),
        },
        scattering: OwnSampling,
        max_depth: u32::MAX,
        roulette: RussianRoulette::PathThroughput { from_length: 4 },
        first_event: FirstEvent::Any,
    };
    let tracers: Vec<_> = setups.iter().map(path).collect();
    let views: Vec<_> =
        setups.iter().zip(&tracers).map(|(scene, estimator)| View { scene, estimator, time: 0.0 }).collect();
    let settings = FilterSettings::default();
    let filter = settings.filter(PathFilterName::Psf, setups[0].sensor())?;
    let selection = settings.selection()?;
    let render = |views: &[View<'_, _, _>], seed: u64, batches: u64, samples: u64, far: bool| {
        let filter = if far {
            filter
        } else {
            FilterSettings { filter_length: Some(0.0), ..settings.clone() }
                .filter(PathFilterName::Psf, setups[0].sensor())?
        };
        let (films, _) = render_views(views, &Independent::new(seed), &filter, selection, 0..batches, samples)?;
        Ok::<Vec<LayeredImage>, Failure>(films.iter().map(|film| film.develop(0)).collect())
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(context.threads).build()?;
    let (mut alone, mut together) = (Replications::new(), Replications::new());
    pool.install(|| {
        let truth = render(&views[..1], context.seed_of("cameras reference", 0), context.effort(128, 1024), 4, false)?;
        for trial in 0..context.effort(3, 6) {
            let error =
                |image: &LayeredImage| Ok::<f64, Failure>(relative_mse(&ImagePair::of_images(image, &truth[0])?));
            let one = render(&views[..1], context.seed_of("one camera", trial), 1, SAMPLES, true)?;
            alone.push(error(&one[0])?);
            let all = render(&views, context.seed_of("all cameras", trial), 1, SAMPLES, true)?;
            together.push(error(&all[0])?);
        }
        Ok::<(), Failure>(())
    })?;
    report.claims.push(at_least("gain-of-four-cameras-over-one", ratio_of_means(&alone, &together), 1.0));
    Ok(())
}
