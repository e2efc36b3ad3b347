//! Passes of samples from the camera, alone or with light paths that pixels share.

use std::ops::Range;

use photon_map::Scratch;
use qmc_sampling::{Interleaved, Sampler, SamplerFamily};
use rayon::prelude::*;
use scene_core::film::{Film, FilmError, FilmTile, Filter, Pixel, SplatBuffer};
use scene_core::{Counting, Ray, RayCounts, Scene, Sensor, SensorRay, Spectrum, Vertex};

use super::{LIGHT_STREAM, TILE_SIZE};
use crate::estimators::{CameraEstimator, FirstHit};

/// What a pass needs to know of its job.
#[derive(Clone, Copy, Debug)]
pub struct PassContext<'a, S, F> {
    /// The scene.
    pub scene: &'a S,
    /// Numbers for each path.
    pub samplers: &'a F,
    /// Reconstruction filter.
    pub filter: Filter,
}

/// What a pass has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PassCounts {
    /// Rays traced.
    pub rays: RayCounts,
    /// Light paths whose splats are on the film.
    pub light_paths: u64,
}

/// Something that adds samples from the camera to a film.
pub trait CameraPass: Sync {
    /// Samples per pixel that belong together: passes are cut between them. The last ones may be fewer.
    fn batch(&self) -> u64 {
        1
    }

    /// Adds the given samples to every pixel.
    ///
    /// # Errors
    /// If splats do not fit the film.
    fn add_samples<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        film: &mut Film,
        samples: Range<u64>,
    ) -> Result<PassCounts, FilmError>;
}

impl<S: Scene + Sync, F: SamplerFamily> PassContext<'_, S, F> {
    /// Adds sample number `index` to a pixel.
    fn add_sample<C: Scene>(
        &self,
        scene: &C,
        [x, y]: [u32; 2],
        pixel: &mut Pixel,
        index: u64,
        radiance: impl FnOnce(Ray, &mut F::Sampler) -> (C::Spectrum, Option<FirstHit>),
    ) {
        let (mut sampler, ray) = self.eye_ray(scene, [x, y], index);
        let (radiance, first_hit) = radiance(ray.ray, &mut sampler);
        pixel.add((radiance * ray.weight).to_rgb());
        if let Some(hit) = first_hit {
            pixel.add_aov(hit.albedo, hit.normal, hit.depth);
        }
    }

    /// The ray of sample number `index` of a pixel, and the sampler from which its numbers came.
    pub fn eye_ray<C: Scene>(&self, scene: &C, [x, y]: [u32; 2], index: u64) -> (F::Sampler, SensorRay) {
        // The first pair of numbers is the place in the pixel, also of sequences that run through the image.
        self.ray_by(scene, [x, y], self.sampler([x, y], index))
    }

    /// Another ray of the same pixel and sample, with numbers of its own.
    pub fn extra_ray<C: Scene>(&self, scene: &C, place: [u32; 2], index: u64, number: u32) -> (F::Sampler, SensorRay) {
        self.ray_by(scene, place, self.sampler(place, index).fork(EXTRA_DOMAIN.wrapping_add(number)))
    }

    /// A ray of a pixel from the sampler's first numbers.
    fn ray_by<C: Scene>(&self, scene: &C, [x, y]: [u32; 2], mut sampler: F::Sampler) -> (F::Sampler, SensorRay) {
        let [dx, dy] = self.filter.sample(sampler.next_2d());
        let raster = [x as f32 + 0.5 + dx, y as f32 + 0.5 + dy];
        let ray = scene.sensor().sample_ray(raster, sampler.next_2d());
        (sampler, ray)
    }

    /// The sampler of sample number `index` of a pixel, from its first number on.
    pub fn sampler(&self, place: [u32; 2], index: u64) -> F::Sampler {
        self.samplers.sampler(self.stream(place), index)
    }

    /// The sampler of light path number `index` of photon maps.
    pub fn photon_sampler(&self, index: u64) -> F::Sampler {
        self.samplers.sampler(PHOTON_STREAM, index)
    }

    /// The sampler of path number `index` from the sensor that says where photons are wanted.
    pub fn importon_sampler(&self, index: u64) -> F::Sampler {
        self.samplers.sampler(IMPORTON_STREAM, index)
    }

    /// Adds the given samples to every pixel, in parallel; each thread has memory for queries of photon maps.
    pub fn add_all(
        &self,
        film: &mut Film,
        samples: Range<u64>,
        radiance: impl Fn(&Counting<'_, S>, &mut Scratch, Ray, &mut F::Sampler) -> (S::Spectrum, Option<FirstHit>) + Sync,
    ) -> RayCounts {
        let add = |mut tile: FilmTile<'_>| {
            let (scene, mut scratch) = (Counting::new(self.scene), Scratch::default());
            for (place, pixel) in tile.pixels_mut() {
                for index in samples.clone() {
                    self.add_sample(&scene, place, pixel, index, |ray, sampler| {
                        radiance(&scene, &mut scratch, ray, sampler)
                    });
                }
            }
            scene.counts()
        };
        film.tiles_mut(TILE_SIZE).into_par_iter().map(add).sum()
    }

    /// The stream of a pixel.
    fn stream(&self, [x, y]: [u32; 2]) -> u64 {
        u64::from(y) * u64::from(self.scene.sensor().resolution()[0]) + u64::from(x)
    }
}

impl<E: CameraEstimator> CameraPass for E {
    fn add_samples<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        film: &mut Film,
        samples: Range<u64>,
    ) -> Result<PassCounts, FilmError> {
        let tiles: Vec<FilmTile<'_>> = film.tiles_mut(TILE_SIZE);
        let add = |mut tile: FilmTile<'_>| {
            let scene = Counting::new(context.scene);
            for (place, pixel) in tile.pixels_mut() {
                for index in samples.clone() {
                    context.add_sample(&scene, place, pixel, index, |ray, sampler| self.radiance(&scene, ray, sampler));
                }
            }
            scene.counts()
        };
        Ok(PassCounts { rays: tiles.into_par_iter().map(add).sum(), light_paths: 0 })
    }
}

/// An estimator whose samples need something from the emitters, such as light paths, that many of them may share.
pub trait SharingEstimator: Sync {
    /// What is shared; keeps vertices of the scene.
    type Shared<V: Vertex + Send + Sync>: Send + Sync;

    /// Number of light paths in it.
    fn paths(&self) -> u32;

    /// Makes it: light path number `k` takes its numbers from `sampler(k)`. `used` is one that is no longer needed, for its memory.
    fn share<'s, S: Scene, R: Sampler>(
        &self,
        scene: &'s S,
        sampler: impl FnMut(u32) -> R,
        used: Option<Self::Shared<S::Vertex<'s>>>,
    ) -> Self::Shared<S::Vertex<'s>>;

    /// An estimate of the radiance that arrives along `ray`, and what the ray hit first.
    fn radiance<S, V>(
        &self,
        scene: &S,
        shared: &Self::Shared<V>,
        ray: Ray,
        sampler: &mut impl Sampler,
    ) -> (S::Spectrum, Option<FirstHit>)
    where
        S: Scene,
        V: Vertex<Spectrum = S::Spectrum> + Send + Sync;

    /// Whether [`splats`](Self::splats) has any.
    fn has_splats(&self) -> bool {
        false
    }

    /// Connects the light paths to the sensor; their mean over all light paths is added to the image.
    fn splats<S, V>(
        &self,
        scene: &S,
        shared: &Self::Shared<V>,
        sampler: &mut impl Sampler,
        splat: impl FnMut([f32; 2], S::Spectrum),
    ) where
        S: Scene,
        V: Vertex<Spectrum = S::Spectrum> + Send + Sync,
    {
        let _ = (scene, shared, sampler, splat);
    }
}

/// The splats of some light paths, and what they took.
pub(crate) type Splatted = (SplatBuffer, PassCounts);

/// How samples share their light paths.
#[derive(Clone, Copy, Debug)]
pub enum Sharing {
    /// Every sample has its own.
    Independent,
    /// Interleaved sampling (Keller and Heidrich 2001): the pixels of a tile have different ones, and each tile the same. All
    /// samples of one pass over the image, that is, one sample per pixel, share them: the method of dependent tests.
    Interleaved(Interleaved),
}

/// A [`SharingEstimator`] with its way of sharing.
#[derive(Clone, Copy, Debug)]
pub struct Shared<E> {
    /// The estimator.
    pub estimator: E,
    /// Which samples share.
    pub sharing: Sharing,
}

/// Streams of light paths of single pixels, beyond the one of shared light paths.
const PIXEL_LIGHT_STREAMS: u64 = LIGHT_STREAM + 1;
/// The stream of light paths of photon maps: they are others than those that eye paths are connected to.
const PHOTON_STREAM: u64 = 1 << 41;
/// The stream of paths from the sensor that say where photons are wanted.
const IMPORTON_STREAM: u64 = PHOTON_STREAM + 1;
/// Numbers of the first extra ray of a sample; those of the others follow.
const EXTRA_DOMAIN: u32 = 0x6578_0000;
/// Numbers for the connections to the sensor.
const LENS_DOMAIN: u32 = 0x6c65_6e73;

impl<E: SharingEstimator> CameraPass for Shared<E> {
    fn add_samples<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        film: &mut Film,
        samples: Range<u64>,
    ) -> Result<PassCounts, FilmError> {
        match self.sharing {
            Sharing::Independent => self.independent(context, film, samples),
            Sharing::Interleaved(tile) => {
                let mut counts = PassCounts::default();
                for index in samples {
                    let pass = self.interleaved(context, film, index, tile)?;
                    counts.rays += pass.rays;
                    counts.light_paths += pass.light_paths;
                }
                Ok(counts)
            }
        }
    }
}

impl<E: SharingEstimator> Shared<E> {
    fn independent<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        film: &mut Film,
        samples: Range<u64>,
    ) -> Result<PassCounts, FilmError> {
        let estimator = &self.estimator;
        let paths = u64::from(estimator.paths());
        let (width, height) = (film.width(), film.height());
        let add = |mut tile: FilmTile<'_>| {
            let scene = Counting::new(context.scene);
            let mut splats = SplatBuffer::new(width, height, context.filter);
            let (mut used, mut light_paths) = (None, 0);
            for (place, pixel) in tile.pixels_mut() {
                let stream = PIXEL_LIGHT_STREAMS + context.stream(place);
                for index in samples.clone() {
                    let shared = estimator.share(&scene, self.own_light_paths(context, place, index), used.take());
                    context.add_sample(&scene, place, pixel, index, |ray, sampler| {
                        estimator.radiance(&scene, &shared, ray, sampler)
                    });
                    if estimator.has_splats() {
                        let mut sampler = context.samplers.sampler(stream, index).fork(LENS_DOMAIN);
                        estimator.splats(&scene, &shared, &mut sampler, |raster, value| {
                            splats.add(raster, value.to_rgb());
                        });
                        light_paths += paths;
                    }
                    used = Some(shared);
                }
            }
            (splats, PassCounts { rays: scene.counts(), light_paths })
        };
        let tiles: Vec<FilmTile<'_>> = film.tiles_mut(TILE_SIZE);
        let done: Vec<_> = tiles.into_par_iter().map(add).collect();
        add_splats(film, done)
    }

    /// The numbers of the light paths that a sample has for itself.
    pub(crate) fn own_light_paths<'a, S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &'a PassContext<'_, S, F>,
        place: [u32; 2],
        index: u64,
    ) -> impl FnMut(u32) -> F::Sampler + use<'a, S, F, E> {
        let (stream, paths) = (PIXEL_LIGHT_STREAMS + context.stream(place), u64::from(self.estimator.paths()));
        move |path: u32| context.samplers.sampler(stream, index * paths + u64::from(path))
    }

    /// Light paths for each place in the tile: blocks of one sequence.
    pub(crate) fn share_patterns<'s, S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'s, S, F>,
        index: u64,
        tile: Interleaved,
    ) -> (Vec<E::Shared<S::Vertex<'s>>>, Vec<Splatted>) {
        let estimator = &self.estimator;
        let (paths, patterns) = (u64::from(estimator.paths()), u64::from(tile.patterns()));
        let [width, height] = context.scene.sensor().resolution();
        let share = |pattern: u32| {
            let scene = Counting::new(context.scene);
            let first = (index * patterns + u64::from(pattern)) * paths;
            let sampler = |path: u32| context.samplers.sampler(LIGHT_STREAM, first + u64::from(path));
            let shared = estimator.share(&scene, sampler, None);
            let mut splats = SplatBuffer::new(width, height, context.filter);
            let mut light_paths = 0;
            if estimator.has_splats() {
                let mut sampler = context.samplers.sampler(LIGHT_STREAM, first).fork(LENS_DOMAIN);
                estimator.splats(&scene, &shared, &mut sampler, |raster, value| splats.add(raster, value.to_rgb()));
                light_paths = paths;
            }
            (shared, (splats, PassCounts { rays: scene.counts(), light_paths }))
        };
        (0..tile.patterns()).into_par_iter().map(share).unzip()
    }

    /// One sample per pixel, with light paths for each place in the tile.
    fn interleaved<S: Scene + Sync, F: SamplerFamily>(
        &self,
        context: &PassContext<'_, S, F>,
        film: &mut Film,
        index: u64,
        tile: Interleaved,
    ) -> Result<PassCounts, FilmError> {
        let estimator = &self.estimator;
        let (shared, done) = self.share_patterns(context, index, tile);
        let mut counts = add_splats(film, done)?;

        // Eye paths.
        let add = |mut pixels: FilmTile<'_>| {
            let scene = Counting::new(context.scene);
            for (place, pixel) in pixels.pixels_mut() {
                let shared = &shared[tile.pattern(place) as usize];
                context.add_sample(&scene, place, pixel, index, |ray, sampler| {
                    estimator.radiance(&scene, shared, ray, sampler)
                });
            }
            scene.counts()
        };
        let tiles: Vec<FilmTile<'_>> = film.tiles_mut(TILE_SIZE);
        counts.rays += tiles.into_par_iter().map(add).sum::<RayCounts>();
        Ok(counts)
    }
}

/// Adds up the counts, and the splats in their order.
fn add_splats(film: &mut Film, done: Vec<Splatted>) -> Result<PassCounts, FilmError> {
    let mut counts = PassCounts::default();
    for (splats, pass) in done {
        if pass.light_paths > 0 {
            film.add_splats(&splats)?;
        }
        counts.rays += pass.rays;
        counts.light_paths += pass.light_paths;
    }
    Ok(counts)
}
