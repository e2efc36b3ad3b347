//! Independent numbers that break one law each.

use std::sync::atomic::{AtomicU64, Ordering};

use qmc_sampling::{Independent, IndependentSampler, Sampler, SamplerFamily, Split};

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Lie {
    Nothing,
    ReachesOne,
    ForgetsTheSeed,
    CountsCalls,
    ForkDependsOnUse,
    ForkIsACopy,
    IgnoresTheDomain,
    IgnoresTheStream,
    IgnoresTheIndex,
    SkewsSingles,
    SkewsPairs,
    RepeatsADimension,
    ForkLeaks,
    DomainsLeak,
    NeighboursLeak,
    ChildIsTheFork,
    ChildDependsOnUse,
    ChildrenAreSkewed,
}

pub(crate) struct Liar {
    lie: Lie,
    family: Independent,
    calls: AtomicU64,
}

impl Liar {
    pub(crate) fn new(lie: Lie, seed: u64) -> Self {
        let seed = if lie == Lie::ForgetsTheSeed { 1 } else { seed };
        Self { lie, family: Independent::new(seed), calls: AtomicU64::new(0) }
    }
}

/// A little beside a number: another one, but not independent of it.
fn beside(x: f32) -> f32 {
    (x + 0.01).fract()
}

impl SamplerFamily for Liar {
    type Sampler = LiarSampler;

    fn sampler(&self, stream: u64, index: u64) -> LiarSampler {
        let lie = self.lie;
        let stream = match lie {
            Lie::IgnoresTheStream => 0,
            Lie::CountsCalls => stream + (self.calls.fetch_add(1, Ordering::Relaxed) << 50),
            _ => stream,
        };
        let index = if lie == Lie::IgnoresTheIndex { 0 } else { index };
        let mut sampler = LiarSampler::of(lie, self.family.sampler(stream, index));
        if lie == Lie::NeighboursLeak && stream % 2 == 1 {
            sampler.first_pair = Some(beside(self.family.sampler(stream - 1, index).next_2d()[0]));
        }
        sampler
    }
}

#[derive(Clone)]
pub(crate) struct LiarSampler {
    lie: Lie,
    start: IndependentSampler,
    numbers: IndependentSampler,
    taken: u32,
    last: f32,
    first_single: Option<f32>,
    first_pair: Option<f32>,
}

impl LiarSampler {
    fn of(lie: Lie, numbers: IndependentSampler) -> Self {
        let start = numbers.clone();
        Self { lie, start, numbers, taken: 0, last: 0.5, first_single: None, first_pair: None }
    }
}

impl Sampler for LiarSampler {
    fn next_1d(&mut self) -> f32 {
        self.taken += 1;
        let x = self.numbers.next_1d();
        match self.lie {
            Lie::ReachesOne if x > 0.999 => 1.0,
            Lie::SkewsSingles => x.powf(1.1).min(0.999_999),
            Lie::RepeatsADimension => self.last,
            _ => self.first_single.take().unwrap_or(x),
        }
    }

    fn next_2d(&mut self) -> [f32; 2] {
        self.taken += 1;
        let [x, y] = self.numbers.next_2d();
        self.last = y;
        let x = self.first_pair.take().unwrap_or(x);
        if self.lie == Lie::SkewsPairs { [x.powf(1.1).min(0.999_999), y] } else { [x, y] }
    }

    fn fork(&self, domain: u32) -> Self {
        let lie = self.lie;
        match lie {
            Lie::ForkDependsOnUse => Self::of(lie, self.start.fork(domain + 100 * self.taken)),
            Lie::ForkIsACopy => Self::of(lie, self.start.clone()),
            Lie::IgnoresTheDomain => Self::of(lie, self.start.fork(7)),
            Lie::ForkLeaks => {
                let leak = beside(self.start.clone().next_2d()[0]);
                Self { first_single: Some(leak), ..Self::of(lie, self.start.fork(domain)) }
            }
            Lie::DomainsLeak if domain == 2 => {
                let leak = beside(self.start.fork(1).next_1d());
                Self { first_single: Some(leak), ..Self::of(lie, self.start.fork(2)) }
            }
            _ => Self::of(lie, self.start.fork(domain)),
        }
    }
}

impl Split for LiarSampler {
    fn split(&self, domain: u32, children: u32, child: u32) -> Self {
        match self.lie {
            Lie::ChildIsTheFork => self.fork(domain),
            Lie::ChildDependsOnUse => Self::of(self.lie, self.start.split(domain + 100 * self.taken, children, child)),
            Lie::ChildrenAreSkewed => Self::of(Lie::SkewsPairs, self.start.split(domain, children, child)),
            lie => Self::of(lie, self.start.split(domain, children, child)),
        }
    }
}
