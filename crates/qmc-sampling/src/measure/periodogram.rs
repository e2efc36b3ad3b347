//! The power spectrum of two-dimensional points.
use super::{MeasureError, check};
use alloc::vec;
use alloc::vec::Vec;

/// The mean power spectrum of sets of two-dimensional points, as a square picture with frequency zero in the middle.
///
/// `P(f) = 1 / n |sum_j exp(-2 pi i f . x_j)|^2` for integer frequencies, which the unit torus has; one on average for
/// independent points. The value at zero is left out (zero). Add several randomisations for a smooth picture.
/// Cost: points times pixels.
///
/// ```
/// use qmc_sampling::measure::Periodogram;
/// let mut picture = Periodogram::new(8);
/// picture.add(&[0.0, 0.0, 0.5, 0.0])?; // a comb of period 1/2: only even frequencies
/// assert!(picture.power([1, 0]) < 1e-12 && (picture.power([2, 0]) - 2.0).abs() < 1e-12);
/// # Ok::<(), qmc_sampling::measure::MeasureError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Periodogram {
    /// The largest frequency.
    reach: usize,
    sum: Vec<f64>,
    sets: u32,
}

impl Periodogram {
    /// An empty picture of frequencies from `-reach` to `reach`.
    #[must_use]
    pub fn new(reach: usize) -> Self {
        let side = 2 * reach + 1;
        Self { reach, sum: vec![0.0; side * side], sets: 0 }
    }

    /// The number of pixels of a side.
    #[must_use]
    pub fn side(&self) -> usize {
        2 * self.reach + 1
    }

    /// Adds a set of points, `[x0, y0, x1, y1, ..]`.
    ///
    /// # Errors
    /// If the points are not well-formed.
    pub fn add(&mut self, points: &[f64]) -> Result<(), MeasureError> {
        let n = check(points, 2)? as f64;
        let side = self.side();
        let mut spectrum = vec![(0.0, 0.0); self.sum.len()];
        // The powers of exp(-2 pi i x) and of exp(-2 pi i y), for all frequencies; the spectrum is the sum of their products.
        let [mut along_x, mut along_y] = [vec![(0.0, 0.0); side], vec![(0.0, 0.0); side]];
        for point in points.chunks_exact(2) {
            self.waves(point[0], &mut along_x);
            self.waves(point[1], &mut along_y);
            for (row, &(c, d)) in spectrum.chunks_exact_mut(side).zip(&along_y) {
                for (sum, &(a, b)) in row.iter_mut().zip(&along_x) {
                    sum.0 += a * c - b * d;
                    sum.1 += a * d + b * c;
                }
            }
        }
        for (sum, (re, im)) in self.sum.iter_mut().zip(spectrum) {
            *sum += (re * re + im * im) / n;
        }
        self.sum[self.reach * side + self.reach] = 0.0;
        self.sets += 1;
        Ok(())
    }

    fn waves(&self, x: f64, waves: &mut [(f64, f64)]) {
        for (k, wave) in waves.iter_mut().enumerate() {
            let frequency = k as f64 - self.reach as f64;
            let (sin, cos) = crate::Real::sin_cos(-2.0 * core::f64::consts::PI * frequency * x);
            *wave = (cos, sin);
        }
    }

    /// The mean power at a frequency; zero beyond the reach or if there are no points yet.
    #[must_use]
    pub fn power(&self, frequency: [i32; 2]) -> f64 {
        let at = |f: i32| usize::try_from(i64::from(f) + self.reach as i64).ok().filter(|&k| k < self.side());
        match (at(frequency[0]), at(frequency[1])) {
            (Some(x), Some(y)) if self.sets > 0 => self.sum[y * self.side() + x] / f64::from(self.sets),
            _ => 0.0,
        }
    }

    /// The picture, row by row, of [`side`](Self::side) squared numbers.
    #[must_use]
    pub fn picture(&self) -> Vec<f32> {
        let scale = 1.0 / f64::from(self.sets.max(1));
        self.sum.iter().map(|sum| (sum * scale) as f32).collect()
    }

    /// The mean power over rings of width one around frequency zero.
    #[must_use]
    pub fn radial(&self) -> Vec<f64> {
        let mut rings = vec![(0.0, 0_u32); self.reach + 1];
        let reach = self.reach as i32;
        for y in -reach..=reach {
            for x in -reach..=reach {
                let radius = crate::Real::sqrt(f64::from(x) * f64::from(x) + f64::from(y) * f64::from(y));
                if let Some(ring) = rings.get_mut((radius + 0.5) as usize) {
                    ring.0 += self.power([x, y]);
                    ring.1 += 1;
                }
            }
        }
        rings.into_iter().map(|(sum, count)| sum / f64::from(count.max(1))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::testing::points;
    use crate::sequences::{Random, Stratified};

    #[test]
    fn white_noise_is_flat_and_jittered_points_lack_low_frequencies() {
        let (mut white, mut jittered) = (Periodogram::new(6), Periodogram::new(6));
        for seed in 0..40 {
            white.add(&points(Random::new(seed), 256, 2)).unwrap();
            jittered.add(&points(Stratified::jittered(16, 16, seed).unwrap(), 256, 2)).unwrap();
        }
        for ring in 1..6 {
            assert!((white.radial()[ring] - 1.0).abs() < 0.3, "{:?}", white.radial());
        }
        assert!(jittered.radial()[1] < 0.1 && jittered.radial()[3] < 0.3, "{:?}", jittered.radial());
        assert_eq!((white.power([0, 0]), white.power([7, 0])), (0.0, 0.0));
        assert_eq!(white.picture().len(), 13 * 13);
        assert!(white.add(&[0.5]).is_err() && Periodogram::new(1).power([1, 1]) == 0.0);
    }
}
