//! Samplers, families, sequences.

use std::cell::Cell;

use estimator_checks::laws::sampler::{SamplerLaws, check_image_sequence, check_sampler, check_sequence, check_split};
use qmc_sampling::image::{HaltonImage, ImageSequence, SobolImage};
use qmc_sampling::sampler::{FromSequence, GlobalHalton, GlobalSobol, PaddedLattice, ZSobol};
use qmc_sampling::sequences::{Halton, Lattice};
use qmc_sampling::{Independent, OwenSobol, Sequence};

use crate::sampler_lies::{Liar, Lie};
use crate::{SUITE, broken, broken_exactly, rejects};

#[test]
fn every_family_keeps_the_laws() {
    check_sampler(SUITE.check("independent"), Independent::new).expect_pass();
    check_sampler(SUITE.check("Owen-Sobol"), OwenSobol::new).expect_pass();
    check_sampler(SUITE.check("lattice"), PaddedLattice::new).expect_pass();
    check_sampler(SUITE.check("Halton"), |seed| FromSequence::new(Halton::default(), seed)).expect_pass();
    let related = SamplerLaws::new().related_streams();
    related.run(SUITE.check("Z-Sobol"), |seed| ZSobol::new(64, 64, 64, seed).unwrap()).expect_pass();
    related.run(SUITE.check("global Sobol"), |seed| GlobalSobol::new(64, 64, seed).unwrap()).expect_pass();
    related.run(SUITE.check("global Halton"), |seed| GlobalHalton::new(64, 64, seed).unwrap()).expect_pass();
}

#[test]
fn every_family_splits() {
    check_split(SUITE.check("split: independent"), Independent::new).expect_pass();
    check_split(SUITE.check("split: Owen-Sobol"), OwenSobol::new).expect_pass();
    check_split(SUITE.check("split: lattice"), PaddedLattice::new).expect_pass();
    check_split(SUITE.check("split: Z-Sobol"), |seed| ZSobol::new(64, 64, 64, seed).unwrap()).expect_pass();
}

#[test]
fn families_that_lie_are_rejected() {
    let run = |lie: Lie| check_sampler(SUITE.twin(&format!("{lie:?}")), |seed| Liar::new(lie, seed));
    run(Lie::Nothing).expect_pass();
    for (lie, law) in [
        (Lie::ReachesOne, "numbers lie in [0, 1)"),
        (Lie::CountsCalls, "two samplers made alike hand out the same numbers"),
        (Lie::ForkDependsOnUse, "a fork does not depend on how many numbers were taken"),
        (Lie::ForkIsACopy, "forks of different domains are different streams"),
        (Lie::IgnoresTheDomain, "forks of different domains are different streams"),
        (Lie::IgnoresTheStream, "different paths get different numbers"),
        (Lie::IgnoresTheIndex, "different paths get different numbers"),
    ] {
        assert_eq!(broken_exactly(run(lie)), law, "{lie:?}");
    }
    for (lie, part) in [
        (Lie::ForgetsTheSeed, "the first pair"),
        (Lie::SkewsPairs, "the second pair"),
        (Lie::SkewsSingles, "successive dimensions"),
        (Lie::RepeatsADimension, "successive dimensions"),
        (Lie::ForkLeaks, "a stream and its fork"),
        (Lie::DomainsLeak, "forks of two domains"),
        (Lie::NeighboursLeak, "two streams"),
    ] {
        rejects(run(lie), part);
    }
    // Streams that are related on purpose, and nothing to ask for.
    let related = SamplerLaws::new().related_streams();
    related.run(SUITE.twin("related"), |seed| Liar::new(Lie::NeighboursLeak, seed)).expect_pass();
    let none = SamplerLaws::new().streams([]).run(SUITE.twin("no streams"), Independent::new);
    assert!(!none.passed() && !none.rejected(), "{none}");
}

#[test]
fn children_that_lie_are_rejected() {
    let run = |lie: Lie| check_split(SUITE.twin(&format!("split: {lie:?}")), |seed| Liar::new(lie, seed));
    run(Lie::Nothing).expect_pass();
    assert_eq!(broken_exactly(run(Lie::ChildIsTheFork)), "children are no copies");
    let law = "a child does not depend on how many numbers were taken";
    assert_eq!(broken_exactly(run(Lie::ChildDependsOnUse)), law);
    rejects(run(Lie::ChildrenAreSkewed), "");
}

/// A sequence of closures: a coordinate in double and in single precision, and a pair.
#[derive(Clone, Copy)]
struct Of<D, S, P>(D, S, P);

impl<D, S, P> Sequence for Of<D, S, P>
where
    D: Fn(u64, u32) -> f64 + Copy,
    S: Fn(f64) -> f32 + Copy,
    P: Fn([f64; 2]) -> [f64; 2] + Copy,
{
    fn dimensions(&self) -> u32 {
        5
    }
    fn sample(&self, index: u64, dimension: u32) -> f64 {
        (self.0)(index, dimension)
    }
    fn sample_f32(&self, index: u64, dimension: u32) -> f32 {
        (self.1)(self.sample(index, dimension))
    }
    fn sample_2d(&self, index: u64) -> [f64; 2] {
        (self.2)([self.sample(index, 0), self.sample(index, 1)])
    }
}

#[test]
fn sequences() {
    check_sequence("Halton", &Halton::default()).expect_pass();
    check_sequence("lattice", &Lattice::default()).expect_pass();
    let at = |i: u64, d: u32| Halton::default().sample(i, d);
    let down = |x: f64| (x * 16_777_216.0).floor() as f32 / 16_777_216.0;
    check_sequence("closures", &Of(at, down, |pair| pair)).expect_pass();
    let range = "coordinates lie in [0, 1)";
    assert_eq!(broken(check_sequence("one", &Of(|i, d| at(i, d).max(f64::from(d)), down, |pair| pair))), range);
    assert_eq!(broken(check_sequence("nan", &Of(|i, d| at(i, d) + 0.0 / f64::from(d), down, |pair| pair))), range);
    let count = Cell::new(0);
    let counting = |i, d| {
        count.set(count.get() + 1);
        at(i + count.get() / 1000, d)
    };
    assert_eq!(
        broken(check_sequence("counting", &Of(counting, down, |pair| pair))),
        "the same coordinate is the same again"
    );
    let rounded = "sample_f32 is rounded towards zero";
    assert_eq!(broken(check_sequence("nearest", &Of(at, |x| x as f32, |pair| pair))), rounded);
    let swapped = broken(check_sequence("swapped", &Of(at, down, |[x, y]: [f64; 2]| [y, x])));
    assert_eq!(swapped, "sample_2d is the first two coordinates");
}

/// An image whose answers are changed.
struct Changed<I, P, O> {
    image: I,
    index: fn(u64) -> u64,
    pixel: P,
    offset: O,
}

impl<I: ImageSequence, P: Fn(Option<[u32; 2]>) -> Option<[u32; 2]>, O: Fn([f64; 2]) -> [f64; 2]> ImageSequence
    for Changed<I, P, O>
{
    fn size(&self) -> [u32; 2] {
        self.image.size()
    }
    fn batch_len(&self) -> u64 {
        self.image.batch_len()
    }
    fn batches(&self) -> u64 {
        self.image.batches()
    }
    fn pixel(&self, index: u64) -> Option<[u32; 2]> {
        (self.pixel)(self.image.pixel(index % (1 << 60)))
    }
    fn index(&self, pixel: [u32; 2], batch: u64) -> u64 {
        (self.index)(self.image.index(pixel, batch))
    }
    fn offset(&self, index: u64) -> [f64; 2] {
        (self.offset)(self.image.offset(index % (1 << 60)))
    }
}

#[test]
fn images() {
    check_image_sequence("Sobol", &SobolImage::new(13, 40).unwrap()).expect_pass();
    check_image_sequence("Halton", &HaltonImage::new(100, 3).unwrap()).expect_pass();
    let image = || SobolImage::new(5, 7).unwrap();
    fn run(
        index: fn(u64) -> u64,
        pixel: impl Fn(Option<[u32; 2]>) -> Option<[u32; 2]>,
        offset: impl Fn([f64; 2]) -> [f64; 2],
    ) -> estimator_checks::Outcome {
        check_image_sequence("changed", &Changed { image: SobolImage::new(5, 7).unwrap(), index, pixel, offset })
    }
    run(|i| i, |p| p, |at| at).expect_pass();
    assert_eq!(image().batch_len(), 64);
    assert_eq!(broken(run(|i| i ^ 1, |p| p, |at| at)), "the point of a pixel falls into it");
    assert_eq!(broken(run(|i| i, |p| p.filter(|p| p[0] > 0), |at| at)), "the point of a pixel falls into it");
    let full = |p: Option<[u32; 2]>| p.or(Some([0, 0]));
    assert_eq!(broken(run(|i| i, full, |at| at)), "a batch puts one point into each pixel");
    assert_eq!(broken(run(|i| i + (1 << 60), |p| p, |at| at)), "the point of a batch is one of its points");
    assert_eq!(broken(run(|i| i, |p| p, |at| at.map(|x| x + 0.1))), "the place in the pixel lies in [0, 1)^2");
}
