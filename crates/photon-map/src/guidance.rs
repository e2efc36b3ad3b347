//! Guidance of emission and scattering by importons.

use std::f64::consts::PI;

use crate::sphere::below_one;
use crate::{sphere_direction, sphere_square};

/// Why there is no such guidance.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GuidanceError {
    /// No cell.
    #[error("a histogram of {columns} x {rows} cells: both are at least 1, their product at most 65536")]
    Resolution {
        /// Columns.
        columns: u32,
        /// Rows.
        rows: u32,
    },
    /// A share that leaves nothing to the original density.
    #[error("the share of guided directions lies in [0, 1), not at {0}")]
    Share(f64),
}

/// Directions of importance at a point, as a histogram over cells of equal solid angle.
///
/// ```text
/// h(w) = (n / 4 pi) W_cell(w) / sum W            per solid angle
/// ```
///
/// **Symbols.** `n`: number of cells; `W_c`: sum of the importance that arrived from directions in cell `c`. Cells
/// are those of a grid on the square of [`sphere_direction`](crate::sphere_direction).
///
/// **Assumptions.** None: it is a density to sample from, not an estimate. Alone it may be zero where light goes; see
/// [`Guide`]. Importance that is negative, zero, infinite or NaN, and directions that are none, are not counted.
///
/// **Cost.** Adding is O(1), sampling O(number of cells). Allocated once; [`clear`](Self::clear) it for the next point.
///
/// **Source.** I. Peter and G. Pietrek, "Importance driven construction of photon maps", Rendering Techniques 1998.
///
/// # Example
/// ```
/// use photon_map::DirectionalHistogram;
/// let mut histogram = DirectionalHistogram::new(8, 4)?;
/// for (wi, importance) in [([0.0, 0.0, 1.0], 3.0), ([0.0, 0.0, -1.0], 1.0)] {
///     histogram.add(wi, importance);
/// }
/// let solid_angle = 4.0 * std::f64::consts::PI / 32.0;
/// assert!((histogram.pdf_solid_angle([0.01, 0.001, 1.0]) * solid_angle - 0.75).abs() < 1e-12);
/// # Ok::<(), photon_map::GuidanceError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DirectionalHistogram {
    columns: u32,
    rows: u32,
    weights: Vec<f64>,
    total: f64,
}

impl DirectionalHistogram {
    /// An empty histogram.
    ///
    /// # Errors
    /// [`GuidanceError::Resolution`] if a side has no cell, or there are more than 65536.
    pub fn new(columns: u32, rows: u32) -> Result<Self, GuidanceError> {
        let cells = u64::from(columns) * u64::from(rows);
        if cells == 0 || cells > 65536 {
            return Err(GuidanceError::Resolution { columns, rows });
        }
        Ok(Self { columns, rows, weights: vec![0.0; cells as usize], total: 0.0 })
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.weights.fill(0.0);
        self.total = 0.0;
    }

    /// Adds importance that arrived from `wi`.
    pub fn add(&mut self, wi: [f32; 3], importance: f32) {
        let Some(cell) = self.cell(wi).filter(|_| importance > 0.0 && importance.is_finite()) else { return };
        self.weights[cell] += f64::from(importance);
        self.total += f64::from(importance);
    }

    /// Whether it has no importance.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.total <= 0.0
    }

    fn cell(&self, direction: [f32; 3]) -> Option<usize> {
        let [u, v] = sphere_square(direction)?;
        let column = ((u * f64::from(self.columns)) as u32).min(self.columns - 1);
        let row = ((v * f64::from(self.rows)) as u32).min(self.rows - 1);
        Some((row * self.columns + column) as usize)
    }

    /// The density of a direction, per solid angle; zero if the histogram is empty, or the direction none.
    #[must_use]
    pub fn pdf_solid_angle(&self, direction: [f32; 3]) -> f64 {
        match self.cell(direction) {
            Some(cell) if !self.is_empty() => {
                self.weights[cell] / self.total * (self.weights.len() as f64 / (4.0 * PI))
            }
            _ => 0.0,
        }
    }

    /// A direction with density [`pdf_solid_angle`](Self::pdf_solid_angle); `None` if the histogram is empty.
    #[must_use]
    pub fn sample(&self, [u, v]: [f64; 2]) -> Option<[f32; 3]> {
        let mut rest = u * self.total;
        let mut chosen = None;
        for (cell, &weight) in self.weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
            chosen = Some((cell, below_one(rest / weight)));
            if rest < weight {
                break;
            }
            rest -= weight;
        }
        let (cell, within) = chosen?;
        let (column, row) = (cell as u32 % self.columns, cell as u32 / self.columns);
        Some(sphere_direction([
            (f64::from(column) + within) / f64::from(self.columns),
            (f64::from(row) + below_one(v)) / f64::from(self.rows),
        ]))
    }
}

/// A direction with its density per solid angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuidedDirection {
    /// The direction.
    pub direction: [f32; 3],
    /// Its density in the mixture: what the contribution is to be divided by.
    pub pdf_solid_angle: f64,
}

/// Emits or scatters by importance, mixed with the density that the renderer would use itself.
///
/// ```text
/// p(w) = (1 - b) p_0(w) + b h(w),      contribution  f(w) cos / p(w)
/// ```
///
/// **Symbols.** `b` in `[0, 1)`: the share that is guided; `p_0`: the original density per solid angle (of the BSDF,
/// or the light's emission); `h`: [`DirectionalHistogram`] of the importons around the point; 0 takes `b`'s place if
/// the histogram is empty.
///
/// **Unbiased** for every histogram, since `p >= (1 - b) p_0 > 0` where `f cos > 0`; the weight is at most
/// `1 / (1 - b)` times that of the original sampling. Dirac deltas have no density: scatter by them without guidance.
///
/// Photons get unequal flux by it, which makes density estimates noisier; Keller and Wald 2000 therefore guides *where photons are kept*
/// instead. Both go together: trace with this, multiply the flux by the weight, then let a
/// [`Deposition`](crate::Deposition) decide. For the choice among lights there is
/// [`LightTable::guided`](crate::LightTable::guided).
///
/// **Cost.** That of the histogram, which has to be filled from the importons around each point.
///
/// **Source.** I. Peter and G. Pietrek 1998; the mixture makes it unbiased. Keller and Wald 2000, "Remaining problems".
///
/// # Example
/// ```
/// use photon_map::{DirectionalHistogram, Guide, sphere_direction};
/// let mut histogram = DirectionalHistogram::new(8, 4)?;
/// histogram.add([1.0, 0.0, 0.2], 1.0);
/// let guide = Guide::new(0.5)?;
/// let uniform = 1.0 / (4.0 * std::f64::consts::PI); // the light emits into all directions alike
/// let sample = guide.sample(&histogram, [0.1, 0.5, 0.5], |u| Some(sphere_direction(u)), |_| uniform).ok_or("none")?;
/// assert!(sample.direction[0] > 0.0);
/// assert!((sample.pdf_solid_angle / uniform - (0.5 + 0.5 * 32.0)).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked"))]
pub struct Guide {
    share: f64,
}

#[cfg(feature = "serde")]
read_through!(Guide { share: f64 } => Self::new(share), GuidanceError);

impl Guide {
    /// Guides this share of the directions.
    ///
    /// # Errors
    /// [`GuidanceError::Share`] if it is not in `[0, 1)`: with 1, nothing would find what the importons missed.
    pub fn new(share: f64) -> Result<Self, GuidanceError> {
        if (0.0..1.0).contains(&share) { Ok(Self { share }) } else { Err(GuidanceError::Share(share)) }
    }

    /// The share `b`.
    #[must_use]
    pub const fn share(&self) -> f64 {
        self.share
    }

    /// The share of the directions that this histogram guides: 0 if it is empty.
    ///
    /// For renderers that sample by themselves: draw from the histogram with this probability, and otherwise from the
    /// original density, whose Dirac deltas then count `1 / (1 - b)` times.
    #[must_use]
    pub fn share_at(&self, histogram: &DirectionalHistogram) -> f64 {
        if histogram.is_empty() { 0.0 } else { self.share }
    }

    /// The density of a direction in the mixture, given its `original` density.
    #[must_use]
    pub fn pdf_solid_angle(&self, histogram: &DirectionalHistogram, direction: [f32; 3], original: f64) -> f64 {
        let share = self.share_at(histogram);
        let guided = if share > 0.0 { share * histogram.pdf_solid_angle(direction) } else { 0.0 };
        guided + (1.0 - share) * original
    }

    /// A direction from the mixture.
    ///
    /// `u`: uniform in `[0, 1)`; the first one chooses. `original`: the renderer's own sampling, `None` where the
    /// path ends (then this is `None`, too, and the contribution zero); `pdf`: its density per solid angle.
    pub fn sample(
        &self,
        histogram: &DirectionalHistogram,
        u: [f64; 3],
        original: impl FnOnce([f64; 2]) -> Option<[f32; 3]>,
        pdf: impl FnOnce([f32; 3]) -> f64,
    ) -> Option<GuidedDirection> {
        let numbers = [u[1], u[2]];
        let guided = u[0] < self.share_at(histogram);
        let direction = if guided { histogram.sample(numbers) } else { original(numbers) }?;
        let pdf_solid_angle = self.pdf_solid_angle(histogram, direction, pdf(direction));
        (pdf_solid_angle > 0.0).then_some(GuidedDirection { direction, pdf_solid_angle })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn histogram() -> DirectionalHistogram {
        let mut histogram = DirectionalHistogram::new(4, 4).unwrap();
        for (direction, importance) in [([1.0, 0.1, 0.2], 2.0), ([-1.0, 0.3, -0.9], 1.0), ([0.0, -1.0, 0.1], 5.0)] {
            histogram.add(direction, importance);
        }
        histogram
    }

    #[test]
    fn samples_fall_into_cells_in_proportion_to_their_importance() {
        let histogram = histogram();
        let mut counts = [0_u32; 16];
        for i in 0..800 {
            let direction = histogram.sample([(f64::from(i) + 0.5) / 800.0, 0.5]).unwrap();
            counts[histogram.cell(direction).unwrap()] += 1;
        }
        let expected: Vec<u32> = histogram.weights.iter().map(|weight| (100.0 * weight) as u32).collect();
        assert_eq!(counts.to_vec(), expected);
    }

    #[test]
    fn the_density_integrates_to_one() {
        let histogram = histogram();
        let centre = |i: u32| sphere_direction([(f64::from(i % 4) + 0.5) / 4.0, (f64::from(i / 4) + 0.5) / 4.0]);
        let integral: f64 = (0..16).map(|i| histogram.pdf_solid_angle(centre(i)) * 4.0 * PI / 16.0).sum();
        assert!((integral - 1.0).abs() < 1e-12);
    }

    #[test]
    fn nonsense_is_answered_as_documented() {
        let mut histogram = DirectionalHistogram::new(4, 4).unwrap();
        for importance in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            histogram.add([1.0, 0.0, 0.0], importance);
        }
        histogram.add([0.0; 3], 1.0);
        assert!(histogram.is_empty());
        assert_eq!(histogram.sample([0.5; 2]), None);
        assert_eq!(histogram.pdf_solid_angle([1.0, 0.0, 0.0]), 0.0);
        // Without importance the renderer's own sampling is left alone.
        let guide = Guide::new(0.9).unwrap();
        let sample = guide.sample(&histogram, [0.1, 0.2, 0.3], |u| Some(sphere_direction(u)), |_| 0.25);
        assert_eq!(sample, Some(GuidedDirection { direction: sphere_direction([0.2, 0.3]), pdf_solid_angle: 0.25 }));
        assert_eq!(guide.sample(&histogram, [0.1, 0.2, 0.3], |_| None, |_| 0.25), None);

        histogram.add([1.0, 0.0, 0.0], 1.0);
        histogram.clear();
        assert!(histogram.is_empty());
        assert!(matches!(DirectionalHistogram::new(0, 1), Err(GuidanceError::Resolution { .. })));
        assert!(
            [1.0, -0.1, f64::NAN]
                .iter()
                .all(|&share| Guide::new(share) == Err(GuidanceError::Share(share)) || share.is_nan())
        );
    }
}
