//! Path space filtering of whole renderings.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::ops::ControlFlow;

use estimator_checks::{Suite, slope_at_most};
use lichtwerk::choices::AnyHeuristic;
use lichtwerk::estimators::AmbientOcclusion;
use lichtwerk::filtering::{Selection, View, bake, render_views};
use lichtwerk::filters::{FilterSettings, PathFilterName};
use lichtwerk::metrics::{ImagePair, relative_mse};
use lichtwerk::program::{EstimatorName, RenderSettings, SamplerName, estimate};
use lichtwerk::render::Budget;
use lichtwerk_tests::scenes::resized;
use path_space_filter::{NormalCone, PathSpaceFilter, Radius, SimilarTime, SimilarityExt};
use qmc_sampling::Independent;
use scene_core::film::LayeredImage;
use scene_core::glam::Vec3A;
use scene_core::{Ray, ReferenceScene, SceneDescription, builtin};

static SUITE: Suite = Suite::with_share("workspace filters", 22, 7e-8);

fn scene(description: SceneDescription, [width, height]: [u32; 2]) -> ReferenceScene {
    ReferenceScene::new(resized(description, width, height)).unwrap()
}

fn render(scene: &ReferenceScene, settings: &RenderSettings) -> LayeredImage {
    let rendering = estimate(scene, settings, |_| ControlFlow::Continue(())).unwrap();
    rendering.film.develop(rendering.light_paths)
}

fn filtered(settings: &RenderSettings, name: PathFilterName, filtering: FilterSettings) -> RenderSettings {
    RenderSettings { path_filter: Some(name), filtering, ..settings.clone() }
}

/// Whether two images agree up to the round-off of sums that run in another order.
fn assert_same(a: &LayeredImage, b: &LayeredImage, what: &str) {
    let (a, b) = (a.rgb().unwrap(), b.rgb().unwrap());
    for (i, (a, b)) in a.iter().zip(&b).enumerate() {
        for k in 0..3 {
            assert!((a[k] - b[k]).abs() <= 2e-4 * (a[k].abs() + 1e-2), "{what}, pixel {i}: {a:?} and {b:?}");
        }
    }
}

/// Paths that are taken apart and put together again are the paths: with nobody in the ball but the centre, filtered images are the unfiltered ones.
#[test]
fn without_a_radius_every_estimator_renders_its_own_image() {
    use EstimatorName::{Ao, Direct, InstantRadiosity, Path, PhotonMap, RobustIgi};
    let scenes = [builtin::cornell_box(), builtin::glass_ball(), builtin::interior(), builtin::translucent_blob()];
    for (number, description) in scenes.into_iter().enumerate() {
        let scene = scene(description, [24, 18]);
        for estimator in [Path, Direct, Ao, RobustIgi, InstantRadiosity, PhotonMap] {
            for vertices in [1, 3] {
                let mut settings =
                    RenderSettings { estimator, threads: 2, max_depth: 6, ..RenderSettings::new(Budget::Samples(4)) };
                settings.photons.photons = 2000;
                let nothing = FilterSettings {
                    filter_length: Some(0.0),
                    filter_vertices: vertices,
                    filter_batch: Some(2),
                    ..FilterSettings::default()
                };
                let plain = render(&scene, &settings);
                for name in [PathFilterName::Psf, PathFilterName::PsfHash] {
                    let found = render(&scene, &filtered(&settings, name, nothing.clone()));
                    assert_same(&found, &plain, &format!("scene {number}, {estimator:?}, {vertices} vertices"));
                }
            }
        }
    }
}

#[test]
fn threads_and_passes_change_nothing() {
    let scene = scene(builtin::cornell_box(), [32, 24]);
    for name in [PathFilterName::Psf, PathFilterName::PsfHash] {
        let run = |threads| {
            let filtering = FilterSettings { filter_batch: Some(4), filter_extra: 1, ..FilterSettings::default() };
            let settings = RenderSettings { threads, ..RenderSettings::new(Budget::Samples(10)) };
            render(&scene, &filtered(&settings, name, filtering)).rgb().unwrap()
        };
        assert_eq!(run(1), run(3));
    }
}

/// Two halves that were rendered one after the other are the whole.
#[test]
fn a_rendering_goes_on_where_another_one_stopped() {
    let scene = scene(builtin::cornell_box(), [32, 24]);
    let settings = |samples, first| {
        let settings = RenderSettings {
            first,
            sampler: SamplerName::GlobalSobol,
            ..RenderSettings::new(Budget::Samples(samples))
        };
        let filtering = FilterSettings { filter_batch: Some(4), ..FilterSettings::default() };
        filtered(&settings, PathFilterName::Psf, filtering)
    };
    let parts = [render(&scene, &settings(8, 0)), render(&scene, &settings(8, 8))].map(|image| image.rgb().unwrap());
    let whole = render(&scene, &settings(16, 0)).rgb().unwrap();
    for (i, whole) in whole.iter().enumerate() {
        for k in 0..3 {
            let mean = 0.5 * (parts[0][i][k] + parts[1][i][k]);
            assert!((mean - whole[k]).abs() <= 1e-5 * (1.0 + whole[k]));
        }
    }
    // Not in the middle of a batch.
    let error = estimate(&scene, &settings(8, 6), |_| ControlFlow::Continue(())).unwrap_err();
    assert!(error.to_string().contains("6 samples"), "{error}");
}

#[test]
fn estimators_that_tell_nobody_what_they_find_are_refused() {
    let scene = scene(builtin::cornell_box(), [4, 4]);
    for estimator in [EstimatorName::Bdpt, EstimatorName::Light, EstimatorName::Sppm, EstimatorName::RestirDirect] {
        let settings = RenderSettings { estimator, ..RenderSettings::new(Budget::Samples(1)) };
        let settings = filtered(&settings, PathFilterName::Psf, FilterSettings::default());
        let error = estimate(&scene, &settings, |_| ControlFlow::Continue(())).unwrap_err();
        assert!(error.to_string().contains("photon-map"), "{error}");
    }
}

#[test]
fn heuristics_of_whole_paths_are_refused_as_without_a_filter() {
    let scene = scene(builtin::cornell_box(), [4, 4]);
    let plain = RenderSettings { heuristic: AnyHeuristic::Stratification, ..RenderSettings::new(Budget::Samples(1)) };
    for settings in [plain.clone(), filtered(&plain, PathFilterName::Psf, FilterSettings::default())] {
        let error = estimate(&scene, &settings, |_| ControlFlow::Continue(())).unwrap_err();
        assert!(error.to_string().contains("stratification"), "{error}");
    }
}

/// Occlusion has no colour, and dark books are as white as white walls.
#[test]
fn occlusion_is_averaged_without_colours() {
    let scene = scene(builtin::interior(), [48, 36]);
    let settings = RenderSettings {
        estimator: EstimatorName::Ao,
        ao_distance: 0.5,
        threads: 2,
        ..RenderSettings::new(Budget::Samples(8))
    };
    let image = render(&scene, &filtered(&settings, PathFilterName::Psf, FilterSettings::default()));
    assert!(image.rgb().unwrap().iter().all(|rgb| rgb.iter().all(|c| (0.0..=1.0001).contains(c))));
    let truth = render(&scene, &RenderSettings { budget: Budget::Samples(512), seed: 9, ..settings.clone() });
    let plain = render(&scene, &settings);
    let error = |image: &LayeredImage| relative_mse(&ImagePair::of_images(image, &truth).unwrap());
    assert!(error(&image) < 0.7 * error(&plain), "{} and {}", error(&image), error(&plain));
}

/// Several views average together, unless they are apart in time.
#[test]
fn views_share_their_vertices() {
    let scene = scene(builtin::cornell_box(), [32, 24]);
    let ao = AmbientOcclusion { distance: 0.2 };
    let view = |time: f32| View { scene: &scene, estimator: &ao, time };
    let radius = Radius::absolute(0.03).unwrap();
    let truth = {
        let settings = RenderSettings {
            estimator: EstimatorName::Ao,
            ao_distance: 0.2,
            ..RenderSettings::new(Budget::Samples(1024))
        };
        render(&scene, &settings)
    };
    let error = |views: &[View<'_, _, _>], together: bool| {
        let time = SimilarTime::new(if together { 10.0 } else { 0.1 }).unwrap();
        let filter = PathSpaceFilter::new(radius).similarity(NormalCone::PAPER.and(time));
        let samplers = Independent::new(3);
        let (films, _) =
            render_views(views, &samplers, &filter, Selection::default(), 0..1, 2, &mut |_| ControlFlow::Continue(()))
                .unwrap();
        relative_mse(&ImagePair::of_images(&films[0].develop(0), &truth).unwrap())
    };
    let views = [0.0, 1.0, 2.0, 3.0].map(view);
    let (alone, together, apart) = (error(&views[..1], true), error(&views, true), error(&views, false));
    assert!(together < 0.8 * alone, "{together} together, {alone} alone");
    assert!(apart > 1.2 * together, "{apart} apart, {together} together");
}

/// Texels have their own light, and less noise than without a filter.
#[test]
fn textures_are_baked_in_the_order_of_their_rays() {
    let scene = scene(builtin::cornell_box(), [4, 4]);
    let ao = AmbientOcclusion { distance: 0.1 };
    // Along the floor, from a wall to the short box.
    let texel = |i: u16| Ray::new(Vec3A::new(0.005 + 0.01 * f32::from(i), 0.05, 0.05), Vec3A::NEG_Y);
    let rays: Vec<Ray> = (0..24).map(texel).collect();
    let bake_with = |length: f32, samples| {
        let filter = PathSpaceFilter::new(Radius::absolute(length).unwrap());
        bake(&scene, &rays, &ao, &Independent::new(1), &filter, Selection::default(), 0..1, samples)
    };
    let truth = bake_with(0.0, 4096);
    assert!(truth[0][0] < 0.6 && truth[9][0] > 0.85 && truth[16][0] < 0.75, "{truth:?}");
    let error = |texture: &[[f32; 3]]| texture.iter().zip(&truth).map(|(a, b)| (a[0] - b[0]).powi(2)).sum::<f32>();
    assert!(error(&bake_with(0.02, 8)) < error(&bake_with(0.0, 8)));
}

/// Numbers of samples per pixel, one per batch: from where the noise of edges, which no filter changes, is below the blur of a large radius.
/// With fewer the slope is not known well enough.
const SAMPLES: [u64; 13] = [8, 10, 12, 16, 20, 24, 32, 48, 64, 96, 128, 192, 256];

/// Errors by number of batches; no two points share samples.
fn errors(
    scene: &ReferenceScene,
    seed: u64,
    truth: &LayeredImage,
    name: PathFilterName,
    filtering: &FilterSettings,
) -> Vec<(f64, f64)> {
    let filtering = FilterSettings { filter_batch: Some(1), ..filtering.clone() };
    let error = |samples: u64| {
        let runs = 3;
        let one = |run: u64| {
            let seed = seed.wrapping_add(samples << 32 | run);
            let settings = RenderSettings { seed, threads: 2, ..RenderSettings::new(Budget::Samples(samples)) };
            let image = render(scene, &filtered(&settings, name, filtering.clone()));
            relative_mse(&ImagePair::of_images(&image, truth).unwrap())
        };
        (0..runs).map(one).sum::<f64>() / runs as f64
    };
    SAMPLES.map(|samples| (samples as f64, error(samples))).to_vec()
}

fn truth(scene: &ReferenceScene, samples: u64) -> LayeredImage {
    render(scene, &RenderSettings { seed: 77, threads: 2, ..RenderSettings::new(Budget::Samples(samples)) })
}

/// A radius at which blur is larger than noise, and that shrinks faster than usual, so that few batches tell whether it vanishes.
fn far() -> FilterSettings {
    FilterSettings { filter_radius: 12.0, filter_exponent: 0.5, ..FilterSettings::default() }
}

/// Weights of which each is consistent: what is averaged, and how far in pixels.
fn weights() -> [(&'static str, PathFilterName, FilterSettings); 6] {
    let usual = far;
    let all = || FilterSettings { filter_normals: -1.0, filter_as_stored: true, ..usual() };
    [
        ("everything", PathFilterName::Psf, all()),
        ("normals", PathFilterName::Psf, FilterSettings { filter_normals: 0.95, ..all() }),
        ("albedo", PathFilterName::Psf, FilterSettings { filter_albedo: Some(0.05), ..all() }),
        ("view", PathFilterName::Psf, FilterSettings { filter_view: Some(0.99), ..usual() }),
        ("two iterations", PathFilterName::Psf, FilterSettings { filter_iterations: 2, ..usual() }),
        ("hash", PathFilterName::PsfHash, usual()),
    ]
}

/// What the quick forms try in scenes other than the Cornell box.
const FEW_WEIGHTS: [&str; 2] = ["everything", "hash"];

/// The error falls with the number of batches for every weight, and where the radius is held it does not: all is averaged, which blurs most.
fn errors_fall(what: &str, scene: &ReferenceScene, truth: &LayeredImage, slope: f64, among: &[&str]) {
    for (name, filter, filtering) in weights().into_iter().filter(|(name, ..)| among.is_empty() || among.contains(name))
    {
        let check = SUITE.check(&format!("{what}, {name}"));
        let points = errors(scene, check.seed(), truth, filter, &filtering);
        println!("{}", slope_at_most(check, &points, slope).expect_pass());
    }
    let [(_, filter, everything), ..] = weights();
    let held = FilterSettings { filter_exponent: 1e-6, ..everything };
    let check = SUITE.twin(&format!("{what}, held"));
    let points = errors(scene, check.seed(), truth, filter, &held);
    println!("{}", slope_at_most(check, &points, slope).expect_reject());
}

const SLOPE: f64 = -0.7;
/// Slower at these numbers of samples: highlights are smaller than the first radii.
const GLOSSY_SLOPE: f64 = -0.6;

#[test]
fn errors_fall_for_every_weight_in_the_cornell_box() {
    let scene = scene(builtin::cornell_box(), [24, 24]);
    errors_fall("cornell box", &scene, &truth(&scene, 8192), SLOPE, &[]);
}

#[test]
fn errors_fall_in_the_interior() {
    let scene = scene(builtin::interior(), [24, 18]);
    errors_fall("interior", &scene, &truth(&scene, 4096), SLOPE, &FEW_WEIGHTS);
}

#[test]
fn errors_fall_on_glossy_surfaces() {
    let scene = scene(builtin::conference(), [24, 18]);
    errors_fall("glossy", &scene, &truth(&scene, 4096), GLOSSY_SLOPE, &FEW_WEIGHTS);
}

#[test]
#[ignore = "long form: cargo test --release --workspace -- --ignored"]
fn errors_fall_for_every_weight_elsewhere() {
    for (what, description, slope) in
        [("interior (long)", builtin::interior(), SLOPE), ("glossy (long)", builtin::conference(), GLOSSY_SLOPE)]
    {
        let scene = scene(description, [24, 18]);
        errors_fall(what, &scene, &truth(&scene, 4096), slope, &[]);
    }
}
