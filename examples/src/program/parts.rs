//! `lichtwerk render --checkpoint`, `--shard`, and `lichtwerk merge`: renderings that are continued, and put together from parts.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::{Duration, Instant};

use scene_core::film::{Film, LayeredImage, LayeredImageError, SAMPLES_PER_PIXEL};
use scene_core::{ReferenceScene, Scene};

use super::render::{EstimatorName, RenderSettings, attributes};
use super::{Failure, MergeArguments, RenderArguments, report};
use crate::light_paths::smooth;
use crate::output::{Checkpoint, CheckpointError, Described, ImageFormat, check_writable, save_image};
use crate::render::{Budget, Progress, Rendering};

/// One of several equal parts of a rendering, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: u64,
    of: u64,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parse = || {
            let (number, of) = text.split_once('/')?;
            Some(Self { number: number.trim().parse().ok()?, of: of.trim().parse().ok()? })
        };
        match parse() {
            Some(shard) if (1..=shard.of).contains(&shard.number) => Ok(shard),
            _ => Err("expected K/N with K from 1 to N, as in 2/8".to_owned()),
        }
    }
}

impl Shard {
    /// Its samples of so many: all shards together have each once.
    fn samples(self, all: u64) -> Range<u64> {
        let boundary = |k: u64| (u128::from(all) * u128::from(k) / u128::from(self.of)) as u64;
        boundary(self.number - 1)..boundary(self.number)
    }
}

/// The part of a rendering that a process has to do, and what is there already.
pub(super) struct Part {
    path: Option<PathBuf>,
    /// Without samples of this process.
    described: Described,
    /// Number of the first sample of this process.
    first: u64,
    earlier: Option<Checkpoint>,
}

impl Part {
    /// Finds out where to begin, and tells the settings.
    pub(super) fn of(
        arguments: &RenderArguments,
        scene: &ReferenceScene,
        settings: &mut RenderSettings,
    ) -> Result<Self, Failure> {
        if arguments.checkpoint.is_some() || arguments.shard.is_some() {
            // What is put together would be another image than that of one process.
            if arguments.filtering.filter_extra > 0 {
                return Err("--filter-extra samples depend on earlier batches: no --checkpoint, no --shard".into());
            }
            if settings.estimator == EstimatorName::RestirDirect {
                return Err("restir-direct weighs by its earlier passes: no --checkpoint, no --shard".into());
            }
        }
        let planned = match settings.budget {
            Budget::Samples(samples) => samples,
            Budget::Seconds(_) => 0,
        };
        let described =
            Described { rendering: identity(arguments, scene, settings), planned, ..described(scene, settings) };
        let mut range = settings.first..settings.first + planned;
        if let Some(shard) = arguments.shard {
            if planned == 0 {
                return Err("--shard divides a number of samples: give --spp, not --time".into());
            }
            range = shard.samples(planned);
        }
        if let Some(path) = &arguments.checkpoint {
            check_writable(path)?;
        }
        let earlier = match &arguments.checkpoint {
            Some(path) if path.exists() => Some(Checkpoint::read(path)?),
            _ => None,
        };
        let mut first = range.start;
        if let (Some(Checkpoint { described: before, .. }), Some(path)) = (&earlier, &arguments.checkpoint) {
            before.check_same(&described).map_err(|error| format!("{}: {error}", path.display()))?;
            first = match before.samples[..] {
                [] => first,
                [[start, end]] if start == range.start && (end <= range.end || planned == 0) => end,
                _ => {
                    let ranges = &before.samples;
                    return Err(format!("{}: it has samples {ranges:?} of another part", path.display()).into());
                }
            };
            report(&format!("{}: {} samples per pixel are there", path.display(), first - range.start));
        }
        settings.first = first;
        if planned > 0 {
            settings.planned = Some(planned);
            settings.budget = Budget::Samples(range.end - first);
        }
        Ok(Self { path: arguments.checkpoint.clone(), described, first, earlier })
    }

    /// All that is known after the given rendering.
    pub(super) fn with(&self, rendering: Rendering) -> Result<Checkpoint, CheckpointError> {
        let described = done(&self.described, self.first, &rendering.progress());
        self.and_earlier(Checkpoint { described, film: rendering.film })
    }

    fn and_earlier(&self, mut now: Checkpoint) -> Result<Checkpoint, CheckpointError> {
        self.earlier.as_ref().map_or(Ok(()), |earlier| now.absorb(earlier))?;
        Ok(now)
    }

    /// Writes the checkpoint while the rendering goes on, if there is to be one.
    pub(super) fn keeper(&self, seconds: f64) -> Option<Keeper<'_>> {
        let path = self.path.as_deref()?;
        Some(Keeper { part: self, path, every: Duration::from_secs_f64(seconds), last: Instant::now() })
    }
}

/// Writes checkpoints now and then.
pub(super) struct Keeper<'a> {
    part: &'a Part,
    path: &'a Path,
    every: Duration,
    last: Instant,
}

impl Keeper<'_> {
    /// After a pass.
    pub(super) fn observe(&mut self, pass: &Progress<'_>) -> Result<(), Failure> {
        if self.last.elapsed() < self.every {
            return Ok(());
        }
        let described = done(&self.part.described, self.part.first, pass);
        let checkpoint = self.part.and_earlier(Checkpoint { described, film: pass.film.clone() })?;
        checkpoint.write(self.path)?;
        self.last = Instant::now();
        Ok(())
    }
}

/// What the image of such a rendering will be like.
pub(super) fn described(scene: &ReferenceScene, settings: &RenderSettings) -> Described {
    Described { attributes: attributes(scene, settings), smoothing: settings.smoothing(), ..Described::default() }
}

/// With the numbers of a rendering so far.
fn done(described: &Described, first: u64, pass: &Progress<'_>) -> Described {
    Described {
        samples: if pass.samples > 0 { vec![[first, first + pass.samples]] } else { Vec::new() },
        light_paths: pass.light_paths,
        rays: [pass.rays.closest_hit, pass.rays.visibility],
        seconds: pass.elapsed.as_secs_f64(),
        ..described.clone()
    }
}

/// Whatever decides on the samples; not where they go, who computes them, or how many.
fn identity(arguments: &RenderArguments, scene: &ReferenceScene, settings: &RenderSettings) -> Vec<String> {
    let plain = RenderArguments {
        scene: scene.name().to_owned(),
        sampler: Some(settings.sampler),
        spp: None,
        time: None,
        size: Some(scene_core::Sensor::resolution(scene.sensor())),
        threads: 0,
        max_depth: Some(settings.max_depth),
        out: Vec::new(),
        exposure: 0.0,
        stats: None,
        display_server: None,
        checkpoint: None,
        checkpoint_seconds: 0.0,
        shard: None,
        ..arguments.clone()
    };
    let scene = [format!("triangles: {}", scene.triangle_count()), format!("lights: {}", scene.emitters().len())];
    scene.into_iter().chain(top_level_lines(&format!("{plain:#?}"))).collect()
}

/// Of a struct that is written over several lines: each field on a line of its own, whatever it holds.
fn top_level_lines(pretty: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for line in pretty.lines() {
        let text = line.trim();
        // Fields of the struct are indented by four blanks, and what belongs to them by more or ends with a bracket.
        let is_field = line.starts_with("    ") && !line.starts_with("     ") && !text.starts_with([')', '}', ']']);
        match lines.last_mut() {
            Some(last) if !is_field => *last = format!("{last} {text}"),
            _ => lines.push(text.to_owned()),
        }
    }
    lines
}

/// The image of a checkpoint: what one process would have written.
pub(super) fn image_of(checkpoint: &Checkpoint) -> Result<LayeredImage, LayeredImageError> {
    let Checkpoint { described, film } = checkpoint;
    finished(described, film, described.light_paths, described.count())
}

/// The image of a rendering.
pub(super) fn develop(described: &Described, rendering: &Progress<'_>) -> Result<LayeredImage, LayeredImageError> {
    finished(described, rendering.film, rendering.light_paths, rendering.samples)
}

fn finished(
    described: &Described,
    film: &Film,
    light_paths: u64,
    samples: u64,
) -> Result<LayeredImage, LayeredImageError> {
    let mut image = film.develop(light_paths);
    if let Some(sides) = described.smoothing {
        smooth(&mut image, sides)?;
    }
    for (key, text) in &described.attributes {
        // Attributes are a service: one that does not fit is no reason to lose the image.
        let _ = image.set_attribute(key.as_str(), text.clone());
    }
    let _ = image.set_attribute(SAMPLES_PER_PIXEL, samples);
    Ok(image)
}

/// Puts parts together.
pub(super) fn merge(arguments: &MergeArguments) -> Result<(), Failure> {
    for path in &arguments.out {
        ImageFormat::of(path)?;
        check_writable(path)?;
    }
    if let Some(path) = &arguments.checkpoint {
        check_writable(path)?;
    }
    let is_image = |path: &PathBuf| ImageFormat::of(path).is_ok();
    let image = match arguments.parts.iter().filter(|path| is_image(path)).count() {
        0 => merged_checkpoints(arguments)?,
        count if count == arguments.parts.len() => {
            if arguments.checkpoint.is_some() {
                return Err("images have no exact sums to be kept in a checkpoint".into());
            }
            let read =
                |path: &PathBuf| LayeredImage::read_exr(path).map_err(|error| format!("{}: {error}", path.display()));
            LayeredImage::merge(&arguments.parts.iter().map(read).collect::<Result<Vec<_>, _>>()?)?
        }
        _ => return Err("either checkpoints or EXR images, not both".into()),
    };
    for path in &arguments.out {
        save_image(path, &image, arguments.exposure)?;
    }
    Ok(())
}

fn merged_checkpoints(arguments: &MergeArguments) -> Result<LayeredImage, Failure> {
    let mut whole: Option<Checkpoint> = None;
    for path in &arguments.parts {
        let part = Checkpoint::read(path)?;
        match &mut whole {
            None => whole = Some(part),
            Some(whole) => whole.absorb(&part).map_err(|error| named(path, &error))?,
        }
    }
    let whole = whole.ok_or("nothing to merge")?;
    let Described { planned, samples, .. } = &whole.described;
    if *planned > 0 && whole.described.count() < *planned {
        report(&format!("warning: of {planned} samples per pixel there are only {samples:?}"));
    }
    if let Some(path) = &arguments.checkpoint {
        whole.write(path)?;
    }
    Ok(image_of(&whole)?)
}

fn named(path: &Path, error: &impl std::fmt::Display) -> Failure {
    format!("{}: {error}", path.display()).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setting_is_a_line() {
        #[derive(Debug)]
        #[expect(dead_code, reason = "shown")]
        struct Settings {
            depth: Option<u32>,
            size: [u32; 2],
            seed: u64,
        }
        let lines = top_level_lines(&format!("{:#?}", Settings { depth: Some(3), size: [4, 5], seed: 6 }));
        let expected = ["Settings {", "depth: Some( 3, ),", "size: [ 4, 5, ],", "seed: 6, }"];
        assert_eq!(lines, expected);
    }

    #[test]
    fn shards_divide_all_samples() {
        for (all, of) in [(64, 4), (7, 3), (2, 5), (1 << 40, 7)] {
            let mut next = 0;
            for number in 1..=of {
                let samples = Shard { number, of }.samples(all);
                assert_eq!(samples.start, next);
                next = samples.end;
            }
            assert_eq!(next, all);
        }
        assert_eq!("2/8".parse(), Ok(Shard { number: 2, of: 8 }));
        for bad in ["0/4", "5/4", "1", "1/0", "a/b", "-1/2"] {
            assert!(bad.parse::<Shard>().is_err(), "{bad}");
        }
    }
}
