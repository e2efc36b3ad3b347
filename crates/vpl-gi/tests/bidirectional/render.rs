//! A loop over pixels, small and plain.

use estimator_checks::BatchMeans;
use qmc_sampling::{Independent, Sampler, SamplerFamily};
use scene_core::{EmitterChoice, ReferenceScene, Rgb, RussianRoulette, Scene, Sensor, UniformChoice};
use vpl_gi::{Bidirectional, LightPaths, LightTracing, PathHeuristic, TechniqueSet};

use crate::scenes::SIZE;

/// Side of a block, in pixels.
const BLOCK: u32 = 8;
/// Longest paths.
pub(crate) const MAX_DEPTH: u32 = 5;
/// Stream of the light paths' samplers.
const LIGHT_STREAM: u64 = 1 << 40;

/// How much to render.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Samples per pixel of a batch.
    pub(crate) samples: u64,
    /// Batches.
    pub(crate) batches: u64,
}

/// Light paths per eye path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sharing {
    /// Each eye path has its own.
    Independent,
    /// This many for all pixels together, for each sample per pixel.
    Shared(u32),
}

impl Sharing {
    /// Techniques with the connection to the lens.
    pub(crate) fn with_lens(self) -> TechniqueSet {
        let light_paths = match self {
            Self::Independent => f64::from(SIZE * SIZE),
            Self::Shared(paths) => f64::from(paths),
        };
        TechniqueSet::WithLens { light_paths }
    }
}

/// The estimator as the tests use it.
pub(crate) fn bidirectional<H: PathHeuristic>(
    scene: &ReferenceScene,
    heuristic: H,
    techniques: TechniqueSet,
) -> Bidirectional<H, UniformChoice> {
    let choice = UniformChoice::new(scene.emitters().len());
    let roulette = RussianRoulette::LocalAlbedo { from_length: 2 };
    let tracing = LightTracing { choice, max_length: u32::MAX, roulette };
    Bidirectional { heuristic, techniques, tracing, max_depth: MAX_DEPTH, roulette }
}

/// Sums of a film.
#[derive(Clone, Debug)]
pub(crate) struct Pixels(Vec<[f64; 3]>);

impl Pixels {
    pub(crate) fn new() -> Self {
        Self(vec![[0.0; 3]; (SIZE * SIZE) as usize])
    }

    pub(crate) fn add(&mut self, raster: [f32; 2], value: Rgb, weight: f64) {
        let [x, y] = raster.map(|r| (r as u32).min(SIZE - 1));
        let pixel = &mut self.0[(y * SIZE + x) as usize];
        (0..3).for_each(|c| pixel[c] += f64::from(value.to_array()[c]) * weight);
    }

    /// Means over the blocks and the whole image, channel by channel.
    fn blocks(&self) -> Vec<f64> {
        let columns = (SIZE / BLOCK) as usize;
        let mut blocks = vec![0.0; 3 * (columns * columns + 1)];
        for (i, pixel) in self.0.iter().enumerate() {
            let (x, y) = (i % SIZE as usize / BLOCK as usize, i / SIZE as usize / BLOCK as usize);
            for (c, value) in pixel.iter().enumerate() {
                let channel = c * (columns * columns + 1);
                blocks[channel + y * columns + x] += value / f64::from(BLOCK * BLOCK);
                blocks[channel + columns * columns] += value / f64::from(SIZE * SIZE);
            }
        }
        blocks
    }
}

/// One image for each batch, by a function of a seed.
pub(crate) fn batches(name: &str, effort: Effort, mut render: impl FnMut(u64) -> Pixels) -> BatchMeans {
    let first = estimator_checks::seed(name);
    let mut means = None;
    for batch in 0..effort.batches {
        let blocks = render(first.wrapping_add(batch)).blocks();
        means.get_or_insert_with(|| BatchMeans::new(blocks.len())).push_batch(&blocks).unwrap();
    }
    means.unwrap()
}

/// A sensor ray through a pixel, uniformly.
pub(crate) fn sensor_ray(
    scene: &ReferenceScene,
    pixel: u64,
    sampler: &mut impl Sampler,
) -> ([f32; 2], scene_core::Ray) {
    let [dx, dy] = sampler.next_2d();
    let (x, y) = ((pixel % u64::from(SIZE)) as f32, (pixel / u64::from(SIZE)) as f32);
    let raster = [x + dx, y + dy];
    (raster, scene.sensor().sample_ray(raster, sampler.next_2d()).ray)
}

/// Bidirectional path tracing; eye paths by `eye`, light paths to the lens by `lens` (the same, unless a bug is planted).
pub(crate) fn render_with<H: PathHeuristic, G: PathHeuristic, C: EmitterChoice>(
    scene: &ReferenceScene,
    eye: &Bidirectional<H, C>,
    lens: &Bidirectional<G, C>,
    sharing: Sharing,
    samples: u64,
    seed: u64,
) -> Pixels {
    let family = Independent::new(seed);
    let mut pixels = Pixels::new();
    let mut lights = LightPaths::new(scene);
    let count = u64::from(SIZE * SIZE);
    let eye_weight = 1.0 / samples as f64;
    for sample in 0..samples {
        if let Sharing::Shared(paths) = sharing {
            eye.trace_light_paths(scene, &mut lights, paths, |path| {
                family.sampler(LIGHT_STREAM, sample * u64::from(paths) + u64::from(path))
            });
            let mut sampler = family.sampler(LIGHT_STREAM + 1, sample);
            let weight = eye_weight / f64::from(paths);
            lens.splats(scene, &lights, &mut sampler, |raster, value| pixels.add(raster, value, weight));
        }
        for pixel in 0..count {
            if sharing == Sharing::Independent {
                let index = sample * count + pixel;
                eye.trace_light_paths(scene, &mut lights, 1, |_| family.sampler(LIGHT_STREAM, index));
                let mut sampler = family.sampler(LIGHT_STREAM + 1, index);
                let weight = eye_weight / count as f64;
                lens.splats(scene, &lights, &mut sampler, |raster, value| pixels.add(raster, value, weight));
            }
            let mut sampler = family.sampler(pixel, sample);
            let (raster, ray) = sensor_ray(scene, pixel, &mut sampler);
            let radiance = eye.radiance(scene, &lights, ray, &mut sampler, &mut ());
            pixels.add(raster, radiance, eye_weight);
        }
    }
    pixels
}
