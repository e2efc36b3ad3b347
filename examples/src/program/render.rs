//! `lichtwerk render`.

use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::ValueEnum;
use qmc_sampling::{Independent, OwenSobol, SamplerFamily};
use scene_core::film::{Filter, LayeredImage};
use scene_core::{RayCounts, ReferenceScene, RussianRoulette, Scene, Sensor};
use vpl_gi::{Bidirectional, LightTracing, Residual, RobustIgi};

use super::done::Done;
use super::finish::{Finish, Plain, Run};
use super::parts::{Part, described, develop, image_of};
use super::{Failure, RenderArguments, Told, check_numbers, filtered, find_ranks, report, tell, write_numbers};
use crate::choices::{AnyChoice, AnyHeuristic, AnyPathHeuristic, LightSelection};
use crate::distributed::{Ranks, RanksError};
use crate::estimators::{
    AmbientOcclusion, BidirectionalPaths, FirstEvent, LightTracer, NextEvent, NoLightPaths, OwnSampling, PathTracer,
    PhotonLights, VirtualLights,
};
use crate::filters::{FilterSettings, PathFilterName};
use crate::light_paths::LightPathSettings;
use crate::light_photons::{LightPhotonSettings, LightPhotonsError};
use crate::output::{Display, ImageFormat, Interrupt, Progress, check_writable, save_image};
use crate::photons::{PathLimits, PhotonSettings};
use crate::render::{Budget, Observe, PassContext, Progress as Pass, RenderError, Rendering, Shared, thread_pool};
use crate::resampling::{AnyDirect, DirectName, ResamplingSettings};
use crate::samplers::{AnyFamily, SamplerName};

/// The estimators.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum EstimatorName {
    /// Path tracing: next event estimation and scattering, combined by the heuristic. Knows participating media.
    #[default]
    Path,
    /// Light tracing; what it cannot find (specular next to the sensor) by path tracing.
    Light,
    /// Emission and direct light only: path tracing with two segments. Knows participating media.
    Direct,
    /// Ambient occlusion.
    Ao,
    /// Robust instant global illumination: virtual point lights where the geometry term is small, scattered rays elsewhere.
    RobustIgi,
    /// Virtual point lights alone. Biased where the threshold is not infinite, or there are mirrors and glass.
    InstantRadiosity,
    /// Bidirectional path tracing, weighted by the heuristic: each eye path has a light path of its own, or more that pixels share
    /// (`--light-paths 32 --interleave 3x3`).
    // In a library call see `LightPathSettings::classical`.
    Bdpt,
    /// Emission and direct light, with samples that neighbouring pixels share without bias.
    RestirDirect,
    /// Photon mapping: direct light as in path tracing, caustics and indirect light from photon maps. Biased.
    PhotonMap,
    /// Stochastic progressive photon mapping: new photons and a smaller radius in every pass. Consistent.
    Sppm,
}

impl EstimatorName {
    /// Whether it makes use of the settings of light paths.
    pub fn connects_light_paths(self) -> bool {
        matches!(self, Self::RobustIgi | Self::InstantRadiosity | Self::Bdpt)
    }

    /// Whether it follows light through participating media; the others take them for clear.
    pub fn knows_media(self) -> bool {
        matches!(self, Self::Path | Self::Direct)
    }
}

/// The reconstruction filters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FilterName {
    /// Mean over the pixel.
    Box,
    /// Tent of radius one pixel.
    Tent,
    /// Gaussian with a standard deviation of half a pixel.
    Gaussian,
    /// Path space filtering by range search, before reconstruction.
    Psf,
    /// Path space filtering by jittered spatial hashing, before reconstruction.
    PsfHash,
}

impl FilterName {
    fn reconstruction(self) -> Option<Filter> {
        match self {
            Self::Box => Some(Filter::BOX),
            Self::Tent => Some(Filter::TENT),
            Self::Gaussian => Some(Filter::GAUSSIAN),
            Self::Psf | Self::PsfHash => None,
        }
    }

    pub(super) fn path_space(self) -> Option<PathFilterName> {
        match self {
            Self::Psf => Some(PathFilterName::Psf),
            Self::PsfHash => Some(PathFilterName::PsfHash),
            _ => None,
        }
    }

    /// The reconstruction filter and the path space filter among those that were named: one of each at most.
    pub(super) fn sort(names: &[Self]) -> Result<(Option<Filter>, Option<PathFilterName>), Failure> {
        let reconstructions: Vec<Filter> = names.iter().filter_map(|name| name.reconstruction()).collect();
        let path_space: Vec<PathFilterName> = names.iter().filter_map(|name| name.path_space()).collect();
        if reconstructions.len() > 1 || path_space.len() > 1 {
            return Err("--filter: one of box, tent and gaussian, and one of psf and psf-hash".to_owned().into());
        }
        Ok((reconstructions.first().copied(), path_space.first().copied()))
    }
}

/// How to estimate, apart from the scene.
#[derive(Clone, Debug)]
pub struct RenderSettings {
    /// What adds up the light.
    pub estimator: EstimatorName,
    /// How next event estimation and scattering are combined.
    pub heuristic: AnyHeuristic,
    /// How the emitter is chosen.
    pub lights: LightSelection,
    /// Where the random numbers come from.
    pub sampler: SamplerName,
    /// When to stop.
    pub budget: Budget,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Number of threads; zero is one per core.
    pub threads: usize,
    /// Segments per path.
    pub max_depth: u32,
    /// Segments from which Russian roulette may end a path.
    pub rr_depth: u32,
    /// Reconstruction filter.
    pub filter: Filter,
    /// Path space filter, if one is wanted.
    pub path_filter: Option<PathFilterName>,
    /// Its settings.
    pub filtering: FilterSettings,
    /// Samples per pixel that another rendering takes: this one begins with the next. Whole batches, with a path space filter.
    pub first: u64,
    /// Samples per pixel of all renderings together, if this is one of several.
    pub planned: Option<u64>,
    /// Distance of ambient occlusion, in units of the scene.
    pub ao_distance: f32,
    /// Light paths, for the estimators that connect to them.
    pub light_paths: LightPathSettings,
    /// Resampling of direct light and of directions.
    pub resampling: ResamplingSettings,
    /// Light selection by photons.
    pub light_photons: LightPhotonSettings,
    /// Photon maps.
    pub photons: PhotonSettings,
    /// What parameters of the scene file are, for the record.
    pub definitions: Vec<(String, String)>,
    /// The processes that render together.
    pub ranks: Ranks,
}

impl RenderSettings {
    /// Whether paths are traced in the usual way, without any resampling.
    fn is_plain(&self) -> bool {
        !self.selects_by_photons() && self.direct_settings().is_plain()
    }

    /// Whether photons tell which lights get shadow rays.
    pub(super) fn selects_by_photons(&self) -> bool {
        let applies = matches!(self.estimator, EstimatorName::Path | EstimatorName::Direct);
        applies && self.lights == LightSelection::Photons && self.resampling.direct == DirectName::Nee
    }

    /// Segments of the estimator's paths at most.
    pub(super) fn longest(&self) -> u32 {
        if self.estimator == EstimatorName::Direct { self.max_depth.min(2) } else { self.max_depth }
    }

    /// The longest path as it is written down: -1 is unlimited.
    pub(super) fn max_depth_text(&self) -> String {
        if self.max_depth == u32::MAX { "-1".to_owned() } else { self.max_depth.to_string() }
    }

    /// The settings of resampling; `--lights ris` asks for it too.
    pub(super) fn direct_settings(&self) -> ResamplingSettings {
        let mut settings = self.resampling.clone();
        if self.lights == LightSelection::Ris {
            settings.direct = DirectName::Ris;
        }
        settings
    }

    /// Path tracing with next event estimation.
    pub fn path_tracer<S: Scene>(&self, scene: &S) -> PathTracer<NextEvent<AnyHeuristic, AnyChoice>, OwnSampling> {
        PathTracer {
            direct: NextEvent { heuristic: self.heuristic, choice: AnyChoice::new(self.lights, scene.emitters()) },
            scattering: OwnSampling,
            max_depth: self.longest(),
            roulette: self.roulette(),
            first_event: FirstEvent::Any,
        }
    }

    /// The path space filter's settings for the estimator.
    pub(super) fn path_filtering(&self) -> FilterSettings {
        let mut filtering = self.filtering.clone();
        // Occlusion has no colour.
        filtering.filter_as_stored |= self.estimator == EstimatorName::Ao;
        filtering
    }

    /// Sides of the tile of the discontinuity buffer that smooths the image, if it is asked for.
    pub(super) fn smoothing(&self) -> Option<[u32; 2]> {
        self.light_paths.smoothing().filter(|_| self.estimator.connects_light_paths())
    }

    fn roulette(&self) -> RussianRoulette {
        RussianRoulette::PathThroughput { from_length: self.rr_depth.saturating_sub(1) }
    }

    /// Path tracing with the scene's own filter and depth.
    pub fn new(budget: Budget) -> Self {
        Self {
            estimator: EstimatorName::Path,
            heuristic: AnyHeuristic::Power,
            lights: LightSelection::Power,
            sampler: SamplerName::Sobol,
            budget,
            seed: 0,
            threads: 0,
            max_depth: u32::MAX,
            rr_depth: 5,
            filter: Filter::BOX,
            path_filter: None,
            filtering: FilterSettings::default(),
            first: 0,
            planned: None,
            ao_distance: f32::INFINITY,
            light_paths: LightPathSettings::default(),
            resampling: ResamplingSettings::default(),
            light_photons: LightPhotonSettings::default(),
            photons: PhotonSettings::default(),
            definitions: Vec::new(),
            ranks: Ranks::default(),
        }
    }
}

/// Renders with the estimator that the settings name.
///
/// # Errors
/// If the image has no pixels or too many (for the sampler), or threads cannot be started.
pub fn estimate(
    scene: &ReferenceScene,
    settings: &RenderSettings,
    mut observe: impl FnMut(Pass<'_>) -> ControlFlow<()> + Send,
) -> Result<Rendering, RenderError> {
    estimate_here(scene, settings, &mut observe)
}

/// All estimators with the crate's own scene are compiled here, once: whoever calls a generic function compiles it again.
#[inline(never)]
fn estimate_here(
    scene: &ReferenceScene,
    settings: &RenderSettings,
    observe: Observe<'_>,
) -> Result<Rendering, RenderError> {
    estimate_in(scene, settings, observe)
}

/// [`estimate`] in a scene of any kind. Takes a minute to compile.
///
/// # Errors
/// As for [`estimate`].
pub fn estimate_in<S: Scene + Sync>(
    scene: &S,
    settings: &RenderSettings,
    observe: Observe<'_>,
) -> Result<Rendering, RenderError> {
    let family = |name| {
        let paths = match settings.budget {
            Budget::Samples(samples) => {
                u32::try_from(settings.planned.unwrap_or(samples)).unwrap_or(u32::MAX).clamp(1, 1 << 31)
            }
            Budget::Seconds(_) => PATHS_OF_TIMED_RENDERINGS,
        };
        AnyFamily::new(name, scene.sensor().resolution(), paths, settings.seed)
    };
    if let Some(filter) = settings.path_filter {
        filtered::check(settings)?;
        return estimate_with(scene, settings, &family(settings.sampler)?, &filter, observe);
    }
    match settings.sampler {
        SamplerName::Independent => estimate_with(scene, settings, &Independent::new(settings.seed), &Plain, observe),
        SamplerName::Sobol => estimate_with(scene, settings, &OwenSobol::new(settings.seed), &Plain, observe),
        // The others share one copy of the renderer.
        name => estimate_with(scene, settings, &family(name)?, &Plain, observe),
    }
}

/// Samplers that want to know the number of paths per pixel are told this one if only the time is known.
const PATHS_OF_TIMED_RENDERINGS: u32 = 64;

fn estimate_with<S: Scene + Sync>(
    scene: &S,
    settings: &RenderSettings,
    samplers: &impl SamplerFamily,
    finish: &impl Finish,
    observe: Observe<'_>,
) -> Result<Rendering, RenderError> {
    if settings.estimator != EstimatorName::Bdpt && !settings.heuristic.is_of_densities() {
        return Err(RenderError::Heuristic);
    }
    let choice = AnyChoice::new(settings.lights, scene.emitters());
    let roulette = settings.roulette();
    let run = Run { scene, samplers, settings };
    let mut path = settings.path_tracer(scene);
    let resampling = &settings.resampling;
    let limits = PathLimits { max_depth: settings.max_depth, roulette };
    match settings.estimator {
        // Without room for direct light there is nothing to reuse.
        EstimatorName::RestirDirect if settings.max_depth < 2 => {
            finish.other(&run, &path, None::<&NoLightPaths>, observe)
        }
        EstimatorName::Path | EstimatorName::Direct if settings.is_plain() => finish.observable(&run, &path, observe),
        EstimatorName::Path | EstimatorName::Direct => {
            let resampling = settings.direct_settings();
            let probes = resampling.probes(scene);
            let resampled = resampling.resampled(scene, samplers, probes.as_ref())?;
            let photons = light_photons(scene, samplers, settings)?;
            let camera = PathTracer {
                direct: match &photons {
                    Some(photons) => AnyDirect::Photons(photons),
                    None => resampling.direct(settings.heuristic, choice, resampled),
                },
                scattering: resampling.scattering(scene),
                max_depth: path.max_depth,
                roulette,
                first_event: FirstEvent::Any,
            };
            let rays = photons.as_ref().map_or(RayCounts::default(), PhotonLights::rays);
            let mut rendering = finish.observable(&run, &camera, &mut counting(rays, observe))?;
            rendering.rays += rays;
            if let Some(photons) = &photons {
                rendering.preparation_seconds += photons.seconds();
                rendering.seconds += photons.seconds();
            }
            Ok(rendering)
        }
        EstimatorName::RestirDirect => {
            let probes = resampling.probes(scene);
            let direct = resampling.resampled(scene, samplers, probes.as_ref())?;
            let camera = resampling.restir(direct);
            finish.other(&run, &camera, None::<&NoLightPaths>, observe)
        }
        EstimatorName::PhotonMap | EstimatorName::Sppm => {
            let resampling = settings.direct_settings();
            let probes = resampling.probes(scene);
            let resampled = resampling.resampled(scene, samplers, probes.as_ref())?;
            let direct = resampling.direct(settings.heuristic, choice.clone(), resampled);
            if settings.estimator == EstimatorName::Sppm {
                let camera = settings.photons.progressive(scene, direct, choice, limits)?;
                return finish.other(&run, &camera, None::<&NoLightPaths>, observe);
            }
            let camera = settings.photons.mapping(scene, direct, choice, limits)?;
            let rays = shared_maps(&run, |context| camera.prepare(context, &settings.ranks))?;
            let mut rendering = finish.observable(&run, &camera, &mut counting(rays, observe))?;
            rendering.rays += rays;
            Ok(rendering)
        }
        EstimatorName::Light => {
            path.first_event = FirstEvent::SpecularOnly;
            let light = LightTracer { choice, max_depth: settings.max_depth, roulette };
            finish.other(&run, &path, Some(&light), observe)
        }
        EstimatorName::RobustIgi | EstimatorName::InstantRadiosity => {
            let drops = settings.estimator == EstimatorName::InstantRadiosity;
            let eye = settings.light_paths.robust(scene, if drops { Residual::Drop } else { Residual::Scatter })?;
            let eye = RobustIgi { max_depth: settings.max_depth, roulette, ..eye };
            let light = LightTracing {
                choice,
                // The connection is a segment, and so is the camera's ray.
                max_length: settings.max_depth.saturating_sub(2),
                roulette: RussianRoulette::LocalAlbedo { from_length: 0 },
            };
            let estimator = VirtualLights { eye, light, paths: settings.light_paths.light_paths, caustics: None };
            let camera = Shared { estimator, sharing: settings.light_paths.sharing() };
            if settings.photons.caustics && !drops {
                let camera = settings.photons.complement(scene, camera, limits)?;
                return finish.other(&run, &camera, None::<&NoLightPaths>, observe);
            }
            finish.observable(&run, &camera, observe)
        }
        EstimatorName::Bdpt => {
            let settings_of_paths = &settings.light_paths;
            let heuristic =
                AnyPathHeuristic { name: settings.heuristic, partition: settings_of_paths.partition_of(scene)? };
            let techniques = settings_of_paths.techniques(scene.sensor().resolution());
            let roulette_of_light = RussianRoulette::LocalAlbedo { from_length: 0 };
            let tracing = LightTracing { choice, max_length: u32::MAX, roulette: roulette_of_light };
            let paths = Bidirectional { heuristic, techniques, tracing, max_depth: settings.max_depth, roulette };
            let estimator = BidirectionalPaths {
                paths,
                count: settings_of_paths.light_paths,
                resampled: settings_of_paths.resampled_connections,
            };
            let camera = Shared { estimator, sharing: settings_of_paths.sharing() };
            finish.other(&run, &camera, None::<&NoLightPaths>, observe)
        }
        EstimatorName::Ao => {
            let ao = AmbientOcclusion { distance: settings.ao_distance };
            finish.observable(&run, &ao, observe)
        }
    }
}

/// Traces the photons that tell which lights contribute, if they are asked for.
fn light_photons<S: Scene + Sync>(
    scene: &S,
    samplers: &impl SamplerFamily,
    settings: &RenderSettings,
) -> Result<Option<PhotonLights>, RenderError> {
    if !settings.selects_by_photons() {
        return Ok(None);
    }
    let trace = || PhotonLights::trace_by(scene, samplers, &settings.light_photons, &settings.ranks);
    thread_pool(settings.threads)?.install(trace).map_err(|error| match error {
        LightPhotonsError::Ranks(error) => error.into(),
        error => error.into(),
    })
}

/// Traces the light paths that all samples share together with the other ranks, even if there is nothing left to be done here.
/// One process does that when it needs them.
fn shared_maps<S: Scene + Sync, F: SamplerFamily>(
    run: &Run<'_, S, F>,
    prepare: impl FnOnce(&PassContext<'_, S, F>) -> Result<RayCounts, RanksError> + Send,
) -> Result<RayCounts, RenderError> {
    let &Run { scene, samplers, settings } = run;
    let ranks = &settings.ranks;
    if !ranks.are_several() || !ranks.any(settings.budget != Budget::Samples(0))? {
        return Ok(RayCounts::default());
    }
    let context = PassContext { scene, samplers, filter: settings.filter };
    Ok(thread_pool(settings.threads)?.install(|| prepare(&context))?)
}

/// Counts rays that were traced before the first pass.
fn counting<'a>(rays: RayCounts, observe: Observe<'a>) -> impl FnMut(Pass<'_>) -> ControlFlow<()> + Send + use<'a> {
    move |mut pass| {
        pass.rays += rays;
        observe(pass)
    }
}

/// A finished image with the settings in its attributes.
///
/// # Errors
/// As for [`estimate`].
pub fn render_to_image(
    scene: &ReferenceScene,
    settings: &RenderSettings,
    observe: impl FnMut(Pass<'_>) -> ControlFlow<()> + Send,
) -> Result<(LayeredImage, Rendering), RenderError> {
    let rendering = estimate(scene, settings, observe)?;
    let image = develop(&described(scene, settings), &rendering.progress())?;
    Ok((image, rendering))
}

/// Everything that can go wrong before the first ray.
struct Prepared {
    scene: ReferenceScene,
    settings: RenderSettings,
    outputs: Vec<PathBuf>,
    /// Samples per pixel of an image that is to be continued.
    earlier: Option<(u64, LayeredImage)>,
    part: Part,
    load_seconds: f64,
}

/// Loads, and finds out whether the files can be written.
fn prepare(arguments: &RenderArguments, ranks: &Ranks) -> Result<Prepared, Failure> {
    // Load and build the scene.
    let start = Instant::now();
    let (scene, wishes) = arguments.build(arguments.description()?)?;
    arguments.check(&scene)?;
    let mut settings = RenderSettings { ranks: ranks.clone(), ..arguments.settings(&scene, &wishes)? };
    let load_seconds = start.elapsed().as_secs_f64();

    // Find out now whether the files can be written.
    let mut outputs = Vec::new();
    if ranks.is_first() {
        outputs = if arguments.out.is_empty() { default_outputs(scene.name())? } else { arguments.out.clone() };
        for path in &outputs {
            ImageFormat::of(path)?;
            check_writable(path)?;
        }
        if let Some(path) = &arguments.stats {
            check_numbers(path)?;
        }
    }

    // Find out where to begin.
    let earlier = arguments.continued.as_deref().map(|path| filtered::earlier(path, &scene, &settings)).transpose()?;
    if let Some((done, _)) = &earlier {
        settings.first = *done;
    }
    let part = Part::of(arguments, &scene, &mut settings)?;
    Ok(Prepared { scene, settings, outputs, earlier, part, load_seconds })
}

/// Loads, renders, writes; together with other processes, if there are any.
pub(super) fn run(arguments: &RenderArguments) -> Result<(), Failure> {
    let ranks = find_ranks(arguments.shard.is_some())?;
    match run_with(&ranks, arguments) {
        Err(error) if ranks.are_several() => {
            // Before the ranks part: the first process that ends with an error ends all others, whatever they have to say.
            report(&format!("error: {error}"));
            Err(Told.into())
        }
        result => result,
    }
}

fn run_with(ranks: &Ranks, arguments: &RenderArguments) -> Result<(), Failure> {
    let Prepared { scene, settings, outputs, earlier, part, load_seconds } = ranks.agree(prepare(arguments, ranks))?;

    // Render.
    let mut watch = Watch::new(arguments, &settings, scene.name());
    let mut keeper = part.keeper(arguments.checkpoint_seconds);
    let rendering = ranks.agree(estimate(&scene, &settings, |pass| {
        if let Some(Err(error)) = keeper.as_mut().map(|keeper| keeper.observe(&pass)) {
            watch.progress.suspend(|| tell(&format!("warning: {error}")));
        }
        if part.is_full(&pass) { ControlFlow::Break(()) } else { watch.observe(pass) }
    }))?;

    // Keep this part, and put all together.
    let own = ranks.agree(Done::of(&part, rendering, load_seconds))?;
    ranks.agree(part.keep(&own.checkpoint))?;
    let Some(done) = ranks.reduce(own)? else { return Ok(()) };
    let mut image = image_of(&done.checkpoint)?;
    if let Some((_, earlier)) = earlier {
        image = LayeredImage::merge(&[earlier, image])?;
    }
    watch.finish(&image, &done);

    // Write.
    for path in &outputs {
        save_image(path, &image, arguments.exposure)?;
    }
    if let Some(path) = &arguments.stats {
        write_numbers(path, &done.stats(arguments, ranks.traffic()))?;
    }
    if std::io::stderr().is_terminal() {
        report(&summary(&outputs, &done));
    }
    Ok(())
}

/// What was written, for a terminal.
fn summary(outputs: &[PathBuf], done: &Done) -> String {
    let files = outputs.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
    let (film, described) = (done.film(), &done.checkpoint.described);
    let rays = described.rays.iter().sum::<u64>() as f64;
    format!(
        "{files}: {} x {}, {} samples per pixel, {:.1} s, {rays:.2e} rays",
        film.width(),
        film.height(),
        described.count(),
        done.cost.seconds
    )
}

/// `out/NAME.exr` and `out/NAME.png`.
fn default_outputs(name: &str) -> Result<Vec<PathBuf>, Failure> {
    let folder = PathBuf::from("out");
    std::fs::create_dir_all(&folder).map_err(|error| format!("cannot create {}: {error}", folder.display()))?;
    Ok(["exr", "png"].iter().map(|extension| folder.join(format!("{name}.{extension}"))).collect())
}

/// What looks at a rendering while it goes on: progress, viewer, Ctrl-C.
struct Watch {
    progress: Progress,
    display: Display,
    interrupt: Interrupt,
}

impl Watch {
    fn new(arguments: &RenderArguments, settings: &RenderSettings, name: &str) -> Self {
        let is_first = settings.ranks.is_first();
        let progress = match settings.budget {
            _ if !is_first => Progress::hidden("samples per pixel"),
            Budget::Samples(samples) => Progress::counting(samples, "samples per pixel"),
            Budget::Seconds(seconds) => Progress::timed(Duration::from_secs_f64(seconds), "samples per pixel"),
        };
        let server = arguments.display_server.as_deref().filter(|_| is_first);
        let display = server.map_or_else(Display::none, |server| {
            Display::connect(server, name).unwrap_or_else(|error| {
                report(&format!("warning: {error}"));
                Display::none()
            })
        });
        // Another handler in the process keeps its Ctrl-C.
        let interrupt = Interrupt::install().unwrap_or_else(|_| Interrupt::inactive());
        Self { progress, display, interrupt }
    }

    fn observe(&mut self, pass: Pass<'_>) -> ControlFlow<()> {
        self.progress.add(pass.samples - self.progress.done());
        if self.display.is_due() {
            self.show(&pass.film.develop(pass.light_paths));
        }
        if self.interrupt.is_requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn show(&mut self, image: &LayeredImage) {
        if let Err(error) = self.display.update(image) {
            self.progress.suspend(|| report(&format!("warning: {error}")));
        }
    }

    fn finish(&mut self, image: &LayeredImage, done: &Done) {
        self.progress.finish();
        self.show(image);
        let rejected = done.film().rejected_samples();
        if rejected > 0 {
            report(&format!("warning: {rejected} samples were not finite and count as black"));
        }
        if self.interrupt.is_requested() {
            let samples = done.cost.samples;
            report(&format!("interrupted after {samples} samples per pixel; the image so far is kept"));
        }
    }
}
