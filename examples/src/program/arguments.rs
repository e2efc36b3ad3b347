//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use super::compare::RenderOptions;
use super::parts::Shard;
use super::render::{EstimatorName, FilterName};
use crate::choices::{AnyHeuristic, LightSelection};
use crate::filters::{FilterSettings, PathFilterName};
use crate::light_paths::LightPathSettings;
use crate::light_photons::LightPhotonSettings;
use crate::photons::PhotonSettings;
use crate::resampling::ResamplingSettings;
use crate::samplers::SamplerName;
use crate::values::{folder, positive, stops, whole};
use headings::{ESTIMATOR, FARM, IMAGE, SAMPLES, SCENE};

/// Renders scenes with the estimators of the Lichtwerk crates, and measures them.
#[derive(Debug, Parser)]
#[command(version, about, after_help = "Without a subcommand, the showcase is rendered into out/.")]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// What the program can do.
#[derive(Debug, Subcommand)]
#[non_exhaustive]
pub enum Command {
    /// Render a builtin office into out/ in two ways, with a table of time, rays, error and efficiency.
    Showcase(ShowcaseArguments),
    /// Render a scene.
    Render(Box<RenderArguments>),
    /// Render frames, stereo pairs or motion blur, whose paths are filtered together.
    Frames(Box<FramesArguments>),
    /// Put the parts of a rendering together: checkpoints exactly, images rounded.
    Merge(MergeArguments),
    /// Compare two images: MSE, relative MSE, MRSE, FLIP, ratio of the means.
    Diff(DiffArguments),
    /// Render a scene with several estimators in turn, and write a page that compares them, with error bars.
    Compare(CompareArguments),
    /// Measure what a paper claims, and write report.json and report.html.
    Experiment(ExperimentArguments),
    /// List builtin scenes, estimators, heuristics, samplers and experiments.
    List,
}

/// Arguments of `showcase`.
#[derive(Clone, Debug, Args)]
pub struct ShowcaseArguments {
    /// Folder for the images.
    #[arg(long, default_value = "out", value_parser = folder())]
    pub out: PathBuf,
    /// Samples per pixel.
    #[arg(long, default_value_t = DEFAULT_SHOWCASE_SAMPLES, value_parser = whole::<u64>(1..=MAX_SAMPLES, 64))]
    pub spp: u64,
    /// Size in pixels, as WIDTHxHEIGHT.
    #[arg(long, value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    /// Number of threads; 0 is one per core.
    #[arg(long, default_value_t = 0, value_parser = whole::<usize>(0..=MAX_THREADS, 4))]
    pub threads: usize,
}

const DEFAULT_SHOWCASE_SAMPLES: u64 = 24;

impl Default for ShowcaseArguments {
    fn default() -> Self {
        Self { out: PathBuf::from("out"), spp: DEFAULT_SHOWCASE_SAMPLES, size: None, threads: 0 }
    }
}

/// More samples per pixel than this are taken for a mistake.
const MAX_SAMPLES: u64 = 1 << 32;

/// So are more threads.
const MAX_THREADS: usize = 4096;

/// Headings of `render --help`. What is below others belongs to some estimators or filters, as [`idle`](super::idle) knows.
pub(super) mod headings {
    /// What is estimated, and how paths go.
    pub(crate) const ESTIMATOR: &str = "Estimator, paths, lights";
    /// How long, and by which numbers.
    pub(crate) const SAMPLES: &str = "Samples and time";
    /// What is written.
    pub(crate) const IMAGE: &str = "Image and output";
    /// What is rendered.
    pub(crate) const SCENE: &str = "Scene";
    /// Renderings that are interrupted, and those of many machines.
    pub(crate) const FARM: &str = "Checkpoints and parts (docs/farm.md)";
    /// Those of options that all estimators have.
    pub(crate) const OF_ALL: [&str; 5] = [ESTIMATOR, SAMPLES, IMAGE, SCENE, FARM];
}

/// Arguments of `render`, in the order of its help.
#[derive(Clone, Debug, Args)]
pub struct RenderArguments {
    /// A builtin scene (see `lichtwerk list`), or a file: Mitsuba 3 .xml, glTF 2.0 .gltf or .glb, LuxCore .scn.
    pub scene: String,
    /// What adds up the light.
    #[arg(long, value_enum, default_value_t, help_heading = ESTIMATOR)]
    pub estimator: EstimatorName,
    /// Segments per path, as Mitsuba counts: 1 is visible emission, 2 direct light; -1 is unlimited
    /// [default: the scene's].
    #[arg(long, allow_negative_numbers = true, value_parser = parse_depth, help_heading = ESTIMATOR)]
    pub max_depth: Option<u32>,
    /// Segments from which Russian roulette may end a path.
    #[arg(long, default_value_t = 5, value_parser = whole::<u32>(0..=u32::MAX, 5), help_heading = ESTIMATOR)]
    pub rr_depth: u32,
    /// How next event estimation and scattering are combined.
    #[arg(long, value_enum, default_value_t, help_heading = ESTIMATOR)]
    pub heuristic: AnyHeuristic,
    /// How the emitter for next event estimation is chosen.
    #[arg(long, value_enum, default_value_t, help_heading = ESTIMATOR)]
    pub lights: LightSelection,
    /// Distance up to which `ao` looks for occluders, in units of the scene [default: a tenth of the scene's radius].
    #[arg(long, allow_negative_numbers = true, value_parser = positive(0.5), help_heading = ESTIMATOR)]
    pub ao_distance: Option<f64>,
    /// Samples per pixel [default: what the scene asks for, or 64].
    #[arg(long, conflicts_with = "time", value_parser = whole::<u64>(1..=MAX_SAMPLES, 64), help_heading = SAMPLES)]
    pub spp: Option<u64>,
    /// Seconds to render instead of a number of samples.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = positive(60.0), help_heading = SAMPLES)]
    pub time: Option<f64>,
    /// Seed of all random numbers: same seed, same image, at any number of threads.
    #[arg(long, default_value_t = 0, value_parser = whole::<u64>(0..=u64::MAX, 7), help_heading = SAMPLES)]
    pub seed: u64,
    /// Where the random numbers come from [default: sobol; global-sobol with a path space filter].
    #[arg(long, value_enum, help_heading = SAMPLES)]
    pub sampler: Option<SamplerName>,
    /// Number of threads; 0 is one per core.
    #[arg(long, default_value_t = 0, value_parser = whole::<usize>(0..=MAX_THREADS, 4), help_heading = SAMPLES)]
    pub threads: usize,
    /// Image file, .exr (linear, with auxiliary channels) or .png; may be given more than once
    /// [default: out/SCENE.exr and out/SCENE.png].
    #[arg(long, value_name = "FILE", help_heading = IMAGE)]
    pub out: Vec<PathBuf>,
    /// Size in pixels, as WIDTHxHEIGHT [default: the scene's]. The horizontal angle of view stays.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size, help_heading = IMAGE)]
    pub size: Option<[u32; 2]>,
    /// Exposure of PNG files, in stops: 1 is twice as bright.
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true, value_parser = stops, help_heading = IMAGE)]
    pub exposure: f32,
    /// Reconstruction filter [default: the scene's], and path space filter [default: none]; may be given once for each.
    #[arg(long, value_enum, value_delimiter = ',', help_heading = IMAGE)]
    pub filter: Vec<FilterName>,
    /// File for settings, time, rays and memory, as JSON; `-` is standard output.
    #[arg(long, value_name = "FILE", help_heading = IMAGE)]
    pub stats: Option<PathBuf>,
    /// Show the image so far in the tev viewer that listens on HOST:PORT.
    #[arg(long, value_name = "HOST:PORT", help_heading = IMAGE)]
    pub display_server: Option<String>,
    /// Set a parameter of a Mitsuba file; may be given more than once.
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = parse_definition, help_heading = SCENE)]
    pub definitions: Vec<(String, String)>,
    /// Resampling.
    #[command(flatten)]
    pub resampling: ResamplingSettings,
    /// Light selection by photons.
    #[command(flatten)]
    pub light_photons: LightPhotonSettings,
    /// Light paths.
    #[command(flatten)]
    pub light_paths: LightPathSettings,
    /// Photon maps.
    #[command(flatten)]
    pub photons: PhotonSettings,
    /// Path space filtering.
    #[command(flatten)]
    pub filtering: FilterSettings,
    /// Go on where this path space filtered image stopped, and write the mean of both.
    #[arg(long = "continue", value_name = "IMAGE.exr", requires = "filter", conflicts_with_all = ["checkpoint", "shard"], help_heading = "Path space filter")]
    pub continued: Option<PathBuf>,
    /// File for the exact state of the rendering: written now and then and at the end; if it is there, the rendering goes on from it.
    /// With mpirun each rank has its own, FILE.K-of-N.
    #[arg(long, value_name = "FILE", help_heading = FARM)]
    pub checkpoint: Option<PathBuf>,
    /// Seconds between two checkpoints.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = positive(60.0), help_heading = FARM)]
    pub checkpoint_seconds: f64,
    /// Only this part of the samples, for `lichtwerk merge`: number K of N equal ones.
    #[arg(long, value_name = "K/N", help_heading = FARM)]
    pub shard: Option<Shard>,
}

/// Arguments of `frames`.
#[derive(Clone, Debug, Args)]
pub struct FramesArguments {
    /// The frames in order: builtin scenes or scene files, all of one size.
    #[arg(required = true)]
    pub scenes: Vec<String>,
    /// Two images of each frame, for eyes so far apart (in units of the scene).
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = positive(0.065))]
    pub stereo: Option<f64>,
    /// The mean of all frames in place of each: motion blur.
    #[arg(long)]
    pub blur: bool,
    /// What adds up the light: path, direct or ao.
    #[arg(long, value_enum, default_value_t)]
    pub estimator: EstimatorName,
    /// How paths are filtered.
    #[arg(long, value_enum, default_value = "psf")]
    pub filter: PathFilterName,
    /// Largest number of frames between vertices that are alike [default: any].
    #[arg(long, value_name = "FRAMES", allow_negative_numbers = true, value_parser = positive(2.0))]
    pub filter_time: Option<f64>,
    /// Samples per pixel of each image.
    #[arg(long, default_value_t = 16, value_parser = whole::<u64>(1..=MAX_SAMPLES, 64))]
    pub spp: u64,
    /// Size in pixels, as WIDTHxHEIGHT [default: the scenes'].
    #[arg(long, value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 0, value_parser = whole::<u64>(0..=u64::MAX, 7))]
    pub seed: u64,
    /// Number of threads; 0 is one per core.
    #[arg(long, default_value_t = 0, value_parser = whole::<usize>(0..=MAX_THREADS, 4))]
    pub threads: usize,
    /// Segments per path; -1 is unlimited [default: unlimited].
    #[arg(long, allow_negative_numbers = true, value_parser = parse_depth)]
    pub max_depth: Option<u32>,
    /// Distance up to which `ao` looks for occluders [default: a tenth of the scene's radius].
    #[arg(long, allow_negative_numbers = true, value_parser = positive(0.5))]
    pub ao_distance: Option<f64>,
    /// Folder for the images.
    #[arg(long, default_value = "out", value_parser = folder())]
    pub out: PathBuf,
    /// Exposure of PNG files, in stops.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_parser = stops)]
    pub exposure: f32,
    /// Path space filtering.
    #[command(flatten)]
    pub filtering: FilterSettings,
}

/// Arguments of `merge`.
#[derive(Clone, Debug, Args)]
pub struct MergeArguments {
    /// Checkpoints of parts of one rendering, or EXR images.
    #[arg(required = true)]
    pub parts: Vec<PathBuf>,
    /// Image file, .exr or .png; may be given more than once.
    #[arg(long, required = true)]
    pub out: Vec<PathBuf>,
    /// File for the merged checkpoint.
    #[arg(long)]
    pub checkpoint: Option<PathBuf>,
    /// Exposure of PNG files, in stops.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_parser = stops)]
    pub exposure: f32,
}

/// Arguments of `diff`.
#[derive(Clone, Debug, Args)]
pub struct DiffArguments {
    /// The image to judge.
    pub image: PathBuf,
    /// The image that is taken for the truth.
    pub reference: PathBuf,
    /// Also write the numbers to this file, as JSON; `-` is standard output, which then has nothing else.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// Arguments of `compare`.
#[derive(Clone, Debug, Args)]
pub struct CompareArguments {
    /// A builtin scene (see `lichtwerk list`) or a scene file.
    pub scene: String,
    /// Estimators, each as NAME[:OPTION[=VALUE]]*, with the long options of `render`: `path,bdpt:heuristic=balance`.
    #[arg(long, required = true, value_delimiter = ',', value_name = "ENTRIES")]
    pub estimators: Vec<String>,
    /// Renderings of each estimator at each budget, with different seeds.
    #[arg(long, default_value_t = 8, value_parser = whole::<u64>(1..=1000, 8))]
    pub trials: u64,
    /// The image that is taken for the truth, .exr [default: path tracing, kept in the cache].
    #[arg(long, value_name = "FILE")]
    pub reference: Option<PathBuf>,
    /// Samples per pixel of the reference that path tracing makes [default: 64 times the budget].
    #[arg(long, conflicts_with = "reference", value_parser = whole::<u64>(1..=MAX_SAMPLES, 64))]
    pub reference_spp: Option<u64>,
    /// Folder where references are kept.
    #[arg(long, default_value = "out/references", value_parser = folder())]
    pub cache: PathBuf,
    /// Folder for report.html, report.json and pictures [default: out/compare-SCENE].
    #[arg(long, value_parser = folder())]
    pub out: Option<PathBuf>,
    /// Options of `render`, for all estimators.
    #[command(flatten)]
    pub options: RenderOptions,
}

/// Arguments of `experiment`.
#[derive(Clone, Debug, Args)]
pub struct ExperimentArguments {
    /// An experiment (see `lichtwerk list`), or `all`.
    pub name: String,
    /// Be done within a minute.
    #[arg(long)]
    pub quick: bool,
    /// Folder for report.json, report.html and pictures; for `all`, each experiment has a folder of its name in it
    /// [default: out/NAME].
    #[arg(long, value_parser = folder())]
    pub out: Option<PathBuf>,
    /// Seed of all random numbers.
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>(0..=u64::MAX, 7))]
    pub seed: u64,
    /// Number of threads; 0 is one per core.
    #[arg(long, default_value_t = 0, value_parser = whole::<usize>(0..=MAX_THREADS, 4))]
    pub threads: usize,
    /// Take what is in the folder already, if it is of the same form and seed, in place of running an experiment again: `all` goes on
    /// where it was interrupted.
    #[arg(long)]
    pub keep: bool,
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let parse = || {
        let (width, height) = text.split_once(['x', 'X'])?;
        Some([width.trim().parse().ok()?, height.trim().parse().ok()?])
    };
    match parse() {
        Some([0, _] | [_, 0]) => {
            Err("an image needs at least one pixel in each direction: expected WIDTHxHEIGHT, as in 640x360".to_owned())
        }
        Some(size) => Ok(size),
        None => Err("expected WIDTHxHEIGHT, as in 640x360".to_owned()),
    }
}

fn parse_depth(text: &str) -> Result<u32, String> {
    match text.parse::<i64>() {
        Ok(-1) => Ok(u32::MAX),
        Ok(depth) if (1..i64::from(u32::MAX)).contains(&depth) => Ok(depth as u32),
        _ => Err("expected a number of segments from 1, as in 5, or -1 for no limit".to_owned()),
    }
}

fn parse_definition(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.to_owned(), value.to_owned())),
        _ => Err("expected NAME=VALUE, as in spp=16".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn nonsense_is_refused_with_a_reason() {
        for bad in [
            &["--size", "0x5"][..],
            &["--size", "5"],
            &["--spp", "0"],
            &["--spp", "99999999999"],
            &["--time", "-1"],
            &["--time", "inf"],
            &["--threads", "100000"],
            &["--max-depth", "0"],
            &["--spp", "4", "--time", "1"],
            &["-D", "=3"],
            &["--estimator", "magic"],
        ] {
            let line = ["lichtwerk", "render", "cornell-box"].iter().chain(bad);
            assert!(Arguments::try_parse_from(line).is_err(), "{bad:?}");
        }
        let fine = ["lichtwerk", "render", "cornell-box", "--max-depth", "-1", "-D", "spp=4", "--exposure", "-1.5"];
        assert!(Arguments::try_parse_from(fine).is_ok());
    }
}
