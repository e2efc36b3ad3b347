//! `lichtwerk render --checkpoint`, `--shard`, and `lichtwerk merge`: renderings that are continued, and put together from parts.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::{Duration, Instant};

use scene_core::film::{Film, LayeredImage, LayeredImageError, SAMPLES_PER_PIXEL};
use scene_core::{ReferenceScene, Scene, Sensor};

use super::attributes::{attributes, difference};
use super::filtered::filter_and_batch;
use super::render::{EstimatorName, RenderSettings};
use super::{Failure, MergeArguments, RenderArguments, report, tell};
use crate::distributed::{Ranks, share};
use crate::light_paths::smooth;
use crate::output::{Checkpoint, CheckpointError, Described, ImageFormat, OutputError, check_writable, save_image};
use crate::render::{Budget, MAX_PASS, Progress, Rendering};

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
        share(self.number - 1, self.of, all)
    }

    /// That of this process, if there are others.
    fn of_rank(ranks: &Ranks) -> Option<Self> {
        ranks.are_several().then(|| Self { number: ranks.rank() as u64 + 1, of: ranks.size() as u64 })
    }

    /// Numbers of samples for a rendering of which only the time is known: far more than there will be, and not so many that
    /// those of all ranks would not be in the sequences of large images.
    fn endless(self) -> Range<u64> {
        let length = ((1 << 26) / self.of.next_power_of_two()).clamp(1 << 10, 1 << 20);
        (self.number - 1) * length..self.number * length
    }

    /// Its own file.
    fn file(self, path: &Path) -> PathBuf {
        let mut name = path.as_os_str().to_owned();
        name.push(format!(".{}-of-{}", self.number, self.of));
        name.into()
    }
}

/// The part of a rendering that a process has to do, and what is there already.
pub(super) struct Part {
    path: Option<PathBuf>,
    /// Without samples of this process.
    described: Described,
    /// Number of the first sample of this process.
    first: u64,
    /// Number of the first sample that belongs to another one, whatever the time.
    end: u64,
    earlier: Option<Checkpoint>,
}

impl Part {
    /// Finds out where to begin, and tells the settings.
    pub(super) fn of(
        arguments: &RenderArguments,
        scene: &ReferenceScene,
        settings: &mut RenderSettings,
    ) -> Result<Self, Failure> {
        let of_rank = Shard::of_rank(&settings.ranks);
        let shard = arguments.shard.or(of_rank);
        if arguments.checkpoint.is_some() || shard.is_some() {
            check_divisible(arguments, settings, of_rank.is_some())?;
        }
        let planned = match settings.budget {
            Budget::Samples(samples) => samples,
            Budget::Seconds(_) => 0,
        };
        let described =
            Described { rendering: identity(arguments, scene, settings), planned, ..described(scene, settings) };
        let (mut range, mut end) = (settings.first..settings.first + planned, u64::MAX);
        if let Some(shard) = shard {
            check_enough(shard, planned, scene, settings, of_rank.is_some())?;
            range = shard.samples(planned);
            if planned == 0 {
                let endless = shard.endless();
                (range, end) = (endless.start..endless.start, endless.end);
            }
        }
        let path = arguments.checkpoint.as_deref().map(|path| of_rank.map_or(path.to_owned(), |part| part.file(path)));
        if let Some(path) = &path {
            check_writable(path)?;
        }
        let earlier = match &path {
            Some(path) if path.exists() => Some(Checkpoint::read(path)?),
            _ => None,
        };
        let mut first = range.start;
        if let (Some(Checkpoint { described: before, .. }), Some(path)) = (&earlier, &path) {
            before.check_same(&described).map_err(|error| format!("{}: {error}", path.display()))?;
            first = match before.samples[..] {
                [] => first,
                [[start, end]] if start == range.start && (end <= range.end || planned == 0) => end,
                _ => {
                    let ranges = ranges(&before.samples);
                    return Err(format!("{}: it has samples {ranges}, of another part", path.display()).into());
                }
            };
            tell(&format!("{}: {} samples per pixel are there", path.display(), first - range.start));
        }
        settings.first = first;
        if planned > 0 {
            settings.planned = Some(planned);
            settings.budget = Budget::Samples(range.end - first);
        }
        Ok(Self { path, described, first, end, earlier })
    }

    /// Whether this process has taken all samples that it may take.
    pub(super) fn is_full(&self, pass: &Progress<'_>) -> bool {
        self.first.saturating_add(pass.samples).saturating_add(MAX_PASS) > self.end
    }

    /// Keeps what is done, if it is to be kept.
    pub(super) fn keep(&self, done: &Checkpoint) -> Result<(), OutputError> {
        self.path.as_deref().map_or(Ok(()), |path| done.write(path))
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

/// Refuses what would be another image than that of one process if it were put together.
fn check_divisible(arguments: &RenderArguments, settings: &RenderSettings, has_ranks: bool) -> Result<(), Failure> {
    const DIVIDERS: &str = "no --checkpoint, no --shard, no mpirun";
    if arguments.filtering.filter_extra > 0 {
        return Err(format!("--filter-extra samples depend on earlier batches: {DIVIDERS}").into());
    }
    if settings.estimator == EstimatorName::RestirDirect {
        return Err(format!("restir-direct weighs by its earlier passes: {DIVIDERS}").into());
    }
    if has_ranks && arguments.shard.is_some() {
        return Err("--shard: mpirun shares out the samples".into());
    }
    if has_ranks && arguments.continued.is_some() {
        return Err("--continue: one process only; with mpirun, --checkpoint".into());
    }
    if matches!(settings.budget, Budget::Seconds(_)) {
        if arguments.shard.is_some() {
            return Err("--shard divides a number of samples: give --spp, not --time".into());
        }
        let shrinks = settings.estimator == EstimatorName::Sppm || settings.photons.caustics;
        if has_ranks && (shrinks || settings.path_filter.is_some()) {
            return Err("the radius shrinks from sample to sample: with mpirun give --spp, not --time".into());
        }
    }
    Ok(())
}

/// Refuses parts some of which could not be rendered: all of them find it out, not the last one.
fn check_enough(
    shard: Shard,
    planned: u64,
    scene: &ReferenceScene,
    settings: &RenderSettings,
    has_ranks: bool,
) -> Result<(), Failure> {
    let parts = shard.of;
    if planned == 0 {
        return Ok(());
    }
    // Ranks without samples have nothing to do, and write nothing either.
    if planned < parts && !has_ranks {
        return Err(format!("--shard: {planned} samples per pixel are not enough for {parts} parts").into());
    }
    if let Some(name) = settings.path_filter {
        let (_, batch) = filter_and_batch(name, &settings.path_filtering(), scene.sensor())?;
        let multiple = parts.saturating_mul(batch);
        if !planned.is_multiple_of(multiple) {
            return Err(format!(
                "parts of filtered images are whole batches: --spp has to be a multiple of {multiple}, {parts} parts of --filter-batch {batch}"
            )
            .into());
        }
    }
    Ok(())
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
        size: Some(scene.sensor().resolution()),
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
    let mut image = finished(described, film, described.light_paths, described.count())?;
    let _ = image.set_attribute(SAMPLES, ranges(&described.samples));
    Ok(image)
}

/// Name of the attribute that tells which samples an image has.
const SAMPLES: &str = "samples";

/// Ranges of numbers of samples for people, ends not included: `0 to 16, 32 to 48`.
fn ranges(samples: &[[u64; 2]]) -> String {
    samples.iter().map(|[start, end]| format!("{start} to {end}")).collect::<Vec<_>>().join(", ")
}

/// What [`ranges`] wrote; nothing if it is anything else.
fn parse_ranges(text: &str) -> Option<Vec<[u64; 2]>> {
    let range = |range: &str| {
        let (start, end) = range.split_once(" to ")?;
        Some([start.parse().ok()?, end.parse().ok()?])
    };
    text.split(", ").map(range).collect()
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
    if let Some(path) = arguments.parts.iter().find(|path| matches!(ImageFormat::of(path), Ok(ImageFormat::Png))) {
        return Err(named(path, &"of a PNG nothing is left to be merged: give EXR images or checkpoints"));
    }
    let is_image = |path: &PathBuf| ImageFormat::of(path).is_ok();
    let image = match arguments.parts.iter().filter(|path| is_image(path)).count() {
        0 => merged_checkpoints(arguments)?,
        count if count == arguments.parts.len() => {
            if arguments.checkpoint.is_some() {
                return Err("images have no exact sums to be kept in a checkpoint".into());
            }
            merged_images(&arguments.parts)?
        }
        _ => return Err("either checkpoints or EXR images, not both".into()),
    };
    for path in &arguments.out {
        save_image(path, &image, arguments.exposure)?;
    }
    Ok(())
}

/// Settings that parts of an image may differ in: which samples they have, and who drew them.
const DIFFERENT: [&str; 3] = ["sampler", "seed", "renderer"];

fn merged_images(paths: &[PathBuf]) -> Result<LayeredImage, Failure> {
    let read = |path: &PathBuf| LayeredImage::read_exr(path).map_err(Failure::from);
    let images = paths.iter().map(read).collect::<Result<Vec<_>, _>>()?;
    let all: Vec<_> = paths.iter().zip(&images).collect();
    check_alike(&all)?;
    let samples = samples_of(&all)?;
    let mut merged = LayeredImage::merge(&images).map_err(|error| match error {
        LayeredImageError::NoSampleCount(index) => named(
            &paths[index],
            &"it does not tell how many samples per pixel it has (attribute 'spp'), by which images are weighed",
        ),
        error => error.into(),
    })?;
    if let Some(samples) = samples {
        let _ = merged.set_attribute(SAMPLES, ranges(&samples));
    }
    Ok(merged)
}

fn text(image: &LayeredImage, key: &str) -> Option<String> {
    image.attribute(key).map(ToString::to_string)
}

/// Refuses images of different renderings.
fn check_alike(all: &[(&PathBuf, &LayeredImage)]) -> Result<(), Failure> {
    let Some((first_path, first)) = all.first() else { return Ok(()) };
    for (path, image) in all {
        let refuse = |what: String| Err(named(path, &format!("it {what}")));
        let [[a, b], [c, d]] = [first, image].map(|image| [image.width(), image.height()]);
        if [a, b] != [c, d] {
            return refuse(format!("has {c} x {d} pixels, and {} has {a} x {b}", first_path.display()));
        }
        if let Some((name, _)) = first.channels().find(|(name, _)| image.channel(name).is_none()) {
            return refuse(format!("has no channel '{name}', as {} has", first_path.display()));
        }
        if let Some((name, _)) = image.channels().find(|(name, _)| first.channel(name).is_none()) {
            return refuse(format!("has a channel '{name}', and {} has none", first_path.display()));
        }
    }
    // Of three, the first may be silent about what the others differ in.
    for (index, (path, image)) in all.iter().enumerate() {
        for (earlier_path, earlier) in &all[..index] {
            if let Some((key, [one, other])) = difference(|key| text(earlier, key), |key| text(image, key), &DIFFERENT)
            {
                let message = format!("its {key} is '{other}', that of {} '{one}'", earlier_path.display());
                return Err(named(path, &message));
            }
        }
    }
    Ok(())
}

/// Refuses samples that are in two images; all of them, if all images tell theirs and were drawn by the same numbers.
fn samples_of(all: &[(&PathBuf, &LayeredImage)]) -> Result<Option<Vec<[u64; 2]>>, Failure> {
    // Other seeds and samplers are other samples, whatever their numbers.
    let drawn_by = |image: &LayeredImage| [text(image, "seed"), text(image, "sampler")];
    let mut taken: Vec<([u64; 2], [Option<String>; 2])> = Vec::new();
    let mut are_known = true;
    for (path, image) in all {
        let Some(samples) = text(image, SAMPLES).and_then(|samples| parse_ranges(&samples)) else {
            are_known = false;
            continue;
        };
        for [start, end] in samples {
            let overlaps = |(range, by): &([u64; 2], _)| *by == drawn_by(image) && start < range[1] && range[0] < end;
            if taken.iter().any(overlaps) {
                return Err(named(path, &format!("its samples {start} to {end} are in another image, too")));
            }
            taken.push(([start, end], drawn_by(image)));
        }
    }
    let are_one_sequence = taken.windows(2).all(|pair| pair[0].1 == pair[1].1);
    let mut samples: Vec<_> = taken.into_iter().map(|(range, _)| range).collect();
    samples.sort_unstable();
    Ok((are_known && are_one_sequence).then_some(samples))
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
        report(&format!("warning: of {planned} samples per pixel there are only {}", ranges(samples)));
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
    fn ranges_are_written_and_read() {
        for samples in [vec![[0, 16]], vec![[0, 1], [2, 3], [70, 1 << 40]]] {
            assert_eq!(parse_ranges(&ranges(&samples)), Some(samples));
        }
        assert_eq!(ranges(&[[0, 16], [32, 48]]), "0 to 16, 32 to 48");
        for other in ["", "0", "0 to", "a to b", "0-16"] {
            assert_eq!(parse_ranges(other), None, "{other}");
        }
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
        for of in [2, 3, 64, 1000, 100_000] {
            let end_of_last = (1..=of).fold(0, |next, number| {
                let samples = Shard { number, of }.endless();
                assert!(samples.start == next && samples.end > next + MAX_PASS, "{number} of {of}");
                samples.end
            });
            assert!(end_of_last <= 1 << 27, "{of}");
        }
        assert_eq!("2/8".parse(), Ok(Shard { number: 2, of: 8 }));
        assert_eq!(Shard { number: 2, of: 8 }.file(Path::new("a/b.part")), Path::new("a/b.part.2-of-8"));
        for bad in ["0/4", "5/4", "1", "1/0", "a/b", "-1/2"] {
            assert!(bad.parse::<Shard>().is_err(), "{bad}");
        }
    }
}
