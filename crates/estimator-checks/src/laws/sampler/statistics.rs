//! What is random about samplers: over independent families, every number and every pair of numbers is uniform.

use qmc_sampling::{Sampler, SamplerFamily};

use super::{INDICES, STREAMS, sampler_laws};
use crate::outcome::{Outcome, Report};
use crate::pearson::chi_square_counts;
use crate::suite::Check;

/// How many families are drawn.
pub(super) const FAMILIES: usize = 40_000;

/// The parts of the statistical laws: which pairs of numbers are looked at.
const PARTS: [&str; 6] = [
    "the first pair",
    "the second pair",
    "successive dimensions",
    "a stream and its fork",
    "forks of two domains",
    "two streams",
];

/// Checks the laws of a sampler family and of its samplers.
///
/// ```text
/// (1)  all numbers lie in [0, 1)
/// (2)  samplers of the same stream and index, and clones, hand out the same numbers; those of others do not
/// (3)  fork(d) does not depend on how many numbers were taken; other domains, and forks of forks, are other streams
/// (4)  over independent families, pairs of numbers of one path are uniform in the unit square         chi-square
/// (5)  so are one number of a path and one of its fork, of two of its forks, of two streams
/// ```
///
/// (4) implies that each number is uniform, and that two dimensions are independent: the first two numbers, the next
/// two, the second and the third. For quasi-Monte Carlo points only families of different seeds are independent, so each
/// pair comes from a family of its own; stream and index vary, pixels and others among them.
///
/// (1) to (3) are exact. The six parts of (4) and (5) share the level of the check. Assumes that families of different seeds are
/// independent; a family that takes no seed is rejected. Cost: 40 000 families, unless set.
///
/// ```
/// use estimator_checks::{Check, laws::sampler::SamplerLaws};
/// use qmc_sampling::sampler::GlobalHalton;
///
/// let family = |seed| GlobalHalton::new(64, 64, seed).expect("64 pixels are not too many");
/// // One sequence for all pixels: they are not independent of each other.
/// SamplerLaws::new().related_streams().run(Check::new("global", 1e-6)?, family).expect_pass();
/// # Ok::<(), estimator_checks::SuiteError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SamplerLaws {
    families: usize,
    streams: Vec<u64>,
    related: bool,
}

impl Default for SamplerLaws {
    fn default() -> Self {
        Self::new()
    }
}

impl SamplerLaws {
    /// 40 000 families; streams 0, 1, 63, 64 and one that is no pixel; independent streams.
    pub fn new() -> Self {
        Self { families: FAMILIES, streams: STREAMS.into(), related: false }
    }

    /// How many families are drawn.
    #[must_use]
    pub fn families(self, families: usize) -> Self {
        Self { families, ..self }
    }

    /// The streams that are asked for. Without any, the check is undecided.
    #[must_use]
    pub fn streams(self, streams: impl Into<Vec<u64>>) -> Self {
        Self { streams: streams.into(), ..self }
    }

    /// Leaves out that streams are independent: for families that say how they are related.
    #[must_use]
    pub fn related_streams(self) -> Self {
        Self { related: true, ..self }
    }

    /// Checks the laws. `family` makes the family of a seed.
    #[must_use = "it decides nothing until it is expected to pass or to reject"]
    pub fn run<F: SamplerFamily>(&self, check: Check, family: impl Fn(u64) -> F) -> Report {
        let exact = Outcome::of_laws(check.test(), sampler_laws(&family(check.seed()), &self.streams));
        let mut uniforms = check.uniforms();
        let mut parts = PARTS.map(|_| Histogram::new([16, 16]));
        let families = if self.streams.is_empty() { 0 } else { self.families };
        for i in 0..families {
            let stream = self.streams[i % self.streams.len()];
            let index = INDICES[i / self.streams.len() % INDICES.len()];
            let family = family(uniforms.next_u64());
            let mut sampler = family.sampler(stream, index);
            let [mut fork, mut other] = [sampler.fork(1), sampler.fork(2)];
            let mut neighbour = family.sampler(stream ^ 1, index);
            let first = sampler.next_2d();
            let single = sampler.next_1d();
            let second = sampler.next_2d();
            let forked = fork.next_1d();
            let pairs = [
                first,
                second,
                [first[1], single],
                [first[0], forked],
                [forked, other.next_1d()],
                [first[0], neighbour.next_2d()[0]],
            ];
            parts.iter_mut().zip(pairs).for_each(|(part, pair)| part.add(pair));
        }
        let checks = check.split(PARTS);
        let judged = parts.into_iter().zip(checks).take(PARTS.len() - usize::from(self.related));
        Report { outcomes: std::iter::once(exact).chain(judged.map(|(part, check)| part.judge(check))).collect() }
    }
}

/// Counts of pairs in a grid.
#[derive(Debug)]
pub(super) struct Histogram {
    grid: [usize; 2],
    counts: Vec<u64>,
}

impl Histogram {
    pub(super) fn new(grid: [usize; 2]) -> Self {
        Self { grid, counts: vec![0; grid[0] * grid[1]] }
    }

    /// What is no number in `[0, 1)` goes to the nearest cell: that it is none is another law.
    pub(super) fn add(&mut self, [x, y]: [f32; 2]) {
        let cell = |x: f32, n: usize| ((x * n as f32) as usize).min(n - 1);
        self.counts[cell(y, self.grid[1]) * self.grid[0] + cell(x, self.grid[0])] += 1;
    }

    pub(super) fn judge(self, check: Check) -> Outcome {
        let uniform = vec![1.0 / self.counts.len() as f64; self.counts.len()];
        chi_square_counts(check, &self.counts, &uniform)
    }
}
