//! `lichtwerk frames`: several images whose paths are filtered together.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use scene_core::film::{Film, LayeredImage, SAMPLES_PER_PIXEL};
use scene_core::{ReferenceScene, Scene, Sensor};

use super::attributes::{FRAME, attributes};
use super::filtered;
use super::render::{EstimatorName, RenderSettings};
use super::{Failure, FramesArguments, load_description, report};
use crate::estimators::AmbientOcclusion;
use crate::filtering::{Observable, View, render_views};
use crate::filters::FilterError;
use crate::output::{Interrupt, Progress, check_writable, save_image};
use crate::render::{Budget, RenderError, thread_pool};
use crate::samplers::{AnyFamily, SamplerName};

/// A frame as one eye sees it.
struct Frame {
    /// What its file is called.
    name: String,
    eye: &'static str,
    scene: ReferenceScene,
    /// Its number.
    time: f32,
}

/// Loads the frames, renders them together, writes an image for each, or one for each eye.
pub(super) fn run(arguments: &FramesArguments) -> Result<(), Failure> {
    let frames = load(arguments)?;
    let settings = settings(arguments, &frames);
    filtered::check(&settings)?;
    std::fs::create_dir_all(&arguments.out)
        .map_err(|error| format!("cannot create {}: {error}", arguments.out.display()))?;
    let file = |frame| arguments.out.join(file_name(arguments, &frames[0], frame));
    let files: Vec<PathBuf> = frames.iter().map(file).collect();
    for file in &files {
        check_writable(&with_extension(file, "exr"))?;
    }

    let films = match arguments.estimator {
        EstimatorName::Path | EstimatorName::Direct => {
            render(arguments, &settings, &frames, |s| settings.path_tracer(s))?
        }
        EstimatorName::Ao => {
            render(arguments, &settings, &frames, |_| AmbientOcclusion { distance: settings.ao_distance })?
        }
        _ => return Err("frames are rendered by path, direct and ao".into()),
    };

    // The mean of all points in time, or each by itself.
    let mut images: Vec<(&PathBuf, Film)> = Vec::new();
    for (file, film) in files.iter().zip(films) {
        match images.iter_mut().find(|(earlier, _)| *earlier == file) {
            Some((_, mean)) => mean.merge(&film)?,
            None => images.push((file, film)),
        }
    }
    for (file, film) in &images {
        let image = annotated(arguments, &settings, &frames[0].scene, film, file)?;
        for extension in ["exr", "png"] {
            save_image(&with_extension(file, extension), &image, arguments.exposure)?;
        }
    }
    Ok(())
}

/// Names may hold dots.
fn with_extension(file: &Path, extension: &str) -> PathBuf {
    let mut name = file.as_os_str().to_owned();
    name.push(".");
    name.push(extension);
    PathBuf::from(name)
}

/// Each scene file once for each eye.
fn load(arguments: &FramesArguments) -> Result<Vec<Frame>, Failure> {
    let eyes: &[(&str, f64)] = match arguments.stereo {
        Some(distance) => &[("-left", -0.5 * distance), ("-right", 0.5 * distance)],
        None => &[("", 0.0)],
    };
    let mut frames: Vec<Frame> = Vec::new();
    for (number, file) in arguments.scenes.iter().enumerate() {
        let mut description = load_description(file, &[])?;
        if let Some([width, height]) = arguments.size {
            (description.camera.width, description.camera.height) = (width, height);
        }
        for &(eye, right) in eyes {
            let mut description = description.clone();
            description.camera = description.camera.moved_right(right as f32);
            let name = description.name.clone();
            let scene = ReferenceScene::new(description).map_err(|error| format!("{file}: {error}"))?;
            if let Some(first) = frames.first() {
                let [one, other] = [&first.scene, &scene].map(|scene| scene.sensor().resolution());
                if one != other {
                    let [[a, b], [c, d]] = [one, other];
                    return Err(
                        format!("{file}: {c} x {d} pixels, and the first frame has {a} x {b}; give --size").into()
                    );
                }
            }
            frames.push(Frame { name, eye, scene, time: number as f32 });
        }
    }
    Ok(frames)
}

/// As for rendering one of them.
fn settings(arguments: &FramesArguments, frames: &[Frame]) -> RenderSettings {
    let radius = frames.first().map_or(0.0, |frame| frame.scene.bounding_sphere().1);
    let mut filtering = arguments.filtering.clone();
    filtering.filter_time = arguments.filter_time.map(|time| time as f32);
    RenderSettings {
        estimator: arguments.estimator,
        sampler: SamplerName::GlobalSobol,
        seed: arguments.seed,
        threads: arguments.threads,
        max_depth: arguments.max_depth.unwrap_or(u32::MAX),
        path_filter: Some(arguments.filter),
        filtering,
        ao_distance: arguments.ao_distance.map_or(0.1 * radius, |distance| distance as f32),
        ..RenderSettings::new(Budget::Samples(arguments.spp))
    }
}

/// `NAME-FRAME-EYE`; a frame that is alone has no number, and all as one have the name of the first.
fn file_name(arguments: &FramesArguments, first: &Frame, frame: &Frame) -> String {
    let Frame { name, eye, time, .. } = frame;
    match arguments {
        _ if arguments.blur => format!("{}-blur{eye}", first.name),
        _ if arguments.scenes.len() == 1 => format!("{name}{eye}"),
        _ => format!("{name}-{time:03}{eye}"),
    }
}

fn render<E: Observable>(
    arguments: &FramesArguments,
    settings: &RenderSettings,
    frames: &[Frame],
    estimator: impl Fn(&ReferenceScene) -> E,
) -> Result<Vec<Film>, Failure> {
    let estimators: Vec<E> = frames.iter().map(|frame| estimator(&frame.scene)).collect();
    let views: Vec<View<'_, ReferenceScene, E>> = frames
        .iter()
        .zip(&estimators)
        .map(|(Frame { scene, time, .. }, estimator)| View { scene, estimator, time: *time })
        .collect();
    let sensor = views.first().ok_or("no frames")?.scene.sensor();
    let filtering = settings.path_filtering();
    if filtering.filter_extra > 0 || filtering.filter_visibility {
        return Err(FilterError::Setting("--filter-extra and --filter-visibility are for single images").into());
    }
    let filter = filtering.filter(arguments.filter, sensor)?;
    let [width, height] = sensor.resolution();
    let pixels = u64::from(width) * u64::from(height) * views.len() as u64;
    // Batches of one size, as large as the memory allows.
    let batches = arguments.spp.div_ceil(filtering.batch(&filter, pixels));
    let batch = arguments.spp.div_ceil(batches);
    let paths = u32::try_from(batches * batch * views.len() as u64).unwrap_or(u32::MAX).min(1 << 31);
    let samplers =
        AnyFamily::new(settings.sampler, [width, height], paths, settings.seed).map_err(RenderError::from)?;
    let selection = filtering.selection()?;

    let progress = Progress::counting(batches * batch, "samples per pixel");
    let interrupt = Interrupt::install().unwrap_or_else(|_| Interrupt::inactive());
    let (films, _) = thread_pool(settings.threads)?.install(|| {
        render_views(&views, &samplers, &filter, selection, 0..batches, batch, &mut |done| {
            progress.add(done * batch - progress.done());
            if interrupt.is_requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
    })?;
    progress.finish();
    if interrupt.is_requested() {
        report("interrupted; the images so far are kept");
    }
    Ok(films)
}

fn annotated(
    arguments: &FramesArguments,
    settings: &RenderSettings,
    first: &ReferenceScene,
    film: &Film,
    file: &Path,
) -> Result<LayeredImage, Failure> {
    let mut image = film.develop(0);
    let pixels = u64::from(film.width()) * u64::from(film.height());
    image.set_attribute(SAMPLES_PER_PIXEL, film.samples() / pixels.max(1))?;
    for (key, text) in attributes(first, settings) {
        image.set_attribute(&key, text)?;
    }
    // Frame and eye are in the name of the file.
    image.set_attribute(FRAME, file.file_name().unwrap_or_default().to_string_lossy().into_owned())?;
    image.set_attribute("scene", arguments.scenes.join(", "))?;
    Ok(image)
}
