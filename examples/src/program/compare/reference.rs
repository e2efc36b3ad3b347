//! The image that is taken for the truth: a file, or path tracing with many samples that is kept on disk.

use std::fmt::{self, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use qmc_sampling::Replications;
use scene_core::film::{Attribute, LayeredImage, SAMPLES_PER_PIXEL};
use scene_core::{ReferenceScene, Scene, SceneDescription, Sensor};

use crate::output::{Interrupt, Progress, check_writable, save_image};
use crate::program::{Failure, RenderSettings, report};
use crate::render::{Budget, Observe, Progress as Pass, RenderError, Rendering};

/// Attribute of files in the cache that tells what they are the reference of.
const KEY: &str = "referenceKey";
/// Attribute with the seconds that a reference took.
const SECONDS: &str = "renderSeconds";
/// Timed renderings stop near their limit.
const TIME_TOLERANCE: f64 = 0.9;

/// The reference.
#[derive(Debug)]
pub(super) struct Reference {
    pub(super) image: LayeredImage,
    /// Where it comes from, for people.
    pub(super) about: String,
    /// Whether it was there already.
    pub(super) reused: bool,
}

/// What determines a reference apart from its noise: the scene with its contents and size, the path length and the filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Key(u64);

impl Key {
    /// The key of this scene, rendered with these settings.
    ///
    /// A hash of everything that the description has in it: geometry, materials and lights with all digits, images by their size and mean.
    /// What the file is called, and how many samples it asks for, does not matter. The program's version does.
    pub(super) fn new(description: &SceneDescription, settings: &RenderSettings) -> Self {
        let SceneDescription { name, shapes, instances, materials, lights, camera, .. } = description;
        let mut hash = Fnv::new();
        let parts: [&dyn fmt::Debug; 8] =
            [name, shapes, instances, materials, lights, camera, &settings.filter, &settings.max_depth];
        for part in parts {
            // Hashing does not fail.
            let _ = write!(hash, "{part:?};");
        }
        let _ = hash.write_str(env!("CARGO_PKG_VERSION"));
        Self(hash.0)
    }

    /// The file of a cache.
    pub(super) fn file(self, cache: &Path, scene: &str) -> PathBuf {
        let name: String = scene.chars().map(|c| if c.is_alphanumeric() || c == '-' { c } else { '_' }).collect();
        cache.join(format!("{name}-{self}.exr"))
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

/// FNV-1a (Fowler, Noll, Vo), 64 bits: the same everywhere and for ever, unlike the standard library's.
struct Fnv(u64);

impl Fnv {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Write for Fnv {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0 = text.bytes().fold(self.0, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3));
        Ok(())
    }
}

/// Reads a reference of the user's.
pub(super) fn from_file(path: &Path, size: [u32; 2]) -> Result<Reference, Failure> {
    let image = LayeredImage::read_exr(path).map_err(|error| format!("reference {}: {error}", path.display()))?;
    check(&image, size).map_err(|reason| format!("reference {}: {reason}", path.display()))?;
    Ok(Reference { image, about: path.display().to_string(), reused: true })
}

/// Whether a reference can be compared with.
fn check(image: &LayeredImage, [width, height]: [u32; 2]) -> Result<(), String> {
    if [image.width(), image.height()] != [width, height] {
        return Err(format!("{}x{} pixels instead of {width}x{height}", image.width(), image.height()));
    }
    let pixels = image.rgb().map_err(|error| error.to_string())?;
    if pixels.iter().any(|pixel| pixel.iter().all(|value| value.is_finite())) {
        return Ok(());
    }
    Err("no pixel is finite".to_owned())
}

/// Takes the reference out of the cache, or renders it and puts it there. `settings` are those of path tracing, with the budget that the
/// reference should have at least; `render` renders: who tests the cache need not compile all estimators.
pub(super) fn cached(
    cache: &Path,
    key: Key,
    scene: &ReferenceScene,
    settings: &RenderSettings,
    interrupt: &Interrupt,
    render: impl FnOnce(&RenderSettings, Observe<'_>) -> Result<(LayeredImage, Rendering), RenderError>,
) -> Result<Reference, Failure> {
    let path = key.file(cache, scene.name());
    if path.exists() {
        match reuse(&path, key, scene.sensor().resolution(), settings.budget) {
            Ok(Some(image)) => return Ok(described(image, &path, true)),
            Ok(None) => {}
            Err(reason) => report(&format!("warning: {} is made anew: {reason}", path.display())),
        }
    }
    std::fs::create_dir_all(cache).map_err(|error| format!("cannot create {}: {error}", cache.display()))?;
    check_writable(&path)?;
    let progress = match settings.budget {
        Budget::Samples(samples) => Progress::counting(samples, "samples per pixel of the reference"),
        Budget::Seconds(seconds) => {
            Progress::timed(std::time::Duration::from_secs_f64(seconds), "samples per pixel of the reference")
        }
    };
    // Independent of the seeds of what it is compared with, and the same for all of them.
    let settings = RenderSettings { seed: Replications::seed(key.0, 0), ..settings.clone() };
    let mut observe = |pass: Pass<'_>| {
        progress.add(pass.samples - progress.done());
        if interrupt.is_requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let (mut image, rendering) = render(&settings, &mut observe).map_err(|error| format!("reference: {error}"))?;
    progress.finish();
    if interrupt.is_requested() {
        return Err("interrupted while the reference was rendered: nothing is kept".into());
    }
    image.set_attribute(KEY, key.to_string())?;
    image.set_attribute(SECONDS, rendering.seconds)?;
    check(&image, scene.sensor().resolution()).map_err(|reason| format!("reference: {reason}"))?;
    save_image(&path, &image, 0.0)?;
    Ok(described(image, &path, false))
}

/// The image in the cache; nothing if it has fewer samples than wanted. An error if it is not what its name says.
fn reuse(path: &Path, key: Key, size: [u32; 2], wanted: Budget) -> Result<Option<LayeredImage>, String> {
    let image = LayeredImage::read_exr(path).map_err(|error| error.to_string())?;
    check(&image, size)?;
    let found = image.attribute(KEY).map(ToString::to_string).unwrap_or_default();
    if found != key.to_string() {
        return Err(format!("it is the reference of something else ('{found}')"));
    }
    let number = |name| image.attribute(name).and_then(Attribute::as_f64).unwrap_or(0.0);
    let enough = match wanted {
        Budget::Samples(samples) => number(SAMPLES_PER_PIXEL) >= samples as f64,
        Budget::Seconds(seconds) => number(SECONDS) >= TIME_TOLERANCE * seconds,
    };
    Ok(enough.then_some(image))
}

fn described(image: LayeredImage, path: &Path, reused: bool) -> Reference {
    let samples = image.attribute(SAMPLES_PER_PIXEL).and_then(Attribute::as_u64).unwrap_or(0);
    let about = format!("path tracing with {samples} samples per pixel ({})", path.display());
    Reference { image, about, reused }
}

#[cfg(test)]
mod tests {
    use scene_core::builtin::Builtin;
    use scene_core::film::Filter;

    use super::super::stand_in::grey;
    use super::*;

    fn description(name: &str) -> SceneDescription {
        let mut description = Builtin::named(name).unwrap().description();
        (description.camera.width, description.camera.height) = (4, 3);
        description
    }

    fn settings(samples: u64) -> RenderSettings {
        RenderSettings { threads: 1, ..RenderSettings::new(Budget::Samples(samples)) }
    }

    #[test]
    fn hashes_are_those_of_fnv_1a() {
        let mut hash = Fnv::new();
        hash.write_str("foobar").unwrap();
        assert_eq!(hash.0, 0x8594_4171_f739_67e8);
    }

    #[test]
    fn keys_tell_apart_what_makes_another_image_and_nothing_else() {
        let (furnace, plain) = (description("furnace"), settings(1));
        let key = Key::new(&furnace, &plain);
        let mut same = description("furnace");
        (same.samples_per_pixel, same.source) = (Some(77), Some("elsewhere.xml".into()));
        assert_eq!(key, Key::new(&same, &RenderSettings { seed: 5, threads: 7, ..settings(9) }));
        let mut wider = description("furnace");
        wider.camera.width = 5;
        let mut other = description("furnace");
        other.instances.pop();
        let keys = [
            key,
            Key::new(&wider, &plain),
            Key::new(&other, &plain),
            Key::new(&description("cornell-box"), &plain),
            Key::new(&furnace, &RenderSettings { max_depth: 3, ..settings(1) }),
            Key::new(&furnace, &RenderSettings { filter: Filter::GAUSSIAN, ..settings(1) }),
        ];
        for (index, key) in keys.iter().enumerate() {
            assert!(!keys[..index].contains(key), "{index}");
        }
        let file = key.file(Path::new("cache"), "a/b c");
        assert_eq!(file, Path::new("cache").join(format!("a_b_c-{key}.exr")));
    }

    #[test]
    fn the_cache_keeps_what_is_whole_and_has_enough_samples() {
        let folder = tempfile::tempdir().unwrap();
        let description = description("furnace");
        let scene = ReferenceScene::new(description.clone()).unwrap();
        let key = Key::new(&description, &settings(1));
        let get =
            |samples| cached(folder.path(), key, &scene, &settings(samples), &Interrupt::inactive(), grey).unwrap();
        let first = get(4);
        assert!(!first.reused && first.about.contains("4 samples per pixel"));
        assert!(get(4).reused && get(2).reused);
        assert_eq!(get(4).image.rgb().unwrap(), first.image.rgb().unwrap());
        assert!(!get(8).reused, "it has too few samples");
        assert!(get(4).reused, "more than enough");
        // Broken files, and those of another key, are made anew.
        let path = key.file(folder.path(), scene.name());
        std::fs::write(&path, "no image").unwrap();
        assert!(!get(4).reused);
        let mut image = get(4).image;
        image.set_attribute(KEY, "0123").unwrap();
        save_image(&path, &image, 0.0).unwrap();
        assert!(!get(4).reused && get(4).reused);

        let interrupt = Interrupt::inactive();
        interrupt.request();
        let error = cached(folder.path(), key, &scene, &settings(64), &interrupt, grey).unwrap_err();
        assert!(error.to_string().contains("interrupted") && get(4).reused, "{error}");
    }

    #[test]
    fn files_of_another_size_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let mut image = LayeredImage::new(2, 1).unwrap();
        image.set_rgb(&[[f32::NAN; 3]; 2]).unwrap();
        save_image(&path, &image, 0.0).unwrap();
        let message = |path: &Path, size| from_file(path, size).unwrap_err().to_string();
        assert!(message(&path, [3, 1]).contains("2x1 pixels instead of 3x1"));
        assert!(message(&path, [2, 1]).contains("no pixel is finite"));
        assert!(message(&folder.path().join("b.exr"), [2, 1]).contains("b.exr"));
        image.set_rgb(&[[0.5; 3]; 2]).unwrap();
        save_image(&path, &image, 0.0).unwrap();
        assert!(from_file(&path, [2, 1]).unwrap().reused);
    }
}
