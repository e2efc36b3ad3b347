//! A histogram over a domain, and the counts that a density lets us expect in it.

use crate::domain::{Coordinates, Domain, IntoPoint};
use crate::outcome::Outcome;
use crate::quadrature::{Hint, Integral, Rectangle, integrate};
use crate::suite::Check;
use crate::verdict::{Undecided, Violation};

/// How many samples of a cell are kept, to show the quadrature where the density is.
const HINTS: usize = 64;

/// The quadrature error of a cell's expected count may be this part of the count's standard deviation.
const ERROR_PER_DEVIATION: f64 = 0.01;

/// A sample this close (in parameters) to a cell of positive density may have been rounded across the edge.
const EDGE: f64 = 2e-6;

/// Why a check ended before its statistic was computed.
pub(crate) enum Stop {
    Violation(Violation),
    Undecided(Undecided),
}

impl From<Violation> for Stop {
    fn from(violation: Violation) -> Self {
        Self::Violation(violation)
    }
}

impl From<Undecided> for Stop {
    fn from(reason: Undecided) -> Self {
        Self::Undecided(reason)
    }
}

impl Stop {
    pub(crate) fn into_outcome(self, check: Check, method: &str) -> Outcome {
        match self {
            Self::Violation(violation) => Outcome::violation(check, method, violation),
            Self::Undecided(reason) => Outcome::undecided(check, method, reason),
        }
    }
}

/// Evaluates a density and refuses what cannot be one.
pub(crate) fn checked_density<P: Coordinates>(density: &impl Fn(P) -> f64, point: P) -> Result<f64, Violation> {
    let value = density(point);
    if !value.is_finite() {
        return Err(Violation::NotFinite { what: "density", at: format!("{point:?}") });
    }
    if value < 0.0 {
        return Err(Violation::NegativeDensity { density: value, at: format!("{point:?}") });
    }
    Ok(value)
}

/// Converts a sample and refuses what is not a number.
pub(crate) fn checked_point<P: Coordinates>(sample: impl IntoPoint<P>) -> Result<P, Violation> {
    let point = sample.into_point();
    if point.is_finite() { Ok(point) } else { Err(Violation::NotFinite { what: "sample", at: format!("{point:?}") }) }
}

/// A histogram over a regular grid in the parameters of a domain, whose cells have equal measure.
pub(crate) struct Bins<'a, D: Domain> {
    domain: &'a D,
    shape: [usize; 2],
    counts: Vec<u64>,
    hints: Vec<Vec<Hint>>,
}

/// The expected probability of each cell.
pub(crate) struct Masses {
    pub(crate) cells: Vec<f64>,
    pub(crate) total: Integral,
}

impl<'a, D: Domain> Bins<'a, D> {
    pub(crate) fn new(domain: &'a D, shape: [usize; 2]) -> Self {
        let shape = if D::DIMENSIONS == 1 { [shape[0] * shape[1], 1] } else { shape };
        let cells = shape[0] * shape[1];
        Self { domain, shape, counts: vec![0; cells], hints: vec![Vec::new(); cells] }
    }

    /// Counts a sample at which the density is known.
    pub(crate) fn add(&mut self, point: D::Point, density: f64) -> Result<(), Violation> {
        let at =
            self.domain.parameters(point).ok_or_else(|| Violation::OutsideDomain { sample: format!("{point:?}") })?;
        let cell = self.cell(at);
        self.counts[cell] += 1;
        let hint = Hint { at, value: density * self.domain.measure() };
        let hints = &mut self.hints[cell];
        // Keep the first ones, which lie where the mass is, and the highest, which lies on the peak.
        if hints.len() < HINTS {
            hints.push(hint);
        } else if hint.value > hints[HINTS - 1].value {
            hints[HINTS - 1] = hint;
        }
        Ok(())
    }

    fn cell(&self, [u, v]: [f64; 2]) -> usize {
        let [rows, columns] = self.shape;
        let row = ((u * rows as f64) as usize).min(rows - 1);
        let column = ((v * columns as f64) as usize).min(columns - 1);
        row * columns + column
    }

    /// Integrates the density over each cell, to an accuracy that `samples` samples cannot resolve.
    pub(crate) fn masses(
        &self,
        density: &impl Fn(D::Point) -> f64,
        samples: usize,
        budget: usize,
    ) -> Result<Masses, Stop> {
        let measure = self.domain.measure();
        let mut f = |at| Ok(checked_density(density, self.domain.point(at))? * measure);
        let n = samples as f64;
        let tolerance = |mass: f64| ERROR_PER_DEVIATION * (mass * n + 1.0).sqrt() / n;
        let mut total = Integral { value: 0.0, error: 0.0, evaluations: 0, converged: true };
        let mut cells = Vec::with_capacity(self.counts.len());
        for (index, hints) in self.hints.iter().enumerate() {
            let rectangle = Rectangle::cell(index, self.shape);
            let left = budget.saturating_sub(total.evaluations);
            let mass = integrate(D::DIMENSIONS, [rectangle], hints, &mut f, tolerance, left)?;
            total.value += mass.value;
            total.error += mass.error;
            total.evaluations += mass.evaluations;
            total.converged &= mass.converged;
            cells.push(mass.value);
        }
        if !total.converged {
            let Integral { value: integral, error, evaluations, .. } = total;
            return Err(Undecided::Quadrature { integral, error, evaluations }.into());
        }
        Ok(Masses { cells, total })
    }

    /// The counts, after samples that round-off moved out of the support have been moved back.
    pub(crate) fn counts_on_support(&self, masses: &[f64]) -> Result<Vec<u64>, Violation> {
        let mut counts = self.counts.clone();
        for (index, &count) in self.counts.iter().enumerate().filter(|&(i, &count)| count > 0 && masses[i] == 0.0) {
            let hint = &self.hints[index][0];
            let neighbour = (count as usize <= HINTS)
                .then(|| self.hints[index].iter().map(|hint| self.supported_neighbour(hint.at, masses)).collect())
                .and_then(|all: Option<Vec<usize>>| all)
                .and_then(|all| all.first().copied());
            match neighbour {
                Some(other) => counts[other] += count,
                None => {
                    let example = format!("{:?}", self.domain.point(hint.at));
                    return Err(Violation::ZeroDensity { samples: count, example });
                }
            }
            counts[index] = 0;
        }
        Ok(counts)
    }

    fn supported_neighbour(&self, [u, v]: [f64; 2], masses: &[f64]) -> Option<usize> {
        let shifts = [[EDGE, 0.0], [-EDGE, 0.0], [0.0, EDGE], [0.0, -EDGE]];
        shifts
            .into_iter()
            .map(|[du, dv]| self.cell([(u + du).clamp(0.0, 1.0), (v + dv).rem_euclid(1.0)]))
            .find(|&cell| masses[cell] > 0.0)
    }
}
