//! Renderings as means over blocks of pixels.

use estimator_checks::BatchMeans;
use lichtwerk::estimators::NoLightPaths;
use lichtwerk::program::{RenderSettings, estimate};
use lichtwerk::render::{Budget, CameraPass, Job, Rendering};
use qmc_sampling::SamplerFamily;
use scene_core::film::Filter;
use scene_core::{ReferenceScene, Scene};

/// How much to render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Samples per pixel of a batch.
    pub samples: u64,
    /// Independent batches: seeds, which are randomisations for quasi-Monte Carlo samplers.
    pub batches: u64,
    /// Side of the blocks in pixels.
    pub block: usize,
}

impl Effort {
    /// Seconds for an image of 24 x 24 pixels, on one core.
    pub const QUICK: Self = Self { samples: 32, batches: 32, block: 6 };
    /// Minutes.
    pub const LONG: Self = Self { samples: 256, batches: 100, block: 4 };
}

/// Renders once per batch, on one thread, and takes means over blocks of pixels; each channel, and the whole image in
/// each channel, is a block of its own. The seeds follow from `name`.
///
/// # Panics
/// If the image cannot be rendered, or has samples that are not finite.
pub fn block_means(name: &str, scene: &ReferenceScene, settings: &RenderSettings, effort: Effort) -> BatchMeans {
    means_of(name, effort, |seed| {
        let settings = RenderSettings { seed, threads: 1, budget: Budget::Samples(effort.samples), ..settings.clone() };
        estimate(scene, &settings, |_| std::ops::ControlFlow::Continue(())).expect("a scene with a size")
    })
}

/// As [`block_means`], with any renderer: a function from a seed to a rendering.
///
/// # Panics
/// If the image has samples that are not finite.
pub fn means_of(name: &str, effort: Effort, render: impl Fn(u64) -> Rendering) -> BatchMeans {
    let first_seed = estimator_checks::seed(name);
    let mut means = None::<BatchMeans>;
    for batch in 0..effort.batches {
        let rendering = render(first_seed.wrapping_add(batch));
        assert_eq!(rendering.film.rejected_samples(), 0, "{name}: samples that are not finite");
        let blocks = blocks_of(&rendering, effort.block);
        means
            .get_or_insert_with(|| BatchMeans::new(blocks.len()))
            .push_batch(&blocks)
            .expect("all batches have the same size");
    }
    means.unwrap_or_else(|| BatchMeans::new(0))
}

/// Renders with a camera pass that the program does not offer: on one thread, each pixel the mean over its square.
///
/// # Panics
/// If the image cannot be rendered.
pub fn render_by<S: Scene + Sync>(
    scene: &S,
    camera: &impl CameraPass,
    samplers: &impl SamplerFamily,
    samples: u64,
) -> Rendering {
    render_through(Filter::BOX, scene, camera, samplers, samples)
}

/// [`render_by`] with a reconstruction filter.
///
/// # Panics
/// If the image cannot be rendered.
pub fn render_through<S: Scene + Sync>(
    filter: Filter,
    scene: &S,
    camera: &impl CameraPass,
    samplers: &impl SamplerFamily,
    samples: u64,
) -> Rendering {
    let budget = Budget::Samples(samples);
    let job = Job { scene, samplers, camera, light: None::<&NoLightPaths>, filter, budget, first: 0, threads: 1 };
    job.render(&mut |_| std::ops::ControlFlow::Continue(())).expect("a scene with a size")
}

/// The means of the blocks of `block * block` pixels and of the whole image, channel by channel.
pub fn blocks_of(rendering: &Rendering, block: usize) -> Vec<f64> {
    let image = rendering.film.develop(rendering.light_paths);
    let (width, height) = (image.width() as usize, image.height() as usize);
    let columns = width.div_ceil(block);
    let mut all = Vec::new();
    for channel in ["R", "G", "B"] {
        let mut sums = vec![(0.0, 0.0); columns * height.div_ceil(block) + 1];
        let whole = sums.len() - 1;
        for (i, &value) in image.channel(channel).unwrap_or_default().iter().enumerate() {
            for at in [i / width / block * columns + i % width / block, whole] {
                sums[at].0 += f64::from(value);
                sums[at].1 += 1.0;
            }
        }
        all.extend(sums.into_iter().map(|(sum, count)| sum / count));
    }
    all
}
