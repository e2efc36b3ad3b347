//! The laws of the traits of `qmc-sampling`: `Sampler` with `SamplerFamily`, `Split`, `Sequence` and `ImageSequence`.

mod statistics;

use qmc_sampling::image::ImageSequence;
use qmc_sampling::{Sampler, SamplerFamily, Sequence, Split};

pub use statistics::SamplerLaws;

use super::{Law, hold};
use crate::outcome::{Outcome, Report};
use crate::suite::Check;

/// Streams and indices that are asked for, unless [`SamplerLaws`] says otherwise: pixels, and what is none.
const STREAMS: [u64; 5] = [0, 1, 63, 64, 1 << 40];
const INDICES: [u64; 4] = [0, 1, 5, 63];
/// How many numbers are taken from one sampler.
const NUMBERS: usize = 256;

/// Checks the laws of a [`SamplerFamily`] and of its samplers with the default [`SamplerLaws`].
///
/// `family` makes the family of a seed: stratified samples depend on each other, so only independent randomisations can
/// be tested by statistics.
///
/// ```
/// use estimator_checks::{Check, laws::sampler::check_sampler};
/// use qmc_sampling::OwenSobol;
///
/// check_sampler(Check::new("Owen-scrambled Sobol points", 1e-6)?, OwenSobol::new).expect_pass();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_sampler<F: SamplerFamily>(check: Check, family: impl Fn(u64) -> F) -> Report {
    SamplerLaws::new().run(check, family)
}

/// The laws that hold exactly.
fn sampler_laws<F: SamplerFamily>(family: &F, streams: &[u64]) -> Law {
    let mut firsts = Vec::new();
    for &stream in streams {
        for index in INDICES {
            let at = || format!("stream {stream}, index {index}");
            let sampler = family.sampler(stream, index);
            let numbers = take(sampler.clone());
            in_range(&numbers, at)?;
            let same = |other: F::Sampler| bits(&take(other)) == bits(&numbers);
            hold("two samplers made alike hand out the same numbers", same(family.sampler(stream, index)), at)?;
            hold("a clone replays the numbers", same(sampler.clone()), at)?;
            forks(&sampler, &numbers, at)?;
            firsts.push((bits(&numbers[..8]), stream, index));
        }
    }
    firsts.sort_unstable();
    for pair in firsts.windows(2) {
        let [(a, stream, index), (b, other, next)] = pair else { continue };
        let shown = || format!("stream {stream}, index {index} and stream {other}, index {next} begin alike");
        hold("different paths get different numbers", a != b, shown)?;
    }
    Ok(())
}

fn forks<S: Sampler>(sampler: &S, numbers: &[f32], at: impl Fn() -> String) -> Law {
    let fork = take(sampler.fork(3));
    in_range(&fork, &at)?;
    let mut used = sampler.clone();
    for taken in 0..9 {
        let same = bits(&take(used.fork(3))) == bits(&fork);
        let shown = || format!("it differs after {taken} pairs and numbers, {}", at());
        hold("a fork does not depend on how many numbers were taken", same, shown)?;
        used.next_2d();
        used.next_1d();
    }
    let others = [
        ("the stream it was forked from", numbers.to_vec()),
        ("that of another domain", take(sampler.fork(4))),
        ("that of domain 0", take(sampler.fork(0))),
        ("its own fork of the same domain", take(sampler.fork(3).fork(3))),
    ];
    for (what, other) in others {
        let shown = || format!("the fork of domain 3 begins like {what}, {}", at());
        hold("forks of different domains are different streams", other[..8] != fork[..8], shown)?;
    }
    Ok(())
}

/// Numbers, ones and pairs by turns.
fn take(mut sampler: impl Sampler) -> Vec<f32> {
    let mut numbers = Vec::with_capacity(NUMBERS + 3);
    while numbers.len() < NUMBERS {
        numbers.extend(sampler.next_2d());
        numbers.push(sampler.next_1d());
    }
    numbers
}

fn bits(numbers: &[f32]) -> Vec<u32> {
    numbers.iter().map(|x| x.to_bits()).collect()
}

fn in_range(numbers: &[f32], at: impl Fn() -> String) -> Law {
    match numbers.iter().position(|x| !(0.0..1.0).contains(x)) {
        Some(i) => hold("numbers lie in [0, 1)", false, || format!("number {i} is {}, {}", numbers[i], at())),
        None => Ok(()),
    }
}

/// Checks the laws of [`Split`]: what is not a law of a [`Sampler`] already.
///
/// ```text
/// (1)  numbers of children lie in [0, 1); the same child has the same numbers, whatever was taken from its sampler
/// (2)  children are no copies: of each other, of the fork of the same domain, of their sampler, of children of other counts
/// (3)  the first pair of a child is uniform, over independent families              chi-square
/// ```
///
/// `family` makes the family of a seed, as in [`check_sampler`]. The report has two outcomes.
///
/// ```
/// use estimator_checks::{Check, laws::sampler::check_split};
///
/// check_split(Check::new("children", 1e-6)?, qmc_sampling::OwenSobol::new).expect_pass();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_split<F: SamplerFamily<Sampler: Split>>(check: Check, family: impl Fn(u64) -> F) -> Report {
    let exact = Outcome::of_laws(check.test(), split_laws(&family(check.seed())));
    let mut pairs = statistics::Histogram::new([16, 16]);
    let mut uniforms = check.uniforms();
    for i in 0..statistics::FAMILIES {
        let path = family(uniforms.next_u64()).sampler(STREAMS[i % STREAMS.len()], INDICES[i % INDICES.len()]);
        pairs.add(path.split(1, 4, (i % 3) as u32).next_2d());
    }
    Report { outcomes: vec![exact, pairs.judge(check)] }
}

fn split_laws<F: SamplerFamily<Sampler: Split>>(family: &F) -> Law {
    for stream in STREAMS {
        let at = |child: u32| format!("child {child}, stream {stream}");
        let path = family.sampler(stream, 2);
        let mut used = path.clone();
        used.next_1d();
        used.next_2d();
        let mut all = vec![("the sampler".to_string(), take(path.clone())), ("the fork".into(), take(path.fork(1)))];
        for (children, child) in (0..4).flat_map(|child| [(4, child), (8, child)]) {
            let numbers = take(path.split(1, children, child));
            in_range(&numbers, || at(child))?;
            let same = bits(&take(used.split(1, children, child))) == bits(&numbers);
            hold("a child does not depend on how many numbers were taken", same, || at(child))?;
            for (name, other) in &all {
                let shown = || format!("{name} begins like {} of {children}", at(child));
                hold("children are no copies", other[..8] != numbers[..8], shown)?;
            }
            all.push((format!("child {child} of {children}"), numbers));
        }
    }
    Ok(())
}

/// Checks the laws of a [`Sequence`]: coordinates in `[0, 1)`, the same when asked for again and in another order; `sample_f32`
/// is `sample` rounded towards zero (to a number of 24 bits or more), `sample_2d` the first two coordinates. No chance is involved.
///
/// ```
/// use estimator_checks::laws::sampler::check_sequence;
///
/// check_sequence("Halton", &qmc_sampling::sequences::Halton::default()).expect_pass();
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_sequence(test: &str, sequence: &impl Sequence) -> Outcome {
    Outcome::of_laws(test, sequence_laws(sequence))
}

fn sequence_laws(sequence: &impl Sequence) -> Law {
    let dimensions = sequence.dimensions().min(40);
    hold("a sequence has dimensions", dimensions > 0, || "there are none".into())?;
    let indices: Vec<u64> = (0..200).chain([1 << 12, (1 << 16) - 1, 1 << 20]).collect();
    let points = || indices.iter().flat_map(|&i| (0..dimensions).map(move |d| (i, d)));
    let first: Vec<f64> = points().map(|(i, d)| sequence.sample(i, d)).collect();
    for ((i, d), &x) in points().zip(&first).collect::<Vec<_>>().into_iter().rev() {
        let at = |what: &str, y: f64| format!("{x} and {what}{y} at point {i}, dimension {d}");
        hold("coordinates lie in [0, 1)", (0.0..1.0).contains(&x), || format!("{x} at point {i}, dimension {d}"))?;
        let again = sequence.sample(i, d);
        hold("the same coordinate is the same again", x.to_bits() == again.to_bits(), || at("then ", again))?;
        let single = f64::from(sequence.sample_f32(i, d));
        let rounded = (0.0..1.0).contains(&single) && single <= x && x - single < 1.0 / 16_777_216.0;
        hold("sample_f32 is rounded towards zero", rounded, || at("in f32 ", single))?;
        let pair = sequence.sample_2d(i);
        if let Some(&y) = pair.get(d as usize).filter(|_| dimensions > 1) {
            hold("sample_2d is the first two coordinates", x == y, || at("in a pair ", y))?;
        }
    }
    Ok(())
}

/// Checks the laws of an [`ImageSequence`] on all its pixels (of an image of up to some thousand) and some batches.
///
/// ```text
/// (1)  pixel(index(p, b)) = p,   index(p, b) / batch_len = b         for all pixels p and batches b
/// (2)  all other points of a batch lie outside of the image
/// (3)  offset(i) in [0, 1)^2
/// ```
///
/// No chance is involved. Cost: four batches.
///
/// ```
/// use estimator_checks::laws::sampler::check_image_sequence;
/// use qmc_sampling::image::SobolImage;
///
/// check_image_sequence("13 by 40", &SobolImage::new(13, 40)?).expect_pass();
/// # Ok::<(), qmc_sampling::sequences::SequenceError>(())
/// ```
#[must_use = "it decides nothing until it is expected to pass or to reject"]
pub fn check_image_sequence(test: &str, image: &impl ImageSequence) -> Outcome {
    Outcome::of_laws(test, image_laws(image))
}

fn image_laws(image: &impl ImageSequence) -> Law {
    let ([width, height], length, batches) = (image.size(), image.batch_len(), image.batches());
    let pixels = u64::from(width) * u64::from(height);
    let shown = || format!("{length} points for {width} x {height} pixels");
    hold("a batch has a point for each pixel", length >= pixels && length > 0, shown)?;
    let some = [0, 1, batches / 2, batches.saturating_sub(1)];
    for batch in some.into_iter().filter(|&batch| batch < batches) {
        for pixel in (0..height).flat_map(|y| (0..width).map(move |x| [x, y])) {
            let index = image.index(pixel, batch);
            let (found, offset) = (image.pixel(index), image.offset(index));
            let shown = || format!("point {index} of batch {batch} is in {found:?}, not in {pixel:?}");
            hold("the point of a pixel falls into it", found == Some(pixel), shown)?;
            let shown = || format!("point {index} of pixel {pixel:?} is none of batch {batch}");
            hold("the point of a batch is one of its points", index / length == batch, shown)?;
            let inside = offset.iter().all(|x| (0.0..1.0).contains(x));
            hold("the place in the pixel lies in [0, 1)^2", inside, || format!("{offset:?} at point {index}"))?;
        }
        let hits = (batch * length..(batch + 1) * length).filter(|&index| image.pixel(index).is_some()).count() as u64;
        let shown = || format!("{hits} points of batch {batch} in {pixels} pixels");
        hold("a batch puts one point into each pixel", hits == pixels, shown)?;
    }
    Ok(())
}
