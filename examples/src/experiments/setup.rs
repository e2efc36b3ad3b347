//! What an experiment renders.

use std::ops::ControlFlow;
use std::path::PathBuf;

use scene_core::builtin::Builtin;
use scene_core::film::LayeredImage;
use scene_core::{ReferenceScene, Scene, SceneDescription};

use super::Context;
use crate::program::{Failure, RenderSettings, estimate, load_description};
use crate::render::{Budget, Rendering};

/// A scene, and the settings that all renderings of it share.
#[derive(Debug)]
pub struct Setup {
    /// The scene.
    pub scene: ReferenceScene,
    /// Path tracing as the scene asks for; change what the experiment varies.
    pub settings: RenderSettings,
}

/// The file of this name below the folder that the environment variable `LICHTWERK_ASSETS` names, or else `../shared/assets`; nothing if there is
/// none.
pub(super) fn asset_file(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("LICHTWERK_ASSETS").map_or_else(|| PathBuf::from("../shared/assets"), PathBuf::from);
    Some(folder.join(name)).filter(|path| path.exists())
}

impl Setup {
    /// A builtin scene at another size, with its own filter and path length.
    ///
    /// # Errors
    /// No such scene, or one that cannot be built at this size.
    pub fn builtin(context: &Context, name: &str, size: [u32; 2]) -> Result<Self, Failure> {
        let builtin = Builtin::named(name).ok_or_else(|| format!("there is no builtin scene '{name}'"))?;
        Self::of(context, builtin.description(), size)
    }

    /// A scene file below the folder that the environment variable `LICHTWERK_ASSETS` names, or else `../shared/assets`. Nothing if there
    /// is no such file.
    ///
    /// # Errors
    /// A file that cannot be loaded.
    pub fn asset(context: &Context, file: &str, size: [u32; 2]) -> Result<Option<Self>, Failure> {
        let Some(path) = asset_file(file) else { return Ok(None) };
        Self::of(context, load_description(&path.to_string_lossy(), &[])?, size).map(Some)
    }

    /// A scene at another size, with its own filter and path length.
    ///
    /// # Errors
    /// One that cannot be built at this size.
    pub fn of(
        context: &Context,
        mut description: SceneDescription,
        [width, height]: [u32; 2],
    ) -> Result<Self, Failure> {
        (description.camera.width, description.camera.height) = (width, height);
        let filter = description.filter;
        let max_depth = description.max_depth.unwrap_or(u32::MAX);
        let scene = ReferenceScene::new(description)?;
        let ao_distance = 0.1 * scene.bounding_sphere().1;
        let threads = context.threads;
        let settings =
            RenderSettings { filter, max_depth, ao_distance, threads, ..RenderSettings::new(Budget::Samples(1)) };
        Ok(Self { scene, settings })
    }

    /// Renders with so many samples per pixel and this seed, and settings of one's own.
    ///
    /// # Errors
    /// As for [`estimate`].
    pub fn render(&self, settings: &RenderSettings, samples: u64, seed: u64) -> Result<Rendering, Failure> {
        let settings = RenderSettings { budget: Budget::Samples(samples), seed, ..settings.clone() };
        Ok(estimate(&self.scene, &settings, |_| ControlFlow::Continue(()))?)
    }

    /// An image to measure errors against: the setup's settings, with a seed of its own. Its own error counts as an error
    /// of what is compared with it, so take many samples.
    ///
    /// # Errors
    /// As for [`render`](Self::render).
    pub fn reference(&self, context: &Context, samples: u64) -> Result<LayeredImage, Failure> {
        let rendering = self.render(&self.settings, samples, context.seed_of("reference", 0))?;
        Ok(rendering.film.develop(rendering.light_paths))
    }
}
