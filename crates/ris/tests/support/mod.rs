//! Finite state spaces, enumerated completely: expectations are sums, and no test of them can fail by chance.

#![allow(dead_code, unreachable_pub, reason = "each test uses its part of it")]

use ris::{Budget, Expectations, Resampled, Source, from_fn};

/// Number of states.
pub const STATES: usize = 3;

/// An integrand, a target and a source over the states; sums take the place of integrals.
#[derive(Clone, Copy, Debug)]
pub struct Problem {
    pub f: [f64; STATES],
    pub g: [f64; STATES],
    pub p: [f64; STATES],
}

impl Problem {
    /// Anything from smooth to spiky, positive everywhere.
    pub fn random(random: &mut Random) -> Self {
        let mut value = || core::array::from_fn(|_| 10_f64.powf(2.0 * random.next() - 1.0));
        let (f, g, p): ([f64; STATES], _, [f64; STATES]) = (value(), value(), value());
        let sum: f64 = p.iter().sum();
        Self { f, g, p: p.map(|p| p / sum) }
    }

    pub fn integral(&self) -> f64 {
        self.f.iter().sum()
    }

    fn expect(&self, of: impl Fn(usize) -> f64) -> f64 {
        (0..STATES).filter(|&x| self.p[x] > 0.0).map(|x| self.p[x] * of(x)).sum()
    }

    /// By definition.
    pub fn expectations(&self) -> Expectations {
        let Self { f, g, p } = self;
        Expectations {
            e1: self.expect(|x| f[x] / p[x]).powi(2),
            e2: self.expect(|x| f[x] * f[x] / (g[x] * p[x])) * self.expect(|x| g[x] / p[x]),
            e3: self.expect(|x| (f[x] / p[x]).powi(2)),
        }
    }

    /// The source, by inversion. What probability is left is state number `STATES`, of density zero.
    pub fn source(&self) -> impl Source<usize, f64> + use<> {
        let p = self.p;
        let density = move |x: &usize| p.get(*x).copied().unwrap_or(0.0);
        from_fn(
            move |uniform: &mut dyn FnMut() -> f64| {
                let x = invert(&p, uniform());
                (x, density(&x))
            },
            density,
        )
    }

    pub fn target(&self) -> impl Fn(&usize) -> f64 + use<> {
        let g = self.g;
        move |x| g.get(*x).copied().unwrap_or(0.0)
    }

    /// The number that makes the source draw a state, its probability, and the weight `g/p`.
    fn choices(&self) -> Vec<Choice> {
        choices(&self.p).map(|(x, u, probability)| Choice { u, probability, weight: self.g[x] / self.p[x] }).collect()
    }

    /// What resampling `candidates` of the problem's own can return, with its probabilities.
    pub fn resampled(&self, candidates: usize) -> Vec<(Resampled<usize, f64>, f64)> {
        let steps = vec![Step::Candidate(self.choices()); candidates];
        let mut outcomes = Vec::new();
        walk(&steps, &mut |numbers, probability| {
            let mut numbers = numbers.iter().copied();
            let mut reservoir = ris::Reservoir::new();
            while let Some(u) = numbers.next() {
                let x = invert(&self.p, u);
                reservoir.update(x, self.g[x], 1.0 / self.p[x], numbers.next().unwrap());
            }
            outcomes.push((reservoir.finish(), probability));
        });
        outcomes
    }

    /// Every sequence of numbers that [`ris::Ris`] can meet, but for those that decide the same, with its probability.
    pub fn for_each_sequence(&self, budget: Budget, visit: &mut dyn FnMut(&[f64], f64)) {
        for (samples, first) in roundings(budget.samples()) {
            // All combinations of the samples' numbers of candidates.
            let mut all = vec![first];
            for _ in 0..samples {
                let mut longer = Vec::new();
                for steps in &all {
                    for (candidates, rounding) in roundings(budget.candidates()) {
                        let mut steps = steps.clone();
                        steps.extend(rounding);
                        steps.push(Step::NewSample);
                        let step = if candidates == 1 {
                            // Importance sampling: nothing is selected.
                            Step::Number(self.choices().iter().map(|c| (c.u, c.probability)).collect())
                        } else {
                            Step::Candidate(self.choices())
                        };
                        steps.extend(vec![step; candidates]);
                        longer.push(steps);
                    }
                }
                all = longer;
            }
            all.iter().for_each(|steps| walk(steps, visit));
        }
    }
}

/// State, number and probability of what has a probability.
pub fn choices(p: &[f64]) -> impl Iterator<Item = (usize, f64, f64)> + use<> {
    let mut below = 0.0;
    let all: Vec<_> = p
        .iter()
        .enumerate()
        .map(|(x, &p)| {
            below += p;
            (x, below - 0.5 * p, p)
        })
        .filter(|&(_, _, p)| p > 0.0)
        .collect();
    all.into_iter()
}

/// The state that a number stands for.
pub fn invert(p: &[f64], u: f64) -> usize {
    let mut below = 0.0;
    for (x, p) in p.iter().enumerate() {
        below += p;
        if u < below {
            return x;
        }
    }
    p.len()
}

/// The counts that a real number is rounded to, each with the step that makes it so.
fn roundings(count: f64) -> Vec<(usize, Vec<Step>)> {
    let (floor, part) = (count.floor(), count.fract());
    if part == 0.0 {
        return vec![(floor as usize, vec![])];
    }
    let at = |u: f64, probability: f64| vec![Step::Number(vec![(u, probability)])];
    vec![(floor as usize, at(0.5 * (1.0 + part), 1.0 - part)), (floor as usize + 1, at(0.5 * part, part))]
}

/// A way to draw a candidate.
#[derive(Clone, Debug)]
pub struct Choice {
    pub u: f64,
    pub probability: f64,
    pub weight: f64,
}

/// What happens one after the other.
#[derive(Clone, Debug)]
pub enum Step {
    /// A number with the values that matter, and their probabilities.
    Number(Vec<(f64, f64)>),
    /// A number draws a candidate, the next one selects.
    Candidate(Vec<Choice>),
    /// A number selects among this weight and those before.
    Select(f64),
    /// Selection begins anew.
    NewSample,
}

/// How close to the edges of their intervals the numbers lie: a threshold that is off shows.
const EDGE: f64 = 1e-12;

/// Visits every sequence of numbers with its probability.
pub fn walk(steps: &[Step], visit: &mut dyn FnMut(&[f64], f64)) {
    go(steps, &mut Vec::new(), 1.0, 0.0, visit);
}

fn go(steps: &[Step], numbers: &mut Vec<f64>, probability: f64, sum: f64, visit: &mut dyn FnMut(&[f64], f64)) {
    let Some((first, rest)) = steps.split_first() else { return visit(numbers, probability) };
    match first {
        Step::NewSample => go(rest, numbers, probability, 0.0, visit),
        Step::Number(values) => {
            for &(u, p) in values {
                numbers.push(u);
                go(rest, numbers, probability * p, sum, visit);
                numbers.pop();
            }
        }
        Step::Candidate(choices) => {
            for choice in choices {
                numbers.push(choice.u);
                select(choice.weight, rest, numbers, probability * choice.probability, sum, visit);
                numbers.pop();
            }
        }
        Step::Select(weight) => select(*weight, rest, numbers, probability, sum, visit),
    }
}

fn select(
    weight: f64,
    rest: &[Step],
    numbers: &mut Vec<f64>,
    probability: f64,
    sum: f64,
    visit: &mut dyn FnMut(&[f64], f64),
) {
    let sum = sum + weight;
    let share = if weight > 0.0 { weight / sum } else { 0.0 };
    let branches = [((1.0 - EDGE) * share, share), (share + EDGE * (1.0 - share), 1.0 - share)];
    for (u, p) in branches {
        if p > 0.0 {
            numbers.push(u.min(1.0 - EDGE));
            go(rest, numbers, probability * p, sum, visit);
            numbers.pop();
        }
    }
}

/// `E[W; Y = x]` of each state: one wherever an estimator is unbiased for any integrand.
pub fn contributions<'a>(outcomes: impl IntoIterator<Item = &'a (Resampled<usize, f64>, f64)>) -> [f64; STATES] {
    let (mut sum, mut total) = ([0.0; STATES], 0.0);
    for (resampled, probability) in outcomes {
        total += probability;
        if let Some(&x) = resampled.sample() {
            sum[x] += probability * resampled.contribution_weight();
        }
    }
    assert!((total - 1.0).abs() < 1e-12, "probabilities sum to {total}");
    sum
}

/// Whether two numbers are the same but for rounding.
#[track_caller]
pub fn assert_close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * (1.0 + a.abs().max(b.abs())), "{a} is not {b}");
}

/// PCG32 of a fixed seed.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mixed = (((self.0 >> 18) ^ self.0) >> 27) as u32;
        f64::from(mixed.rotate_right((self.0 >> 59) as u32)) / 4_294_967_296.0
    }
}
